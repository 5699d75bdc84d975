"""Templates as the build compiled them."""

from pathlib import Path

import pytest

from hpn.web.pages import assets, templates


def test_the_build_has_compiled_every_template_as_it_is() -> None:
    made = templates.environment_of(assets.Assets.load())
    assert made.bytecode_cache is not None and made.loader is not None
    for name in made.list_templates():
        source, path, _ = made.loader.get_source(made, name)
        assert made.bytecode_cache.get_bucket(made, name, path, source).code is not None, f"{name}: run `make assets`"


def test_a_template_that_has_changed_since_is_compiled_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(templates, "TEMPLATES", tmp_path)
    monkeypatch.setattr(templates, "COMPILED", tmp_path / "compiled")
    page = tmp_path / "page.html"
    page.write_text("before")
    templates.compile_all()
    page.write_text("after")
    assert templates.environment_of(assets.Assets.load()).get_template("page.html").render() == "after"
    assert len(list((tmp_path / "compiled").iterdir())) == 1


def test_a_tree_that_has_been_moved_keeps_its_compiled_templates(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    built, moved = tmp_path / "built", tmp_path / "moved"
    built.mkdir()
    (built / "page.html").write_text("as built")
    for folder in (built, moved):
        monkeypatch.setattr(templates, "TEMPLATES", folder)
        monkeypatch.setattr(templates, "COMPILED", folder / "compiled")
        if folder is built:
            templates.compile_all()
            built.rename(moved)
    made = templates.environment_of(assets.Assets.load())
    assert made.bytecode_cache is not None and made.loader is not None
    source, path, _ = made.loader.get_source(made, "page.html")
    assert made.bytecode_cache.get_bucket(made, "page.html", path, source).code is not None

"""Templates compiled by the build."""

from pathlib import Path

import pytest
from jinja2 import pass_context

from hpn.web.pages import assets, templates


def test_the_build_has_compiled_every_template_as_it_is() -> None:
    output = templates.environment_of(assets.Assets.load())
    assert output.bytecode_cache is not None and output.loader is not None
    for name in output.list_templates():
        source, path, _ = output.loader.get_source(output, name)
        assert output.bytecode_cache.get_bucket(output, name, path, source).code is not None, (
            f"{name}: run `make assets`"
        )


def test_a_template_that_has_changed_since_is_compiled_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(templates, "TEMPLATES", tmp_path)
    monkeypatch.setattr(templates, "COMPILED", tmp_path / "compiled")
    page = tmp_path / "page.html"
    page.write_text("before")
    templates.compile_all()
    page.write_text("after")
    assert templates.environment_of(assets.Assets.load()).get_template("page.html").render() == "after"
    assert len(list((tmp_path / "compiled").iterdir())) == 1


def test_a_template_whose_filter_now_takes_the_context_is_compiled_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(templates, "TEMPLATES", tmp_path)
    monkeypatch.setattr(templates, "COMPILED", tmp_path / "compiled")
    (tmp_path / "page.html").write_text("{{ 'word' | capital }}")
    templates.compile_all()
    with_context = pass_context(lambda context, text: text.upper())
    monkeypatch.setattr(templates, "FILTERS", templates.FILTERS | {"capital": with_context})
    templates.compile_all()
    assert templates.environment_of(assets.Assets.load()).get_template("page.html").render() == "WORD"


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
    output = templates.environment_of(assets.Assets.load())
    assert output.bytecode_cache is not None and output.loader is not None
    source, path, _ = output.loader.get_source(output, "page.html")
    assert output.bytecode_cache.get_bucket(output, "page.html", path, source).code is not None


def test_a_template_is_laid_out_in_lines_that_fit_beside_each_other() -> None:
    wide = [
        f"{path.name}:{number}"
        for path in sorted(templates.TEMPLATES.glob("*.html"))
        for number, line in enumerate(path.read_text().splitlines(), start=1)
        if len(line) > 140
    ]
    assert wide == []


def test_the_layout_of_a_template_is_none_of_the_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(templates, "TEMPLATES", tmp_path)
    laid_out = (
        '<td class="figure"\n    id="{{ 1\n    + 1 }}"{% if true %} title="a\n      b"{% endif %}\n    hidden>\n'
        "  {{ 3 }}\n  <span>kept</span>\n  apart\n</td>\n<pre>\na  b</pre>"
    )
    (tmp_path / "page.html").write_text(laid_out)
    output = templates.environment_of(assets.Assets.load())

    assert output.loader is not None
    source, _, _ = output.loader.get_source(output, "page.html")
    assert source.count("\n") == laid_out.count("\n")
    assert output.get_template("page.html").render() == (
        '<td class="figure" id="2" title="a b" hidden>3\n<span>kept</span>\napart</td>\n<pre>\na  b</pre>'
    )

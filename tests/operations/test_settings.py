"""The settings, as the example file and the README list them."""

import re
from pathlib import Path

import pytest

from hpn.web.settings import Settings

ROOT = Path(__file__).parents[2]
OF_COMPOSE_ALONE = {"POSTGRES_PASSWORD", "HPN_PUBLISH"}
NAMES = {f"HPN_{name.upper()}" for name in Settings.model_fields}


def example() -> dict[str, str]:
    """Variables of the example file, set or commented out."""
    lines = re.findall(r"^#?([A-Z_]+)=(.*)$", (ROOT / ".env.example").read_text(), re.M)
    assert len(lines) == len(dict(lines))
    return dict(lines)


def test_the_example_file_has_every_setting_and_no_other() -> None:
    assert set(example()) == NAMES | OF_COMPOSE_ALONE


def test_the_example_file_shows_the_defaults(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    for name, value in example().items():
        monkeypatch.setenv(name, value)
    shown, default = Settings(), Settings.model_construct()

    for name in set(Settings.model_fields) - {"catalogue_folder"}:
        assert getattr(shown, name) == getattr(default, name), name
    assert shown.catalogue_folder.resolve() == default.catalogue_folder


def test_the_readme_lists_every_setting() -> None:
    listed = set(re.findall(r"^\| `(HPN_[A-Z_]+)` \|", (ROOT / "README.md").read_text(), re.M))

    assert listed == NAMES


def test_every_setting_is_described() -> None:
    assert [name for name, field in Settings.model_fields.items() if not field.description] == []

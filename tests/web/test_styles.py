"""The style sheets say what browsers understand."""

import re
from pathlib import Path

import pytest

STATIC = Path(__file__).parents[2] / "frontend/static"
COLOUR = r"(?:#[0-9a-f]{3,8}|rgb\([^()]*\)|transparent)"
BOTH = re.compile(rf"\(\s*{COLOUR}\s*,\s*{COLOUR}\s*\)")


@pytest.mark.parametrize("file", sorted(STATIC.glob("*.css")), ids=lambda file: file.name)
def test_light_dark_is_given_two_colours(file: Path) -> None:
    """With anything else the browser drops the whole declaration, and says nothing."""
    text = file.read_text()

    wrong = [text[call.start() :][:60] for call in re.finditer("light-dark", text) if not BOTH.match(text, call.end())]

    assert wrong == []

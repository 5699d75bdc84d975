"""Style sheets contain only declarations that browsers understand."""

import re
from pathlib import Path

import pytest

STATIC = Path(__file__).parents[2] / "frontend/static"
COLOUR = r"(?:#[0-9a-f]{3,8}|rgb\([^()]*\)|transparent)"
BOTH = re.compile(rf"\(\s*{COLOUR}\s*,\s*{COLOUR}\s*\)")


@pytest.mark.parametrize("file", sorted(STATIC.glob("*.css")), ids=lambda file: file.name)
def test_light_dark_is_given_two_colours(file: Path) -> None:
    """With any other argument the browser silently drops the whole declaration."""
    text = file.read_text()

    wrong = [text[call.start() :][:60] for call in re.finditer("light-dark", text) if not BOTH.match(text, call.end())]

    assert wrong == []

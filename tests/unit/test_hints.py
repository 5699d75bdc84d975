"""Hints of the form: one line each, in every language."""

import pytest

from hpn.links.symbols import SYMBOLS, mechanism_symbols
from hpn.physics.motion.mechanisms import TYPES
from hpn.words.reader import LANGUAGE_NAMES, Reader

HINTS = {symbol.hint for symbol in (*SYMBOLS, *(each for kind in TYPES for each in mechanism_symbols(kind)))} - {""}
LONGEST = 60
"""Characters that the form has room for in one line."""


@pytest.mark.parametrize("language", LANGUAGE_NAMES)
def test_a_hint_fits_into_one_line_of_the_form(language: str) -> None:
    reader = Reader(language)
    assert len(HINTS) > 20
    assert [text for text in map(reader.text, sorted(HINTS)) if len(text) > LONGEST] == []

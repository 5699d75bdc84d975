"""Handbook symbols in a text, parsed for typesetting: `T_av` is T with the index av."""

import re

Symbol = tuple[str, str]
"""A letter and its index, which may be empty."""

Part = str | Symbol

_LETTER = "[A-Za-zαβηθμφ]"
_INDEXED = rf"\b{_LETTER}_[A-Za-z0-9]+(?:[,_][A-Za-z0-9]+)*(?:\([A-Za-z0-9]+\))?"
_SENTENCE = re.compile(rf"({_INDEXED}|(?<=\)/)i\b)")
_FORMULA = re.compile(rf"({_INDEXED}|\b{_LETTER}\b)")


def formula(text: str) -> list[Part]:
    """Parts of a formula, in which single letters are symbols, too."""
    return _parts(_FORMULA, text)


def sentence(text: str) -> list[Part]:
    """Parts of a sentence, in which only letters with an index are symbols, and the ratio i as a divisor of one."""
    return _parts(_SENTENCE, text)


def _parts(pattern: re.Pattern[str], text: str) -> list[Part]:
    pieces = pattern.split(text)
    return [_symbol(piece) if k % 2 else piece for k, piece in enumerate(pieces) if piece]


def _symbol(text: str) -> Symbol:
    letter, _, index = text.partition("_")
    return letter, index.replace("_", ",")

"""Handbook symbols in a text, taken apart for setting: `T_av` is T with the index av."""

import re

Part = str | list[str]
"""A plain text, or a symbol: its letter and its index, which may be empty."""

_INDEXED = r"\b[A-Za-zηθ]_[A-Za-z0-9]+(?:[,_][A-Za-z0-9]+)*(?:\([A-Za-z0-9]+\))?"
_SENTENCE = re.compile(rf"({_INDEXED})")
_FORMULA = re.compile(rf"({_INDEXED}|\b[A-Za-zαβηθμφ]\b)")


def formula(text: str) -> list[Part]:
    """A formula, in which single letters are symbols too."""
    return _parts(_FORMULA, text)


def sentence(text: str) -> list[Part]:
    """A sentence, in which only what has an index is a symbol."""
    return _parts(_SENTENCE, text)


def _parts(pattern: re.Pattern[str], text: str) -> list[Part]:
    pieces = pattern.split(text)
    return [_symbol(piece) if k % 2 else piece for k, piece in enumerate(pieces) if piece]


def _symbol(text: str) -> list[str]:
    letter, _, index = text.partition("_")
    return [letter, index.replace("_", ",")]

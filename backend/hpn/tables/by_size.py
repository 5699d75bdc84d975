"""Numbers by size as typed text: `21` for all sizes, or `20A: 21; 32A: 30; others: 18`."""

import json
from collections.abc import Callable, Iterable
from functools import cache
from typing import NamedTuple

from hpn.words.designations import OTHERS, canonical_place
from hpn.words.reader import LANGUAGES, Reader
from hpn.words.terms import FOR_OTHERS


class Part(NamedTuple):
    """A number as a text, and its size as written; the size is blank for all others."""

    size: str
    number: str

    @property
    def place(self) -> str:
        """Size in the handbook's spelling, or `others`; anything else as written."""
        is_others = not self.size or self.size.casefold() in _words_for_others()
        return OTHERS if is_others else str(canonical_place(self.size))


class BySize(str):
    """Numbers by size in one text, `20A:21;18`, with their parts."""

    parts: tuple[Part, ...]

    def __new__(cls, parts: Iterable[Part]) -> "BySize":
        """A text equal to its parts as a link writes them."""
        own = tuple(parts)
        text = super().__new__(cls, ";".join(f"{size}:{number}" if size else number for size, number in own))
        text.parts = own
        return text

    def for_field(self, numbers: Iterable[str], reader: Reader) -> str:
        """The text for a field of a reader, with numbers as the reader writes them."""
        pairs = list(zip(self.parts, numbers, strict=True))
        if len(pairs) == 1 and not self.parts[0].size:
            return pairs[0][1]
        others = reader.text(FOR_OTHERS)
        return "; ".join(f"{others if part.place == OTHERS else part.size}: {number}" for part, number in pairs)


def by_size(text: str) -> BySize:
    """Parts of a text between semicolons; the size of each stands before a colon."""
    if isinstance(text, BySize):
        return text
    parts = []
    for piece in filter(str.strip, text.split(";")):
        size, colon, number = piece.partition(":")
        is_sized = bool(colon and size.strip())
        parts.append(
            Part(size.strip(), number.strip()) if is_sized else Part("", piece.strip() if ";" in text else piece)
        )
    return BySize(parts)


def numbers_by_size(cell: str, number_of: Callable[[str], float | None]) -> dict[str, float] | None:
    """Numbers by size in a cell, typed or as an object of JSON, read by `number_of`; None for any other cell."""
    parts = by_size(cell).parts
    if cell.lstrip().startswith("{"):
        try:
            pairs = json.loads(cell, object_pairs_hook=list)  # neither of two numbers for one size counts
        except (ValueError, RecursionError):
            return None
        parts = tuple(Part(size, str(number)) for size, number in pairs)
    numbers = {part.place: number for part in parts if (number := number_of(part.number)) is not None}
    is_whole = len(numbers) == len(parts) and any(part.size for part in parts)
    return numbers if is_whole else None


@cache
def _words_for_others() -> frozenset[str]:
    return frozenset({OTHERS, *(Reader(language).text(FOR_OTHERS).casefold() for language in LANGUAGES)})

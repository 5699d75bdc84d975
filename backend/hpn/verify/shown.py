"""Lines that a file shows, the figures in them, and the lines of two files beside each other."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from itertools import zip_longest
from typing import Any

from pydantic import ValidationError

from hpn.application import InputError
from hpn.application.faults import faults_of, pointer
from hpn.engine.selection import Selection
from hpn.explain.comparison import is_same
from hpn.explain.differences import Difference, differences
from hpn.words.reader import GROUP, MINUS
from hpn.words.wording import MendableError

FIGURE = re.compile(rf"[0-9](?:[0-9.,{GROUP}]*[0-9])?(?:e[+-]?[0-9]{{1,3}})?")
"""A figure with the marks of any language inside it; those of a designation count, too."""

BY_MARK = {".": (",", GROUP), ",": (".", GROUP)}
"""Marks between thousands by the decimal mark."""


class UnreadableFileError(MendableError):
    """A file that can't be read, with the sentence that says why."""


MOST_FAULTS = 3


def listed(error: ValidationError | InputError) -> str:
    """Faults of an application in one line."""
    return "; ".join(f"{pointer(place) or '/'}: {text}" for place, text, _ in faults_of(error)[:MOST_FAULTS])


@dataclass(frozen=True, slots=True)
class Shown:
    """A line of a file and where it stands, such as `page 2` or `Selection, row 7`.

    `behind` are its formulas, `key` what names it among all lines, such as the path of an element.
    """

    place: str
    text: str
    behind: str = ""
    key: str = ""

    @property
    def words(self) -> str:
        """The line without its figures."""
        return f"{self.key} {FIGURE.sub('#', self.text)}"

    @property
    def figures(self) -> list[str]:
        """Its figures as they are written."""
        return FIGURE.findall(self.text)


Pair = tuple[Shown | None, Shown | None]
"""Lines of two files that stand for each other; None where one has nothing in this place."""


def beside(one: Sequence[Shown], other: Sequence[Shown]) -> Iterator[Pair]:
    """Lines of two files beside each other: those with the same words, in their order."""
    words = [line.words for line in one], [line.words for line in other]
    for tag, first, last, start, end in SequenceMatcher(None, *words).get_opcodes():
        pairs = zip_longest(one[first:last], other[start:end])
        if tag == "equal":
            yield from pairs
        else:
            yield from ((line, None) for line in one[first:last])
            yield from ((None, line) for line in other[start:end])


def with_same_words(line: Shown, lines: Iterable[Shown], mark: str) -> Shown | None:
    """The line of another file with the same words, that with most of its figures first.

    A line without a letter, which may be a row of a table or ticks of an axis, has to share two figures.
    """
    found = [other for other in lines if other.words == line.words]
    best = max(found, key=lambda other: _common(line, other, mark), default=None)
    is_bare = not any(map(str.isalpha, line.text))
    return None if best is None or (is_bare and _common(line, best, mark) < LEAST_IN_COMMON) else best


LEAST_IN_COMMON = 2


def _common(one: Shown, other: Shown, mark: str) -> int:
    return sum(_agree(a, b, mark) for a, b in zip(one.figures, other.figures, strict=True))


def is_alike(one: Shown, other: Shown, mark: str) -> bool:
    """True where lines with the same words have the same figures, as far as both show digits."""
    return all(_agree(a, b, mark) for a, b in zip(one.figures, other.figures, strict=True))


def is_exact(one: Shown, other: Shown) -> bool:
    """True where lines with the same words have figures that are equal to 1e-12."""
    figures = zip(one.figures, other.figures, strict=False)
    return one.words == other.words and all(a == b or is_same(_float(a), _float(b)) for a, b in figures)


def _float(figure: str) -> float | str:
    value = value_of(figure, ".")
    return figure if value is None else value


def _agree(one: str, other: str, mark: str) -> bool:
    if one == other:
        return True
    a, b = value_of(one, mark), value_of(other, mark)
    if a is None or b is None:
        return False
    return is_same(a, b) or agrees(one, b, mark) or agrees(other, a, mark)


def agrees(figure: str, value: float, mark: str) -> bool:
    """True for a figure with decimals that is a value, rounded; a whole one has to have all of its digits."""
    shown = value_of(figure, mark)
    if shown is None or "e" in figure:
        return shown is not None and is_same(shown, value)
    decimals = len(figure.partition(mark)[2])
    return is_same(shown, abs(value)) or abs(shown - abs(value)) <= 0.5 * 10.0**-decimals * (1 + 1e-9)


def value_of(figure: str, mark: str) -> float | None:
    """Value of a figure by its decimal mark; None of what is no number, such as 17.2.1."""
    for group in BY_MARK[mark]:
        figure = figure.replace(group, "")
    try:
        return float(figure.replace(mark, ".").replace(MINUS, "-"))
    except ValueError:
        return None


def differing(saved: Mapping[str, Any], today: Selection) -> Iterator[Difference]:
    """Verdicts and figures of two answers that differ, those in a text included; another wording is no difference."""
    for one in differences(saved, today):
        if one.kind != "text" or _has_other_figures(one.saved, one.today):
            yield one


def _has_other_figures(one: Any, other: Any) -> bool:
    lines = Shown("", str(one)), Shown("", str(other))
    return lines[0].words == lines[1].words and not is_exact(*lines)

"""Lines of a file, the figures in them, and the lines of two files beside each other."""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from itertools import zip_longest
from typing import Any
from urllib.parse import parse_qsl, urlsplit

from msgspec import structs
from pydantic import ValidationError

from hpn.application import Application, InputError
from hpn.application.faults import lines_of
from hpn.engine.room import Room
from hpn.engine.selection import Selection
from hpn.explain.comparison import is_same
from hpn.explain.differences import Difference, differences
from hpn.web.form import link_reader
from hpn.words.reader import GROUP, MINUS
from hpn.words.wording import MendableError

FIGURE = re.compile(rf"[0-9](?:[0-9.,{GROUP}]*[0-9])?(?:e[+-]?[0-9]{{1,3}})?")
"""Figure with the marks of any language inside it; figures of a designation count, too."""

POINT = "."
"""Decimal mark of cells, packages and JSON in any language."""

BY_MARK = {".": (",", GROUP), ",": (".", GROUP)}
"""Marks between thousands, by the decimal mark."""


class UnreadableFileError(MendableError):
    """Error of an unreadable file; its sentence says why."""

    @classmethod
    def of(cls, form: str, error: Exception) -> "UnreadableFileError":
        """Error for a file that a library can't read, with the first line of the library's text."""
        return cls(f"the {form} can’t be read: {str(error).partition(chr(10))[0]:.200}")


MOST_FAULTS, MOST_FIELDS = 3, 200_000


def listed(error: ValidationError | InputError) -> str:
    """First faults of an application in one line."""
    return "; ".join(lines_of(error)[:MOST_FAULTS])


@dataclass(frozen=True, slots=True)
class FileSubject:
    """Application, and the gear that its file shows; blank for the foremost."""

    application: Application
    chosen: str = ""


def subject_of(link: str) -> FileSubject | None:
    """Application and gear of a link; None for a link without a readable application."""
    try:
        pairs = parse_qsl(urlsplit(link).query, keep_blank_values=True, max_num_fields=MOST_FIELDS)
    except ValueError:
        return None
    form = link_reader.parse(pairs)
    return None if form.application is None else FileSubject(form.application, form.gear)


@dataclass(frozen=True, slots=True)
class FileLine:
    """Line of a file and its place, such as `page 2` or `Selection, row 7`.

    `behind` are its columns and formulas, `key` identifies it among all lines, such as the path of an element.
    """

    place: str
    text: str
    behind: str = ""
    key: str = ""

    @property
    def words(self) -> str:
        """Line without its figures."""
        return f"{self.key} {FIGURE.sub('#', self.text)}"

    @property
    def figures(self) -> list[str]:
        """Figures as they are written."""
        return FIGURE.findall(self.text)


Pair = tuple[FileLine | None, FileLine | None]
"""Corresponding lines of two files; None where a file has none."""


def beside(one: Sequence[FileLine], other: Sequence[FileLine]) -> Iterator[Pair]:
    """Lines of two files beside each other: lines with the same words, in their order."""
    words = [line.words for line in one], [line.words for line in other]
    for tag, first, last, start, end in SequenceMatcher(None, *words).get_opcodes():
        pairs = zip_longest(one[first:last], other[start:end])
        if tag == "equal":
            yield from pairs
        else:
            yield from ((line, None) for line in one[first:last])
            yield from ((None, line) for line in other[start:end])


def with_same_words(line: FileLine, lines: Iterable[FileLine], mark: str) -> FileLine | None:
    """Line of another file with the same words, and with most of this line's figures.

    A line without a letter, such as a row of a table or ticks of an axis, must share two figures.
    """
    alike = [other for other in lines if other.words == line.words]
    best = max(alike, key=lambda other: _common(line, other, mark), default=None)
    is_bare = not any(map(str.isalpha, line.text))
    return None if best is None or (is_bare and _common(line, best, mark) < LEAST_IN_COMMON) else best


LEAST_IN_COMMON = 2


def _common(one: FileLine, other: FileLine, mark: str) -> int:
    return sum(_agree(a, b, mark) for a, b in zip(one.figures, other.figures, strict=True))


def is_alike(one: FileLine, other: FileLine, mark: str) -> bool:
    """True where lines with the same words have the same figures, as far as both show digits."""
    return all(_agree(a, b, mark) for a, b in zip(one.figures, other.figures, strict=True))


def is_exact(one: FileLine, other: FileLine) -> bool:
    """True where lines with the same words have figures that are equal to 1e-12."""
    figures = zip(one.figures, other.figures, strict=False)
    return one.words == other.words and all(a == b or is_same(_float(a), _float(b)) for a, b in figures)


def _float(figure: str) -> float | str:
    """Value of a figure with every digit; a figure with marks between thousands, or with a decimal comma, stays
    a text."""
    value = None if "," in figure or GROUP in figure else value_of(figure, ".")
    return figure if value is None else value


def _agree(one: str, other: str, mark: str) -> bool:
    if one == other:
        return True
    a, b = value_of(one, mark), value_of(other, mark)
    if a is None or b is None:
        return False
    return is_same(a, b) or agrees(one, b, mark) or agrees(other, a, mark)


def agrees(figure: str, value: float, mark: str) -> bool:
    """True for a figure that is a value rounded to its decimals; a whole figure must have all digits of the value."""
    known = value_of(figure, mark)
    if known is None or "e" in figure:
        return known is not None and is_same(known, value)
    decimals = len(figure.partition(mark)[2])
    return is_same(known, abs(value)) or abs(known - abs(value)) <= 0.5 * 10.0**-decimals * (1 + 1e-9)


def value_of(figure: str, mark: str) -> float | None:
    """Value of a figure with a decimal mark; None for a text that is no number, such as 17.2.1."""
    for group in BY_MARK[mark]:
        figure = figure.replace(group, "")
    try:
        return float(figure.replace(mark, ".").replace(MINUS, "-"))
    except ValueError:
        return None


def differing(saved: Mapping[str, Any], today: Selection) -> Iterator[Difference]:
    """Verdicts and figures of two answers that differ, figures in texts included; other wording is no difference."""
    room, known = saved.get("tolerance"), today.tolerance
    if isinstance(room, Mapping) and isinstance(known, Room):
        saved = {**saved, "tolerance": {**room, "case": _whole(room.get("case"))}}
        today = structs.replace(today, tolerance=structs.replace(known, case=_whole(known.case)))
    for one in differences(saved, today):
        before, after = FileLine("", str(one.saved)), FileLine("", str(one.today))
        if one.kind != "text" or (before.words == after.words and not is_alike(before, after, POINT)):
            yield one
    yield from _in_notices(saved, today)


def _whole(case: Any) -> Any:
    """A case with the defaults of what it leaves out: files carry them, and what was sent may lack them."""
    try:
        return Application.model_validate(case).model_dump(mode="json")
    except (ValidationError, InputError):
        return case


def _in_notices(saved: Mapping[str, Any], today: Selection) -> Iterator[Difference]:
    """Values of notices that differ, by the sentences' names; the differences of an answer do not include them."""
    known, counts = [*today.notices], Counter[str]()
    for place, one in enumerate(saved.get("notices") or ()):
        code, values = one.get("code"), one.get("values") or {}
        same = [other for other in known if other.code == code][counts[code] :]
        counts[code] += 1
        for name, value in values.items() if same else ():
            if name in same[0].values and not is_same(value, same[0].values[name]):
                pointer_ = f"/notices/{place}/values/{name}"
                yield Difference(pointer_, "figure", "changed", None, None, name, value, same[0].values[name])

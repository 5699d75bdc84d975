"""From a text to the cells of a table, by every plausible separator."""

import csv
import io
import itertools
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from re import IGNORECASE

from hpn.tables.cells import Merged, tidy
from hpn.words.fields import MAXIMUM_PHASES
from hpn.words.patterns import Pattern
from hpn.words.wording import N_, Sentence, Value

MAXIMUM_CHARACTERS = 1_000_000
MOST_HEAD_ROWS = 50
"""Rows in addition to the phases: title, header, units, sums."""

MOST_CELLS = 150_000
MOST_CHARACTERS = 4_000_000
"""Cells of a file, and characters of their texts."""

LONGEST_TEXT = 131_072
"""Characters of a cell: the csv module's limit, and four times that of spreadsheet programs."""

SEPARATORS = {
    "tab": N_("tab"),
    "semicolon": N_("semicolon"),
    "comma": N_("comma"),
    "bar": N_("vertical bar"),
    "blanks": N_("several blanks"),
    "blank": N_("blank"),
}
_MARKS = {"tab": "\t", "semicolon": ";", "comma": ",", "bar": "|"}
_HINT = Pattern(r"sep=(.)\r?\n", 7, IGNORECASE)
"""First line that tells Excel the separator."""


Takes = Callable[[Sequence[str], bool], bool]
"""Test for a table that is taken unread, by the names of its columns and True where its phases are lists."""


class RefusedError(ValueError):
    """Error for a table that can't be read; `sentence` gives the reason."""

    def __init__(self, template: str, **values: Value) -> None:
        super().__init__(template)
        self.sentence = Sentence(template, dict(values))


def too_many_cells() -> RefusedError:
    """Error for a table with too many cells."""
    template = N_("there are more than {most} cells: leave out the columns that are not needed")
    return RefusedError(template, most=MOST_CELLS)


class CellBudget:
    """Cells and characters that a file may still have: a large file may repeat one short text in very many cells."""

    def __init__(self, cells: int = MOST_CELLS) -> None:
        self._cells, self._characters = cells, MOST_CHARACTERS

    def take(self, texts: Iterable[str]) -> None:
        """Count the cells of a row; raises RefusedError for too many cells or characters."""
        for text in texts:
            self._cells -= 1
            self._characters -= len(text)
            if len(text) > LONGEST_TEXT:
                raise RefusedError(N_("a cell is longer than any number or heading"))
        if self._cells < 0:
            raise too_many_cells()
        if self._characters < 0:
            raise RefusedError(N_("the cells have more than {most} characters"), most=MOST_CHARACTERS)


def no_number(row: int, cell: str) -> RefusedError:
    """Error for a cell that is not a number, with the remedy for a formula or a merged cell."""
    template = N_("row {row}: {cell} is not a number")
    if cell.startswith("="):
        template = N_("row {row}: {cell} has no calculated value; open and save the table in the spreadsheet program")
    elif isinstance(cell, Merged):
        template = N_("row {row}: the cells {cell} are merged; write a number into each of them")
    return RefusedError(template, row=row, cell=cell[:40])


@dataclass(frozen=True, slots=True)
class Grid:
    """Rows of cells, all of one width, with the number of each row for the user.

    `counts` are the cells that each row had before it was filled up to that width. `notes` tell the user about
    surprises in the file.
    """

    rows: tuple[tuple[str, ...], ...]
    numbers: tuple[int, ...]
    separator: str = ""
    turned: bool = False
    counts: tuple[int, ...] = ()
    notes: tuple[Sentence, ...] = ()

    @property
    def width(self) -> int:
        """Number of columns."""
        return len(self.rows[0])

    @property
    def even(self) -> bool:
        """True where rows of different lengths are a sign of a wrong separator."""
        return self.separator in ("comma", "blanks", "blank")

    def transposed(self) -> "Grid":
        """Columns as rows."""
        columns = tuple(zip(*self.rows, strict=True))
        return Grid(columns, tuple(range(1, self.width + 1)), self.separator, True, notes=self.notes)


def grid_of(rows: Iterable[Sequence[str]], separator: str = "", numbers: Iterable[int] | None = None) -> Grid:
    """A table of rows that may differ in length; empty rows and empty columns at the end are left out.

    Raises RefusedError for an empty table, and for more cells than the longest cycle has.
    """
    room = CellBudget()
    full = list[tuple[int, Sequence[str], int]]()
    for number, row in zip(itertools.count(1) if numbers is None else numbers, rows, strict=False):
        if any(row):
            room.take(row)
            full.append((number, row, len(row)))
    if not full:
        raise RefusedError(N_("the text is empty"))
    if len(full) * max(len(row) for _, row, _ in full) > MOST_CELLS:
        raise too_many_cells()
    columns = list(zip_longest(*(row for _, row, _ in full), fillvalue=""))
    while not any(columns[-1]):
        columns.pop()
    cells = tuple(zip(*columns, strict=True))
    return Grid(cells, tuple(k for k, _, _ in full), separator, counts=tuple(width for _, _, width in full))


def grids_of(
    text: str,
    most_rows: int = MAXIMUM_PHASES,
    most_characters: int = MAXIMUM_CHARACTERS,
    numbers: Sequence[int] | None = None,
) -> list[Grid]:
    """The text's cells by each possible separator; raises RefusedError for an empty or too long text."""
    if len(text) > most_characters:
        raise RefusedError(N_("the text is too long: at most {most} characters"), most=most_characters)
    text = text.removeprefix("\ufeff")
    if not tidy(text):
        raise RefusedError(N_("the text is empty"))
    if sum(bool(line.strip()) for line in text.splitlines()) > most_rows + MOST_HEAD_ROWS:
        raise RefusedError(N_("there are more than {most} rows"), most=most_rows)
    hint = _HINT.match(text[: _HINT.longest])
    text = text[hint.end() :] if hint else text
    return [
        grid_of(([tidy(cell) for cell in row] for row in _rows(text, name)), name, numbers)
        for name in _separators(text)
    ]


def _separators(text: str) -> list[str]:
    """Names of the possible separators. A tab or a semicolon is never part of a number; a comma may be."""
    lines = [line for line in text.splitlines() if line.strip()]
    for name in ("tab", "semicolon"):
        if any(_parts(name, lines, begin) for begin in _begins(name, lines)):
            return [name]
    if _barred(lines):
        return ["bar"]
    separators = [name for name, mark in (("comma", ","), ("blanks", "  "), ("blank", " ")) if mark in text.strip()]
    return separators or ["tab"]


def _begins(name: str, lines: Sequence[str]) -> set[int]:
    """Lines where a table may begin: the first line, the first with a mark, and the first with two marks."""
    counts = [line.count(_MARKS[name]) for line in lines]
    return {next((k for k, count in enumerate(counts) if count >= least), 0) for least in (0, 1, 2)}


def _parts(name: str, lines: Sequence[str], begin: int) -> bool:
    """True where a mark is in most lines from line `begin` on, and in at least two of them unless `begin` is the first
    line.
    """
    count = sum(_MARKS[name] in line for line in lines[begin:])
    return count * 2 > len(lines) - begin and (begin == 0 or count >= 2)


def _barred(lines: Sequence[str]) -> bool:
    """True where bars make a table: equally many in each line, at least two. A single bar may be part of a cell."""
    counts = {line.count("|") for line in lines if not _is_rule(line.strip())}
    return len(counts) == 1 and counts.pop() >= 2


def _without_frame(line: str) -> str:
    """A line of a Markdown table without the bars at its ends; empty for the rule below the header."""
    line = line.strip()
    return "" if _is_rule(line) else line.removeprefix("|").removesuffix("|")


def _is_rule(line: str) -> bool:
    """True for the rule below the header of a Markdown table."""
    return "--" in line and not line.strip("-|:+ ")


def _rows(text: str, name: str) -> Iterator[list[str]]:
    if name == "bar":
        text = "\n".join(map(_without_frame, text.splitlines()))
    if name in _MARKS:
        try:
            yield from csv.reader(io.StringIO(text, newline=""), delimiter=_MARKS[name], skipinitialspace=True)
        except csv.Error:  # a cell beyond the module's limit
            raise RefusedError(N_("a cell is longer than any number or heading")) from None
    else:
        between = "  " if name == "blanks" else " "
        for line in text.replace("\r\n", "\n").replace("\r", "\n").split("\n"):
            yield [cell for part in line.strip(" \t").split(between) if (cell := part.strip(" "))]


def require_even(grid: Grid, first: int, head: int, apart: Collection[int] = ()) -> None:
    """Raise RefusedError where rows of the body, from `first` on, or the `head` rows above it differ in length although
    they must not; rows that stand `apart`, by their numbers, may have any length.
    """
    if not grid.even or not grid.counts:
        return
    counts = [min(count, grid.width) for count in grid.counts]  # a separator at the end of a row begins no cell
    usual = Counter(counts[first:]).most_common(1)[0][0]
    for number, count in list(zip(grid.numbers, counts, strict=True))[first - head :]:
        if count != usual and number not in apart:
            template = N_("row {row} has {cells} cells, others have {usual}")
            raise RefusedError(template, row=number, cells=count, usual=usual)

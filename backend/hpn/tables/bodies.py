"""Body of a table: its rows of numbers below the headings, and its rows named like sums or like titles."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from operator import itemgetter
from typing import NamedTuple

from hpn.tables.cells import LONGEST_CELL, Figure, held_of, is_blank, is_number, moment_of, seconds_between
from hpn.tables.headings import heading_of, heading_over, is_stop, is_total
from hpn.tables.heads import (
    MOST_COLUMNS,
    REQUIRED,
    Head,
    Names,
    head_of,
    is_comment,
    numbers_in,
    skipped,
    uncommented,
    upright,
)
from hpn.tables.sheets import Grid, RefusedError, require_even
from hpn.words.patterns import Pattern
from hpn.words.wording import N_, Sentence

DIVIDED = N_("row {row}: {cell} can be one number or two")
TOO_FEW = N_("row {row} has {cells} cells; a phase has torque, speed and duration at least")
_DIVIDED = Pattern("[0-9] [0-9]", LONGEST_CELL)
_LEADS = Pattern("[-+]?[1-9][0-9]{0,2}", LONGEST_CELL)
_FOLLOWS = Pattern("[0-9]{3}([.,][0-9]+)?", LONGEST_CELL)


class Labelled(NamedTuple):
    """A row set apart from the phases by its text: its number for the user, its cells, and the text."""

    number: int
    cells: tuple[str, ...]
    text: str


@dataclass(frozen=True, slots=True)
class TableBody:
    """Rows of numbers with their numbers for the user, the headings above each column, and the rows left out.

    `totals` are rows of numbers whose names may mean sums, means or extremes of the other rows; `titles` are rows of
    one text. Where every row may be a total, the totals are among the rows as well. Columns that are `dated` had dates
    with a time of day, and hold seconds since the first date; `scaled` has, by column, the shown and the held number of
    a cell. Rows whose texts may mean the emergency stop are among the others, with their texts in `stops`.
    """

    rows: tuple[tuple[str, ...], ...]
    numbers: tuple[int, ...]
    headings: tuple[tuple[str, ...], ...]
    notes: tuple[Sentence, ...]
    grid: Grid
    totals: tuple[Labelled, ...] = ()
    titles: tuple[Labelled, ...] = ()
    dated: frozenset[int] = frozenset()
    scaled: Mapping[int, tuple[str, str]] = field(default_factory=dict)
    stops: Mapping[int, str] = field(default_factory=dict)

    @property
    def headed(self) -> bool:
        """True where a text stands above the numbers."""
        return any(self.headings)

    @property
    def parting(self) -> tuple[Labelled, ...]:
        """Titles with rows of numbers above and below."""
        return tuple(title for title in self.titles if self.numbers[0] < title.number < self.numbers[-1])

    def including(self, more: Iterable[Labelled]) -> "TableBody":
        """The body with further rows in their places; several of these may have one number."""
        there = set(self.numbers)
        further = [(each.number, each.cells) for each in more if each.number not in there]
        pairs = sorted([*zip(self.numbers, self.rows, strict=True), *further], key=itemgetter(0))
        return replace(self, numbers=tuple(n for n, _ in pairs), rows=tuple(row for _, row in pairs))

    def of(self, places: Sequence[int]) -> "TableBody":
        """Some of the rows by their places, in this order."""
        return replace(self, numbers=tuple(self.numbers[k] for k in places), rows=tuple(self.rows[k] for k in places))

    def above(self, number: int) -> "TableBody":
        """The rows above a row number."""
        count = sum(each < number for each in self.numbers)
        totals = tuple(total for total in self.totals if total.number < number)
        return replace(self, numbers=self.numbers[:count], rows=self.rows[:count], totals=totals)


def body_of(grid: Grid, scales: str = "", *, named_in: Names | None = None) -> TableBody:
    """Rows of a table, the right way round; raises RefusedError where they make no table.

    `scales` tells which of two numbers counts where a workbook's format shows another number than the cell holds;
    `named_in` is that of `head_of`.
    """
    grid = upright(uncommented(grid))
    if grid.turned and grid.separator == "blank":
        _require_ungrouped(grid)
    if grid.width > MOST_COLUMNS:
        raise RefusedError(N_("there are more than {most} columns"), most=MOST_COLUMNS)
    head = head_of(grid, named_in=named_in)
    if head.end == len(grid.rows):
        raise _no_numbers(grid)
    apart = _rows_apart(grid, head)
    require_even(grid, head.end, head.count, apart)
    settled = _Settled(grid.rows[head.end :], head.headings, scales)
    notes = list(head.notes)
    rows, totals, titles, stops = list[Labelled](), list[Labelled](), list[Labelled](), dict[int, str]()
    for number, row in zip(grid.numbers[head.end :], settled.rows, strict=True):
        written, filled = [cell for cell in row if cell], [cell for cell in row if not is_blank(cell)]
        text = next((cell for cell in filled if not is_number(cell)), "")
        if number in apart and written != [text]:
            notes.append(skipped(number, " ".join(written)))
        elif not filled or written == [text]:
            titles += [Labelled(number, row, text)] if text else []
            notes += [skipped(number, " ".join(written))] if written else []
        else:
            _require_undivided(grid, number, filled)
            stop = next((cell for cell in filled if is_stop(cell)), "")
            stops |= {number: stop} if stop else {}
            (totals if is_total(text) and not stop else rows).append(Labelled(number, row, text))
    labelled = rows or totals
    if not labelled:
        raise RefusedError(N_("there is a header, but no row of numbers below it"))
    left_out = tuple(totals), tuple(titles)
    body = TableBody((), (), head.headings, tuple(notes), grid, *left_out, settled.dated, settled.scaled, stops)
    return body.including(labelled)


def _rows_apart(grid: Grid, head: Head) -> set[int]:
    """Numbers of rows below the header that are not part of the table: comments, repeated headers, lines of text."""
    apart = set()
    for k in range(head.end, len(grid.rows)):
        row = grid.rows[k]
        filled = [place for place, cell in enumerate(row) if not is_blank(cell)]
        again = len(filled) > 1 and all(row[place] in head.headings[place] for place in filled)
        alone = grid.separator == "comma" and filled == [0] and grid.counts[k : k + 1] == (1,) and not is_number(row[0])
        if is_comment(row) or again or alone:
            apart.add(grid.numbers[k])
    return apart


def _no_numbers(grid: Grid) -> RefusedError:
    """Error for a table without a row of numbers; names a misread number where a row has several cells with digits."""
    for number, row in zip(grid.numbers, grid.rows, strict=True):
        numbers = [cell for cell in row if any(map(str.isdigit, cell)) and not heading_of(cell).kind]
        wrong = next((cell for cell in numbers if not is_number(cell)), "")
        if len(numbers) >= 2 and sum(map(bool, row)) < len(REQUIRED):
            return RefusedError(TOO_FEW, row=number, cells=sum(map(bool, row)))
        if len(numbers) >= 2 and wrong:
            return RefusedError(N_("row {row}: {cell} is not a number"), row=number, cell=wrong[:40])
    return RefusedError(N_("there is a header, but no row of numbers below it"))


def _require_undivided(grid: Grid, number: int, cells: Sequence[str]) -> None:
    """Raise RefusedError for a blank between digits that may also end a column: `1 100,1 100,0` with decimal commas."""
    for cell in cells if grid.separator == "comma" else ():
        if _DIVIDED.search(cell) and is_number(cell):
            raise RefusedError(DIVIDED, row=number, cell=cell[:40])


def _require_ungrouped(grid: Grid) -> None:
    """Raise RefusedError where every line of a turned table may have a blank between thousands: `1 1 000`."""
    lines = [line for line in grid.transposed().rows if numbers_in(line)]
    pairs = [
        next((f"{a} {b}" for a, b in pairwise(line) if _LEADS.fullmatch(a) and _FOLLOWS.fullmatch(b)), None)
        for line in lines
    ]
    if pairs and None not in pairs:
        raise RefusedError(DIVIDED, row=1, cell=str(pairs[0]))


class _Settled:
    """Rows of cells with one number each: a date as its seconds, a number shown in thousands as the one that counts."""

    def __init__(self, rows: Sequence[tuple[str, ...]], headings: Sequence[Sequence[str]], scales: str) -> None:
        self.rows, self.dated, self.scaled = rows, frozenset[int](), dict[int, tuple[str, str]]()
        columns = list(zip(*rows, strict=True))
        changed = {}
        for place, cells in enumerate(columns):
            if not all(type(cell) is not Figure or held_of(cell) is None for cell in cells):
                changed[place] = [self._unscaled(place, cell, scales) for cell in cells]
            elif (dated := _seconds_since(cells)) and heading_over(headings[place]).may_be_time:
                changed[place], self.dated = dated, self.dated | {place}
        if changed:
            columns = [tuple(changed.get(place, cells)) for place, cells in enumerate(columns)]
            self.rows = list(zip(*columns, strict=True))

    def _unscaled(self, place: int, cell: str, scales: str) -> str:
        both = held_of(cell)
        if both is None:
            return cell
        self.scaled.setdefault(place, both)
        return Figure(both[scales == "held"])


def _seconds_since(cells: Sequence[str]) -> list[str]:
    """A column of moments as seconds since the first; empty without moments, or with numbers beside them."""
    moments = [moment_of(cell) for cell in cells]
    if not any(moment is not None for moment in moments) or any(map(is_number, cells)):
        return []
    return [
        cell if moment is None else Figure(f"{seconds_between(moments, moment)} s")
        for cell, moment in zip(cells, moments, strict=True)
    ]

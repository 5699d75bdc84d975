"""What the rows and columns of a table are: header, units, phases, sums, and of each column the quantity and its unit.

What has two readings is left blank here, and asked by `pasted`.
"""

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, pairwise
from typing import NamedTuple

from hpn.tables.cells import DECIMALS, entry, is_blank, is_meant_as_number, is_number
from hpn.tables.headings import INDEX, LONGEST, QUANTITIES, SUM, UNIT, Heading, heading_of, is_total
from hpn.tables.numbers import either
from hpn.tables.sheets import Grid, RefusedError, no_number, require_even
from hpn.words import units
from hpn.words.wording import N_, Sentence, Value

WIRE = {"T": "Nm", "n": "rpm", "t": "s", "FRi": "N", "FAi": "N", "Tpk": "Nm", "npk": "rpm", "Trms": "Nm"}
"""Link symbols of the columns of the duty table -> units of the wire."""

REQUIRED = ("T", "n", "t")
SKIP, CELLS = "skip", "cells"
"""Of a column: not read; each cell says its own unit."""

NUMBERS = N_("numbers the phases")

DIVIDED = N_("row {row}: {cell} can be one number or two")
_DIVIDED = re.compile("[0-9] [0-9]")
_LEADS, _FOLLOWS = re.compile("[-+]?[1-9][0-9]{0,2}"), re.compile("[0-9]{3}([.,][0-9]+)?")

HEAD_ROWS = 20
"""Rows among which the header is looked for."""

MOST_COLUMNS = 200
"""Columns that a table of phases or axes may have, once it has a row for each phase."""


@dataclass(frozen=True, slots=True)
class Choices:
    """What somebody has said about a table: blank where nothing is."""

    separator: str = ""
    phase: str = ""
    decimal: str = ""
    times: str = ""
    last: str = ""
    totals: str = ""
    parts: str = ""
    roles: Mapping[int, str] = field(default_factory=dict)
    units: Mapping[int, str] = field(default_factory=dict)


NO_CHOICES = Choices()


@dataclass(frozen=True, slots=True)
class Column:
    """A column: its place, its heading as written, what it is read as (blank: to be asked), and why it is skipped."""

    place: int
    heading: str
    role: str = ""
    unit: str = ""
    lasting: bool = False
    instant: bool = False
    skipped: Sentence | None = None
    text: bool = False

    @property
    def called(self) -> Value:
        """What a sentence calls it: its heading, else its number."""
        return Sentence(N_("“{heading}”"), {"heading": self.heading[:40]}) if self.heading else self.place + 1

    @property
    def quantity(self) -> str:
        """What its unit measures."""
        return QUANTITIES.get(self.role, "")


class Labelled(NamedTuple):
    """A row that its text sets apart from the phases: its number for the user, its cells, and the text."""

    number: int
    cells: tuple[str, ...]
    text: str


@dataclass(frozen=True, slots=True)
class Body:
    """Rows of numbers with their numbers for the user, the headings above each column, and what was left out.

    `totals` are rows of numbers by whose names they may be sums, means or extremes of the others, and `titles` rows of
    one text. Where every row may be a total, they are among the rows as well.
    """

    rows: tuple[tuple[str, ...], ...]
    numbers: tuple[int, ...]
    headings: tuple[tuple[str, ...], ...]
    notes: tuple[Sentence, ...]
    grid: Grid
    totals: tuple[Labelled, ...] = ()
    titles: tuple[Labelled, ...] = ()

    @property
    def headed(self) -> bool:
        """Whether anything stands above the numbers."""
        return any(self.headings)

    @property
    def parting(self) -> tuple[Labelled, ...]:
        """Titles with rows of numbers above and below."""
        return tuple(title for title in self.titles if self.numbers[0] < title.number < self.numbers[-1])

    def including(self, more: Iterable[Labelled]) -> "Body":
        """With further rows among the others, in their places."""
        rows = dict(zip(self.numbers, self.rows, strict=True)) | {each.number: each.cells for each in more}
        return replace(self, numbers=tuple(sorted(rows)), rows=tuple(rows[number] for number in sorted(rows)))

    def above(self, number: int) -> "Body":
        """What stands above a row."""
        count = sum(each < number for each in self.numbers)
        totals = tuple(total for total in self.totals if total.number < number)
        return replace(self, numbers=self.numbers[:count], rows=self.rows[:count], totals=totals)


def body_of(grid: Grid) -> Body:
    """Rows of a table, the right way round; raises RefusedError where they make no table."""
    grid = _upright(grid)
    if grid.turned and grid.separator == "blank":
        _require_ungrouped(grid)
    if grid.width > MOST_COLUMNS:
        raise RefusedError(N_("there are more than {most} columns"), most=MOST_COLUMNS)
    head, first, notes = _head(grid)
    if first == len(grid.rows):
        raise _no_numbers(grid)
    require_even(grid, first, len(head))
    rows, totals, titles = list[Labelled](), list[Labelled](), list[Labelled]()
    for number, row in zip(grid.numbers[first:], grid.rows[first:], strict=True):
        written, filled = [cell for cell in row if cell], [cell for cell in row if not is_blank(cell)]
        text = next((cell for cell in filled if not is_number(cell)), "")
        if not filled or written == [text]:
            titles += [Labelled(number, row, text)] if text else []
            notes += [skipped(number, " ".join(written))] if written else []
        else:
            _require_undivided(grid, number, filled)
            (totals if is_total(text) else rows).append(Labelled(number, row, text))
    found = rows or totals
    if not found:
        raise RefusedError(N_("there is a header, but no row of numbers below it"))
    headings = tuple(tuple(row[k] for row in head if row[k]) for k in range(grid.width))
    body = Body((), (), headings, tuple(notes), grid, tuple(totals), tuple(titles))
    return body.including(found)


def _no_numbers(grid: Grid) -> RefusedError:
    """Why there is no row of numbers: by a cell that may be meant as one, where a row has several."""
    for number, row in zip(grid.numbers, grid.rows, strict=True):
        meant = [cell for cell in row if any(map(str.isdigit, cell)) and not heading_of(cell).kind]
        if len(meant) >= 2:
            return RefusedError(N_("row {row}: {cell} is not a number"), row=number, cell=meant[0][:40])
    return RefusedError(N_("there is a header, but no row of numbers below it"))


def _require_undivided(grid: Grid, number: int, cells: Sequence[str]) -> None:
    """Raise RefusedError where a blank between digits may end a column as well: `1 100,1 100,0` with decimal commas."""
    for cell in cells if grid.separator == "comma" else ():
        if _DIVIDED.search(cell) and is_number(cell):
            raise RefusedError(DIVIDED, row=number, cell=cell[:40])


def _require_ungrouped(grid: Grid) -> None:
    """Raise RefusedError where every line of a turned table may have thousands in it that a blank parts: `1 1 000`."""
    lines = [line for line in grid.transposed().rows if _numbers_in(line)]
    pairs = [
        next((f"{a} {b}" for a, b in pairwise(line) if _LEADS.fullmatch(a) and _FOLLOWS.fullmatch(b)), None)
        for line in lines
    ]
    if pairs and None not in pairs:
        raise RefusedError(DIVIDED, row=1, cell=str(pairs[0]))


def skipped(number: int, text: str) -> Sentence:
    """What is said of a row that is left out."""
    return Sentence(N_("Row {row} is skipped: {text}"), {"row": number, "text": text[:60]})


def _upright(grid: Grid) -> Grid:
    """The table with a row per phase: turned where its first column names the quantities."""
    across = max(_named(row) for row in grid.rows[:HEAD_ROWS])
    if len(grid.rows) > HEAD_ROWS:
        return grid
    turned = grid.transposed()
    down = max(_named(row) for row in turned.rows[:HEAD_ROWS])
    if down < 2:
        return grid
    if across >= 2:
        raise RefusedError(N_("quantities are named both in a row and in a column: paste one table at a time"))
    return turned


def _named(row: Sequence[str]) -> int:
    """How many quantities a row names, by name or by unit."""
    found = set()
    for cell in row[:MOST_COLUMNS]:
        heading = heading_of(cell)
        if heading.kind in QUANTITIES:
            found.add(heading.kind)
        elif heading.kind == UNIT:
            quantities = _quantities(heading.unit)
            found |= {role for role in REQUIRED if QUANTITIES[role] in quantities}
    return len(found)


def _numbers_in(row: Sequence[str]) -> int:
    return sum(is_meant_as_number(cell) for cell in row)


def _head(grid: Grid) -> tuple[list[tuple[str, ...]], int, list[Sentence]]:
    """Rows of the header, the first row below it, and what stands above it and is skipped."""
    named = [_named(row) for row in grid.rows[:HEAD_ROWS]]
    notes: list[Sentence] = []
    first = named.index(max(named)) if max(named) >= 2 else 0
    for number, row in zip(grid.numbers[:first], grid.rows[:first], strict=True):
        if _numbers_in(row) >= 3:
            raise RefusedError(N_("row {row} has numbers above the header"), row=number)
        if sum(_named([cell]) > 0 or heading_of(cell).kind == UNIT for cell in row if cell) < 2:
            notes.append(skipped(number, " ".join(filter(None, row))))
    head = [row for row in grid.rows[:first] if sum(heading_of(cell).kind == UNIT for cell in row if cell) >= 2]
    end = first
    if max(named) >= 2:
        head.append(grid.rows[first])
        end += 1
        while end < len(grid.rows) and _continues(grid.rows[end]):
            head.append(grid.rows[end])
            end += 1
        return head, end, notes
    while end < len(grid.rows) and _numbers_in(row := grid.rows[end]) < min(2, sum(map(bool, row))):
        if sum(map(bool, row)) < 2 and grid.width > 2:
            notes.append(skipped(grid.numbers[end], " ".join(filter(None, row))))
        else:
            head.append(row)
        end += 1
    return head, end, notes


def _continues(row: Sequence[str]) -> bool:
    """Whether a row below the names of the quantities has units or further names in it, beside which a dash is none."""
    filled = [cell for cell in row if not is_blank(cell)]
    said = sum(heading_of(cell).kind in (*QUANTITIES, UNIT) for cell in filled)
    return bool(filled) and said >= min(2, len(filled))


# --- Columns ----------------------------------------------------------------------------------------------------------


def columns_of(body: Body, choices: Choices, assumed: Collection[str]) -> tuple[Column, ...]:
    """What each column is; `assumed` are the units of the wire that a column without a unit is taken to be in."""
    proposed = [_column(body, k) for k in range(body.grid.width) if any(not is_blank(row[k]) for row in body.rows)]
    numeric = [column for column in proposed if not column.text]
    if len(numeric) < 3:
        raise _too_few(body, proposed)
    if not body.headed:
        roles = _by_place(body, proposed)
        proposed = [replace(column, role=roles.get(column.place, column.role)) for column in proposed]
    doubled = {column.role for column in proposed if [other.role for other in proposed].count(column.role) > 1} - {SKIP}
    proposed = [replace(column, role="") if column.role in doubled else column for column in proposed]
    return tuple(_chosen(body, column, choices, assumed) for column in proposed)


def _too_few(body: Body, columns: Sequence[Column]) -> RefusedError:
    """Why there are not three columns of numbers."""
    for number, row in zip(body.numbers, body.rows, strict=True):
        wrong = next((cell for cell in row if not is_blank(cell) and not is_number(cell)), None)
        if wrong and len(columns) >= 3:
            return no_number(number, wrong)
    cells = sum(not is_blank(cell) for cell in body.rows[0])
    template = N_("row {row} has {cells} cells; a phase has torque, speed and duration at least")
    return RefusedError(template, row=body.numbers[0], cells=cells)


def _column(body: Body, place: int) -> Column:
    """A column by what stands above it."""
    heading = " ".join(" ".join(text.split()) for text in body.headings[place])[:LONGEST]
    cells = [row[place] for row in body.rows if not is_blank(row[place])]
    count = sum(map(is_number, cells))
    said = [heading_of(text) for text in body.headings[place]]
    names = {each.kind for each in said if each.kind != UNIT}
    kind = names.pop() if len(names) == 1 else "" if names else _by_unit(said)
    mostly = count == len(cells) if kind == INDEX else 2 * count > len(cells)
    measured = any(units.codes_for(each.unit) for each in said)
    if kind not in QUANTITIES and not measured and (count == 0 or (body.headed and not mostly)):
        return Column(place, heading, SKIP, skipped=Sentence(N_("text")), text=True)
    if body.headed and not heading and _counts(body, place):
        kind = INDEX
    if kind == INDEX and not in_steps(cells):
        kind = ""
    if kind in (INDEX, SUM):
        why = Sentence(NUMBERS) if kind == INDEX else Sentence(N_("a sum"))
        return Column(place, heading, SKIP, skipped=why)
    lasting, instant = any(each.lasting for each in said), any(each.instant for each in said)
    return Column(place, heading, kind, lasting=lasting, instant=instant)


def _by_unit(said: Sequence[Heading]) -> str:
    """Quantity that a unit alone stands for; a force may be radial or axial."""
    found = {quantity for each in said for quantity in _quantities(each.unit)}
    return next((role for role in REQUIRED if found == {QUANTITIES[role]}), "")


def _quantities(unit: str) -> set[str]:
    return {units.QUANTITY_OF[code] for code in units.codes_for(unit)}


def _by_place(body: Body, columns: Sequence[Column]) -> dict[int, str]:
    """Quantities of columns without a heading: by the units in their cells, else torque, speed, duration in order.

    Nothing is said of more than three columns, nor where the first may count the phases, or its texts name quantities.
    """
    numeric = [column.place for column in columns if not column.text]
    by_unit = {place: _by_unit([Heading(UNIT, unit) for unit in _units_in(body, place)]) for place in numeric}
    if any(_units_in(body, place) != {""} for place in numeric):
        return by_unit
    labelled = any(column.text for column in columns) and len(REQUIRED) <= len(body.rows) <= len(WIRE)
    if len(numeric) != 3 or labelled or _counts(body, numeric[0]):
        return {}
    return dict(zip(numeric, REQUIRED, strict=True))


def has_two_ways(body: Body) -> bool:
    """Whether a phase can be a row or a column: three rows of as many plain numbers or more, and nothing else."""
    places = range(body.grid.width)
    if body.headed or len(body.rows) != len(REQUIRED) or len(places) < len(REQUIRED) or _counts(body, 0):
        return False
    return all(map(is_number, chain.from_iterable(body.rows))) and all(_units_in(body, k) == {""} for k in places)


def _counts(body: Body, place: int) -> bool:
    """Whether a column of several rows goes 1, 2, 3 or 0, 1, 2."""
    cells = [row[place].removesuffix(".") for row in body.rows]
    return len(cells) > 1 and any(cells == [str(k + start) for k in range(len(cells))] for start in (0, 1))


def in_steps(cells: Sequence[str]) -> bool:
    """Whether numbers can number rows: 1, 2, 3 from wherever, or 10, 20, 30 from 0 or 10."""
    texts = [cell.removesuffix(".") for cell in cells]
    if not all(re.fullmatch("[0-9]{1,9}", text) for text in texts):
        return False
    numbers = [int(text) for text in texts]
    first, step = numbers[0], numbers[1] - numbers[0] if len(numbers) > 1 else 1
    even = all(after - before == step for before, after in pairwise(numbers))
    return even and (first in (0, step) or (step == 1 and len(numbers) > 1)) and step > 0


def _units_in(body: Body, place: int) -> set[str]:
    """Units behind the numbers of a column, a blank one for a number without."""
    found = set()
    for row in body.rows:
        read = next(filter(None, (entry(row[place], decimal) for decimal in DECIMALS)), None)
        if read is not None:
            found.add(read.unit)
    return found


def _chosen(body: Body, column: Column, choices: Choices, assumed: Collection[str]) -> Column:
    """A column with what somebody has said about it, and with its unit."""
    if column.text:
        return column
    role = choices.roles.get(column.place, "")
    if role in (*QUANTITIES, SKIP):
        column = replace(column, role=role, skipped=column.skipped if role == SKIP else None)
    if column.role not in QUANTITIES:
        return column
    unit = choices.units.get(column.place, "")
    known = unit in units.READ[column.quantity] or (unit == CELLS and "" not in _units_in(body, column.place))
    return replace(column, unit=unit if known else _unit(body, column, assumed))


def unit_question(body: Body, column: Column) -> Sentence:
    """What to ask where the unit of a column is open: any, or which of those that its heading may mean."""
    codes = {units.codes_for(heading_of(text).unit, column.quantity) for text in body.headings[column.place]} - {()}
    meant = codes.pop() if len(codes) == 1 else ()
    if len(meant) < 2:
        return Sentence(N_("Which unit is column {name} in?"), {"name": column.called})
    template = N_("Which unit is column {name} in? It can be {first} or {second}.")
    return Sentence(template, {"name": column.called, **either(meant)})


def is_angular(body: Body, column: Column) -> bool:
    """Whether a column of speeds has a name that leaves open what they are in."""
    return column.quantity == "speed" and any(heading_of(text).angular for text in body.headings[column.place])


def _unit(body: Body, column: Column, assumed: Collection[str]) -> str:
    """Unit of a column as its heading or its cells say it, else that of the wire if it may be assumed; else blank."""
    written = {heading_of(text).unit for text in body.headings[column.place]} - {""}
    if written:
        codes = {units.codes_for(unit, column.quantity) for unit in written}
        only = codes.pop() if len(codes) == 1 else ()
        return only[0] if len(only) == 1 else ""
    inside = _units_in(body, column.place)
    if inside == {""}:
        return WIRE[column.role] if WIRE[column.role] in assumed and not is_angular(body, column) else ""
    return "" if "" in inside else CELLS

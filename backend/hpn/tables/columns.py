"""What the rows and columns of a table are: header, units, phases, sums, and of each column the quantity and its unit.

What has two readings is left blank here, and asked by `pasted`.
"""

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, pairwise
from typing import TypeVar

from hpn.tables.bodies import Body
from hpn.tables.cells import DECIMALS, entry, is_blank, is_number
from hpn.tables.clocks import FORMAT
from hpn.tables.headings import INDEX, LONGEST, QUANTITIES, SUM, heading_over, quantities_of
from hpn.tables.heads import REQUIRED
from hpn.tables.sheets import RefusedError, no_number
from hpn.words import units
from hpn.words.wording import N_, Sentence, Value

WIRE = {"T": "Nm", "n": "rpm", "t": "s", "FRi": "N", "FAi": "N", "Tpk": "Nm", "npk": "rpm", "Trms": "Nm"}
"""Link symbols of the columns of the duty table -> units of the wire."""

SKIP, CELLS = "skip", "cells"
"""Of a column: not read; each cell says its own unit."""

NUMBERS = N_("numbers the phases")
UNKNOWN = N_("not recognised")


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
    scales: str = ""
    rest: str = ""
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
    doubled: bool = False

    @property
    def is_unknown(self) -> bool:
        """True where nothing says what it is, and it is asked; what two columns say is known of both."""
        return not self.role and not self.doubled

    @property
    def called(self) -> Value:
        """What a sentence calls it: its heading, else its number."""
        return Sentence(N_("“{heading}”"), {"heading": self.heading[:40]}) if self.heading else self.place + 1

    @property
    def quantity(self) -> str:
        """What its unit measures."""
        return QUANTITIES.get(self.role, "")


Kind = TypeVar("Kind", bound=Column)


def columns_of(body: Body, choices: Choices, assumed: Collection[str]) -> tuple[Column, ...]:
    """What each column is; `assumed` are the units of the wire that a column without a unit is taken to be in."""
    proposed = [_column(body, k) for k in range(body.grid.width) if any(not is_blank(row[k]) for row in body.rows)]
    numeric = [column for column in proposed if not column.text]
    if len(numeric) < 3:
        raise _too_few(body, proposed)
    if not body.headed:
        roles = _by_place(body, proposed)
        proposed = [replace(column, role=roles.get(column.place, column.role)) for column in proposed]
    return tuple(_with_unit(body, column, choices, assumed) for column in said_of(proposed, choices, tuple(QUANTITIES)))


def said_of(columns: Sequence[Kind], choices: Choices, roles: Collection[str]) -> list[Kind]:
    """Columns with what somebody has said about them; two of one role are asked for, unknown ones may be skipped."""
    known = [column.role for column in columns if column.role not in ("", SKIP)]
    return [_said_of(replace(column, doubled=known.count(column.role) > 1), choices, roles) for column in columns]


def _said_of(column: Kind, choices: Choices, roles: Collection[str]) -> Kind:
    if column.doubled:
        column = replace(column, role="")
    role = "" if column.text else choices.roles.get(column.place, "")
    if role == SKIP or role in roles:
        return replace(column, role=role, skipped=column.skipped if role == SKIP else None)
    if column.is_unknown and choices.rest == SKIP:
        return replace(column, role=SKIP, skipped=Sentence(UNKNOWN))
    return column


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
    said = heading_over(body.headings[place])
    kind = said.kind if said.name else by_units(said.units)
    mostly = count == len(cells) if kind == INDEX else 2 * count > len(cells)
    if kind not in QUANTITIES and not said.codes and (count == 0 or (body.headed and not mostly)):
        return Column(place, heading, SKIP, skipped=Sentence(N_("text")), text=True)
    if body.headed and not heading and _counts(body, place):
        kind = INDEX
    if kind == INDEX and not in_steps(cells):
        kind = ""
    if kind in (INDEX, SUM):
        why = Sentence(NUMBERS) if kind == INDEX else Sentence(N_("a sum"))
        return Column(place, heading, SKIP, skipped=why)
    return Column(place, heading, kind, lasting=said.lasting, instant=said.instant or place in body.dated)


def by_units(written: Collection[str]) -> str:
    """Quantity that units alone stand for; a force may be radial or axial."""
    found = {quantity for unit in written for quantity in quantities_of(unit)}
    return next((role for role in REQUIRED if found == {QUANTITIES[role]}), "")


def _by_place(body: Body, columns: Sequence[Column]) -> dict[int, str]:
    """Quantities of columns without a heading: by the units in their cells, else torque, speed, duration in order.

    Nothing is said of more than three columns, nor where the first may count the phases, or its texts name quantities.
    """
    numeric = [column.place for column in columns if not column.text]
    by_unit = {place: by_units(_units_in(body, place)) for place in numeric}
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


def _with_unit(body: Body, column: Column, choices: Choices, assumed: Collection[str]) -> Column:
    """A column with its unit, as somebody has said it or as it is written."""
    if column.role not in QUANTITIES:
        return column
    unit = choices.units.get(column.place, "")
    known = unit in units.READ[column.quantity] or (unit == CELLS and "" not in _units_in(body, column.place))
    return replace(column, unit=unit if known else _unit(body, column, assumed))


def is_angular(body: Body, column: Column) -> bool:
    """Whether a column of speeds has a name that leaves open what they are in."""
    return column.quantity == "speed" and heading_over(body.headings[column.place]).angular


def _unit(body: Body, column: Column, assumed: Collection[str]) -> str:
    """Unit of a column as its heading or its cells say it, else that of the wire if it may be assumed; else blank."""
    inside = _units_in(body, column.place)
    written = heading_over(body.headings[column.place]).units
    if any(map(FORMAT.fullmatch, written)):
        return "" if "" in inside else CELLS
    if written:
        return unit_by(written, column.quantity)
    if inside == {""}:
        return WIRE[column.role] if WIRE[column.role] in assumed and not is_angular(body, column) else ""
    return "" if "" in inside else CELLS


def unit_by(written: Collection[str], quantity: str) -> str:
    """Code of the unit that is written above a column, blank where that are several or it has two readings."""
    codes = {units.codes_for(unit, quantity) for unit in written}
    only = codes.pop() if len(codes) == 1 else ()
    return only[0] if len(only) == 1 else ""

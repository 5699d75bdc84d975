"""Columns of a table: the input that each one holds, and the unit of its numbers.

Anything with two readings stays blank here; `interpreter` asks about it.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby, pairwise

from hpn.tables.bodies import TableBody
from hpn.tables.cells import DECIMALS, TIME_FORMAT, entry, is_blank, is_number
from hpn.tables.factors import has_factor
from hpn.tables.headings import (
    INDEX,
    LONGEST,
    LONGEST_WRITTEN,
    QUANTITIES,
    SUM,
    heading_of,
    heading_over,
    parts_of,
    quantities_of,
)
from hpn.tables.heads import REQUIRED
from hpn.tables.inputs import NAME, Input, Inputs
from hpn.words import spellings, units
from hpn.words.patterns import Pattern
from hpn.words.wording import N_, Sentence, Value

SKIP, CELLS = "skip", "cells"
"""Role of a column that is not read; unit of a column whose cells name their own units."""

_COUNT = Pattern("[0-9]{1,9}", 9)

NUMBERS = N_("numbers the phases")
UNKNOWN = N_("not recognised")
MOTOR = Sentence(N_("of the motor’s side"))


@dataclass(frozen=True, slots=True)
class Choices:
    """Answers to the questions about a table, blank where there is none. `of` is the mark of the content they belong
    to.
    """

    of: str = ""
    sheet: str = ""
    separator: str = ""
    phase: str = ""
    decimal: str = ""
    times: str = ""
    last: str = ""
    falls: str = ""
    side: str = ""
    stop: str = ""
    totals: str = ""
    parts: str = ""
    scales: str = ""
    loads: str = ""
    rest: str = ""
    twins: str = ""
    zeros: str = ""
    blanks: str = ""
    points: str = ""
    roles: Mapping[int, str] = field(default_factory=dict)
    units: Mapping[int, str] = field(default_factory=dict)


NO_CHOICES = Choices()
ANY = "*"
"""Mark of answers that fit any content they are sent with."""


@dataclass(frozen=True, slots=True)
class Column:
    """A column: its place, its heading as written, its role (blank: to be asked), and why it is skipped.

    `foreign` is the unit in its heading where only another unit can be read. `of_motor` is True where its name has a
    word of the motor, and `likely` is its role if the values are at the output.
    """

    place: int
    heading: str
    role: str = ""
    unit: str = ""
    lasting: bool = False
    instant: bool = False
    skipped: Sentence | None = None
    text: bool = False
    doubled: bool = False
    input: Input | None = None
    foreign: str = ""
    of_motor: bool = False
    likely: str = ""

    @property
    def is_unknown(self) -> bool:
        """True where its content is unknown; the role of two columns that share one is known."""
        return not self.role and not self.doubled

    @property
    def called(self) -> Value:
        """Its heading for a sentence, else its number."""
        return Sentence(N_("“{heading}”"), {"heading": self.heading[:40]}) if self.heading else self.place + 1

    @property
    def quantity(self) -> str:
        """Quantity that its unit measures, blank without a choice of units."""
        return self.input.quantity if self.input else ""

    @property
    def is_number(self) -> bool:
        """True where its cells hold one number each."""
        return self.input is not None and self.input.is_number

    @property
    def numbers_phases(self) -> bool:
        """True where it is skipped because its cells number the rows."""
        return self.role == SKIP and self.skipped is not None and self.skipped.template == NUMBERS


def proposed(body: TableBody, inputs: Inputs) -> list[Column]:
    """Columns that are not empty, by the texts above them."""
    places = range(body.grid.width)
    return [_proposed(body, place, inputs) for place in places if any(not is_blank(row[place]) for row in body.rows)]


def _proposed(body: TableBody, place: int, inputs: Inputs) -> Column:
    headings = body.headings[place]
    heading = " ".join(" ".join(text.split()) for text in headings)[:LONGEST]
    cells = [row[place] for row in body.rows if not is_blank(row[place])]
    over = heading_over(headings)
    kind = inputs.kind_of(headings, over)
    if inputs.has_axes and kind == "t" and over.codes == {"h"}:
        kind = ""  # hours may be a phase's duration or a required life
    if not over.name and not inputs.has_axes:
        kind = by_units(over.units)
    known = (*inputs.by_role, INDEX, SUM) if inputs.has_axes else inputs.by_role
    if kind not in known and not over.codes and _is_text(cells, kind, body.headed and not inputs.has_axes):
        return Column(place, heading, SKIP, skipped=Sentence(N_("text")), text=not inputs.has_axes)
    if body.headed and not heading and counts(body, place):
        kind = INDEX
    if kind == INDEX and not (numbers_axes(cells) if inputs.has_axes else in_steps(cells)):
        kind = ""
    if kind in (INDEX, SUM):
        why = Sentence(NUMBERS) if kind == INDEX else Sentence(N_("a sum"))
        return Column(place, heading, SKIP, skipped=why)
    likely = "" if kind else over.likely
    instant = over.instant or place in body.dated
    return Column(place, heading, kind, lasting=over.lasting, instant=instant, of_motor=over.of_motor, likely=likely)


def _is_text(cells: Sequence[str], kind: str, named: bool) -> bool:
    """True where no cell is a number, or below a header too few: at most half, or for an index not all."""
    count = sum(map(is_number, cells))
    few = count < len(cells) if kind == INDEX else 2 * count <= len(cells)
    return count == 0 or (named and few)


def by_units(written: Collection[str]) -> str:
    """Quantity that units alone imply; blank for a force, which may be radial or axial."""
    quantities = {quantity for unit in written for quantity in quantities_of(unit)}
    return next((role for role in REQUIRED if quantities == {QUANTITIES[role]}), "")


def counts(body: TableBody, place: int) -> bool:
    """True for a column of several rows that counts 1, 2, 3 or 0, 1, 2."""
    cells = [row[place].removesuffix(".") for row in body.rows]
    return len(cells) > 1 and any(cells == [str(k + start) for k in range(len(cells))] for start in (0, 1))


def in_steps(cells: Sequence[str]) -> bool:
    """True for numbers that can number rows: 1, 2, 3 from any start, or 10, 20, 30 from 0 or 10."""
    texts = [cell.removesuffix(".") for cell in cells]
    if not all(map(_COUNT.fullmatch, texts)):
        return False
    numbers = [int(text) for text in texts]
    first, step = numbers[0], numbers[1] - numbers[0] if len(numbers) > 1 else 1
    even = all(after - before == step for before, after in pairwise(numbers))
    return even and (first in (0, step) or (step == 1 and len(numbers) > 1)) and step > 0


def numbers_axes(cells: Sequence[str]) -> bool:
    """True for cells that can number axes, over all rows or anew for each axis: texts, or numbers in steps."""
    texts = [cell.removesuffix(".") for cell, _ in groupby(cells)]
    if not all(map(is_number, cells)):
        return True
    if not all(map(_COUNT.fullmatch, texts)):
        return False
    back = [k for k, (before, after) in enumerate(pairwise(map(int, texts)), start=1) if after < before]
    return all(in_steps(texts[start:end]) for start, end in pairwise([0, *back, len(texts)]))


# --- With answers and units -------------------------------------------------------------------------------------------


def settled(
    columns: Sequence[Column], body: TableBody, inputs: Inputs, choices: Choices, assumed: Collection[str]
) -> tuple[Column, ...]:
    """Columns with the answers about them and with their units.

    Two columns of one role are asked; `rest` may skip unknown ones. `assumed` are the wire's units that a column
    without a unit may be in; for motors only where the heading was understood, since it may otherwise name another
    unit.
    """
    if choices.side in SIDES:
        present = {column.role for column in columns}
        columns = [_on_side(column, choices.side, present) for column in columns]
    roles = [column.role for column in columns if column.role not in ("", SKIP)]
    fitting = [
        _with_answer(replace(column, doubled=roles.count(column.role) > 1), inputs.by_role, choices)
        for column in columns
    ]
    known = (assumed if column.role or not inputs.has_motors else () for column in columns)
    return tuple(_with_unit(column, body, inputs, choices, own) for column, own in zip(fitting, known, strict=True))


SIDES: Mapping[str, str] = {
    "output": N_("of the gear’s output"),
    "motor": N_("of the motor or the gear’s input: not read"),
}


def _on_side(column: Column, side: str, roles: Collection[str]) -> Column:
    """A column named after the motor, by the answer which shaft its values belong to; other columns already have
    `input`.
    """
    if not column.likely or (side == "output" and column.likely in roles):
        return column
    return replace(column, role=column.likely if side == "output" else SKIP, skipped=MOTOR if side == "motor" else None)


def _with_answer(column: Column, roles: Collection[str], choices: Choices) -> Column:
    if column.doubled:
        column = replace(column, role="")
    role = choices.roles.get(column.place, "")
    if role == SKIP or (role in roles and (role == NAME.role or not column.text)):
        return replace(column, role=role, skipped=column.skipped if role == SKIP else None)
    if column.is_unknown and choices.rest == SKIP:
        return replace(column, role=SKIP, skipped=Sentence(UNKNOWN))
    return column


def _with_unit(column: Column, body: TableBody, inputs: Inputs, choices: Choices, assumed: Collection[str]) -> Column:
    """A column with its input and its unit, as answered or as written."""
    input_ = inputs.by_role.get(column.role)
    if input_ is None:
        return column
    headings = body.headings[column.place]
    column = replace(column, input=input_, unit=input_.unit)
    if not column.quantity:
        return replace(column, foreign=_foreign_unit(headings, input_))
    inside = units_in(body, column.place, any_unit=inputs.has_axes)
    unit = choices.units.get(column.place, "")
    if unit in units.READ[column.quantity] or (unit == CELLS and "" not in inside):
        return replace(column, unit=unit)
    if any(map(has_factor, headings)):
        return replace(column, unit="")
    written = written_units(headings, input_.unit) | _further_units(headings, column.quantity)
    if written and not any(map(TIME_FORMAT.fullmatch, written)):
        return replace(column, unit=input_.unit if written == {input_.unit} else _unit_by(written, column.quantity))
    if written or inside - {""}:
        return replace(column, unit="" if "" in inside else CELLS)
    angular = column.quantity == "speed" and heading_over(headings).angular
    return replace(column, unit=input_.unit if input_.unit in assumed and not angular else "")


def units_in(body: TableBody, place: int, *, any_unit: bool = False) -> set[str]:
    """Units behind the numbers of a column, with a blank for a number without a unit."""
    units = set()
    for row in body.rows:
        cell = next(filter(None, (entry(row[place], decimal, any_unit=any_unit) for decimal in DECIMALS)), None)
        if cell is not None:
            units.add(cell.unit)
    return units


def written_units(headings: Sequence[str], wire: str) -> set[str]:
    """Units in the texts above a column, also a unit of the wire at the end of a name: `Dauer ms`, `duration_s`."""
    return {_written_unit(text, wire) for text in headings} - {""} | heading_over(headings).units


def _written_unit(text: str, wire: str) -> str:
    if text.strip().casefold().endswith(f"_{wire}".casefold()):
        return wire
    return heading_of(text).unit or parts_of(text)[1]


def _further_units(headings: Sequence[str], quantity: str) -> set[str]:
    """Further units of a quantity in the texts above a column, beside the first, as in `Nm (lb·in)`."""
    names = [name for name, unit in map(parts_of, headings) if unit]
    return {unit for _, unit in map(parts_of, names) if spellings.codes_for(unit, quantity)}


def _unit_by(written: Collection[str], quantity: str) -> str:
    """Code of the unit above a column, blank for several units and for a unit with two readings."""
    codes = {spellings.codes_for(unit, quantity) for unit in written}
    only = codes.pop() if len(codes) == 1 else ()
    return only[0] if len(only) == 1 else ""


_UNIT = Pattern(r"[%‰/²³^·*]|[0-9]{2}|[A-Za-z][0-9]", LONGEST_WRITTEN)
"""Signs that occur in unknown units, but not in words."""

_AS_PLAIN = str.maketrans({"²": "2", "³": "3", **dict.fromkeys(" ·*^.⋅", "")})


def _foreign_unit(headings: Sequence[str], input_: Input) -> str:
    """Foreign unit above a column with only one possible unit; blank without one."""
    if input_.kind in ("text", "curve"):
        return ""
    own = {input_.unit, _plain(units.SYMBOLS.get(input_.unit, ""))} - {""}
    others = {_written_unit(text, input_.unit or "1") for text in headings} - {"1"}
    strange = [unit for unit in sorted(others) if unit not in own and _plain(unit) not in own]
    return next((unit for unit in strange if _UNIT.search(unit) or spellings.codes_for(unit)), "")


def _plain(unit: str) -> str:
    return unit.casefold().translate(_AS_PLAIN)

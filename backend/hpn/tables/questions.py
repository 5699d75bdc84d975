"""Questions and refusals that tables of phases and of axes have in common."""

from collections.abc import Iterable

from hpn.tables.bodies import Body
from hpn.tables.cells import LONGEST_CELL, is_number
from hpn.tables.clocks import PARTED
from hpn.tables.columns import Choices, Column
from hpn.tables.headings import heading_over
from hpn.tables.numbers import either, known_units, split_unit
from hpn.tables.sheets import RefusedError, no_number
from hpn.words import units
from hpn.words.wording import N_, Sentence

MISSING = {
    "T": N_("Which column is the torque?"),
    "n": N_("Which column is the speed?"),
    "t": N_("Which column is the duration?"),
}

SCALES = ("shown", "held")
"""Which numbers count where a format of a workbook shows thousands of what its cells hold."""


def unit_question(body: Body, column: Column) -> Sentence:
    """What to ask where the unit of a column is open: which of two, or which at all where another is written."""
    written = heading_over(body.headings[column.place]).units
    codes = {units.codes_for(unit, column.quantity): unit for unit in sorted(written)}
    meant, spelled = next(iter(codes.items())) if len(codes) == 1 else ((), "")
    if len(meant) > 1:
        template = N_("Which unit is column {name} in? It can be {first} or {second}.")
        return Sentence(template, {"name": column.called, **either(meant, spelled)})
    unknown = next((unit for unit in sorted(written) if not units.codes_for(unit, column.quantity)), "")
    if unknown:
        template = N_("Which unit is column {name} in? {unit} is none that is known; known are {units}.")
        listed = known_units(column.quantity)
        return Sentence(template, {"name": column.called, "unit": unknown[:20], "units": listed})
    return Sentence(N_("Which unit is column {name} in?"), {"name": column.called})


def no_number_of(row: int, cell: str, column: Column) -> RefusedError:
    """Why a cell is no number of a column, and what would be right: a unit that is known, a time that is one alone."""
    if column.role == "t" and PARTED.fullmatch(cell):
        template = N_("row {row}: {cell} may be hours or minutes; write {first} or {second}")
        return RefusedError(template, row=row, cell=cell, first=f"{cell}:00", second=f"0:{cell:0>5}")
    if unit_behind(cell):
        template = N_("row {row}: {cell} is not a number with a unit that is known here: {units}")
        return RefusedError(template, row=row, cell=cell[:40], units=known_units(column.quantity))
    return no_number(row, cell)


def unit_behind(cell: str) -> str:
    """Letters behind a number as its unit, blank for any other cell."""
    number, unit = split_unit(cell) if len(cell) <= LONGEST_CELL else ("", "")
    return unit if unit[:1].isalpha() and is_number(number) else ""


def scaled_in(body: Body, columns: Iterable[Column]) -> tuple[str, str] | None:
    """What a cell of some columns shows, and what it holds, where a format leaves open which of the two counts."""
    return next((body.scaled[column.place] for column in columns if column.place in body.scaled), None)


def scale_question(scaled: tuple[str, str] | None, choices: Choices) -> list[Sentence]:
    """Question for numbers that a workbook shows in thousands without saying so, as long as it is open."""
    if scaled is None or choices.scales in SCALES:
        return []
    template = N_("The workbook shows {shown} where the cell holds {held}. Which number counts?")
    return [Sentence(template, dict(zip(("shown", "held"), scaled, strict=True)))]


def require_moments(body: Body, places: Iterable[int], times: str) -> None:
    """Raise RefusedError for dates that are taken as durations, or as ends where nothing says when the first began."""
    dated = not body.dated.isdisjoint(places)
    if dated and times == "durations":
        raise RefusedError(N_("dates say when a phase is, and not how long it lasts"))
    if dated and times == "ends":
        raise RefusedError(N_("dates of ends don’t say when the first phase starts: give the dates of starts"))

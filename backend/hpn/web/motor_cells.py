"""Motors of a list as the cells of a sheet, and the table that typed cells become for the one reader of tables."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from decimal import Decimal
from itertools import zip_longest
from typing import NamedTuple

from hpn.application import MotorEntry
from hpn.tables.cells import tidy
from hpn.tables.columns import ANY
from hpn.tables.curve_text import CurveText, curve_text
from hpn.tables.files import TableBounds
from hpn.tables.inputs import Input
from hpn.tables.motor_inputs import MOTORS, NAME
from hpn.tables.motor_points import POINT, POINTS
from hpn.tables.table import Table
from hpn.web.door.problems import Problem
from hpn.web.motor_tables import BOUNDS, written
from hpn.words.patterns import Pattern
from hpn.words.reader import Reader
from hpn.words.units import symbol_of_code
from hpn.words.wording import N_, Sentence, first_of

COLUMNS: Mapping[str, Input] = {
    role: MOTORS.by_role[role] for role in (NAME, "Tmn", "Tm", "Tst", "nmr", "nm", "Jm", "mmo")
}
"""Columns of a sheet by their fields; the field CURVE behind them has the points of a torque curve."""

CURVE = "mcv"
UNITS: Mapping[str, str] = {"Jm": "kg_cm2"}
"""Units of columns that data sheets give in another unit than the wire has; its power of ten follows."""
_POWER = {"Jm": 4}

MOST_ROWS = 301
"""Rows of a sheet with its empty last one; a longer list is edited as text."""

MOST_NAMED = 8
TOO_LONG = N_("a sheet has up to {most} rows: edit a longer list as text")
NAMELESS = N_("Rows without a name: {rows}.")
NAMED_TWICE = N_("Rows with one name, {name}, of which one has torque-speed points: {rows}.")
UNREAD = N_("Not saved: correct these rows, or remove them: {rows}.")

CellRow = tuple[str, ...]
"""Texts of a row's cells, by COLUMNS and CURVE."""

BLANK: CellRow = ("",) * (len(COLUMNS) + 1)


class SheetTable(NamedTuple):
    """Table text of a sheet, and its limits with the number of the sheet's row for each of its lines."""

    text: str
    bounds: TableBounds


def unit_of(role: str, reader: Reader) -> str:
    """Symbol of a column's unit in a reader's language, blank for the name; sheets keep the units of data sheets."""
    code = UNITS.get(role, COLUMNS[role].unit)
    return reader.text(symbol_of_code(code)) if code else ""


def rows_of(motors: Iterable[MotorEntry], decimal: str) -> tuple[CellRow, ...]:
    """Cells of motors, with a reader's decimal mark."""
    return tuple(_row_of(motor, decimal) for motor in motors)


def _row_of(motor: MotorEntry, decimal: str) -> CellRow:
    _, *figures = COLUMNS
    cells = [_cell(getattr(motor, COLUMNS[role].place), decimal, _POWER.get(role, 0)) for role in figures]
    points = [tuple(_cell(getattr(point, field), decimal) for field in POINT.values()) for point in motor.curve or ()]
    return (motor.designation, *cells, CurveText(points).for_field)


_GROUPED = Pattern(r"[1-9][0-9]{0,2}\.[0-9]{3}", 40)
"""Number whose decimal mark may separate thousands: a further 0 makes it plain."""


def _cell(value: float | None, decimal: str, power: int = 0) -> str:
    if value is None:
        return ""
    exact = Decimal(str(value)).scaleb(power)
    text = f"{exact.normalize():f}"
    return (f"{text}0" if _GROUPED.fullmatch(text) else text).replace(".", decimal)


# --- Typed cells ------------------------------------------------------------------------------------------------------


def rows_in(fields: Iterable[tuple[str, str]]) -> tuple[CellRow, ...] | None:
    """Rows typed into a sheet, without blank ones at its end; None for fields of another form. Raises Problem 422."""
    cells: dict[str, list[str]] = {name: [] for name in (*COLUMNS, CURVE)}
    for name, text in fields:
        if name in cells:
            cells[name].append(text.strip() if name == CURVE else " ".join(text.split()))
    if not cells[NAME]:
        return None
    rows = list(zip_longest(*cells.values(), fillvalue=""))
    while rows and not any(rows[-1]):
        rows.pop()
    if len(rows) > MOST_ROWS:
        raise Problem(422, Sentence(TOO_LONG, {"most": MOST_ROWS - 1}))
    return tuple(rows)


def without(rows: Sequence[CellRow], number: str) -> tuple[CellRow, ...]:
    """Rows without one of them, by its number."""
    return tuple(row for place, row in enumerate(rows, 1) if str(place) != number)


def faults_of(rows: Sequence[CellRow]) -> list[Sentence]:
    """Faults of a sheet that its table text would hide, where a row may be a further point of the row above."""
    typed = [(number, _name(row), row[-1]) for number, row in enumerate(rows, 1) if any(row)]
    faults = list[Sentence]()
    if nameless := [number for number, name, _ in typed if not name]:
        faults.append(Sentence(NAMELESS, {"rows": first_of(nameless, MOST_NAMED)}))
    named: dict[str, list[int]] = {}
    for number, name, _ in typed:
        named.setdefault(name, []).append(number)
    for name in dict.fromkeys(name for _, name, curve in typed if curve and name):
        if len(named[name]) > 1:
            values = {"name": name[:60], "rows": first_of(named[name], MOST_NAMED)}
            faults.append(Sentence(NAMED_TWICE, values))
    return faults


def table_of(rows: Sequence[CellRow], reader: Reader) -> SheetTable:
    """Table of a sheet: a header with a reader's names, a line for each row, and one for each further point."""
    has_points = any(row[-1] for row in rows)
    head = [_heading(COLUMNS[role], unit_of(role, reader), reader) for role in COLUMNS]
    of_points = [_heading(MOTORS.by_role[role], reader.text(MOTORS.by_role[role].unit), reader) for role in POINTS]
    lines: list[Sequence[str]] = [[*head, *(of_points if has_points else ())]]
    numbers = [0]
    for number, row in enumerate(rows, 1):
        if not any(row):
            continue
        figures = row[:-1]
        for point in curve_text(row[-1]).points or [()]:
            speed, continuous, *peak = (*point, *[""] * (len(POINTS) - len(point)))
            lines.append([*figures, *((speed, continuous, ":".join(peak)) if has_points else ())])
            numbers.append(number)
            figures = (row[0], *[""] * (len(COLUMNS) - 1))
    return SheetTable(written(lines), replace(BOUNDS, numbers=tuple(numbers)))


def _heading(input_: Input, unit: str, reader: Reader) -> str:
    name = reader.text(input_.named.name)
    return f"{name} [{unit}]" if unit else name


def answers() -> dict[str, str]:
    """Answers to the questions that a sheet has no need of: the figures of its columns, and its blank cells."""
    places = [*COLUMNS, *POINTS]
    roles = {f"r{place}": role for place, role in enumerate(places)}
    units = {f"u{place}": UNITS.get(role, MOTORS.by_role[role].unit) for place, role in enumerate(places[1:], 1)}
    return {**roles, **units, "of": ANY, "blanks": "unknown"}


def unread(rows: Sequence[CellRow], table: Table, motors: Sequence[MotorEntry]) -> tuple[int, ...]:
    """Numbers of typed rows that became no motor, though no answer leaves any out."""
    if any(choice.chosen in ("skip", "motors") for choice in table.choices):
        return ()
    taken = {number for motor in motors for number in table.origins.get(motor.designation, ())}
    names = {_name(rows[number - 1]) for number in taken}
    return tuple(number for number, row in enumerate(rows, 1) if any(row) and _name(row) not in names)


def _name(row: CellRow) -> str:
    """Name of a row's motor, as the reader of tables takes it."""
    return " ".join(tidy(row[0]).split())[:100]

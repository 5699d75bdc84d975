"""Columns of a table with one cycle, by their headings, else by their units or places; one may name the phases."""

from collections.abc import Collection, Sequence
from dataclasses import replace
from itertools import chain

from hpn.tables.bodies import TOO_FEW, TableBody
from hpn.tables.cells import is_blank, is_number, moment_of
from hpn.tables.columns import Choices, Column, by_units, counts, proposed, settled, units_in
from hpn.tables.headings import is_name, is_remark
from hpn.tables.heads import REQUIRED
from hpn.tables.inputs import CYCLE, NAME, PHASE_ROLES
from hpn.tables.sheets import RefusedError, no_number
from hpn.words.titles import LONGEST_NAME, is_title


def columns_of(body: TableBody, choices: Choices, assumed: Collection[str]) -> tuple[Column, ...]:
    """Columns with the answers about them and with their units; raises RefusedError for fewer than three numeric
    columns.
    """
    columns = proposed(body, CYCLE)
    if sum(not column.text for column in columns) < len(REQUIRED):
        raise _too_few(body, columns)
    if not body.headed:
        roles = _by_place(body, columns)
        columns = [replace(column, role=roles.get(column.place, column.role)) for column in columns]
    if named := _column_of_names(columns, body):
        columns = [replace(c, role=NAME.role, skipped=None) if c is named else c for c in columns]
    return settled(columns, body, CYCLE, choices, assumed)


def _column_of_names(columns: Sequence[Column], body: TableBody) -> Column | None:
    """Column that names the phases, unless an answer says otherwise; None without one.

    It is the column with this service's own heading, else a column of texts whose heading means a name, else the first
    column of texts, remarks last. At least half of its cells are filled, all may be names, and they are not all the
    same.
    """
    candidates = []
    for column in columns:
        if column.heading == NAME.place:
            return column
        cells = [row[column.place] for row in body.rows]
        filled = [cell for cell in cells if not is_blank(cell)]
        tells_apart = 2 * len(filled) >= len(cells) and len(set(filled)) >= min(len(cells), 2)
        is_time = any(map(moment_of, filled))
        if column.text and tells_apart and not is_time and all(is_title(cell, LONGEST_NAME) for cell in cells):
            candidates.append(column)
    return min(candidates, key=lambda column: (is_remark(column.heading), not is_name(column.heading)), default=None)


def _too_few(body: TableBody, columns: Sequence[Column]) -> RefusedError:
    """Error for fewer than three columns of numbers."""
    for number, row in zip(body.numbers, body.rows, strict=True):
        wrong = next((cell for cell in row if not is_blank(cell) and not is_number(cell)), None)
        if wrong and len(columns) >= len(REQUIRED):
            return no_number(number, wrong)
    cells = sum(not is_blank(cell) for cell in body.rows[0])
    return RefusedError(TOO_FEW, row=body.numbers[0], cells=cells)


def _by_place(body: TableBody, columns: Sequence[Column]) -> dict[int, str]:
    """Quantities of columns without a heading: by the units in their cells, else torque, speed, duration in order.

    Empty for any number of columns but three, where the first may count the phases, or where texts may name quantities.
    """
    numeric = [column.place for column in columns if not column.text]
    inside = {place: units_in(body, place) for place in numeric}
    if any(units != {""} for units in inside.values()):
        return {place: by_units(units) for place, units in inside.items()}
    labelled = any(column.text for column in columns) and len(REQUIRED) <= len(body.rows) <= len(PHASE_ROLES)
    if len(numeric) != len(REQUIRED) or labelled or counts(body, numeric[0]):
        return {}
    return dict(zip(numeric, REQUIRED, strict=True))


def has_two_ways(body: TableBody) -> bool:
    """True where a phase can be a row or a column: exactly three rows of three or more plain numbers each."""
    places = range(body.grid.width)
    if body.headed or len(body.rows) != len(REQUIRED) or len(places) < len(REQUIRED) or counts(body, 0):
        return False
    return all(map(is_number, chain.from_iterable(body.rows))) and all(units_in(body, k) == {""} for k in places)

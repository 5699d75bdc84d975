"""A table of axes that somebody uploads: taken as it is where `hpn fleet` would take it, else as a table of cells."""

from collections.abc import Sequence

import msgspec

from hpn.fleet.columns import are_taken
from hpn.tables.axes import AxisTable, read_axes
from hpn.tables.columns import Choices
from hpn.tables.files import Wanted
from hpn.tables.sheets import Grid
from hpn.web.form.symbols import AXIS_INPUTS

WANTED = Wanted(most_rows=50_000, most_characters=4_000_000, takes=are_taken)
"""Most rows and characters of a text whose columns are not named as `hpn fleet` names them."""


def best_reading(grids: Sequence[Grid], choices: Choices, assumed: Sequence[str]) -> AxisTable:
    """The reading that knows most columns, out of those by each separator."""
    tables = [read_axes(grid, AXIS_INPUTS, choices, assumed) for grid in grids]
    return max(tables, key=lambda table: sum(bool(column.role) for column in table.columns))


def lines_of(table: AxisTable) -> bytes:
    """The axes of a table as NDJSON, which `hpn fleet` reads."""
    return b"".join(msgspec.json.encode(axis) + b"\n" for axis in table.axes)

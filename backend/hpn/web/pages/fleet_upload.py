"""What somebody uploads as a table of axes: taken as it is where `hpn fleet` would take it, else as a table of cells.

Arrow is imported by this module, which only the requests that upload a table import.
"""

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import msgspec
import pyarrow as pa
import pyarrow.parquet as pq

from hpn.fleet.columns import AXIS, COLUMNS, is_list
from hpn.tables.cells import Figure
from hpn.tables.columns import Choices
from hpn.tables.sheets import MOST_CELLS, Grid, RefusedError, grid_of, grids_of
from hpn.tables.workbooks import MAGIC, OLD_MAGIC, sheets_of
from hpn.web.door.uploads import decoded
from hpn.web.form.axis_tables import AxisTable, read_axes
from hpn.words.wording import N_

PARQUET, ARROW = b"PAR1", b"ARROW1"
LARGEST = 1e300
"""Numbers beyond it stand as text, and are none."""

MOST_CHARACTERS, MOST_ROWS = 4_000_000, 50_000
"""Longest text and most rows of a table whose columns are not named as `hpn fleet` names them."""

UNREADABLE = N_("the file can’t be read as Parquet, Arrow or NDJSON: save the table as CSV or XLSX")
OLD = N_("a workbook of this old format can’t be read: save it as XLSX or CSV")


@dataclass(frozen=True, slots=True)
class Upload:
    """A table that can be taken as it is, in the format of a suffix, or else the cells of its sheets."""

    suffix: str = ""
    sheets: Mapping[str, Sequence[Grid]] | None = None


def uploaded(content: bytes) -> Upload:
    """What a file or a text is; raises RefusedError, or Problem for what is no text."""
    if content.startswith(OLD_MAGIC):
        raise RefusedError(OLD)
    if content.startswith(MAGIC):
        return Upload(sheets={name: [sheet.grid()] for name, sheet in sheets_of(content).items()})
    for magic, suffix, read in ((PARQUET, ".parquet", pq.ParquetFile), (ARROW, ".arrow", pa.ipc.open_file)):
        if content.startswith(magic):
            return _typed(content, suffix, read)
    text = decoded(content).removeprefix("\ufeff").replace("\r\n", "\n")
    if text.lstrip().startswith("{"):
        return _objects(text)
    if _is_taken_csv(text):
        return Upload(".csv")
    return Upload(sheets={"": grids_of(text, MOST_ROWS, MOST_CHARACTERS)})


def _is_taken(names: Sequence[str], *, is_in_list_form: bool) -> bool:
    """Whether the command knows the columns; long form with other columns in it becomes list form here."""
    known = {AXIS, *COLUMNS.phases, *(COLUMNS.others if is_in_list_form else ())}
    return {AXIS, "torque_Nm"} <= set(names) <= known


def _is_taken_csv(text: str) -> bool:
    rows = csv.reader(io.StringIO(text, newline=""))
    try:
        first, second = dict.fromkeys(next(rows, [])), next(rows, [])
    except csv.Error:
        return False
    cells = dict(zip(first, second, strict=False))
    return _is_taken(list(first), is_in_list_form=cells.get("torque_Nm", "").lstrip().startswith("["))


def _typed(content: bytes, suffix: str, read: Any) -> Upload:
    try:
        file = read(io.BytesIO(content))
        schema = file.schema_arrow if suffix == ".parquet" else file.schema
        if any(is_list(field.type) for field in schema) or _is_taken(schema.names, is_in_list_form=False):
            return Upload(suffix)
        rows = file.read() if suffix == ".parquet" else file.read_all()
    except (pa.ArrowException, OSError):
        raise RefusedError(UNREADABLE) from None
    return _of_cells(rows.column_names, (list(row.values()) for row in rows.slice(0, MOST_CELLS).to_pylist()))


def _objects(text: str) -> Upload:
    try:
        rows = [msgspec.json.decode(line, type=dict[str, Any]) for line in text.split("\n") if line.strip()]
    except (ValueError, RecursionError):
        return Upload(".ndjson")  # the command says which line is none
    names = list(dict.fromkeys(name for row in rows for name in row))
    if any(isinstance(value, list) for row in rows for value in row.values()):
        return Upload(".ndjson")
    if _is_taken(names, is_in_list_form=False):
        return Upload(".ndjson")
    return _of_cells(names, ([row.get(name) for name in names] for row in rows))


def _of_cells(names: Sequence[str], rows: Any) -> Upload:
    return Upload(sheets={"": [grid_of([list(names), *([_cell(value) for value in row] for row in rows)])]})


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < LARGEST:
        return Figure(repr(value).removesuffix(".0"))
    return str(value)


def best_reading(grids: Sequence[Grid], choices: Choices, assumed: Sequence[str]) -> AxisTable:
    """The reading that knows most columns, out of those by each separator."""
    tables = [read_axes(grid, choices, assumed) for grid in grids]
    return max(tables, key=lambda table: sum(bool(column.role) for column in table.columns))


def lines_of(table: AxisTable) -> bytes:
    """The axes of a table as NDJSON, which `hpn fleet` reads."""
    return b"".join(msgspec.json.encode(axis) + b"\n" for axis in table.axes)

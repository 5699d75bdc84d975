"""Tables of a fleet: their formats by suffix, and their required and allowed columns."""

import stat
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import pyarrow as pa

from hpn.fleet.columns import AXIS, COLUMNS, InputColumn, tolerance_column
from hpn.fleet.csv_tables import CsvTable, GzipCsvTable
from hpn.fleet.order import FleetError, status_of, suffix_of, wrong_encoding
from hpn.fleet.tables import AxisTable
from hpn.fleet.typed import ArrowTable, ParquetTable, TableInMemory
from hpn.words.likeness import likeness

FORMATS: dict[str, type[AxisTable]] = {
    ".parquet": ParquetTable,
    ".arrow": ArrowTable,
    ".csv": CsvTable,
    ".arrows": ArrowTable,
    ".feather": ArrowTable,
    ".csv.gz": GzipCsvTable,
}
"""Readable formats, by suffix."""

MOST_PROBLEMS = 20
"""Most wrong columns that an error names."""


def open_axes(
    path: Path,
    ignored: Sequence[str] = (),
    content: bytes | None = None,
    columns: Mapping[str, InputColumn] = COLUMNS.all,
) -> AxisTable:
    """Table of phases or of axes in a file, or in bytes under its name; raises FleetError for columns that are missing,
    unknown or of a wrong type."""
    suffix = suffix_of(path)
    if suffix is None:
        raise FleetError(f"{path}: the suffix must be one of {', '.join(FORMATS)}")
    if content is None:
        _require_file(path)
    table = FORMATS[suffix](path, ignored, content, columns)
    if isinstance(table, CsvTable) and (reason := wrong_encoding(table.head)):
        raise FleetError(f"{path}: {reason}")
    return _usable(table)


def axes_in_memory(table: pa.Table, ignored: Sequence[str] = ()) -> AxisTable:
    """Table of Arrow in memory; raises FleetError as `open_axes`."""
    return _usable(TableInMemory(table, ignored))


def _usable(table: AxisTable) -> AxisTable:
    """Table without the indices of pandas; raises FleetError for wrong columns."""
    known = (AXIS, *table.columns)
    table.ignored += tuple(name for name in table.indices if name not in known and name not in table.ignored)
    _require(table, [*known], [AXIS, *(column.name for column in COLUMNS.phases.values() if column.required)])
    return table


def _require_file(path: Path) -> None:
    status = status_of(path)
    if status is None or not stat.S_ISREG(status.st_mode):
        raise FleetError(f"{path}: {'is not a file' if status else 'there is no such file'}")
    if not status.st_size:
        raise FleetError(f"{path}: is empty, where a table belongs")


def _require(table: AxisTable, allowed: list[str], required: list[str]) -> None:
    allowed = [*allowed, *filter(tolerance_column, table.names)]
    unknown = [name for name in table.names if name not in allowed]
    others = [f"column {name} is missing" for name in required if name not in table.names]
    others += [f"column {name:.80} is there twice" for name, count in Counter(table.names).items() if count > 1]
    if not others:
        others += filter(None, map(table.wrong_type, table.names))
    if wrong := len(unknown) + len(others):
        problems = [*(_unknown(name, allowed) for name in unknown[:MOST_PROBLEMS]), *others][:MOST_PROBLEMS]
        more = [f"{wrong - MOST_PROBLEMS} more"] if wrong > MOST_PROBLEMS else []
        raise FleetError(f"{table.path}: {'; '.join([*problems, *more])}")


def _unknown(name: str, allowed: list[str]) -> str:
    close = likeness(name, allowed)
    hint = f"; it looks like {close}" if close else ""
    return f"column {name!r:.80} is unknown{hint}"

"""Opening the tables of a fleet: their formats by suffix, and the columns that must and may be there."""

import stat
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from hpn.fleet.columns import AXIS, COLUMNS
from hpn.fleet.lines import CsvTable, GzipCsvTable, LinesTable
from hpn.fleet.ndjson import NdjsonTable
from hpn.fleet.order import FleetError, Order, status_of, suffix_of, wrong_encoding
from hpn.fleet.tables import Table
from hpn.fleet.typed import ArrowTable, ParquetTable
from hpn.words.likeness import likeness

FORMATS: dict[str, type[Table]] = {
    ".parquet": ParquetTable,
    ".arrow": ArrowTable,
    ".csv": CsvTable,
    ".ndjson": NdjsonTable,
    ".arrows": ArrowTable,
    ".feather": ArrowTable,
    ".jsonl": NdjsonTable,
    ".csv.gz": GzipCsvTable,
}
"""Formats that are read, by suffix."""

FORM = "torque_Nm"
"""Column that decides the form of a table."""

MOST_PROBLEMS = 20
"""Wrong columns that an error names."""


def open_tables(order: Order) -> tuple[Table, Table | None]:
    """The table of axes of an order, and the one beside it; raises FleetError."""
    table = open_axes(order.axes, order.ignored)
    if order.requirements is None:
        return table, None
    return table, open_requirements(order.requirements, table, order.ignored)


def open_axes(path: Path, ignored: Sequence[str] = ()) -> Table:
    """The table of phases or of axes; raises FleetError for columns that are missing, unknown or of a wrong type."""
    table = _opened(path, ignored)
    allowed = [AXIS, *COLUMNS.phases, *(COLUMNS.others if table.is_in_list_form else ())]
    required = [AXIS, *(column.name for column in COLUMNS.phases.values() if column.required)]
    _require(table, allowed, required)
    return table


def open_requirements(path: Path, phases: Table, ignored: Sequence[str] = ()) -> Table:
    """The table beside phases in long form, a row for each axis with its other columns."""
    if phases.is_in_list_form:
        raise FleetError(f"{phases.path}: has its axes in list form; --axes belongs to the long form alone")
    table = _opened(path, ignored)
    _require(table, [AXIS, *COLUMNS.others], [AXIS])
    return table


def _opened(path: Path, ignored: Sequence[str]) -> Table:
    suffix = suffix_of(path)
    if suffix is None:
        raise FleetError(f"{path}: the suffix must be one of {', '.join(FORMATS)}")
    found = status_of(path)
    if found is None or not stat.S_ISREG(found.st_mode):
        raise FleetError(f"{path}: {'is not a file' if found else 'there is no such file'}")
    if not found.st_size:
        raise FleetError(f"{path}: is empty, where a table belongs")
    table = FORMATS[suffix](path, ignored)
    if isinstance(table, LinesTable) and (said := wrong_encoding(table.head)):
        raise FleetError(f"{path}: {said}")
    known = (AXIS, *COLUMNS.all)
    table.ignored += tuple(name for name in table.indices if name not in known and name not in ignored)
    return table


def _require(table: Table, allowed: list[str], required: list[str]) -> None:
    if not _has_a_form(table):  # nothing is known of where other columns belong
        allowed = [*allowed, *COLUMNS.others]
    unknown = [name for name in table.names if name not in allowed]
    others = [f"column {name} is missing" for name in required if name not in table.names]
    others += [f"column {name:.80} is there twice" for name, count in Counter(table.names).items() if count > 1]
    if not others:
        others += table.wrong_types()
    if found := len(unknown) + len(others):
        problems = [*(_unknown(name, allowed) for name in unknown[:MOST_PROBLEMS]), *others][:MOST_PROBLEMS]
        more = [f"{found - MOST_PROBLEMS} more"] if found > MOST_PROBLEMS else []
        raise FleetError(f"{table.path}: {'; '.join([*problems, *more])}")


def _has_a_form(table: Table) -> bool:
    return FORM in table.names and not table.wrong_type(FORM)


def _unknown(name: str, allowed: list[str]) -> str:
    if name in COLUMNS.others:
        return f"column {name} belongs into the table of --axes, since a row is a phase"
    if name in COLUMNS.phases:
        return f"column {name} belongs to the phases"
    close = likeness(name, allowed)
    said = f"; it looks like {close}" if close else ""
    return f"column {name!r:.80} is unknown{said}"

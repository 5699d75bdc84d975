"""Opening the tables of a fleet: their formats by suffix, and the columns that must and may be there."""

from collections import Counter
from collections.abc import Iterator
from difflib import get_close_matches
from pathlib import Path

from hpn.fleet.columns import AXIS, COLUMNS
from hpn.fleet.errors import FleetError
from hpn.fleet.lines import CsvTable, NdjsonTable
from hpn.fleet.tables import ArrowTable, ParquetTable, Table, TypedTable

FORMATS: dict[str, type[Table]] = {
    ".parquet": ParquetTable,
    ".arrow": ArrowTable,
    ".csv": CsvTable,
    ".ndjson": NdjsonTable,
}


def format_of(path: Path) -> str:
    """Suffix of a file, which says its format."""
    if path.suffix not in FORMATS:
        raise FleetError(f"{path}: the suffix must be one of {', '.join(FORMATS)}")
    return path.suffix


def open_axes(path: Path) -> Table:
    """The table of phases or of axes; raises FleetError for columns that are missing, unknown or of a wrong type."""
    table = _opened(path)
    allowed = [AXIS, *COLUMNS.phases, *(COLUMNS.others if table.is_in_list_form else ())]
    required = [AXIS, *(column.name for column in COLUMNS.phases.values() if column.required)]
    _require(table, allowed, required)
    return table


def open_requirements(path: Path, phases: Table) -> Table:
    """The table beside phases in long form, a row for each axis with its other columns."""
    if phases.is_in_list_form:
        raise FleetError(f"{phases.path}: has its axes in list form; --axes belongs to the long form alone")
    table = _opened(path)
    _require(table, [AXIS, *COLUMNS.others], [AXIS])
    return table


def _opened(path: Path) -> Table:
    suffix = format_of(path)
    if not path.is_file():
        raise FleetError(f"{path}: {'is not a file' if path.exists() else 'there is no such file'}")
    if not path.stat().st_size:
        raise FleetError(f"{path}: is empty, where a table belongs")
    return FORMATS[suffix](path)


def _require(table: Table, allowed: list[str], required: list[str]) -> None:
    problems = list(_unknown(table, allowed))
    problems += [f"column {name} is missing" for name in required if name not in table.names]
    problems += [f"column {name} is there twice" for name, count in Counter(table.names).items() if count > 1]
    if not problems and isinstance(table, TypedTable):
        problems += table.wrong_types()
    if problems:
        raise FleetError(f"{table.path}: {'; '.join(problems)}")


def _unknown(table: Table, allowed: list[str]) -> Iterator[str]:
    for name in table.names:
        if name in COLUMNS.others and name not in allowed:
            yield f"column {name} belongs into the table of --axes, since a row is a phase"
        elif name in COLUMNS.phases and name not in allowed:
            yield f"column {name} belongs to the phases"
        elif name not in allowed:
            close = get_close_matches(name, allowed, 1)
            yield f"column {name!r:.80} is unknown" + (f"; it looks like {close[0]}" if close else "")

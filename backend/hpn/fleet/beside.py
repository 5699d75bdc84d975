"""Sizing a fleet for a service, in a process beside it: nothing of Arrow is imported by this module alone."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from hpn.catalogue import Catalogue
from hpn.fleet.errors import FleetError

ANSWERED_IN = {
    ".parquet": ".parquet",
    ".arrow": ".arrow",
    ".csv": ".csv",
    ".ndjson": ".ndjson",
    ".arrows": ".arrow",
    ".feather": ".arrow",
    ".jsonl": ".ndjson",
    ".csv.gz": ".csv",
}
"""Suffixes of tables that are read, and of the files that they are answered in, which are those that are written."""


def suffix_of(path: Path) -> str | None:
    """Suffix of a table that is read."""
    return next((suffix for suffix in ANSWERED_IN if path.name.endswith(suffix)), None)


class Sized(NamedTuple):
    """End of a fleet: columns that were ignored though nobody asked for that; words for input that can't be used; the
    system's code for a file that can't be written."""

    ignored: tuple[str, ...] = ()
    refusal: str = ""
    code: int = 0


def sized(order: Mapping[str, Any], catalogue: Catalogue, workers: int) -> Sized:
    """Size a fleet by the fields of its order in so many threads, which leaves files where all goes well."""
    from hpn.fleet.run import Order, keep_memory, size_fleet, threads

    keep_memory()
    ignored = list[str]()
    try:
        size_fleet(Order(**order), catalogue, threads(workers), note_ignored=lambda _, name: ignored.append(name))
    except FleetError as error:
        return Sized(refusal=str(error))
    except OSError as error:
        if not error.errno:
            raise
        return Sized(code=error.errno)
    return Sized(tuple(ignored))

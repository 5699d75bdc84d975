"""Sizing a fleet for a service, in a process beside it: nothing of Arrow is imported by this module alone."""

from typing import NamedTuple

from hpn.catalogue import Catalogue
from hpn.fleet.order import FleetError, Order


class Sized(NamedTuple):
    """End of a fleet: columns that were ignored though nobody asked for that; words for input that can't be used; the
    system's code for a file that can't be written."""

    ignored: tuple[str, ...] = ()
    refusal: str = ""
    code: int = 0


def sized(order: Order, catalogue: Catalogue, workers: int) -> Sized:
    """Size a fleet in so many threads, which leaves files where all goes well."""
    from hpn.fleet.run import keep_memory, size_fleet, threads

    keep_memory()
    ignored = list[str]()
    try:
        size_fleet(order, catalogue, threads(workers), note_ignored=lambda _, name: ignored.append(name))
    except FleetError as error:
        return Sized(refusal=str(error))
    except OSError as error:
        if not error.errno:
            raise
        return Sized(code=error.errno)
    return Sized(tuple(ignored))

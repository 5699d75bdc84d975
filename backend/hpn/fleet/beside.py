"""Work on fleets for a service, in a process beside it: nothing of Arrow is imported by this module alone."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from hpn.catalogue import Catalogue
from hpn.fleet.faults import CellFault
from hpn.fleet.order import FleetError, Order
from hpn.tables.answers import answered
from hpn.tables.columns import NO_CHOICES, Choices
from hpn.tables.files import TableBounds, text_of
from hpn.tables.reading import Reading, reading_of
from hpn.words.wording import Sentence


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


NAME = "The table"
"""Name of a table that a page is given."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineReading:
    """A reading of a table of axes; of one that is taken as it is its axes and what is wrong with their cells, or words
    for one that can't be used; and how many axes and phases it has."""

    reading: Reading
    rows: Sequence[Mapping[str, Any]] = ()
    faults: Sequence[CellFault] = ()
    axes: int = 0
    phases: int = 0
    refusal: str = ""


def read_machine(
    content: bytes | str, wanted: TableBounds, choices: Choices = NO_CHOICES, assumed: Collection[str] = ()
) -> MachineReading:
    """Reading of a file or a text, as `reading_of` gives it."""
    reading = reading_of(content, wanted, choices, assumed)
    if not reading.suffix:
        rows = reading.table.axes if reading.table else ()
        lists = (row.get("torque_Nm") for row in rows)
        phases = sum(len(each) for each in lists if isinstance(each, list))
        return MachineReading(reading=reading, axes=len(rows), phases=phases)
    from hpn.fleet.machine import given_of

    content = content.encode() if isinstance(content, str) else content
    try:
        source = given_of(text_of(content).encode() if reading.suffix == ".csv" else content, NAME + reading.suffix)
    except FleetError as error:
        return MachineReading(reading=reading, refusal=str(error).replace(NAME + reading.suffix, NAME))
    return MachineReading(
        reading=reading, rows=source.rows, faults=source.faults, axes=source.axes, phases=source.phases
    )


def read_answered(
    content: bytes, wanted: TableBounds, texts: Sequence[str]
) -> tuple[MachineReading, tuple[Sentence, ...]]:
    """Reading of a file by answers of a program, and what is wrong with these; no unit is assumed."""
    return answered(
        texts,
        wanted.inputs,
        lambda choices: read_machine(content, wanted, choices),
        lambda read: read.reading.table.columns if read.reading.table else (),
    )

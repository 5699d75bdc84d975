"""Work on fleets for a service, in a separate process: importing this module imports nothing of Arrow."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from hpn.catalogue import Catalogue
from hpn.fleet.faults import CellFault
from hpn.fleet.order import FleetError, Order
from hpn.tables.answers import reading_by_answers
from hpn.tables.columns import NO_CHOICES, Choices
from hpn.tables.files import TableBounds, text_of
from hpn.tables.reading import Reading, reading_of
from hpn.words.wording import Sentence


class Sized(NamedTuple):
    """End of a fleet: unrequested columns that were ignored, the refusal of unusable input, and the error number of the
    system for a file that can't be written."""

    ignored: tuple[str, ...] = ()
    refusal: str = ""
    code: int = 0


def sized(order: Order, catalogue: Catalogue, workers: int) -> Sized:
    """Size a fleet in `workers` threads; the files appear only where all goes well."""
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
"""Name of a table that comes from a page."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineReading:
    """Reading of a table of axes, with the numbers of its axes and phases.

    A table in the columns of `hpn fleet` also has its rows and the faults of its cells, or a refusal.
    """

    reading: Reading
    rows: Sequence[Mapping[str, Any]] = ()
    faults: Sequence[CellFault] = ()
    axes: int = 0
    phases: int = 0
    refusal: str = ""


def read_machine(
    content: bytes | str, bounds: TableBounds, choices: Choices = NO_CHOICES, assumed: Collection[str] = ()
) -> MachineReading:
    """Reading of a file or a text, as from `reading_of`."""
    reading = reading_of(content, bounds, choices, assumed)
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
    content: bytes, bounds: TableBounds, texts: Sequence[str]
) -> tuple[MachineReading, tuple[Sentence, ...]]:
    """Reading of a file by a program's answers, and the sentences on wrong answers; no unit is assumed."""
    return reading_by_answers(
        texts,
        bounds.inputs,
        lambda choices: read_machine(content, bounds, choices),
        lambda machine: machine.reading.table.columns if machine.reading.table else (),
    )

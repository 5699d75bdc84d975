"""Tables of axes, and readings of them."""

from typing import Any

from hpn.links.symbols import AXIS_INPUTS
from hpn.tables.axes import read_axes
from hpn.tables.columns import Choices
from hpn.tables.sheets import grids_of
from hpn.tables.table import Choice, Table

WIRE = tuple(AXIS_INPUTS.units)
HEAD = "Achse;Moment [Nm];Drehzahl [1/min];Dauer [s]"


def read(*lines: str, assumed: tuple[str, ...] = WIRE, **said: Any) -> Table:
    """Reading of a table."""
    return read_axes(grids_of("\n".join(lines))[0], AXIS_INPUTS, Choices(**said), assumed)


def asked(table: Table) -> list[str]:
    """Open questions of a table."""
    return [question.text for question in table.questions]


def offered(table: Table, name: str) -> Choice:
    """Choice that a table leaves open."""
    choice = table.choice(name)
    assert choice is not None
    return choice

"""Gears to order: those of all axes by their ordering codes, with quantities and masses."""

from collections.abc import Iterable
from typing import Annotated, NamedTuple

from pydantic import Field

from hpn.catalogue import Catalogue
from hpn.catalogue.ordering import OrderingCode, read_ordering_code
from hpn.words.reply import Reply


class Placed(NamedTuple):
    """An axis by what counts for the order: its number and quantity, its ordering code, and the gear selected."""

    number: int
    quantity: int
    ordering_code: str | None
    selected: str | None


class OrderedGear(Reply, frozen=True):
    """One line of the order."""

    ordering_code: Annotated[str, Field(description="Ordering code; the designation where an axis has none.")]
    designation: Annotated[str, Field(description="Designation of the gear.")]
    axes: Annotated[tuple[int, ...], Field(description="Numbers of its axes.")]
    quantity: Annotated[int, Field(description="Number of such gears.")]
    weight_kg: Annotated[float | None, Field(description="Mass of all of them; null where it is not published.")]


class GearOrder(Reply, frozen=True):
    """All gears of a machine; axes without a gear are not in it."""

    gears: Annotated[tuple[OrderedGear, ...], Field(description="Gears, most first.")]
    weight_kg: Annotated[float | None, Field(description="Mass of all; null where that of one is not known.")]

    @property
    def kinds(self) -> int:
        """Number of kinds of gears, by their designations."""
        return len({gear.designation for gear in self.gears})


def gears_of(axes: Iterable[Placed], catalogue: Catalogue) -> GearOrder:
    """List of the gears of axes: that of the ordering code, else the selected one."""
    lines: dict[tuple[str, str], list[Placed]] = {}
    for axis in axes:
        if line := _line(axis, catalogue):
            lines.setdefault(line, []).append(axis)
    gears = [_ordered(*line, placed, catalogue) for line, placed in lines.items()]
    masses = [gear.weight_kg for gear in gears]
    whole = None if None in masses else sum(mass for mass in masses if mass is not None)
    return GearOrder(tuple(sorted(gears, key=lambda gear: (-gear.quantity, gear.ordering_code))), whole)


def _line(axis: Placed, catalogue: Catalogue) -> tuple[str, str] | None:
    """Ordering code and designation of an axis's gear; None for an axis without one."""
    if axis.ordering_code is None:
        return None if axis.selected is None else (axis.selected, axis.selected)
    code = read_ordering_code(catalogue, axis.ordering_code)
    return (code.text, code.gear.designation) if isinstance(code, OrderingCode) else None


def _ordered(code: str, designation: str, axes: list[Placed], catalogue: Catalogue) -> OrderedGear:
    gear = catalogue.by_designation.get(designation)
    count = sum(axis.quantity for axis in axes)
    mass = None if gear is None or gear.weight_kg is None else gear.weight_kg * count
    return OrderedGear(code, designation, tuple(axis.number for axis in axes), count, mass)

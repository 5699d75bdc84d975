"""Gears to order: the gears of all axes by their ordering codes, with quantities and masses."""

from collections.abc import Iterable
from typing import Annotated, NamedTuple

import msgspec
from pydantic import Field

from hpn.catalogue import Catalogue
from hpn.catalogue.ordering import OrderingCode, read_ordering_code
from hpn.words.reply import Reply


class OrderAxis(NamedTuple):
    """Axis as the order needs it: number, quantity, ordering code, selected gear, and the motor’s name."""

    number: int
    quantity: int
    ordering_code: str | None
    selected: str | None
    motor: str | None = None


class _MotorName(msgspec.Struct):
    name: str | None = None
    designation: str | None = None


class _Required(msgspec.Struct):
    motor: _MotorName | None = None


class _Own(msgspec.Struct):
    requirements: _Required | None = None


def motor_of(application: bytes) -> str | None:
    """Name of the motor in an axis's own part, in any JSON of a caller; None without one."""
    try:
        own = _OWN.decode(application)
    except (msgspec.DecodeError, UnicodeDecodeError):
        return None
    motor = own.requirements.motor if own.requirements else None
    return (motor.name or motor.designation) if motor else None


_OWN = msgspec.json.Decoder(_Own)


class OrderedGear(Reply, frozen=True):
    """One line of the order."""

    ordering_code: Annotated[str, Field(description="Ordering code; the designation where an axis has none.")]
    designation: Annotated[str, Field(description="Designation of the gear.")]
    axes: Annotated[tuple[int, ...], Field(description="Numbers of the axes of this line.")]
    quantity: Annotated[int, Field(description="Number of these gears.")]
    weight_kg: Annotated[float | None, Field(description="Mass of all these gears; null where it is not published.")]
    motors: Annotated[tuple[str, ...], Field(description="Names of the motors of these axes, each once.")] = ()


class GearOrder(Reply, frozen=True):
    """All gears of a machine, without axes that have no gear."""

    gears: Annotated[tuple[OrderedGear, ...], Field(description="Gears, the largest quantity first.")]
    weight_kg: Annotated[
        float | None, Field(description="Mass of all gears; null where the mass of a gear is not known.")
    ]

    @property
    def kinds(self) -> int:
        """Number of kinds of gears, by their designations."""
        return len({gear.designation for gear in self.gears})


def gears_of(axes: Iterable[OrderAxis], catalogue: Catalogue) -> GearOrder:
    """Gears of axes to order: the gear of the ordering code, else the selected one."""
    lines: dict[tuple[str, str], list[OrderAxis]] = {}
    known: dict[tuple[str | None, str | None], tuple[str, str] | None] = {}
    for axis in axes:
        gear = axis.ordering_code, axis.selected
        if gear not in known:
            known[gear] = _line(axis, catalogue)
        if line := known[gear]:
            lines.setdefault(line, []).append(axis)
    gears = [_ordered(*line, placed, catalogue) for line, placed in lines.items()]
    masses = [gear.weight_kg for gear in gears]
    whole = None if None in masses else sum(mass for mass in masses if mass is not None)
    return GearOrder(tuple(sorted(gears, key=lambda gear: (-gear.quantity, gear.ordering_code))), whole)


def _line(axis: OrderAxis, catalogue: Catalogue) -> tuple[str, str] | None:
    """Ordering code and designation of an axis's gear; None for an axis without one."""
    if axis.ordering_code is None:
        return None if axis.selected is None else (axis.selected, axis.selected)
    code = read_ordering_code(catalogue, axis.ordering_code)
    return (code.text, code.gear.designation) if isinstance(code, OrderingCode) else None


def _ordered(code: str, designation: str, axes: list[OrderAxis], catalogue: Catalogue) -> OrderedGear:
    gear = catalogue.by_designation.get(designation)
    count = sum(axis.quantity for axis in axes)
    mass = None if gear is None or gear.weight_kg is None else gear.weight_kg * count
    motors = dict.fromkeys(axis.motor for axis in axes if axis.motor)
    return OrderedGear(code, designation, tuple(axis.number for axis in axes), count, mass, tuple(motors))

"""Published figures of a gear as lines with their sources, and in the groups of a page."""

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TypeVar

from hpn.account.lines import Line
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.physics.equations import FloatArray
from hpn.words.quantities import GEAR, MOTOR
from hpn.words.source import source_sentence
from hpn.words.units import suffix_of
from hpn.words.wording import N_, Named, Quantity, Sentence, listed

T = TypeVar("T")

FIGURES = tuple(name for name in GEAR if suffix_of(name))
"""Published figures, in the order of their lists."""

GROUPS: Mapping[str, str] = {
    "rated_torque_Nm": N_("Torque at the output"),
    "maximum_input_speed_rpm": N_("Speed at the input, temperature"),
    "backlash_arcmin": N_("Accuracy and stiffness"),
    "length_min_mm": N_("Size and weight"),
    "dynamic_radial_load_N": N_("Output bearing"),
    "inertia_kgm2": N_("At the input"),
    "clamp_bolts": N_("Bolts"),
}
"""Titles of a page's groups, by the first figure of each."""

RANGES: Mapping[str, tuple[str, str, str]] = {
    "ambient_temperature_minimum_degC": (
        *("ambient_temperature_maximum_degC", "ambient_temperature"),
        N_("Ambient temperature"),
    ),
    "length_min_mm": ("length_max_mm", "length", N_("Length, depending on the motor")),
}
"""Figures at the beginning of a range -> the figure at its end, and code and name of the range."""

AT_MOST = ("backlash_arcmin", "transmission_accuracy_arcmin")
"""Figures published as an upper limit."""


def published(gear: Gear | None) -> list[Line]:
    """Every published figure of a gear, None if its source lacks it; empty for an unknown gear."""
    return [line_of(gear, name) for name in FIGURES] if gear else []


def line_of(gear: Gear, name: str) -> Line:
    """One figure of a gear, such as its ratio."""
    source = gear.sources.get(name)
    return Line(
        f"gear.{name}",
        GEAR[name],
        getattr(gear, name),
        suffix_of(name),
        "published",
        source_sentence(source) if source else None,
        sign="≤" if name in AT_MOST else "",
        is_supplied=gear.is_supplied(name),
    )


def groups_of(gear: Gear) -> list[tuple[str, list[Line]]]:
    """Published figures of a gear by group, ranges as one line."""
    return grouped(ranged(published(gear)), lambda line: line.code)


def grouped(items: Iterable[T], code_of: Callable[[T], str]) -> list[tuple[str, list[T]]]:
    """Lines or rows of published figures, in their order, under the titles of their groups."""
    groups = itertools.groupby(items, lambda item: _GROUP_OF[code_of(item).removeprefix("gear.")])
    return [(title, list(group)) for title, group in groups]


def _group_of_each() -> Iterator[tuple[str, str]]:
    title = ""
    for name in GEAR:
        title = GROUPS.get(name, title)
        yield name, title


_GROUP_OF = dict(_group_of_each())
_GROUP_OF |= {code: _GROUP_OF[first] for first, (_, code, _) in RANGES.items()}


def ranged(lines: list[Line]) -> list[Line]:
    """Published figures with each range as one line; a single number for equal ends, or if one end is missing."""
    by_name = {line.field: line for line in lines}
    ends = {end for end, _, _ in RANGES.values()}
    return [_range(line, by_name) if name in RANGES else line for name, line in by_name.items() if name not in ends]


def _range(first: Line, by_name: Mapping[str, Line]) -> Line:
    end, code, name = RANGES[first.field]
    values = list(dict.fromkeys(one.value for one in (first, by_name[end]) if isinstance(one.value, float | int)))
    named = next((one for one in (first, by_name[end]) if one.value is not None), first)
    return Line(
        f"gear.{code}",
        Named(name),
        values[0] if values else None,
        first.unit,
        "published",
        named.source,
        values[1] if len(values) == 2 else None,
        is_supplied=first.is_supplied or by_name[end].is_supplied,
    )


def whole(catalogue: Catalogue, designation: str) -> list[Line]:
    """All data of a gear in a catalogue: figures, ranges as one line, bolts, curves and note; empty for an unknown
    gear.
    """
    gear = catalogue.by_designation.get(designation)
    if gear is None:
        return []
    return [
        *ranged(published(gear)),
        *bolts(gear),
        *_curves(catalogue, gear),
        *(Line(f"gear.{name}", GEAR[name], getattr(gear, name), kind="published") for name in ("stages", "note")),
    ]


def of_motor(catalogue: Catalogue, designation: str) -> list[Line]:
    """Figures of a listed motor; empty if the catalogue lacks it."""
    motor = catalogue.motor_by_designation.get(designation)
    names = [name for name in MOTOR if suffix_of(name)] if motor else []
    return [Line(f"motor.{name}", MOTOR[name], getattr(motor, name), suffix_of(name), "published") for name in names]


def _curves(catalogue: Catalogue, gear: Gear) -> Iterator[Line]:
    """Points of the supplied curves of a gear."""
    curve, efficiency = catalogue.curves.get(gear.size), catalogue.efficiency.get(gear.designation)
    if curve is not None:
        yield _points("gear.bearing_curve", N_("Points of the output bearing’s curve"), curve.axial_N, curve.radial_N)
    if efficiency is not None:
        yield _points("gear.efficiency_curve", N_("Points of the efficiency curve"), *efficiency)


def _points(code: str, name: str, *columns: FloatArray) -> Line:
    """Points of a curve as one line, with the supplied coordinates."""
    points = [point for point in zip(*(column.tolist() for column in columns), strict=True)]
    values = {f"x{at}_{axis}": Quantity(x, "", 12) for at, point in enumerate(points) for axis, x in enumerate(point)}
    texts = (" / ".join(f"{{x{at}_{axis}}}" for axis in range(len(columns))) for at in range(len(points)))
    return Line(code, Named(name), Sentence("; ".join(texts), values), kind="published")


# --- Bolts ------------------------------------------------------------------------------------------------------------


def bolts(gear: Gear | None) -> list[Line]:
    """Bolts of housing and motor coupling, each in one line."""
    if gear is None:
        return []
    values = {"housing_bolts": _housing_bolts(gear), "clamp_bolts": _clamp_bolts(gear)}
    return [Line(f"gear.{name}", GEAR[name], value, kind="published") for name, value in values.items()]


def _housing_bolts(gear: Gear) -> Sentence | None:
    bolts = gear.housing_bolts
    if bolts is None:
        return None
    parts = [Sentence("{number} × {bolt}", {"number": bolts.number_of_bolts or "?", "bolt": bolts.bolt_size or "?"})]
    if bolts.pitch_diameter_mm is not None:
        parts.append(Sentence("Ø\u00a0{diameter}", {"diameter": Quantity(bolts.pitch_diameter_mm, "mm", 4)}))
    if bolts.tightening_torque_Nm is not None:
        parts.append(Sentence("{torque}", {"torque": Quantity(bolts.tightening_torque_Nm, "Nm", 4)}))
    return listed(parts)


def _clamp_bolts(gear: Gear) -> Sentence | None:
    parts = [
        Sentence("{bolt}", {"bolt": bolt.bolt_size})
        if bolt.tightening_torque_Nm is None
        else Sentence(
            "{bolt} {torque}", {"bolt": bolt.bolt_size, "torque": Quantity(bolt.tightening_torque_Nm, "Nm", 4)}
        )
        for bolt in gear.clamp_bolts
    ]
    return listed(parts, Sentence(N_("{first} or {rest}")).template) if parts else None

"""The load envelope of a size as a small drawing: points on a canvas, with round marks on both axes."""

from dataclasses import dataclass

from hpn.application import InputError
from hpn.catalogue import Catalogue
from hpn.drawings.axis import round_numbers
from hpn.envelopes import EnvelopeCurve, EnvelopeQuery, life_envelopes
from hpn.gear import Gear

WIDTH, HEIGHT = 420, 250
LEFT, RIGHT, TOP, BOTTOM = 56, 62, 12, 36
"""Canvas in user units of the SVG, and what its margins leave for numbers."""

SPACE = 1.06
"""Room beyond the largest load."""

MOST_SPACES = 6
"""Spaces between round numbers along an axis."""


@dataclass(frozen=True, slots=True)
class AxisMark:
    """A number on an axis, and where it stands."""

    place: float
    value: float


@dataclass(frozen=True, slots=True)
class CurveLine:
    """One envelope: corner points as loads, and as the text of an SVG polyline."""

    curve: EnvelopeCurve
    points: str


@dataclass(frozen=True, slots=True)
class Drawing:
    """Radial load to the right, axial load upwards, as in the plots of a selection."""

    lines: tuple[CurveLine, ...]
    radial_marks: tuple[AxisMark, ...]
    axial_marks: tuple[AxisMark, ...]
    supplied: bool


def drawing(catalogue: Catalogue, gear: Gear) -> Drawing | None:
    """Envelopes of a gear at the published speed and life, or None where its limits are not published."""
    supplied = gear.size in catalogue.curves
    try:
        curves = life_envelopes(catalogue, gear, EnvelopeQuery(model="digitised" if supplied else "linear"))
    except InputError:
        return None
    axial = SPACE * max(value for curve in curves for value in curve.axial_N)
    radial = SPACE * max(value for curve in curves for value in curve.radial_N)

    def x(load: float) -> float:
        return round(LEFT + load / radial * (WIDTH - LEFT - RIGHT), 1)

    def y(load: float) -> float:
        return round(HEIGHT - BOTTOM - load / axial * (HEIGHT - TOP - BOTTOM), 1)

    def line(curve: EnvelopeCurve) -> CurveLine:
        points = zip(curve.radial_N, curve.axial_N, strict=True)
        return CurveLine(curve, " ".join(f"{x(along)},{y(up)}" for along, up in points))

    return Drawing(
        tuple(map(line, curves)),
        tuple(AxisMark(x(value), value) for value in round_numbers(0.0, radial, MOST_SPACES)),
        tuple(AxisMark(y(value), value) for value in round_numbers(0.0, axial, MOST_SPACES)),
        supplied,
    )

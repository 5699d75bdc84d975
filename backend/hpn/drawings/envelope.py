"""The load envelope of a size as a small drawing: points on a canvas, with round marks on both axes."""

from dataclasses import dataclass
from math import floor, log10

from hpn.application import InputError
from hpn.catalogue import Catalogue
from hpn.envelopes import EnvelopeCurve, EnvelopeQuery, life_envelopes
from hpn.gear import Gear

WIDTH, HEIGHT = 420, 250
LEFT, RIGHT, TOP, BOTTOM = 56, 62, 12, 36
"""Canvas in user units of the SVG, and what its margins leave for numbers."""

SPACE = 1.06
"""Room beyond the largest load."""


@dataclass(frozen=True, slots=True)
class Mark:
    """A number on an axis, and where it stands."""

    place: float
    value: float


@dataclass(frozen=True, slots=True)
class Line:
    """One envelope: corner points as loads, and as the text of an SVG polyline."""

    curve: EnvelopeCurve
    points: str


@dataclass(frozen=True, slots=True)
class Drawing:
    """Radial load to the right, axial load upwards, as in the plots of a selection."""

    lines: tuple[Line, ...]
    radial_marks: tuple[Mark, ...]
    axial_marks: tuple[Mark, ...]
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

    def line(curve: EnvelopeCurve) -> Line:
        points = zip(curve.radial_N, curve.axial_N, strict=True)
        return Line(curve, " ".join(f"{x(along)},{y(up)}" for along, up in points))

    return Drawing(
        tuple(map(line, curves)),
        tuple(Mark(x(value), value) for value in _marks(radial)),
        tuple(Mark(y(value), value) for value in _marks(axial)),
        supplied,
    )


def _marks(largest: float) -> list[float]:
    """Round numbers from 0 up to a largest one, four to eight of them."""
    step = 10.0 ** floor(log10(largest / 4))
    step *= max(factor for factor in (1, 2, 5) if factor * step * 4 <= largest)
    return [k * step for k in range(int(largest / step) + 1)]

"""Interactive plots of the output bearing (zoom, hover, export) from the scenes of the drawings; axes fixed per
size.
"""

from collections.abc import Sequence
from html import escape
from math import hypot

from hpn.application import OutputLoad
from hpn.catalogue.gear import Gear
from hpn.explain.drawings.axis import widened
from hpn.explain.drawings.chart import LimitCurve, Mark, Scene
from hpn.explain.drawings.layout import LETTER, Figure, layout, points
from hpn.explain.drawings.picture import BearingPicture, PhaseLoad
from hpn.explain.drawings.sizes import SizeUse
from hpn.explain.drawings.svg import Point
from hpn.explain.drawings.words import axis_title, indexed, numbers_in, text_of
from hpn.words.reader import DEFAULT, Reader
from hpn.words.terms import ENVELOPE_BASIS
from hpn.words.wording import N_, Quantity, Sentence, Value

HALO = ", ".join(f"{x}px {y}px 1px var(--card)" for x in (-1, 1) for y in (-1, 1))
"""Shadow that separates a label from the lines behind it."""

SPELT_OUT = 3
"""Largest number of loads with labels such as "phase 2" instead of "2"."""

DASHES = {"single": "dash", "s1": "longdash", "s2": "dot", "s3": "dashdot"}


def bearing_figure(scene: Scene, picture: BearingPicture, reader: Reader = DEFAULT) -> Figure:
    """Plot of the envelopes and loads of one gear."""
    heading = Sentence(
        "Output bearing of {gear}: {condition}, model {model}",
        {"gear": picture.gear.name, "condition": picture.condition, "model": picture.load.model},
    )
    return _figure(scene, picture.gear, picture, heading, reader)


def sizes_figure(scene: Scene, uses: Sequence[SizeUse], picture: BearingPicture, reader: Reader = DEFAULT) -> Figure:
    """Plot of the permissible constant load of each size."""
    heading = Sentence(
        "Permissible constant load of each size: {condition}, f_w = {f_w}",
        {"condition": picture.condition, "f_w": Quantity(picture.load.load_coefficient, "")},
    )
    drawn = (use.gear for use in uses if use.curve is not None)
    largest = max(drawn, key=lambda gear: gear.dynamic_radial_load_N or 0.0, default=None)
    return _figure(scene, largest, picture, heading, reader)


def _figure(scene: Scene, gear: Gear | None, picture: BearingPicture, heading: Sentence, reader: Reader) -> Figure:
    lines = sorted(scene.lines, key=lambda line: line.strong)
    data = [_curve(line, reader) for line in lines]
    if scene.ray:
        data.append(_distance(scene.ray, reader))
    for kind, symbol, size in (("given", "circle-open", 9), ("equivalent", "circle-open", 11), ("load", "circle", 9)):
        marks = [mark for mark in scene.marks if mark.kind.split()[0] == kind]
        if marks:
            others = [mark.place for mark in scene.marks if mark not in marks]
            data.append(_points(kind, symbol, size, marks, others, reader))
    return {"data": data, "layout": _layout(gear, picture.loads, heading, picture.load, reader)}


# --- Curves -----------------------------------------------------------------------------------------------------------


def _curve(line: LimitCurve, reader: Reader) -> Figure:
    """Curve with its name, which the page writes along the visible part."""
    radial, axial = zip(*line.corners, strict=True)
    kind, *states = line.kind.split()
    colour = "var(--governing)" if "governing" in states else "var(--ink)" if line.strong else "var(--muted)"
    dash = next((DASHES[one] for one in (kind, *states) if one in DASHES), "solid")
    figure: Figure = {
        "type": "scatter",
        "mode": "lines",
        "name": indexed(line.full_name),
        "x": numbers_in(radial, "N", reader),
        "y": numbers_in(axial, "N", reader),
        "line": {"color": colour, "width": 3 if line.strong else 1.5, "dash": dash},
        "hovertext": [f"{indexed(line.full_name)}<br>{_spelt(*corner, reader)}" for corner in line.corners],
        "hoverinfo": "text",
        "meta": {"kind": kind, "load_coefficient": line.load_coefficient, "label": indexed(line.label), "halo": HALO},
    }
    return figure | ({"fill": "tozeroy", "fillcolor": "var(--area)"} if line.strong else {})


def _spelt(radial_N: float, axial_N: float, reader: Reader) -> str:
    values: dict[str, Value] = {"radial": Quantity(radial_N, "N", 4), "axial": Quantity(axial_N, "N", 4)}
    return text_of(Sentence("radial {radial}, axial {axial}", values), reader)


def _distance(ray: tuple[Point, Point], reader: Reader) -> Figure:
    """Line from the worst load to the limit of a single load in its direction."""
    radial, axial = zip(*ray, strict=True)
    return {
        "type": "scatter",
        "mode": "lines",
        "x": numbers_in(radial, "N", reader),
        "y": numbers_in(axial, "N", reader),
        "line": {"color": "var(--muted)", "width": 1.5, "dash": "dot"},
        "hoverinfo": "skip",
        "meta": {"kind": "distance"},
    }


# --- Loads ------------------------------------------------------------------------------------------------------------


def _points(
    kind: str, symbol: str, size: int, marks: Sequence[Mark], others: Sequence[Point], reader: Reader
) -> Figure:
    """Points of one kind with their labels; governing phases have the governing colour."""
    spelt = kind == "load" and len(marks) <= SPELT_OUT
    texts = [text_of(Sentence(N_("phase {phases}"), {"phases": m.label}), reader) if spelt else m.label for m in marks]
    trace = points(kind, size=size)
    states = ["governing" in mark.kind for mark in marks]
    trace["marker"] |= {
        "symbol": symbol,
        "color": ["var(--governing)" if governs else "var(--ink)" for governs in states],
    }
    return trace | {
        "mode": "markers+text",
        "x": numbers_in((mark.place[0] for mark in marks), "N", reader),
        "y": numbers_in((mark.place[1] for mark in marks), "N", reader),
        "text": list(map(indexed, texts)),
        "textposition": _positions([mark.place for mark in marks], others),
        "textfont": {"color": "var(--ink)", "size": LETTER, "shadow": HALO},
        "hovertext": [indexed(escape(mark.full_name)) for mark in marks],
    }


_SIDES = {"top right": (1, 1), "bottom right": (1, -1), "top left": (-1, 1), "bottom left": (-1, -1)}


def _positions(places: Sequence[Point], others: Sequence[Point]) -> list[str]:
    """Side of each point on which its label is furthest from other points and labels."""
    known = [*places, *others]
    width = max((radial for radial, _ in known), default=0.0) or 1.0
    height = max((axial for _, axial in known), default=0.0) or 1.0
    points = [(radial / width, axial / height) for radial, axial in known]
    sides = []
    for own in range(len(places)):
        side, place = _roomiest(points[own], [*points[:own], *points[own + 1 :]])
        points.append(place)
        sides.append(side)
    return sides


def _roomiest(point: Point, others: Sequence[Point]) -> tuple[str, Point]:
    """Side of a point with the most room, up to the room that a label needs, and the place of the label there."""
    x, y = point
    offered = {side: (x + 0.05 * dx, y + 0.04 * dy) for side, (dx, dy) in _SIDES.items()}
    side = max(offered, key=lambda side: min(_room(offered[side], others), 0.12))
    return side, offered[side]


def _room(place: Point, others: Sequence[Point]) -> float:
    """Distance of a place to the nearest other point; negative beyond the axes."""
    if min(place) <= 0:
        return -1.0
    return min((hypot(place[0] - x, place[1] - y) for x, y in others), default=1.0)


def _layout(
    gear: Gear | None, loads: Sequence[PhaseLoad], heading: Sentence, load: OutputLoad, reader: Reader
) -> Figure:
    radial, axial = _reach(gear, loads)
    figure = layout(
        reader,
        axis_title(N_("radial load"), "N", reader),
        axis_title(N_("axial load"), "N", reader),
        title=text_of(heading, reader),
        note=reader.text(ENVELOPE_BASIS[load.model]),
        revision=f"{gear and gear.size} {radial:g} {axial:g}",
    )
    measure = reader.measure("N")
    figure["xaxis"]["range"] = [0, measure.number(radial) * 1.08]
    figure["yaxis"]["range"] = [0, measure.number(axial) * 1.08]
    return figure


def _reach(gear: Gear | None, loads: Sequence[PhaseLoad]) -> Point:
    """Ends of the radial and the axial axis in N."""
    radial = widened((gear and gear.dynamic_radial_load_N) or 1000.0, [load.radial_N for load in loads])
    axial = widened((gear and gear.dynamic_axial_load_N) or 1000.0, [load.axial_N for load in loads])
    return radial, axial

"""Plots of the output bearing to zoom, hover and export; axes fixed per size, radial load to the right."""

from collections.abc import Sequence
from html import escape
from math import hypot

from hpn.application import OutputLoad
from hpn.catalogue.gear import Gear
from hpn.engine.envelopes import EnvelopeCurve
from hpn.explain.drawings.axis import widened
from hpn.explain.drawings.layout import Figure, layout, points
from hpn.explain.drawings.picture import BearingPicture, NamedCurve, PhaseLoad
from hpn.explain.drawings.sizes import SizeUse
from hpn.explain.drawings.words import axis_title, coefficient_name, indexed, said, share, shown
from hpn.words.reader import DEFAULT, Reader
from hpn.words.terms import ENVELOPE_BASIS
from hpn.words.wording import N_, Quantity, Sentence, Value

LABELLED_LOADS = 40
"""Loads up to which each is named in the plot."""

Place = tuple[float, float]

NAME_HEIGHT, NAME_WIDTH = 0.06, 0.15
"""Least distance of two names of curves on the axial and the radial axis, as shares of the axes."""

HALO = ", ".join(f"{x}px {y}px 1px var(--card)" for x in (-1, 1) for y in (-1, 1))
"""Shadow that keeps a label apart from the lines behind it."""

SPELT_OUT = 6
"""Loads up to which the label says "phase 2" and not just "2"."""

PRINTED_STYLES = {
    1.0: ("var(--plot-a)", "longdash"),
    1.2: ("var(--plot-b)", "dashdot"),
    1.5: ("var(--plot-c)", "longdashdot"),
}
"""Colour and dash of the printed load coefficients."""

STYLES = {
    "own": ("var(--plot-own)", "solid"),
    "published": ("var(--ink)", "dot"),
    "equivalent": ("var(--plot-load)", "dash"),
}

SIZE_STYLES = (
    ("var(--plot-c)", "dot"),
    ("var(--plot-b)", "dashdot"),
    ("var(--plot-a)", "longdash"),
    ("var(--plot-own)", "solid"),
    ("var(--ink)", "dash"),
)


def bearing_figure(picture: BearingPicture, reader: Reader = DEFAULT, governing: Sequence[int] = ()) -> Figure:
    """Envelopes and loads of one candidate; those of the phases that govern have a ring."""
    curves = sorted(
        picture.named_curves, key=lambda named: ("life", "own", "published", "equivalent").index(named.kind)
    )
    ends = _ends(curves, _reach(picture.gear, picture.loads))
    data = [_named(named, picture, end, reader) for named, end in zip(curves, ends, strict=True)]
    if picture.loads and picture.worst.published > 0:
        data.append(_distance(picture.worst, reader))
    data += [_points(picture.loads, reader), *_given(picture.loads, reader), *_rings(picture.loads, governing, reader)]
    heading = Sentence(
        "Output bearing of {gear}: {condition}, model {model}",
        {"gear": picture.gear.name, "condition": picture.condition, "model": picture.load.model},
    )
    return {"data": data, "layout": _layout(picture.gear, picture.loads, heading, picture.load, reader)}


def sizes_figure(
    uses: Sequence[SizeUse], picture: BearingPicture, reader: Reader = DEFAULT, governing: Sequence[int] = ()
) -> Figure:
    """Permissible constant load of each size, with the loads of the phases."""
    drawn = [(use, use.curve) for use in uses if use.curve is not None]
    data = [
        _size(curve, use.gear, SIZE_STYLES[place % len(SIZE_STYLES)], reader)
        for place, (use, curve) in enumerate(drawn)
    ]
    loads = picture.loads[:LABELLED_LOADS]
    data += [_points(loads, reader, with_use=False), *_rings(loads, governing, reader)]
    heading = Sentence(
        "Permissible constant load of each size: {condition}, f_w = {f_w}",
        {"condition": picture.condition, "f_w": Quantity(picture.load.load_coefficient, "")},
    )
    largest = max((use.gear for use, _ in drawn), key=lambda gear: gear.dynamic_radial_load_N or 0.0, default=None)
    return {"data": data, "layout": _layout(largest, picture.loads, heading, picture.load, reader)}


# --- Curves -----------------------------------------------------------------------------------------------------------


def _size(curve: EnvelopeCurve, gear: Gear, style: tuple[str, str], reader: Reader) -> Figure:
    """Curve of a size, whose name stands where it starts on the axial axis."""
    figure = _curve(curve, "size", Sentence("{gear}", {"gear": gear.name}), style, reader)
    return figure | _labelled(gear.size, len(curve.radial_N), 0)


def _labelled(label: str, corners: int, place: int) -> Figure:
    """Name of a curve on one of its corners: 0 on the axial axis, -1 on the radial one."""
    return {
        "text": [label if corner == place % corners else "" for corner in range(corners)],
        "mode": "lines+text",
        "textposition": "top right",
        "textfont": {"size": 11, "shadow": HALO},
    }


def _ends(curves: Sequence[NamedCurve], reach: Place) -> list[int]:
    """Corner of each curve for its name, 0 or -1: that with most room, up to what a name needs on each axis."""
    needed = {0: NAME_HEIGHT * reach[1], -1: NAME_WIDTH * reach[0]}
    taken: dict[int, list[float]] = {0: [], -1: []}
    ends = []
    for named in curves:
        at = {0: named.curve.axial_N[0], -1: named.curve.radial_N[-1]}
        room = {end: min((abs(at[end] - other) / needed[end] for other in taken[end]), default=1.0) for end in at}
        end = max((-1, 0) if named.kind == "published" else (0, -1), key=lambda end: min(room[end], 1.0))
        taken[end].append(at[end])
        ends.append(end)
    return ends


def _named(named: NamedCurve, picture: BearingPicture, end: int, reader: Reader) -> Figure:
    """Curve with its name in the drawing at one of its ends."""
    style = PRINTED_STYLES[named.curve.load_coefficient] if named.kind == "life" else STYLES[named.kind]
    figure = _curve(named.curve, named.kind, named.name, style, reader)
    figure |= _labelled(_name(named, picture, reader), len(named.curve.radial_N), end)
    if named.kind != "own":
        return figure
    figure["line"]["width"] = 3
    return figure | {"fill": "tozeroy", "fillcolor": "var(--area)"}


def _name(named: NamedCurve, picture: BearingPicture, reader: Reader) -> str:
    """Name on a curve; none on the published one where it is the limit now."""
    names = {
        "own": reader.text(N_("limit now")),
        "life": coefficient_name(named.curve.load_coefficient, reader),
        "published": reader.text(N_("single load")) if picture.life_factor < 1 else "",
        "equivalent": "P_m",
    }
    return indexed(names[named.kind])


def _curve(curve: EnvelopeCurve, kind: str, name: Sentence, style: tuple[str, str], reader: Reader) -> Figure:
    colour, dash = style
    title = said(name, reader)
    return {
        "type": "scatter",
        "mode": "lines",
        "name": title,
        "x": shown(curve.radial_N, "N", reader),
        "y": shown(curve.axial_N, "N", reader),
        "line": {"color": colour, "width": 2, "dash": dash},
        "hovertext": [
            f"{title}<br>{_spelt(*corner, reader)}" for corner in zip(curve.radial_N, curve.axial_N, strict=True)
        ],
        "hoverinfo": "text",
        "meta": {"kind": kind, "load_coefficient": curve.load_coefficient},
    }


def _spelt(radial_N: float, axial_N: float, reader: Reader) -> str:
    values: dict[str, Value] = {"radial": Quantity(radial_N, "N", 4), "axial": Quantity(axial_N, "N", 4)}
    return said(Sentence("radial {radial}, axial {axial}", values), reader)


def _distance(worst: PhaseLoad, reader: Reader) -> Figure:
    """Line from the worst phase's load to the published envelope, along the load's own direction."""
    edge = min(worst.allowed / worst.published, 1e6)
    name = Sentence("From phase {phase} to the limit of a single load in its direction", {"phase": worst.places[0] + 1})
    return {
        "type": "scatter",
        "mode": "lines",
        "name": said(name, reader),
        "x": shown([worst.radial_N, worst.radial_N * edge], "N", reader),
        "y": shown([worst.axial_N, worst.axial_N * edge], "N", reader),
        "line": {"color": "var(--plot-load)", "width": 1.5, "dash": "dot"},
        "hoverinfo": "skip",
        "meta": {"kind": "distance"},
    }


# --- Loads ------------------------------------------------------------------------------------------------------------


def _points(loads: Sequence[PhaseLoad], reader: Reader, *, with_use: bool = True) -> Figure:
    is_named = len(loads) <= LABELLED_LOADS
    template = N_("phase {phases}") if len(loads) <= SPELT_OUT else "{phases}"
    return points("phases", size=10) | {
        "mode": "markers+text" if is_named else "markers",
        "name": said(Sentence("Loads of the phases"), reader),
        "x": shown((load.radial_N for load in loads), "N", reader),
        "y": shown((load.axial_N for load in loads), "N", reader),
        "text": [said(Sentence(template, {"phases": load.phases}), reader) for load in loads],
        "textposition": _positions(loads) if is_named else "top right",
        "textfont": {"color": "var(--ink)", "size": 12, "shadow": HALO},
        "hovertext": [_hover(load, reader, with_use=with_use) for load in loads],
    }


def _rings(loads: Sequence[PhaseLoad], governing: Sequence[int], reader: Reader) -> list[Figure]:
    """Trace of rings around the loads of the phases that govern, none where there is no such load."""
    places = set(governing)
    at = [(load.radial_N, load.axial_N) for load in loads if not places.isdisjoint(load.places)]
    marker = {"size": 18, "symbol": "diamond-open", "color": "var(--governing)", "line": {"width": 2}}
    return _marks("governing", said(Sentence("Governing phase"), reader), marker, at, reader)


def _given(loads: Sequence[PhaseLoad], reader: Reader) -> list[Figure]:
    """Trace of hollow points of the loads as they act, none where all act at the shaft's centre."""
    at = [(load.given_N, load.axial_N) for load in loads if load.has_lever]
    marker = {"size": 9, "symbol": "circle-open", "color": "var(--ink)", "line": {"width": 1.5}}
    return _marks("given", said(Sentence("Load where it acts"), reader), marker, at, reader)


def _marks(kind: str, name: str, marker: Figure, at: Sequence[tuple[float, float]], reader: Reader) -> list[Figure]:
    """Trace of open marks at radial and axial loads in N, none where there is no load."""
    trace = points(kind, size=marker["size"]) | {
        "mode": "markers",
        "name": name,
        "marker": marker,
        "x": shown((radial for radial, _ in at), "N", reader),
        "y": shown((axial for _, axial in at), "N", reader),
        "hoverinfo": "skip",
    }
    return [trace] if at else []


def _hover(load: PhaseLoad, reader: Reader, *, with_use: bool) -> str:
    text = said(Sentence("phase {phases}", {"phases": escape(load.spoken)}), reader) + "<br>"
    text += _spelt(load.radial_N, load.axial_N, reader)
    if with_use:
        used: dict[str, Value] = {"used": share(load.published)}
        text += "<br>" + said(Sentence("{used} of the published maximum", used), reader)
    return text


_SIDES = {"top right": (1, 1), "bottom right": (1, -1), "top left": (-1, 1), "bottom left": (-1, -1)}


def _positions(loads: Sequence[PhaseLoad]) -> list[str]:
    """Side of each point on which its label is furthest from the other points and labels."""
    width = max((load.radial_N for load in loads), default=0.0) or 1.0
    height = max((load.axial_N for load in loads), default=0.0) or 1.0
    taken = [(load.radial_N / width, load.axial_N / height) for load in loads]
    sides = []
    for own in range(len(loads)):
        side, place = _roomiest(taken[own], [*taken[:own], *taken[own + 1 :]])
        taken.append(place)
        sides.append(side)
    return sides


def _roomiest(point: Place, others: Sequence[Place]) -> tuple[str, Place]:
    """Side of a point on which there is most room, up to what a label needs, and where the label stands there."""
    x, y = point
    offered = {side: (x + 0.05 * dx, y + 0.04 * dy) for side, (dx, dy) in _SIDES.items()}
    side = max(offered, key=lambda side: min(_room(offered[side], others), 0.12))
    return side, offered[side]


def _room(place: Place, others: Sequence[Place]) -> float:
    """Distance of a place to the nearest of some others; there is none beyond the axes."""
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
        title=said(heading, reader),
        note=reader.text(ENVELOPE_BASIS[load.model]),
        revision=f"{gear and gear.size} {radial:g} {axial:g}",
    )
    measure = reader.measure("N")
    figure["xaxis"]["range"] = [0, measure.shown(radial) * 1.08]
    figure["yaxis"]["range"] = [0, measure.shown(axial) * 1.08]
    return figure


def _reach(gear: Gear | None, loads: Sequence[PhaseLoad]) -> Place:
    """Ends of the radial and the axial axis in N."""
    radial = widened((gear and gear.dynamic_radial_load_N) or 1000.0, [load.radial_N for load in loads])
    axial = widened((gear and gear.dynamic_axial_load_N) or 1000.0, [load.axial_N for load in loads])
    return radial, axial

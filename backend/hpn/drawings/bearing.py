"""Plots of the output bearing: radial load on the x axis, axial load on the y axis, axes fixed per size."""

from collections.abc import Sequence
from math import hypot

from hpn.application import OutputLoad
from hpn.drawings.picture import BearingPicture, NamedCurve, PhaseLoad, condition, phase_loads
from hpn.drawings.words import ENGLISH, STANDING, STANDING_SUPPLIED, Figure, Words, layout, share, widened
from hpn.envelopes import EnvelopeCurve, life_envelopes
from hpn.gear import Gear
from hpn.selection import Selection
from hpn.wording import N_, Quantity, Sentence, Value

LABELLED_LOADS = 40
"""Loads up to which each is named in the plot."""

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


def bearing_figure(picture: BearingPicture, words: Words = ENGLISH) -> Figure:
    """Envelopes and loads of one candidate."""
    load = picture.load
    curves = sorted(
        picture.named_curves, key=lambda named: ("life", "own", "published", "equivalent").index(named.kind)
    )
    data = [_named(named, words) for named in curves]
    if picture.worst.published > 0:
        data.append(_distance(picture.worst, words))
    data.append(_points(picture.loads, words))
    heading = Sentence(
        "Output bearing of {gear} at {speed} for {life} ({basis}), model {model}",
        {
            "gear": picture.gear.name,
            "speed": Quantity(picture.average_output_speed_rpm, "rpm"),
            "life": Quantity(load.life_h, "h", 6),
            "basis": load.life_basis,
            "model": load.model,
        },
    )
    return {"data": data, "layout": _layout(picture.gear, picture.loads, heading, load, words)}


def sizes_figure(selection: Selection, words: Words = ENGLISH) -> Figure:
    """Life envelopes of every size at the application's speed, life and load coefficient, with its loads."""
    load, query, catalogue = selection.load or OutputLoad(), condition(selection), selection.catalogue
    drawn: list[Gear] = []
    data: list[Figure] = []
    for place, size in enumerate(catalogue.sizes):
        gear = catalogue.find_size(size)
        if gear is None or not _has_envelope(selection, gear, load):
            continue
        own = next(c for c in life_envelopes(catalogue, gear, query) if c.load_coefficient == load.load_coefficient)
        style = SIZE_STYLES[place % len(SIZE_STYLES)]
        data.append(
            _curve(own, "size", Sentence("{gear}", {"gear": gear.name}), style, words) | {"text": _at_start(own, gear)}
        )
        data[-1] |= {"mode": "lines+text", "textposition": "top right", "textfont": {"size": 11, "shadow": HALO}}
        drawn.append(gear)
    count = len(selection.application.duty_cycle.phases)
    loads = phase_loads(selection, [0.0] * count) if selection.load else []
    if loads:
        data.append(_points(loads[:LABELLED_LOADS], words, with_use=False))
    heading = Sentence(
        "Constant load that each size carries at {speed} for {life} ({basis}), f_w = {f_w}",
        {
            "speed": Quantity(query.speed_rpm, "rpm"),
            "life": Quantity(load.life_h, "h", 6),
            "basis": load.life_basis,
            "f_w": Quantity(load.load_coefficient, ""),
        },
    )
    largest = max(drawn, key=lambda gear: gear.dynamic_radial_load_N or 0.0, default=None)
    return {"data": data, "layout": _layout(largest, loads, heading, load, words)}


def _has_envelope(selection: Selection, gear: Gear, load: OutputLoad) -> bool:
    if load.model == "digitised":
        return gear.size in selection.catalogue.curves
    return bool(gear.dynamic_radial_load_N and gear.dynamic_axial_load_N)


def _at_start(curve: EnvelopeCurve, gear: Gear) -> list[str]:
    """Name of a size where its curve starts on the axial axis."""
    return [gear.size, *("" for _ in curve.radial_N[1:])]


def _named(named: NamedCurve, words: Words) -> Figure:
    style = PRINTED_STYLES[named.curve.load_coefficient] if named.kind == "life" else STYLES[named.kind]
    figure = _curve(named.curve, named.kind, named.name, style, words)
    if named.kind != "own":
        return figure
    figure["line"]["width"] = 3
    return figure | {"fill": "tozeroy", "fillcolor": "var(--plot-own-soft)"}


def _curve(curve: EnvelopeCurve, kind: str, name: Sentence, style: tuple[str, str], words: Words) -> Figure:
    colour, dash = style
    title = words.say(name)
    return {
        "type": "scatter",
        "mode": "lines",
        "name": title,
        "x": words.convert_all(curve.radial_N, "N"),
        "y": words.convert_all(curve.axial_N, "N"),
        "line": {"color": colour, "width": 2, "dash": dash},
        "hovertext": [
            f"{title}<br>{_spelt(*corner, words)}" for corner in zip(curve.radial_N, curve.axial_N, strict=True)
        ],
        "hoverinfo": "text",
        "meta": {"kind": kind, "load_coefficient": curve.load_coefficient},
    }


def _spelt(radial_N: float, axial_N: float, words: Words) -> str:
    values: dict[str, Value] = {"radial": Quantity(radial_N, "N", 4), "axial": Quantity(axial_N, "N", 4)}
    return words.say(Sentence("radial {radial}, axial {axial}", values))


def _points(loads: Sequence[PhaseLoad], words: Words, *, with_use: bool = True) -> Figure:
    named = len(loads) <= LABELLED_LOADS
    template = N_("phase {phases}") if len(loads) <= SPELT_OUT else "{phases}"
    labels = [words.say(Sentence(template, {"phases": load.phases})) for load in loads]
    return {
        "type": "scatter",
        "mode": "markers+text" if named else "markers",
        "name": words.say(Sentence("Loads of the phases")),
        "x": words.convert_all((load.radial_N for load in loads), "N"),
        "y": words.convert_all((load.axial_N for load in loads), "N"),
        "text": labels,
        "textposition": _positions(loads) if named else "top right",
        "textfont": {"color": "var(--ink)", "size": 12, "shadow": HALO},
        "cliponaxis": False,
        "marker": {
            "size": 10,
            "color": "var(--plot-load)",
            "symbol": "diamond",
            "line": {"color": "var(--card)", "width": 1},
        },
        "hovertext": [_hover(load, words, with_use=with_use) for load in loads],
        "hoverinfo": "text",
        "meta": {"kind": "phases"},
    }


def _hover(load: PhaseLoad, words: Words, *, with_use: bool) -> str:
    text = words.say(Sentence("phase {phases}", {"phases": load.phases})) + "<br>"
    text += _spelt(load.radial_N, load.axial_N, words)
    if with_use:
        used: dict[str, Value] = {"used": share(load.published)}
        text += "<br>" + words.say(Sentence("{used} of the published maximum", used))
    return text


_SIDES = {"top right": (1, 1), "bottom right": (1, -1), "top left": (-1, 1), "bottom left": (-1, -1)}


def _positions(loads: Sequence[PhaseLoad]) -> list[str]:
    """Side of each point on which its label is furthest from the other points and labels."""
    width = max((load.radial_N for load in loads), default=0.0) or 1.0
    height = max((load.axial_N for load in loads), default=0.0) or 1.0
    places = [(load.radial_N / width, load.axial_N / height) for load in loads]
    taken, sides = list(places), []
    for own, (x, y) in enumerate(places):
        offered = {side: (x + 0.05 * dx, y + 0.04 * dy) for side, (dx, dy) in _SIDES.items()}
        others = [place for index, place in enumerate(taken) if index != own]

        def room(
            side: str, offered: dict[str, tuple[float, float]] = offered, others: list[tuple[float, float]] = others
        ) -> float:
            u, v = offered[side]
            return min((hypot(u - a, v - b) for a, b in others), default=1.0) if v > 0 and u > 0 else -1.0

        best = max(_SIDES, key=lambda side: min(room(side), 0.12))
        taken.append(offered[best])
        sides.append(best)
    return sides


def _distance(worst: PhaseLoad, words: Words) -> Figure:
    """Line from the worst phase's load to the published envelope, along the load's own direction."""
    edge = min(1 / worst.published, 1e6)
    name = words.say(
        Sentence("From phase {phase} to the published maximum along its own direction", {"phase": worst.places[0] + 1})
    )
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": words.convert_all([worst.radial_N, worst.radial_N * edge], "N"),
        "y": words.convert_all([worst.axial_N, worst.axial_N * edge], "N"),
        "line": {"color": "var(--plot-load)", "width": 1.5, "dash": "dot"},
        "hoverinfo": "skip",
        "meta": {"kind": "distance"},
    }


def _layout(gear: Gear | None, loads: Sequence[PhaseLoad], heading: Sentence, load: OutputLoad, words: Words) -> Figure:
    note = words.translate(STANDING_SUPPLIED if load.model == "digitised" else STANDING)
    radial = widened((gear and gear.dynamic_radial_load_N) or 1000.0, [load.radial_N for load in loads])
    axial = widened((gear and gear.dynamic_axial_load_N) or 1000.0, [load.axial_N for load in loads])
    figure = layout(
        words,
        words.axis(N_("radial load"), "N"),
        words.axis(N_("axial load"), "N"),
        title=words.say(heading),
        note=note,
        revision=f"{gear and gear.size} {radial:g} {axial:g}",
    )
    figure["xaxis"]["range"] = [0, words.convert(radial, "N") * 1.08]
    figure["yaxis"]["range"] = [0, words.convert(axial, "N") * 1.08]
    return figure

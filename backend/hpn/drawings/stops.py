"""Allowed number of emergency stops against their torque, with the user's stop, as a plot and in words."""

from math import ceil, inf, log10

import numpy as np

from hpn import equations
from hpn.drawings.words import ENGLISH, Figure, Words, layout, share, widened
from hpn.gear import Gear
from hpn.selection import Selection
from hpn.wording import N_, Quantity, Sentence, Value

TOP = 8
"""Power of ten at which the axis of the number ends, unless more stops are expected."""

LOW = 10
"""Number of stops below which a label has no room under its point."""


def emergency_stop_figure(selection: Selection, gear: Gear, words: Words = ENGLISH) -> Figure | None:
    """Allowed number of emergency stops against their torque (equation 17.9), with the user's stop on it.

    None where the gear's ratings are not published.
    """
    T_R, T_M = gear.repeated_peak_torque_Nm, gear.momentary_peak_torque_Nm
    if T_R is None or T_M is None:
        return None
    stop = selection.application.emergency_stop
    T_k = abs(stop.torque_Nm) if stop else 0.0
    top = max(TOP, ceil(log10(stop.count)) if stop and stop.count else 0)
    torque = np.linspace(T_R, max(T_M, T_R), 60)
    marked = _stop(selection, gear, top, words)
    beyond = any("top" in stop["textposition"] for stop in marked)
    data = [_line(torque.tolist(), (10 ** (8.5 - 1.5 * torque / T_R)).tolist(), words, named_below=beyond)]
    figure = layout(
        words,
        words.axis(N_("emergency-stop torque T_k"), "Nm"),
        words.translate(N_("number of stops")),
        title=words.say(Sentence("Allowed emergency stops of {gear}, equation 17.9", {"gear": gear.designation})),
        revision=gear.designation,
    )
    edge = [words.convert(T, "Nm") for T in (T_R, T_M)]
    figure["shapes"] = [_free(edge[0]), *(_vertical(x) for x in edge)]
    figure["annotations"] = [_label(edge[0], "T<sub>R</sub>"), _label(edge[1], "T<sub>M</sub>"), _free_label(words)]
    figure["xaxis"]["range"] = [0, words.convert(widened(T_M, [T_k]), "Nm") * 1.06]
    figure["yaxis"] |= {
        "type": "log",
        "range": [0, top],
        "exponentformat": "power",
        "dtick": 1,
        "tickfont": {"size": 11},
    }
    return {"data": [*data, *marked], "layout": figure}


def _line(torque: list[float], number: list[float], words: Words, *, named_below: bool) -> Figure:
    name = words.say(Sentence("Allowed number N_k max"))
    named = len(torque) // (2 if named_below else 4)
    return {
        "type": "scatter",
        "mode": "lines+text",
        "name": name,
        "text": [name if place == named else "" for place in range(len(torque))],
        "textposition": "bottom left" if named_below else "top right",
        "textfont": {"color": "var(--ink)", "size": 12},
        "x": words.convert_all(torque, "Nm"),
        "y": number,
        "line": {"color": "var(--plot-own)", "width": 3},
        "fill": "tozeroy",
        "fillcolor": "var(--plot-own-soft)",
        "hovertext": [
            words.say(
                Sentence("{torque}: {number} stops", {"torque": Quantity(T, "Nm"), "number": Quantity(int(N), "", 7)})
            )
            for T, N in zip(torque, number, strict=True)
        ],
        "hoverinfo": "text",
        "meta": {"kind": "allowed"},
    }


def _stop(selection: Selection, gear: Gear, top: int, words: Words) -> list[Figure]:
    stop, allowed = selection.application.emergency_stop, allowed_stops(selection, gear)
    if stop is None or allowed is None:
        return []
    number = float(stop.count) if stop.count else min(allowed, 10.0**top)
    if number <= 0:
        return []
    name = words.say(Sentence("your stops") if stop.count else Sentence("your stop torque"))
    # Its label stands on the other side of the line than the line's own, and not on the numbers of the axis.
    side = "top" if number > allowed * (1 + 1e-9) or number < LOW else "bottom"
    return [
        {
            "type": "scatter",
            "mode": "markers+text",
            "name": name,
            "text": [name],
            "textposition": f"{side} left",
            "textfont": {"color": "var(--ink)", "size": 12},
            "x": [words.convert(abs(stop.torque_Nm), "Nm")],
            "y": [number],
            "cliponaxis": False,
            "marker": {
                "size": 12,
                "color": "var(--plot-load)",
                "symbol": "diamond",
                "line": {"color": "var(--card)", "width": 1},
            },
            "hovertext": [f"{name}<br>{words.show(Quantity(abs(stop.torque_Nm), 'Nm'))}"],
            "hoverinfo": "text",
            "meta": {"kind": "stop"},
        }
    ]


def allowed_stops(selection: Selection, gear: Gear) -> float | None:
    """Allowed number at the user's torque, infinite at or below T_R; None without a stop or a rating."""
    stop, T_R = selection.application.emergency_stop, gear.repeated_peak_torque_Nm
    if stop is None or T_R is None:
        return None
    return float(
        equations.allowed_momentary_peaks(emergency_stop_torque_Nm=abs(stop.torque_Nm), repeated_peak_torque_Nm=T_R)
    )


def emergency_stop_words(selection: Selection, gear: Gear) -> list[Sentence]:
    """How many stops are allowed at the user's torque, and how much of that budget they use."""
    stop, T_R, T_M = selection.application.emergency_stop, gear.repeated_peak_torque_Nm, gear.momentary_peak_torque_Nm
    if T_R is None or T_M is None:
        return [Sentence("Not rated: the peak torques of {gear} are not published.", {"gear": gear.name})]
    allowed = allowed_stops(selection, gear)
    if stop is None or allowed is None:
        return [Sentence("Enter an emergency-stop torque to see how many such stops this gear allows.")]
    torque: dict[str, Value] = {"torque": Quantity(abs(stop.torque_Nm), "Nm", 6)}
    too_hard = abs(stop.torque_Nm) > T_M * (1 + equations.ROUNDING)
    excess = [
        Sentence("{torque} is above T_M = {limit}, whatever the number.", torque | {"limit": Quantity(T_M, "Nm", 6)})
    ]
    if allowed == inf:
        return [
            Sentence(
                "{torque} is at or below T_R = {limit}: equation 17.9 sets no limit to the number.",
                torque | {"limit": Quantity(T_R, "Nm", 6)},
            )
        ]
    return [*(excess if too_hard else []), _budget(stop.count, allowed, torque)]


def _budget(count: int | None, allowed: float, torque: dict[str, Value]) -> Sentence:
    if allowed < 1:
        return Sentence("At {torque} equation 17.9 allows not even one stop.", torque)
    values = torque | {"allowed": Quantity(allowed, "", 12)}
    if count is None:
        return Sentence("At {torque} equation 17.9 allows {allowed} stops over the life.", values)
    used: dict[str, Value] = {"count": Quantity(count, "", 16), "used": share(count / allowed)}
    return Sentence(
        "At {torque} equation 17.9 allows {allowed} stops over the life; your {count} use {used} of that budget.",
        values | used,
    )


def _free(x: float) -> Figure:
    """Region at and below T_R, where the equation sets no limit."""
    return {
        "type": "rect",
        "x0": 0,
        "x1": x,
        "y0": 0,
        "y1": 1,
        "yref": "paper",
        "layer": "below",
        "fillcolor": "var(--plot-own-soft)",
        "line": {"width": 0},
    }


def _free_label(words: Words) -> Figure:
    return {
        "x": 0.01,
        "xref": "paper",
        "y": 0.02,
        "yref": "paper",
        "xanchor": "left",
        "yanchor": "bottom",
        "text": words.say(Sentence("no limit by equation 17.9")),
        "showarrow": False,
        "font": {"size": 12, "color": "var(--muted)"},
    }


def _vertical(x: float) -> Figure:
    return {
        "type": "line",
        "x0": x,
        "x1": x,
        "y0": 0,
        "y1": 1,
        "yref": "paper",
        "line": {"color": "var(--edge)", "width": 1, "dash": "dot"},
    }


def _label(x: float, text: str) -> Figure:
    return {
        "x": x, "y": 1, "yref": "paper", "text": text, "showarrow": False, "xanchor": "left", "yanchor": "top",
    }  # fmt: skip

"""Allowed number of emergency stops against their torque, with the user's stop, as a plot and in words."""

from math import ceil, inf, log10

import numpy as np

from hpn.explain.drawings.axis import widened
from hpn.explain.drawings.layout import Figure, layout, points
from hpn.explain.drawings.subject import Subject
from hpn.explain.drawings.words import axis_title, said, share, shown
from hpn.physics import equations
from hpn.physics.equations import FloatArray
from hpn.words.reader import DEFAULT, Reader
from hpn.words.wording import N_, Quantity, Sentence, Value

TOP = 8
"""Power of ten at which the axis of the number ends, unless more stops are expected."""

LOW = 10
"""Number of stops below which a label has no room under its point."""

DRAWN_TORQUES = 60


def emergency_stop_figure(subject: Subject, reader: Reader = DEFAULT) -> Figure | None:
    """Allowed number of emergency stops against their torque (equation 17.9), with the user's stop on it.

    None where the gear's ratings are not published.
    """
    gear = subject.gear
    T_R, T_M = gear.repeated_peak_torque_Nm, gear.momentary_peak_torque_Nm
    if T_R is None or T_M is None:
        return None
    stop = subject.application.emergency_stop
    top = max(TOP, ceil(log10(stop.count)) if stop and stop.count else 0)
    torque = np.linspace(T_R, max(T_M, T_R), DRAWN_TORQUES)
    number = equations.momentary_peaks_at(emergency_stop_torque_Nm=torque, repeated_peak_torque_Nm=T_R)
    marked = _stop(subject, top, reader)
    is_beyond = any("top" in point["textposition"] for point in marked)
    return {
        "data": [_line(torque, number, reader, named_below=is_beyond), *marked],
        "layout": _layout(subject, T_R, T_M, top, reader),
    }


def _layout(subject: Subject, T_R: float, T_M: float, top: int, reader: Reader) -> Figure:
    designation, torque = subject.gear.designation, reader.measure("Nm")
    figure = layout(
        reader,
        axis_title(N_("emergency-stop torque T_k"), "Nm", reader),
        reader.text(N_("number of stops")),
        title=said(Sentence("Permitted emergency stops of {gear}, equation 17.9", {"gear": designation}), reader),
        revision=designation,
    )
    edge = [torque.shown(T_R), torque.shown(T_M)]
    figure["shapes"] = [_free(edge[0]), *map(_vertical, edge)]
    figure["annotations"] = [_label(edge[0], "T<sub>R</sub>"), _label(edge[1], "T<sub>M</sub>"), _free_label(reader)]
    figure["xaxis"]["range"] = [0, torque.shown(widened(T_M, [subject.emergency_stop_torque_Nm or 0.0])) * 1.06]
    figure["yaxis"] |= {
        "type": "log",
        "range": [0, top],
        "exponentformat": "power",
        "dtick": 1,
        "tickfont": {"size": 11},
    }
    return figure


def _line(torque: FloatArray, number: FloatArray, reader: Reader, *, named_below: bool) -> Figure:
    name = said(Sentence("Permitted number N_k,max"), reader)
    named = len(torque) // (2 if named_below else 4)
    return {
        "type": "scatter",
        "mode": "lines+text",
        "name": name,
        "text": [name if place == named else "" for place in range(len(torque))],
        "textposition": "bottom left" if named_below else "top right",
        "textfont": {"color": "var(--ink)", "size": 12},
        "x": shown(torque.tolist(), "Nm", reader),
        "y": number.tolist(),
        "line": {"color": "var(--ink)", "width": 3},
        "fill": "tozeroy",
        "fillcolor": "var(--area)",
        "hovertext": [
            said(
                Sentence("{torque}: {number} stops", {"torque": Quantity(T, "Nm"), "number": Quantity(int(N), "", 7)}),
                reader,
            )
            for T, N in zip(torque.tolist(), number.tolist(), strict=True)
        ],
        "hoverinfo": "text",
        "meta": {"kind": "allowed"},
    }


def _stop(subject: Subject, top: int, reader: Reader) -> list[Figure]:
    stop, torque = subject.application.emergency_stop, subject.emergency_stop_torque_Nm
    allowed = allowed_stops(subject)
    if stop is None or torque is None or allowed is None:
        return []
    number = float(stop.count) if stop.count else min(allowed, 10.0**top)
    if number <= 0:
        return []
    name = said(Sentence("your stops") if stop.count else Sentence("your stop torque"), reader)
    # Its label stands on the other side of the line than the line's own, and not on the numbers of the axis.
    side = "top" if number > allowed * (1 + 1e-9) or number < LOW else "bottom"
    return [
        points("stop", size=12)
        | {
            "mode": "markers+text",
            "name": name,
            "text": [name],
            "textposition": f"{side} left",
            "textfont": {"color": "var(--ink)", "size": 12},
            "x": shown([torque], "Nm", reader),
            "y": [number],
            "hovertext": [f"{name}<br>{reader.quantity(Quantity(torque, 'Nm'))}"],
        }
    ]


def allowed_stops(subject: Subject) -> float | None:
    """Allowed number at the user's torque, infinite at or below T_R; None without a stop or a rating."""
    torque, T_R = subject.emergency_stop_torque_Nm, subject.gear.repeated_peak_torque_Nm
    if torque is None or T_R is None:
        return None
    return equations.allowed_momentary_peaks(emergency_stop_torque_Nm=torque, repeated_peak_torque_Nm=T_R).item()


# --- In words ---------------------------------------------------------------------------------------------------------


def emergency_stop_words(subject: Subject) -> list[Sentence]:
    """How many stops are allowed at the user's torque, and how much of that budget they use."""
    gear, stop, torque = subject.gear, subject.application.emergency_stop, subject.emergency_stop_torque_Nm
    T_R, T_M, allowed = gear.repeated_peak_torque_Nm, gear.momentary_peak_torque_Nm, allowed_stops(subject)
    if T_R is None or T_M is None:
        return [
            Sentence("Not rated: the peak torques of {gear} are not in this catalogue’s source.", {"gear": gear.name})
        ]
    if stop is None or torque is None or allowed is None:
        return [Sentence("Enter an emergency-stop torque to see how many such stops this gear permits.")]
    given: dict[str, Value] = {"torque": Quantity(torque, "Nm", 6)}
    if allowed == inf:
        return [
            Sentence(
                "{torque} is at or below T_R = {limit}: equation 17.9 sets no limit to the number.",
                given | {"limit": Quantity(T_R, "Nm", 6)},
            )
        ]
    budget = _budget(stop.count, allowed, given)
    if torque <= T_M * (1 + equations.ROUNDING):
        return [budget]
    values = given | {"limit": Quantity(T_M, "Nm", 6)}
    return [Sentence("{torque} is above T_M = {limit}, whatever the number.", values), budget]


def _budget(count: int | None, allowed: float, torque: dict[str, Value]) -> Sentence:
    if allowed < 1:
        return Sentence("At {torque} no emergency stop is permitted (eq. 17.9).", torque)
    values = torque | {"allowed": Quantity(allowed, "", 12)}
    if count is None:
        return Sentence("At {torque} equation 17.9 permits {allowed} stops over the life.", values)
    used: dict[str, Value] = {"count": Quantity(count, "", 16), "used": share(count / allowed)}
    return Sentence(
        "At {torque} equation 17.9 permits {allowed} stops over the life; your {count} use {used} of them.",
        values | used,
    )


# --- Parts of the plot ------------------------------------------------------------------------------------------------


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
        "fillcolor": "var(--area)",
        "line": {"width": 0},
    }


def _free_label(reader: Reader) -> Figure:
    return {
        "x": 0.01,
        "xref": "paper",
        "y": 0.02,
        "yref": "paper",
        "xanchor": "left",
        "yanchor": "bottom",
        "text": said(Sentence("no limit by equation 17.9"), reader),
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

"""Plots of a selection as plain Plotly figures: data and axes here, colours of the page's theme in the browser.

Radial load lies on the x axis, axial load on the y axis. Axes are fixed per size, and widen in steps only where a load
lies outside, so that the picture doesn't jump while somebody types.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hpn import bearing, equations
from hpn.application import OutputLoad
from hpn.checks import BearingCase
from hpn.envelopes import EnvelopeCurve, EnvelopeQuery, envelope_curve, life_envelopes
from hpn.gear import Gear
from hpn.selection import Selection
from hpn.wording import Quantity, Sentence, Value

Figure = dict[str, Any]
FloatArray = NDArray[np.float64]
MAXIMUM_LABELLED_PHASES = 200
COLOURS = ("#3b82c4", "#2a9d8f", "#c77d2e", "#8f6bb3", "#c2577a")
STEPS = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)


@dataclass(frozen=True, slots=True)
class BearingPicture:
    """Loads of one application on the output bearing of one candidate, everything that plot, table and verdict need.

    Loads are magnitudes in N by phase; `published` is f_w P of each phase (1 on the published envelope over f_w),
    `mean` is P_m without f_w, `life_utilisation` f_w P_m over k.
    """

    gear: Gear
    load: OutputLoad
    radial_N: list[float]
    axial_N: list[float]
    published: list[float]
    mean: float
    life_factor: float
    life_L50_h: float
    average_output_speed_rpm: float
    life_utilisation: float
    curves: list[EnvelopeCurve]
    published_curve: EnvelopeCurve
    mean_curve: EnvelopeCurve

    @property
    def worst(self) -> int:
        """Index of the phase that uses the published envelope most."""
        return int(np.argmax(self.published))

    @property
    def constant_load_utilisation(self) -> float:
        """Share of what a constant load may be: f_w P_m over min(1, k)."""
        return self.mean * self.load.load_coefficient / min(1.0, self.life_factor)


def bearing_picture(selection: Selection, gear: Gear) -> BearingPicture | None:
    """Loads on the bearing of a candidate, or None without loads or where the bearing of its size is not rated."""
    load, case = selection.application.loads, selection.evaluation.case.bearing
    index = selection.gears.rows.index(gear)
    if load is None or case is None or np.isnan(case.mean[selection.index, index]):
        return None
    duty, n = selection.evaluation.case.duty, selection.index
    count = len(selection.application.duty_cycle.phases)
    radial, axial = (component[n, :count].tolist() for component in duty.loads_N)
    speed = duty.average_output_speed_rpm.item(n)
    query = EnvelopeQuery(
        speed_rpm=speed,
        life_h=bearing.required_L50(load.life_h, load.life_basis),
        load_coefficient=load.load_coefficient,
        model=load.model,
    )
    mean, k = float(case.mean[n, index]), case.life_factor.item(n)
    catalogue = selection.catalogue
    return BearingPicture(
        gear=gear,
        load=load,
        radial_N=radial,
        axial_N=axial,
        published=_phase_use(case, n, index, count),
        mean=mean / load.load_coefficient,
        life_factor=k,
        life_L50_h=float(case.life_L50_h[n, index]),
        average_output_speed_rpm=speed,
        life_utilisation=mean / k,
        curves=life_envelopes(catalogue, gear, query),
        published_curve=envelope_curve(catalogue, gear, load.model, load.load_coefficient),
        mean_curve=envelope_curve(catalogue, gear, load.model, 1.0, mean / load.load_coefficient),
    )


def _phase_use(case: BearingCase, application: int, gear: int, count: int) -> list[float]:
    used: list[float] = case.phase_loads[application, :count, gear].tolist()
    return used


def bearing_verdict(picture: BearingPicture) -> list[Sentence]:
    """What the picture says, in words: the life of the cycle, the largest single load, the next f_w, what decides."""
    used, worst = picture.constant_load_utilisation, picture.worst
    sentences = [
        Sentence(
            "The cycle uses {used} of what a constant load may be at {speed} for {life} ({basis}).",
            {
                "used": Quantity(100 * used, "percent"),
                "speed": Quantity(picture.average_output_speed_rpm, "rpm"),
                "life": Quantity(picture.load.life_h, "h", 6),
                "basis": picture.load.life_basis,
            },
        ),
        Sentence(
            "Phase {phase} uses {used} of the published maximum.",
            {"phase": worst + 1, "used": Quantity(100 * picture.published[worst], "percent")},
        ),
        *_next_load_coefficient(picture),
    ]
    if picture.life_utilisation >= picture.published[worst]:
        return [*sentences, Sentence("The life of the bearing decides.")]
    return [*sentences, Sentence("The largest single load decides.")]


def _next_load_coefficient(picture: BearingPicture) -> list[Sentence]:
    """What the next printed load coefficient would do to the first sentence."""
    f_w = picture.load.load_coefficient
    larger = next((printed for printed in bearing.PRINTED_LOAD_COEFFICIENTS if printed > f_w), None)
    if larger is None:
        return []
    used = picture.constant_load_utilisation * larger / f_w
    values: dict[str, Value] = {"coefficient": f"{larger:g}"}
    if used > 1:
        excess = Quantity(100 * (used - 1), "percent")
        return [Sentence("f_w = {coefficient} would exceed the first by {excess}.", values | {"excess": excess})]
    return [Sentence("f_w = {coefficient} would use {used}.", values | {"used": Quantity(100 * used, "percent")})]


def bearing_figure(picture: BearingPicture) -> Figure:
    """Envelopes and loads of one candidate."""
    f_w = picture.load.load_coefficient
    condition = f"{picture.average_output_speed_rpm:.4g} rpm, {picture.load.life_h:g} h {picture.load.life_basis}"
    data = [
        _curve(
            curve,
            f"life envelope, f_w = {curve.load_coefficient:g}{' (yours)' if curve.load_coefficient == f_w else ''}",
            f"constant load at {condition}",
            COLOURS[place % len(COLOURS)],
            width=3 if curve.load_coefficient == f_w else 1.5,
        )
        for place, curve in enumerate(picture.curves)
    ]
    data.append(
        _curve(
            picture.published_curve, f"published maximum over f_w = {f_w:g}", "any single phase", "#7a8794", dash="dot"
        )
    )
    if picture.mean > 0:
        data.append(_curve(picture.mean_curve, "equivalent load P = P_m", "the cycle", "#d1495b", dash="dash"))
    data += [_distance(picture), _points(picture)]
    return {"data": data, "layout": _load_layout(picture.gear, picture.radial_N, picture.axial_N)}


def sizes_figure(selection: Selection) -> Figure:
    """Life envelopes of every size at the application's speed, life and load coefficient, with its loads."""
    load, duty = selection.application.loads or OutputLoad(), selection.evaluation.case.duty
    query = EnvelopeQuery(
        speed_rpm=duty.average_output_speed_rpm.item(selection.index),
        life_h=bearing.required_L50(load.life_h, load.life_basis),
        load_coefficient=load.load_coefficient,
        model=load.model,
    )
    catalogue, rated = selection.catalogue, []
    for size in catalogue.sizes:
        gear = catalogue.find_size(size)
        drawn = load.model != "digitised" or size in catalogue.curves
        if gear and gear.dynamic_radial_load_N and gear.dynamic_axial_load_N and drawn:
            rated.append(gear)
    data = []
    for place, gear in enumerate(rated):
        own = next(c for c in life_envelopes(catalogue, gear, query) if c.load_coefficient == load.load_coefficient)
        data.append(
            _curve(own, gear.name, f"constant load, f_w = {load.load_coefficient:g}", COLOURS[place % len(COLOURS)])
        )
    radial, axial = (part[selection.index].tolist() for part in duty.loads_N)
    count = len(selection.application.duty_cycle.phases)
    data.append(_markers(radial[:count], axial[:count], [f"phase {i}" for i in range(1, count + 1)]))
    largest = max(rated, key=lambda gear: gear.dynamic_radial_load_N or 0.0, default=None)
    return {"data": data, "layout": _load_layout(largest, radial, axial)}


def emergency_stop_figure(selection: Selection, gear: Gear) -> Figure | None:
    """Allowed number of emergency stops against their torque (equation 17.9), with the user's stop on it."""
    stop = selection.application.emergency_stop
    T_R, T_M = gear.repeated_peak_torque_Nm, gear.momentary_peak_torque_Nm
    if stop is None or T_R is None or T_M is None:
        return None
    torque = np.linspace(T_R, T_M, 60)
    number = 10 ** (8.5 - 1.5 * torque / T_R)
    data: list[Figure] = [
        {
            "type": "scatter",
            "mode": "lines",
            "name": "allowed number, equation 17.9",
            "x": torque.tolist(),
            "y": number.tolist(),
            "line": {"color": COLOURS[0], "width": 3},
            "hovertemplate": "%{x:.4g} Nm: %{y:.3s} stops<extra></extra>",
        }
    ]
    T_k = abs(stop.torque_Nm)
    if stop.count:
        data.append(_marker("your stops", T_k, float(stop.count), "%{x:.4g} Nm, %{y} stops expected<extra></extra>"))
    elif T_k > T_R:
        allowed = float(equations.allowed_momentary_peaks(emergency_stop_torque_Nm=T_k, repeated_peak_torque_Nm=T_R))
        if allowed > 0:
            data.append(_marker("your stop", T_k, allowed, "%{x:.4g} Nm, %{y} stops allowed<extra></extra>"))
    right = _widened(T_M, [T_k]) * 1.05
    layout = {
        **_layout("emergency-stop torque T_k in Nm", "number of stops"),
        "shapes": [_vertical(T_R), _vertical(T_M)],
        "annotations": [_label(T_R, "T_R"), _label(T_M, "T_M")],
    }
    layout["xaxis"] |= {"range": [0, right]}
    layout["yaxis"] |= {"type": "log", "range": [0, 8.5], "exponentformat": "power", "dtick": 1}
    return {"data": data, "layout": layout}


def _curve(curve: EnvelopeCurve, name: str, what: str, colour: str, *, dash: str = "solid", width: float = 2) -> Figure:
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": curve.radial_N,
        "y": curve.axial_N,
        "line": {"color": colour, "width": width, "dash": dash},
        "hovertemplate": f"{name}, {what}<br>radial %{{x:.4g}} N, axial %{{y:.4g}} N<extra></extra>",
    }


def _points(picture: BearingPicture) -> Figure:
    shown = slice(0, MAXIMUM_LABELLED_PHASES)
    labels = [f"phase {place}" for place in range(1, len(picture.radial_N) + 1)]
    figure = _markers(picture.radial_N, picture.axial_N, labels)
    figure["customdata"] = [round(100 * used, 6) for used in picture.published[shown]]
    figure["hovertemplate"] = (
        "%{text}<br>radial %{x:.4g} N, axial %{y:.4g} N<br>%{customdata:.3g} % of the published maximum<extra></extra>"
    )
    return figure


def _markers(radial: Sequence[float], axial: Sequence[float], labels: Sequence[str]) -> Figure:
    shown = slice(0, MAXIMUM_LABELLED_PHASES)
    return {
        "type": "scatter",
        "mode": "markers+text" if len(labels) <= 12 else "markers",
        "name": "phases",
        "x": list(radial[shown]),
        "y": list(axial[shown]),
        "text": list(labels[shown]),
        "textposition": "top right",
        "cliponaxis": False,
        "marker": {"size": 9, "color": "#d1495b", "symbol": "diamond"},
        "hovertemplate": "%{text}<br>radial %{x:.4g} N, axial %{y:.4g} N<extra></extra>",
    }


def _distance(picture: BearingPicture) -> Figure:
    """Line from the worst phase's load to the published envelope, along the load's own direction."""
    worst, used = picture.worst, picture.published[picture.worst]
    radial, axial = picture.radial_N[worst], picture.axial_N[worst]
    edge = 1 / used if used > 0 else 1.0
    return {
        "type": "scatter",
        "mode": "lines",
        "name": f"phase {worst + 1} to the published maximum",
        "x": [radial, radial * edge],
        "y": [axial, axial * edge],
        "line": {"color": "#d1495b", "width": 1, "dash": "dot"},
        "hovertemplate": f"phase {worst + 1} uses {100 * used:.3g} % of the published maximum<extra></extra>",
    }


def _load_layout(gear: Gear | None, radial: Sequence[float], axial: Sequence[float]) -> Figure:
    layout = _layout("radial load in N", "axial load in N")
    limits = (gear.dynamic_radial_load_N, gear.dynamic_axial_load_N) if gear else (None, None)
    for axis, limit, loads in zip(("xaxis", "yaxis"), limits, (radial, axial), strict=True):
        layout[axis] |= {"range": [0, _widened(limit or 1000.0, loads) * 1.08]}
    return layout


def _widened(limit: float, values: Sequence[float]) -> float:
    """The limit times the smallest step that holds all values; beyond the last step just what holds them."""
    largest = max(values, default=0.0)
    return next((limit * step for step in STEPS if largest <= limit * step), largest)


def _layout(x: str, y: str) -> Figure:
    return {
        "xaxis": {"title": {"text": x}, "tickmode": "auto", "rangemode": "tozero", "zeroline": True},
        "yaxis": {"title": {"text": y}, "tickmode": "auto", "rangemode": "tozero", "zeroline": True},
        "legend": {"orientation": "h", "x": 0, "y": -0.22, "xanchor": "left", "yanchor": "top"},
        "margin": {"l": 64, "r": 16, "t": 16, "b": 56},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
        "hovermode": "closest",
    }


def _marker(name: str, x: float, y: float, hover: str) -> Figure:
    return {
        "type": "scatter",
        "mode": "markers",
        "name": name,
        "x": [x],
        "y": [y],
        "cliponaxis": False,
        "marker": {"size": 11, "color": "#d1495b", "symbol": "diamond"},
        "hovertemplate": hover,
    }


def _vertical(x: float) -> Figure:
    return {
        "type": "line",
        "x0": x,
        "x1": x,
        "y0": 0,
        "y1": 1,
        "yref": "paper",
        "line": {"color": "#7a8794", "width": 1, "dash": "dot"},
    }


def _label(x: float, text: str) -> Figure:
    return {"x": x, "y": 1, "yref": "paper", "text": text, "showarrow": False, "xanchor": "left", "yanchor": "top"}

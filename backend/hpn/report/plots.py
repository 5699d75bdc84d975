"""Plots as data: lines and labels in a unit square, ticks at round numbers. The template only draws."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from hpn import bearing
from hpn.application import Application
from hpn.bearing import PRINTED_LOAD_COEFFICIENTS
from hpn.duty import Duty
from hpn.report.export import Export
from hpn.report.language import Language
from hpn.report.symbols import formula
from hpn.wording import N_

LABELLED_PHASES = 20
"""Phases up to which each is named in a plot."""

MOST_STEPS = 400
"""Steps up to which a plot over time draws each phase; beyond, the range of each slice of time."""

MOST_POINTS = 400

SMALLEST_SPAN = 1e-200
"""Range below which an axis has no ticks, or shows nothing but zero."""

Point = tuple[float, float]


@dataclass
class Plot:
    """Lines, points and labels in data coordinates, and the axes around them."""

    x_range: Point
    y_range: Point
    x_label: str = ""
    y_label: str = ""
    lines: list[dict[str, Any]] = field(default_factory=list)
    marks: list[dict[str, Any]] = field(default_factory=list)

    def line(self, kind: str, points: Iterable[Point], label: str = "", place: Point | None = None) -> None:
        """Add a line of a kind that the template knows, as far as it is in view, with a label at its own place."""
        for piece in _in_view([self._place(point) for point in points]):
            self.lines.append({"kind": kind, "points": piece})
        if label and place:
            self.mark("label", place, label)

    def mark(self, kind: str, place: Point, text: str = "") -> None:
        """Add a point or a text, where it is in view."""
        at = self._place(place)
        if all(0 <= coordinate <= 1 for coordinate in at):
            self.marks.append({"kind": kind, "at": at, "text": formula(text)})

    def data(self, language: Language) -> dict[str, Any]:
        """Everything in the unit square, y upwards."""
        return {
            "x_label": self.x_label,
            "y_label": self.y_label,
            "x_ticks": _ticks(self.x_range, language),
            "y_ticks": _ticks(self.y_range, language),
            "zero": self._place((self.x_range[0], 0.0))[1],
            "lines": self.lines,
            "marks": self.marks,
        }

    def _place(self, point: Point) -> list[float]:
        return [
            (value - low) / (high - low) for value, (low, high) in zip(point, (self.x_range, self.y_range), strict=True)
        ]


def _in_view(points: Sequence[Sequence[float]]) -> list[list[Sequence[float]]]:
    """Pieces of a line within the unit square; a line that leaves it far behind would take ages to draw dashed."""
    pieces: list[list[Sequence[float]]] = []
    for start, end in pairwise(points):
        low, high = 0.0, 1.0
        for at, to in zip(start, end, strict=True):
            if at == to:
                low, high = (low, high) if 0 <= at <= 1 else (1.0, 0.0)
            else:
                first, second = sorted(((0 - at) / (to - at), (1 - at) / (to - at)))
                low, high = max(low, first), min(high, second)
        if low > high:
            continue
        entry, leave = ([round(a + s * (b - a), 5) for a, b in zip(start, end, strict=True)] for s in (low, high))
        if pieces and pieces[-1][-1] == entry:
            pieces[-1].append(leave)
        else:
            pieces.append([entry, leave])
    return pieces


def _ticks(span: Point, language: Language) -> list[dict[str, Any]]:
    low, high = span
    if high - low < SMALLEST_SPAN:
        return []
    step = _round_step((high - low) / 5)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [{"at": (k * step - low) / (high - low), "text": language.tick(k * step)} for k in range(first, last + 1)]


def _round_step(rough: float) -> float:
    scale = 10.0 ** math.floor(math.log10(rough))
    return scale * next(factor for factor in (1, 2, 2.5, 5, 10) if factor >= rough / scale - 1e-9)


def _span(values: Iterable[float]) -> Point:
    """Range that holds zero and the values, with room for labels."""
    known = [*values, 0.0]
    low, high = min(known), max(known)
    if high - low < SMALLEST_SPAN:
        return 0.0, 1.0
    room = 0.14 * (high - low)
    return (low - room if low < 0 else 0.0, high + room if high > 0 else room)


# --- The cycle over time ----------------------------------------------------------------------------------------------


def cycle(export: Export, language: Language) -> list[dict[str, Any]]:
    """Torque and speed over time, phases as steps and the pause at the end, as in illustration 17.1."""
    application, duty = export.application, export.reply["duty"]
    torque = _over_time(application, "torque_Nm", language.text(N_("Torque in Nm")))
    torque.line(
        "average", [(0.0, T := duty["average_torque_Nm"]), (torque.x_range[1], T)], "T_av", (torque.x_range[1], T)
    )
    speed = _over_time(application, "speed_rpm", language.text(N_("Speed in rpm")))
    speed.line(
        "average",
        [(0.0, n := duty["average_output_speed_rpm"]), (speed.x_range[1], n)],
        "n_out,av",
        (speed.x_range[1], n),
    )
    speed.x_label = language.text(N_("Time in s"))
    _name_phases(application, torque, language)
    return [torque.data(language), speed.data(language)]


def _over_time(application: Application, name: str, label: str) -> Plot:
    phases = application.duty_cycle.phases
    steps, time = [(0.0, 0.0)], 0.0
    for phase in phases:
        value = getattr(phase, name)
        steps += [(time, value), (time + phase.duration_s, value)]
        time += phase.duration_s
    end = time + application.duty_cycle.pause_s
    plot = Plot((0.0, end), _span([*(value for _, value in steps), 0.0]), y_label=label)
    steps += [(time, 0.0), (end, 0.0)]
    if len(phases) <= MOST_STEPS:
        plot.line(name, steps)
    else:
        plot.line(f"range_{name}", _ranges(steps, end))
    return plot


def _ranges(steps: Sequence[Point], end: float) -> list[Point]:
    """Least and largest value in each of MOST_STEPS slices of time."""
    slices: list[list[float]] = [[] for _ in range(MOST_STEPS)]
    for time, value in steps:
        slices[min(int(time / end * MOST_STEPS), MOST_STEPS - 1)].append(value)
    points: list[Point] = []
    for k, values in enumerate(slices):
        if values:
            points += [((k + 0.5) * end / MOST_STEPS, min(values)), ((k + 0.5) * end / MOST_STEPS, max(values))]
    return points


def _name_phases(application: Application, plot: Plot, language: Language) -> None:
    phases, end, time = application.duty_cycle.phases, plot.x_range[1], 0.0
    if len(phases) > LABELLED_PHASES:
        return
    for number, phase in enumerate(phases, 1):
        if phase.duration_s > 0.025 * end:
            plot.mark("phase", (time + phase.duration_s / 2, max(phase.torque_Nm, 0.0)), f"t_{number}")
        time += phase.duration_s
    if application.duty_cycle.pause_s > 0.05 * end:
        plot.mark("phase", ((time + end) / 2, 0.0), "t_p")


# --- The output bearing -----------------------------------------------------------------------------------------------


def envelope(export: Export, language: Language) -> dict[str, Any] | None:
    """Loads of the phases in the envelopes of the output bearing; None without loads or without the gear's limits."""
    gear, loads = export.gear(export.candidate["designation"]), export.application.loads
    largest, life = export.check("output_bearing_load"), export.check("output_bearing_life")
    if not (gear and loads and largest and life and gear.dynamic_radial_load_N and gear.dynamic_axial_load_N):
        return None
    curve = export.figures.curves.get(gear.size) if export.figures else None
    if life["utilisation"] is None or (loads.model == "digitised" and curve is None):
        return None

    def corners(factor: float) -> list[Point]:
        radial, axial = bearing.envelope(
            model=loads.model,
            radial_limit_N=gear.dynamic_radial_load_N or 0.0,
            axial_limit_N=gear.dynamic_axial_load_N or 0.0,
            curve=curve,
            factor=factor,
        )
        return list(zip(radial.tolist(), axial.tolist(), strict=True))

    published, k = corners(1 / loads.load_coefficient), min(1.0, life["limit"])
    points = _loads(export.application)
    reach = [*corners(k), *published, *points]
    plot = Plot(_span(x for x, _ in reach), _span(y for _, y in reach))
    plot.x_label, plot.y_label = language.text(N_("Radial load in N")), language.text(N_("Axial load in N"))
    for f_w in PRINTED_LOAD_COEFFICIENTS:
        plot.line("printed", corners(k / f_w))
        plot.mark("above", corners(k / f_w)[-1], f"f_w {language.exact(f_w)}")
    plot.line("own", corners(k / loads.load_coefficient))
    plot.line("published", published)
    plot.line("equivalent", corners(life["demand"] / loads.load_coefficient))
    for point, name in points.items():
        plot.mark("point", point, name)
    return plot.data(language)


def _loads(application: Application) -> dict[Point, str]:
    """Radial and axial load of the phases, each once, with the numbers of the phases that have it."""
    radial, axial = Duty([application]).loads_N
    loads: dict[Point, list[int]] = {}
    for number, point in enumerate(zip(radial[0].tolist(), axial[0].tolist(), strict=True), 1):
        loads.setdefault(point, []).append(number)
    named = len(application.duty_cycle.phases) <= LABELLED_PHASES
    return {point: _numbers(numbers) if named else "" for point, numbers in list(loads.items())[:MOST_POINTS]}


def _numbers(numbers: list[int]) -> str:
    """Phase numbers, three or more in a row as a range."""
    if len(numbers) > 2 and numbers[-1] - numbers[0] == len(numbers) - 1:
        return f"{numbers[0]}–{numbers[-1]}"
    return ", ".join(map(str, numbers))

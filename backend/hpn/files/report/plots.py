"""Plots as data: lines and labels in a unit square, ticks at round numbers. The template only draws."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import accumulate, pairwise
from typing import Any

from hpn.application import Application
from hpn.application.phase import Phase
from hpn.explain.drawings import (
    Plane,
    Subject,
    bearing_picture,
    envelope_drawing,
    gear_plane,
    governing_phases,
    motion_drawing,
    motor_plane,
)
from hpn.explain.drawings.axis import round_numbers, slices
from hpn.explain.drawings.svg import markup
from hpn.files.export import Export
from hpn.words.quantities import INPUTS
from hpn.words.reader import Reader
from hpn.words.symbols import formula, sentence
from hpn.words.units import suffix_of
from hpn.words.wording import N_, Sentence

LABELLED_PHASES = 20
"""Phases up to which each is named in a plot."""

MOST_STEPS = 400
"""Steps up to which a plot over time draws each phase; beyond, the range of each slice of time."""

MOST_SPACES = 7
"""Spaces between the round numbers along an axis."""

LIFE = "output_bearing_life"

ON_PAPER = """
text { font-size: 13px; font-family: "HPN Sans"; fill: #5b6875 }
.line, .grid, .axis, .ray, .leader, .cross, .allowed, .ring { fill: none }
.grid { stroke: #d5dbe1; stroke-width: .6 }
.axis { stroke: #16202b }
.area { fill: #eef4fa }
.line { stroke: #5b6875 }
.line.limit { stroke: #0b5394; stroke-width: 2.6 }
.line.single { stroke: #16202b; stroke-dasharray: 6 4 }
.line.mean { stroke: #1b7f3b; stroke-dasharray: 6 3 }
.line.span { stroke-dasharray: 2 3 }
.line.region { stroke: none }
.line.curve { stroke: #b35900; stroke-width: 1.5; stroke-linejoin: round }
.ray, .leader { stroke: #7d8894; stroke-width: .8 }
.ray { stroke-dasharray: 2 3 }
.back { fill: #fff; fill-opacity: .85 }
.name.limit { fill: #0b5394; font-weight: bold }
.name.mean { fill: #1b7f3b }
.letter, .index { font-style: italic }
.disc { fill: #fff; stroke: #16202b }
.dot, .number, .told { fill: #16202b }
.sign { fill: none; stroke: #1b7f3b; stroke-width: 1.5 }
.outside .sign { stroke: #b3261e }
.number { font-weight: bold }
.equivalent .disc, .equivalent .dot { fill: #eef4fa; stroke: #0b5394 }
.governing .disc, .governing .dot { fill: #0b5394; stroke: #0b5394 }
.governing .number { fill: #fff }
.ring, .cross { stroke: #b3261e; stroke-width: 2 }
.track { fill: #f3f6f9; stroke: #7d8894; stroke-width: .5 }
.used { fill: #1b7f3b }
.outside .used, .outside .told { fill: #b3261e }
.allowed { stroke: #16202b; stroke-width: 1.5 }
.steps, .zero, .boundary, .level { fill: none }
.steps { stroke: #0b5394; stroke-width: 1.75 }
.zero { stroke: #16202b }
.boundary { stroke: #d5dbe1; stroke-dasharray: 2 2 }
.level { stroke: #16202b; stroke-dasharray: 2 2 }
.level.average { stroke: #1b7f3b; stroke-dasharray: 6 3 }
.phase-step { fill: none }
.pause { fill: #f3f6f9 }
"""
"""Style sheet of a drawing in the report."""

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

    def data(self, reader: Reader) -> dict[str, Any]:
        """Everything in the unit square, y upwards."""
        return {
            "x_label": self.x_label,
            "y_label": self.y_label,
            "x_ticks": _ticks(self.x_range, reader),
            "y_ticks": _ticks(self.y_range, reader),
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


def _ticks(span: Point, reader: Reader) -> list[dict[str, Any]]:
    low, high = span
    return [
        {"at": (number - low) / (high - low), "text": reader.tick(number)}
        for number in round_numbers(low, high, MOST_SPACES)
    ]


def _span(values: Iterable[float]) -> Point:
    """Range that holds zero and the values, with room for labels."""
    known = [*values, 0.0]
    low, high = min(known), max(known)
    if high - low < SMALLEST_SPAN:
        return 0.0, 1.0
    room = 0.14 * (high - low)
    return (low - room if low < 0 else 0.0, high + room if high > 0 else room)


# --- The cycle over time ----------------------------------------------------------------------------------------------


def cycle(export: Export, reader: Reader) -> list[dict[str, Any]]:
    """Torque and speed over time, phases as steps and the pause at the end, as in illustration 17.1."""
    application, duty = export.application, export.selection.duty
    torque = _over_time(application, "torque_Nm", duty.average_torque_Nm, "T_av", reader)
    speed = _over_time(application, "speed_rpm", duty.average_output_speed_rpm, "n_out,av", reader)
    speed.x_label = reader.text(N_("Time in s"))
    _name_phases(application, torque, reader)
    return [torque.data(reader), speed.data(reader)]


def _over_time(application: Application, name: str, average: float, symbol: str, reader: Reader) -> Plot:
    cycle, unit, named = application.duty_cycle, suffix_of(name) or "", INPUTS[f"phase.{name}"]
    shown = reader.measure(unit).shown
    values = [*(shown(getattr(phase, name)) for phase in cycle.load_phases), 0.0]
    edges = [*accumulate((phase.duration_s for phase in cycle.load_phases), initial=0.0)]
    edges.append(end := edges[-1] + cycle.pause_s)
    peaks = [*(shown(_peak(phase, name)) for phase in cycle.load_phases), 0.0]
    label = Sentence(N_("{quantity} in {unit}"), {"quantity": named.name, "unit": reader.unit(unit)}, ("quantity",))
    plot = Plot((0.0, end), _span([*values, *peaks]), y_label=reader.told(label))
    if len(cycle.load_phases) <= MOST_STEPS:
        if peaks != values:
            plot.line(f"range_{name}", _steps(edges, peaks))
        plot.line(name, _steps(edges, values))
    else:
        width = end / MOST_STEPS
        ranges = slices([edge / width for edge in edges], values)
        plot.line(f"range_{name}", [((k + 0.5) * width, value) for k, ends in ranges.items() for value in ends])
    mean = shown(average)
    plot.line("average", [(0.0, mean), (end, mean)], symbol, (end, mean))
    return plot


def _steps(edges: Sequence[float], values: Sequence[float]) -> list[Point]:
    return [(0.0, 0.0), *((edges[k + place], value) for k, value in enumerate(values) for place in (0, 1))]


def _peak(phase: Phase, name: str) -> float:
    """Largest torque or speed of a phase, with the sign of its mean."""
    own: float = getattr(phase, name)
    peak: float | None = getattr(phase, f"peak_{name}")
    return own if peak is None else math.copysign(peak, own)


def _name_phases(application: Application, plot: Plot, reader: Reader) -> None:
    phases, end, time = application.duty_cycle.load_phases, plot.x_range[1], 0.0
    if len(phases) > LABELLED_PHASES:
        return
    for number, phase in enumerate(phases, 1):
        if phase.duration_s > 0.025 * end:
            plot.mark(
                "phase",
                (time + phase.duration_s / 2, reader.measure("Nm").shown(max(_peak(phase, "torque_Nm"), 0.0))),
                f"t_{number}",
            )
        time += phase.duration_s
    if application.duty_cycle.pause_s > 0.05 * end:
        plot.mark("phase", ((time + end) / 2, 0.0), "t_p")


def motion(export: Export, reader: Reader) -> str:
    """The page's drawing of a motion over time; blank where phases were given, and without the gear's limits."""
    gear = export.gear(export.candidate)
    if gear is None or export.figures is None:
        return ""
    drawing = motion_drawing(Subject(export.application, gear, export.figures), reader)
    return "" if drawing is None else markup(drawing, ON_PAPER)


# --- Torque against speed ---------------------------------------------------------------------------------------------


def planes(export: Export, reader: Reader, left_out: str) -> list[dict[str, Any]]:
    """The page's planes of gear and motor, where a motion or a motor is given and the gear's limits are at hand.

    `left_out` is what torques at the motor leave out.
    """
    gear, application = export.gear(export.candidate), export.application
    if gear is None or export.figures is None:
        return []
    if application.requirements.motor is None and application.duty_cycle.motion is None:
        return []
    subject = Subject(application, gear, export.figures)
    governing = governing_phases(subject, export.candidate.governing_check, None)
    output = _plane(N_("Torque and speed at the gear’s output"), gear_plane(subject, reader, governing), reader)
    motor = _plane(N_("Torque and speed at the motor"), motor_plane(subject, reader, governing), reader)
    return [output, motor | {"words": [*motor["words"], " " + left_out]}]


def _plane(title: str, plane: Plane, reader: Reader) -> dict[str, Any]:
    words = " ".join(reader.told(one) for one in plane.words)
    return {
        "title": reader.text(title),
        "drawing": markup(plane.drawing, ON_PAPER),
        "words": sentence(words),
        "alt": words,
    }


# --- The output bearing -----------------------------------------------------------------------------------------------


def envelope(export: Export, reader: Reader) -> dict[str, Any] | None:
    """The drawing of the page in the colours of the report, and its condition; None without the gear's limits."""
    gear, application = export.gear(export.candidate), export.application
    if gear is None or export.figures is None:
        return None
    subject = Subject(application, gear, export.figures)
    picture = bearing_picture(subject, export.candidate.check(LIFE))
    if picture is None:
        return None
    governing = governing_phases(subject, export.candidate.governing_check, picture)
    return {
        "drawing": markup(envelope_drawing(picture, reader, governing), ON_PAPER),
        "condition": sentence(reader.told(picture.condition)),
    }

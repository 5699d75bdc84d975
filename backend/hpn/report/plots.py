"""Plots as data: lines and labels in a unit square, ticks at round numbers. The template only draws."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import accumulate, pairwise
from typing import Any

from hpn.application import Application
from hpn.bearing import PRINTED_LOAD_COEFFICIENTS
from hpn.drawings import Subject, picture_of
from hpn.drawings.axis import round_numbers, slices
from hpn.reader import Reader
from hpn.report.export import Export
from hpn.report.symbols import formula
from hpn.wording import N_

LABELLED_PHASES = 20
"""Phases up to which each is named in a plot."""

MOST_STEPS = 400
"""Steps up to which a plot over time draws each phase; beyond, the range of each slice of time."""

LABELLED_LOADS = 20
"""Loads up to which each is named in a plot."""

MOST_SPACES = 7
"""Spaces between the round numbers along an axis."""

LIFE = "output_bearing_life"

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
    torque = _over_time(application, "torque_Nm", reader.text(N_("Torque in Nm")))
    torque.line("average", [(0.0, T := duty.average_torque_Nm), (torque.x_range[1], T)], "T_av", (torque.x_range[1], T))
    speed = _over_time(application, "speed_rpm", reader.text(N_("Speed in rpm")))
    speed.line(
        "average",
        [(0.0, n := duty.average_output_speed_rpm), (speed.x_range[1], n)],
        "n_out,av",
        (speed.x_range[1], n),
    )
    speed.x_label = reader.text(N_("Time in s"))
    _name_phases(application, torque, reader)
    return [torque.data(reader), speed.data(reader)]


def _over_time(application: Application, name: str, label: str) -> Plot:
    cycle = application.duty_cycle
    values = [*(getattr(phase, name) for phase in cycle.phases), 0.0]
    edges = [*accumulate((phase.duration_s for phase in cycle.phases), initial=0.0)]
    edges.append(end := edges[-1] + cycle.pause_s)
    plot = Plot((0.0, end), _span(values), y_label=label)
    if len(cycle.phases) <= MOST_STEPS:
        ends = [(edges[k + place], value) for k, value in enumerate(values) for place in (0, 1)]
        plot.line(name, [(0.0, 0.0), *ends])
    else:
        width = end / MOST_STEPS
        ranges = slices([edge / width for edge in edges], values)
        plot.line(f"range_{name}", [((k + 0.5) * width, value) for k, ends in ranges.items() for value in ends])
    return plot


def _name_phases(application: Application, plot: Plot, reader: Reader) -> None:
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


def envelope(export: Export, reader: Reader) -> dict[str, Any] | None:
    """Loads of the phases in the envelopes of the output bearing; None without loads or without the gear's limits."""
    gear, life = export.gear(export.candidate), export.candidate.check(LIFE)
    if gear is None or export.figures is None or life is None or life.demand is None or life.limit is None:
        return None
    picture = picture_of(Subject(export.application, gear, export.figures), life.demand, life.limit)
    points = [(load.radial_N, load.axial_N) for load in picture.loads]
    curves = [named for named in picture.named_curves if named.kind != "equivalent"]
    reach = [*points, *(corner for named in curves for corner in named.corners)]
    plot = Plot(_span(x for x, _ in reach), _span(y for _, y in reach))
    plot.x_label, plot.y_label = reader.text(N_("Radial load in N")), reader.text(N_("Axial load in N"))
    for named in picture.named_curves:
        plot.line(named.kind, named.corners)
        if named.kind in ("own", "life") and named.curve.load_coefficient in PRINTED_LOAD_COEFFICIENTS:
            plot.mark("above", named.corners[-1], f"f_w {reader.exact(named.curve.load_coefficient)}")
    is_named = len(picture.loads) <= LABELLED_LOADS
    for point, load in zip(points, picture.loads, strict=True):
        plot.mark("point", point, load.phases if is_named else "")
    return plot.data(reader)

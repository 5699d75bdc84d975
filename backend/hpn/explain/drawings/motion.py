"""A motion over time: way, speed, acceleration and torque, with the gear's limits and the phases that come out."""

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from xml.etree.ElementTree import Element

import numpy as np

from hpn.application.motion import LinearMotion
from hpn.explain.drawings.axis import round_numbers
from hpn.explain.drawings.cycle import (
    LETTER,
    NAMED_PHASES,
    RIGHT,
    WIDTH,
    Diagram,
    Level,
    Mark,
    placed,
    speed_levels,
    ticks,
    torque_levels,
)
from hpn.explain.drawings.subject import Subject
from hpn.explain.drawings.svg import Point, add, canvas, path, text, width_of
from hpn.explain.drawings.words import axis_title
from hpn.physics.equations import FloatArray
from hpn.physics.motion import Trace, trace_of
from hpn.words.reader import DEFAULT, Reader
from hpn.words.wording import N_, Quantity, Sentence, Value

TOP, HEIGHT, HIGHER, BETWEEN, BOTTOM = 40.0, 54.0, 78.0, 26.0, 34.0
"""Room above the first diagram, height of a plain one and of one with limits, room between two and below the last."""

MOST_PAUSE, LEAST_PAUSE = 0.25, 0.06
"""Share of the width that a pause takes at most, and at least."""

STRAIGHT = 0.05
"""Units of the drawing by which a piece may leave the line between its ends and still be drawn as that line."""

RADIUS, APART = 8.5, 19.5
"""Of the numbers of the phases: radius, and least distance of two."""


def motion_drawing(subject: Subject, reader: Reader = DEFAULT, governing: Sequence[int] = ()) -> Element | None:
    """Drawing of the motion of an application beside the limits of a gear; None where it has phases of its own."""
    course = subject.duty.courses.get(0)
    if course is None:
        return None
    trace = trace_of(course)
    diagrams = list(_diagrams(subject, trace))
    numbers = [mark.symbol for diagram, _ in diagrams for mark in _ticks(diagram, 0.0, reader)]
    left = 8 + max(width_of(number) for number in numbers) * 0.86  # whose letters are smaller than those of a load
    last = diagrams[-1][0]
    drawing = canvas(WIDTH, last.top + last.height + BOTTOM)
    end_s, pause_s = trace.time_s.item(-1), subject.application.duty_cycle.pause_s
    right = _end_of_motion(left, end_s, pause_s)
    x = left + trace.time_s / end_s * (right - left)
    _phases(drawing, trace, x, (TOP, last.top + last.height), governing)
    if pause_s:
        _pause(drawing, (right, RIGHT), (TOP, last.top + last.height))
    for diagram, values in diagrams:
        _diagram(drawing, diagram, (x, values), left, reader)
    _time(drawing, (left, right), last.top + last.height, end_s, reader)
    return drawing


def motion_words(subject: Subject) -> list[Sentence]:
    """The same in words."""
    course, duty = subject.duty.courses.get(0), subject.application.duty_cycle
    if course is None or duty.motion is None:
        return []
    trace = trace_of(course)
    values: dict[str, Value] = {
        "time": Quantity(trace.time_s.item(-1), "s"),
        "speed": Quantity(subject.duty.maximum_output_speed_rpm.item(), "rpm"),
        "low": Quantity(trace.torque_Nm.min().item(), "Nm"),
        "high": Quantity(trace.torque_Nm.max().item(), "Nm"),
    }
    linear = isinstance(duty.motion, LinearMotion)
    own = N_("Distance and acceleration are the load’s; speed and torque are those at the gear’s output.")
    turning = N_("All at the gear’s output; the angle counts from the start.")
    said = [
        Sentence(N_("Motion of {time}; at most {speed}; torque from {low} to {high}."), values),
        Sentence(own if linear else turning),
    ]
    pause = Sentence("Pause {pause}.", {"pause": Quantity(duty.pause_s, "s", 6)})
    return [*said, pause] if duty.pause_s else said


# --- Diagrams ---------------------------------------------------------------------------------------------------------


def _diagrams(subject: Subject, trace: Trace) -> Iterable[tuple[Diagram, FloatArray]]:
    """Diagrams from the top, each with the values of its curve."""
    motion = subject.application.duty_cycle.motion
    assert motion is not None
    load = motion.mechanism.load
    if isinstance(motion, LinearMotion):
        way, names, units = load.way_per_rad / load.ratio, (N_("Distance"), N_("Acceleration")), ("mm", "mm_per_s2")
    else:
        way, names, units = math.degrees(1.0), (N_("Angle"), N_("Acceleration")), ("deg", "deg_per_s2")
    curves: tuple[tuple[str, str, FloatArray, list[Level]], ...] = (
        (names[0], units[0], trace.angle_rad * way, []),
        (N_("Speed"), "rpm", trace.speed_rpm, speed_levels(subject)),
        (names[1], units[1], trace.acceleration_rad_per_s2 * way, []),
        (N_("Torque"), "Nm", trace.torque_Nm, torque_levels(subject)),
    )
    top = TOP
    for name, unit, values, levels in curves:
        height = HIGHER if levels else HEIGHT
        extremes = [values.min().item(), values.max().item()]
        yield Diagram(name, unit, top, height, extremes, levels), values
        top += height + BETWEEN


def _end_of_motion(left: float, motion_s: float, pause_s: float) -> float:
    """Where the motion ends and the pause begins; a long pause is drawn shorter than it is."""
    share = pause_s / (motion_s + pause_s)
    return RIGHT - (RIGHT - left) * (min(max(share, LEAST_PAUSE), MOST_PAUSE) if pause_s else 0.0)


def _diagram(
    drawing: Element, diagram: Diagram, curve: tuple[FloatArray, FloatArray], left: float, reader: Reader
) -> None:
    text(drawing, "title", (left, diagram.top - 6), axis_title(diagram.quantity, diagram.unit, reader))
    for mark in _ticks(diagram, left, reader):
        add(drawing, "path", "grid", d=path([(left, mark.line or 0.0), (RIGHT, mark.line or 0.0)]))
        text(drawing, "tick", (mark.x, mark.y), mark.symbol, "end")
    zero = diagram.y(0.0)
    add(drawing, "path", "zero", d=path([(left, zero), (RIGHT, zero)]))
    points = _points(curve[0], np.vectorize(diagram.y, otypes=[float])(curve[1]))
    add(drawing, "path", "area", d=path([(points[0][0], zero), *points, (points[-1][0], zero)], closed=True))
    add(drawing, "path", "steps", d=path(points))
    marks, beyond = placed(diagram, reader)
    for mark in marks:
        if mark.line is not None:
            add(drawing, "path", f"level {mark.kind}", d=path([(left, mark.line), (RIGHT, mark.line)]))
    value = {"Nm": " {}"}.get(diagram.unit, "")
    names = [(0.0, f"↑ {mark.symbol}{value.format(mark.value)}", mark.kind) for mark in beyond]
    y = diagram.top - LETTER + 4
    for wanted, name, kind in (*names, *((mark.y, f"{mark.symbol} {mark.value}".strip(), mark.kind) for mark in marks)):
        y = max(y + LETTER, wanted)
        text(drawing, f"name {kind}", (RIGHT + 4, y), name)


def _ticks(diagram: Diagram, left: float, reader: Reader) -> list[Mark]:
    """As many numbers as have room below each other, two at least."""
    spaces = int(diagram.height // LETTER)
    marks = ticks(diagram, reader, left, spaces)
    return marks if len(marks) > 1 else ticks(diagram, reader, left, spaces + 2)


def _points(x: FloatArray, y: FloatArray) -> list[Point]:
    """Points of a curve: both ends of every piece, and what is between them where it is not straight."""
    share = (x - x[:, :1]) / np.where(x[:, -1:] > x[:, :1], x[:, -1:] - x[:, :1], 1.0)
    bent = (np.abs(y[:, :1] + share * (y[:, -1:] - y[:, :1]) - y) > STRAIGHT).any(axis=1)
    kept = np.zeros(x.shape, np.bool_)
    kept[:, (0, -1)] = True
    kept[bent] = True
    if kept.sum() > 4 * WIDTH:
        kept &= _telling(x, y)
    points = list(zip(x[kept].tolist(), y[kept].tolist(), strict=True))
    return [point for place, point in enumerate(points) if not place or point != points[place - 1]]


def _telling(x: FloatArray, y: FloatArray) -> np.ndarray:
    """First, last, lowest and highest point in each slice of width 1: more than those a line does not show."""
    slices, heights = x.ravel().astype(np.intp), y.ravel()
    kept = np.zeros(len(heights), np.bool_)
    starts = np.flatnonzero(np.diff(slices, prepend=-1))
    order = np.lexsort((heights, slices))  # slices ascend, so that each keeps its place
    ends = np.append(starts[1:], len(heights)) - 1
    kept[starts] = kept[ends] = kept[order[starts]] = kept[order[ends]] = True
    return kept.reshape(x.shape)


def _phases(drawing: Element, trace: Trace, x: FloatArray, span: tuple[float, float], governing: Sequence[int]) -> None:
    """Stretch of each phase across all diagrams, and its number above them where there is room for it."""
    starts = np.flatnonzero(np.diff(trace.phase, prepend=-1))
    if len(starts) > NAMED_PHASES:
        return
    edges = [*x[starts, 0].tolist(), x.item(-1)]
    free = 0.0
    for k, (start, end) in enumerate(pairwise(edges)):
        state = " governing" if k in governing else ""
        add(
            drawing,
            "rect",
            f"phase-step{state}",
            x=start,
            y=span[0],
            width=end - start,
            height=span[1] - span[0],
            data_phase=str(k),
        )
        if k:
            add(drawing, "path", "boundary", d=path([(start, span[0]), (start, span[1])]))
        middle = (start + end) / 2
        if middle >= free:
            group = add(drawing, "g", f"mark{state}", data_phase=str(k))
            add(group, "circle", "disc", cx=middle, cy=RADIUS + 2, r=RADIUS)
            text(group, "number", (middle, RADIUS + 6.2), str(k + 1), "middle")
            free = middle + APART


def _pause(drawing: Element, across: tuple[float, float], span: tuple[float, float]) -> None:
    add(drawing, "rect", "pause", x=across[0], y=span[0], width=across[1] - across[0], height=span[1] - span[0])
    text(drawing, "phase", ((across[0] + across[1]) / 2, RADIUS + 6.2), "t_p", "middle")


def _time(drawing: Element, across: tuple[float, float], bottom: float, end_s: float, reader: Reader) -> None:
    """Time from the start of the motion to its end."""
    left, right = across
    for spaces in (6, 4, 2, 1):
        numbers = [(number, reader.tick(number)) for number in round_numbers(0.0, end_s, spaces)]
        room = (right - left) / max(len(numbers) - 1, 1)
        if all(width_of(label) + 4 <= room for _, label in numbers):
            break
    for number, label in numbers:
        text(drawing, "tick", (left + number / end_s * (right - left), bottom + 14), label, "middle")
    text(drawing, "title", ((left + right) / 2, bottom + 29), axis_title(N_("Time"), "s", reader), "middle")

"""The duty cycle over time, as in the handbook's illustration 17.1: torque and speed as steps, limits as lines.

Coordinates are those of a drawing WIDTH wide, y downwards; the template only writes them down as SVG.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

from hpn.application import DutyCycle
from hpn.application.phase import Phase
from hpn.explain.drawings.axis import round_numbers, slices
from hpn.explain.drawings.picture import MOST_MARKED
from hpn.explain.drawings.subject import Subject
from hpn.explain.drawings.words import axis_title
from hpn.words.quantities import DUTY, GEAR, INPUTS
from hpn.words.reader import DEFAULT, Reader
from hpn.words.wording import N_, Quantity, Sentence, Value

WIDTH, LEFT, RIGHT = 344.0, 42.0, 252.0
TORQUE_TOP, TORQUE_HEIGHT, SPEED_HEIGHT, BETWEEN = 28.0, 90.0, 62.0, 53.0
LETTER = 13.0
"""Least distance of two texts below each other."""

NAMED_PHASES = 24
"""Phases up to which each has its number below it, and short ones are drawn wider than they are."""

APART = 18.0
"""Least distance of two numbers beside each other."""

MOST_LETTERS = 13
"""Letters of a symbol and its value that have room at the right of a diagram."""

INDEX_DEPTH = 3.0
"""How far an index reaches below its line."""

LEAST_WIDTH, MOST_PAUSE = 0.08, 0.35
MOST_STEPS = 300
HEADROOM = 1.08
OUT_OF_SCALE = 2.2
"""Lines beyond this multiple of the largest step are only named at the edge, with an arrow."""


@dataclass(frozen=True, slots=True)
class Mark:
    """A text of the drawing, its handbook symbol apart, or a line that belongs to it."""

    x: float
    y: float
    symbol: str
    value: str = ""
    kind: str = ""
    line: float | None = None


@dataclass(frozen=True, slots=True)
class Panel:
    """One step diagram: its axis, its steps and its lines; `beyond` are those beyond the scale, from the right edge."""

    title: Mark
    top: float
    bottom: float
    zero: float
    outline: str
    area: str
    ticks: list[Mark]
    lines: list[Mark]
    beyond: list[Mark]


@dataclass(frozen=True, slots=True)
class Step:
    """The part of both diagrams that belongs to a phase, which `place` counts from 0."""

    place: int
    left: float
    right: float


@dataclass(frozen=True, slots=True)
class Disc:
    """The number of a phase below its step, as it stands at its load in the envelope."""

    place: int
    x: float
    y: float


@dataclass(frozen=True, slots=True)
class CyclePicture:
    """Both diagrams, the numbers of the phases between them, and the same in words."""

    height: float
    torque: Panel
    speed: Panel
    left: float
    right: float
    steps: list[Step]
    discs: list[Disc]
    names: list[Mark]
    boundaries: list[float]
    pause: tuple[float, float] | None
    pause_broken: bool
    to_scale: bool
    words: list[Sentence]


@dataclass(frozen=True, slots=True)
class Level:
    """A level to compare the steps with."""

    symbol: str
    value: float
    kind: str


@dataclass(frozen=True)
class Diagram:
    """Content of a panel: the phases' values and levels, and its place in the drawing."""

    quantity: str
    unit: str
    top: float
    height: float
    values: list[float]
    levels: list[Level]

    @cached_property
    def range(self) -> tuple[float, float]:
        """From the smallest to the largest step, 0 and the levels that are near them included."""
        low, high = min(0.0, *self.values), max(0.0, *self.values)
        largest = max(-low, high)
        high = max(high, *(level.value for level in self.levels if level.value <= largest * OUT_OF_SCALE), 0.0)
        return (low, high) if high > low else (0.0, 1.0)

    def y(self, value: float) -> float:
        """Where a value stands."""
        lowest, highest = (HEADROOM * end for end in self.range)
        return round(self.top + self.height * (highest - value) / (highest - lowest), 2)


def cycle_picture(subject: Subject, reader: Reader = DEFAULT) -> CyclePicture:
    """The cycle of an application, beside the limits of one gear."""
    cycle = subject.application.duty_cycle
    edges, to_scale, broken = _edges(cycle)
    torques, speeds = ([getattr(phase, name) for phase in cycle.load_phases] for name in ("torque_Nm", "speed_rpm"))
    top = TORQUE_TOP + TORQUE_HEIGHT + BETWEEN
    torque = Diagram(N_("Torque"), "Nm", TORQUE_TOP, TORQUE_HEIGHT, torques, torque_levels(subject))
    speed = Diagram(N_("Speed"), "rpm", top, SPEED_HEIGHT, speeds, speed_levels(subject))
    count = len(cycle.load_phases)
    return CyclePicture(
        height=top + SPEED_HEIGHT + 6,
        torque=_panel(torque, edges, reader),
        speed=_panel(speed, edges, reader),
        left=LEFT,
        right=RIGHT,
        steps=[Step(k, edges[k], edges[k + 1]) for k in range(count if count <= MOST_MARKED else 0)],
        discs=_discs(edges, count, TORQUE_TOP + TORQUE_HEIGHT + 12),
        names=_names(edges, count, TORQUE_TOP + TORQUE_HEIGHT + 16),
        boundaries=edges[1 : count + 1] if count <= NAMED_PHASES else [],
        pause=(edges[count], edges[-1]) if cycle.pause_s > 0 else None,
        pause_broken=broken,
        to_scale=to_scale,
        words=_in_words(cycle),
    )


# --- Time -------------------------------------------------------------------------------------------------------------


def _edges(cycle: DutyCycle) -> tuple[list[float], bool, bool]:
    """Where each phase begins and the pause ends; whether widths are to scale, and whether the pause is cut short.

    So that a short phase beside a long one is still seen, it is drawn wider than it is.
    """
    longest = max(phase.duration_s for phase in cycle.load_phases)
    durations = [phase.duration_s / longest for phase in cycle.load_phases]  # no sum overflows or vanishes
    total, pause = sum(durations), cycle.pause_s / longest
    share = pause / (total + pause)
    broken = share > MOST_PAUSE + 0.3
    room = 1 - (MOST_PAUSE if broken else max(share, LEAST_WIDTH) if pause > 0 else 0.0)
    widths = [duration / total * room for duration in durations]
    if len(widths) <= NAMED_PHASES:
        widths = _widened(widths, min(LEAST_WIDTH, room / len(widths)), room)
    edges = [LEFT]
    for width in widths:
        edges.append(edges[-1] + width * (RIGHT - LEFT))
    if pause > 0:
        edges.append(RIGHT)
    honest = [duration / total * (1 - share) for duration in durations]
    to_scale = broken or all(abs(a - b) < 0.01 for a, b in zip(widths, honest, strict=True))
    return edges, to_scale and len(cycle.load_phases) > 0, broken


def _widened(widths: list[float], least: float, room: float) -> list[float]:
    """No width below the least one; what that takes comes off the others in proportion."""
    short = {place for place, width in enumerate(widths) if width < least}
    while True:
        rest = sum(width for place, width in enumerate(widths) if place not in short)
        factor = (room - least * len(short)) / rest if rest > 0 else 0.0
        more = {p for p, width in enumerate(widths) if p not in short and width * factor < least * (1 - 1e-9)}
        if not more:
            return [least if place in short else width * factor for place, width in enumerate(widths)]
        short |= more


def _discs(edges: list[float], count: int, y: float) -> list[Disc]:
    """Numbers of the phases below their steps, as many as have room beside each other and the name of the pause."""
    discs: list[Disc] = []
    end = (edges[count] + edges[-1]) / 2 if len(edges) > count + 1 else edges[-1] + APART
    for k in range(count if count <= NAMED_PHASES else 0):
        x = (edges[k] + edges[k + 1]) / 2
        if x <= end - APART and (not discs or x - discs[-1].x >= APART):
            discs.append(Disc(k, x, y))
    return discs


def _names(edges: list[float], count: int, y: float) -> list[Mark]:
    """Name of the pause, and of all phases together where they are too many for numbers."""
    names = [Mark((edges[0] + edges[count]) / 2, y, f"1 … {count}")] if count > NAMED_PHASES else []
    if len(edges) > count + 1:
        names.append(Mark((edges[count] + edges[-1]) / 2, y, "t_p"))
    return names


# --- One diagram ------------------------------------------------------------------------------------------------------


def _panel(diagram: Diagram, edges: Sequence[float], reader: Reader) -> Panel:
    bottom = diagram.top + diagram.height
    outline, area = _steps(edges, diagram.values, diagram.y)
    marks, beyond = placed(diagram, reader)
    title = Mark(LEFT, diagram.top - 5 - LETTER, axis_title(diagram.quantity, diagram.unit, reader))
    return Panel(title, diagram.top, bottom, diagram.y(0.0), outline, area, ticks(diagram, reader), marks, beyond)


def _steps(edges: Sequence[float], values: Sequence[float], y: Callable[[float], float]) -> tuple[str, str]:
    """Path of the steps, and of the area between them and zero; of very many, the range in each slice of time."""
    zero = y(0.0)
    if len(values) > MOST_STEPS:
        return _ranges(edges, values, y)
    path = [f"M{edges[0]:.2f} {zero}"]
    for k, value in enumerate(values):
        path.append(f"V{y(value)}H{edges[k + 1]:.2f}")
    outline = "".join(path) + f"V{zero}" + (f"H{edges[-1]:.2f}" if len(edges) > len(values) + 1 else "")
    return outline, "".join(path) + f"V{zero}Z"


def _ranges(edges: Sequence[float], values: Sequence[float], y: Callable[[float], float]) -> tuple[str, str]:
    found = slices(edges, values)
    outline = "".join(f"M{x + 0.5} {y(low) + 0.5:.2f}V{y(high) - 0.5:.2f}" for x, (low, high) in found.items())
    area = "".join(f"M{x} {y(max(high, 0))}h1V{y(min(low, 0))}h-1Z" for x, (low, high) in found.items())
    return outline, area or f"M{edges[0]} {y(0.0)}"


def ticks(diagram: Diagram, reader: Reader, left: float = LEFT, spaces: int = 3) -> list[Mark]:
    """Marks at round numbers of the reader's unit, beside an axis that is so far from the left edge."""
    low, high = diagram.range
    start, end = (reader.measure(diagram.unit).shown(value) for value in (low, high))
    scale = (end - start) / (high - low)
    places = ((diagram.y(number / scale), number) for number in round_numbers(start, end, spaces))
    return [Mark(left - 5, y + 4.0, reader.tick(number), line=y) for y, number in places]


def placed(diagram: Diagram, reader: Reader) -> tuple[list[Mark], list[Mark]]:
    """Levels with their names at the right, none over another; and those beyond the scale, which only have a name."""
    marks: list[Mark] = []
    beyond: list[Mark] = []
    top, (_, high) = diagram.top, diagram.range
    y = top - LETTER
    for level in sorted(diagram.levels, key=lambda level: -level.value):
        text = reader.figure(level.value, diagram.unit)
        if level.value > high * (1 + 1e-9):
            beyond.append(Mark(WIDTH, top - 5, level.symbol, text, level.kind))
            y = top - 5 + INDEX_DEPTH
            continue
        line = diagram.y(level.value)
        y = max(y + LETTER, line + 4.0)
        fits = len(level.symbol) + len(text) <= MOST_LETTERS
        marks.append(Mark(RIGHT + 4, y, level.symbol, text if fits else "", level.kind, line))
    return marks, beyond[::-1]


# --- Levels ---------------------------------------------------------------------------------------------------------


def torque_levels(subject: Subject) -> list[Level]:
    """Average, gear's limits and emergency stop."""
    gear = subject.gear
    return _known(
        (DUTY["average_torque_Nm"].symbol, subject.duty.average_torque_Nm.item(), "average"),
        (GEAR["rated_torque_Nm"].symbol, gear.rated_torque_Nm, "limit"),
        (GEAR["repeated_peak_torque_Nm"].symbol, gear.repeated_peak_torque_Nm, "limit"),
        (INPUTS["emergency_stop.torque_Nm"].symbol, subject.emergency_stop_torque_Nm, "stop"),
    )


def speed_levels(subject: Subject) -> list[Level]:
    """At the output: the limits of the input over the ratio."""
    limits = {name: getattr(subject.gear, name) for name in ("average_input_speed_rpm", "maximum_input_speed_rpm")}
    return _known(
        (DUTY["average_output_speed_rpm"].symbol, subject.duty.average_output_speed_rpm.item(), "average"),
        *(
            (f"{GEAR[name].symbol}/{GEAR['ratio'].symbol}", value and value / subject.gear.ratio, "limit")
            for name, value in limits.items()
        ),
    )


def _known(*levels: tuple[str, float | None, str]) -> list[Level]:
    """Levels whose value is there."""
    return [Level(symbol, value, kind) for symbol, value, kind in levels if value is not None]


def _in_words(cycle: DutyCycle) -> list[Sentence]:
    """The cycle from end to end, with the peaks of its phases; what comes out of a motion with the digits of a page."""
    phases, pause_s = cycle.load_phases, cycle.pause_s
    count, digits = len(phases), 6 if cycle.motion is None else DEFAULT.digits
    torques, speeds = (_reached(phases, name) for name in ("torque_Nm", "speed_rpm"))
    sentences = [
        Sentence("One phase.") if count == 1 else Sentence("{count} phases.", {"count": count}),
        Sentence("Torque from {low} to {high}.", _extremes(torques, "Nm", digits)),
        Sentence("Speed from {low} to {high}.", _extremes(speeds, "rpm", digits)),
    ]
    pause = Sentence("Pause {pause}.", {"pause": Quantity(pause_s, "s", 6)})
    return [*sentences, pause] if pause_s > 0 else sentences


def _reached(phases: Sequence[Phase], name: str) -> list[float]:
    """The peaks of phases, each with the sign of its mean; the mean itself where a phase is steady."""
    means = [getattr(phase, name) for phase in phases]
    peaks = [getattr(phase, f"peak_{name}") for phase in phases]
    return [mean if peak is None else math.copysign(peak, mean) for mean, peak in zip(means, peaks, strict=True)]


def _extremes(values: Sequence[float], unit: str, digits: int) -> dict[str, Value]:
    return {"low": Quantity(min(values), unit, digits), "high": Quantity(max(values), unit, digits)}

"""The duty cycle over time, as in the handbook's illustration 17.1: torque and speed as steps, limits as lines.

Coordinates are those of a drawing WIDTH wide, y downwards; the template only writes them down as SVG.
"""

import math
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from hpn.application import DutyCycle
from hpn.drawings.words import ENGLISH, Words
from hpn.gear import Gear
from hpn.selection import Selection
from hpn.wording import N_, Quantity, Sentence, Value

WIDTH, LEFT, RIGHT = 344.0, 34.0, 282.0
TORQUE_TOP, TORQUE_HEIGHT, SPEED_HEIGHT, BETWEEN = 14.0, 92.0, 60.0, 30.0
LETTER = 10.5
"""Least distance of two texts below each other."""

NAMED_PHASES = 24
"""Phases up to which each has its name below it, and short ones are drawn wider than they are."""

LEAST_WIDTH, MOST_PAUSE = 0.04, 0.35
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
    """One step diagram: its axis, its steps and its lines."""

    title: str
    top: float
    bottom: float
    zero: float
    outline: str
    area: str
    ticks: list[Mark]
    lines: list[Mark]
    beyond: list[Mark]
    """Lines beyond the scale, from the right edge inwards."""


@dataclass(frozen=True, slots=True)
class CyclePicture:
    """Both diagrams, the names of the phases between them, and the same in words."""

    height: float
    torque: Panel
    speed: Panel
    names: list[Mark]
    boundaries: list[float]
    pause: tuple[float, float] | None
    pause_broken: bool
    to_scale: bool
    words: list[Sentence]


@dataclass(frozen=True, slots=True)
class _Line:
    """A level to compare the steps with."""

    symbol: str
    value: float | None
    kind: str


def cycle_picture(selection: Selection, gear: Gear, words: Words = ENGLISH) -> CyclePicture:
    """The cycle of an application, beside the limits of one gear."""
    cycle = selection.application.duty_cycle
    edges, to_scale, broken = _edges(cycle)
    torque = _panel(
        words.axis(N_("Torque"), "Nm"), "Nm", TORQUE_TOP, TORQUE_HEIGHT, edges,
        [phase.torque_Nm for phase in cycle.phases], _torque_lines(selection, gear), words,
    )  # fmt: skip
    top = TORQUE_TOP + TORQUE_HEIGHT + BETWEEN
    speed = _panel(
        words.axis(N_("Speed"), "rpm"), "rpm", top, SPEED_HEIGHT, edges,
        [phase.speed_rpm for phase in cycle.phases], _speed_lines(selection, gear), words,
    )  # fmt: skip
    count = len(cycle.phases)
    return CyclePicture(
        height=top + SPEED_HEIGHT + 6,
        torque=torque,
        speed=speed,
        names=_names(edges, count, TORQUE_TOP + TORQUE_HEIGHT + 11),
        boundaries=edges[1 : count + 1] if count <= NAMED_PHASES else [],
        pause=(edges[count], edges[-1]) if cycle.pause_s > 0 else None,
        pause_broken=broken,
        to_scale=to_scale,
        words=_in_words(selection),
    )


# --- Time -------------------------------------------------------------------------------------------------------------


def _edges(cycle: DutyCycle) -> tuple[list[float], bool, bool]:
    """Where each phase begins and the pause ends; whether widths are to scale, and whether the pause is cut short.

    So that a short phase beside a long one is still seen, it is drawn wider than it is.
    """
    longest = max(phase.duration_s for phase in cycle.phases)
    durations = [phase.duration_s / longest for phase in cycle.phases]  # no sum overflows or vanishes
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
    return edges, to_scale and len(cycle.phases) > 0, broken


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


def _names(edges: list[float], count: int, y: float) -> list[Mark]:
    """Names of the phases below their steps, as many as have room, and of the pause."""
    names: list[Mark] = []
    if count > NAMED_PHASES:
        names.append(Mark((edges[0] + edges[count]) / 2, y, f"t_1 … t_{count}"))
    for k in range(count if count <= NAMED_PHASES else 0):
        x = (edges[k] + edges[k + 1]) / 2
        if not names or x - names[-1].x >= (10.0 if k < 10 else 14.0):
            names.append(Mark(x, y, f"t_{k + 1}"))
    if len(edges) > count + 1:
        names.append(Mark((edges[count] + edges[-1]) / 2, y, "t_p"))
    return names


# --- One diagram ------------------------------------------------------------------------------------------------------


def _panel(
    title: str,
    unit: str,
    top: float,
    height: float,
    edges: Sequence[float],
    values: Sequence[float],
    lines: Sequence[_Line],
    words: Words,
) -> Panel:
    low, high = _range(values, lines)
    lowest, highest = low * HEADROOM, high * HEADROOM

    def at(value: float) -> float:
        return round(top + height * (highest - value) / (highest - lowest), 2)

    bottom = top + height
    outline, area = _steps(edges, values, at)
    ticks = [Mark(LEFT - 5, at(v) + 3.5, text, line=at(v)) for v, text in _ticks(low, high, unit, words)]
    marks, beyond = _placed(lines, high, at, top, unit, words)
    return Panel(title, top, bottom, at(0.0), outline, area, ticks, marks, beyond)


def _range(values: Sequence[float], lines: Sequence[_Line]) -> tuple[float, float]:
    """From the smallest to the largest step, 0 and the lines that are near them included."""
    low, high = min(0.0, *values), max(0.0, *values)
    largest = max(-low, high)
    near = [line.value for line in lines if line.value is not None and line.value <= largest * OUT_OF_SCALE]
    high = max(high, *near, 0.0)
    return (low, high) if high > low else (0.0, 1.0)


def _steps(edges: Sequence[float], values: Sequence[float], at: Callable[[float], float]) -> tuple[str, str]:
    """Path of the steps, and of the area between them and zero; of very many, the range in each slice of time."""
    zero = at(0.0)
    if len(values) > MOST_STEPS:
        return _ranges(edges, values, at)
    path = [f"M{edges[0]:.2f} {zero}"]
    for k, value in enumerate(values):
        path.append(f"V{at(value)}H{edges[k + 1]:.2f}")
    outline = "".join(path) + f"V{zero}" + (f"H{edges[-1]:.2f}" if len(edges) > len(values) + 1 else "")
    return outline, "".join(path) + f"V{zero}Z"


def _ranges(edges: Sequence[float], values: Sequence[float], at: Callable[[float], float]) -> tuple[str, str]:
    slices: dict[int, tuple[float, float]] = {}
    for k, value in enumerate(values):
        for place in range(int(edges[k]), max(math.ceil(edges[k + 1]), int(edges[k]) + 1)):
            low, high = slices.get(place, (value, value))
            slices[place] = min(low, value), max(high, value)
    zero = at(0.0)
    outline = "".join(f"M{x + 0.5} {at(low) + 0.5:.2f}V{at(high) - 0.5:.2f}" for x, (low, high) in slices.items())
    area = "".join(f"M{x} {at(max(high, 0))}h1V{at(min(low, 0))}h-1Z" for x, (low, high) in slices.items())
    return outline, area or f"M{edges[0]} {zero}"


def _ticks(low: float, high: float, unit: str, words: Words) -> list[tuple[float, str]]:
    """Values on the wire and texts in the reader's unit, at round numbers of the latter."""
    start, end = words.convert(low, unit), words.convert(high, unit)
    scale = (end - start) / (high - low)
    if not end - start > sys.float_info.min:  # no room for round numbers between them
        return []
    step = _round_step((end - start) / 3)
    places = range(math.ceil(start / step - 1e-9), math.floor(end / step + 1e-9) + 1)
    return [(k * step / scale, words.number(k * step / scale, unit)) for k in places]


def _round_step(rough: float) -> float:
    scale = 10.0 ** math.floor(math.log10(rough))
    return scale * next(factor for factor in (1, 2, 5, 10) if factor >= rough / scale - 1e-9)


def _placed(
    lines: Sequence[_Line], high: float, at: Callable[[float], float], top: float, unit: str, words: Words
) -> tuple[list[Mark], list[Mark]]:
    """Lines with their names at the right, none over another; and those beyond the scale, which only have a name."""
    known = sorted((line for line in lines if line.value is not None), key=lambda line: -(line.value or 0.0))
    marks: list[Mark] = []
    beyond: list[Mark] = []
    y = top - LETTER
    for line in known:
        value = line.value or 0.0
        shown = words.number(value, unit)
        if value > high * (1 + 1e-9):
            beyond.append(Mark(WIDTH, top - 5, line.symbol, shown, line.kind))
            continue
        y = max(y + LETTER, at(value) + 3.5)
        marks.append(Mark(RIGHT + 4, y, line.symbol, shown if unit == "Nm" else "", line.kind, at(value)))
    return marks, beyond[::-1]


# --- What is compared -------------------------------------------------------------------------------------------------


def _torque_lines(selection: Selection, gear: Gear) -> list[_Line]:
    stop, average = selection.application.emergency_stop, selection.evaluation.duty.average_torque_Nm
    return [
        _Line("T_av", average.item(selection.index), "average"),
        _Line("T_N", gear.rated_torque_Nm, "limit"),
        _Line("T_R", gear.repeated_peak_torque_Nm, "limit"),
        _Line("T_k", abs(stop.torque_Nm) if stop else None, "stop"),
    ]


def _speed_lines(selection: Selection, gear: Gear) -> list[_Line]:
    """At the output: the limits of the input over the ratio."""
    average = selection.evaluation.duty.average_output_speed_rpm.item(selection.index)
    limits = (("n_av(max)/i", gear.average_input_speed_rpm), ("n_in(max)/i", gear.maximum_input_speed_rpm))
    at_output = [_Line(name, value / gear.ratio if value else None, "limit") for name, value in limits]
    return [_Line("n_av", average, "average"), *at_output]


def _in_words(selection: Selection) -> list[Sentence]:
    cycle = selection.application.duty_cycle
    torques, speeds = ([getattr(p, name) for p in cycle.phases] for name in ("torque_Nm", "speed_rpm"))
    one = len(cycle.phases) == 1
    phases = Sentence("One phase.") if one else Sentence("{count} phases.", {"count": len(cycle.phases)})
    sentences = [
        phases,
        Sentence("Torque from {low} to {high}.", _extremes(torques, "Nm")),
        Sentence("Speed from {low} to {high}.", _extremes(speeds, "rpm")),
    ]
    pause = Sentence("Pause {pause}.", {"pause": Quantity(cycle.pause_s, "s", 6)})
    return [*sentences, pause] if cycle.pause_s > 0 else sentences


def _extremes(values: Iterable[float], unit: str) -> dict[str, Value]:
    known = list(values)
    return {"low": Quantity(min(known), unit, 6), "high": Quantity(max(known), unit, 6)}

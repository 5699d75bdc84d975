"""The duty cycle over time, as in the handbook's illustration 17.1: steps of torque over steps of speed, and limits.

A motion is drawn with its own curves.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate
from xml.etree.ElementTree import Element

import numpy as np

from hpn.application import Application, DutyCycle
from hpn.application.phase import Phase
from hpn.engine.duty import Duty
from hpn.explain.drawings.motion import motion_over_time, motion_words
from hpn.explain.drawings.panels import (
    MOST_BOUNDARIES,
    RIGHT,
    Level,
    Panel,
    Stretch,
    TimeAxis,
    axis_left,
    over_time,
    stretches,
)
from hpn.explain.drawings.picture import MOST_MARKED
from hpn.explain.drawings.subject import Subject
from hpn.physics.equations import FloatArray
from hpn.words.quantities import DUTY, GEAR, INPUTS
from hpn.words.reader import DEFAULT, Reader
from hpn.words.units import suffix_of
from hpn.words.wording import N_, Quantity, Sentence, Value

TORQUE_HEIGHT, SPEED_HEIGHT = 78.0, 56.0

LEAST_WIDTH, MOST_PAUSE = 0.08, 0.35
"""Least share of the time axis for a phase, and largest share for a long pause."""


@dataclass(frozen=True, slots=True)
class CyclePicture:
    """Drawing of a cycle over time, and the same in words; `note` names the parts that are not to scale."""

    drawing: Element
    words: list[Sentence]
    note: Sentence | None


def cycle_picture(
    application: Application,
    subject: Subject | None,
    reader: Reader = DEFAULT,
    governing: Sequence[int] = (),
    check: str | None = None,
    original: Application | None = None,
) -> CyclePicture:
    """Picture of an application's cycle, beside the limits of a gear if one is given.

    The governing phases and the governing check's limit stand out. A case of an application with tolerances is drawn
    within the tolerances of the `original` application.
    """
    duty, cycle = subject.duty if subject else Duty.of([application]), application.duty_cycle
    torque, speed = _torque_levels(duty, subject, check), _speed_levels(duty, subject, check)
    course = duty.courses.get(0)
    if course is not None and cycle.motion is not None:
        panels, axis = motion_over_time(course, cycle.motion, cycle.pause_s, (speed, torque), reader)
        words = motion_words(cycle.motion, cycle.pause_s, duty)
        return CyclePicture(over_time(panels, axis, reader, governing), words, None)
    panels = [
        _panel(N_("Torque"), TORQUE_HEIGHT, cycle, "torque_Nm", torque, original),
        _panel(N_("Speed"), SPEED_HEIGHT, cycle, "speed_rpm", speed, original),
    ]
    axis, note = _axis(cycle, axis_left(panels, reader))
    return CyclePicture(over_time(panels, axis, reader, governing), _in_words(cycle), note)


def _panel(
    quantity: str, height: float, cycle: DutyCycle, name: str, levels: Sequence[Level], original: Application | None
) -> Panel:
    """Steps of one quantity, with the pause at the end, and the peaks of phases with any."""
    phases = cycle.load_phases
    rest = [0.0] if cycle.pause_s > 0 else []
    means = [*(getattr(phase, name) for phase in phases), *rest]
    peaks = [*_reached(phases, name), *rest]
    values, extremes = _steps(means), _steps(peaks)
    band = [_steps([*each, *rest]) for each in zip(*_within(original, name), strict=True)] if original else []
    return Panel(quantity, suffix_of(name), height, values, levels, extremes if peaks != means else None, band)


def _steps(values: Sequence[float]) -> FloatArray:
    """Curve with a constant value over each stretch."""
    return np.repeat(np.array(values)[:, None], 2, axis=1)


def _within(original: Application, name: str) -> list[tuple[float, float, float]]:
    """Given value of each phase, and the smallest and largest within its tolerance."""
    ends = {interval.place: (interval.low, interval.high) for interval in original.intervals}
    values = [getattr(phase, name) for phase in original.duty_cycle.load_phases]
    return [(value, *ends.get(("phases", k, name), (value, value))) for k, value in enumerate(values)]


# --- Time -------------------------------------------------------------------------------------------------------------


def _axis(cycle: DutyCycle, left: float) -> tuple[TimeAxis, Sentence | None]:
    """Places of the phases and of the pause, and a note if they are not to scale.

    A short phase beside a long one is drawn wider, so that it stays visible.
    """
    longest = max(phase.duration_s for phase in cycle.load_phases)
    durations = [phase.duration_s / longest for phase in cycle.load_phases]  # no sum overflows or vanishes
    total, pause = sum(durations), cycle.pause_s / longest
    share = pause / (total + pause)
    broken = share > MOST_PAUSE + 0.3
    room = 1 - (MOST_PAUSE if broken else max(share, LEAST_WIDTH) if pause > 0 else 0.0)
    widths = [duration / total * room for duration in durations]
    if len(widths) <= MOST_BOUNDARIES:
        widths = _widened(widths, min(LEAST_WIDTH, room / len(widths)), room)
    honest = [duration / total * (1 - share) for duration in durations]
    note = None
    if broken:
        note = Sentence("The pause is drawn shorter than it is.")
    elif any(abs(a - b) >= 0.01 for a, b in zip(widths, honest, strict=True)):
        note = Sentence("Short phases are drawn wider than they are.")
    edges = [left + share * (RIGHT - left) for share in accumulate(widths, initial=0.0)]
    phases = stretches(edges, [phase.name or "" for phase in cycle.load_phases])
    rest = Stretch(edges[-1], RIGHT, ()) if pause > 0 else None
    x = np.array([(one.start, one.end) for one in (*phases, *([rest] if rest else []))])
    return TimeAxis(x, phases if len(phases) <= MOST_MARKED else (), phases, rest, row=0), note


def _widened(widths: list[float], least: float, room: float) -> list[float]:
    """Widths raised to the least one; the others shrink in proportion."""
    short = {place for place, width in enumerate(widths) if width < least}
    while True:
        rest = sum(width for place, width in enumerate(widths) if place not in short)
        factor = (room - least * len(short)) / rest if rest > 0 else 0.0
        more = {p for p, width in enumerate(widths) if p not in short and width * factor < least * (1 - 1e-9)}
        if not more:
            return [least if place in short else width * factor for place, width in enumerate(widths)]
        short |= more


# --- Levels -----------------------------------------------------------------------------------------------------------

_JUDGED = {
    "average_torque": "rated_torque_Nm",
    "repeated_peak_torque": "repeated_peak_torque_Nm",
    "momentary_peak_torque": "emergency_stop.torque_Nm",
    "momentary_peak_count": "emergency_stop.torque_Nm",
    "average_input_speed": "average_input_speed_rpm",
    "maximum_input_speed": "maximum_input_speed_rpm",
}
"""Check -> its level."""


def _torque_levels(duty: Duty, subject: Subject | None, check: str | None) -> list[Level]:
    """Levels of torque: the average, and a gear's limits and emergency stop."""
    levels = [Level(DUTY["average_torque_Nm"].symbol, duty.average_torque_Nm.item(), "average")]
    if subject is not None:
        for name in ("rated_torque_Nm", "repeated_peak_torque_Nm"):
            levels += _known(GEAR[name].symbol, getattr(subject.gear, name), "limit", name, check)
        name = "emergency_stop.torque_Nm"
        levels += _known(INPUTS[name].symbol, subject.emergency_stop_torque_Nm, "stop", name, check)
    return levels


def _speed_levels(duty: Duty, subject: Subject | None, check: str | None) -> list[Level]:
    """Levels of output speed: the average, and a gear's input limits over the ratio."""
    levels = [Level(DUTY["average_output_speed_rpm"].symbol, duty.average_output_speed_rpm.item(), "average")]
    if subject is not None:
        for name in ("average_input_speed_rpm", "maximum_input_speed_rpm"):
            limit: float | None = getattr(subject.gear, name)
            symbol = f"{GEAR[name].symbol}/{GEAR['ratio'].symbol}"
            levels += _known(symbol, limit and limit / subject.gear.ratio, "limit", name, check)
    return levels


def _known(symbol: str, value: float | None, kind: str, name: str, check: str | None) -> list[Level]:
    """Level if its value is known; the level of the governing check stands out."""
    state = " governing" if check and _JUDGED.get(check) == name else ""
    return [] if value is None else [Level(symbol, value, kind + state)]


# --- In words ---------------------------------------------------------------------------------------------------------


def _in_words(cycle: DutyCycle) -> list[Sentence]:
    """The cycle in words, with the peaks of its phases; figures from a motion have the digits of a page."""
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
    """Peaks of phases, each with the sign of its mean; the mean itself for a steady phase."""
    means = [getattr(phase, name) for phase in phases]
    peaks = [getattr(phase, f"peak_{name}") for phase in phases]
    return [mean if peak is None else math.copysign(peak, mean) for mean, peak in zip(means, peaks, strict=True)]


def _extremes(values: Sequence[float], unit: str, digits: int) -> dict[str, Value]:
    return {"low": Quantity(min(values), unit, digits), "high": Quantity(max(values), unit, digits)}

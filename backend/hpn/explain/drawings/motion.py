"""A motion over time: way, speed and torque as curves."""

import math
from itertools import pairwise

from hpn.application.motion import LinearMotion, Motion
from hpn.engine.duty import Duty
from hpn.explain.drawings.panels import RIGHT, Level, Panel, Stretch, TimeAxis, axis_left, stretches
from hpn.explain.drawings.picture import MOST_MARKED
from hpn.physics.motion import Trace, trace_of
from hpn.physics.motion.course import Course
from hpn.physics.motion.trace import starts
from hpn.words.reader import Reader
from hpn.words.wording import N_, Quantity, Sentence, Value

WAY_HEIGHT, SPEED_HEIGHT, TORQUE_HEIGHT = 50.0, 60.0, 74.0

MOST_PAUSE, LEAST_PAUSE = 0.25, 0.06
"""Largest and smallest share of the width for a pause."""


def motion_over_time(
    course: Course, motion: Motion, pause_s: float, levels: tuple[list[Level], list[Level]], reader: Reader
) -> tuple[list[Panel], TimeAxis]:
    """Way, speed and torque of a motion, the last two beside their `levels`, on a time axis to scale.

    Its moves are numbered, and its pause lies behind them.
    """
    trace, load, (speed, torque) = trace_of(course), motion.mechanism.load, levels
    if isinstance(motion, LinearMotion):
        way = Panel(N_("Distance"), "mm", WAY_HEIGHT, trace.angle_rad * (load.way_per_rad / load.ratio))
    else:
        way = Panel(N_("Angle"), "deg", WAY_HEIGHT, trace.angle_rad * math.degrees(1.0))
    panels = [
        way,
        Panel(N_("Speed"), "rpm", SPEED_HEIGHT, trace.speed_rpm, speed),
        Panel(N_("Torque"), "Nm", TORQUE_HEIGHT, trace.torque_Nm, torque),
    ]
    return panels, _axis(course, trace, pause_s, axis_left(panels, reader), reader)


def _axis(course: Course, trace: Trace, pause_s: float, left: float, reader: Reader) -> TimeAxis:
    end_s = trace.time_s.item(-1)
    right = _end_of_motion(left, end_s, pause_s)
    x = left + trace.time_s / end_s * (right - left)
    begun = starts(trace.phase)
    phases = stretches([*x[begun, 0].tolist(), right])
    bounds = [*starts(course.move).tolist(), len(phases)]
    moves = [Stretch(phases[k].start, phases[end - 1].end, range(k, end)) for k, end in pairwise(bounds)]
    times = [reader.figure(time, "s") for time in (*trace.time_s[begun, 0][bounds[:-1]].tolist(), end_s)]
    times[-1] = reader.with_unit(times[-1], "s")
    return TimeAxis(
        x,
        phases if len(phases) <= MOST_MARKED else (),
        moves,
        Stretch(right, RIGHT, ()) if pause_s else None,
        row=2,
        times=list(zip((*(move.start for move in moves), right), times, strict=True)),
    )


def _end_of_motion(left: float, motion_s: float, pause_s: float) -> float:
    """Place where the motion ends and the pause begins; a long pause is drawn shorter than to scale."""
    share = pause_s / (motion_s + pause_s)
    return RIGHT - (RIGHT - left) * (min(max(share, LEAST_PAUSE), MOST_PAUSE) if pause_s else 0.0)


def motion_words(motion: Motion, pause_s: float, duty: Duty) -> list[Sentence]:
    """A motion in words."""
    trace = trace_of(duty.courses[0])
    values: dict[str, Value] = {
        "time": Quantity(trace.time_s.item(-1), "s"),
        "speed": Quantity(duty.maximum_output_speed_rpm.item(), "rpm"),
        "low": Quantity(trace.torque_Nm.min().item(), "Nm"),
        "high": Quantity(trace.torque_Nm.max().item(), "Nm"),
    }
    own = N_("The distance is the load’s; speed and torque are those at the gear’s output.")
    turning = N_("All at the gear’s output; the angle is measured from the start.")
    sentences = [
        Sentence(N_("Motion of {time}; at most {speed}; torque from {low} to {high}."), values),
        Sentence(own if isinstance(motion, LinearMotion) else turning),
    ]
    pause = Sentence("Pause {pause}.", {"pause": Quantity(pause_s, "s", 6)})
    return [*sentences, pause] if pause_s else sentences

"""A motion over time for drawings: at both ends of every piece, where its extremes are, and in between."""

from dataclasses import dataclass, replace

import numpy as np

from hpn.physics.equations import FloatArray
from hpn.physics.motion.course import Course
from hpn.physics.motion.mechanisms import RPM
from hpn.physics.motion.motor import share_of_torque
from hpn.physics.motion.pieces import Pieces, PlaceArray
from hpn.physics.motion.torque import monotone, torque_at

MOST_INSTANTS, MOST_POINTS = 13, 4000
"""Instants of a piece, and of all pieces together; each piece keeps at least its two ends."""


@dataclass(frozen=True, eq=False)
class Trace:
    """Angle from the start, speed, acceleration and torque at the gear's output, signed, shape (pieces, instants).

    `phase` (pieces,) is the phase of each piece. Every extreme of a piece is at one of its ends.
    """

    phase: PlaceArray
    time_s: FloatArray
    angle_rad: FloatArray
    speed_rpm: FloatArray
    acceleration_rad_per_s2: FloatArray
    torque_Nm: FloatArray


def starts(of: PlaceArray) -> PlaceArray:
    """Places at which a phase or a move begins; `of` is the phase of each piece, or the move of each phase."""
    return np.flatnonzero(np.diff(of, prepend=-1))


def trace_of(course: Course) -> Trace:
    """Trace of a course."""
    return _along(course, course.pieces, course.phase, course.factor)


def motor_trace(
    course: Course, *, ratio: float, efficiency: FloatArray, motor_inertia_kgm2: float, no_load_torque_Nm: float = 0.0
) -> tuple[Trace, FloatArray]:
    """Trace, and torque in Nm of a motor along it, its own inertia included; `efficiency` broadcasts to (phases,).

    The pieces are cut at extremes of this torque.
    """
    p, load = course.pieces, course.load
    share = share_of_torque(course, np.array([ratio]), efficiency)[0]
    own = share[course.phase] * course.factor
    inertia = motor_inertia_kgm2 * ratio
    # The motor's torque is that of a load whose inertia includes the motor's, referred to the mechanism.
    with_motor = replace(p, inertia_kgm2=p.inertia_kgm2 + inertia * load.ratio / own, move=np.arange(len(p)))
    cut = monotone(with_motor)
    places = cut.move
    trace = _along(course, p.at(places).windows(cut.start_s, cut.end_s), course.phase[places], course.factor[places])
    without_load = no_load_torque_Nm * np.sign(course.speed_rpm)[trace.phase][:, None]
    return trace, share[trace.phase][:, None] * trace.torque_Nm + inertia * trace.acceleration_rad_per_s2 + without_load


@dataclass(frozen=True, slots=True)
class Instant:
    """Signed torque in Nm and acceleration in rad/s² at the gear's output, in a phase given by its place.

    `is_driven` is True where the motor drives the load, T / (i η), and False where the load drives the motor, T η / i.
    """

    phase: int
    torque_Nm: float
    acceleration_rad_per_s2: float
    is_driven: bool


def peak_instant(
    course: Course, *, ratio: float, efficiency: FloatArray, motor_inertia_kgm2: float, no_load_torque_Nm: float = 0.0
) -> Instant:
    """The instant at which the motor of one gear has its largest torque; `efficiency` has shape (phases,)."""
    trace, torque = motor_trace(
        course,
        ratio=ratio,
        efficiency=efficiency,
        motor_inertia_kgm2=motor_inertia_kgm2,
        no_load_torque_Nm=no_load_torque_Nm,
    )
    place = np.unravel_index(np.argmax(np.abs(torque)), torque.shape)
    phase = trace.phase.item(place[0])
    is_driven = bool(course.torque_Nm[phase] * course.speed_rpm[phase] >= 0)
    return Instant(phase, trace.torque_Nm.item(place), trace.acceleration_rad_per_s2.item(place), is_driven)


def _along(course: Course, pieces: Pieces, phase: PlaceArray, factor: FloatArray) -> Trace:
    load, rows = course.load, pieces.transposed
    count = max(2, min(MOST_INSTANTS, MOST_POINTS // len(pieces)))
    length = (pieces.end_s - pieces.start_s)[:, None]
    part = length * np.linspace(0.0, 1.0, count)
    t = rows.start_s + part
    t[:, -1] = pieces.end_s
    angle = rows.angle_at(t)
    turned = angle - angle[:, :1]
    before = [np.concatenate(([[0.0]], np.cumsum(ends[:-1, -1:], axis=0))) for ends in (turned, part)]
    moving = rows.sign != 0
    return Trace(
        phase=phase,
        time_s=before[1] + part,
        angle_rad=(before[0] + turned) * load.ratio,
        speed_rpm=rows.speed_at(t) * moving * load.ratio / RPM,
        acceleration_rad_per_s2=rows.acceleration_at(t) * moving * load.ratio,
        torque_Nm=torque_at(rows, t) * factor[:, None],
    )

"""Torque at the motor along a motion, its own inertia included: T / (i η) or T η / i, plus J_m i α + T_0 sgn ω.

The inertia J_m is that of motor and gear at the input, T_0 the gear's torque without load, 0 at rest.
"""

from dataclasses import replace

import numpy as np

from hpn.physics.equations import FloatArray
from hpn.physics.motion.course import Course
from hpn.physics.motion.torque import Torque, monotone

LOOKED_AT_ONCE = 10_000
"""Pieces that are cut together, those with the largest torque first."""

PIECES_AT_ONCE = 200_000
"""Pieces times gears, or motors, that are looked at together."""


def motor_torques(
    course: Course,
    *,
    ratio: FloatArray,
    efficiency_at_peak: FloatArray,
    efficiency_at_rms: FloatArray,
    motor_inertia_kgm2: float | FloatArray,
    pause_s: float,
    no_load_torque_Nm: float | FloatArray = 0.0,
) -> tuple[FloatArray, FloatArray]:
    """Peak and RMS torque in Nm of the motor over the cycle, on gears or of motors, shape (gears,) each.

    `ratio`, `motor_inertia_kgm2` and `no_load_torque_Nm` broadcast to (gears,), the efficiencies to (gears, phases). At
    least one gear.
    """
    i, J, T_0 = np.broadcast_arrays(ratio, motor_inertia_kgm2, no_load_torque_Nm)
    shape = len(i), len(course.move)
    at_peak, at_rms = (np.broadcast_to(eta, shape) for eta in (efficiency_at_peak, efficiency_at_rms))
    step = max(1, PIECES_AT_ONCE // len(course.pieces))
    some = [slice(k, k + step) for k in range(0, len(i), step)]
    own = [{"ratio": i[s], "motor_inertia_kgm2": J[s], "no_load_torque_Nm": T_0[s]} for s in some]
    peaks = [peak_torque(course, efficiency=at_peak[s], **gears) for s, gears in zip(some, own, strict=True)]
    rms = [
        rms_torque(course, efficiency=at_rms[s], pause_s=pause_s, **gears) for s, gears in zip(some, own, strict=True)
    ]
    return np.concatenate(peaks), np.concatenate(rms)


def rms_torque(
    course: Course,
    *,
    ratio: FloatArray,
    efficiency: FloatArray,
    motor_inertia_kgm2: float | FloatArray,
    pause_s: float,
    no_load_torque_Nm: float | FloatArray = 0.0,
) -> FloatArray:
    """RMS torque in Nm of the motor over the cycle, its pause included, on gears, shape (gears,).

    `efficiency` broadcasts to (gears, phases), the others to (gears,). In a phase the motor's torque is a T + b α + c
    with an a, b and c of its own.
    """
    squares = square_torque(
        course,
        ratio=ratio,
        efficiency=efficiency,
        motor_inertia_kgm2=motor_inertia_kgm2,
        no_load_torque_Nm=no_load_torque_Nm,
    )
    rms: FloatArray = np.sqrt(np.maximum(squares.sum(axis=1), 0.0) / (course.duration_s.sum() + pause_s))
    return rms


def square_torque(
    course: Course,
    *,
    ratio: FloatArray,
    efficiency: FloatArray,
    motor_inertia_kgm2: float | FloatArray,
    no_load_torque_Nm: float | FloatArray = 0.0,
) -> FloatArray:
    """Integral of the square of the motor's torque over each phase in Nm² s, shape (gears, phases)."""
    a, b = share_of_torque(course, ratio, efficiency), (motor_inertia_kgm2 * ratio)[:, None]
    c = np.broadcast_to(no_load_torque_Nm, ratio.shape)[:, None] * np.sign(course.speed_rpm)
    squares: FloatArray = (
        a**2 * course.square_torque + 2 * a * b * course.torque_acceleration + b**2 * course.square_acceleration
    )
    if c.any():
        squares = squares + 2 * c * (a * course.torque_time + b * course.speed_change) + c**2 * course.duration_s
    return squares


def least_square_per_inertia(course: Course, *, efficiency: FloatArray, pause_s: float) -> FloatArray:
    """Least square of the RMS torque that any ratio leaves to a motor, over its inertia, in Nm²/(kg m²); (gears,).

    The square is A / i² + 2 B J + C i² J² with the means A, B and C over the cycle of (a T)², a T α and α², a = 1 / η
    where the motor drives and η where the load does. It is least at i² = √(A / C) / J: 2 J (√(A C) + B) (Giberti et
    al., Mechatronics 20, 2010). `efficiency` broadcasts to (gears, phases); without a torque at no load.
    """
    a = share_of_torque(course, np.ones(1), efficiency)
    cycle_s = course.duration_s.sum() + pause_s
    A = (a**2 * course.square_torque).sum(axis=1) / cycle_s
    B = (a * course.torque_acceleration).sum(axis=1) / cycle_s
    C = course.square_acceleration.sum() / cycle_s
    least: FloatArray = 2 * (np.sqrt(A * C) + B)
    return least


def peak_torque(
    course: Course,
    *,
    ratio: FloatArray,
    efficiency: FloatArray,
    motor_inertia_kgm2: float | FloatArray,
    no_load_torque_Nm: float | FloatArray = 0.0,
) -> FloatArray:
    """Largest torque in Nm of the motor on gears, shape (gears,).

    `efficiency` broadcasts to (gears, phases), the others to (gears,).

    The ends of the pieces give it, unless it is larger in between: by no more than h² / 8 times the largest second
    derivative. The pieces where that matters are cut at the extremes of the motor's own torque.
    """
    p, load = course.pieces, course.load
    a = share_of_torque(course, ratio, efficiency)[:, course.phase] * course.factor
    b = (motor_inertia_kgm2 * ratio * load.ratio)[:, None]
    c = np.broadcast_to(no_load_torque_Nm, ratio.shape)[:, None] * p.sign
    torque = Torque(load.viscous_Nms, load.gravity_Nm)
    larger = np.maximum(*(np.abs(a * torque.at(p, t) + b * p.acceleration_at(t) + c) for t in (p.start_s, p.end_s)))
    peak: FloatArray = larger.max(axis=1)

    most = larger + _bow(course, a, b)
    rows, places = np.nonzero(most > peak[:, None])
    order = np.argsort(-most[rows, places])
    for part in np.array_split(order, 1 + len(order) // LOOKED_AT_ONCE):
        row, place = (which[part] for which in (rows, places))
        open_ = most[row, place] > peak[row]  # what came before may have settled it
        row, place = row[open_], place[open_]
        own, some = a[row, place], p.at(place)
        with_motor = some.inertia_kgm2 + b[row, 0] / own
        some = monotone(torque, replace(some, inertia_kgm2=with_motor, move=np.arange(len(row))))
        for t in (some.start_s, some.end_s):
            ends = torque.at(some, t) * own[some.move] + c[row, place][some.move]
            np.maximum.at(peak, row[some.move], np.abs(ends))
    return peak


def share_of_torque(course: Course, ratio: FloatArray, efficiency: FloatArray) -> FloatArray:
    """Motor's torque over the gear's output torque, shape (gears, phases): the gear loses in the sense of the power."""
    drives = course.torque_Nm * course.speed_rpm >= 0
    share: FloatArray = np.where(drives, 1 / efficiency, efficiency) / ratio[:, None]
    return share


def _bow(course: Course, a: FloatArray, b: FloatArray) -> FloatArray:
    """How far a T + b α may rise above the line between the ends of a piece, at most; shape (gears, pieces)."""
    p, load = course.pieces, course.load
    ends = (p.start_s, p.end_s)
    speed, acceleration, jerk = (
        np.maximum(*(np.abs(function(t)) for t in ends)) for function in (p.speed_at, p.acceleration_at, p.jerk_at)
    )
    snap = np.abs(p.swing) * p.frequency**2
    jerk = np.maximum(jerk, np.abs(p.swing) * p.frequency)
    bend = load.viscous_Nms * jerk + load.gravity_Nm * (speed**2 + acceleration)
    bow: FloatArray = (a * (bend + p.inertia_kgm2 * snap) + b * snap) * (p.end_s - p.start_s) ** 2 / 8
    return bow

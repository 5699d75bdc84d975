"""Torque at the motor along a motion, its own inertia included: T / (i η) or T η / i, plus J_m i α + T_0 sgn ω.

J_m is the inertia of motor and gear at the input, T_0 the gear's no-load torque, 0 at rest.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hpn.physics.equations import FloatArray
from hpn.physics.motion.course import Course
from hpn.physics.motion.pieces import Pieces, PlaceArray, joined
from hpn.physics.motion.torque import monotone, torque_at

LOOKED_AT_ONCE = 10_000
"""Pieces that are cut together, those with the largest torque first."""

PIECES_AT_ONCE = 200_000
"""Pieces times gears, or motors, that are evaluated together."""


@dataclass(frozen=True, eq=False)
class Courses:
    """Some concatenated courses, with all data that the motor's torque needs.

    `motion` is the course of each piece, and `phase` its phase among all; `phases` and `starts` are the places at which
    the phases and the pieces of each course begin. `ratio` is the ratio between gear and mechanism.
    """

    pieces: Pieces
    motion: PlaceArray
    phase: PlaceArray
    factor: FloatArray
    ratio: FloatArray
    starts: PlaceArray
    phases: PlaceArray
    torque_Nm: FloatArray
    speed_rpm: FloatArray
    duration_s: FloatArray
    torque_time: FloatArray
    speed_change: FloatArray
    square_torque: FloatArray
    torque_acceleration: FloatArray
    square_acceleration: FloatArray

    @classmethod
    def of(cls, courses: Sequence[Course]) -> "Courses":
        """Courses in their order."""
        pieces, phases = (
            np.array([len(column) for column in columns])
            for columns in ([one.pieces for one in courses], [one.move for one in courses])
        )
        starts, firsts = np.cumsum(pieces) - pieces, np.cumsum(phases) - phases
        motion = np.repeat(np.arange(len(courses)), pieces)
        columns = ("phase", "factor", *OF_PHASES)
        phase, factor, *of_phases = (np.concatenate([getattr(one, name) for one in courses]) for name in columns)
        ratio = np.array([one.load.ratio for one in courses])[motion]
        whole = joined([one.pieces for one in courses])
        return cls(whole, motion, phase + firsts[motion], factor, ratio, starts, firsts, *of_phases)

    def of_phase(self, values: FloatArray) -> FloatArray:
        """Values for each phase from one value per course, on the last axis."""
        counts = np.diff(self.phases, append=len(self.duration_s))
        return np.repeat(np.broadcast_to(values, (*values.shape[:-1], len(counts))), counts, axis=-1)


OF_PHASES = (
    "torque_Nm",
    "speed_rpm",
    "duration_s",
    "torque_time",
    "speed_change",
    "square_torque",
    "torque_acceleration",
    "square_acceleration",
)


def motor_torques(
    courses: Sequence[Course],
    *,
    ratio: FloatArray,
    efficiency_at_peak: FloatArray,
    efficiency_at_rms: FloatArray,
    motor_inertia_kgm2: FloatArray,
    pause_s: FloatArray,
    no_load_torque_Nm: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Peak and RMS torque in Nm of the motor over M cycles, for several gears or motors, shape (gears, M) each.

    `ratio` and `no_load_torque_Nm` have shape (gears,), inertia and pause broadcast to (gears, M), the efficiencies to
    (gears, phases), with the phases of all courses concatenated. At least one gear and one course.
    """
    along, count = Courses.of(courses), len(ratio)
    shape = count, len(along.duration_s)
    at_peak, at_rms = (np.broadcast_to(eta, shape) for eta in (efficiency_at_peak, efficiency_at_rms))
    J, pause = (np.broadcast_to(values, (count, len(courses))) for values in (motor_inertia_kgm2, pause_s))
    step = max(1, PIECES_AT_ONCE // len(along.pieces))
    some = [slice(k, k + step) for k in range(0, count, step)]
    own = [{"ratio": ratio[s], "motor_inertia_kgm2": J[s], "no_load_torque_Nm": no_load_torque_Nm[s]} for s in some]
    peaks = [peak_torque(along, efficiency=at_peak[s], **gears) for s, gears in zip(some, own, strict=True)]
    rms = [
        rms_torque(along, efficiency=at_rms[s], pause_s=pause[s], **gears) for s, gears in zip(some, own, strict=True)
    ]
    return np.concatenate(peaks), np.concatenate(rms)


def rms_torque(
    along: Courses,
    *,
    ratio: FloatArray,
    efficiency: FloatArray,
    motor_inertia_kgm2: FloatArray,
    pause_s: FloatArray,
    no_load_torque_Nm: FloatArray,
) -> FloatArray:
    """RMS torque in Nm of the motor over each cycle, its pause included, shape (gears, M); arguments as above.

    In a phase the motor's torque is a T + b α + c with an a, b and c of its own.
    """
    squares = square_torque(
        along,
        ratio=ratio,
        efficiency=efficiency,
        motor_inertia_kgm2=along.of_phase(motor_inertia_kgm2),
        no_load_torque_Nm=no_load_torque_Nm,
    )
    square = np.add.reduceat(squares, along.phases, axis=1)
    cycle_s = np.add.reduceat(along.duration_s, along.phases) + pause_s
    rms: FloatArray = np.sqrt(np.maximum(square, 0.0) / cycle_s)
    return rms


def square_torque(
    course: Course | Courses,
    *,
    ratio: FloatArray,
    efficiency: FloatArray,
    motor_inertia_kgm2: float | FloatArray,
    no_load_torque_Nm: float | FloatArray = 0.0,
) -> FloatArray:
    """Integral of the square of the motor's torque over each phase in Nm² s, shape (gears, phases).

    Efficiency and inertia broadcast to (gears, phases), the others to (gears,).
    """
    a, b = share_of_torque(course, ratio, efficiency), motor_inertia_kgm2 * ratio[:, None]
    c = np.broadcast_to(no_load_torque_Nm, ratio.shape)[:, None] * np.sign(course.speed_rpm)
    squares: FloatArray = (
        a**2 * course.square_torque + 2 * a * b * course.torque_acceleration + b**2 * course.square_acceleration
    )
    if c.any():
        squares = squares + 2 * c * (a * course.torque_time + b * course.speed_change) + c**2 * course.duration_s
    return squares


def least_square_per_inertia(course: Course, *, efficiency: FloatArray, pause_s: float) -> FloatArray:
    """Least square of the RMS torque at any ratio over the motor's inertia, in Nm²/(kg m²); shape (gears,).

    The square is A / i² + 2 B J + C i² J² with the means A, B and C over the cycle of (a T)², a T α and α², a = 1 / η
    where the motor drives and η where the load does. It is least at i² = √(A / C) / J: 2 J (√(A C) + B) (Giberti et
    al., Mechatronics 20, 2010). `efficiency` broadcasts to (gears, phases); without a no-load torque.
    """
    a = share_of_torque(course, np.ones(1), efficiency)
    cycle_s = course.duration_s.sum() + pause_s
    A = (a**2 * course.square_torque).sum(axis=1) / cycle_s
    B = (a * course.torque_acceleration).sum(axis=1) / cycle_s
    C = course.square_acceleration.sum() / cycle_s
    least: FloatArray = 2 * (np.sqrt(A * C) + B)
    return least


def peak_torque(
    along: Courses,
    *,
    ratio: FloatArray,
    efficiency: FloatArray,
    motor_inertia_kgm2: FloatArray,
    no_load_torque_Nm: FloatArray,
) -> FloatArray:
    """Largest torque in Nm of the motor on gears along each course, shape (gears, M).

    `efficiency` broadcasts to (gears, phases), the inertia to (gears, M), the others to (gears,).

    The ends of the pieces give it, unless it is larger in between: by no more than h² / 8 times the largest second
    derivative. The pieces where that matters are cut at the extremes of the motor's own torque.
    """
    p, motion = along.pieces, along.motion
    a = share_of_torque(along, ratio, efficiency)[:, along.phase] * along.factor
    b = (motor_inertia_kgm2 * ratio[:, None])[:, motion] * along.ratio
    c = no_load_torque_Nm[:, None] * p.sign
    larger = np.maximum(*(np.abs(a * torque_at(p, t) + b * p.acceleration_at(t) + c) for t in (p.start_s, p.end_s)))
    peak: FloatArray = np.maximum.reduceat(larger, along.starts, axis=1)

    most = larger + bow(p, a, b)
    rows, places = np.nonzero(most > peak[:, motion])
    order = np.argsort(-most[rows, places])
    for part in np.array_split(order, 1 + len(order) // LOOKED_AT_ONCE):
        row, place = (which[part] for which in (rows, places))
        open_ = most[row, place] > peak[row, motion[place]]  # earlier parts may have settled it
        row, place = row[open_], place[open_]
        own, some = a[row, place], p.at(place)
        with_motor = some.inertia_kgm2 + b[row, place] / own
        some = monotone(replace(some, inertia_kgm2=with_motor, move=np.arange(len(row))))
        for t in (some.start_s, some.end_s):
            ends = torque_at(some, t) * own[some.move] + c[row, place][some.move]
            np.maximum.at(peak, (row[some.move], motion[place][some.move]), np.abs(ends))
    return peak


def share_of_torque(course: Course | Courses, ratio: FloatArray, efficiency: FloatArray) -> FloatArray:
    """Motor's torque over the gear's output torque, shape (gears, phases), with losses in the direction of the
    power.
    """
    drives = course.torque_Nm * course.speed_rpm >= 0
    share: FloatArray = np.where(drives, 1 / efficiency, efficiency) / ratio[:, None]
    return share


def bow(p: Pieces, a: FloatArray, b: FloatArray) -> FloatArray:
    """Upper bound of the rise of a T + b α above the line between the ends of a piece; shape (gears, pieces)."""
    ends = (p.start_s, p.end_s)
    speed, acceleration, jerk = (
        np.maximum(*(np.abs(function(t)) for t in ends)) for function in (p.speed_at, p.acceleration_at, p.jerk_at)
    )
    snap = np.abs(p.swing) * p.frequency**2
    jerk = np.maximum(jerk, np.abs(p.swing) * p.frequency)
    bend = p.viscous_Nms * jerk + p.gravity_Nm * (speed**2 + acceleration)
    most: FloatArray = (a * (bend + p.inertia_kgm2 * snap) + b * snap) * (p.end_s - p.start_s) ** 2 / 8
    return most

"""From a motion to load phases: a phase per ramp and run, split where the load's torque changes its sign."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import lru_cache

import numpy as np

from hpn.physics.equations import FloatArray, power_ten_thirds
from hpn.physics.motion.mechanisms import RPM, ShaftLoad
from hpn.physics.motion.moves import Move
from hpn.physics.motion.pieces import Pieces, PlaceArray, joined, pieces_of
from hpn.physics.motion.torque import (
    cut_at_zeros,
    halved_integral,
    instants_of,
    integral,
    monotone,
    summed,
    torque_at,
)

LARGEST_TURN = np.pi / 4
"""Largest angle in rad of a piece under gravity, so that one rule integrates it and no extreme hides in it."""

GRADED = 0.3
"""Ratio of least to largest torque of a piece below which its power 10/3 is not smooth enough for one rule."""


@dataclass(frozen=True, eq=False)
class Course:
    """A motion at the gear's output: its phases, and the data behind the motor's torque.

    For each phase, shape (phases,): the place of its move, the mean torque by the weights of equation 17.2 and the mean
    speed, both signed; peaks, least torques and RMS by magnitude; and the integrals of T (Nm s), α (rad/s), T² (Nm² s),
    T α (Nm rad/s) and α² (rad²/s³), signed at the output. `pieces` are smooth, their torque keeps its sign and is
    monotone; `phase` is the phase of each piece, and `factor` the gear's share of the shaft's torque.
    """

    load: ShaftLoad
    pieces: Pieces
    phase: PlaceArray
    factor: FloatArray
    move: PlaceArray
    duration_s: FloatArray
    torque_Nm: FloatArray
    speed_rpm: FloatArray
    peak_torque_Nm: FloatArray
    peak_speed_rpm: FloatArray
    rms_torque_Nm: FloatArray
    least_torque_Nm: FloatArray
    torque_time: FloatArray
    speed_change: FloatArray
    square_torque: FloatArray
    torque_acceleration: FloatArray
    square_acceleration: FloatArray

    @property
    def load_inertia_kgm2(self) -> float:
        """Moment of inertia of the load at the gear's output."""
        return self.load.inertia_kgm2 / self.load.ratio**2


RECENT = 8
"""Motions whose courses are cached, of 5 MB at most each: an edit beside 400 moves under gravity takes 21 ms less."""


@lru_cache(maxsize=RECENT)
def course_of(moves: tuple[Move, ...], start_deg: float, load: ShaftLoad) -> Course:
    """Course of moves.

    The integral of equation 17.2 is exact where the torque is constant; elsewhere it errs by less than 1e-10 of itself.
    """
    return course_along(pieces_of(moves, start_deg, load), load)


def course_along(pieces: Pieces, load: ShaftLoad) -> Course:
    """Course along pieces, however they are cut."""
    return courses_along([(pieces, load)])[0]


@dataclass(frozen=True, eq=False)
class _Loads:
    """Numbers of the loads of some motions, shape (motions,); `of` is the motion of each move."""

    of: PlaceArray
    efficiency: FloatArray
    ratio: FloatArray

    def factor(self, pieces: Pieces, driving: FloatArray) -> FloatArray:
        """Share of the shaft's torque that the gear bears where the load is driven (1), drives (-1) or rests (0)."""
        motion = self.of[pieces.move]
        eta, ratio = self.efficiency[motion], self.ratio[motion]
        return np.where(driving > 0, 1 / eta, np.where(driving < 0, eta, 1.0)) / ratio


def courses_along(parts: Sequence[tuple[Pieces, ShaftLoad]]) -> list[Course]:
    """Courses of motions, computed together with the same results as one by one."""
    counts = [int(pieces.move[-1]) + 1 for pieces, _ in parts]
    firsts = np.cumsum([0, *counts])
    loads = _Loads(
        np.repeat(np.arange(len(parts)), counts),
        *(np.array([getattr(load, name) for _, load in parts]) for name in ("efficiency", "ratio")),
    )
    moved = [replace(pieces, move=pieces.move + first) for (pieces, _), first in zip(parts, firsts[:-1], strict=True)]
    whole = _course(joined(moved), loads, parts[0][1])
    if len(parts) == 1:
        return [whole]
    phases, pieces = (np.searchsorted(move, firsts).tolist() for move in (whole.move, whole.pieces.move))
    return [
        _part(whole, load, slice(*phases[k : k + 2]), slice(*pieces[k : k + 2]), firsts[k])
        for k, (_, load) in enumerate(parts)
    ]


OF_PHASES = tuple(one.name for one in fields(Course))[4:]


def _part(whole: Course, load: ShaftLoad, phases: slice, pieces: slice, first_move: int) -> Course:
    """One of several courses computed together."""
    own = whole.pieces.at(pieces)
    of_phases = {name: getattr(whole, name)[phases] for name in OF_PHASES}
    of_phases["move"] = of_phases["move"] - first_move
    own = replace(own, move=own.move - first_move)
    return Course(load, own, whole.phase[pieces] - phases.start, whole.factor[pieces], **of_phases)


def _course(pieces: Pieces, loads: _Loads, first: ShaftLoad) -> Course:
    """Course along the concatenated pieces of motions, with the load of the first."""
    pieces = cut_at_zeros(torque_at, monotone(_parted(pieces)))
    middle = (pieces.start_s + pieces.end_s) / 2
    above = torque_at(pieces, middle) >= 0
    marks = np.stack((pieces.move, pieces.part, above))
    starts = np.flatnonzero(np.any(np.diff(marks, axis=1, prepend=-1) != 0, axis=0))
    phase = np.repeat(np.arange(len(starts)), np.diff(starts, append=len(pieces)))

    sign = np.where(above, 1.0, -1.0)
    factor = loads.factor(pieces, sign * pieces.sign)
    ratio = loads.ratio[loads.of[pieces.move]]
    ends = np.abs(np.stack([torque_at(pieces, t) for t in (pieces.start_s, pieces.end_s)])) * factor
    speeds = np.abs(np.stack([pieces.speed_at(t) for t in (pieces.start_s, pieces.end_s)]))
    moving = pieces.sign != 0
    peak, least = np.maximum.reduceat(ends.max(axis=0), starts), np.minimum.reduceat(ends.min(axis=0), starts)
    duration = np.add.reduceat(pieces.end_s - pieces.start_s, starts)
    rows, t = pieces.transposed, instants_of(pieces)
    values, speed, acceleration = torque_at(rows, t), rows.speed_at(t), rows.acceleration_at(t)
    # Not the difference of two angles, which leaves a short piece of a long move few digits.
    angle = np.add.reduceat(summed(pieces, speed), starts) * moving[starts]
    squares = summed(pieces, values**2) * factor**2
    crossed = summed(pieces, values * acceleration) * factor * ratio
    accelerations = summed(pieces, acceleration**2) * ratio**2
    square_torque = np.add.reduceat(squares, starts)
    steady = peak == least
    mean = peak * _weighed(pieces, loads.of, starts, phase, factor, ends, peak, angle)
    return Course(
        load=first,
        pieces=pieces,
        phase=phase,
        factor=factor,
        move=pieces.move[starts],
        duration_s=duration,
        torque_Nm=sign[starts] * np.where(steady | ~moving[starts], peak, np.clip(mean, least, peak)),
        speed_rpm=angle / duration * ratio[starts] / RPM,
        peak_torque_Nm=peak,
        peak_speed_rpm=np.maximum.reduceat(speeds.max(axis=0), starts) * moving[starts] * ratio[starts] / RPM,
        rms_torque_Nm=np.where(steady, peak, np.clip(np.sqrt(square_torque / duration), least, peak)),
        least_torque_Nm=least,
        torque_time=np.add.reduceat(summed(pieces, values) * factor, starts),
        speed_change=np.add.reduceat(summed(pieces, acceleration) * ratio, starts),
        square_torque=square_torque,
        torque_acceleration=np.add.reduceat(crossed, starts),
        square_acceleration=np.add.reduceat(accelerations, starts),
    )


def _parted(pieces: Pieces) -> Pieces:
    """Pieces cut so that none turns far under gravity."""
    hangs = pieces.gravity_Nm > 0
    if not hangs.any():
        return pieces
    speed = np.maximum(np.abs(pieces.speed_at(pieces.start_s)), np.abs(pieces.speed_at(pieces.end_s)))
    turn = speed * (pieces.end_s - pieces.start_s) * (pieces.sign != 0)
    counts = np.where((pieces.sign == 0) | ~hangs, 1, np.maximum(2, np.ceil(turn / LARGEST_TURN))).astype(np.intp)
    result = pieces.at(np.repeat(np.arange(len(pieces)), counts))
    step = np.arange(len(result)) - np.repeat(np.cumsum(counts) - counts, counts)
    count, length = np.repeat(counts, counts), result.end_s - result.start_s
    edges = [result.start_s + length * (step + k) / count for k in (0, 1)]
    edges[1] = np.where(step + 1 == count, result.end_s, edges[1])
    return result.windows(edges[0], edges[1])


def _weighed(
    pieces: Pieces,
    motion_of_move: PlaceArray,
    starts: PlaceArray,
    phase: PlaceArray,
    factor: FloatArray,
    ends: FloatArray,
    peak: FloatArray,
    angle: FloatArray,
) -> FloatArray:
    """Mean torque of each phase by the weights of equation 17.2, over its peak: (∫|n| |T|^(10/3) dt / ∫|n|
    dt)^(3/10).
    """
    motion = motion_of_move[pieces.move]
    largest = np.zeros(motion[-1] + 1)
    np.maximum.at(largest, motion[starts], peak)
    largest[largest == 0] = 1.0

    def damage(p: Pieces, t: FloatArray) -> FloatArray:
        return p.speed_at(t) * p.sign * power_ten_thirds(np.abs(torque_at(p, t)) / largest[motion_of_move[p.move]])

    damages = integral(damage, pieces)
    whole = np.add.reduceat(damages, starts)[phase]
    coarse = np.flatnonzero((ends.min(axis=0) < GRADED * ends.max(axis=0)) & (pieces.sign != 0))
    damages[coarse] = halved_integral(damage, pieces.at(coarse), motion[coarse], damages[coarse], whole[coarse])
    damages *= power_ten_thirds(factor)
    with np.errstate(all="ignore"):
        mean: FloatArray = (
            np.power(np.add.reduceat(damages, starts) / np.abs(angle), 0.3) * largest[motion[starts]] / peak
        )
    return np.nan_to_num(mean)

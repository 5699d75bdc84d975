"""From a motion to load phases: a phase per ramp and run, parted where the load's torque changes its sign."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from hpn.physics.equations import FloatArray, power_ten_thirds
from hpn.physics.motion.mechanisms import RPM, ShaftLoad
from hpn.physics.motion.moves import Move
from hpn.physics.motion.pieces import Pieces, PlaceArray, pieces_of
from hpn.physics.motion.torque import Torque, cut_at_zeros, halved_integral, instants_of, integral, monotone, summed

LARGEST_TURN = np.pi / 4
"""Angle in rad that a piece may turn under gravity, so that one rule integrates it and no extreme hides in it."""

GRADED = 0.3
"""Least over largest torque of a piece below which its power 10/3 is not smooth enough for one rule."""


@dataclass(frozen=True, eq=False)
class Course:
    """A motion at the gear's output: its phases, and the data behind the motor's torque.

    Of each phase, shape (phases,): the place of its move, the mean torque that equation 17.2 weighs and the mean speed,
    both signed; peaks, least torques and RMS by magnitude; and the integrals of T (Nm s), α (rad/s), T² (Nm² s), T α
    (Nm rad/s) and α² (rad²/s³), signed at the output. `pieces` are smooth, their torque keeps its sign and is monotone;
    `phase` says which phase each is part of, and `factor` what the gear bears of the shaft's torque.
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
"""Motions whose courses are kept, of 5 MB at most each: an edit beside 400 moves under gravity takes 21 ms less."""


@lru_cache(maxsize=RECENT)
def course_of(moves: tuple[Move, ...], start_deg: float, load: ShaftLoad) -> Course:
    """Course of moves.

    The integral of equation 17.2 is exact where the torque is constant; elsewhere it errs by less than 1e-10 of itself.
    """
    return course_along(pieces_of(moves, start_deg, load), load)


def course_along(pieces: Pieces, load: ShaftLoad) -> Course:
    """Course along pieces, however they are cut."""
    torque = Torque(load.viscous_Nms, load.gravity_Nm)
    pieces = cut_at_zeros(torque.at, monotone(torque, _parted(pieces, load)))
    middle = (pieces.start_s + pieces.end_s) / 2
    above = torque.at(pieces, middle) >= 0
    marks = np.stack((pieces.move, pieces.part, above))
    starts = np.flatnonzero(np.any(np.diff(marks, axis=1, prepend=-1) != 0, axis=0))
    phase = np.repeat(np.arange(len(starts)), np.diff(starts, append=len(pieces)))

    sign = np.where(above, 1.0, -1.0)
    driving = sign * pieces.sign
    factor = np.where(driving > 0, 1 / load.efficiency, np.where(driving < 0, load.efficiency, 1.0)) / load.ratio
    ends = np.abs(np.stack([torque.at(pieces, t) for t in (pieces.start_s, pieces.end_s)])) * factor
    speeds = np.abs(np.stack([pieces.speed_at(t) for t in (pieces.start_s, pieces.end_s)]))
    moving = pieces.sign != 0
    peak, least = np.maximum.reduceat(ends.max(axis=0), starts), np.minimum.reduceat(ends.min(axis=0), starts)
    duration = np.add.reduceat(pieces.end_s - pieces.start_s, starts)
    rows, t = pieces.transposed, instants_of(pieces)
    values, speed, acceleration = torque.at(rows, t), rows.speed_at(t), rows.acceleration_at(t)
    # Not the difference of two angles, which leaves a short piece of a long move few digits.
    angle = np.add.reduceat(summed(pieces, speed), starts) * moving[starts]
    squares = summed(pieces, values**2) * factor**2
    crossed = summed(pieces, values * acceleration) * factor * load.ratio
    accelerations = summed(pieces, acceleration**2) * load.ratio**2
    square_torque = np.add.reduceat(squares, starts)
    steady = peak == least
    mean = peak * _weighed(torque, pieces, starts, phase, factor, ends, peak, angle)
    return Course(
        load=load,
        pieces=pieces,
        phase=phase,
        factor=factor,
        move=pieces.move[starts],
        duration_s=duration,
        torque_Nm=sign[starts] * np.where(steady | ~moving[starts], peak, np.clip(mean, least, peak)),
        speed_rpm=angle / duration * load.ratio / RPM,
        peak_torque_Nm=peak,
        peak_speed_rpm=np.maximum.reduceat(speeds.max(axis=0), starts) * moving[starts] * load.ratio / RPM,
        rms_torque_Nm=np.where(steady, peak, np.clip(np.sqrt(square_torque / duration), least, peak)),
        least_torque_Nm=least,
        torque_time=np.add.reduceat(summed(pieces, values) * factor, starts),
        speed_change=np.add.reduceat(summed(pieces, acceleration) * load.ratio, starts),
        square_torque=square_torque,
        torque_acceleration=np.add.reduceat(crossed, starts),
        square_acceleration=np.add.reduceat(accelerations, starts),
    )


def _parted(pieces: Pieces, load: ShaftLoad) -> Pieces:
    """Pieces cut so that none turns far under gravity."""
    if not load.gravity_Nm:
        return pieces
    speed = np.maximum(np.abs(pieces.speed_at(pieces.start_s)), np.abs(pieces.speed_at(pieces.end_s)))
    turn = speed * (pieces.end_s - pieces.start_s) * (pieces.sign != 0)
    counts = np.where(pieces.sign == 0, 1, np.maximum(2, np.ceil(turn / LARGEST_TURN))).astype(np.intp)
    result = pieces.at(np.repeat(np.arange(len(pieces)), counts))
    step = np.arange(len(result)) - np.repeat(np.cumsum(counts) - counts, counts)
    count, length = np.repeat(counts, counts), result.end_s - result.start_s
    edges = [result.start_s + length * (step + k) / count for k in (0, 1)]
    edges[1] = np.where(step + 1 == count, result.end_s, edges[1])
    return result.windows(edges[0], edges[1])


def _weighed(
    torque: Torque,
    pieces: Pieces,
    starts: PlaceArray,
    phase: PlaceArray,
    factor: FloatArray,
    ends: FloatArray,
    peak: FloatArray,
    angle: FloatArray,
) -> FloatArray:
    """Mean torque of each phase that equation 17.2 weighs, over its peak: (∫|n| |T|^(10/3) dt / ∫|n| dt)^(3/10)."""
    largest = peak.max() or 1.0

    def damage(p: Pieces, t: FloatArray) -> FloatArray:
        return p.speed_at(t) * p.sign * power_ten_thirds(np.abs(torque.at(p, t)) / largest)

    damages = integral(damage, pieces)
    whole = np.add.reduceat(damages, starts)[phase]
    coarse = np.flatnonzero((ends.min(axis=0) < GRADED * ends.max(axis=0)) & (pieces.sign != 0))
    damages[coarse] = halved_integral(damage, pieces.at(coarse), damages[coarse], whole[coarse])
    damages *= power_ten_thirds(factor)
    with np.errstate(all="ignore"):
        mean: FloatArray = np.power(np.add.reduceat(damages, starts) / np.abs(angle), 0.3) * largest / peak
    return np.nan_to_num(mean)

"""Motions as smooth pieces: angle, speed, acceleration and torque in closed form at every instant.

A piece is a stretch of a move with a constant jerk (ramps and runs) or one sine (modified sine). Its instants t run
from `start_s` to `end_s`, in a time of its own whose 0 is where the move starts or ends, so that a speed at rest is
exactly 0. Data of a piece have shape (pieces,); functions of time broadcast.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from hpn.physics.equations import FloatArray
from hpn.physics.motion.mechanisms import ShaftLoad, balance, cosine, sine
from hpn.physics.motion.moves import Move

PlaceArray = NDArray[np.intp]

RAMP, RUN, BRAKE = range(3)
"""Parts of a move, each a phase unless the torque changes its sign; a modified sine has its halves, a dwell is
a run.
"""


@dataclass(frozen=True, slots=True)
class Pieces:
    """Pieces of a motion of the mechanism's shaft, in rad and s, each with the load that acts in it.

    x = x_0 + ω_0 t + α_0 t²/2 + j t³/6 - S/w² sin(w t + φ) is the angle from `base`, whose cosine and sine are kept;
    `sign` is the direction of the move, 0 for a dwell. `held_Nm` is the constant part of the torque: friction, weight
    and the external load. `inertia_kgm2` is the accelerated inertia, `viscous_Nms` the viscous friction, `gravity_Nm`
    the torque of the weight held level. `swings` is False if no piece has a sine.
    """

    swings: bool
    move: PlaceArray
    part: PlaceArray
    start_s: FloatArray
    end_s: FloatArray
    sign: FloatArray
    angle: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    jerk: FloatArray
    swing: FloatArray
    frequency: FloatArray
    shift: FloatArray
    base_cosine: FloatArray
    base_sine: FloatArray
    held_Nm: FloatArray
    inertia_kgm2: FloatArray
    viscous_Nms: FloatArray
    gravity_Nm: FloatArray

    def __len__(self) -> int:
        return len(self.move)

    def at(self, places: PlaceArray | NDArray[np.bool_] | slice) -> "Pieces":
        """Some of the pieces."""
        return Pieces(self.swings, *[column[places] for column in _columns_of(self)])

    def windows(self, start_s: FloatArray, end_s: FloatArray) -> "Pieces":
        """The same pieces between other instants."""
        move, part, _, _, *others = _columns_of(self)
        return Pieces(self.swings, move, part, start_s, end_s, *others)

    def angle_at(self, t: FloatArray) -> FloatArray:
        """Angle from the base in rad."""
        polynomial = self.angle + t * (self.speed + t * (self.acceleration / 2 + t * (self.jerk / 6)))
        return polynomial - self.swing / self.frequency**2 * np.sin(self._turn(t)) if self.swings else polynomial

    def speed_at(self, t: FloatArray) -> FloatArray:
        """Speed in rad/s."""
        polynomial = self.speed + t * (self.acceleration + t * (self.jerk / 2))
        return polynomial - self.swing / self.frequency * np.cos(self._turn(t)) if self.swings else polynomial

    def acceleration_at(self, t: FloatArray) -> FloatArray:
        """Acceleration in rad/s²."""
        polynomial = self.acceleration + t * self.jerk
        return polynomial + self.swing * np.sin(self._turn(t)) if self.swings else polynomial

    def jerk_at(self, t: FloatArray) -> FloatArray:
        """Derivative of the acceleration in rad/s³."""
        return self.jerk + self.swing * self.frequency * np.cos(self._turn(t))

    def snap_at(self, t: FloatArray) -> FloatArray:
        """Derivative of the jerk in rad/s⁴."""
        return -self.swing * self.frequency**2 * np.sin(self._turn(t))

    def _turn(self, t: FloatArray) -> FloatArray:
        return self.frequency * t + self.shift

    def cosine_at(self, t: FloatArray) -> FloatArray:
        """Cosine of the angle from the horizontal, [-]; shape of `t`."""
        x = self.angle_at(t)
        return self.base_cosine * np.cos(x) - self.base_sine * np.sin(x)

    def sine_at(self, t: FloatArray) -> FloatArray:
        """Sine of the angle from the horizontal, [-]; shape of `t`."""
        x = self.angle_at(t)
        return self.base_sine * np.cos(x) + self.base_cosine * np.sin(x)

    @property
    def transposed(self) -> "Pieces":
        """Pieces in rows, for instants of shape (pieces, n)."""
        return Pieces(self.swings, *[column[:, None] for column in _columns_of(self)])


_columns_of = attrgetter(*[name for name in Pieces.__annotations__ if name != "swings"])


def joined(parts: Sequence[Pieces]) -> Pieces:
    """Pieces of motions, concatenated."""
    if len(parts) == 1:
        return parts[0]
    columns = zip(*map(_columns_of, parts), strict=True)
    return Pieces(any(one.swings for one in parts), *map(np.concatenate, columns))


# --- From moves to pieces ---------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Course:
    """Course of half a move in the direction of the way, from its start."""

    start: float
    end: float
    angle: float = 0.0
    speed: float = 0.0
    acceleration: float = 0.0
    jerk: float = 0.0
    swing: float = 0.0
    frequency: float = 1.0
    shift: float = 0.0


def pieces_of(moves: Sequence[Move], start_deg: float, load: ShaftLoad) -> Pieces:
    """Pieces of moves in their order."""
    rows = list(_rows(moves, start_deg, load))
    columns = np.array(rows, dtype=np.float64).T
    move, part = columns[:2].astype(np.intp)
    return Pieces(any(one.profile == "modified_sine" for one in moves), move, part, *columns[2:])


def _rows(moves: Sequence[Move], start_deg: float, load: ShaftLoad) -> Iterator[tuple[float, ...]]:
    position = start_deg
    for place, move in enumerate(moves):
        sign = math.copysign(1.0, move.way) if move.way else 0.0
        constant_Nm = balance(load.friction_Nm * sign, load.constant_Nm, load.external_Nm * move.external)
        end = math.fmod(position + move.way, 360.0) if load.gravity_Nm else 0.0
        own = constant_Nm, load.inertia_kgm2, load.viscous_Nms, load.gravity_Nm
        bases = [(cosine(angle), sine(angle), *own) for angle in (position, end)]
        if not sign:
            yield (place, RUN, 0.0, move.time_s or 0.0, 0.0, *_coefficients(_Course(0.0, 0.0), 0.0), *bases[0])
            continue
        total = abs(move.way) / load.way_per_rad
        first, run, last = _courses(move, total)
        for one in first:
            yield (place, RAMP, one.start, one.end, sign, *_coefficients(one, sign), *bases[0])
        if run:
            yield (place, RUN, run.start, run.end, sign, *_coefficients(run, sign), *bases[0])
        for one in (_mirrored(one) for one in reversed(last)):
            yield (place, BRAKE, one.start, one.end, sign, *_coefficients(one, sign), *bases[1])
        position = end


def _coefficients(one: _Course, sign: float) -> tuple[float, ...]:
    moved = (one.angle, one.speed, one.acceleration, one.jerk, one.swing)
    return (*(sign * value for value in moved), one.frequency, one.shift)


def _mirrored(one: _Course) -> _Course:
    """The same course backwards in time; its way counts from the end of the move."""
    return replace(
        one,
        start=-one.end,
        end=-one.start,
        angle=-one.angle,
        acceleration=-one.acceleration,
        shift=-one.shift,
    )


def _courses(move: Move, total: float) -> tuple[list[_Course], _Course | None, list[_Course]]:
    """First ramp of a move, the run behind it, and the last ramp backwards in time, for a way in rad."""
    if move.profile == "modified_sine":
        half = _modified_sine(total, move.time_s or 0.0)
        return half, None, half
    timing = move.timing
    scale = total / abs(move.way)
    V = timing.peak_speed * scale
    first, last = (
        _ramp(ramp_s, V, a * scale, share)
        for ramp_s, a, share in zip(timing.ramps_s, timing.peak_accelerations, timing.jerk_shares, strict=True)
    )
    run = _Course(0.0, timing.run_s, angle=V * timing.ramps_s[0] / 2, speed=V) if timing.run_s else None
    return first, run, last


def _ramp(ramp_s: float, V: float, a: float, share: float) -> list[_Course]:
    """Ramp from rest to the speed V with the peak acceleration a; jerk acts in `share` of it, half at either end."""
    if not share:
        return [_Course(0.0, ramp_s, acceleration=a)]
    rise = ramp_s * share / 2
    jerk, first = a / rise, a * rise / 2
    steps = [
        _Course(0.0, rise, jerk=jerk),
        _Course(0.0, ramp_s - 2 * rise, angle=a * rise**2 / 6, speed=first, acceleration=a),
        _Course(-rise, 0.0, angle=V * ramp_s / 2, speed=V, jerk=-jerk),
    ]
    return [step for step in steps if step.end - step.start > 1e-12 * ramp_s]


def _modified_sine(total: float, time_s: float) -> list[_Course]:
    """First half of Neklutin's modified sine: a quarter of a fast sine, and half of a slow one.

    Its peaks are c_v = 4 π / (4 + π) = 1.760 times way over time and c_a = 4 π² / (4 + π) = 5.528 times way over time².
    C. N. Neklutin, Mechanisms and Cams for Automatic Machines, 1969.
    """
    mean = math.pi * total / ((4 + math.pi) * time_s)
    swing = 4 * math.pi * mean / time_s
    fast, slow = 4 * math.pi / time_s, 4 * math.pi / (3 * time_s)
    return [
        _Course(0.0, time_s / 8, speed=mean, swing=swing, frequency=fast),
        _Course(
            time_s / 8,
            time_s / 2,
            angle=2 * total / (4 + math.pi),
            speed=mean,
            swing=swing,
            frequency=slow,
            shift=math.pi / 3,
        ),
    ]

"""Timing of a move from rest to rest: two ramps, each by its time or its acceleration, and the run between them.

With ramps of t1 and t2 and a run at the speed V a move of the way D takes T, where D = V (T - (t1 + t2) / 2). A ramp of
given acceleration a takes t = V / (k a) + a / j, where k is the ratio of mean to peak acceleration at a share of jerk,
and j a jerk given in place of the share, with k = 1.
"""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace

from hpn.physics.equations import ROUNDING

NEXT_TO_NONE = 8 * sys.float_info.epsilon
"""Share of a whole up to which a difference is rounding."""


@dataclass(frozen=True, slots=True)
class Shape:
    """Ends of ramps: jerk acts in a share of each ramp, half of it at either end, or has a given size.

    The jerk is in units of way per s³; infinite if the share is given.
    """

    share: float = 0.0
    jerk: float = math.inf

    @property
    def mean(self) -> float:
        """Ratio of mean to peak acceleration of a ramp with its share of jerk."""
        return 1 - self.share / 2

    def peak_of(self, V: float, t: float) -> float:
        """Smallest peak acceleration of a ramp that takes the time t in s to the speed V.

        V = a t - a² / j; if the jerk is too low for that, the acceleration with a share of 1.
        """
        left = 1 - 4 * V / (self.jerk * t**2)
        return V / (self.mean * t) * 2 / (1 + (math.sqrt(left) if left > NEXT_TO_NONE else 0.0))

    def share_of(self, a: float, t: float) -> float:
        """Share of a ramp in which jerk acts, for a peak acceleration a and the time t in s."""
        return self.share if math.isinf(self.jerk) else min(2 * a / (self.jerk * t), 1.0)


@dataclass(frozen=True, slots=True)
class Ramp:
    """A ramp by its time in s or its peak acceleration in units of way per s², or by both."""

    time_s: float | None = None
    acceleration: float = math.inf

    def time_at(self, V: float, shape: Shape) -> float:
        """Time in s to or from the speed V."""
        if self.time_s is not None:
            return self.time_s
        return V / (shape.mean * self.acceleration) + self.acceleration / shape.jerk

    def peak_at(self, V: float, t: float, shape: Shape) -> float:
        """Peak acceleration of the ramp if it takes the time t in s to the speed V."""
        by_jerk = self.acceleration < math.inf and shape.jerk < math.inf
        return self.acceleration if by_jerk else shape.peak_of(V, t)

    def least_jerk(self, V: float, t: float) -> float:
        """Smallest jerk at which it takes the time t in s to the speed V, or reaches its acceleration on the way."""
        return self.acceleration**2 / V if self.acceleration < math.inf else 4 * V / t**2


@dataclass(frozen=True, slots=True)
class Timing:
    """Ramps and run of a move in s; its peak speed, and the peak acceleration of each ramp, in units of way and s.

    `jerk_shares` are the shares of the ramps in which jerk acts, `least_jerk` the smallest sufficient jerk. `is_cut` is
    True where the requested speed leaves no time to run, so that an unrequested triangle results.
    """

    ramps_s: tuple[float, float]
    run_s: float
    peak_speed: float
    peak_accelerations: tuple[float, float]
    jerk_shares: tuple[float, float] = (0.0, 0.0)
    least_jerk: float = 0.0
    is_cut: bool = False

    @property
    def time_s(self) -> float:
        """Time of the whole move."""
        return sum(self.ramps_s) + self.run_s


def equal_ramps(D: float, T: float, ramp_s: float, shape: Shape) -> Timing:
    """Way D in time T with equal ramps; a ramp that leaves next to no run becomes half the time."""
    times = (ramp_s, ramp_s) if T - 2 * ramp_s > ROUNDING * T else (T / 2, T / 2)
    return _of_ramps(D, T, times, (Ramp(ramp_s), Ramp(ramp_s)), shape)


def triangle(D: float, T: float) -> Timing:
    """Way D in time T with equal ramps and no run."""
    return Timing((T / 2, T / 2), 0.0, 2 * D / T, (4 * D / T**2,) * 2)


def at_triangle(D: float, T: float, ramps: Sequence[Ramp], shape: Shape) -> list[float]:
    """Times in s of ramps to a triangle's speed 2 D / T: together they may take T at most."""
    return [ramp.time_at(2 * D / T, shape) for ramp in ramps]


def in_time(D: float, T: float, ramps: Sequence[Ramp], shape: Shape) -> Timing | None:
    """Way D in time T with two ramps; None if they leave too little time for the way.

    D = V (T' - s V), where T' is T less half of the ramps' time that does not depend on the speed, and s V half of the
    rest.
    """
    most = at_triangle(D, T, ramps, shape)
    if sum(most) > T * (1 + ROUNDING):
        return None
    if sum(most) > T * (1 - NEXT_TO_NONE):  # a triangle, but for rounding
        return _of_ramps(D, T, (most[0] * T / sum(most), most[1] * T / sum(most)), ramps, shape)
    fixed, s = _halves(ramps, shape)
    left = T - fixed
    V = 2 * D / (left * (1 + math.sqrt(max(1 - 4 * s * D / left**2, 0.0))))
    return _of_ramps(D, T, (ramps[0].time_at(V, shape), ramps[1].time_at(V, shape)), ramps, shape)


def at_speed(D: float, V: float, ramps: Sequence[Ramp], shape: Shape) -> Timing:
    """Way D at the speed V with two ramps; without a run if the last ramp must begin before V is reached."""
    half, s = _halves(ramps, shape)
    run_s = D / V - half - s * V
    if is_cut := run_s <= ROUNDING * (half + s * V):
        V, run_s = 2 * D / (half + math.sqrt(half**2 + 4 * s * D)), 0.0
    times = ramps[0].time_at(V, shape), ramps[1].time_at(V, shape)
    return _shaped(times, run_s, V, ramps, shape, is_cut)


def at_speed_in_time(D: float, T: float, V: float, ramps: Sequence[Ramp | None], shape: Shape) -> Timing | None:
    """Way D at the speed V in time T: equal ramps, or one given ramp and the other in the remaining time.

    t2 = 2 (T - D / V) - t1; None if nothing remains.
    """
    place = 0 if ramps[0] else 1
    if (ramp := ramps[place]) is None:
        return equal_ramps(D, T, min(T - D / V, T / 2), shape)
    both, own = 2 * (T - D / V), ramp.time_at(V, shape)
    if not own < both * (1 - ROUNDING):
        return None
    pair = Ramp(own, ramp.acceleration), Ramp(both - own)
    timing = in_time(D, T, pair if place == 0 else pair[::-1], shape)
    return replace(timing, is_cut=False) if timing else equal_ramps(D, T, T / 2, shape)


def _halves(ramps: Sequence[Ramp], shape: Shape) -> tuple[float, float]:
    """Half of the ramps' time that does not depend on the speed, and half of the rest over the speed."""
    fixed = math.fsum(ramp.time_at(0.0, shape) / 2 for ramp in ramps)
    return fixed, math.fsum(1 / (2 * shape.mean * ramp.acceleration) for ramp in ramps if ramp.time_s is None)


def _of_ramps(D: float, T: float, ramps_s: tuple[float, float], ramps: Sequence[Ramp], shape: Shape) -> Timing:
    """Way D in time T with ramps of given times, without a run if only rounding remains for it."""
    first, second = ramps_s
    run_s = T - first - second
    is_cut = run_s <= ROUNDING * T
    V = 2 * D / T if is_cut else D / (T - (first + second) / 2)
    return _shaped(ramps_s, 0.0 if is_cut else run_s, V, ramps, shape, is_cut)


def _shaped(
    ramps_s: tuple[float, float], run_s: float, V: float, ramps: Sequence[Ramp], shape: Shape, is_cut: bool
) -> Timing:
    """Timing with accelerations and shares of its ramps, and the jerk that they need."""
    pairs = list(zip(ramps, ramps_s, strict=True))
    first, second = (ramp.peak_at(V, t, shape) for ramp, t in pairs)
    shares = shape.share_of(first, ramps_s[0]), shape.share_of(second, ramps_s[1])
    least = max(ramp.least_jerk(V, t) for ramp, t in pairs)
    return Timing(ramps_s, run_s, V, (first, second), shares, least, is_cut)

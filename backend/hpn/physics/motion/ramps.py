"""Timing of a move from rest to rest: two ramps, each by its time or its acceleration, and the run between them.

With ramps of t1 and t2 and a run at the speed V a move of the way D takes T, where D = V (T - (t1 + t2) / 2). A ramp by
its acceleration a takes t = V / (k a), where k is the mean over the peak acceleration: 1, and of an S-curve less.
"""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass

from hpn.physics.equations import ROUNDING


@dataclass(frozen=True, slots=True)
class Ramp:
    """A ramp by either its time in s or its peak acceleration in units of way per s²."""

    time_s: float | None = None
    acceleration: float = math.inf

    def time_at(self, V: float, k: float) -> float:
        """Time in s to or from the speed V."""
        return V / (k * self.acceleration) if self.time_s is None else self.time_s


@dataclass(frozen=True, slots=True)
class Timing:
    """Ramps and run of a move in s; its speed and, in the middle of each ramp, its accelerations by way and seconds.

    `is_cut` says that the speed asked for leaves no time to run, so that a triangle comes out that nobody asked for.
    """

    ramps_s: tuple[float, float]
    run_s: float
    peak_speed: float
    peak_accelerations: tuple[float, float]
    is_cut: bool = False

    @property
    def time_s(self) -> float:
        """Time of the whole move."""
        return sum(self.ramps_s) + self.run_s


def equal_ramps(D: float, T: float, ramp_s: float, k: float) -> Timing:
    """Way D in time T with ramps of one length; one that leaves next to no run is half the time."""
    return _of_ramps(D, T, (ramp_s, ramp_s) if T - 2 * ramp_s > ROUNDING * T else (T / 2, T / 2), k)


def triangle(D: float, T: float) -> Timing:
    """Way D in time T with equal ramps and no run."""
    return Timing((T / 2, T / 2), 0.0, 2 * D / T, (4 * D / T**2,) * 2)


def at_triangle(D: float, T: float, ramps: Sequence[Ramp], k: float) -> list[float]:
    """Times in s of ramps to the speed 2 D / T of a triangle: together they may take T at most."""
    return [ramp.time_at(2 * D / T, k) for ramp in ramps]


def in_time(D: float, T: float, ramps: Sequence[Ramp], k: float) -> Timing | None:
    """Way D in time T with two ramps; None where they leave too little time to cover the way.

    D = V (T' - s V), where T' is T less half of the ramps by time, and s V half of those by acceleration.
    """
    most = at_triangle(D, T, ramps, k)
    if sum(most) > T * (1 + ROUNDING):
        return None
    if sum(most) > T * (1 - 8 * sys.float_info.epsilon):  # a triangle, but for rounding
        return _of_ramps(D, T, (most[0] * T / sum(most), most[1] * T / sum(most)), k)
    by_time, s = _halves(ramps, k)
    left = T - by_time
    V = 2 * D / (left * (1 + math.sqrt(max(1 - 4 * s * D / left**2, 0.0))))
    return _of_ramps(D, T, (ramps[0].time_at(V, k), ramps[1].time_at(V, k)), k)


def at_speed(D: float, V: float, ramps: Sequence[Ramp], k: float) -> Timing:
    """Way D at the speed V with two ramps; without a run where the speed is not reached before the brake has to act."""
    half, s = _halves(ramps, k)
    run_s = D / V - half - s * V
    if is_cut := run_s <= ROUNDING * (half + s * V):
        V, run_s = 2 * D / (half + math.sqrt(half**2 + 4 * s * D)), 0.0
    first, second = (ramp.time_at(V, k) for ramp in ramps)
    return Timing((first, second), run_s, V, (V / (k * first), V / (k * second)), is_cut)


def _halves(ramps: Sequence[Ramp], k: float) -> tuple[float, float]:
    """Half the time of the ramps by time, and half the time over the speed of those by acceleration."""
    by_time = math.fsum(ramp.time_s / 2 for ramp in ramps if ramp.time_s is not None)
    return by_time, math.fsum(1 / (2 * k * ramp.acceleration) for ramp in ramps if ramp.time_s is None)


def _of_ramps(D: float, T: float, ramps_s: tuple[float, float], k: float) -> Timing:
    """Way D in time T with ramps of some times, which may leave no run but for rounding."""
    first, second = ramps_s
    run_s = T - first - second
    is_cut = run_s <= ROUNDING * T
    V = 2 * D / T if is_cut else D / (T - (first + second) / 2)
    return Timing(ramps_s, 0.0 if is_cut else run_s, V, (V / (k * first), V / (k * second)), is_cut)

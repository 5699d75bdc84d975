"""A motor's torque curve of the contract that `contract.py` works out: typed phases, one line at a time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from tests.reference.contract_gears import Arithmetic, peak_of

Curve = Sequence[Mapping[str, Any]]

ROOM = 1e-12


@dataclass
class AlongCurve:
    """Torque and peak curve where a motor is nearest to the curve, and what both rules allow; None beyond its end."""

    demand: Any = None
    peak: Any = None
    thermal: Any = None
    mean_speed: Any = None

    @property
    def continuous(self) -> Any:
        return None if self.thermal is None else min(self.thermal, self.mean_speed)


def along_curve(curve: Curve, cycle: Mapping[str, Any], ratio: Any, loss: Any, by: Arithmetic) -> AlongCurve:
    """Peaks against the least limit up to the peak speed of a phase; losses at its mean speed, at rest in the pause."""
    phases, pause = cycle["phases"], cycle.get("pause_s", 0)
    if max(ratio * peak_of(p, "speed_rpm") for p in phases) > curve[-1]["speed_rpm"] * (1 + ROOM):
        return AlongCurve()

    def least(top: Any) -> Any:
        return min(at(curve, "peak_Nm", top), *(p["peak_Nm"] for p in curve if p["speed_rpm"] <= top))

    pairs = [(peak_of(p, "torque_Nm") / loss, least(ratio * peak_of(p, "speed_rpm"))) for p in phases]
    demand, peak = max(pairs, key=lambda pair: pair[0] / pair[1])
    speeds = [ratio * abs(p["speed_rpm"]) for p in phases]
    squares = [at(curve, "continuous_Nm", n) ** 2 * p["duration_s"] for n, p in zip(speeds, phases, strict=True)]
    time = by.total(p["duration_s"] for p in phases) + pause
    balance = (by.total(squares) + curve[0]["continuous_Nm"] ** 2 * pause) / time
    mean = by.total(n * p["duration_s"] for n, p in zip(speeds, phases, strict=True)) / time
    return AlongCurve(demand, peak, balance ** (by.number(1) / 2), at(curve, "continuous_Nm", mean))


def at(curve: Curve, name: str, speed: Any) -> Any:
    """Torque on the straight line between two points; at the last one also a rounding beyond it."""
    for low, high in pairwise(curve):
        if speed <= high["speed_rpm"]:
            share = (speed - low["speed_rpm"]) / (high["speed_rpm"] - low["speed_rpm"])
            return low[name] + (high[name] - low[name]) * share
    return curve[-1][name]

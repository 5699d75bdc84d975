"""Loads of the output bearing by the contract, of one phase at a time."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any

from tests.reference.contract_gears import Arithmetic, Gear, peak_of


def of_wheel(phases: Sequence[Any], given: Mapping[str, Any], by: Arithmetic) -> list[tuple[Any, Any]]:
    """Radial and axial load of each phase that a pinion or pulley on the shaft makes."""
    drive = given.get("drive")
    if drive is None:
        return [(by.number(0), by.number(0))] * len(phases)
    forces = [2000 * peak_of(p, "torque_Nm") / drive["diameter_mm"] for p in phases]
    if drive["type"] == "belt":
        return [(given.get("belt_tension_factor", by.number(2)) * max(forces), by.number(0))] * len(phases)
    helix = math.radians(float(given.get("rack_helix_deg", 0)))
    across = math.hypot(1, math.tan(math.radians(20)) / math.cos(helix))
    return [(F * by.number(across), F * by.number(math.tan(helix))) for F in forces]


def at_centre(F_R: float, F_A: float, x: float | None, y: float, x_c: float | None) -> float | None:
    """Radial load at the shaft's centre that stands for where both act; None where that is not known."""
    if not x and not (y and F_A):
        return F_R
    if x_c is None:
        return None
    return F_R * (1 if x is None else max(1, abs(x) / x_c)) + F_A * y / x_c


def equivalent(model: str, F_R: float, F_A: float, gear: Gear) -> float | None:
    if model == "digitised":
        return None if gear.curve is None else _along_curve(gear.curve, F_R, F_A)
    if gear.F_R is None or gear.F_A is None:
        return None
    r, a = F_R / gear.F_R, F_A / gear.F_A
    return r + a if model == "linear" else max(r, r * 56 / 100 + a)


def _along_curve(curve: Sequence[tuple[float, float]], F_R: float, F_A: float) -> float:
    """Length of the load over the length at which its ray meets the curve, found by trying every segment."""
    if F_R == F_A == 0:
        return 0.0
    for (R0, A0), (R1, A1) in itertools.pairwise(curve):
        # (F_R, F_A) = P * ((R0, A0) + s * (R1 - R0, A1 - A0)), by Cramer's rule for P and P s
        across = R0 * (A1 - A0) - A0 * (R1 - R0)
        P = (F_R * (A1 - A0) - F_A * (R1 - R0)) / across
        Ps = (R0 * F_A - A0 * F_R) / across
        if P > 0 and -1e-12 <= Ps / P <= 1 + 1e-12:
            return P
    raise AssertionError("the curve does not reach from axis to axis")

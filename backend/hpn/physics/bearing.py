"""The output bearing: equivalent load, envelopes and life between the two published limits.

The handbook's graphs 16.1 to 16.5 are not available. `linear` and `iso281` stand in for them, built on F_R,dyn(max)
and F_A,dyn(max) of the rating tables; `digitised` follows graph points that a supplement supplies. That the published
limits belong to f_w = 1 is our reading, not printed. Loads act at the centre of the output shaft and along its axis.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from hpn.physics.equations import FloatArray, equation, over_phases, total

RADIAL_FACTOR = 0.56
"""X of deep groove ball bearings where the axial part matters (ISO 281, table of factors X and Y)."""

L50_PER_L10 = 5.0
"""L50 = 5 L10: from the maker's other handbooks, not printed in this one; a Weibull slope of 10/9 gives 5.45."""

PRINTED_LOAD_COEFFICIENTS = (1.0, 1.2, 1.5)
"""Load coefficients of the printed graphs 16.1 to 16.5."""


@dataclass(frozen=True, eq=False)
class Curve:
    """Permissible loads from the radial axis (axial 0) round to the axial axis (radial 0), each ray crossed once."""

    radial_N: FloatArray
    axial_N: FloatArray

    def equivalent_load(self, radial_N: FloatArray, axial_N: FloatArray) -> FloatArray:
        """Factor by which loads exceed the curve in their own direction; any shape, the same out.

        On the segment between two points with p x d = c, where d is the step to the next point, P = (load x d) / c.
        """
        angle = np.arctan2(axial_N / self.axial_N[-1], radial_N / self.radial_N[0])
        knots = np.arctan2(self.axial_N / self.axial_N[-1], self.radial_N / self.radial_N[0])
        segment = np.clip(np.searchsorted(knots, angle, side="right") - 1, 0, len(knots) - 2)
        step_radial, step_axial = np.diff(self.radial_N)[segment], np.diff(self.axial_N)[segment]
        load = radial_N * step_axial - axial_N * step_radial
        curve = self.radial_N[segment] * step_axial - self.axial_N[segment] * step_radial
        return np.asarray(load / curve, dtype=float)


def curve_through(points: Sequence[tuple[float, float]]) -> Curve:
    """Curve through (radial_N, axial_N) points in any order.

    Raises CurveError, with the index of the point, if the points don't start on one axis and end on the other, or if a
    ray from the origin would cross the curve more than once (not star-shaped).
    """
    if len(points) < 2:
        raise CurveError(0, "a curve needs at least two points, one on each axis")
    order = sorted(range(len(points)), key=lambda index: np.arctan2(points[index][1], points[index][0]))
    ordered = [points[index] for index in order]
    if ordered[0][1] != 0 or ordered[0][0] <= 0:
        raise CurveError(order[0], "no point lies on the radial axis (axial_N 0, radial_N above 0)")
    if ordered[-1][0] != 0 or ordered[-1][1] <= 0:
        raise CurveError(order[-1], "no point lies on the axial axis (radial_N 0, axial_N above 0)")
    for index, (this, following) in enumerate(pairwise(ordered)):
        if this[0] * following[1] - this[1] * following[0] <= 0:
            raise CurveError(
                order[index + 1], "the curve is not star-shaped: two of its points lie in one direction from the origin"
            )
    radial, axial = np.array(ordered, dtype=float).T
    return Curve(radial, axial)


class CurveError(ValueError):
    """Error for points that make no envelope; `index` is the place of the first wrong one."""

    def __init__(self, index: int, detail: str) -> None:
        super().__init__(detail)
        self.index = index


@equation
def radial_load_at_centre(
    *,
    radial_N: ArrayLike,
    axial_N: ArrayLike,
    radial_position_mm: ArrayLike,
    axial_radius_mm: ArrayLike,
    shaft_centre_mm: ArrayLike,
) -> FloatArray:
    """Radial load at the shaft's centre in N that loads the bearing no less: F_R max(1, |x| / x_c) + |F_A| y / x_c.

    x and x_c are measured from the shaft's shoulder, y from its axis; x is NaN for a load at the centre. An upper bound
    for any distance of the two bearings behind the shoulder. NaN where x_c is unknown and a lever acts.
    """
    F_R, F_A, x, y, x_c = (
        np.asarray(value)
        for value in (np.abs(radial_N), np.abs(axial_N), radial_position_mm, axial_radius_mm, shaft_centre_mm)
    )
    at_centre, moment = np.isnan(x) | (x == 0), F_A * y
    lever = np.where(at_centre, 1.0, np.maximum(np.abs(x) / x_c, np.where(np.isnan(x_c), np.nan, 1.0)))
    return F_R * lever + np.where(moment == 0, 0.0, moment / x_c)


@equation
def linear_load(*, radial: ArrayLike, axial: ArrayLike) -> FloatArray:
    """Equivalent load P = r + a of normalised loads r, a: the straight line between the published points. [-]"""
    return np.add(radial, axial)


@equation
def iso281_load(*, radial: ArrayLike, axial: ArrayLike) -> FloatArray:
    """Equivalent load P = max(r, 0.56 r + a) of normalised loads; ISO 281 with Y set by the axial limit. [-]"""
    return np.maximum(radial, np.add(np.multiply(RADIAL_FACTOR, radial), axial))


@equation
def mean_equivalent_load(*, equivalent_load: ArrayLike, speed_rpm: ArrayLike, duration_s: ArrayLike) -> FloatArray:
    """Constant load with the damage of the cycle, P_m = (sum n t P^3 / sum n t)^(1/3). [-]

    ISO 281, ball bearings, exponent 3; phases along the last axis. Holding phases (n = 0) have no weight; a cycle
    without motion raises nothing and gives NaN, as the application forbids it. Loads are scaled by the largest of the
    moving phases, so that no cube of them overflows or vanishes.
    """
    P, n, t = over_phases(equivalent_load, speed_rpm, duration_s)
    weight = np.abs(n) * t
    P = np.where(weight > 0, P, 0.0)  # holding phases must not set the scale
    largest = P.max(axis=-1)
    r = P / np.where(largest == 0, 1.0, largest)[..., None]
    P_m: FloatArray = largest * np.cbrt(total(weight * (r * r * r)) / total(weight))
    return P_m


@equation
def life_factor(
    *,
    average_output_speed_rpm: ArrayLike,
    required_life_L50_h: ArrayLike,
    reference_speed_rpm: ArrayLike,
    reference_life_h: ArrayLike,
) -> FloatArray:
    """Permissible load factor k = (n_ref L_ref / (n_out_av L_required))^(1/3) at speed and required life. [-]

    ISO 281. The pause counts in n_out_av, as in equation 17.4.
    """
    by_speed = np.cbrt(reference_speed_rpm) / np.cbrt(average_output_speed_rpm)  # no quotient overflows here
    return by_speed * (np.cbrt(reference_life_h) / np.cbrt(required_life_L50_h))


@equation
def life_L50(
    *,
    equivalent_load: ArrayLike,
    average_output_speed_rpm: ArrayLike,
    reference_speed_rpm: ArrayLike,
    reference_life_h: ArrayLike,
) -> FloatArray:
    """Life L50 = L_ref (n_ref / n_out_av) / (f_w P_m)^3 in hours; infinite without a load.

    `equivalent_load` is f_w P_m. ISO 281, ball bearings.
    """
    P = np.asarray(equivalent_load)
    by_speed = np.divide(reference_speed_rpm, average_output_speed_rpm)
    L50: FloatArray = np.asarray(reference_life_h) * by_speed / (P * P * P)
    return L50


@equation
def required_L50(*, life_h: ArrayLike, basis: ArrayLike) -> FloatArray:
    """Required life as L50 in hours: a requirement on the basis `L10` counts five times."""
    return np.where(np.equal(basis, "L10"), np.multiply(life_h, L50_PER_L10), life_h)


def envelope(
    *,
    model: str,
    radial_limit_N: float,
    axial_limit_N: float,
    curve: Curve | None,
    factor: float,
) -> tuple[FloatArray, FloatArray]:
    """Corner points (radial_N, axial_N) of the envelope f P = 1 with f = 1 / factor, from the axial to the radial axis.

    `factor` is 1 / f_w for the published envelope and min(1, k) / f_w for the life envelope.
    """
    if model == "digitised":
        if curve is None:
            raise ValueError("the digitised model needs the points of a printed curve")
        return curve.radial_N[::-1] * factor, curve.axial_N[::-1] * factor
    knee = [(1.0, 1.0 - RADIAL_FACTOR)] if model == "iso281" else []
    radial, axial = np.array([(0.0, 1.0), *knee, (1.0, 0.0)]).T
    return radial * radial_limit_N * factor, axial * axial_limit_N * factor

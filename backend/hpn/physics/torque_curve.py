"""Torque of motors over their speed, by straight lines between points: continuous (S1) and peak."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hpn.physics.equations import FloatArray

PlaceArray = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class TorqueCurve:
    """Points of one motor by rising speed from 0, shape (points,)."""

    speed_rpm: FloatArray
    continuous_Nm: FloatArray
    peak_Nm: FloatArray


@dataclass(frozen=True, eq=False)
class TorqueCurves:
    """Curves of M motors as lines: `torque = at 0 + slope · speed` in each of their segments, shape (M, segments).

    `knots_rpm` (M, segments + 1) are the speeds of the points, infinite beyond the end of a shorter curve. `least_Nm`
    is the least peak torque of the points up to the start of a segment.
    """

    knots_rpm: FloatArray
    last_rpm: FloatArray
    continuous: tuple[FloatArray, FloatArray]
    peak: tuple[FloatArray, FloatArray]
    least_Nm: FloatArray

    @classmethod
    def of(cls, curves: Sequence[TorqueCurve]) -> "TorqueCurves":
        """Curves in one table."""
        table = np.full((3, len(curves), max(len(curve.speed_rpm) for curve in curves)), np.nan)
        for row, curve in enumerate(curves):
            table[:, row, : len(curve.speed_rpm)] = curve.speed_rpm, curve.continuous_Nm, curve.peak_Nm
        knots, peak = table[0], table[2]
        with np.errstate(all="ignore"):
            slopes = np.nan_to_num(np.diff(table[1:]) / np.diff(knots), posinf=0.0, neginf=0.0)  # of points too near
        bases = np.nan_to_num(table[1:, :, :-1] - slopes * knots[:, :-1])
        (continuous, highest), least = zip(bases, slopes, strict=True), np.fmin.accumulate(peak, axis=1)[:, :-1]
        return cls(np.nan_to_num(knots, nan=np.inf), np.nanmax(knots, axis=1), continuous, highest, least)

    def segment_at(self, rows: PlaceArray, speed_rpm: FloatArray) -> PlaceArray:
        """Segment of the curve of each row at a speed, the last one beyond its end; both of one shape."""
        segment = np.zeros(np.shape(speed_rpm), np.intp)
        last = (np.isfinite(self.knots_rpm).sum(axis=1) - 2)[rows]
        for place in range(1, self.knots_rpm.shape[1] - 1):
            segment += self.knots_rpm[rows, place] < speed_rpm
        return np.asarray(np.minimum(segment, last))

    def continuous_at(self, rows: PlaceArray, speed_rpm: FloatArray) -> FloatArray:
        """Continuous torque in Nm of the curve of each row at a speed; both of one shape."""
        return _on(self.continuous, rows, self.segment_at(rows, speed_rpm), speed_rpm)

    def least_peak_up_to(self, rows: PlaceArray, speed_rpm: FloatArray) -> FloatArray:
        """Least peak torque in Nm of the curve of each row from 0 up to a speed; both of one shape."""
        segment = self.segment_at(rows, speed_rpm)
        return np.minimum(self.least_Nm[rows, segment], _on(self.peak, rows, segment, speed_rpm))


def _on(
    lines: tuple[FloatArray, FloatArray], rows: PlaceArray, segment: PlaceArray, speed_rpm: FloatArray
) -> FloatArray:
    base, slope = lines
    torque: FloatArray = base[rows, segment] + slope[rows, segment] * speed_rpm
    return torque

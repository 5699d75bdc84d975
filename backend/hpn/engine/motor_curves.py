"""Motors with a torque curve: their peak torque along it, and their continuous torque at the speeds of a cycle."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hpn.catalogue import Catalogue, GearList
from hpn.engine.duty import Duty
from hpn.engine.input_arrays import CURVE
from hpn.engine.motor_torques import asked_in, courses_once, kinds_of, lines_of_efficiency, peaks_by_phase
from hpn.physics.equations import ROUNDING, FloatArray, total
from hpn.physics.motion import Course, DriveTrains, judged_along
from hpn.physics.torque_curve import TorqueCurves

PlaceArray = NDArray[np.intp]

CELLS_AT_ONCE = 500_000
"""Motors times kinds of gears times phases, at most, that are evaluated together."""


@dataclass(frozen=True, eq=False)
class CurveFigures:
    """Figures of G gears under N applications, or of N motors under one, shape (N, G) each.

    NaN if the motor has no curve, and where the gear's input turns faster than the end of the curve. `demand_Nm` is the
    motor's torque where it is nearest to its peak curve, `peak_Nm` the curve at that point. `thermal_Nm` is the root of
    the mean of M_c(n)², the RMS torque at which the motor's losses balance; `at_mean_speed_Nm` is M_c at the mean
    speed.
    """

    demand_Nm: FloatArray
    peak_Nm: FloatArray
    thermal_Nm: FloatArray
    at_mean_speed_Nm: FloatArray

    @property
    def continuous_Nm(self) -> FloatArray:
        """Largest RMS torque that both rules allow: the balance of losses and the makers' rule."""
        return np.minimum(self.thermal_Nm, self.at_mean_speed_Nm)


def along_curves(duty: Duty, gears: GearList, catalogue: Catalogue) -> CurveFigures:
    """Figures of the motors with a curve, NaN for the others."""
    rows = np.flatnonzero(~np.isnan(duty.inputs[CURVE][:, 0]))
    places, kinds = kinds_of(gears, catalogue)
    count = max(len(duty.inputs[CURVE]), len(duty.phases.speed_rpm))
    table = np.full((4, count, len(places)), np.nan)
    if rows.size:
        judge = _Judge(duty, rows, places, gears, catalogue)
        table[:, rows] = judge.figures()
    return CurveFigures(*table[:, :, kinds])


class _Judge:
    """Motors with a curve, in some rows, on the first gear of each kind."""

    def __init__(self, duty: Duty, rows: PlaceArray, places: PlaceArray, gears: GearList, catalogue: Catalogue) -> None:
        self._duty, self._rows, self._places = duty, rows, places
        self._gears, self._catalogue = gears, catalogue
        self._curves = TorqueCurves.of(duty.inputs.motor_curves[rows, 0].tolist())
        self._ratio = gears.columns.ratio[places]
        self._cycle = rows if len(duty.phases.speed_rpm) > 1 else np.zeros_like(rows)
        fastest = duty.maximum_output_speed_rpm[self._cycle] * self._ratio
        self._within = fastest <= self._curves.last_rpm[:, None] * (1 + ROUNDING)
        self._table = np.full((4, len(rows), len(places)), np.nan)

    def figures(self) -> FloatArray:
        """Demand, peak, balance and continuous torque at the mean speed in Nm, shape (4, rows, kinds)."""
        moves = np.zeros(len(self._rows), np.bool_)
        for course, indices in courses_once(self._duty):
            own = np.flatnonzero(np.isin(self._cycle, indices))
            if own.size:
                moves[own] = True
                self._table[:3, own] = self._along(course, own)
        if not moves.all():
            torques = peaks_by_phase(self._duty, self._places, self._gears, self._catalogue)
            for some in self._parts(np.flatnonzero(~moves)):
                self._table[:3, some] = self._by_phase(some, torques)
        mean_speed = self._duty.average_output_speed_rpm[self._cycle] * self._ratio
        rows = np.broadcast_to(np.arange(len(self._rows))[:, None], mean_speed.shape)
        self._table[3] = self._curves.continuous_at(rows, mean_speed)
        self._table[:, ~self._within] = np.nan
        return self._table

    def _parts(self, rows: PlaceArray) -> Iterator[PlaceArray]:
        """Yield places of rows to evaluate together."""
        step = max(1, CELLS_AT_ONCE // (len(self._places) * self._duty.phases.speed_rpm.shape[-1]))
        for start in range(0, len(rows), step):
            yield rows[start : start + step]

    def _by_phase(self, some: PlaceArray, torques_Nm: FloatArray) -> FloatArray:
        """Demand, peak and balance of typed phases: their peaks against the least limit up to their speed, mean speeds.

        Shape (3, some, kinds).
        """
        phases, cycle = self._duty.phases, self._cycle[some]
        torque = torques_Nm[cycle]
        own = np.broadcast_to(some[:, None, None], torque.shape)
        speed, fastest = (
            n[cycle, 0][:, None] * self._ratio[:, None] for n in (phases.speed_rpm, phases.peak_speed_rpm)
        )
        limit = self._curves.least_peak_up_to(own, fastest)
        at = (torque / limit).argmax(axis=-1)[..., None]
        demand, peak = (np.take_along_axis(values, at, -1)[..., 0] for values in (torque, limit))
        time, pause = phases.duration_s[cycle, 0][:, None], self._duty.inputs["duty_cycle.pause_s"][cycle]
        squares = np.square(self._curves.continuous_at(own, speed))
        at_rest = np.square(self._curves.continuous[0][some, :1]) * pause
        balance = np.sqrt((total(squares * time) + at_rest) / (total(time) + pause))
        return np.stack((demand, peak, balance))

    def _along(self, course: Course, own: PlaceArray) -> FloatArray:
        """Demand, peak and balance along a motion, with the motor's own inertia where it is known, (3, own, kinds)."""
        duty, columns = self._duty, self._gears.columns
        row, kind = np.nonzero(self._within[own])
        inertia, pause_s, stated = (
            asked_in(duty, path, self._rows[own])[row]
            for path in ("requirements.motor.inertia_kgm2", "duty_cycle.pause_s", "requirements.efficiency")
        )
        gears = [self._gears.rows[place] for place in self._places.tolist()]
        loaded, known = lines_of_efficiency(gears, self._catalogue)
        own_inertia, without_load = (
            np.nan_to_num(column[self._places])[kind] for column in (columns.inertia_kgm2, columns.no_load_torque_Nm)
        )
        trains = DriveTrains(
            curve=own[row],
            ratio=self._ratio[kind],
            loaded_Nm=loaded[kind],
            efficiency=np.where(np.isnan(stated)[:, None], known[kind], stated[:, None]),
            inertia_kgm2=inertia + own_inertia,
            no_load_torque_Nm=without_load,
            pause_s=pause_s,
        )
        figures = np.full((3, len(own), len(gears)), np.nan)
        figures[:, row, kind] = judged_along(course, self._curves, trains)
        return figures

"""Applications as arrays: N duty cycles side by side, so that one code path serves one and a million."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hpn import bearing, equations
from hpn.application import Application, OutputLoad
from hpn.compiled import compiled

FloatArray = NDArray[np.float64]

TORQUE, SPEED, DURATION, RADIAL, AXIAL = range(5)
"""Columns of `Duty.phases`."""

(
    PAUSE,
    UTILISATION,
    STOP_TORQUE,
    STOP_COUNT,
    LIFE,
    BACKLASH,
    STIFFNESS,
    WEIGHT,
    LENGTH,
    TEMPERATURE,
    EFFICIENCY,
    MOTOR_SPEED,
    MOTOR_PEAK,
    MOTOR_RATED,
    LOAD_COEFFICIENT,
    BEARING_L50,
    MODEL,
    RANK_BY,
) = range(18)
"""Columns of `Duty.wishes`."""

LINEAR, ISO281, DIGITISED = range(3)
_MODEL = {"linear": LINEAR, "iso281": ISO281, "digitised": DIGITISED}
BY_WEIGHT, BY_UTILISATION, BY_LENGTH, BY_MOTOR_TORQUE, BY_LIFE, BY_STIFFNESS = range(6)
_RANK_BY = {
    "weight": BY_WEIGHT,
    "utilisation": BY_UTILISATION,
    "length": BY_LENGTH,
    "motor_torque": BY_MOTOR_TORQUE,
    "life": BY_LIFE,
    "stiffness": BY_STIFFNESS,
}

T_AV, N_OUT_AV, T_MAX, N_OUT_MAX, T_RMS = range(5)
"""Columns of `Duty.figures`."""


class Duty:
    """N applications as arrays; `loads` are the conditions of their output loads, None where there is none.

    `phases` has shape (N, phases, 5), by magnitude; shorter cycles are padded with phases of no duration, which have no
    weight in any equation. `wishes`, shape (N, 18), is what else is asked; NaN where it is not. `figures`, shape
    (N, 5), is what the cycles come to.
    """

    def __init__(self, applications: Sequence[Application]) -> None:
        self.applications, self.loads = applications, [application.loads for application in applications]
        cycles = list(map(_phases, applications, self.loads))
        longest = max(map(len, cycles))
        padded = [cycle + [0.0] * (longest - len(cycle)) for cycle in cycles]
        self.phases = np.array(padded).reshape(len(cycles), -1, 5)
        self.wishes = np.array(list(map(_wishes, applications, self.loads)), dtype=np.float64)
        self.figures = np.empty((len(applications), 5))
        _work_out(self.phases, self.wishes, self.figures)

    @property
    def torque_Nm(self) -> FloatArray:
        """Torque of every phase by magnitude, shape (N, phases)."""
        return self.phases[:, :, TORQUE]

    @property
    def speed_rpm(self) -> FloatArray:
        """Speed of every phase by magnitude, shape (N, phases)."""
        return self.phases[:, :, SPEED]

    @property
    def duration_s(self) -> FloatArray:
        """Duration of every phase, shape (N, phases)."""
        return self.phases[:, :, DURATION]

    @property
    def loads_N(self) -> tuple[FloatArray, FloatArray]:
        """Magnitudes of the radial and axial load, shape (N, phases): each the phase's, else the cycle's, else 0."""
        return self.phases[:, :, RADIAL], self.phases[:, :, AXIAL]

    @property
    def pause_s(self) -> FloatArray:
        """Pause t_p, shape (N,)."""
        return self.wishes[:, PAUSE]

    @property
    def emergency_stop_torque_Nm(self) -> FloatArray:
        """Magnitude of T_k, shape (N,); NaN without an emergency stop."""
        return self.wishes[:, STOP_TORQUE]

    @property
    def average_torque_Nm(self) -> FloatArray:
        """T_av, shape (N,)."""
        return self.figures[:, T_AV]

    @property
    def average_output_speed_rpm(self) -> FloatArray:
        """n_out_av, shape (N,)."""
        return self.figures[:, N_OUT_AV]

    @property
    def maximum_torque_Nm(self) -> FloatArray:
        """T_max, holding phases included, shape (N,)."""
        return self.figures[:, T_MAX]

    @property
    def maximum_output_speed_rpm(self) -> FloatArray:
        """n_out_max, shape (N,)."""
        return self.figures[:, N_OUT_MAX]


def _phases(application: Application, load: OutputLoad | None) -> list[float]:
    """A row of `Duty.phases`, one phase behind the other, without its padding."""
    figures: list[float] = []
    if load is None:
        for phase in application.duty_cycle.phases:
            figures += abs(phase.torque_Nm), abs(phase.speed_rpm), phase.duration_s, 0.0, 0.0
        return figures
    radial, axial = load.radial_N or 0.0, load.axial_N or 0.0
    for phase in application.duty_cycle.phases:
        figures += abs(phase.torque_Nm), abs(phase.speed_rpm), phase.duration_s
        figures.append(abs(radial if phase.radial_N is None else phase.radial_N))
        figures.append(abs(axial if phase.axial_N is None else phase.axial_N))
    return figures


_NOT_ASKED = math.nan


def _wishes(application: Application, load: OutputLoad | None) -> tuple[float, ...]:
    """A row of `Duty.wishes`."""
    stop, asked = application.emergency_stop, application.requirements
    motor = asked.motor
    return (
        application.duty_cycle.pause_s,
        asked.utilisation,
        abs(stop.torque_Nm) if stop else _NOT_ASKED,
        _NOT_ASKED if stop is None or stop.count is None else stop.count,
        _NOT_ASKED if asked.life_h is None else asked.life_h,
        _NOT_ASKED if asked.backlash_arcmin is None else asked.backlash_arcmin,
        _NOT_ASKED if asked.torsional_stiffness_Nm_per_rad is None else asked.torsional_stiffness_Nm_per_rad,
        _NOT_ASKED if asked.weight_kg is None else asked.weight_kg,
        _NOT_ASKED if asked.length_mm is None else asked.length_mm,
        _NOT_ASKED if asked.ambient_temperature_degC is None else asked.ambient_temperature_degC,
        _NOT_ASKED if asked.efficiency is None else asked.efficiency,
        _NOT_ASKED if motor is None or motor.maximum_speed_rpm is None else motor.maximum_speed_rpm,
        _NOT_ASKED if motor is None or motor.peak_torque_Nm is None else motor.peak_torque_Nm,
        _NOT_ASKED if motor is None or motor.rated_torque_Nm is None else motor.rated_torque_Nm,
        load.load_coefficient if load else _NOT_ASKED,
        bearing.required_L50(load.life_h, load.life_basis) if load else _NOT_ASKED,
        _MODEL[load.model] if load else _NOT_ASKED,
        _RANK_BY[application.rank_by],
    )


_average_output_torque, _average_output_speed = (
    equations.average_output_torque.case,
    equations.average_output_speed.case,
)
_rms_torque = equations.rms_torque.case


@compiled
def _work_out(phases: FloatArray, wishes: FloatArray, figures: FloatArray) -> None:
    for n in range(phases.shape[0]):
        T, speed, t = phases[n, :, TORQUE], phases[n, :, SPEED], phases[n, :, DURATION]
        figures[n, T_AV] = _average_output_torque(T, speed, t)
        figures[n, N_OUT_AV] = _average_output_speed(speed, t, wishes[n, PAUSE])
        figures[n, T_MAX] = T.max()
        figures[n, N_OUT_MAX] = speed.max()
        figures[n, T_RMS] = _rms_torque(T, t, wishes[n, PAUSE])

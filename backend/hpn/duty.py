"""Applications as columns: N duty cycles side by side as arrays, so that one code path serves one and a million."""

from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hpn import bearing, equations
from hpn.application import Application

FloatArray = NDArray[np.float64]


class Duty:
    """N applications as columns of shape (N, 1), to broadcast against gears of shape (G,).

    Shorter cycles are padded with phases of no duration, which have no weight in any equation.
    """

    def __init__(self, applications: Sequence[Application]) -> None:
        self.applications = applications
        cycles = [application.duty_cycle for application in applications]
        longest = max(len(cycle.phases) for cycle in cycles)
        table = np.zeros((len(cycles), longest, 3))
        for index, cycle in enumerate(cycles):
            table[index, : len(cycle.phases)] = [(p.torque_Nm, p.speed_rpm, p.duration_s) for p in cycle.phases]
        self.torque_Nm, self.speed_rpm, self.duration_s = np.abs(table).transpose(2, 0, 1)
        self.pause_s = np.array([cycle.pause_s for cycle in cycles])
        self.average_torque_Nm = equations.average_output_torque(
            torque_Nm=self.torque_Nm, speed_rpm=self.speed_rpm, duration_s=self.duration_s
        )[:, None]
        self.average_output_speed_rpm = equations.average_output_speed(
            speed_rpm=self.speed_rpm, duration_s=self.duration_s, pause_s=self.pause_s
        )[:, None]
        self.maximum_torque_Nm = np.maximum.reduce(self.torque_Nm, axis=1, keepdims=True)
        self.maximum_output_speed_rpm = np.maximum.reduce(self.speed_rpm, axis=1, keepdims=True)

    def column(self, value: Callable[[Application], float | None]) -> FloatArray:
        """One input of every application, shape (N, 1); NaN where it is not given."""
        return np.array([[np.nan if (v := value(a)) is None else v] for a in self.applications], dtype=float)

    @cached_property
    def rms_torque_Nm(self) -> FloatArray:
        """RMS output torque over the cycle with its pause, shape (N, 1)."""
        return equations.rms_torque(torque_Nm=self.torque_Nm, duration_s=self.duration_s, pause_s=self.pause_s)[:, None]

    @cached_property
    def emergency_stop_torque_Nm(self) -> FloatArray:
        """Magnitude of T_k, shape (N, 1); NaN without an emergency stop."""
        return np.abs(self.column(lambda a: a.emergency_stop.torque_Nm if a.emergency_stop else None))

    @cached_property
    def reserve_utilisation(self) -> FloatArray:
        """The user's largest acceptable utilisation u of the load checks, shape (N, 1)."""
        return self.column(lambda a: a.requirements.utilisation)

    @cached_property
    def loads_N(self) -> tuple[FloatArray, FloatArray]:
        """Magnitudes of the radial and axial load, shape (N, phases): each the phase's, else the cycle's, else 0."""
        radial, axial = np.zeros(self.torque_Nm.shape), np.zeros(self.torque_Nm.shape)
        for index, application in enumerate(self.applications):
            phases, load = application.duty_cycle.phases, application.loads
            if load is not None:
                cycle_radial, cycle_axial = load.radial_N or 0.0, load.axial_N or 0.0
                radial[index, : len(phases)] = [cycle_radial if p.radial_N is None else p.radial_N for p in phases]
                axial[index, : len(phases)] = [cycle_axial if p.axial_N is None else p.axial_N for p in phases]
        return np.abs(radial), np.abs(axial)

    @cached_property
    def load_coefficient(self) -> FloatArray:
        """Load coefficient f_w, shape (N, 1); 1 without loads."""
        return self.column(lambda a: a.loads.load_coefficient if a.loads else 1.0)

    @cached_property
    def required_bearing_L50_h(self) -> FloatArray:
        """Required bearing life as L50, shape (N, 1); NaN without loads."""
        return self.column(lambda a: bearing.required_L50(a.loads.life_h, a.loads.life_basis) if a.loads else None)

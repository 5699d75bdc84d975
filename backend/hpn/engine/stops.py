"""Emergency stops by the brake on gears: torque, time, angle and energy, and how hard the brake may be."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hpn.catalogue import GearColumns
from hpn.engine.duty import Duty
from hpn.physics import stop
from hpn.physics.equations import FloatArray

SOLVED = 1e-9
"""Relative room of a torque that was solved for and is put back into its equation."""


@dataclass(frozen=True, eq=False)
class Stops:
    """Stops of N applications on G gears, each figure broadcasting to (N, G); NaN where no brake is given.

    `drive_resonance_Hz` and `motor_inertia_kgm2`, with the gear's own at the input, are those of the figures.
    """

    duty: Duty
    gears: GearColumns
    drive_resonance_Hz: FloatArray
    motor_inertia_kgm2: FloatArray

    @cached_property
    def brake(self) -> stop.Brake:
        """The brake, and what it stops."""
        stated = self.duty.asked["requirements.efficiency"]
        return stop.Brake(
            torque_Nm=self.duty.asked["emergency_stop.brake.torque_Nm"],
            ratio=self.gears.ratio,
            motor_inertia_kgm2=self.motor_inertia_kgm2,
            load_inertia_kgm2=self.duty.load_inertia_kgm2,
            efficiency=np.where(np.isnan(stated), 1.0, stated),
        )

    @cached_property
    def dynamic_factor(self) -> FloatArray:
        """Dynamic factor f: as it is given, else by rise time and drive resonance. [-]"""
        given = self.duty.asked["emergency_stop.brake.dynamic_factor"]
        rise = self.duty.asked["emergency_stop.brake.rise_time_s"]
        computed = stop.dynamic_factor(rise_time_s=rise, drive_resonance_Hz=self.drive_resonance_Hz)
        return np.where(np.isnan(given), computed, given)

    @cached_property
    def opposing_torques_Nm(self) -> tuple[FloatArray, ...]:
        """Torques in Nm against the motion at which a stop may be hardest: both ends of their range, and 0."""
        lowest, highest = self.duty.opposing_torque_Nm
        return lowest, np.zeros_like(lowest), highest

    @cached_property
    def torque_Nm(self) -> FloatArray:
        """Largest torque T_k of the gear in Nm."""
        return self._torque_of(self.brake)

    def _torque_of(self, brake: stop.Brake) -> FloatArray:
        torques = [
            stop.stop_torque(brake=brake, opposing_torque_Nm=T_opp, dynamic_factor=self.dynamic_factor)
            for T_opp in self.opposing_torques_Nm
        ]
        T_k: FloatArray = np.maximum.reduce(torques)
        return T_k

    @cached_property
    def course(self) -> stop.Stop:
        """Time, angle and energy of the longest stop, at the smallest opposing torque."""
        asked = self.duty.asked
        return stop.course_of_stop(
            brake=self.brake,
            opposing_torque_Nm=self.duty.opposing_torque_Nm[0],
            speed_rad_per_s=self.duty.stop_speed_rpm * np.pi / 30,
            reaction_time_s=asked["emergency_stop.brake.reaction_time_s"],
            rise_time_s=asked["emergency_stop.brake.rise_time_s"],
        )

    @cached_property
    def never_stops(self) -> NDArray[np.bool_]:
        """True where the brake does not stop the load, shape (N, G); False without a brake."""
        given = ~np.isnan(self.brake.torque_Nm)
        return given & ~stop.is_stopped(brake=self.brake, opposing_torque_Nm=self.duty.opposing_torque_Nm[0])

    def largest_brake_torque_Nm(self, permissible_torque_Nm: FloatArray) -> FloatArray:
        """Largest torque T_B of the brake in Nm at which no stop exceeds a permissible torque of the gear.

        0 where none both keeps to it and stops the load; NaN where the torque is not published.
        """
        torques = [
            stop.largest_brake_torque(
                brake=self.brake,
                opposing_torque_Nm=T_opp,
                dynamic_factor=self.dynamic_factor,
                permissible_torque_Nm=permissible_torque_Nm,
            )
            for T_opp in self.opposing_torques_Nm
        ]
        T_B: FloatArray = np.minimum.reduce(torques)
        brake = replace(self.brake, torque_Nm=T_B)
        keeps = self._torque_of(brake) <= permissible_torque_Nm * (1 + SOLVED)
        stops = stop.is_stopped(brake=brake, opposing_torque_Nm=self.duty.opposing_torque_Nm[0])
        return np.where(np.isnan(T_B) | (keeps & stops), T_B, 0.0)

"""Emergency stops by the brake on gears: torque, time, angle and energy, and the brake's largest torque."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hpn.application import Application
from hpn.catalogue import GearColumns
from hpn.engine.duty import Duty
from hpn.physics import stop
from hpn.physics.equations import ROUNDING, FloatArray
from hpn.physics.motion.mechanisms import GRAVITY, Linear
from hpn.physics.stiffness import ARCMIN_PER_RAD


@dataclass(frozen=True, eq=False)
class Stops:
    """Stops of N applications on G gears, each figure broadcasting to (N, G); NaN without a brake.

    `motor_inertia_kgm2` includes the gear's own inertia at the input.
    """

    duty: Duty
    gears: GearColumns
    motor_inertia_kgm2: FloatArray

    @cached_property
    def brake(self) -> stop.BrakeFigures:
        """The brake with the inertias that it stops."""
        stated = self.duty.inputs["requirements.efficiency"]
        return stop.BrakeFigures(
            torque_Nm=self.duty.inputs["emergency_stop.brake.torque_Nm"],
            ratio=self.gears.ratio,
            motor_inertia_kgm2=self.motor_inertia_kgm2,
            load_inertia_kgm2=self.duty.load_inertia_kgm2,
            efficiency=np.where(np.isnan(stated), 1.0, stated),
        )

    @cached_property
    def play(self) -> stop.Play:
        """The gears as springs with backlash."""
        return stop.Play(self.gears.torsional_stiffness_Nm_per_rad, self.gears.backlash_arcmin / ARCMIN_PER_RAD)

    @property
    def load(self) -> stop.LoadTorques:
        """Torques of the load at the gear."""
        return self.duty.stop_load

    @property
    def dynamic_factor(self) -> FloatArray:
        """The user's own dynamic factor f; NaN without one. [-]"""
        return self.duty.inputs["emergency_stop.brake.dynamic_factor"]

    @cached_property
    def torque_Nm(self) -> FloatArray:
        """Torque T_k of a stop on the gear in Nm; an upper bound, except by the user's own dynamic factor."""
        return stop.stop_torque(brake=self.brake, load=self.load, gear=self.play, dynamic_factor=self.dynamic_factor)

    @cached_property
    def course(self) -> stop.Stop:
        """Upper bounds of a stop's time, angle and energy."""
        inputs = self.duty.inputs
        return stop.course_of_stop(
            brake=self.brake,
            load=self.load,
            gear=self.play,
            stop_torque_Nm=self.torque_Nm,
            speed_rad_per_s=self.duty.stop_speed_rpm * np.pi / 30,
            reaction_time_s=inputs["emergency_stop.brake.reaction_time_s"],
            rise_time_s=inputs["emergency_stop.brake.rise_time_s"],
        )

    @cached_property
    def never_stops(self) -> NDArray[np.bool_]:
        """True where the brake does not stop the load, shape (N, G); False without a brake."""
        return ~np.isnan(self.brake.torque_Nm) & ~stop.is_stopped(brake=self.brake, load=self.load)

    @cached_property
    def never_holds(self) -> NDArray[np.bool_]:
        """True where the brake stops the load but does not hold it at rest, shape (N, G)."""
        stopped = stop.is_stopped(brake=self.brake, load=self.load)
        return stopped & ~stop.is_held(brake=self.brake, load=self.load)

    def largest_brake_torque_Nm(self, permissible_torque_Nm: FloatArray) -> FloatArray:
        """Largest torque T_B of the brake in Nm at which no stop exceeds a permissible torque of the gear.

        0 if no such torque stops the load; NaN if the permissible torque is not published.
        """
        return stop.largest_brake_torque(
            brake=self.brake,
            load=self.load,
            gear=self.play,
            dynamic_factor=self.dynamic_factor,
            permissible_torque_Nm=permissible_torque_Nm,
        )

    def largest_load_inertia_kgm2(self, permissible_torque_Nm: FloatArray) -> FloatArray:
        """Largest inertia of the load in kg m² at which no stop exceeds a permissible torque of the gear.

        Infinite without a limit; NaN where the brake does not hold the load, or an inertia is unknown.
        """
        return stop.largest_load_inertia(
            brake=self.brake,
            load=self.load,
            gear=self.play,
            dynamic_factor=self.dynamic_factor,
            permissible_torque_Nm=permissible_torque_Nm,
        )

    def sentence_on(
        self, application: Application, index: int, first: int, name: str
    ) -> Iterator[tuple[str, dict[str, float | str]]]:
        """Yield codes and values of the notices on the stops of application `index` by its brake.

        `first` is the place of its first candidate, `name` its designation.
        """
        stop, motion = application.emergency_stop, application.duty_cycle.motion
        if stop is None or (brake := stop.brake) is None:
            return
        if np.isnan(self.duty.load_inertia_kgm2.item(index)) or np.isnan(self.motor_inertia_kgm2[index]).all():
            yield "brake_inertia_unknown", {}
        yield "brake_bound" if brake.dynamic_factor is None else "brake_factor_typed", {}
        if np.isnan(self.duty.inputs["requirements.efficiency"].item(index)):
            yield "brake_efficiency_unknown", {}
        if index not in self.duty.stopped_loads:
            pulled = brake.load_torque_Nm is not None or brake.opposing_torque_Nm is not None
            yield "brake_while_accelerating" if pulled else "brake_without_load", {}
        if slipping := sorted(set(self.gears.ratio[self.never_holds[index]].tolist())):
            pulling = np.asarray(self.load.pulling_Nm).item(index)
            yield "brake_does_not_hold", {"torque_Nm": pulling, "ratios": ", ".join(f"{i:g}" for i in slipping)}
        if motion is not None and isinstance(motion.mechanism, Linear) and motion.mechanism.counterweight_kg:
            share = self.hardest_rad_per_s2[index, first] * motion.mechanism.load.way_at_gear_m / GRAVITY
            if share > 1 + ROUNDING:
                yield "counterweight_slack", {"share_percent": 100 * float(share), "name": name}

    @property
    def hardest_rad_per_s2(self) -> FloatArray:
        """Upper bound (T_k + T_o) / J of the load's deceleration in rad/s², shape (N, G)."""
        hardest: FloatArray = (self.torque_Nm + self.load.opposing_Nm) / self.duty.load_inertia_kgm2
        return hardest

"""Motor of the gear shown on the page: omissions of its torques, and fitting motors and gears."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

from hpn.account.readings import assumed_of, thermal_of_candidate
from hpn.application import Application, Motor
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.allowed import with_listed_motor
from hpn.engine.duty import Duty
from hpn.engine.motors import MotorUse, SizeWithMotor, asks_inertia_ratio, motors_on, ratios_with_motor, with_motor
from hpn.engine.notices import on_motor_torques
from hpn.engine.selection import Selection
from hpn.explain.calculation.motor import BY_CURVE, LOSS_FREE, STATED
from hpn.links.writer import to_link
from hpn.physics import stiffness
from hpn.web.form.linked import LONGEST_LINK
from hpn.words.wording import N_, Sentence

LISTED_AT_ONCE = 25
"""Fitting motors that the page lists at first."""


@dataclass(frozen=True)
class DriveView:
    """Gear under an application with a motor, or without one until a motor is chosen."""

    application: Application
    gear: Gear
    catalogue: Catalogue
    selection: Selection
    links: Callable[[Application], str] = to_link
    most: int = LISTED_AT_ONCE

    @cached_property
    def motor(self) -> Motor | None:
        """Required motor; a named motor has the figures of the list."""
        return with_listed_motor(self.application, self.catalogue).requirements.motor

    @property
    def is_told(self) -> bool:
        """True if torques are drawn: a motor is required, a motion is given, or there is a list of motors."""
        return bool(self.motor or self.application.duty_cycle.motion or self.catalogue.motors)

    @cached_property
    def uses(self) -> Sequence[MotorUse]:
        """Listed motors on the gear, best first."""
        return motors_on(self.application, self.gear, self.catalogue)

    @property
    def fitting(self) -> list[MotorUse]:
        """Motors that fit."""
        return [use for use in self.uses if use.fits]

    @property
    def nearest(self) -> MotorUse | None:
        """Nearest miss; None if all motors fit."""
        return next((use for use in self.uses if not use.fits), None)

    @property
    def without_inertia(self) -> int:
        """Number of motors that a required inertia ratio excludes, as their inertia is unknown."""
        if not asks_inertia_ratio(self.application):
            return 0
        return sum(motor.inertia_kgm2 is None for motor in self.catalogue.motors)

    def is_chosen(self, use: MotorUse) -> bool:
        """True for the required motor."""
        return self.motor is not None and self.motor.designation == use.motor.designation

    def link(self, use: MotorUse) -> str:
        """Link of the application with a listed motor; blank for a link too long to repeat for each motor."""
        link = self.links(with_motor(self.application, use.motor))
        return link if len(link) <= LONGEST_LINK else ""

    @property
    def assumed(self) -> Sentence | None:
        """Assumption on the motor's torque between its known figures; None without a motor or figures."""
        known = self.motor and (self.motor.curve or self.motor.rated_torque_Nm or self.motor.peak_torque_Nm)
        return assumed_of(self.motor) if known else None

    @property
    def thermal(self) -> Sentence | None:
        """Sentence with both rules of the motor's thermal load on the gear; None without a torque curve."""
        candidate = self.selection.candidate(self.gear.designation)
        return thermal_of_candidate(candidate) if candidate else None

    @property
    def speed_limit_rpm(self) -> float | None:
        """Speed limit for the drive in rpm: the smaller known one of gear and motor; None if both are unknown."""
        speeds = (self.gear.maximum_input_speed_rpm, self.motor.top_speed_rpm if self.motor else None)
        return min((n for n in speeds if n is not None), default=None)

    @property
    def error_parts(self) -> list[tuple[str, float]]:
        """Names and values of the parts of the position error in arcmin; empty if one is not published."""
        gear, (lowest, highest) = self.gear, (torque.item() for torque in self._duty.torque_range_Nm)
        accuracy, backlash, K3 = (
            gear.transmission_accuracy_arcmin,
            gear.backlash_arcmin,
            gear.torsional_stiffness_Nm_per_rad,
        )
        if accuracy is None or backlash is None or K3 is None:
            return []
        wind_up = stiffness.wind_up(torque_Nm=highest - lowest, torsional_stiffness_Nm_per_rad=K3).item()
        crossed = backlash if lowest <= 0 <= highest else 0.0
        parts = (
            (N_("accuracy"), accuracy),
            (N_("backlash"), crossed),
            (N_("wind-up from lowest to highest torque"), wind_up),
        )
        return [(name, value) for name, value in parts if value > 0]

    @property
    def shortest_ramp_s(self) -> float | None:
        """Shortest ramp of a motion in s; None for phases."""
        motion = self.application.duty_cycle.motion
        return min((move.shortest_ramp_s for move in motion.moves if move.way), default=None) if motion else None

    @property
    def stop_speed_rpm(self) -> float:
        """Output speed in rpm at the command of an emergency stop."""
        return float(self._duty.stop_speed_rpm.item())

    @cached_property
    def _duty(self) -> Duty:
        return Duty.of([self.application])

    @property
    def sizes(self) -> list[SizeWithMotor]:
        """Gears that fit together with the motor, by size."""
        return ratios_with_motor(self.selection)

    @property
    def left_out(self) -> list[Sentence]:
        """Notes on torques at the motor with this gear: their basis and their omissions."""
        return [
            self._efficiency(BY_CURVE, known=self.gear.designation in self.catalogue.efficiency),
            on_motor_torques(self.selection.notices),
        ]

    @property
    def left_out_of_all(self) -> list[Sentence]:
        """Notes on torques at the motor with any gear: their basis and their omissions."""
        curves = N_("η from your efficiency curves; 1 for a gear that has none, a lower bound.")
        return [
            self._efficiency(curves, known=bool(self.catalogue.efficiency)),
            on_motor_torques(self.selection.notices),
        ]

    def _efficiency(self, curve: str, *, known: bool) -> Sentence:
        if self.application.requirements.efficiency is not None:
            return Sentence(STATED)
        return Sentence(curve if known else LOSS_FREE)

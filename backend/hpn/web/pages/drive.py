"""The motor behind the gear that the page looks at: what its torques leave out, and which motors and gears fit."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

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
"""Motors that fit of which the page shows the use."""


@dataclass(frozen=True)
class DriveView:
    """A gear under an application with a motor, or without one as long as none is chosen."""

    application: Application
    gear: Gear
    catalogue: Catalogue
    selection: Selection
    links: Callable[[Application], str] = to_link
    most: int = LISTED_AT_ONCE

    @cached_property
    def motor(self) -> Motor | None:
        """The motor that is asked for, its figures those of the list where it is named."""
        return with_listed_motor(self.application, self.catalogue).requirements.motor

    @property
    def is_told(self) -> bool:
        """True where torques are drawn: a motor is asked for, a motion given, or there is a list to choose from."""
        return bool(self.motor or self.application.duty_cycle.motion or self.catalogue.motors)

    @cached_property
    def uses(self) -> Sequence[MotorUse]:
        """The user's motors on the gear, best first."""
        return motors_on(self.application, self.gear, self.catalogue)

    @property
    def fitting(self) -> list[MotorUse]:
        """Those that fit."""
        return [use for use in self.uses if use.fits]

    @property
    def nearest(self) -> MotorUse | None:
        """The nearest miss."""
        return next((use for use in self.uses if not use.fits), None)

    @property
    def without_inertia(self) -> int:
        """Number of motors that an inertia ratio leaves out, as their inertia is not known."""
        if not asks_inertia_ratio(self.application):
            return 0
        return sum(motor.inertia_kgm2 is None for motor in self.catalogue.motors)

    def is_chosen(self, use: MotorUse) -> bool:
        """True for the motor that is asked for."""
        return self.motor is not None and self.motor.designation == use.motor.designation

    def link(self, use: MotorUse) -> str:
        """Link of the application with a motor of the list, blank for one that is too long to stand for each motor."""
        link = self.links(with_motor(self.application, use.motor))
        return link if len(link) <= LONGEST_LINK else ""

    @property
    def speed_limit_rpm(self) -> float | None:
        """Speed to set in the drive: the smaller of what gear and motor may run at, as far as they are known."""
        of_motor = self.motor.maximum_speed_rpm if self.motor else None
        return min((n for n in (self.gear.maximum_input_speed_rpm, of_motor) if n is not None), default=None)

    @property
    def error_parts(self) -> list[tuple[str, float]]:
        """Parts that add up to the position error in arcmin by their names; none where one is not published."""
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
        parts = ((N_("accuracy"), accuracy), (N_("backlash"), crossed), (N_("wind-up"), wind_up))
        return [(name, value) for name, value in parts if value > 0]

    @property
    def shortest_ramp_s(self) -> float | None:
        """Shortest ramp of a motion; None where phases are typed."""
        motion = self.application.duty_cycle.motion
        return min((move.shortest_ramp_s for move in motion.moves if move.way), default=None) if motion else None

    @property
    def stop_speed_rpm(self) -> float:
        """Output speed at the command of an emergency stop."""
        return float(self._duty.stop_speed_rpm.item())

    @cached_property
    def _duty(self) -> Duty:
        return Duty.of([self.application])

    @property
    def sizes(self) -> list[SizeWithMotor]:
        """Gears that fit with the motor, by size."""
        return ratios_with_motor(self.selection)

    @property
    def left_out(self) -> list[Sentence]:
        """Notes on torques at the motor on the gear: their basis, and what they leave out."""
        return [
            self._efficiency(BY_CURVE, known=self.gear.designation in self.catalogue.efficiency),
            on_motor_torques(self.selection.notices),
        ]

    @property
    def left_out_of_all(self) -> list[Sentence]:
        """The same of every gear."""
        curves = N_("η from your efficiency curves; 1 for a gear that has none, a lower bound.")
        return [
            self._efficiency(curves, known=bool(self.catalogue.efficiency)),
            on_motor_torques(self.selection.notices),
        ]

    def _efficiency(self, curve: str, *, known: bool) -> Sentence:
        if self.application.requirements.efficiency is not None:
            return Sentence(STATED)
        return Sentence(curve if known else LOSS_FREE)

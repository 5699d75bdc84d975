"""Subject of the pictures: an application, and the selected gear."""

from dataclasses import dataclass
from functools import cached_property
from math import isnan

from hpn.application import Application
from hpn.catalogue import Catalogue, GearList
from hpn.catalogue.gear import Gear
from hpn.engine.allowed import with_listed_motor
from hpn.engine.candidates import Candidate
from hpn.engine.duty import Duty
from hpn.engine.figures import Figures


@dataclass(frozen=True)
class Subject:
    """An application and one gear; figures that its pictures share are computed once, on first use.

    `chosen` is the judged gear, of this moment or of a saved answer.
    """

    application: Application
    gear: Gear
    catalogue: Catalogue
    chosen: Candidate | None = None

    @cached_property
    def duty(self) -> Duty:
        """Figures of the duty cycle."""
        return Duty.of([self.application])

    @cached_property
    def sizes(self) -> GearList:
        """The first gear of every size: properties of a size, such as its output bearing, are the same in all its
        gears.
        """
        first: dict[str, Gear] = {}
        for gear in self.catalogue.gears:
            first.setdefault(gear.size, gear)
        return self.catalogue.listed(first.values())

    @cached_property
    def of_sizes(self) -> Figures:
        """Figures of the first gear of every size."""
        return Figures(self.duty, self.sizes, self.catalogue)

    @cached_property
    def equipped(self) -> Application:
        """The application with the figures of its listed motor."""
        return with_listed_motor(self.application, self.catalogue)

    @cached_property
    def of_gear(self) -> Figures:
        """Figures of the gear itself, with the motor's."""
        gears = self.catalogue.listed([self.gear])
        return Figures(Duty.of([self.equipped]), gears, self.catalogue)

    @property
    def place(self) -> int:
        """Place of the gear's own size in `sizes`."""
        return self.catalogue.sizes.index(self.gear.size)

    @cached_property
    def emergency_stop_torque_Nm(self) -> float | None:
        """Torque of the emergency stop on the gear by magnitude, or None without one."""
        stop = self.application.emergency_stop
        if stop is None:
            return None
        if self.chosen is not None:
            own = self.chosen.says("stop_torque_Nm")
            return self.chosen.stop_torque_Nm if own else stop.torque_Nm and abs(stop.torque_Nm)
        T_k = self.of_gear.stop_torque_Nm.item()
        return None if isnan(T_k) else T_k

"""One selection as it leaves the service: what was asked and what was answered, never computed again."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import cached_property
from typing import Any

from hpn import equations
from hpn.application import Application
from hpn.candidates import Candidate, foremost
from hpn.catalogue import Catalogue
from hpn.gear import Gear
from hpn.wording import N_

LOSS_FREE = N_("η = 1 where no efficiency is known: a lower bound")
LOWER_BOUND = N_("lower bound where η = 1")
"""What is to be known of motor torques, in full and where there is little room."""


@dataclass(frozen=True)
class Export:
    """An application, the reply to it, and what a reader needs to find both again.

    `link` is absolute. `created` is when the selection was saved, in a time zone; None for one that is not saved, whose
    files then carry no date. `catalogue` gives the figures behind the reply; one of another version is not used, and
    the files say so.
    """

    application: Application
    reply: Mapping[str, Any]
    link: str
    title: str = ""
    reference: str = ""
    created: datetime | None = None
    catalogue: Catalogue | None = None

    @property
    def candidates(self) -> Sequence[Candidate]:
        """Every candidate, best first."""
        candidates: Sequence[Candidate] = self.reply["candidates"]
        return candidates

    @property
    def candidate(self) -> Candidate:
        """The selected gear, or the nearest miss where none is suitable."""
        return foremost(self.candidates)

    @property
    def definitions(self) -> Mapping[str, Any]:
        """Check definitions by code."""
        definitions: Mapping[str, Any] = self.reply["check_definitions"]
        return definitions

    @cached_property
    def figures(self) -> Catalogue | None:
        """The catalogue of the reply's own version, or None where that is not at hand."""
        known = self.catalogue is not None and self.catalogue.version == self.reply["catalogue_version"]
        return self.catalogue if known else None

    def gear(self, designation: str) -> Gear | None:
        """Published figures of a candidate as they were, or None."""
        return self.figures.by_designation.get(designation) if self.figures else None

    def check(self, code: str) -> Mapping[str, Any] | None:
        """A check of the reported gear, or None where it was not asked for."""
        return next((check for check in self.candidate["checks"] if check["code"] == code), None)

    @cached_property
    def rms_torque_Nm(self) -> float:
        """RMS torque of the cycle at the output, pause included; the reply has it behind each gear's efficiency."""
        cycle = self.application.duty_cycle
        return equations.rms_torque(
            torque_Nm=[phase.torque_Nm for phase in cycle.phases],
            duration_s=[phase.duration_s for phase in cycle.phases],
            pause_s=cycle.pause_s,
        ).item()

    def follows_efficiency_curve(self, candidate: Candidate) -> bool:
        """Whether the motor torques of a candidate are by a curve of a supplement, phase by phase.

        A stated efficiency goes before any curve. Without the catalogue of the reply its figures tell, as far as they
        can: a curve that says nothing of any phase leaves no trace in them.
        """
        if self.application.requirements.efficiency is not None:
            return False
        if self.figures is not None:
            return candidate["designation"] in self.figures.efficiency
        output = {
            "motor_peak_torque_Nm": self.reply["duty"]["maximum_torque_Nm"],
            "motor_rated_torque_Nm": self.rms_torque_Nm,
        }
        plain = {name: torque / candidate["ratio"] for name, torque in output.items()}
        return any(abs(candidate[name] - value) > 1e-9 * value for name, value in plain.items())

    def is_lower_bound(self, candidate: Candidate) -> bool:
        """Whether the motor torques of a candidate are loss-free, in some phase at least: no efficiency is known."""
        if self.application.requirements.efficiency is not None:
            return False
        if not self.follows_efficiency_curve(candidate):
            return True
        if self.figures is None:
            return False
        known, _ = self.figures.efficiency[candidate["designation"]]
        torques = [abs(phase.torque_Nm) for phase in self.application.duty_cycle.phases]
        return any(torque and not known[0] <= torque <= known[-1] for torque in torques)

    @property
    def runner_up(self) -> Candidate | None:
        """The second suitable gear, or None."""
        second = self.candidates[1:2]
        return second[0] if second and second[0]["status"] == "suitable" else None

    @property
    def smaller(self) -> Candidate | None:
        """The nearest miss among the smaller sizes: of the same ratio where there is one, else of any."""
        own = frame(self.candidate)
        misses = [c for c in self.candidates if c["status"] == "unsuitable" and frame(c) < own]
        same = [c for c in misses if c["ratio"] == self.candidate["ratio"]]
        return next(iter(same or misses), None)


def frame(candidate: Candidate) -> int:
    """Number in the size of a candidate: 20 for 20A."""
    return int(str(candidate["size"]).rstrip("A"))

"""One selection as it leaves the service: what was asked and what was answered, never computed again."""

import re
from collections.abc import Callable
from dataclasses import dataclass, field, fields
from datetime import datetime
from functools import cached_property
from pkgutil import resolve_name
from typing import Any

import numpy as np

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.allowed import with_listed_motor
from hpn.engine.candidates import Candidate
from hpn.engine.checks import BY_CODE
from hpn.engine.duty import Duty
from hpn.engine.selection import Selection
from hpn.explain.comparison import lighter_miss
from hpn.physics import equations
from hpn.words.wording import N_

DIGITS = 4
"""Significant digits of a computed number in a file."""

LOSS_FREE = N_("η = 1 where no efficiency is known: a lower bound")
LOWER_BOUND = N_("lower bound where η = 1")
"""Note on motor torques without an efficiency, in full and for a narrow place."""


_NO_XML = re.compile("[^\t\n\r\x20-\x7e\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Control characters and what else XML can't hold, and with it no workbook, no shell and no metadata of a PDF."""


@dataclass(frozen=True)
class Heading:
    """The title block: what people call a selection, who answers for it, and what is ordered."""

    title: str = ""
    reference: str = ""
    author: str = ""
    revision: str = ""
    ordering_code: str = ""

    def __post_init__(self) -> None:
        """Replace what no file can hold, in texts that anybody may have written."""
        for part in fields(self):
            shown = _NO_XML.sub("\N{REPLACEMENT CHARACTER}", getattr(self, part.name))
            object.__setattr__(self, part.name, shown)


@dataclass(frozen=True)
class Export:
    """An application, the selection for it, and what a reader needs to find both again.

    `link` is absolute. `created` is when the selection was saved, in a time zone; None for one that is not saved, whose
    files show the day of `made` instead, when they are made. `catalogue` gives the figures behind the selection; one of
    another version is not used, and the files say so. `reply` is a saved selection as it was saved, to the byte.
    `chosen` is the gear that somebody looks at instead of the foremost.
    """

    application: Application
    selection: Selection
    link: str
    heading: Heading = field(default_factory=Heading)
    created: datetime | None = None
    made: datetime | None = None
    catalogue: Catalogue | None = None
    reply: bytes = b""
    chosen: str = ""

    @property
    def candidate(self) -> Candidate:
        """The gear that was chosen to be looked at, else the selected one or the nearest miss."""
        return self.selection.candidate(self.chosen) or self.selection.foremost

    @cached_property
    def asked(self) -> list[Candidate]:
        """Candidates of the ratios and sizes that were asked for, beside which a chosen gear may stand."""
        ratios, sizes = self.application.requirements.ratios, self.application.requirements.sizes
        return [
            c for c in self.selection.candidates if c.ratio in (ratios or [c.ratio]) and c.size in (sizes or [c.size])
        ]

    @cached_property
    def equipped(self) -> Application:
        """The application with the figures of the motor that it names, as far as the catalogue is at hand."""
        return with_listed_motor(self.application, self.figures) if self.figures else self.application

    @cached_property
    def duty(self) -> Duty:
        """Duty of the application, as arrays for one."""
        return Duty.of([self.application])

    @cached_property
    def figures(self) -> Catalogue | None:
        """The catalogue of the selection's own version, or None where that is not at hand."""
        known = self.catalogue is not None and self.catalogue.version == self.selection.catalogue_version
        return self.catalogue if known else None

    def gear(self, candidate: Candidate) -> Gear | None:
        """Published figures of a candidate as they were, or None."""
        return self.figures.by_designation.get(candidate.designation) if self.figures else None

    def source(self, code: str) -> str:
        """Where the limit of a check on the reported gear comes from, as exactly as it is known."""
        gear, check = self.gear(self.candidate), BY_CODE.get(code)
        figure = check.limited_by if check else None
        exact = gear.sources.get(figure) if gear and figure else None
        return exact or self.selection.check_definitions[code].source

    def follows_efficiency_curve(self, candidate: Candidate) -> bool:
        """True for a candidate whose motor torques are by a curve of a supplement, phase by phase.

        A stated efficiency goes before any curve. Without the catalogue of the selection its figures tell, as far as
        they can: a curve that says nothing of any phase leaves no trace in them.
        """
        if self.application.requirements.efficiency is not None:
            return False
        if self.figures is not None:
            return candidate.designation in self.figures.efficiency
        if self.selection.turns_motor:
            return any(notice.code == "efficiency_supplied" for notice in self.selection.notices)
        shown = np.array([candidate.motor_peak_torque_Nm, candidate.motor_rated_torque_Nm], dtype=np.float64)
        output = np.array([self.duty.maximum_torque_Nm.item(), self.duty.rms_torque_Nm.item()])
        loss_free = equations.motor_torque(output_torque_Nm=output, ratio=candidate.ratio, efficiency=1.0)
        return bool((np.abs(shown - loss_free) > 1e-9 * loss_free).any())

    def is_lower_bound(self, candidate: Candidate) -> bool:
        """True for a candidate whose motor torques are loss-free: no efficiency is known."""
        return self.application.requirements.efficiency is None and not self.follows_efficiency_curve(candidate)

    @property
    def others(self) -> list[Candidate]:
        """Suitable gears beside the reported one, best first."""
        reported = self.candidate.designation
        return [c for c in self.selection.candidates if c.status == "suitable" and c.designation != reported]

    @property
    def misses(self) -> list[Candidate]:
        """Rejected gears beside the reported one that are worth a word: the nearest of those that are lighter, or the
        nearest of all where it fails itself.
        """
        if self.candidate.status == "suitable":
            gears = self.figures.by_designation if self.figures else {}
            lighter = lighter_miss(self.selection, self.candidate.designation, gears)
            return [lighter] if lighter else []
        rejected = [c for c in self.selection.candidates if c.status == "unsuitable" and c.is_judged]
        return [c for c in rejected if c.designation != self.candidate.designation][:2]


def made_by(maker: str, export: Export, *more: Any, **chosen: Any) -> bytes:
    """File that a function, named `module:function`, makes of an export: what only names it loads nothing for it."""
    make: Callable[..., bytes] = resolve_name(maker)
    return make(export, *more, **chosen)

"""Selection for a file: application and answer, never computed again."""

import re
from dataclasses import dataclass, field, fields
from datetime import datetime
from functools import cached_property

from hpn.account.account import Account
from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.candidates import Candidate
from hpn.engine.selection import Selection
from hpn.explain.comparison import lighter_miss
from hpn.words.wording import N_

DIGITS = 4
"""Significant digits of a computed number in a file."""

LOSS_FREE = N_("η = 1 where no efficiency is known: a lower bound")
LOWER_BOUND = N_("lower bound where η = 1")
"""Notes on motor torques without an efficiency: in full, and for a narrow place."""


_NO_XML = re.compile("[^\t\n\r\x20-\x7e\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML can't hold, control characters among them: workbook, shell and PDF metadata need XML."""


@dataclass(frozen=True)
class ExportTitle:
    """Title block: names of a selection, its author, and its ordering code."""

    title: str = ""
    reference: str = ""
    author: str = ""
    revision: str = ""
    ordering_code: str = ""

    def __post_init__(self) -> None:
        """Replace characters that no file can hold; the texts may come from anybody."""
        for part in fields(self):
            text = _NO_XML.sub("\N{REPLACEMENT CHARACTER}", getattr(self, part.name))
            object.__setattr__(self, part.name, text)


@dataclass(frozen=True)
class Export:
    """Application, its selection, and the data that lead a reader back to both.

    `link` is absolute. `created` is the moment of saving, in a time zone. For an unsaved selection it is None, and
    files show the day of `moment` instead, when they are made. `catalogue` has the figures behind the selection;
    a catalogue of another version is not used, and the files say so. `reply` is a saved selection byte for byte.
    `chosen` is the gear that the user looks at instead of the foremost one.
    """

    application: Application
    selection: Selection
    link: str
    heading: ExportTitle = field(default_factory=ExportTitle)
    created: datetime | None = None
    moment: datetime | None = None
    catalogue: Catalogue | None = None
    reply: bytes = b""
    chosen: str = ""

    @property
    def candidate(self) -> Candidate:
        """Gear that the user has chosen, else the selected one or the nearest miss."""
        return self.selection.candidate(self.chosen) or self.selection.foremost

    @cached_property
    def within_request(self) -> list[Candidate]:
        """Candidates of the requested ratios and sizes; a chosen gear may be another one."""
        ratios, sizes = self.application.requirements.ratios, self.application.requirements.sizes
        return [
            c for c in self.selection.candidates if c.ratio in (ratios or [c.ratio]) and c.size in (sizes or [c.size])
        ]

    @cached_property
    def account(self) -> Account:
        """Account of the reported gear."""
        return Account(self.selection, self.candidate, self.application, self.figures)

    @cached_property
    def figures(self) -> Catalogue | None:
        """Catalogue of the selection's own version, or None where it is not at hand."""
        known = self.catalogue is not None and self.catalogue.version == self.selection.catalogue_version
        return self.catalogue if known else None

    def gear(self, candidate: Candidate) -> Gear | None:
        """Published figures of a candidate in the selection's own catalogue, or None."""
        return self.figures.by_designation.get(candidate.designation) if self.figures else None

    @property
    def misses(self) -> list[Candidate]:
        """Rejected gears to name: beside a suitable gear the nearest lighter one, beside a failed gear the
        nearest two."""
        if self.candidate.status == "suitable":
            gears = self.figures.by_designation if self.figures else {}
            lighter = lighter_miss(self.selection, self.candidate.designation, gears)
            return [lighter] if lighter else []
        rejected = [c for c in self.selection.candidates if c.status == "unsuitable" and c.is_judged]
        return [c for c in rejected if c.designation != self.candidate.designation][:2]

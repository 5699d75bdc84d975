"""One selection as it leaves the service: what was asked and what was answered, never computed again."""

import re
from collections.abc import Callable
from dataclasses import dataclass, field, fields
from datetime import datetime
from functools import cached_property
from pkgutil import resolve_name
from typing import Any

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
"""Note on motor torques without an efficiency, in full and for a narrow place."""


_NO_XML = re.compile("[^\t\n\r\x20-\x7e\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Control characters and what else XML can't hold, and with it no workbook, no shell and no metadata of a PDF."""


@dataclass(frozen=True)
class ExportTitle:
    """The title block: what people call a selection, who answers for it, and what is ordered."""

    title: str = ""
    reference: str = ""
    author: str = ""
    revision: str = ""
    ordering_code: str = ""

    def __post_init__(self) -> None:
        """Replace what no file can hold, in texts that anybody may have written."""
        for part in fields(self):
            text = _NO_XML.sub("\N{REPLACEMENT CHARACTER}", getattr(self, part.name))
            object.__setattr__(self, part.name, text)


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
    heading: ExportTitle = field(default_factory=ExportTitle)
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
    def account(self) -> Account:
        """Account of the reported gear."""
        return Account(self.selection, self.candidate, self.application, self.figures)

    @cached_property
    def figures(self) -> Catalogue | None:
        """The catalogue of the selection's own version, or None where that is not at hand."""
        known = self.catalogue is not None and self.catalogue.version == self.selection.catalogue_version
        return self.catalogue if known else None

    def gear(self, candidate: Candidate) -> Gear | None:
        """Published figures of a candidate as they were, or None."""
        return self.figures.by_designation.get(candidate.designation) if self.figures else None

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


def made_by(maker: str, export: Any, *more: Any, **chosen: Any) -> bytes:
    """File that a function, named `module:function`, makes of an export: what only names it loads nothing for it."""
    make: Callable[..., bytes] = resolve_name(maker)
    return make(export, *more, **chosen)

"""Content of a page for a selection, computed just now or saved: the partials of the templates read it."""

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from hpn.account.account import Account
from hpn.account.over_tolerance import DecidingLine, OverTolerance, WorstLine, over_tolerance
from hpn.application import Application, RankBy
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.candidates import Candidate, WorstCase
from hpn.engine.checks import allowed
from hpn.engine.remedy import Alternative, Growth, condition_of, growths_of, remedy_of
from hpn.engine.room import with_tolerance
from hpn.engine.selection import Selection
from hpn.engine.tolerance_words import tolerance_of
from hpn.engine.tried import needed_of
from hpn.explain.comparison import lighter_miss
from hpn.explain.drawings import Pictures, Subject, cycle_picture
from hpn.explain.drawings.cycle import CyclePicture
from hpn.files.export import DIGITS
from hpn.links.writer import to_link
from hpn.web.door.visit import current
from hpn.web.pages.drive import DriveView
from hpn.web.pages.gear_map import GearMap, map_of
from hpn.words.quantities import LISTED
from hpn.words.reader import Reader
from hpn.words.wording import Named, Sentence


@dataclass(frozen=True, slots=True)
class RejectedSize:
    """The rejected gears of one size, nearest miss first."""

    size: str
    candidates: tuple[Candidate, ...]


@dataclass(frozen=True, slots=True)
class CandidateList:
    """The candidates as they are listed: suitable ones, then those that lack an input alone, rejected ones by size,
    nearest miss first, and the other unrated ones.

    `ties` are runs of suitable gears of one size that differ neither in what they are ranked by nor in weight and
    utilisation, so that L10 alone orders them.
    """

    suitable: tuple[Candidate, ...]
    lacking: tuple[Candidate, ...]
    rejected: tuple[RejectedSize, ...]
    unrated: tuple[Candidate, ...]
    ties: tuple[tuple[Candidate, ...], ...]

    @property
    def count(self) -> int:
        """Number of suitable gears."""
        return len(self.suitable)


@dataclass(frozen=True, kw_only=True)
class Result:
    """A selection, and the candidate that the page looks at; `asked` tells whether the reader chose it.

    `application` is None where it was saved by a version with other inputs. `catalogue` is the one that the selection
    was made from, None where that is not kept. `example` tells whether the application is the handbook's. `choosing`
    stands before the designation in the address of a saved selection that looks at another candidate, `tail` behind
    the live page's links: pins and labels. `links` makes the address of the same page with another application.
    """

    selection: Selection
    application: Application | None
    chosen: Candidate
    asked: bool
    catalogue: Catalogue | None
    choosing: str = ""
    tail: str = ""
    links: Callable[[Application], str] = to_link
    live: bool = False
    example: bool = False

    @property
    def gears(self) -> Mapping[str, Gear]:
        """Catalogue figures by designation, as far as they are known."""
        return self.catalogue.by_designation if self.catalogue else {}

    @property
    def names(self) -> Mapping[str, str]:
        """Checks by code, as they stand inside a sentence."""
        return {code: self.selection.name_of(code) for code in self.selection.check_definitions}

    @property
    def bounds(self) -> Mapping[str | None, float]:
        """Largest utilisation with which each check passes, by code; 1 where none governs."""
        return {code: allowed(code, self.utilisation) for code in (None, *self.selection.check_definitions)}

    @cached_property
    def account(self) -> Account:
        """Account of the chosen candidate."""
        return Account(self.selection, self.chosen, self.application, self.catalogue)

    @property
    def gear(self) -> Gear | None:
        """Catalogue figures of the chosen candidate."""
        return self.gears.get(self.chosen.designation)

    @cached_property
    def pictures(self) -> Pictures | None:
        """Pictures of the chosen candidate, or None where what they need is not kept."""
        if self.application is None or self.gear is None or self.catalogue is None:
            return None
        subject = Subject(self.application, self.gear, self.catalogue, self.chosen)
        return Pictures(subject, self.chosen, current())

    @cached_property
    def map(self) -> GearMap:
        """Map of the gears that were judged; empty where their catalogue is not kept."""
        candidates = {candidate.designation: candidate for candidate in self.selection.candidates}
        return map_of(self.selection, candidates, self.catalogue) if self.catalogue else ()

    @property
    def bearing_pictures(self) -> Pictures | None:
        """Those of the section on the output bearing."""
        return self.pictures

    @property
    def at_least(self) -> tuple[str, float] | None:
        """Check and utilisation of the chosen candidate as far as it is known, where its bearing lacks an input."""
        known = [
            (check.code, used)
            for check in self.chosen.checks
            if (used := check.at_least if check.utilisation is None else check.utilisation) is not None
        ]
        return max(known, key=lambda one: one[1] / self.bounds[one[0]]) if self.chosen.missing and known else None

    @cached_property
    def drive(self) -> DriveView | None:
        """Motor of the chosen candidate, or None where what it needs is not kept."""
        if self.application is None or self.gear is None or self.catalogue is None:
            return None
        return DriveView(self.application, self.gear, self.catalogue, self.selection, self.links)

    @property
    def tolerance(self) -> Sentence | None:
        """Sentence on the chosen gear over the whole tolerance; None without tolerances."""
        return tolerance_of(self.chosen)

    @cached_property
    def over(self) -> OverTolerance | None:
        """Account of the chosen gear over the tolerances; None without any."""
        return over_tolerance(self.account)

    @property
    def worst_used(self) -> float | None:
        """Utilisation of the chosen gear in its worst case; None without tolerances or a number."""
        return self.chosen.worst.utilisation if isinstance(self.chosen.worst, WorstCase) else None

    @property
    def worst_cycle(self) -> CyclePicture | None:
        """Typed cycle in the case in which the check that governs is worst, within its tolerances."""
        line = self.over.governing if self.over else None
        if (
            line is None
            or line.corner is None
            or self.gear is None
            or self.catalogue is None
            or self.application is None
        ):
            return None
        case = line.corner.application
        if case.duty_cycle.motion is not None:
            return None
        subject = Subject(case, self.gear, self.catalogue, line.corner.candidate)
        return cycle_picture(case, subject, current(), (), line.check.code, self.application)

    @property
    def failing_case(self) -> str:
        """Address of the case in which the chosen gear fails inside its tolerances; blank for none."""
        worst = self.chosen.worst
        if not isinstance(worst, WorstCase) or worst.status != "unsuitable" or not self.over:
            return ""
        line = self.over.governing
        return self.case(line) if line else ""

    def case(self, line: WorstLine) -> str:
        """Address of the case in which a check is worst, with the gear in sight, which others may outrank there."""
        return f"{self.links(line.corner.application)}&gear={self.chosen.designation}" if line.corner else ""

    def with_tolerance(self, line: DecidingLine) -> str:
        """Address with a tolerance by the factor that lets the gear hold."""
        assert self.application is not None
        return self.links(with_tolerance(self.application, line.given.path, line.allowed or 0.0))

    @property
    def other_judgement(self) -> str:
        """Address with gears judged by the worst case, or by the values as given where they are judged so."""
        assert self.application is not None
        requirements = self.application.requirements
        changed = requirements.model_copy(update={"over_tolerance": not requirements.over_tolerance})
        return self.links(self.application.model_copy(update={"requirements": changed}))

    @property
    def utilisation(self) -> float:
        """Largest utilisation that was accepted."""
        return self.application.requirements.utilisation if self.application else 1.0

    @property
    def rank_by(self) -> RankBy:
        """Order of the candidates."""
        return self.application.rank_by if self.application else "weight"

    @cached_property
    def lighter(self) -> Candidate | None:
        """The nearest miss that is lighter than the selected gear."""
        return lighter_miss(self.selection, self.selection.selected, self.gears)

    @cached_property
    def listed(self) -> CandidateList:
        """The candidates as they are listed."""
        by_status: dict[str, list[Candidate]] = {"suitable": [], "unsuitable": [], "unrated": []}
        for candidate in self.selection.candidates:
            by_status[candidate.status].append(candidate)
        suitable = tuple(by_status["suitable"])
        sizes: dict[str, list[Candidate]] = {}
        for candidate in by_status["unsuitable"]:
            sizes.setdefault(candidate.size, []).append(candidate)
        return CandidateList(
            suitable=suitable,
            rejected=tuple(RejectedSize(size, tuple(group)) for size, group in sizes.items()),
            lacking=tuple(candidate for candidate in by_status["unrated"] if candidate.missing),
            unrated=tuple(candidate for candidate in by_status["unrated"] if not candidate.missing),
            ties=_ties(suitable, self.rank_by),
        )

    def remedy(self, designation: str) -> Sentence | None:
        """Remedy that makes a candidate fit, as far as its catalogue figures are known."""
        candidate = self._judged(designation)
        return remedy_of(candidate, self.alternatives(designation)) if candidate else None

    def conditions(self, designation: str) -> tuple[Sentence, ...]:
        """Changes that each alone make a candidate fit, as far as its catalogue figures are known."""
        return tuple(map(condition_of, self.alternatives(designation)))

    def alternatives(self, designation: str) -> tuple[Alternative, ...]:
        """The same changes as figures."""
        if designation not in self._alternatives:
            candidate, alternatives = self._judged(designation), tuple[Alternative, ...]()
            if candidate and self.application and self.catalogue:
                alternatives = needed_of(candidate, self.application, self.catalogue)
            self._alternatives[designation] = alternatives
        return self._alternatives[designation]

    @cached_property
    def _alternatives(self) -> dict[str, tuple[Alternative, ...]]:
        """Alternatives that were worked out, by designation."""
        return {}

    def _judged(self, designation: str) -> Candidate | None:
        """A candidate with known catalogue figures; the chosen one may stand outside the ratios and sizes asked for."""
        chosen = self.chosen.designation == designation
        candidate = self.chosen if chosen else self.selection.candidate(designation)
        return candidate if designation in self.gears else None

    @property
    def columns(self) -> Mapping[str, Named]:
        """Figures of which the list of candidates has a column."""
        return {name: named for name, named in LISTED.items() if self.chosen.says(name)}

    @property
    def growths(self) -> Mapping[str, tuple[Growth, ...]]:
        """Growth of every driver of each check of the chosen candidate at which that check is at its limit."""
        return growths_of(self.chosen, self.utilisation)


@dataclass(frozen=True, slots=True)
class Preview:
    """Title and description that a chat shows for a link to a selection, in English."""

    title: str
    description: str


def preview_of(selection: Selection, title: str | None = None) -> Preview:
    """Gear and verdict of a selection, under the title that it was saved with."""
    best, duty, english = selection.foremost, selection.duty, Reader(digits=DIGITS)
    verdict = f"{selection.selected}, suitable" if selection.selected else "no suitable gear"
    parts = [
        f"Average torque {english.figure(duty.average_torque_Nm)} Nm",
        f"largest torque {english.figure(duty.maximum_torque_Nm)} Nm",
        f"average speed {english.figure(duty.average_output_speed_rpm)} rpm",
    ]
    if duty.load_inertia_kgm2 is not None:
        inertia = english.figure(duty.load_inertia_kgm2)
        parts.append(f"motion of {len(duty.phases)} load phases, load inertia {inertia} kg·m²")
    parts.append(f"{best.designation}: {best.reason.removesuffix('.')}")
    return Preview(f"{title or 'HPN Select'}: {verdict}", ", ".join(parts) + ".")


def _ties(suitable: Sequence[Candidate], rank_by: RankBy) -> tuple[tuple[Candidate, ...], ...]:
    if rank_by in ("life", "motor_torque"):
        return ()  # these differ from ratio to ratio
    runs = (tuple(run) for _, run in itertools.groupby(suitable, lambda c: (c.size, c.stages, c.utilisation)))
    return tuple(run for run in runs if len(run) > 1)

"""Content of a page for a live or saved selection; the partials of the templates read it."""

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
from hpn.engine.tried import needed_of, tried
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
    """Rejected gears of a size, nearest miss first."""

    size: str
    candidates: tuple[Candidate, ...]


@dataclass(frozen=True, slots=True)
class CandidateList:
    """Candidates in the order of the list: suitable ones, those that only lack an input, rejected ones by size with the
    nearest miss first, and the other unrated ones.

    `ties` are runs of suitable gears of one size with the same rank figure, weight and utilisation, so that only L10
    orders them.
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
    """Selection, and the candidate that the page shows; `is_chosen_gear` is True if the reader chose it.

    `application` is None if a version with other inputs saved it. `catalogue` is that of the selection, None if it is
    not kept. `example` is True for the handbook's application. `choosing` precedes the designation in the address of a
    saved selection that shows another candidate. `tail` (pins and labels) ends links to the live page. `links` makes
    the address of the same page with another application.
    """

    selection: Selection
    application: Application | None
    chosen: Candidate
    is_chosen_gear: bool
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
        """Names of checks by code, for use inside a sentence."""
        return {code: self.selection.name_of(code) for code in self.selection.check_definitions}

    @property
    def bounds(self) -> Mapping[str | None, float]:
        """Largest utilisation with which each check passes, by code; 1 for None, if no check governs."""
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
        """Pictures of the chosen candidate; None if application, gear or catalogue is not kept."""
        if self.application is None or self.gear is None or self.catalogue is None:
            return None
        subject = Subject(self.application, self.gear, self.catalogue, self.chosen)
        return Pictures(subject, self.chosen, current())

    @cached_property
    def map(self) -> GearMap:
        """Map of the judged gears; empty if their catalogue is not kept."""
        candidates = {candidate.designation: candidate for candidate in self.selection.candidates}
        return map_of(self.selection, candidates, self.catalogue) if self.catalogue else ()

    @property
    def bearing_pictures(self) -> Pictures | None:
        """Pictures of the section on the output bearing."""
        return self.pictures

    @property
    def at_least(self) -> tuple[str, float] | None:
        """Check and lower bound of the chosen candidate's utilisation, if its bearing lacks an input; else None."""
        known = [
            (check.code, used)
            for check in self.chosen.checks
            if (used := check.at_least if check.utilisation is None else check.utilisation) is not None
        ]
        return max(known, key=lambda one: one[1] / self.bounds[one[0]]) if self.chosen.missing and known else None

    @cached_property
    def drive(self) -> DriveView | None:
        """Motor of the chosen candidate; None if application, gear or catalogue is not kept."""
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
        """Typed phases within their tolerances, in the worst case of the governing check; None for a motion."""
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
        """Address of the case within the tolerances in which the chosen gear fails; blank without such a case."""
        worst = self.chosen.worst
        if not isinstance(worst, WorstCase) or worst.status != "unsuitable" or not self.over:
            return ""
        line = self.over.governing
        return self.case(line) if line else ""

    def case(self, line: WorstLine) -> str:
        """Address of a check's worst case; it names the gear, which others may outrank in that case."""
        return f"{self.links(line.corner.application)}&gear={self.chosen.designation}" if line.corner else ""

    def with_tolerance(self, line: DecidingLine) -> str:
        """Address with a tolerance scaled by the factor with which the gear holds."""
        assert self.application is not None
        return self.links(with_tolerance(self.application, line.tolerance.path, line.allowed or 0.0))

    @property
    def other_judgement(self) -> str:
        """Address with the other judgement of gears: by the worst case, or back by the given values."""
        assert self.application is not None
        requirements = self.application.requirements
        return self.links(self.application.requiring(over_tolerance=not requirements.over_tolerance))

    @property
    def utilisation(self) -> float:
        """Largest accepted utilisation."""
        return self.application.requirements.utilisation if self.application else 1.0

    @property
    def rank_by(self) -> RankBy:
        """Order of the candidates."""
        return self.application.rank_by if self.application else "weight"

    @cached_property
    def lighter(self) -> Candidate | None:
        """Nearest miss that is lighter than the selected gear."""
        return lighter_miss(self.selection, self.selection.selected, self.gears)

    @cached_property
    def listed(self) -> CandidateList:
        """Candidates in the order of the list."""
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
        """Remedy that makes a candidate fit; None if its catalogue figures are unknown."""
        candidate = self._judged(designation)
        return remedy_of(candidate, self.alternatives(designation)) if candidate else None

    def conditions(self, designation: str) -> tuple[Sentence, ...]:
        """Changes each of which makes a candidate fit; empty if its catalogue figures are unknown."""
        return tuple(map(condition_of, self.alternatives(designation)))

    def alternatives(self, designation: str) -> tuple[Alternative, ...]:
        """Figures of the changes each of which makes a candidate fit."""
        if designation not in self._alternatives:
            candidate, alternatives = self._judged(designation), tuple[Alternative, ...]()
            if candidate and self.application and self.catalogue:
                alternatives = needed_of(candidate, self.application, self.catalogue)
            self._alternatives[designation] = alternatives
        return self._alternatives[designation]

    def tries(self, designation: str) -> tuple[str, ...]:
        """Links that try the alternatives of a gear's remedy, one each; none without application or catalogue."""
        application, catalogue = self.application, self.catalogue
        if application is None or catalogue is None:
            return ()
        return tuple(self.links(tried(application, one, catalogue)) for one in self.alternatives(designation))

    @cached_property
    def _alternatives(self) -> dict[str, tuple[Alternative, ...]]:
        """Cache of alternatives by designation."""
        return {}

    def _judged(self, designation: str) -> Candidate | None:
        """Candidate with known catalogue figures; the chosen one may be outside the required ratios and sizes."""
        chosen = self.chosen.designation == designation
        candidate = self.chosen if chosen else self.selection.candidate(designation)
        return candidate if designation in self.gears else None

    @property
    def columns(self) -> Mapping[str, Named]:
        """Figures that have a column in the list of candidates."""
        return {name: named for name, named in LISTED.items() if self.chosen.says(name)}

    @property
    def growths(self) -> Mapping[str, tuple[Growth, ...]]:
        """Growth of each driver at which a check of the chosen candidate reaches its limit, by check."""
        return growths_of(self.chosen, self.utilisation)


@dataclass(frozen=True, slots=True)
class Preview:
    """Title and description of a link to a selection, which chats show; in English."""

    title: str
    description: str


def preview_of(selection: Selection, title: str | None = None) -> Preview:
    """Preview with gear and verdict of a selection, under its saved title if it has one."""
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

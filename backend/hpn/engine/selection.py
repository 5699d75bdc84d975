"""From an application and the catalogue to a ranked list of candidates, each with its checks and a reason.

A `Selection` is the reply: the API encodes it as JSON, pages and files read it, a saved reply decodes to it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from math import isfinite
from typing import Annotated, NamedTuple

import msgspec
from msgspec import UNSET, UnsetType
from pydantic import Field

from hpn import ENGINE_VERSION
from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.allowed import gears_for, gears_left_out, with_listed_motor
from hpn.engine.alone import Alone
from hpn.engine.candidates import Candidate, candidates_of
from hpn.engine.check import Group, Kind
from hpn.engine.checks import BY_CODE, name_of
from hpn.engine.duty import Duty
from hpn.engine.evaluation import SUITABLE, UNRATED, Evaluation, evaluate
from hpn.engine.notice import Notice
from hpn.engine.notices import ADDED_AT_MOTOR, notices_of
from hpn.engine.room import Room, room_of
from hpn.engine.tolerance import with_worst
from hpn.words.quantities import DUTY, PHASE
from hpn.words.reply import Reply, described


class PhaseFigures(Reply, frozen=True, omit_defaults=True):
    """A load phase that results from a motion, in the form of a typed phase."""

    __pydantic_config__ = described(PHASE)

    torque_Nm: float
    speed_rpm: float
    duration_s: float
    peak_torque_Nm: float
    peak_speed_rpm: float
    rms_torque_Nm: float
    least_torque_Nm: float | None = None
    radial_N: float | None = None
    axial_N: float | None = None
    name: str | None = None


class DutyFigures(Reply, frozen=True, omit_defaults=True):
    """Figures of the duty cycle; for a motion, with its phases and inertia."""

    __pydantic_config__ = described(DUTY)

    average_torque_Nm: float
    average_output_speed_rpm: float
    maximum_torque_Nm: float
    maximum_output_speed_rpm: float
    phases: Annotated[tuple[PhaseFigures, ...], Field(description="Load phases that result from the motion.")] = ()
    load_inertia_kgm2: Annotated[
        float | None, Field(description="Moment of inertia of the motion’s load at the gear’s output.")
    ] = None


class CheckDefinition(Reply, frozen=True):
    """Properties of a check that are the same for every candidate; `Check` explains the fields."""

    title: Annotated[str, Field(description="Name of the check.")]
    equation: Annotated[str | None, Field(description="Number of the handbook’s equation, if any.")]
    unit: Annotated[str, Field(description="Unit of demand and limit; empty for a pure number.")]
    kind: Annotated[Kind, Field(description="Kind of limit: maximum or minimum of the demand.")]
    group: Annotated[
        Group,
        Field(description="Load checks count in the candidate’s utilisation; property checks only where they fail."),
    ]
    limit_name: Annotated[str, Field(description="Symbol of the limit.")] = ""
    source: Annotated[str, Field(description="Source of the limit.")] = ""
    tests: Annotated[str, Field(description="Condition that is checked.")] = ""
    consequence: Annotated[str, Field(description="Consequence of exceeding the limit.")] = ""
    basis: Annotated[str, Field(description="Basis of the limit.")] = ""
    remedy: Annotated[str, Field(description="Suggested change.")] = ""


LINK = (
    "Address of the page that shows this application. The page opens up to 60,000 bytes: save a longer application and "
    "share the address of the saved selection."
)


class Selection(Reply, frozen=True):
    """The answer to one application. `link` is the address of the page that shows the application."""

    engine_version: Annotated[str, Field(description="Version of the calculation.")]
    catalogue_version: Annotated[str, Field(description="Hash of the catalogue’s content, supplement included.")]
    link: Annotated[str, Field(description=LINK)]
    duty: Annotated[DutyFigures, Field(description="The duty cycle’s own figures.")]
    selected: Annotated[str | None, Field(description="Designation of the first suitable candidate, or null.")]
    candidates: Annotated[tuple[Candidate, ...], Field(min_length=1, description="Every gear considered, best first.")]
    check_definitions: Annotated[dict[str, CheckDefinition], Field(description="Definitions by check code.")]
    notices: Annotated[tuple[Notice, ...], Field(description="Assumptions and remarks.")]
    tolerance: (
        Annotated[
            Room | None,
            Field(description="The selected gear over the tolerances, if given; null without a selected gear."),
        ]
        | UnsetType
    ) = UNSET

    @property
    def foremost(self) -> Candidate:
        """The selected gear, else the first one that is judged or only lacks an input, else the first."""
        return next((one for one in self.candidates if one.is_judged or one.missing), self.candidates[0])

    def name_of(self, code: str) -> str:
        """Name of a check inside a sentence; for a check of another version its title."""
        titled = code not in BY_CODE and code in self.check_definitions
        return self.check_definitions[code].title if titled else name_of(code)

    @property
    def adds_at_motor(self) -> bool:
        """True where inertia or no-load torque counts in all motor torques, according to a notice."""
        return any(notice.code in ADDED_AT_MOTOR for notice in self.notices)

    def candidate(self, designation: str) -> Candidate | None:
        """The candidate of a designation, or None."""
        return next((entry for entry in self.candidates if entry.designation == designation), None)


encode = msgspec.json.Encoder().encode
"""JSON of a selection; NaN (unpublished) and infinity (unlimited) become null."""


class Outcome(NamedTuple):
    """One line of a batch: the selected gear, its utilisation and governing check, and the number of suitable gears.

    `holds` and the worst case are those of the selected gear over the tolerances, UNSET without tolerances.
    """

    selected: str | None
    governing_check: str | None
    utilisation: float | None
    suitable: int
    holds: bool | UnsetType | None = UNSET
    worst_utilisation: float | UnsetType | None = UNSET
    worst_governing_check: str | UnsetType | None = UNSET


@dataclass(frozen=True, slots=True)
class Judgement:
    """An application on its gears: number `index` of an evaluation."""

    application: Application
    evaluation: Evaluation
    index: int = 0

    def outcome(self) -> Outcome:
        """Answer in brief."""
        evaluation, index = self.evaluation, self.index
        suitable = int((evaluation.verdict[index] == SUITABLE).sum())
        if not suitable:
            return Outcome(None, None, None, 0, *((None,) * 3 if self.application.tolerances else ()))
        best = evaluation.order.item(index, 0)
        check = evaluation.checks[evaluation.governing.item(index, best)]
        used = evaluation.utilisation.item(index, best)
        worst = self.worst_of(best) if self.application.tolerances else ()
        return Outcome(evaluation.gears.rows[best].designation, check.code, used, suitable, *worst)

    def worst_of(self, gear: int) -> tuple[bool | None, float | None, str | None]:
        """True where a gear holds over its whole tolerance, and its worst case; None without tolerances."""
        if self.evaluation.worst is None or not self.application.tolerances:
            return None, None, None
        judged, index = self.evaluation.worst.evaluation, self.index
        used, verdict = judged.utilisation.item(index, gear), judged.verdict.item(index, gear)
        code = None if verdict == UNRATED else judged.checks[judged.governing.item(index, gear)].code
        return verdict == SUITABLE, used if isfinite(used) else None, code

    def selection(
        self, link_of: Callable[[Application], str] | None = None, samples: int = 0, *, with_room: bool = True
    ) -> Selection:
        """The answer in full, with links from `link_of` and the failing share of `samples` points of the tolerances.

        The room over the tolerances takes longer than the rest, and may be left out.
        """
        evaluation, index = self.evaluation, self.index
        candidates = tuple(candidates_of(evaluation, index))
        checks = tuple(evaluation.checks[place].code for place in evaluation.places_of(index))
        return Selection(
            engine_version=ENGINE_VERSION,
            catalogue_version=evaluation.catalogue.version,
            link=link_of(self.application) if link_of else "",
            duty=_duty(self.application, evaluation, index),
            selected=candidates[0].designation if candidates[0].status == "suitable" else None,
            candidates=candidates,
            check_definitions=dict(_definitions(checks)),
            notices=notices_of(self.application, evaluation, index),
            tolerance=self._room(candidates[0], link_of or (lambda _: ""), samples) if with_room else UNSET,
        )

    def _room(self, first: Candidate, link_of: Callable[[Application], str], samples: int) -> Room | UnsetType | None:
        """Room of the selected gear over the tolerances; UNSET without tolerances, None without a selected gear."""
        if not self.application.tolerances:
            return UNSET
        if first.status != "suitable":
            return None
        catalogue = self.evaluation.catalogue
        gear = catalogue.by_designation[first.designation]
        return room_of(Alone.of(self.application, gear, catalogue), link_of, samples)

    def left_out(self) -> tuple[Candidate, ...]:
        """Candidates outside the requested ratios and sizes, judged alike and without rank.

        The application must be judged alone.
        """
        catalogue, duty = self.evaluation.catalogue, self.evaluation.case.duty
        gears = gears_left_out(self.evaluation.gears, catalogue)
        others = candidates_of(evaluate(duty, gears, catalogue), 0) if gears.rows else ()
        return tuple(msgspec.structs.replace(candidate, rank=None) for candidate in others)


def select(
    application: Application,
    catalogue: Catalogue,
    link_of: Callable[[Application], str] | None = None,
    samples: int = 0,
) -> Selection:
    """Evaluate and rank every gear that the application allows; the reply has links from `link_of`.

    Raises InputError for a ratio or size that the catalogue lacks, for a combination without a gear, and for the
    digitised bearing model without a candidate that has curve points.
    """
    return judge(application, catalogue).selection(link_of, samples)


def with_gear(selection: Selection, application: Application, catalogue: Catalogue, designation: str) -> Selection:
    """The selection, with a gear beyond its ratios and sizes added as the last candidate."""
    if not designation or selection.candidate(designation) is not None:
        return selection
    beyond = [each for each in judge(application, catalogue).left_out() if each.designation == designation]
    return msgspec.structs.replace(selection, candidates=(*selection.candidates, *beyond))


def judge(application: Application, catalogue: Catalogue) -> Judgement:
    """Evaluation of an application, from which the reply is made; raises as `select` does."""
    gears, equipped = gears_for(application, catalogue), with_listed_motor(application, catalogue)
    return Judgement(application, with_worst([application], evaluate(Duty.of([equipped]), gears, catalogue)))


def _duty(application: Application, evaluation: Evaluation, index: int) -> DutyFigures:
    figures = DutyFigures(*(getattr(evaluation.case.duty, name).item(index) for name in DUTY))
    motion = application.duty_cycle.motion
    if motion is None:
        return figures
    phases = tuple(PhaseFigures(**vars(phase)) for phase in motion.phases)
    return msgspec.structs.replace(figures, phases=phases, load_inertia_kgm2=motion.load_inertia_kgm2)


@lru_cache(maxsize=1024)
def _definitions(codes: tuple[str, ...]) -> dict[str, CheckDefinition]:
    names = CheckDefinition.__struct_fields__
    return {code: CheckDefinition(*(getattr(BY_CODE[code], name) for name in names)) for code in codes}

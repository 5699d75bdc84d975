"""From an application and the catalogue to a ranked list of candidates, each with its checks and a reason.

A `Selection` is the reply: what the API encodes as JSON, what pages and files read, what a saved reply decodes to.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice, repeat
from typing import Annotated, NamedTuple

import msgspec
import numpy as np
from pydantic import Field

from hpn import ENGINE_VERSION
from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.allowed import gears_for, gears_left_out, with_listed_motor
from hpn.engine.check import Check, Group, Kind
from hpn.engine.checks import BY_CODE, allowed
from hpn.engine.duty import Duty
from hpn.engine.evaluation import (
    CHECK_STATUS,
    STATUS,
    SUITABLE,
    UNRATED,
    CheckStatus,
    Evaluation,
    PlaceArray,
    Status,
    evaluate,
)
from hpn.engine.notices import Notice, notices_of
from hpn.engine.reserve import reserves
from hpn.physics.equations import FloatArray
from hpn.words.quantities import CANDIDATE, CHECK, DUTY, PHASE, RESERVE
from hpn.words.reply import Reply, described
from hpn.words.wording import N_, Quantity, Sentence, Value, telling_decimals


class CheckResult(Reply, frozen=True):
    """One check of one candidate."""

    __pydantic_config__ = described(CHECK)

    code: str
    demand: float | None
    limit: float | None
    utilisation: float | None
    status: CheckStatus


class Reserve(Reply, frozen=True):
    """Factors by which each driver may grow (above 1) or must shrink (below 1) on a candidate, the others as given."""

    __pydantic_config__ = described(RESERVE)

    torque_factor: float | None = None
    speed_factor: float | None = None
    load_factor: float | None = None
    emergency_stop_torque_Nm: float | None = None
    brake_torque_Nm: float | None = None
    brake_torque_repeated_Nm: float | None = None
    load_inertia_kgm2: float | None = None


class Candidate(Reply, frozen=True):
    """One gear, its verdict and why."""

    __pydantic_config__ = described(CANDIDATE)

    designation: str
    size: str
    ratio: int
    stages: int
    status: Status
    rank: int | None
    utilisation: float | None
    governing_check: str | None
    reason: str
    average_input_speed_rpm: float | None = None
    maximum_input_speed_rpm: float | None = None
    life_L10_h: float | None = None
    momentary_peak_count: float | None = None
    bearing_life_L50_h: float | None = None
    bearing_life_L10_h: float | None = None
    motor_peak_torque_Nm: float | None = None
    motor_rated_torque_Nm: float | None = None
    natural_frequency_Hz: float | None = None
    drive_resonance_Hz: float | None = None
    wind_up_arcmin: float | None = None
    position_error_arcmin: float | None = None
    position_error_mm: float | None = None
    stop_torque_Nm: float | None = None
    stopping_time_s: float | None = None
    stopping_angle_deg: float | None = None
    stopping_distance_mm: float | None = None
    stop_energy_J: float | None = None
    end_stop_speed_rpm: float | None = None
    motor_lock_speed_rpm: float | None = None
    reserve: Reserve = Reserve()
    checks: Annotated[tuple[CheckResult, ...], Field(min_length=1)] = ()

    def check(self, code: str) -> CheckResult | None:
        """The check of a code, or None where it was not asked for."""
        return next((check for check in self.checks if check.code == code), None)

    @property
    def failing(self) -> tuple[CheckResult, ...]:
        """The checks that fail."""
        return tuple(check for check in self.checks if check.status == "fail")

    @property
    def is_judged(self) -> bool:
        """True where every check could be judged; an unsuitable candidate may still have one that could not."""
        return all(check.status != "not_rated" for check in self.checks)

    def is_unlimited(self, figure: str) -> bool:
        """True where a figure is empty because nothing limits it, not for want of an input or of a rating.

        The candidate's status does not say: a gear that fails a check is unsuitable, rated or not.
        """
        asked, rated = _UNLIMITED_BY[figure]
        rating = self.check(rated)
        known = rating is not None and rating.status != "not_rated"
        return getattr(self, figure) is None and self.check(asked) is not None and known


_UNLIMITED_BY = {
    "life_L10_h": ("average_torque", "average_torque"),
    "momentary_peak_count": ("momentary_peak_torque", "repeated_peak_torque"),
    "bearing_life_L50_h": ("output_bearing_life", "output_bearing_life"),
}
"""Figures that may be unlimited: the check that is present where they are asked for, and the check that is rated where
the gear has the figure behind them."""


class PhaseFigures(Reply, frozen=True, omit_defaults=True):
    """A load phase that comes out of a motion, as one is typed."""

    __pydantic_config__ = described(PHASE)

    torque_Nm: float
    speed_rpm: float
    duration_s: float
    peak_torque_Nm: float
    peak_speed_rpm: float
    rms_torque_Nm: float
    radial_N: float | None = None
    axial_N: float | None = None
    name: str | None = None


class DutyFigures(Reply, frozen=True, omit_defaults=True):
    """Figures of the duty cycle; with phases and inertia for a motion."""

    __pydantic_config__ = described(DUTY)

    average_torque_Nm: float
    average_output_speed_rpm: float
    maximum_torque_Nm: float
    maximum_output_speed_rpm: float
    phases: Annotated[tuple[PhaseFigures, ...], Field(description="Load phases that the motion comes to.")] = ()
    load_inertia_kgm2: Annotated[
        float | None, Field(description="Moment of inertia of the motion’s load at the gear’s output.")
    ] = None


class CheckDefinition(Reply, frozen=True):
    """Properties of a check that are the same for every candidate; `Check` explains the fields."""

    title: Annotated[str, Field(description="Name of the check.")]
    equation: Annotated[str | None, Field(description="Number of the handbook’s equation, where it has one.")]
    unit: Annotated[str, Field(description="Unit of demand and limit; empty for a pure number.")]
    kind: Annotated[Kind, Field(description="Which way the limit bounds the demand.")]
    group: Annotated[
        Group,
        Field(description="Load checks count in the candidate’s utilisation; property checks only where they fail."),
    ]
    limit_name: Annotated[str, Field(description="Symbol of the limit.")] = ""
    source: Annotated[str, Field(description="Where the limit comes from.")] = ""
    tests: Annotated[str, Field(description="Condition that is checked.")] = ""
    consequence: Annotated[str, Field(description="Consequence of exceeding the limit.")] = ""
    basis: Annotated[str, Field(description="On which basis it stands.")] = ""
    remedy: Annotated[str, Field(description="Change that helps.")] = ""


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
    notices: Annotated[tuple[Notice, ...], Field(description="Assumptions and standings.")]

    @property
    def foremost(self) -> Candidate:
        """The selected gear, else the nearest miss among those that could be judged, if any could."""
        return next((candidate for candidate in self.candidates if candidate.is_judged), self.candidates[0])

    @property
    def turns_motor(self) -> bool:
        """Whether the motor's own inertia counts in its torques, which a notice says."""
        return any(notice.code in ("motor_inertia_included", "motor_all_included") for notice in self.notices)

    def candidate(self, designation: str) -> Candidate | None:
        """The candidate of a designation, or None."""
        return next((entry for entry in self.candidates if entry.designation == designation), None)


encode = msgspec.json.Encoder().encode
"""JSON of a selection; NaN and infinity, which stand for unpublished and unlimited, become null."""

decode = msgspec.json.Decoder(Selection).decode
"""Selection of JSON, also of JSON that an earlier version has saved; raises msgspec.MsgspecError for any other."""


class Outcome(NamedTuple):
    """One line of a batch: the selected gear, how close it is to its limits, and how many gears are suitable."""

    selected: str | None
    governing_check: str | None
    utilisation: float | None
    suitable: int


@dataclass(frozen=True, slots=True)
class Judged:
    """An application on its gears: number `index` of an evaluation."""

    application: Application
    evaluation: Evaluation
    index: int = 0

    def outcome(self) -> Outcome:
        """Answer in brief."""
        evaluation, index = self.evaluation, self.index
        suitable = int((evaluation.verdict[index] == SUITABLE).sum())
        if not suitable:
            return Outcome(None, None, None, 0)
        best = evaluation.order.item(index, 0)
        check = evaluation.checks[evaluation.governing.item(index, best)]
        used = evaluation.utilisation.item(index, best)
        return Outcome(evaluation.gears.rows[best].designation, check.code, used, suitable)

    def selection(self, link: str = "") -> Selection:
        """The answer in full."""
        evaluation, index = self.evaluation, self.index
        candidates = tuple(candidates_of(evaluation, index))
        checks = tuple(evaluation.checks[place].code for place in evaluation.asked_by(index))
        return Selection(
            engine_version=ENGINE_VERSION,
            catalogue_version=evaluation.catalogue.version,
            link=link,
            duty=_duty(self.application, evaluation, index),
            selected=candidates[0].designation if candidates[0].status == "suitable" else None,
            candidates=candidates,
            check_definitions=dict(_definitions(checks)),
            notices=notices_of(self.application, evaluation, index),
        )

    def left_out(self) -> tuple[Candidate, ...]:
        """Candidates that the ratios and sizes asked for leave out, judged alike and without rank.

        They are of an application that is judged alone.
        """
        catalogue, duty = self.evaluation.catalogue, self.evaluation.case.duty
        gears = gears_left_out(self.evaluation.gears, catalogue)
        found = candidates_of(evaluate(duty, gears, catalogue), 0) if gears.rows else ()
        return tuple(msgspec.structs.replace(candidate, rank=None) for candidate in found)


def select(application: Application, catalogue: Catalogue, link: str = "") -> Selection:
    """Evaluate every gear that the application allows, and rank them.

    Raises InputError for a ratio or size that the catalogue lacks, for a combination that leaves no gear, and for the
    digitised bearing model where no candidate has curve points.
    """
    return judge(application, catalogue).selection(link)


def judge(application: Application, catalogue: Catalogue) -> Judged:
    """Evaluation of an application before the reply is put together; raises as `select` does."""
    gears, equipped = gears_for(application, catalogue), with_listed_motor(application, catalogue)
    return Judged(application, evaluate(Duty.of([equipped]), gears, catalogue))


def _duty(application: Application, evaluation: Evaluation, index: int) -> DutyFigures:
    figures = DutyFigures(*(getattr(evaluation.case.duty, name).item(index) for name in DUTY))
    motion = application.duty_cycle.motion
    if motion is None:
        return figures
    phases = tuple(PhaseFigures(**vars(phase)) for phase in motion.phases)
    return msgspec.structs.replace(figures, phases=phases, load_inertia_kgm2=motion.load_inertia_kgm2)


# --- Candidates -------------------------------------------------------------------------------------------------------


def candidates_of(evaluation: Evaluation, index: int) -> Iterator[Candidate]:
    """Candidates of an application, best first."""
    order, asked = evaluation.order[index], evaluation.asked_by(index)
    codes = [check.code for check in evaluation.checks]
    u = evaluation.case.asked["requirements.utilisation"].item(index)
    figures = (getattr(evaluation.case.figures, name)[index] for name in FIGURES)
    tables = (evaluation.demand, evaluation.limit, evaluation.used)
    terms = (table[place, index] for place in asked for table in tables)
    columns = iter(
        _columns([evaluation.utilisation[index], *figures, *reserves(evaluation, index).values(), *terms], order)
    )
    used, values = next(columns), zip(*islice(columns, len(FIGURES)), strict=True)
    reserve = map(Reserve, *islice(columns, len(Reserve.__struct_fields__)))
    states = [map(CHECK_STATUS.__getitem__, row) for row in evaluation.status[asked, index][:, order].tolist()]
    checks = [
        map(CheckResult, repeat(codes[place]), next(columns), next(columns), next(columns), state)
        for place, state in zip(asked, states, strict=True)
    ]
    rows = zip(used, values, reserve, zip(*checks, strict=True), strict=True)
    verdicts, governs = evaluation.verdict[index].tolist(), evaluation.governing[index].tolist()
    for place, (gear, (utilisation, numbers, own_reserve, results)) in enumerate(
        zip(order.tolist(), rows, strict=True)
    ):
        verdict = verdicts[gear]
        governing = None if verdict == UNRATED else codes[governs[gear]]
        known = evaluation.gears.rows[gear]
        failed = sum(result.status == "fail" for result in results)
        yield Candidate(
            designation=known.designation,
            size=known.size,
            ratio=known.ratio,
            stages=known.stages,
            status=STATUS[verdict],
            rank=place + 1 if verdict == SUITABLE else None,
            utilisation=utilisation,
            governing_check=governing,
            reason=_reason(known.size, STATUS[verdict], utilisation, governing, failed, u),
            **dict(zip(FIGURES, numbers, strict=True)),
            reserve=own_reserve,
            checks=results,
        )


def _columns(values: Sequence[FloatArray], order: PlaceArray) -> list[list[float | None]]:
    """Values of the gears in an order, a list for each; None where one is not finite."""
    table = np.empty((len(values), len(order)))
    for place, column in enumerate(values):
        table[place] = column
    table = table[:, order]
    numbers = table.astype(object)
    numbers[~np.isfinite(table)] = None
    columns: list[list[float | None]] = numbers.tolist()
    return columns


FIGURES = (
    "average_input_speed_rpm",
    "maximum_input_speed_rpm",
    "life_L10_h",
    "momentary_peak_count",
    "bearing_life_L50_h",
    "bearing_life_L10_h",
    "motor_peak_torque_Nm",
    "motor_rated_torque_Nm",
    "natural_frequency_Hz",
    "drive_resonance_Hz",
    "wind_up_arcmin",
    "position_error_arcmin",
    "position_error_mm",
    "stop_torque_Nm",
    "stopping_time_s",
    "stopping_angle_deg",
    "stopping_distance_mm",
    "stop_energy_J",
    "end_stop_speed_rpm",
    "motor_lock_speed_rpm",
)
"""Figures of a candidate, in the order of its fields."""


@lru_cache(maxsize=1024)
def _definitions(codes: tuple[str, ...]) -> dict[str, CheckDefinition]:
    return {code: _definition(BY_CODE[code]) for code in codes}


def _definition(check: Check) -> CheckDefinition:
    return CheckDefinition(*(getattr(check, name) for name in CheckDefinition.__struct_fields__))


# --- Reasons ----------------------------------------------------------------------------------------------------------

REASONS = {
    "suitable": N_("Every check passes; the closest is {check} at {percent} of its limit."),
    "unsuitable": N_("{check} is at {percent} of its limit."),
    "unsuitable_more": N_("{check} is at {percent} of its limit; checks that fail: {failed}."),
    "never_stops": N_("The brake does not stop the load."),
    "no_stop_allowed": N_("T_k is too high: no emergency stop is permitted (eq. 17.9)."),
    "unrated": N_("Not rated: figures of {name} that the checks need are not in this catalogue’s source."),
}
"""Templates of the sentence on a candidate's rank."""


def reason_of(candidate: Candidate, utilisation: float) -> Sentence:
    """Sentence on a candidate's rank, for any language; `utilisation` is the user's u."""
    used, code, failed = candidate.utilisation, candidate.governing_check, len(candidate.failing)
    if used is None or code is None:
        return Sentence(REASONS[_key_without_number(candidate.status, code)], {"name": f"HPN-{candidate.size}"})
    percent = Quantity(_told_percent(used, code, utilisation), "percent", 12)
    values: dict[str, Value] = {"check": BY_CODE[code].title, "percent": percent, "failed": failed}
    return Sentence(REASONS[_key(candidate.status, failed)], values, ("check",))


def _reason(size: str, status: Status, used: float | None, code: str | None, failed: int, u: float) -> str:
    """The same sentence in English, as the API gives it, its number with every digit."""
    if used is None or code is None:
        return REASONS[_key_without_number(status, code)].format(name=f"HPN-{size}")
    percent = f"{_told_percent(used, code, u)!r} %"
    return REASONS[_key(status, failed)].format(check=BY_CODE[code].title, percent=percent, failed=failed)


def _key_without_number(status: Status, code: str | None) -> str:
    if status == "unrated":
        return "unrated"
    return "never_stops" if code == "momentary_peak_torque" else "no_stop_allowed"


def _key(status: Status, failed: int) -> str:
    return "unsuitable_more" if failed > 1 else status


def _told_percent(used: float, code: str, u: float) -> float:
    """Utilisation in percent, with enough decimals to tell it from the allowed one."""
    percent = 100 * used
    return round(percent, telling_decimals(percent, 100 * allowed(code, u), 1))

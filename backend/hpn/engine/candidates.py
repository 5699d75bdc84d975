"""Candidates: the gears of a reply, each with its figures, its checks and a reason."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import islice, repeat
from typing import Annotated, Literal

import msgspec
import numpy as np
from msgspec import UNSET, UnsetType
from pydantic import Field

from hpn.engine.checks import BY_CODE, allowed
from hpn.engine.evaluation import (
    CHECK_STATUS,
    STATUS,
    SUITABLE,
    UNRATED,
    CheckStatus,
    Evaluation,
    PlaceArray,
    Status,
    Worst,
)
from hpn.engine.reserve import reserves
from hpn.physics.equations import FloatArray
from hpn.words.quantities import CANDIDATE, CHECK, RESERVE
from hpn.words.reply import Reply, described
from hpn.words.wording import N_, Quantity, Sentence, Value, telling_decimals

LifeOf = Literal["gear_L10", "bearing_L50", "bearing_L10"]


class CheckResult(Reply, frozen=True):
    """One check of one candidate."""

    __pydantic_config__ = described(CHECK)

    code: str
    demand: float | None
    limit: float | None
    utilisation: float | None
    status: CheckStatus
    at_least: float | None = None
    worst: (
        Annotated[float | None, Field(description="Utilisation in the worst case of the tolerances.")] | UnsetType
    ) = UNSET
    exact: (
        Annotated[bool, Field(description="True: proved, nothing inside the tolerances is worse. False: sampled.")]
        | UnsetType
    ) = UNSET


class WorstCase(Reply, frozen=True):
    """Verdict on one gear in the worst case of the tolerances."""

    utilisation: Annotated[float | None, Field(description="Largest utilisation that counts.")]
    governing_check: Annotated[str | None, Field(description="Check with that utilisation.")]
    status: Annotated[Status, Field(description="Status by the worst cases of all checks.")]


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
    """One gear with its verdict and the reason."""

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
    missing: tuple[str, ...] = ()
    average_input_speed_rpm: float | None = None
    maximum_input_speed_rpm: float | None = None
    life_L10_h: float | None = None
    momentary_peak_count: float | None = None
    bearing_life_L50_h: float | None = None
    bearing_life_L10_h: float | None = None
    shortest_life_h: float | None = None
    shortest_life_of: LifeOf | None = None
    motor_peak_torque_Nm: float | None = None
    motor_rated_torque_Nm: float | None = None
    motor_thermal_torque_Nm: float | None = None
    motor_mean_speed_torque_Nm: float | None = None
    motor_torque_limit_Nm: float | None = None
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
    stop_radial_N: float | None = None
    end_stop_speed_rpm: float | None = None
    motor_lock_speed_rpm: float | None = None
    reserve: Reserve = Reserve()
    checks: Annotated[tuple[CheckResult, ...], Field(min_length=1)] = ()
    worst: Annotated[WorstCase, Field(description="Worst case of the tolerances, if given.")] | UnsetType = UNSET

    def says(self, figure: str) -> bool:
        """False for a figure unknown to the version of a saved answer; None then means unknown instead of no value."""
        return True

    def check(self, code: str) -> CheckResult | None:
        """The check of a code, or None if it was not asked for."""
        return next((check for check in self.checks if check.code == code), None)

    @property
    def failing(self) -> tuple[CheckResult, ...]:
        """The checks that fail."""
        return tuple(check for check in self.checks if check.status == "fail")

    @property
    def lacks_lever(self) -> bool:
        """True where the lever of the bearing's load is unknown: failing checks of the bearing are lower bounds."""
        life = self.check("output_bearing_life")
        unknown = self.bearing_life_L50_h is None and self.says("bearing_life_L50_h")
        return unknown and life is not None and life.status != "pass"

    @property
    def is_lower_bound(self) -> bool:
        """True where its utilisation is that of a bearing load with an unknown lever, which fails even without one."""
        return self.lacks_lever and self.governing_check in BEARING_CHECKS

    @property
    def is_judged(self) -> bool:
        """True where every check is rated; an unsuitable candidate may still have an unrated check."""
        return all(check.status != "not_rated" for check in self.checks) and not self.lacks_lever

    def is_unlimited(self, figure: str) -> bool:
        """True where a figure is empty because nothing limits it, rather than for want of an input or a rating.

        The candidate's status does not tell: a gear that fails a check is unsuitable, rated or not.
        """
        unlimited_by, rated = (self.check(code) for code in _UNLIMITED_BY.get(figure, ("", "")))
        known = rated is not None and rated.status != "not_rated"
        return self.says(figure) and getattr(self, figure) is None and unlimited_by is not None and known


_UNLIMITED_BY = {
    "life_L10_h": ("average_torque", "average_torque"),
    "momentary_peak_count": ("momentary_peak_torque", "repeated_peak_torque"),
    "bearing_life_L50_h": ("output_bearing_life", "output_bearing_life"),
    "bearing_life_L10_h": ("output_bearing_life", "output_bearing_life"),
}
"""Figures that may be unlimited: the check that is present if they are asked for, and the check that is rated if the
gear has the figure behind them.
"""

BEARING_CHECKS = ("output_bearing_load", "output_bearing_life")
"""Checks of the output bearing, without a closed form where a pinion or pulley loads the shaft."""

MISSING = ("output_load.shaft_centre_mm",)
"""Inputs that a gear may lack: for the bearing, where loads act off the shaft's centre."""

FIGURES = tuple(
    field.name for field in msgspec.structs.fields(Candidate) if field.type == float | None and not field.required
)
"""Figures of a candidate, in the order of its fields."""


def candidates_of(evaluation: Evaluation, index: int) -> Iterator[Candidate]:
    """Candidates of an application, best first."""
    order, places = evaluation.order[index], evaluation.places_of(index)
    codes = [check.code for check in evaluation.checks]
    u = evaluation.case.inputs["requirements.utilisation"].item(index)
    figures = (getattr(evaluation.case.figures, name)[index] for name in FIGURES)
    tables = (evaluation.demand, evaluation.limit, evaluation.nominal)
    terms = (table[place, index] for place in places for table in tables)
    columns = iter(
        _columns([evaluation.utilisation[index], *figures, *reserves(evaluation, index).values(), *terms], order)
    )
    used, values = next(columns), zip(*islice(columns, len(FIGURES)), strict=True)
    reserve = map(Reserve, *islice(columns, len(Reserve.__struct_fields__)))
    states = [map(CHECK_STATUS.__getitem__, row) for row in evaluation.status[places, index][:, order].tolist()]
    lacks, bounded = evaluation.lacks_input[index].tolist(), bool(np.isfinite(evaluation.at_least[:, index]).any())
    limits = np.select([lacks, evaluation.by_lower_bound[index]], ["missing", "at_least"], "").tolist()
    worst = evaluation.worst if evaluation.worst is not None and evaluation.worst.has_tolerances[index] else None
    checks = [
        map(
            CheckResult,
            repeat(codes[place]),
            next(columns),
            next(columns),
            next(columns),
            state,
            *(_columns([evaluation.at_least[place, index]], order) if bounded or worst else ()),
            *(_worst_of(worst, place, index, order) if worst else ()),
        )
        for place, state in zip(places, states, strict=True)
    ]
    cases: Iterable[WorstCase | UnsetType] = _worst_cases(worst, index, order) if worst else repeat(UNSET)
    rows = zip(used, values, reserve, zip(*checks, strict=True), strict=True)
    verdicts, governs = evaluation.verdict[index].tolist(), evaluation.governing[index].tolist()
    lives = evaluation.case.figures.shortest_life_of[index].tolist()
    for place, (gear, (utilisation, numbers, own_reserve, results), case) in enumerate(
        zip(order.tolist(), rows, cases, strict=False)
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
            reason=_reason(known.size, STATUS[verdict], utilisation, governing, failed, u, limits[gear]),
            missing=MISSING if lacks[gear] else (),
            **dict(zip(FIGURES, numbers, strict=True)),
            shortest_life_of=lives[gear] or None,
            reserve=own_reserve,
            checks=results,
            worst=case,
        )


def _worst_of(worst: Worst, place: int, index: int, order: PlaceArray) -> tuple[list[float | None], list[bool]]:
    """Worst utilisation of a check on the gears in an order, and True where it is proved."""
    return _columns([worst.evaluation.used[place, index]], order)[0], worst.exact[place, index, order].tolist()


def _worst_cases(worst: Worst, index: int, order: PlaceArray) -> list[WorstCase]:
    """Verdicts on the gears in an order by their worst cases."""
    judged = worst.evaluation
    (used,) = _columns([judged.utilisation[index]], order)
    verdicts, governs = judged.verdict[index, order].tolist(), judged.governing[index, order].tolist()
    codes = [
        None if verdict == UNRATED else judged.checks[at].code for verdict, at in zip(verdicts, governs, strict=True)
    ]
    return [WorstCase(each, code, STATUS[verdict]) for each, code, verdict in zip(used, codes, verdicts, strict=True)]


def _columns(values: Sequence[FloatArray], order: PlaceArray) -> list[list[float | None]]:
    """Values of the gears in an order, a list for each; None for a value that is not finite."""
    table = np.empty((len(values), len(order)))
    for place, column in enumerate(values):
        table[place] = column
    table = table[:, order]
    numbers = table.astype(object)
    numbers[~np.isfinite(table)] = None
    columns: list[list[float | None]] = numbers.tolist()
    return columns


# --- Reasons ----------------------------------------------------------------------------------------------------------

REASONS = {
    "suitable": N_("Every check passes; the closest is {check} at {percent} of its limit."),
    "unsuitable": N_("{check} is at {percent} of its limit."),
    "unsuitable_more": N_("{check} is at {percent} of its limit; checks that fail: {failed}."),
    "never_stops": N_("The brake does not stop the load."),
    "no_stop_allowed": N_("T_k is too high: no emergency stop is permitted (eq. 17.9)."),
    "missing": N_("Not rated: the output bearing needs the distance x_c of the shaft’s centre."),
    "at_least": N_(
        "{check} is at {percent} of its limit or more, wherever the shaft’s centre is; checks that fail: {failed}."
    ),
    "unrated": N_("Not rated: figures of {name} that the checks need are not in this catalogue’s source."),
}
"""Templates of the sentence on a candidate's rank."""


def reason_of(candidate: Candidate, utilisation: float) -> Sentence:
    """Sentence on a candidate's rank, for any language; `utilisation` is the user's u."""
    used, code, failed = candidate.utilisation, candidate.governing_check, len(candidate.failing)
    if used is None or code is None:
        key = _key_without_number(candidate.status, code, lacks=bool(candidate.missing))
        return Sentence(REASONS[key], {"name": f"HPN-{candidate.size}"})
    if code not in BY_CODE:  # a check of another version
        return Sentence("{text}", {"text": candidate.reason})
    percent = Quantity(_told_percent(used, code, utilisation), "percent", 12)
    values: dict[str, Value] = {"check": BY_CODE[code].title, "percent": percent, "failed": failed}
    key = "at_least" if candidate.is_lower_bound else _key(candidate.status, failed)
    return Sentence(REASONS[key], values, ("check",))


def _reason(size: str, status: Status, used: float | None, code: str | None, failed: int, u: float, limits: str) -> str:
    """Reason in English, as the API gives it, its number with every digit.

    `limits` is `missing` for a gear that lacks an input, `at_least` for one whose governing check is a lower bound.
    """
    if used is None or code is None:
        return REASONS[_key_without_number(status, code, lacks=limits == "missing")].format(name=f"HPN-{size}")
    percent = f"{_told_percent(used, code, u)!r} %"
    key = limits or _key(status, failed)
    return REASONS[key].format(check=BY_CODE[code].title, percent=percent, failed=failed)


def _key_without_number(status: Status, code: str | None, *, lacks: bool) -> str:
    if status == "unrated":
        return "missing" if lacks else "unrated"
    return "never_stops" if code == "momentary_peak_torque" else "no_stop_allowed"


def _key(status: Status, failed: int) -> str:
    return "unsuitable_more" if failed > 1 else status


def _told_percent(used: float, code: str, u: float) -> float:
    """Utilisation in percent, with enough decimals to differ from the allowed one."""
    percent = 100 * used
    return round(percent, telling_decimals(percent, 100 * allowed(code, u), 1))

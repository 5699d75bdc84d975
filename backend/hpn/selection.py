"""From an application and the catalogue to a ranked list of candidates, each with its checks and a reason."""

from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import orjson
from numpy.typing import NDArray

from hpn import ENGINE_VERSION
from hpn.application import Application, InputError
from hpn.bearing import L50_PER_L10
from hpn.catalogue import Catalogue, GearList
from hpn.checks import ABSENT, FAIL, NOT_RATED, STATUS, Evaluation, evaluate
from hpn.duty import Duty
from hpn.explanations import EXPLANATIONS
from hpn.gear import Gear
from hpn.notices import Notice, notices_of

SUITABLE, UNSUITABLE, UNRATED = range(3)
CANDIDATE_STATUS = ("suitable", "unsuitable", "unrated")
FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Ranking:
    """Verdict on G gears for one application, in catalogue order."""

    status: NDArray[np.int8]
    utilisation: FloatArray
    governing: NDArray[np.intp]
    order: NDArray[np.intp]

    @property
    def best(self) -> int | None:
        """Index of the selected gear, or None where none is suitable."""
        return int(self.order[0]) if self.status[self.order[0]] == SUITABLE else None


def rank(evaluation: Evaluation, index: int) -> Ranking:
    """Rank the gears for application `index`.

    Suitable gears come first by `rank_by`, then unsuitable ones by ascending utilisation, then unrated ones; ties fall
    to weight, utilisation, life and ratio, and last to the order of the catalogue.
    """
    case, status = evaluation.case, evaluation.status[:, index]
    utilisation = evaluation.utilisation[:, index]
    failed = status == FAIL
    counts = (evaluation.load_checks[:, 0] & (status != ABSENT)) | failed
    score = np.where(counts & (status != NOT_RATED), utilisation, -np.inf)
    governing = score.argmax(axis=0)
    verdict = np.where(
        failed.any(axis=0), UNSUITABLE, np.where((status == NOT_RATED).any(axis=0), UNRATED, SUITABLE)
    ).astype(np.int8)
    overall = np.where(verdict == UNRATED, np.nan, score.max(axis=0))
    g, life = case.gears.columns, case.life_L10_h[index]
    key = {
        "weight": g.weight_kg,
        "utilisation": overall,
        "length": g.length_max_mm,
        "motor_torque": case.motor_peak_torque_Nm[index],
        "life": -life,
        "stiffness": -g.torsional_stiffness_Nm_per_rad,
    }[case.duty.applications[index].rank_by]
    first = np.where(verdict == SUITABLE, key, np.where(verdict == UNSUITABLE, overall, 0.0))
    ties = np.array([g.ratio, -life, overall, g.weight_kg, first])
    ties[:, verdict == UNRATED] = 0.0
    ties[np.isnan(ties)] = np.inf  # not published comes last
    order = np.lexsort((*ties, verdict))
    return Ranking(verdict, overall, governing, order)


@dataclass(frozen=True, slots=True)
class Selection:
    """The answer to one application: duty, ranking, checks and notices; `json` is the reply of the API."""

    application: Application
    catalogue: Catalogue
    evaluation: Evaluation
    ranking: Ranking
    index: int = 0

    @property
    def gears(self) -> GearList:
        """The candidates in catalogue order."""
        return self.evaluation.case.gears

    @property
    def selected(self) -> str | None:
        """Designation of the selected gear, or None."""
        best = self.ranking.best
        return None if best is None else self.gears.rows[best].designation

    @property
    def notices(self) -> list[Notice]:
        """What the reader must know beyond the numbers."""
        return notices_of(self.evaluation, self.index)

    def json(self, link: str) -> bytes:
        """The reply of `POST /api/v1/select` as JSON; unlimited, infinite and unpublished values are null."""
        duty, index = self.evaluation.case.duty, self.index
        reply = {
            "engine_version": ENGINE_VERSION,
            "catalogue_version": self.catalogue.version,
            "link": link,
            "duty": {
                "average_torque_Nm": float(duty.average_torque_Nm[index, 0]),
                "average_output_speed_rpm": float(duty.average_output_speed_rpm[index, 0]),
                "maximum_torque_Nm": float(duty.maximum_torque_Nm[index, 0]),
                "maximum_output_speed_rpm": float(duty.maximum_output_speed_rpm[index, 0]),
            },
            "selected": self.selected,
            "candidates": self._candidates(),
            "check_definitions": check_definitions(self._codes()),
            "notices": [{"code": notice.code, "text": notice.text} for notice in self.notices],
        }
        return orjson.dumps(reply)

    def reply(self, link: str) -> dict[str, Any]:
        """The same as plain Python values."""
        reply: dict[str, Any] = orjson.loads(self.json(link))
        return reply

    def summary(self, link: str) -> dict[str, Any]:
        """One line of a batch: the selected gear, how close it is to its limits, and how many gears are suitable."""
        best, ranking = self.ranking.best, self.ranking
        return {
            "status": "ok",
            "selected": self.selected,
            "governing_check": None if best is None else self.evaluation.checks[ranking.governing[best]].code,
            "utilisation": None if best is None else float(ranking.utilisation[best]),
            "suitable": int((ranking.status == SUITABLE).sum()),
            "link": link,
        }

    def _codes(self) -> tuple[str, ...]:
        present = (self.evaluation.status[:, self.index] != ABSENT).all(axis=1)
        return tuple(check.code for check, here in zip(self.evaluation.checks, present, strict=True) if here)

    def _candidates(self) -> list[dict[str, Any]]:
        evaluation, ranking, index = self.evaluation, self.ranking, self.index
        case, gears = evaluation.case, self.gears.rows
        shape = (len(evaluation.checks), len(case.duty.applications), len(gears))
        table = np.empty((3, *shape))
        for check, (demand, limit) in enumerate(zip(evaluation.demand, evaluation.limit, strict=True)):
            table[0, check], table[1, check] = demand, limit
        table[2] = evaluation.utilisation
        rows = table[:, :, index].transpose(2, 1, 0).tolist()
        statuses = evaluation.status[:, index].T.tolist()
        codes = [check.code for check in evaluation.checks]
        derived = self._derived()
        suitable = int((ranking.status == SUITABLE).sum())
        verdicts, governing, overall = ranking.status.tolist(), ranking.governing.tolist(), ranking.utilisation.tolist()
        candidates = []
        for place, gear_index in enumerate(ranking.order.tolist()):
            gear, verdict, utilisation = gears[gear_index], verdicts[gear_index], overall[gear_index]
            check, states = governing[gear_index], statuses[gear_index]
            candidates.append(
                {
                    "designation": gear.designation,
                    "size": gear.size,
                    "ratio": gear.ratio,
                    "stages": gear.stages,
                    "status": CANDIDATE_STATUS[verdict],
                    "rank": place + 1 if place < suitable else None,
                    "utilisation": utilisation,
                    "governing_check": None if verdict == UNRATED else codes[check],
                    "reason": _reason(verdict, gear, codes[check], utilisation, states.count(FAIL)),
                    **derived[gear_index],
                    "checks": [
                        {"code": code, "demand": demand, "limit": limit, "utilisation": used, "status": STATUS[state]}
                        for code, (demand, limit, used), state in zip(codes, rows[gear_index], states, strict=True)
                        if state != ABSENT
                    ],
                }
            )
        return candidates

    def _derived(self) -> list[dict[str, float]]:
        """Derived quantities of every candidate, in catalogue order."""
        case = self.evaluation.case
        columns = {
            "average_input_speed_rpm": case.average_input_speed_rpm,
            "maximum_input_speed_rpm": case.maximum_input_speed_rpm,
            "life_L10_h": case.life_L10_h,
            "momentary_peak_count": case.momentary_peak_count,
            "bearing_life_L50_h": case.bearing.life_L50_h if case.bearing else None,
            "bearing_life_L10_h": case.bearing.life_L50_h / L50_PER_L10 if case.bearing else None,
            "motor_peak_torque_Nm": case.motor_peak_torque_Nm,
            "motor_rated_torque_Nm": case.motor_rated_torque_Nm,
        }
        empty = [None] * len(self.gears.rows)
        lists = [empty if column is None else column[self.index].tolist() for column in columns.values()]
        return [dict(zip(columns, values, strict=True)) for values in zip(*lists, strict=True)]


def select(application: Application, catalogue: Catalogue) -> Selection:
    """Evaluate every gear that the application allows, and rank them.

    Raises InputError for a ratio or size that the catalogue lacks, for a combination that leaves no gear, and for the
    digitised bearing model where no candidate has curve points.
    """
    gears = candidates_of(application, catalogue)
    evaluation = evaluate(Duty([application]), gears, catalogue)
    return Selection(application, catalogue, evaluation, rank(evaluation, 0))


def candidates_of(application: Application, catalogue: Catalogue) -> GearList:
    """Gears that `ratios` and `sizes` leave; raises InputError as `select` does."""
    sizes, ratios = application.requirements.sizes, application.requirements.ratios
    problems: list[tuple[tuple[str | int, ...], str]] = []
    for name, wanted, there in (("sizes", sizes, catalogue.sizes), ("ratios", ratios, catalogue.ratios)):
        listed = ", ".join(str(value) for value in there)
        problems += [
            (("requirements", name, index), f"the catalogue has no {value}; there are {listed}")
            for index, value in enumerate(wanted or ())
            if value not in there
        ]
    if problems:
        raise InputError(*problems)
    gears = catalogue.restricted(sizes, ratios)
    if not gears.rows:
        offered = "; ".join(
            f"{size}: {', '.join(str(gear.ratio) for gear in catalogue.gears if gear.size == size)}"
            for size in sizes or ()
        )
        raise InputError(
            (("requirements", "ratios"), f"no gear has such a size and ratio together; there are {offered}")
        )
    load = application.loads
    if load is not None and load.model == "digitised" and not any(gears.curves):
        raise InputError(
            (
                ("output_load", "model"),
                "no candidate has points of a printed curve: put them into bearing_envelopes.csv of a catalogue "
                "supplement (setting HPN_CATALOGUE_SUPPLEMENT), or choose linear or iso281",
            )
        )
    return gears


@lru_cache(maxsize=1024)
def check_definitions(codes: tuple[str, ...]) -> orjson.Fragment:
    """What is the same for every candidate, by check code, as JSON."""
    return orjson.Fragment(orjson.dumps({code: asdict(EXPLANATIONS[code]) for code in codes}))


REASONS = {
    "suitable": "Every check passes; the closest is {check} at {percent:.1f} % of its limit.",
    "unsuitable": "{check} is at {percent:.1f} % of its limit.",
    "unsuitable_more": "{check} is at {percent:.1f} % of its limit; checks that fail: {failed}.",
    "no_stop_allowed": "The emergency stop is so hard that not one is allowed (equation 17.9).",
    "unrated": "Not rated: figures that the checks need are not published.",
}
"""Why a candidate stands where it does; English msgids."""


def _reason(verdict: int, gear: Gear, check: str, utilisation: float, failed: int) -> str:
    if verdict == UNRATED:
        return gear.note or REASONS["unrated"]
    if utilisation == np.inf:
        return REASONS["no_stop_allowed"]
    key = "suitable" if verdict == SUITABLE else "unsuitable" if failed == 1 else "unsuitable_more"
    title = EXPLANATIONS[check].title
    return REASONS[key].format(check=title, percent=utilisation * 100, failed=failed)

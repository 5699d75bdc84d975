"""From an application and the catalogue to a ranked list of candidates, each with its checks and a reason."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from operator import itemgetter
from typing import Any

import numpy as np
from msgspec import Raw
from msgspec.json import decode
from numpy.typing import NDArray

from hpn import ENGINE_VERSION
from hpn.application import Application, InputError, Location
from hpn.bearing import L50_PER_L10
from hpn.catalogue import Catalogue, GearList
from hpn.checks import ABSENT, FAIL, NOT_RATED, PASS, STATUS, Evaluation, evaluate
from hpn.duty import Duty
from hpn.explanations import EXPLANATIONS
from hpn.notices import Notice, notices_of
from hpn.reply import CandidateRow, CheckRow, DutyRow, ReserveRow, SelectReply, encode
from hpn.reserve import reserve_of
from hpn.wording import N_, Sentence

SUITABLE, UNSUITABLE, UNRATED = range(3)
CANDIDATE_STATUS = ("suitable", "unsuitable", "unrated")
FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Ranking:
    """Verdicts on G gears for N applications in catalogue order, shape (N, G), and the order from best to last."""

    status: NDArray[np.int8]
    utilisation: FloatArray
    governing: NDArray[np.intp]
    order: NDArray[np.intp]


def rank(evaluation: Evaluation) -> Ranking:
    """Rank the gears for every application of an evaluation.

    Suitable gears come first by `rank_by`, then unsuitable ones by ascending utilisation, then unrated ones; ties fall
    to weight, utilisation, life and ratio, and last to the order of the catalogue. What is not published comes last.
    """
    case, status = evaluation.case, evaluation.status
    failed = status == FAIL
    counts = failed | (evaluation.load_checks & (status == PASS))
    score = np.where(counts, evaluation.utilisation, -np.inf)
    unknown = np.logical_or.reduce(status == NOT_RATED) * np.int8(UNRATED)
    verdict = np.where(np.logical_or.reduce(failed), np.int8(UNSUITABLE), unknown)
    unrated = verdict == UNRATED
    overall = np.where(unrated, np.nan, np.maximum.reduce(score))
    g = case.gears.columns
    keys = np.empty((6, *verdict.shape))  # the last key is the first to decide
    keys[0], keys[1], keys[2], keys[3] = g.ratio, -case.life_L10_h, overall, g.weight_kg
    keys[4] = np.where(verdict == SUITABLE, _rank_key(evaluation, overall), overall)
    np.copyto(keys[4], np.arange(verdict.shape[1]), where=unrated)
    keys[5] = verdict
    return Ranking(verdict, overall, score.argmax(axis=0), np.lexsort(keys))


def _rank_key(evaluation: Evaluation, overall: FloatArray) -> FloatArray:
    """What suitable gears are ordered by, ascending, shape (N, G) or (G,)."""
    case = evaluation.case
    g, wishes = case.gears.columns, [application.rank_by for application in case.duty.applications]
    keys: dict[str, Callable[[], FloatArray]] = {
        "weight": lambda: g.weight_kg,
        "utilisation": lambda: overall,
        "length": lambda: g.length_max_mm,
        "motor_torque": lambda: case.motor_peak_torque_Nm,
        "life": lambda: -case.life_L10_h,
        "stiffness": lambda: -g.torsional_stiffness_Nm_per_rad,
    }
    if len(set(wishes)) == 1:
        return keys[wishes[0]]()
    return np.array([np.broadcast_to(keys[wish](), overall.shape)[row] for row, wish in enumerate(wishes)])


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
    def best(self) -> int | None:
        """Index of the selected gear among the candidates, or None where none is suitable."""
        first = self.ranking.order.item(self.index, 0)
        return first if self.ranking.status[self.index, first] == SUITABLE else None

    @property
    def selected(self) -> str | None:
        """Designation of the selected gear, or None."""
        return None if (best := self.best) is None else self.gears.rows[best].designation

    @property
    def notices(self) -> list[Notice]:
        """What the reader must know beyond the numbers."""
        return notices_of(self.evaluation, self.index)

    def json(self, link: str) -> bytes:
        """The reply of `POST /api/v1/select` as JSON; unlimited, infinite and unpublished values are null."""
        duty, index = self.evaluation.case.duty, self.index
        return encode(
            SelectReply(
                engine_version=ENGINE_VERSION,
                catalogue_version=self.catalogue.version,
                link=link,
                duty=DutyRow(
                    duty.average_torque_Nm.item(index),
                    duty.average_output_speed_rpm.item(index),
                    duty.maximum_torque_Nm.item(index),
                    duty.maximum_output_speed_rpm.item(index),
                ),
                selected=self.selected,
                candidates=self._candidates(),
                check_definitions=check_definitions(self._codes()),
                notices=[{"code": notice.code, "text": notice.text} for notice in self.notices],
            )
        )

    def reply(self, link: str) -> dict[str, Any]:
        """The same as plain Python values."""
        reply: dict[str, Any] = decode(self.json(link))
        return reply

    def summary(self, link: str) -> dict[str, Any]:
        """One line of a batch: the selected gear, how close it is to its limits, and how many gears are suitable."""
        best, ranking, index = self.best, self.ranking, self.index
        return {
            "status": "ok",
            "selected": self.selected,
            "governing_check": None if best is None else self.evaluation.checks[ranking.governing[index, best]].code,
            "utilisation": None if best is None else ranking.utilisation.item(index, best),
            "suitable": int((ranking.status[index] == SUITABLE).sum()),
            "link": link,
        }

    def _codes(self) -> tuple[str, ...]:
        here = (self.evaluation.status[:, self.index, 0] != ABSENT).tolist()
        return tuple(check.code for check, present in zip(self.evaluation.checks, here, strict=True) if present)

    def _candidates(self) -> list[CandidateRow]:
        evaluation, ranking, index = self.evaluation, self.ranking, self.index
        order = ranking.order[index]
        in_order = itemgetter(*order.tolist(), -1)  # the last one twice, so that one gear gives a tuple as well
        codes = [check.code for check in evaluation.checks]
        verdicts = ranking.status[index][order].tolist()
        governing = [codes[place] for place in ranking.governing[index][order].tolist()]
        failed = np.add.reduce(evaluation.status[:, index] == FAIL)[order].tolist()
        utilisation = ranking.utilisation[index][order]
        suitable = verdicts.count(SUITABLE)
        names, sizes, ratios, stages = (in_order(column) for column in self.gears.names)
        *derived, torque, speed, load, stop = self._columns((*self._derived(), *self._reserve()), order)
        return list(
            map(
                CandidateRow,
                names,
                sizes,
                ratios,
                stages,
                [CANDIDATE_STATUS[verdict] for verdict in verdicts],
                [*range(1, suitable + 1), *[None] * (len(order) - suitable)],
                utilisation.tolist(),
                [None if v == UNRATED else code for v, code in zip(verdicts, governing, strict=True)],
                map(_reason, verdicts, sizes, governing, failed, np.round(100 * utilisation, 1).tolist()),
                *derived,
                map(ReserveRow, torque, speed, load, stop),
                self._checks(codes, order),
            )
        )

    def _checks(self, codes: list[str], order: NDArray[np.intp]) -> list[list[CheckRow]]:
        """Check rows of every candidate, best first."""
        evaluation, index = self.evaluation, self.index
        table = np.empty((3, len(codes), len(order)))
        for place, (demand, limit) in enumerate(zip(evaluation.demand, evaluation.limit, strict=True)):
            table[0, place] = demand if demand.shape[0] == 1 or demand.ndim == 1 else demand[index]
            table[1, place] = limit if limit.shape[0] == 1 or limit.ndim == 1 else limit[index]
        table[2] = evaluation.utilisation[:, index]
        states = evaluation.status[:, index].T[order].ravel().tolist()
        numbers = table.transpose(0, 2, 1)[:, order].reshape(3, -1).tolist()
        rows = list(map(CheckRow, codes * len(order), *numbers, [STATUS[state] for state in states]))
        size = len(codes)
        lists = [rows[start : start + size] for start in range(0, len(rows), size)]
        if ABSENT in states:
            lists = [[row for row in checks if row.status != STATUS[ABSENT]] for checks in lists]
        return lists

    def _columns(self, quantities: Sequence[FloatArray | None], order: NDArray[np.intp]) -> list[list[Any]]:
        """Quantities, shape (N, G) each, of every candidate, best first; None where there is no such thing."""
        given = [values[self.index] for values in quantities if values is not None]
        columns = iter(np.array(given)[:, order].tolist())
        return [[None] * len(order) if values is None else next(columns) for values in quantities]

    def _reserve(self) -> tuple[FloatArray | None, ...]:
        """Reserves in the order of the fields of ReserveRow."""
        reserve = reserve_of(self.evaluation)
        return reserve.torque, reserve.speed, reserve.load, reserve.emergency_stop_torque_Nm

    def _derived(self) -> tuple[FloatArray | None, ...]:
        """Derived quantities of every candidate, in the order of the fields of CandidateRow, shape (N, G) each."""
        case = self.evaluation.case
        return (
            case.average_input_speed_rpm,
            case.maximum_input_speed_rpm,
            case.life_L10_h,
            case.momentary_peak_count,
            case.bearing.life_L50_h if case.bearing else None,
            case.bearing.life_L50_h / L50_PER_L10 if case.bearing else None,
            case.motor_peak_torque_Nm,
            case.motor_rated_torque_Nm,
        )


def select(application: Application, catalogue: Catalogue) -> Selection:
    """Evaluate every gear that the application allows, and rank them.

    Raises InputError for a ratio or size that the catalogue lacks, for a combination that leaves no gear, and for the
    digitised bearing model where no candidate has curve points.
    """
    gears = candidates_of(application, catalogue)
    evaluation = evaluate(Duty([application]), gears, catalogue)
    return Selection(application, catalogue, evaluation, rank(evaluation))


NOT_THERE = N_("the catalogue has no {value}; there are {listed}")


def candidates_of(application: Application, catalogue: Catalogue) -> GearList:
    """Gears that `ratios` and `sizes` leave; raises InputError as `select` does."""
    sizes, ratios = application.requirements.sizes, application.requirements.ratios
    problems: list[tuple[Location, Sentence]] = []
    for name, wanted, there in (("sizes", sizes, catalogue.sizes), ("ratios", ratios, catalogue.ratios)):
        listed = ", ".join(str(value) for value in there)
        problems += [
            (("requirements", name, index), Sentence(NOT_THERE, {"value": str(value), "listed": listed}))
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
            (
                ("requirements", "ratios"),
                Sentence("no gear has such a size and ratio together; there are {offered}", {"offered": offered}),
            )
        )
    load = application.loads
    if load is not None and load.model == "digitised" and not any(gears.curves):
        raise InputError(
            (
                ("output_load", "model"),
                Sentence(
                    "no candidate has points of a printed curve: put them into bearing_envelopes.csv of a catalogue "
                    "supplement (setting HPN_CATALOGUE_SUPPLEMENT), or choose linear or iso281"
                ),
            )
        )
    return gears


@lru_cache(maxsize=1024)
def check_definitions(codes: tuple[str, ...]) -> Raw:
    """What is the same for every candidate, by check code, as JSON."""
    return Raw(encode({code: EXPLANATIONS[code] for code in codes}))


REASONS = {
    "suitable": N_("Every check passes; the closest is {check} at {percent} of its limit."),
    "unsuitable": N_("{check} is at {percent} of its limit."),
    "unsuitable_more": N_("{check} is at {percent} of its limit; checks that fail: {failed}."),
    "no_stop_allowed": N_("The emergency stop is so hard that not one is allowed (equation 17.9)."),
    "unrated": N_("Not rated: figures of {name} that the checks need are not published."),
}
"""Why a candidate stands where it does: templates of sentences."""


def _reason(verdict: int, size: str, check: str, failed: int, percent: float) -> str:
    if verdict == UNRATED:
        return REASONS["unrated"].format(name=f"HPN-{size}")
    return REASONS["no_stop_allowed"] if percent == np.inf else _reason_template(verdict, check, failed) % percent


@lru_cache(maxsize=1024)
def _reason_template(verdict: int, check: str, failed: int) -> str:
    """Reason with the place of the percentage left open: there are few of these, and many candidates."""
    key = "suitable" if verdict == SUITABLE else "unsuitable" if failed == 1 else "unsuitable_more"
    return REASONS[key].format(check=EXPLANATIONS[check].title, percent="%s %%", failed=failed)

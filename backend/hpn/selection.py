"""From an application and the catalogue to a ranked list of candidates, each with its checks and a reason."""

from dataclasses import dataclass
from functools import lru_cache
from operator import itemgetter
from typing import Any

import numpy as np
from msgspec import Raw
from msgspec.json import decode
from numpy.typing import NDArray

from hpn import ENGINE_VERSION
from hpn.application import Application, InputError
from hpn.bearing import L50_PER_L10
from hpn.catalogue import Catalogue, GearList
from hpn.checks import ABSENT, FAIL, NOT_RATED, STATUS, Evaluation, evaluate
from hpn.duty import Duty
from hpn.explanations import EXPLANATIONS
from hpn.notices import Notice, notices_of
from hpn.reply import CandidateRow, CheckRow, DutyRow, ReserveRow, SelectReply, encode
from hpn.reserve import reserve_of
from hpn.wording import N_

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
        here = (self.evaluation.status[:, self.index, 0] != ABSENT).tolist()
        return tuple(check.code for check, present in zip(self.evaluation.checks, here, strict=True) if present)

    def _candidates(self) -> list[CandidateRow]:
        ranking, index, order = self.ranking, self.index, self.ranking.order
        in_order = itemgetter(*order.tolist(), -1)  # the last one twice, so that one gear gives a tuple as well
        codes = [check.code for check in self.evaluation.checks]
        verdicts, governing = ranking.status[order].tolist(), ranking.governing[order].tolist()
        governing_codes = [codes[place] for place in governing]
        failed = (self.evaluation.status[:, index] == FAIL).sum(axis=0)[order].tolist()
        percent = np.round(100 * ranking.utilisation, 1)[order].tolist()
        suitable = verdicts.count(SUITABLE)
        empty = [None] * len(order)
        names, sizes, ratios, stages = (in_order(column) for column in self.gears.names)
        return list(
            map(
                CandidateRow,
                names,
                sizes,
                ratios,
                stages,
                [CANDIDATE_STATUS[verdict] for verdict in verdicts],
                [*range(1, suitable + 1), *empty[suitable:]],
                ranking.utilisation[order].tolist(),
                [None if v == UNRATED else code for v, code in zip(verdicts, governing_codes, strict=True)],
                map(_reason, verdicts, sizes, governing_codes, failed, percent),
                *(self._column(values) for values in self._derived()),
                map(ReserveRow, *(self._column(values) for values in self._reserve())),
                self._checks(codes),
            )
        )

    def _checks(self, codes: list[str]) -> list[list[CheckRow]]:
        """Check rows of every candidate, best first."""
        evaluation, index, order = self.evaluation, self.index, self.ranking.order
        table = np.empty((3, len(codes), len(order)))
        for place, (demand, limit) in enumerate(zip(evaluation.demand, evaluation.limit, strict=True)):
            table[0, place] = demand if demand.shape[0] == 1 or demand.ndim == 1 else demand[index]
            table[1, place] = limit if limit.shape[0] == 1 or limit.ndim == 1 else limit[index]
        table[2] = evaluation.utilisation[:, index]
        states = evaluation.status[:, index][:, order].T.ravel().tolist()
        numbers = table[:, :, order].transpose(0, 2, 1).reshape(3, -1).tolist()
        rows = list(map(CheckRow, codes * len(order), *numbers, [STATUS[state] for state in states]))
        size = len(codes)
        lists = [rows[start : start + size] for start in range(0, len(rows), size)]
        if ABSENT in states:
            lists = [[row for row in checks if row.status != STATUS[ABSENT]] for checks in lists]
        return lists

    def _column(self, values: FloatArray | None) -> list[float] | list[None]:
        """One quantity, shape (N, G), of every candidate, best first; None where the application has no such thing."""
        order = self.ranking.order
        return [None] * len(order) if values is None else values[self.index][order].tolist()

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
def check_definitions(codes: tuple[str, ...]) -> Raw:
    """What is the same for every candidate, by check code, as JSON."""
    return Raw(encode({code: EXPLANATIONS[code] for code in codes}))


REASONS = {
    "suitable": N_("Every check passes; the closest is %(check)s at %(percent)s %%%% of its limit."),
    "unsuitable": N_("%(check)s is at %(percent)s %%%% of its limit."),
    "unsuitable_more": N_("%(check)s is at %(percent)s %%%% of its limit; checks that fail: %(failed)s."),
    "no_stop_allowed": N_("The emergency stop is so hard that not one is allowed (equation 17.9)."),
    "unrated": N_("Not rated: figures of %(name)s that the checks need are not published."),
}
"""Why a candidate stands where it does; English msgids."""


def _reason(verdict: int, size: str, check: str, failed: int, percent: float) -> str:
    if verdict == UNRATED:
        return REASONS["unrated"] % {"name": f"HPN-{size}"}
    return REASONS["no_stop_allowed"] if percent == np.inf else _reason_template(verdict, check, failed) % percent


@lru_cache(maxsize=1024)
def _reason_template(verdict: int, check: str, failed: int) -> str:
    """Reason with the place of the percentage left open: there are few of these, and many candidates."""
    key = "suitable" if verdict == SUITABLE else "unsuitable" if failed == 1 else "unsuitable_more"
    return REASONS[key] % {"check": EXPLANATIONS[check].title, "percent": "%s", "failed": failed}

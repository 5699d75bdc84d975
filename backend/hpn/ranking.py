"""From checks to verdicts: which gears are suitable, how close each is to its limits, and their order."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hpn import checks as c
from hpn import duty as d
from hpn.checks import FAIL, LOAD_CHECKS, NOT_RATED, PASS, Evaluation, table_of
from hpn.compiled import compiled

FloatArray = NDArray[np.float64]
SUITABLE, UNSUITABLE, UNRATED = range(3)
CANDIDATE_STATUS = ("suitable", "unsuitable", "unrated")


@dataclass(slots=True)
class Ranking:
    """Verdicts on G gears for N applications in catalogue order, shape (N, G), and the order from best to last."""

    status: NDArray[np.int8]
    utilisation: FloatArray
    governing: NDArray[np.int8]
    order: NDArray[np.intp]


def rank(evaluation: Evaluation) -> Ranking:
    """Rank the gears for every application of an evaluation.

    Suitable gears come first by `rank_by`, then unsuitable ones by ascending utilisation, then unrated ones; ties fall
    to weight, utilisation, life and ratio, and last to the order of the catalogue. What is not published comes last.
    """
    shape = evaluation.status.shape[:2]
    ranking = Ranking(np.empty(shape, np.int8), np.empty(shape), np.empty(shape, np.int8), np.empty(shape, np.intp))
    _rank(
        evaluation.duty.wishes,
        table_of(evaluation.gears),
        evaluation.terms,
        evaluation.status,
        evaluation.figures,
        ranking.status,
        ranking.utilisation,
        ranking.governing,
        ranking.order,
    )
    return ranking


@compiled
def _rank(
    wishes: FloatArray,
    gears: FloatArray,
    terms: FloatArray,
    status: NDArray[np.int8],
    figures: FloatArray,
    verdicts: NDArray[np.int8],
    utilisation: FloatArray,
    governing: NDArray[np.int8],
    order: NDArray[np.intp],
) -> None:
    keys = np.empty((verdicts.shape[1], 6))  # the first decides first
    for n in range(verdicts.shape[0]):
        for g in range(verdicts.shape[1]):
            verdict, used, check = _verdict(terms, status, n, g)
            verdicts[n, g], utilisation[n, g], governing[n, g] = verdict, used, check
            keys[g, 0], keys[g, 1], keys[g, 2] = verdict, used, gears[g, c.MASS]
            keys[g, 3], keys[g, 4], keys[g, 5] = used, -figures[n, g, c.L10], gears[g, c.RATIO]
            if verdict == SUITABLE:
                keys[g, 1] = _wish(wishes[n, d.RANK_BY], gears, figures, n, g, used)
            elif verdict == UNRATED:
                keys[g, 1] = g
        for g in range(verdicts.shape[1]):  # a gear is put behind its equals, which keeps the catalogue's order
            first, last = 0, g
            while first < last:
                middle = (first + last) // 2
                if _comes_before(keys, g, order[n, middle]):
                    last = middle
                else:
                    first = middle + 1
            for place in range(g, first, -1):
                order[n, place] = order[n, place - 1]
            order[n, first] = g


@compiled
def _verdict(terms: FloatArray, status: NDArray[np.int8], n: int, g: int) -> tuple[int, float, int]:
    """Status of a candidate, the largest utilisation of its load checks and failing ones, and the check it is of."""
    verdict, largest, governing = SUITABLE, -math.inf, 0
    for check in range(status.shape[2]):
        state = status[n, g, check]
        if state == FAIL:
            verdict = UNSUITABLE
        elif state == NOT_RATED and verdict == SUITABLE:
            verdict = UNRATED
        counts = state == FAIL or (state == PASS and check < LOAD_CHECKS)
        if counts and terms[n, g, check, c.USED] > largest:
            largest, governing = terms[n, g, check, c.USED], check
    return verdict, math.nan if verdict == UNRATED else largest, governing


@compiled
def _wish(rank_by: float, gears: FloatArray, figures: FloatArray, n: int, g: int, used: float) -> Any:
    """What suitable gears are ordered by, ascending."""
    if rank_by == d.BY_UTILISATION:
        return used
    if rank_by == d.BY_LENGTH:
        return gears[g, c.LENGTH_MAX]
    if rank_by == d.BY_MOTOR_TORQUE:
        return figures[n, g, c.MOTOR_PEAK]
    if rank_by == d.BY_LIFE:
        return -figures[n, g, c.L10]
    if rank_by == d.BY_STIFFNESS:
        return -gears[g, c.K3]
    return gears[g, c.MASS]


@compiled
def _comes_before(keys: FloatArray, one: int, other: int) -> bool:
    for key in range(keys.shape[1]):
        a, b = keys[one, key], keys[other, key]
        if a < b or (math.isnan(b) and not math.isnan(a)):
            return True
        if b < a or (math.isnan(a) and not math.isnan(b)):
            return False
    return False

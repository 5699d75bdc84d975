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
    shape = evaluation.status.shape[1:]
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
            verdict, used, check = _verdict(terms[c.USED, :, n, g], status[:, n, g])
            verdicts[n, g], utilisation[n, g], governing[n, g] = verdict, used, check
            key = keys[g]
            key[0], key[1], key[2] = verdict, used, gears[c.MASS, g]
            key[3], key[4], key[5] = used, -figures[c.L10, n, g], gears[c.RATIO, g]
            if verdict == SUITABLE:
                key[1] = _wish(wishes[n, d.RANK_BY], gears[:, g], figures[:, n, g], used)
            elif verdict == UNRATED:
                key[1] = g
        for g in range(verdicts.shape[1]):  # a gear is put behind its equals, which keeps the catalogue's order
            first, last = 0, g
            while first < last:
                middle = (first + last) // 2
                if _comes_before(keys[g], keys[order[n, middle]]):
                    last = middle
                else:
                    first = middle + 1
            for place in range(g, first, -1):
                order[n, place] = order[n, place - 1]
            order[n, first] = g


@compiled
def _verdict(used: FloatArray, status: NDArray[np.int8]) -> tuple[int, float, int]:
    """Status of a candidate, the largest utilisation of its load checks and failing ones, and the check it is of."""
    verdict, largest, governing = SUITABLE, -math.inf, 0
    for check in range(status.size):
        if status[check] == FAIL:
            verdict = UNSUITABLE
        elif status[check] == NOT_RATED and verdict == SUITABLE:
            verdict = UNRATED
        counts = status[check] == FAIL or (status[check] == PASS and check < LOAD_CHECKS)
        if counts and used[check] > largest:
            largest, governing = used[check], check
    return verdict, math.nan if verdict == UNRATED else largest, governing


@compiled
def _wish(rank_by: float, gear: FloatArray, figures: FloatArray, used: float) -> Any:
    """What suitable gears are ordered by, ascending."""
    if rank_by == d.BY_UTILISATION:
        return used
    if rank_by == d.BY_LENGTH:
        return gear[c.LENGTH_MAX]
    if rank_by == d.BY_MOTOR_TORQUE:
        return figures[c.MOTOR_PEAK]
    if rank_by == d.BY_LIFE:
        return -figures[c.L10]
    if rank_by == d.BY_STIFFNESS:
        return -gear[c.K3]
    return gear[c.MASS]


@compiled
def _comes_before(one: FloatArray, other: FloatArray) -> bool:
    for key in range(one.size):
        if one[key] < other[key] or (math.isnan(other[key]) and not math.isnan(one[key])):
            return True
        if other[key] < one[key] or (math.isnan(one[key]) and not math.isnan(other[key])):
            return False
    return False

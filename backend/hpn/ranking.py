"""From checks to verdicts: which gears are suitable, how close each is to its limits, and their order."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hpn import checks as c
from hpn import duty as d
from hpn.catalogue import Catalogue, GearList
from hpn.checks import (
    FAIL,
    LOAD_CHECKS,
    NOT_RATED,
    PASS,
    ByteArray,
    Evaluation,
    FloatArray,
    along_curves,
    motor_torques,
    table_of,
)
from hpn.compiled import compiled
from hpn.duty import Duty

SUITABLE, UNSUITABLE, UNRATED = range(3)
CANDIDATE_STATUS = ("suitable", "unsuitable", "unrated")


def evaluate(duty: Duty, gears: GearList, catalogue: Catalogue) -> Evaluation:
    """Every check that the applications ask for on every gear, and what the gears come to, in one compiled pass.

    Suitable gears come first by `rank_by`, then unsuitable ones by ascending utilisation, then unrated ones; ties fall
    to weight, utilisation, life and ratio, and last to the order of the catalogue. What is not published comes last.
    """
    shape = (len(duty.applications), len(gears.rows))
    numbers, codes = np.empty((*shape, c.COUNT + c.FIGURES // 3, 3)), np.empty((*shape, c.COUNT + 2), np.int8)
    order, unlimited = np.empty(shape, np.intp), np.empty((shape[0], c.FIGURES), np.bool_)
    _evaluate(
        duty.phases,
        duty.wishes,
        duty.figures,
        table_of(gears),
        catalogue.references,
        along_curves(duty, gears),
        motor_torques(duty, gears, catalogue),
        numbers,
        codes,
        order,
        unlimited,
    )
    return Evaluation(duty, gears, catalogue, numbers, codes, order, unlimited)


@compiled
def _evaluate(
    phases: FloatArray,
    wishes: FloatArray,
    cycles: FloatArray,
    gears: FloatArray,
    series: tuple[float, float, float, float],
    curved_loads: FloatArray,
    curved_torques: FloatArray,
    numbers: FloatArray,
    codes: ByteArray,
    order: NDArray[np.intp],
    unlimited: NDArray[np.bool_],
) -> None:
    c.run_checks(phases, wishes, cycles, gears, series, curved_loads, curved_torques, numbers, codes, unlimited)
    _rank(wishes, gears, numbers, codes, order)


@compiled
def _rank(
    wishes: FloatArray,
    gears: FloatArray,
    numbers: FloatArray,
    codes: ByteArray,
    order: NDArray[np.intp],
) -> None:
    figures = numbers.reshape((*order.shape, 3 * numbers.shape[2]))[:, :, 3 * c.COUNT :]
    keys = np.empty((order.shape[1], 6))  # the first decides first
    for n in range(order.shape[0]):
        for g in range(order.shape[1]):
            verdict, used, check = _verdict(numbers, codes, n, g)
            codes[n, g, c.VERDICT], codes[n, g, c.GOVERNING] = verdict, check
            keys[g, 0], keys[g, 1], keys[g, 2] = verdict, used, gears[g, c.MASS]
            keys[g, 3], keys[g, 4], keys[g, 5] = used, -figures[n, g, c.L10], gears[g, c.RATIO]
            if verdict == SUITABLE:
                keys[g, 1] = _wish(wishes[n, d.RANK_BY], gears, figures, n, g, used)
            elif verdict == UNRATED:
                keys[g, 1] = g
        for g in range(order.shape[1]):  # a gear is put behind its equals, which keeps the catalogue's order
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
def _verdict(numbers: FloatArray, codes: ByteArray, n: int, g: int) -> tuple[int, float, int]:
    """Status of a candidate, the largest utilisation of its load checks and failing ones, and the check it is of."""
    verdict, largest, governing = SUITABLE, -math.inf, 0
    for check in range(c.COUNT):
        state = codes[n, g, check]
        if state == FAIL:
            verdict = UNSUITABLE
        elif state == NOT_RATED and verdict == SUITABLE:
            verdict = UNRATED
        counts = state == FAIL or (state == PASS and check < LOAD_CHECKS)
        if counts and numbers[n, g, check, c.USED] > largest:
            largest, governing = numbers[n, g, check, c.USED], check
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

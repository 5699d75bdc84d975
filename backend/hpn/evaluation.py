"""Every check of applications on gears, and from the checks to verdicts and the order of the candidates."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hpn.application import Application, RankBy
from hpn.catalogue import Catalogue, GearList
from hpn.check import Case, Check
from hpn.checks import CHECKS
from hpn.duty import Duty
from hpn.equations import ROUNDING, FloatArray
from hpn.figures import figures_of

BoolArray = NDArray[np.bool_]
PlaceArray = NDArray[np.intp]

CheckStatus = Literal["pass", "fail", "not_rated"]
PASS, FAIL, NOT_RATED = range(3)
CHECK_STATUS: tuple[CheckStatus, ...] = ("pass", "fail", "not_rated")

Status = Literal["suitable", "unsuitable", "unrated"]
SUITABLE, UNSUITABLE, UNRATED = range(3)
STATUS: tuple[Status, ...] = ("suitable", "unsuitable", "unrated")

RANKED_BY: Mapping[RankBy, Callable[[Case, FloatArray], FloatArray]] = {
    "weight": lambda case, used: case.gears.weight_kg,
    "utilisation": lambda case, used: used,
    "length": lambda case, used: case.gears.length_max_mm,
    "motor_torque": lambda case, used: case.figures.motor_peak_torque_Nm,
    "life": lambda case, used: -case.figures.life_L10_h,
    "stiffness": lambda case, used: -case.gears.torsional_stiffness_Nm_per_rad,
}
"""What suitable gears are ordered by, ascending; `used` is their utilisation."""


@dataclass(frozen=True)
class Checked:
    """A check of N applications on G gears; shape (N, G) each, but for `asked`, shape (N,).

    `utilisation` is NaN where it is not rated, infinite where the check fails without a number. What stands in the rows
    of applications that do not ask for the check has no meaning.
    """

    check: Check
    asked: BoolArray
    demand: FloatArray
    limit: FloatArray
    utilisation: FloatArray
    status: NDArray[np.int8]


@dataclass(frozen=True)
class Evaluation:
    """N applications on G gears.

    `verdict` (N, G) is a place in STATUS; `utilisation` (N, G) the largest that counts for a gear and `governing` the
    place of its check in `checked`; `order` (N, G) are the places of the gears from best to last.
    """

    case: Case
    gears: GearList
    catalogue: Catalogue
    checked: tuple[Checked, ...]
    verdict: NDArray[np.int8]
    utilisation: FloatArray
    governing: PlaceArray
    order: PlaceArray


def evaluate(applications: Sequence[Application], gears: GearList, catalogue: Catalogue) -> Evaluation:
    """Every check that the applications ask for on every gear, and how the gears stand."""
    duty = Duty.of(applications)
    case = Case(duty, gears.columns, figures_of(duty, gears, catalogue))
    shape = len(applications), len(gears.rows)
    with np.errstate(all="ignore"):  # NaN and infinity are answers
        checked = tuple(_checked(check, case, shape) for check in CHECKS if _is_asked(check, case).any())
    verdict, utilisation, governing = _verdicts(checked, shape)
    order = _order(case, verdict, utilisation)
    return Evaluation(case, gears, catalogue, checked, verdict, utilisation, governing, order)


def _is_asked(check: Check, case: Case) -> BoolArray:
    """Which applications ask for a check, shape (N, 1)."""
    if check.asked is None:
        return np.ones_like(case.duty.average_torque_Nm, dtype=np.bool_)
    return ~np.isnan(case.asked[check.asked])


def _checked(check: Check, case: Case, shape: tuple[int, int]) -> Checked:
    terms = np.empty((3, *shape))
    terms[0], terms[1], terms[2] = check.demand(case), check.limit(case), check.utilisation(case)
    bound = (case.asked["requirements.utilisation"] if check.group == "load" else 1.0) * (1 + ROUNDING)
    status = np.where(np.isnan(terms[2]), NOT_RATED, np.where(terms[2] <= bound, PASS, FAIL)).astype(np.int8)
    return Checked(check, _is_asked(check, case)[:, 0], terms[0], terms[1], terms[2], status)


def _verdicts(checked: Sequence[Checked], shape: tuple[int, int]) -> tuple[NDArray[np.int8], FloatArray, PlaceArray]:
    """Verdict on each gear, its utilisation and the check that governs; the utilisation of an unrated one is NaN.

    What counts is the utilisation of every failing check and of every load check that passes; of a tie, the first.
    """
    fails, open_ = np.zeros(shape, np.bool_), np.zeros(shape, np.bool_)
    largest, governing = np.full(shape, -np.inf), np.zeros(shape, np.intp)
    for place, one in enumerate(checked):
        asked = one.asked[:, None]
        fails |= asked & (one.status == FAIL)
        open_ |= asked & (one.status == NOT_RATED)
        counts = one.status == FAIL if one.check.group == "property" else one.status != NOT_RATED
        larger = asked & counts & (one.utilisation > largest)
        largest, governing = np.where(larger, one.utilisation, largest), np.where(larger, place, governing)
    verdict = np.where(fails, UNSUITABLE, np.where(open_, UNRATED, SUITABLE)).astype(np.int8)
    return verdict, np.where(verdict == UNRATED, np.nan, largest), governing


def _order(case: Case, verdict: NDArray[np.int8], used: FloatArray) -> PlaceArray:
    """Places of the gears from best to last, shape (N, G).

    Suitable gears come first by `rank_by`, then unsuitable ones by ascending utilisation, then unrated ones in the
    order of the catalogue. Ties fall to weight, utilisation, life and ratio, and last to the order of the catalogue;
    what is not published comes last, since numpy sorts NaN behind every number.
    """
    shape = verdict.shape
    wish = np.where(verdict == UNSUITABLE, used, np.arange(shape[1], dtype=np.float64))
    for rank_by, wished in RANKED_BY.items():
        wanted = (case.asked.rank_by == rank_by) & (verdict == SUITABLE)
        if wanted.any():
            wish = np.where(wanted, wished(case, used), wish)
    ties = (case.gears.weight_kg, used, -case.figures.life_L10_h, case.gears.ratio)
    keys = [np.broadcast_to(key, shape) for key in (verdict, wish, *ties)]
    return np.lexsort(keys[::-1], axis=-1)  # the last key decides first

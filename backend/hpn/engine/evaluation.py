"""Every check of applications on gears, and from the checks to verdicts and the order of the candidates."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hpn.application import RankBy
from hpn.catalogue import Catalogue, GearList
from hpn.engine.check import Case, Check, Values
from hpn.engine.checks import CHECKS
from hpn.engine.duty import Duty
from hpn.engine.figures import Figures
from hpn.physics.equations import ROUNDING, FloatArray, tied

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


@dataclass(frozen=True, eq=False)
class Checked:
    """A check of N applications on G gears; shape (N, G) each, but for `asked`, shape (N, 1).

    `utilisation` is NaN where it is not rated or not asked for, infinite where the check fails without a number; it
    passes up to `bound`, which broadcasts.
    """

    check: Check
    case: Case
    asked: BoolArray
    utilisation: FloatArray
    bound: FloatArray

    @cached_property
    def demand(self) -> FloatArray:
        """The value that is tested."""
        return self._spread(self.check.demand)

    @cached_property
    def limit(self) -> FloatArray:
        """Its bound."""
        return self._spread(self.check.limit)

    @cached_property
    def status(self) -> NDArray[np.int8]:
        """Places in CHECK_STATUS."""
        judged = np.where(self.utilisation <= self.bound, PASS, FAIL)
        return np.where(np.isnan(self.utilisation), NOT_RATED, judged).astype(np.int8)

    def _spread(self, values: Values) -> FloatArray:
        with np.errstate(all="ignore"):
            return np.broadcast_to(values(self.case), self.utilisation.shape)


@dataclass(frozen=True, eq=False)
class Evaluation:
    """N applications on G gears.

    `verdict` (N, G) is a place in STATUS; `utilisation` (N, G) the largest that counts for a gear, NaN for an unrated
    one: that of every failing check and of every load check that passes.
    """

    case: Case
    gears: GearList
    catalogue: Catalogue
    checked: tuple[Checked, ...]
    verdict: NDArray[np.int8]
    utilisation: FloatArray

    @cached_property
    def governing(self) -> PlaceArray:
        """Place in `checked` of the first check that reaches a gear's utilisation within ROUNDING, shape (N, G)."""
        return self.governing_of(np.broadcast_to(np.arange(self.verdict.shape[1]), self.verdict.shape))

    def governing_of(self, gears: PlaceArray) -> PlaceArray:
        """The same for some gears of each application, by their places (N, any number)."""
        used, place = np.take_along_axis(self.utilisation, gears, -1), np.zeros(gears.shape, np.intp)
        reached = used * (1 - ROUNDING)
        for index, one in reversed(tuple(enumerate(self.checked))):
            place[np.take_along_axis(_counted(one), gears, -1) >= reached] = index
        return place

    @cached_property
    def order(self) -> PlaceArray:
        """Places of the gears from best to last, shape (N, G).

        Suitable gears come first by `rank_by`, then unsuitable ones by ascending utilisation, then unrated ones in the
        order of the catalogue. Ties fall to weight, utilisation, life and ratio, and last to the order of the
        catalogue; what is not published comes last.
        """
        shape = self.verdict.shape
        places = np.arange(shape[1], dtype=np.float64)
        weight, used, life, ratio = (np.broadcast_to(key, shape) for key in self._ties)
        wish, used, life = tied(np.stack((np.broadcast_to(self._wish, shape), used, life)))
        wish = np.where(self.verdict == SUITABLE, wish, np.where(self.verdict == UNSUITABLE, used, places))
        return np.lexsort((ratio, life, used, weight, wish, self.verdict), axis=-1)  # the last key decides first

    def foremost(self, among: BoolArray) -> PlaceArray:
        """Place of the first gear by that order out of some of the suitable ones (N, G); any where there is none.

        A minimum over one key after the other, where what is not published is greater than every number: sorting takes
        ten times as long. NumPy finds the place of a minimum in a fifth of the time of its value.
        """
        left, decided = among, np.count_nonzero(among.any(axis=-1))
        for key in {id(key): key for key in (self._wish, *self._ties)}.values():
            if np.count_nonzero(left) == decided:
                break
            values = np.where(left & ~np.isnan(key), key, np.inf)
            least = np.take_along_axis(values, values.argmin(axis=-1, keepdims=True), -1)
            left = left & (values <= least * (1 + np.copysign(ROUNDING, least)))
        places: PlaceArray = left.argmax(axis=-1)  # of a tie in all of them the first in the catalogue
        return places

    @cached_property
    def _wish(self) -> FloatArray:
        """What suitable gears are ordered by, ascending."""
        rank_by = self.case.asked.rank_by
        wishes = {name: RANKED_BY[name](self.case, self.utilisation) for name in RANKED_BY if (rank_by == name).any()}
        if len(wishes) == 1:
            return next(iter(wishes.values()))
        return np.select([rank_by == name for name in wishes], list(wishes.values()))

    @property
    def _ties(self) -> tuple[FloatArray, ...]:
        gears = self.case.gears
        return gears.weight_kg, self.utilisation, -self.case.figures.life_L10_h, gears.ratio


def evaluate(duty: Duty, gears: GearList, catalogue: Catalogue) -> Evaluation:
    """Every check that the applications of a duty ask for on every gear, and how the gears stand."""
    case = Case(duty, gears.columns, Figures(duty, gears, catalogue))
    with np.errstate(all="ignore"):  # NaN and infinity are answers
        checked = tuple(_checked(case))
        verdict, utilisation = _verdicts(checked)
    return Evaluation(case, gears, catalogue, checked, verdict, utilisation)


def _checked(case: Case) -> Iterator[Checked]:
    shape = len(case.duty.average_torque_Nm), len(case.gears.ratio)
    u = case.asked["requirements.utilisation"]
    for check in CHECKS:
        asked = np.ones((shape[0], 1), np.bool_) if check.asked is None else ~np.isnan(case.asked[check.asked])
        if asked.any():
            bound = (u if check.group == "load" else np.ones((1, 1))) * (1 + ROUNDING)
            yield Checked(check, case, asked, np.broadcast_to(check.utilisation(case), shape), bound)


def _verdicts(checked: Sequence[Checked]) -> tuple[NDArray[np.int8], FloatArray]:
    """Verdict on each gear, and its utilisation; that of an unrated one is NaN.

    What counts of a property check is above 1, and so above u: one comparison with the bound of the load checks, of
    which the first is one, tells whether anything fails.
    """
    shape = checked[0].utilisation.shape
    largest, unrated = np.full(shape, -np.inf), np.zeros(shape, np.bool_)
    for one in checked:
        unrated |= np.isnan(one.utilisation) if one.asked.all() else one.asked & np.isnan(one.utilisation)
        np.fmax(largest, _counted(one), out=largest)
    fails = largest > checked[0].bound
    verdict = np.where(fails, np.int8(UNSUITABLE), np.where(unrated, np.int8(UNRATED), np.int8(SUITABLE)))
    return verdict, np.where(verdict == UNRATED, np.nan, largest)


def _counted(one: Checked) -> FloatArray:
    """Utilisation that counts for a gear: of a property check where it fails alone."""
    if one.check.group == "load":
        return one.utilisation
    return np.where(one.utilisation > one.bound, one.utilisation, np.nan)

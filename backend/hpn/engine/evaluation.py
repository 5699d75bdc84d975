"""Checks of applications on gears, the resulting verdicts, and the order of the candidates."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
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
    "life": lambda case, used: -case.figures.shortest_life_h,
    "stiffness": lambda case, used: -case.gears.torsional_stiffness_Nm_per_rad,
    "natural_frequency": lambda case, used: -case.figures.natural_frequency_Hz,
    "position_error": lambda case, used: case.figures.position_error_arcmin,
}
"""Keys for the order of suitable gears, ascending; `used` is their utilisation."""


@dataclass(frozen=True, eq=False)
class Evaluation:
    """N applications on G gears, by the C checks that at least one of them asks for.

    `applies` (C, N, 1). `used` (C, N, G) is the utilisation of each check, NaN where it is not rated or not asked for,
    infinite where the check fails without a number; it passes up to `bound` (C, N, 1). `verdict` (N, G) is a place in
    STATUS; `utilisation` (N, G) the largest of the load checks and of the property checks that fail, NaN for an unrated
    gear. `worst` are the worst cases where an application has tolerances.
    """

    case: Case
    gears: GearList
    catalogue: Catalogue
    checks: tuple[Check, ...]
    applies: BoolArray
    used: FloatArray
    bound: FloatArray
    verdict: NDArray[np.int8]
    utilisation: FloatArray
    worst: "Worst | None" = None

    @property
    def nominal(self) -> FloatArray:
        """Utilisations of the applications as given, shape (C, N, G), even if worst cases judge the gears."""
        return self.used if self.worst is None else self.worst.nominal

    def places_of(self, index: int) -> list[int]:
        """Places in `checks` of the checks of application `index`."""
        places: list[int] = np.flatnonzero(self.applies[:, index, 0]).tolist()
        return places

    @cached_property
    def demand(self) -> FloatArray:
        """Values that the checks test, shape (C, N, G)."""
        return self._table(check.demand for check in self.checks)

    @cached_property
    def limit(self) -> FloatArray:
        """Limits of these values, shape (C, N, G)."""
        return self._table(check.limit_of for check in self.checks)

    def _table(self, columns: Iterable[Values]) -> FloatArray:
        table = np.empty(self.used.shape)
        with np.errstate(all="ignore"):
            for place, values in enumerate(columns):
                table[place] = values(self.case)
        return table

    @cached_property
    def status(self) -> NDArray[np.int8]:
        """Places in CHECK_STATUS, shape (C, N, G)."""
        judged = np.where(self.used <= self.bound, np.int8(PASS), np.int8(FAIL))
        return np.where(np.isnan(self.used), np.int8(NOT_RATED), judged)

    @cached_property
    def at_least(self) -> FloatArray:
        """Lower bounds of utilisations that lack an input, NaN elsewhere; shape (C, N, G)."""
        table = np.full(self.used.shape, np.nan)
        with np.errstate(all="ignore"):
            for place, check in enumerate(self.checks):
                if check.at_least:
                    table[place] = np.where(np.isnan(self.used[place]), check.at_least(self.case), np.nan)
        return table

    @cached_property
    def lacks_input(self) -> BoolArray:
        """True for an unrated gear that only lacks inputs: everything unrated has a lower bound, shape (N, G)."""
        if not any(check.at_least for check in self.checks):
            return np.zeros(self.verdict.shape, np.bool_)
        unknown = np.isnan(self.used) & self.applies & np.isnan(self.at_least)
        return np.array((self.verdict == UNRATED) & ~unknown.any(axis=0))

    @cached_property
    def is_judged(self) -> BoolArray:
        """True where every requested check is rated, and none by a lower bound only, shape (N, G)."""
        bounded = np.isfinite(self.case.figures.bearing_loads_at_least[0])
        return np.array(~(self.applies & np.isnan(self.used)).any(axis=0) & ~bounded)

    @cached_property
    def by_lower_bound(self) -> BoolArray:
        """True where the governing check of an unsuitable gear fails by a lower bound, shape (N, G)."""
        largest, mean = self.case.figures.bearing_loads_at_least
        of_bearing = np.array([check.at_least is not None for check in self.checks])[self.governing]
        return np.array((self.verdict == UNSUITABLE) & of_bearing & np.isfinite(largest) & np.isfinite(mean))

    @cached_property
    def governing(self) -> PlaceArray:
        """Place in `checks` of the governing check, the first to reach the gear's utilisation within ROUNDING, shape
        (N, G).
        """
        return self._first_that_reaches(self.utilisation, self.used, self.bound)

    def governing_of(self, gears: PlaceArray) -> PlaceArray:
        """Place in `checks` of the governing check for one gear of each application, given by its place, shape (N,)."""
        rows = np.arange(len(gears))
        return self._first_that_reaches(self.utilisation[rows, gears], self.used[:, rows, gears], self.bound[..., 0])

    def _first_that_reaches(self, utilisation: FloatArray, used: FloatArray, bound: FloatArray) -> PlaceArray:
        loads = _load_checks(self.checks)
        reached = used >= utilisation * (1 - ROUNDING)
        reached[loads:] &= used[loads:] > bound[loads:]
        places: PlaceArray = reached.argmax(axis=0)
        return places

    @cached_property
    def order(self) -> PlaceArray:
        """Places of the gears from best to last, shape (N, G).

        Suitable gears come first by `rank_by`, then gears that only lack an input by their known utilisations, then
        unsuitable ones by ascending utilisation, then the other unrated ones in the order of the catalogue. Ties fall
        to weight, utilisation, life and ratio, last to the order of the catalogue; unpublished figures come last.
        """
        keys = np.empty((5, *self.verdict.shape))
        weight, used, life, ratio = self._ties
        for place, key in enumerate((self._wish, used, life, weight, ratio)):
            keys[place] = key
        keys[:3] = tied(keys[:3])  # weights and ratios are published figures, without rounding
        wish, used, life, weight, ratio = keys
        rejected = np.where(self.verdict == UNSUITABLE, used, np.arange(used.shape[1]))
        wish, group = np.where(self.verdict == SUITABLE, wish, rejected), self.verdict
        if self.lacks_input.any():
            judged = np.fmax.reduce(np.where(np.isinf(self.used), np.nan, np.fmax(self.used, self.at_least)), axis=0)
            wish = np.where(self.lacks_input, tied(judged[None])[0], wish)
            group = np.where(self.lacks_input, (SUITABLE + UNSUITABLE) / 2, group)
        return np.lexsort((ratio, life, used, weight, wish, group), axis=-1)  # the last key decides first

    def foremost(self, among: BoolArray) -> PlaceArray:
        """Place of the first gear in this order among some suitable ones (N, G); arbitrary without a suitable one.

        A minimum over one key after the other, with unpublished figures as the greatest: sorting takes ten times as
        long. NumPy finds the place of a minimum in a fifth of the time of its value.
        """
        left, decided = among, np.count_nonzero(among.any(axis=-1))
        for key in {id(key): key for key in (self._wish, *self._ties)}.values():
            if np.count_nonzero(left) == decided:
                break
            values = np.where(left & ~np.isnan(key), key, np.inf)
            least = np.take_along_axis(values, values.argmin(axis=-1, keepdims=True), -1)
            left = left & (values <= least * (1 + np.copysign(ROUNDING, least)))
        places: PlaceArray = left.argmax(axis=-1)  # the first in the catalogue if all keys tie
        return places

    @cached_property
    def _wish(self) -> FloatArray:
        """Key for the order of suitable gears, ascending."""
        rank_by = self.case.inputs.rank_by
        wishes = {name: RANKED_BY[name](self.case, self.utilisation) for name in RANKED_BY if (rank_by == name).any()}
        if len(wishes) == 1:
            return next(iter(wishes.values()))
        return np.select([rank_by == name for name in wishes], list(wishes.values()))

    @property
    def _ties(self) -> tuple[FloatArray, ...]:
        gears = self.case.gears
        return gears.weight_kg, self.utilisation, -self.case.figures.life_L10_h, gears.ratio


@dataclass(frozen=True, eq=False)
class Worst:
    """Worst cases of N applications over their tolerances, in the form of an evaluation.

    `exact` (C, N, G) is True for proved checks, `has_tolerances` (N,) for applications with tolerances; the others stay
    as they are. `nominal` (C, N, G) are the utilisations of the values as typed.
    """

    evaluation: Evaluation
    exact: BoolArray
    has_tolerances: BoolArray
    nominal: FloatArray


def judged_by(evaluation: Evaluation, used: FloatArray, bound: FloatArray) -> Evaluation:
    """The evaluation with other utilisations and bounds of its checks."""
    with np.errstate(all="ignore"):
        verdict, utilisation = _verdicts(evaluation.applies, used, bound, _load_checks(evaluation.checks))
    return replace(evaluation, used=used, bound=bound, verdict=verdict, utilisation=utilisation)


def evaluate(duty: Duty, gears: GearList, catalogue: Catalogue) -> Evaluation:
    """Evaluation of every check that an application of a duty asks for, on every gear."""
    case = Case(duty, gears.columns, Figures(duty, gears, catalogue))
    checks, mask = _checks_of(case)
    used = np.empty((*mask.shape[:2], len(gears.rows)))
    bound = np.ones((*mask.shape[:2], 1))
    loads = _load_checks(checks)
    bound[:loads] = case.inputs["requirements.utilisation"]
    bound *= 1 + ROUNDING
    with np.errstate(all="ignore"):  # NaN and infinity are answers
        for place, check in enumerate(checks):
            used[place] = check.utilisation(case)
        verdict, utilisation = _verdicts(mask, used, bound, loads)
    return Evaluation(case, gears, catalogue, checks, mask, used, bound, verdict, utilisation)


def _load_checks(checks: Iterable[Check]) -> int:
    """Number of load checks, which precede the property checks."""
    return sum(check.group == "load" for check in checks)


def _checks_of(case: Case) -> tuple[tuple[Check, ...], BoolArray]:
    """Checks that at least one application asks for, and True for the applications that do, shape (C, N, 1)."""
    always = np.zeros((len(case.duty.average_torque_Nm), 1))
    inputs = [case.inputs[check.trigger] if check.trigger else always for check in CHECKS]
    mask = ~np.isnan(np.concatenate(np.broadcast_arrays(*inputs), axis=1)).T
    for place, check in enumerate(CHECKS):
        if check.instead:
            mask[place] |= ~np.isnan(case.inputs[check.instead][:, 0])
        if check.unless:
            mask[place] &= np.isnan(case.inputs[check.unless][:, 0])
    places = np.flatnonzero(mask.any(axis=1))
    return tuple(CHECKS[place] for place in places.tolist()), mask[places, :, None]


def _verdicts(mask: BoolArray, used: FloatArray, bound: FloatArray, loads: int) -> tuple[NDArray[np.int8], FloatArray]:
    """Verdict on each gear, and its utilisation, NaN for an unrated one. The first `loads` checks are load checks."""
    largest = np.fmax.reduce(used[:loads], axis=0)
    fails = largest > bound[0]
    if loads < len(used):
        property_used = np.fmax.reduce(used[loads:], axis=0)
        missed = property_used > bound[loads]
        fails |= missed
        largest = np.where(missed, np.fmax(largest, property_used), largest)
    unknown = np.isnan(used)
    if not mask.all():
        unknown &= mask
    unrated = unknown.any(axis=0) & ~fails
    largest[unrated] = np.nan
    return np.int8(UNSUITABLE) * fails + np.int8(UNRATED) * unrated, largest  # neither: SUITABLE, which is 0

"""Fewest kinds of gears for a machine: for each number of kinds the set of least weight.

Each axis takes the lightest suitable gear of a set, so that the weight of a set is a sum of minima. Axes with the same
suitable gears form one row. A gear is left out if another is at most as heavy and suits the same axes. So 10,000 axes
shrink to some hundred rows, on which branch and bound is exact (Land and Doig 1960).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from time import monotonic

import numpy as np
from numpy.typing import NDArray

from hpn.engine.evaluation import BoolArray, PlaceArray
from hpn.physics.equations import ROUNDING, FloatArray

NO_GEAR = -1
"""Place of an axis without a gear."""

SECONDS = 1.0
"""Seconds after which the search ends with its best set so far, unproven."""


@dataclass(frozen=True, eq=False)
class GearChoices:
    """Choices of A axes among G gears.

    `suits` (A, G), `utilisation` (A, G) of these gears, `weight_kg` (G,) with NaN if not published, `quantity` (A,) of
    each axis in the machine, `present` (A,) the place of the axis's gear, NO_GEAR without one.
    """

    suits: BoolArray
    utilisation: FloatArray
    weight_kg: FloatArray
    quantity: NDArray[np.int64]
    present: PlaceArray

    def gears_of(self, kinds: Sequence[int]) -> PlaceArray:
        """Gear of each axis out of `kinds`, NO_GEAR where none suits; shape (A,).

        The lightest; among equally light ones the axis's present gear, then the least used.
        """
        places = np.asarray(kinds, np.intp)
        weight = np.where(self.suits[:, places], self.weight_kg[places], np.inf)
        lightest = weight.min(axis=1, keepdims=True)
        used = np.where(places == self.present[:, None], -np.inf, self.utilisation[:, places])
        chosen = places[np.where(weight <= lightest * (1 + ROUNDING), used, np.inf).argmin(axis=1)]
        return np.where(np.isfinite(lightest[:, 0]), chosen, NO_GEAR)


@dataclass(frozen=True, eq=False)
class LightestSet:
    """Gears of one number of kinds, as places; `gear_of` (A,) is the gear of each axis, NO_GEAR where none suits."""

    gears: tuple[int, ...]
    gear_of: PlaceArray
    weight_kg: float
    is_proven: bool


@dataclass(frozen=True, eq=False)
class Kinds:
    """Steps from the machine's own number of kinds down to the least; and the axes without a choice, by their gear."""

    steps: tuple[LightestSet, ...]
    least: int
    forced: dict[int, tuple[int, ...]]


def fewest_kinds(axes: GearChoices, *, most: int | None = None, seconds: float = SECONDS) -> Kinds:
    """Sets of least weight for each number of kinds up to `most` and the machine's own.

    Axes without a suitable gear count nowhere; gears without a published weight are excluded. A number of kinds is left
    out if its last kind neither saves weight nor leaves an axis its own gear.
    """
    axes = replace(axes, suits=axes.suits & np.isfinite(axes.weight_kg))
    served = axes.suits.any(axis=1)
    if not served.any():
        return Kinds((), 0, {})
    own = [int(gear) for gear in np.unique(axes.present[served]) if gear != NO_GEAR]
    search = _Search.of(axes, own, monotonic() + seconds)
    steps: dict[int, LightestSet] = {}
    least, best = 0, _Set((), np.inf, is_proven=True)
    for count in range(1, axes.suits.shape[1] + 1):
        if least and count > min(max(len(own), least), most or count):
            break
        best = search.lightest(count, best)
        if not np.isfinite(best.weight_kg):
            continue
        least = least or count
        if count <= (most or count):
            step = _step(axes, best, count, own)
            steps[len(step.gears)] = step
    return Kinds(tuple(steps[count] for count in sorted(steps, reverse=True)), least, _forced(axes.suits))


def _forced(suits: BoolArray) -> dict[int, tuple[int, ...]]:
    (single,) = np.nonzero(suits.sum(axis=1) == 1)
    gears = suits[single].argmax(axis=1)
    return {int(gear): tuple(single[gears == gear].tolist()) for gear in np.unique(gears)}


def _step(axes: GearChoices, best: "_Set", count: int, own: Iterable[int]) -> LightestSet:
    """A set with gears added that axes keep at no more weight, up to `count`; unused gears are left out."""
    kinds = _gears_of(axes, best.gears)
    for gear in sorted(set(own) - set(kinds), key=lambda gear: -np.count_nonzero(axes.present == gear)):
        if len(kinds) < count:
            kinds = _gears_of(axes, (*kinds, gear))
    gear_of = axes.gears_of(kinds)
    has_gear = gear_of != NO_GEAR
    weight_kg = float(np.sum(axes.weight_kg[gear_of[has_gear]] * axes.quantity[has_gear]))
    return LightestSet(kinds, gear_of, weight_kg, best.is_proven)


def _gears_of(axes: GearChoices, kinds: Sequence[int]) -> tuple[int, ...]:
    gears = np.unique(axes.gears_of(kinds))
    return tuple(gears[gears != NO_GEAR].tolist())


# --- Search -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Set:
    gears: tuple[int, ...]
    weight_kg: float
    is_proven: bool


@dataclass(eq=False)
class _Search:
    """Branch and bound over n gears; `cost` (R, n) in kg is infinite where a gear does not suit a row."""

    places: PlaceArray
    cost: FloatArray
    share: FloatArray
    end: float
    _best: tuple[int, ...] = field(default=(), init=False)
    _weight_kg: float = field(default=np.inf, init=False)

    @classmethod
    def of(cls, axes: GearChoices, own: Sequence[int], end: float) -> "_Search":
        """Search over distinct rows of axes, without replaceable gears."""
        served = axes.suits.any(axis=1)
        rows, row_of = np.unique(axes.suits[served], axis=0, return_inverse=True)
        is_own = np.isin(np.arange(rows.shape[1]), own)
        places = _undominated(rows, np.lexsort((~is_own, axes.weight_kg)))
        cost = np.where(rows[:, places], axes.weight_kg[places], np.inf)
        share = np.bincount(row_of.ravel(), weights=axes.quantity[served]).astype(np.float64)
        return cls(places, cost, share, end)

    def lightest(self, count: int, fewer: _Set) -> _Set:
        """Lightest set of at most `count` gears, starting from the set of one fewer."""
        before = tuple(np.flatnonzero(np.isin(self.places, fewer.gears)).tolist())
        nearer = np.minimum(self.cost, self.cost[:, list(before)].min(axis=1, initial=np.inf, keepdims=True))
        bare, weights_kg = np.isinf(nearer).sum(axis=0), self.share @ nearer
        added = int(np.lexsort((weights_kg, bare))[0])
        self._best, self._weight_kg = before, fewer.weight_kg
        if bare[added] or weights_kg[added] < fewer.weight_kg * (1 - ROUNDING):
            self._best, self._weight_kg = (*before, added), float(weights_kg[added])
        is_proven = self._branch(np.full(len(self.cost), np.inf), np.arange(len(self.places)), (), count)
        return _Set(tuple(self.places[list(self._best)].tolist()), self._weight_kg, is_proven)

    def _branch(self, nearest: FloatArray, still: PlaceArray, chosen: tuple[int, ...], left: int) -> bool:
        """Try every set that adds up to `left` gears from `still` to the chosen ones; False if the time ran out."""
        weight_kg = float(nearest @ self.share)
        if weight_kg < self._weight_kg * (1 - ROUNDING):
            self._best, self._weight_kg = chosen, weight_kg
        if not left or not len(still):
            return True
        if monotonic() > self.end:
            return False
        costs = self.cost[:, still]
        reach = np.minimum(nearest, costs.min(axis=1))
        if not float(reach @ self.share) < self._weight_kg * (1 - ROUNDING):
            return True
        bare = np.isinf(nearest)
        if bare.any():
            suits = np.isfinite(costs[bare])
            if _apart(suits, left) > left:
                return True
            row = costs[bare][suits.sum(axis=1).argmin()]
            order = np.argsort(row, kind="stable")[: np.isfinite(row).sum()]
        else:
            saved = ((nearest[:, None] - np.minimum(nearest[:, None], costs)) * self.share[:, None]).sum(axis=0)
            order = np.argsort(-saved, kind="stable")[: np.count_nonzero(saved > 0)]
            if not weight_kg - saved[order[:left]].sum() < self._weight_kg * (1 - ROUNDING):
                return True
        tried = np.zeros(len(still), np.bool_)
        for place in order:
            tried[place] = True
            nearer = np.minimum(nearest, costs[:, place])
            if not self._branch(nearer, still[~tried], (*chosen, int(still[place])), left - 1):
                return False
        return True


def _undominated(rows: BoolArray, order: PlaceArray) -> PlaceArray:
    """Gears in an order, without those whose rows an earlier gear suits as well."""
    best: list[int] = []
    for gear in order.tolist():
        replaced = any(not (rows[:, gear] & ~rows[:, other]).any() for other in best)
        if rows[:, gear].any() and not replaced:
            best.append(gear)
    return np.array(best, np.intp)


def _apart(suits: BoolArray, most: int) -> int:
    """Number of rows that share no gear with one another, counted up to `most` + 1: each of them needs its own gear."""
    gears = np.zeros(suits.shape[1], np.bool_)
    count = 0
    for row in suits[np.argsort(suits.sum(axis=1), kind="stable")]:
        if not (row & gears).any():
            gears |= row
            count += 1
            if count > most:
                break
    return count

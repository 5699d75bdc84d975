"""Fewest kinds of gears that serve a machine: for each number of kinds the set of least weight.

Each axis takes the lightest gear of a set that suits it, so that the weight of a set is a sum of minima. Axes that the
same gears suit are one row, and a gear that is no lighter than another one and suits no further axis is left out:
10,000 axes come down to some hundred rows, on which branch and bound is exact (Land and Doig 1960).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from time import monotonic

import numpy as np
from numpy.typing import NDArray

from hpn.engine.evaluation import BoolArray, PlaceArray
from hpn.physics.equations import ROUNDING, FloatArray

NO_GEAR = -1
"""Place of the gear of an axis that has none."""

SECONDS = 1.0
"""Time after which the best set that the search has is taken, unproven."""


@dataclass(frozen=True, eq=False)
class GearChoices:
    """Choices of A axes among G gears.

    `suits` (A, G), `utilisation` (A, G) of these gears, `weight_kg` (G,) with NaN where none is published, `quantity`
    (A,) of each axis in the machine, `present` (A,) the place of the gear that it has, NO_GEAR for none.
    """

    suits: BoolArray
    utilisation: FloatArray
    weight_kg: FloatArray
    quantity: NDArray[np.int64]
    present: PlaceArray

    def gears_of(self, kinds: Sequence[int]) -> PlaceArray:
        """Gear of each axis out of `kinds`, NO_GEAR where none suits: the lightest, of equal ones its own, then the
        least used; shape (A,).
        """
        places = np.asarray(kinds, np.intp)
        weight = np.where(self.suits[:, places], self.weight_kg[places], np.inf)
        lightest = weight.min(axis=1, keepdims=True)
        used = np.where(places == self.present[:, None], -np.inf, self.utilisation[:, places])
        chosen = places[np.where(weight <= lightest * (1 + ROUNDING), used, np.inf).argmin(axis=1)]
        return np.where(np.isfinite(lightest[:, 0]), chosen, NO_GEAR)


@dataclass(frozen=True, eq=False)
class LightestSet:
    """Gears of one number of kinds, as places; `gear_of` (A,) says which axis takes which, NO_GEAR where none suits."""

    gears: tuple[int, ...]
    gear_of: PlaceArray
    weight_kg: float
    is_proven: bool


@dataclass(frozen=True, eq=False)
class Kinds:
    """Steps from the machine's own number of kinds down to the least; the axes that leave no choice, by their gear."""

    steps: tuple[LightestSet, ...]
    least: int
    forced: dict[int, tuple[int, ...]]


def fewest_kinds(axes: GearChoices, *, most: int | None = None, seconds: float = SECONDS) -> Kinds:
    """Sets of least weight for each number of kinds up to `most` and the machine's own.

    Axes that no gear suits count nowhere; a gear without a published weight is taken for none. A number of kinds at
    which no further kind saves weight or leaves an axis its own gear is left out.
    """
    axes = _weighed(axes)
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


def _weighed(axes: GearChoices) -> GearChoices:
    suits = axes.suits & np.isfinite(axes.weight_kg)
    return GearChoices(suits, axes.utilisation, axes.weight_kg, axes.quantity, axes.present)


def _forced(suits: BoolArray) -> dict[int, tuple[int, ...]]:
    (single,) = np.nonzero(suits.sum(axis=1) == 1)
    gears = suits[single].argmax(axis=1)
    return {int(gear): tuple(single[gears == gear].tolist()) for gear in np.unique(gears)}


def _step(axes: GearChoices, best: "_Set", count: int, own: Iterable[int]) -> LightestSet:
    """A set with the gears that axes keep at no more weight, up to `count`; gears that no axis takes left out."""
    kinds = _taken(axes, best.gears)
    for gear in sorted(set(own) - set(kinds), key=lambda gear: -np.count_nonzero(axes.present == gear)):
        if len(kinds) < count:
            kinds = _taken(axes, (*kinds, gear))
    gear_of = axes.gears_of(kinds)
    has_gear = gear_of != NO_GEAR
    weight_kg = float(np.sum(axes.weight_kg[gear_of[has_gear]] * axes.quantity[has_gear]))
    return LightestSet(kinds, gear_of, weight_kg, best.is_proven)


def _taken(axes: GearChoices, kinds: Sequence[int]) -> tuple[int, ...]:
    taken = np.unique(axes.gears_of(kinds))
    return tuple(taken[taken != NO_GEAR].tolist())


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
        """Search over distinct rows of axes, without gears that another one replaces."""
        served = axes.suits.any(axis=1)
        rows, row_of = np.unique(axes.suits[served], axis=0, return_inverse=True)
        is_own = np.isin(np.arange(rows.shape[1]), own)
        places = _undominated(rows, np.lexsort((~is_own, axes.weight_kg)))
        cost = np.where(rows[:, places], axes.weight_kg[places], np.inf)
        share = np.bincount(row_of.ravel(), weights=axes.quantity[served]).astype(np.float64)
        return cls(places, cost, share, end)

    def lightest(self, count: int, fewer: _Set) -> _Set:
        """Lightest set of at most `count` gears, from that of one fewer."""
        before = tuple(np.flatnonzero(np.isin(self.places, fewer.gears)).tolist())
        nearer = np.minimum(self.cost, self.cost[:, list(before)].min(axis=1, initial=np.inf, keepdims=True))
        bare, weights_kg = np.isinf(nearer).sum(axis=0), self.share @ nearer
        added = int(np.lexsort((weights_kg, bare))[0])
        self._best, self._weight_kg = before, fewer.weight_kg
        if bare[added] or weights_kg[added] < fewer.weight_kg * (1 - ROUNDING):
            self._best, self._weight_kg = (*before, added), float(weights_kg[added])
        is_proven = self._branch(np.full(len(self.cost), np.inf), np.arange(len(self.places)), (), count)
        return _Set(tuple(self.places[list(self._best)].tolist()), self._weight_kg, is_proven)

    def _take(self, gears: tuple[int, ...], weight_kg: float) -> None:
        if weight_kg < self._weight_kg * (1 - ROUNDING):
            self._best, self._weight_kg = gears, weight_kg

    def _branch(self, nearest: FloatArray, still: PlaceArray, chosen: tuple[int, ...], left: int) -> bool:
        """Try every set that adds up to `left` of the gears `still` to those chosen; False if time ended it."""
        weight_kg = float(nearest @ self.share)
        self._take(chosen, weight_kg)
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
    """Gears in an order, without those of which an earlier one suits every row as well."""
    best: list[int] = []
    for gear in order.tolist():
        replaced = any(not (rows[:, gear] & ~rows[:, other]).any() for other in best)
        if rows[:, gear].any() and not replaced:
            best.append(gear)
    return np.array(best, np.intp)


def _apart(suits: BoolArray, most: int) -> int:
    """Number of rows, counted up to one above `most`, of which no two share a gear: each needs one of its own."""
    taken = np.zeros(suits.shape[1], np.bool_)
    count = 0
    for row in suits[np.argsort(suits.sum(axis=1), kind="stable")]:
        if not (row & taken).any():
            taken |= row
            count += 1
            if count > most:
                break
    return count

"""Worst cases over tolerances: the corners of all checks of some applications, evaluated in one call.

Where a check is proved, no point of the box is worse than its corner. Elsewhere the box is sampled, always at the same
points, and the worst of these and of the corners next to it counts.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hpn.application import Application
from hpn.catalogue import Catalogue, GearList
from hpn.engine.box import Box, duty_of
from hpn.engine.check import Case, Check
from hpn.engine.corners import Need, needs_of
from hpn.engine.evaluation import Evaluation, Worst, evaluate, judged_by
from hpn.engine.figures import Figures
from hpn.engine.members import SAMPLES, Members, Part, chunks_of, members_of
from hpn.physics.equations import ROUNDING, FloatArray

BoolArray = NDArray[np.bool_]

AT_ONCE = 64
"""Applications whose corners are evaluated together."""

CLIMBS, MOST_CLIMBED = 2, 128
"""Steps from the worst samples to worse ends of their inputs, and the largest number of inputs for them."""


@dataclass(frozen=True, eq=False)
class WorstCases:
    """Worst cases of one application on G gears, by check: utilisation, and its point; each of shape (C, G).

    `exact` is False where the box was sampled. `at` is the place in `points` of the point with this utilisation.
    """

    used: FloatArray
    exact: BoolArray
    at: NDArray[np.intp]
    points: list[tuple[Box, FloatArray]]


def with_worst(applications: Sequence[Application], evaluation: Evaluation) -> Evaluation:
    """The evaluation of applications with their worst cases, judged by these where an application asks for it."""
    has_tolerances = np.array([bool(one.tolerances) for one in applications])
    if not has_tolerances.any():
        return evaluation
    used, exact = evaluation.used.copy(), np.ones(evaluation.used.shape, np.bool_)
    some = np.flatnonzero(has_tolerances)
    for start in range(0, len(some), AT_ONCE):
        part = some[start : start + AT_ONCE].tolist()
        members = [members_of(applications[index], evaluation.catalogue) for index in part]
        for index, worst_case in zip(
            part, worst_cases(members, evaluation.checks, evaluation.gears, evaluation.catalogue), strict=True
        ):
            used[:, index], exact[:, index] = worst_case.used, worst_case.exact
    bound = worst_bound(evaluation)
    bound[:, ~has_tolerances] = evaluation.bound[:, ~has_tolerances]
    worst = Worst(judged_by(evaluation, used, bound), exact, has_tolerances, evaluation.used)
    over = has_tolerances & np.array([one.requirements.over_tolerance for one in applications])
    if over.any():
        chosen = np.where(over[:, None], used, evaluation.used), np.where(over[:, None], bound, evaluation.bound)
        evaluation = judged_by(evaluation, *chosen)
    return replace(evaluation, worst=worst)


def worst_bound(evaluation: Evaluation) -> FloatArray:
    """Largest utilisations that the worst cases may have, shape (C, N, 1)."""
    inputs = evaluation.case.inputs
    u, allowed = (inputs[f"requirements.{name}"] for name in ("utilisation", "worst_case_utilisation"))
    bound, loads = evaluation.bound.copy(), np.array([check.group == "load" for check in evaluation.checks])
    bound[loads] = np.where(np.isnan(allowed), u, allowed) * (1 + ROUNDING)
    return bound


def worst_cases(
    members: Sequence[Members],
    checks: Sequence[Check],
    gears: GearList,
    catalogue: Catalogue,
    samples: int = SAMPLES,
) -> list[WorstCases]:
    """Worst cases of applications by some checks, on some gears; `samples` is the number of points where nothing is
    proved.
    """
    boxes = [box for group in members for box in group.boxes]
    needs = needs_of(boxes, checks, gears, catalogue)
    rows = [_NeededPoints(box, own) for box, own in zip(boxes, needs, strict=True)]
    duty = duty_of([(box, own.points) for box, own in zip(boxes, rows, strict=True)])
    judged, cases, first = _Judgement(evaluate(duty, gears, catalogue), rows), [], 0
    for group in members:
        own = [judged.worst(number, first, group) for number in range(len(checks))]
        used, exact, at = (np.stack(part) for part in zip(*own, strict=True))
        parts = zip(group.boxes, rows[first : first + len(group.boxes)], strict=True)
        points = [(box, point) for box, part in parts for point in part.points]
        worst = WorstCases(used, exact.astype(np.bool_), at.astype(np.intp), points)
        cases.append(worst if worst.exact.all() else _sampled(worst, group, checks, gears, samples))
        first += len(group.boxes)
    return cases


class _NeededPoints:
    """Distinct points of all checks in a box, and the places of each check's points."""

    def __init__(self, box: Box, needs: Sequence[Need]) -> None:
        known: dict[bytes, int] = {}
        points: list[FloatArray] = []
        self.of: list[list[int]] = []
        self.needs = needs
        for need in needs:
            places = []
            for point in need.points:
                key = point.tobytes()
                if key not in known:
                    known[key] = len(points)
                    points.append(point)
                places.append(known[key])
            self.of.append(places)
        self.points = np.array(points).reshape(len(points), len(box.value))


class _Judgement:
    """Corners of all boxes in one evaluation, and the worst of each application's corners."""

    def __init__(self, evaluation: Evaluation, rows: Sequence[_NeededPoints]) -> None:
        self._evaluation, self._rows = evaluation, rows
        self._starts = np.cumsum([0, *(len(own.points) for own in rows)]).tolist()
        self._places = {check.code: place for place, check in enumerate(evaluation.checks)}
        self._proofs: dict[str, BoolArray] = {}
        self._each_gear = np.arange(len(evaluation.gears.rows))

    def worst(self, number: int, first: int, group: Members) -> tuple[FloatArray, BoolArray, NDArray[np.intp]]:
        """Worst utilisation of a check on every gear, True where it is proved, and its row among the points, (G,) each.

        `first` is the number of the application's first box.
        """
        own = range(first, first + len(group.boxes))
        needs, gears = [self._rows[box].needs[number] for box in own], self._each_gear
        check, place = needs[0].check, self._places.get(needs[0].check.code)
        at_rows = [self._starts[box] + row for box in own for row in self._rows[box].of[number]]
        if place is None or not self._evaluation.applies.item(place, at_rows[0], 0):
            return np.full(len(gears), np.nan), np.ones(len(gears), np.bool_), np.zeros(len(gears), np.intp)
        rows = np.array(at_rows, np.intp)
        worst, at = self._worst_of(place, rows)
        exact = np.full(len(gears), all(need.is_exact for need in needs) and group.proves(check))
        if check.proven is not None and (any(need.is_moved for need in needs) or group.moves(check)):
            exact &= self._proof(check)[rows].all(axis=0)
        return worst, exact, rows[at] - self._starts[first]

    def _worst_of(self, place: int, rows: NDArray[np.intp]) -> tuple[FloatArray, NDArray[np.intp]]:
        """Worst utilisation of a check in some rows on every gear, and its place among these rows."""
        if len(rows) == 1:
            return self._evaluation.used[place, rows[0]], np.zeros(len(self._each_gear), np.intp)
        used = self._evaluation.used[place, rows]
        unknown = np.isnan(used)
        at = np.where(unknown, -np.inf, used).argmax(axis=0)
        worst = used[at, self._each_gear]
        if unknown.any():  # unrated at one point means unrated, unless it fails at another
            fails = worst > self._evaluation.bound[place, rows].max()
            worst = np.where(unknown.any(axis=0) & ~fails, np.nan, worst)
        return worst, at

    def _proof(self, check: Check) -> BoolArray:
        """True where a check's dependence holds (`Check.proven`), shape (rows, G)."""
        if check.code not in self._proofs:
            assert check.proven is not None
            with np.errstate(all="ignore"):
                proven = check.proven(self._evaluation.case)
            self._proofs[check.code] = np.broadcast_to(proven, self._evaluation.used.shape[1:])
        return self._proofs[check.code]


# --- Samples ----------------------------------------------------------------------------------------------------------


def _sampled(corners: WorstCases, group: Members, checks: Sequence[Check], gears: GearList, samples: int) -> WorstCases:
    """Worst cases, with samples in place of corners where nothing is proved.

    From the worst sample, all inputs then go to their worse ends: of many inputs, no sample is near a corner.
    """
    sampler = _Sampler(np.flatnonzero(~corners.exact.all(axis=1)), checks, gears, group.catalogue)
    cases = replace(corners, points=[*corners.points])
    for parts in chunks_of(group.sampled(samples)):
        cases = sampler.with_samples(cases, parts)
    if group.moving and not group.is_fixed:
        cases = sampler.with_corners_of_motion(cases, group)
    for _ in range(CLIMBS):
        cases = sampler.climbed(cases)
    return cases


@dataclass(frozen=True, eq=False)
class _Sampler:
    """Some checks, by their places, on gears that don't influence one another."""

    places: NDArray[np.intp]
    checks: Sequence[Check]
    gears: GearList
    catalogue: Catalogue

    def with_samples(self, cases: WorstCases, parts: Sequence[Part]) -> WorstCases:
        """Worst cases, further points included."""
        shares = self._shares(parts)
        best = (shares >= shares.max(axis=1, keepdims=True) * (1 - ROUNDING)).argmax(axis=1)
        return self._with(cases, parts, best, np.take_along_axis(shares, best[:, None], axis=1)[:, 0])

    def climbed(self, cases: WorstCases) -> WorstCases:
        """Worst cases after a step from each: every input at that end which alone is worse there."""
        at, open_ = cases.at[self.places], ~cases.exact[self.places] & np.isfinite(cases.used[self.places])
        few = [place for place in np.unique(at[open_]).tolist() if 0 < len(cases.points[place][1]) <= MOST_CLIMBED]
        starts, open_ = {place: k for k, place in enumerate(few)}, open_ & np.isin(at, few)
        if not starts:
            return cases
        around = [(box, _ends_from(box, point)) for box, point in map(cases.points.__getitem__, starts)]
        shares, first = self._shares(around), np.cumsum([0, *(len(points) for _, points in around)])
        rows, corners, known = np.zeros(at.shape, np.intp), list[Part](), dict[tuple[int, bytes], int]()
        for check, gear in np.argwhere(open_).tolist():
            start = starts[at.item(check, gear)]
            box, points = around[start]
            share, *alone = shares[check, first[start] : first[start + 1], gear]
            at_low, at_high = np.split(np.array(alone), 2)
            corner = _corner(points[0], share, at_low, at_high, box.low, box.high)
            rows[check, gear] = row = known.setdefault((start, corner.tobytes()), len(corners))
            if row == len(corners):
                corners.append((box, corner[None]))
        there = np.take_along_axis(self._shares(corners), rows[:, None], axis=1)[:, 0]
        return self._with(cases, corners, rows, np.where(open_, there, -np.inf))

    def with_corners_of_motion(self, cases: WorstCases, group: Members) -> WorstCases:
        """Worst cases, each also with the motion's inputs at those of their ends which alone are worse."""
        moving, motions = group.moving, [group.boxes[0], *group.ends_alone]
        at, open_ = cases.at[self.places], ~cases.exact[self.places] & np.isfinite(cases.used[self.places])
        if len(motions) <= 2 * len(moving) or not open_.any():
            return cases
        value, low, high = np.array([(one.value, one.low, one.high) for one in moving]).T
        shares = self._shares([(box, box.value[None]) for box in motions])
        corners, known = dict[bytes, FloatArray](), dict[tuple[bytes, int], int]()
        rows = np.zeros(at.shape, np.intp)
        for check, gear in np.argwhere(open_).tolist():
            share, *alone = shares[check, :, gear]
            corner = _corner(value, share, np.array(alone[::2]), np.array(alone[1::2]), low, high)
            corners[name := corner.tobytes()] = corner
            rows[check, gear] = known.setdefault((name, at.item(check, gear)), len(known))
        boxes = dict(zip(corners, group.boxes_beside([*corners.values()]), strict=True))
        parts = [(boxes[name] or cases.points[start][0], cases.points[start][1][None]) for name, start in known]
        there = np.take_along_axis(self._shares(parts), rows[:, None], axis=1)[:, 0]
        return self._with(cases, parts, rows, np.where(open_, there, -np.inf))

    def _shares(self, parts: Sequence[Part]) -> FloatArray:
        """Utilisations at points, shape (places, points, G); -inf where unknown."""
        return np.concatenate([self._shares_of(some) for some in chunks_of(parts)], axis=1)

    def _shares_of(self, parts: Sequence[Part]) -> FloatArray:
        duty = duty_of(parts)
        case = Case(duty, self.gears.columns, Figures(duty, self.gears, self.catalogue))
        shape = len(duty.inputs.rank_by), len(self.gears.rows)
        with np.errstate(all="ignore"):
            shares = [np.broadcast_to(self.checks[place].utilisation(case), shape) for place in self.places]
        return np.where(np.isnan(shares), -np.inf, shares)

    def _with(self, cases: WorstCases, parts: Sequence[Part], rows: NDArray[np.intp], shares: FloatArray) -> WorstCases:
        """Worst cases, points included that are worse; their rows and utilisations have shape (places, G).

        The points are added to the list of the cases.
        """
        used, at = cases.used.copy(), cases.at.copy()
        before = np.where(np.isnan(used), np.inf, used)[self.places]
        worse = ~cases.exact[self.places] & (shares > before * (1 + ROUNDING))
        used[self.places] = np.where(worse, shares, used[self.places])
        at[self.places] = np.where(worse, len(cases.points) + rows, at[self.places])
        cases.points.extend((box, point) for box, some in parts for point in some)
        return replace(cases, used=used, at=at)


def _ends_from(box: Box, point: FloatArray) -> FloatArray:
    """A point, and those with each input in turn at its lower and then at its upper end."""
    count = len(point)
    points = np.repeat(point[None], 1 + 2 * count, axis=0)
    places = np.arange(count)
    points[1 + places, places], points[1 + count + places, places] = box.low, box.high
    return points


def _corner(
    point: FloatArray,
    share: float,
    at_low: FloatArray,
    at_high: FloatArray,
    low: FloatArray,
    high: FloatArray,
) -> FloatArray:
    """The point with all inputs at their worse ends, from utilisations at the point and with each alone at its ends."""
    ends: FloatArray = np.where(at_high >= at_low * (1 - ROUNDING), high, low)
    return np.where(np.maximum(at_low, at_high) > share * (1 + ROUNDING), ends, point)

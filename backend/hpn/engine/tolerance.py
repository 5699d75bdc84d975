"""Worst cases over tolerances: applications become the corners of their checks, which one call of the engine judges.

Where a proof says so, no point of the box is worse than the corner. Elsewhere the box is sampled, always with the same
points, and the worst of these counts.
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
from hpn.engine.members import SAMPLES, Members, members_of
from hpn.physics.equations import ROUNDING, FloatArray

BoolArray = NDArray[np.bool_]

AT_ONCE = 64
"""Applications whose corners are judged together."""

ROWS_AT_ONCE = 512


@dataclass(frozen=True, eq=False)
class Found:
    """Worst cases of one application on G gears, by check: utilisation, and where it is; each of shape (C, G).

    `exact` is False where the box was sampled. `at` is the place in `points` of the point that attains it.
    """

    used: FloatArray
    exact: BoolArray
    at: NDArray[np.intp]
    points: list[tuple[Box, FloatArray]]


def with_worst(applications: Sequence[Application], evaluation: Evaluation) -> Evaluation:
    """The evaluation of applications with their worst cases; by these, where an application asks for it."""
    has_tolerances = np.array([bool(one.tolerances) for one in applications])
    if not has_tolerances.any():
        return evaluation
    used, exact = evaluation.used.copy(), np.ones(evaluation.used.shape, np.bool_)
    some = np.flatnonzero(has_tolerances)
    for start in range(0, len(some), AT_ONCE):
        part = some[start : start + AT_ONCE].tolist()
        members = [members_of(applications[index], evaluation.catalogue) for index in part]
        for index, worst_case in zip(part, worst_cases(members, *_setting(evaluation)), strict=True):
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
    inputs = evaluation.case.asked
    u, allowed = (inputs[f"requirements.{name}"] for name in ("utilisation", "worst_case_utilisation"))
    bound, loads = evaluation.bound.copy(), np.array([check.group == "load" for check in evaluation.checks])
    bound[loads] = np.where(np.isnan(allowed), u, allowed) * (1 + ROUNDING)
    return bound


def _setting(evaluation: Evaluation) -> tuple[Sequence[Check], GearList, Catalogue]:
    return evaluation.checks, evaluation.gears, evaluation.catalogue


def worst_cases(
    members: Sequence[Members],
    checks: Sequence[Check],
    gears: GearList,
    catalogue: Catalogue,
    samples: int = SAMPLES,
) -> list[Found]:
    """Worst cases of applications by some checks, on some gears, with so many points where nothing is proved."""
    boxes = [box for group in members for box in group.boxes]
    needs = needs_of(boxes, checks, gears, catalogue)
    rows = [_Rows(box, own) for box, own in zip(boxes, needs, strict=True)]
    duty = duty_of([(box, own.points) for box, own in zip(boxes, rows, strict=True)])
    judged, cases, first = _Judged(evaluate(duty, gears, catalogue), rows), [], 0
    for group in members:
        own = [judged.worst(number, first, group) for number in range(len(checks))]
        used, exact, at = (np.stack(part) for part in zip(*own, strict=True))
        points = [(box, point) for box, part in _parts(group, rows, first) for point in part.points]
        worst = Found(used, exact.astype(np.bool_), at.astype(np.intp), points)
        cases.append(worst if worst.exact.all() else _sampled(worst, group, checks, gears, samples))
        first += len(group.boxes)
    return cases


class _Rows:
    """Points of all checks in a box, each once, and the places of those of every check."""

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


def _parts(group: Members, rows: Sequence[_Rows], place: int) -> list[tuple[Box, _Rows]]:
    return list(zip(group.boxes, rows[place : place + len(group.boxes)], strict=True))


class _Judged:
    """Corners of all boxes in one evaluation, and the worst of those of each application."""

    def __init__(self, evaluation: Evaluation, rows: Sequence[_Rows]) -> None:
        self._evaluation, self._rows = evaluation, rows
        self._starts = np.cumsum([0, *(len(own.points) for own in rows)]).tolist()
        self._places = {check.code: place for place, check in enumerate(evaluation.checks)}
        self._proofs: dict[str, BoolArray] = {}
        self._each_gear = np.arange(len(evaluation.gears.rows))

    def worst(self, number: int, first: int, group: Members) -> tuple[FloatArray, BoolArray, NDArray[np.intp]]:
        """Worst utilisation of a check on every gear, whether it is proved, and the row that attains it, (G,) each.

        The boxes of the application begin with the first one.
        """
        own = range(first, first + len(group.boxes))
        needs, gears = [self._rows[box].needs[number] for box in own], self._each_gear
        check, place = needs[0].check, self._places.get(needs[0].check.code)
        at_rows = [self._starts[box] + row for box in own for row in self._rows[box].of[number]]
        if place is None or not self._evaluation.asked.item(place, at_rows[0], 0):
            return np.full(len(gears), np.nan), np.ones(len(gears), np.bool_), np.zeros(len(gears), np.intp)
        rows, used = np.array(at_rows, np.intp), self._evaluation.used[place, at_rows]
        unknown = np.isnan(used)
        at = np.where(unknown, -np.inf, used).argmax(axis=0)
        worst = used[at, gears]
        if unknown.any():  # not rated somewhere is not rated, unless it fails elsewhere
            fails = worst > self._evaluation.bound[place, at_rows].max()
            worst = np.where(unknown.any(axis=0) & ~fails, np.nan, worst)
        exact = np.full(len(gears), all(need.is_exact for need in needs) and group.proves(check))
        if check.proven is not None and (any(need.is_moved for need in needs) or group.moves(check)):
            exact &= self._proof(check)[rows].all(axis=0)
        return worst, exact, rows[at] - self._starts[first]

    def _proof(self, check: Check) -> BoolArray:
        """True where the condition of a check's declaration holds, shape (rows, G)."""
        if check.code not in self._proofs:
            assert check.proven is not None
            with np.errstate(all="ignore"):
                proven = check.proven(self._evaluation.case)
            self._proofs[check.code] = np.broadcast_to(proven, self._evaluation.used.shape[1:])
        return self._proofs[check.code]


# --- Samples ----------------------------------------------------------------------------------------------------------


def _sampled(corners: Found, group: Members, checks: Sequence[Check], gears: GearList, samples: int) -> Found:
    """Worst cases with those of samples where nothing is proved."""
    open_ = [place for place in range(len(checks)) if not corners.exact[place].all()]
    used, at, points = corners.used.copy(), corners.at.copy(), list(corners.points)
    for box, some in group.sampled(samples):
        for part in chunks_of(some):
            duty = box.at(part)
            case = Case(duty, gears.columns, Figures(duty, gears, group.catalogue))
            for place in open_:
                with np.errstate(all="ignore"):
                    values = np.broadcast_to(checks[place].utilisation(case), (len(part), len(gears.rows)))
                best = np.where(np.isnan(values), -np.inf, values).argmax(axis=0)
                largest = values[best, np.arange(len(gears.rows))]
                worse = ~corners.exact[place] & (largest > np.where(np.isnan(used[place]), np.inf, used[place]))
                used[place] = np.where(worse, largest, used[place])
                at[place] = np.where(worse, len(points) + best, at[place])
            points += [(box, point) for point in part]
    return replace(corners, used=used, at=at, points=points)


def chunks_of(points: FloatArray) -> list[FloatArray]:
    """Points some at a time."""
    return [points[start : start + ROWS_AT_ONCE] for start in range(0, len(points), ROWS_AT_ONCE)]

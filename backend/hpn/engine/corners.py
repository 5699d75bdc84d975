"""Corners of a box of tolerances at which each check has its worst case, by what the check declares of its inputs.

A check takes one point, or two where an input counts at both of its ends. Where inputs are weights of a share
Σ w d / (Σ w + c), the largest share gives its high weights to the largest d: sorting finds it, one point for each
order that the gears have.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import product

import numpy as np
from numpy.typing import NDArray

from hpn.catalogue import Catalogue, GearList
from hpn.engine.box import Box, duty_of
from hpn.engine.check import Case, Check
from hpn.engine.figures import Figures
from hpn.physics.equations import FloatArray

BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.intp]

MOST_ENDS = 4
"""Inputs of one check of which both ends are looked at."""

PAUSE = "duty_cycle.pause_s"


@dataclass(eq=False)
class Need:
    """Points of a box that give a check its worst case; `is_exact` is False where no proof says so.

    `is_moved` is False where no interval has an influence on the check.
    """

    check: Check
    points: FloatArray
    is_exact: bool
    is_moved: bool = False
    weights: list[str] = field(default_factory=list)


def needs_of(boxes: Sequence[Box], checks: Sequence[Check], gears: GearList, catalogue: Catalogue) -> list[list[Need]]:
    """Points of the checks in each box."""
    needs_by_box = [[need_of(box, check) for check in checks] for box in boxes]
    sharing = [(box, need) for box, needs in zip(boxes, needs_by_box, strict=True) for need in needs if need.weights]
    if not sharing:
        return needs_by_box
    ends = [_with_weights(box, need) for box, need in sharing]  # weights at their low ends, at their high ends
    duty = duty_of([(box, points) for (box, _), points in zip(sharing, ends, strict=True)])
    case = Case(duty, gears.columns, Figures(duty, gears, catalogue))
    for check in {need.check.code: need.check for _, need in sharing}.values():
        places = [place for place, (_, need) in enumerate(sharing) if need.check.code == check.code]
        for place, raised in zip(places, _raised(check, case, 2 * np.array(places)), strict=True):
            box, need = sharing[place]
            need.points = _points(box, need, ends[place], raised)
    return needs_by_box


def need_of(box: Box, check: Check) -> Need:
    """Points of a check, its weights left where they are given."""
    point, is_exact, is_moved = box.value.copy(), check.over is not None, check.over is None
    both: list[int] = []
    weights: list[str] = []
    set_high = np.zeros(len(point), np.int8)
    alike = np.zeros(len(point), np.bool_)
    for name, dependence in (check.over or {}).items():
        ends = box.ends.get(name)
        if ends is None or not len(ends.of):
            continue
        is_moved = True
        if dependence == "unproven":
            is_exact = False
        elif dependence == "weight":
            weights.append(name)
        elif dependence == "ends":
            both += ends.of.tolist()
        else:
            equal = ends.at_high == ends.at_low
            rises = (ends.at_high >= ends.at_low) == (dependence == "rising")
            way = np.where(equal, set_high[ends.of], np.where(rises, 1, -1)).astype(np.int8)
            alike[ends.of[equal]] = True
            if (set_high[ends.of] * way < 0).any():
                is_exact = False  # two figures of a phase whose worst lies at different ends
            set_high[ends.of] = way
    set_high[alike & (set_high == 0)] = 1  # magnitudes at both ends are alike, and less between them
    point = np.where(set_high > 0, box.high, np.where(set_high < 0, box.low, point))
    points = point[None]
    if both and len(both) <= MOST_ENDS:
        choices = np.array(list(product((0, 1), repeat=len(both))))
        points = np.repeat(points, len(choices), axis=0)
        points[:, both] = np.where(choices, box.high[both], box.low[both])
    return Need(check, points, is_exact and len(both) <= MOST_ENDS, is_moved, weights)


def _with_weights(box: Box, need: Need) -> FloatArray:
    """The point of a need with its weights at their low ends, and at their high ends."""
    points = np.repeat(need.points[:1], 2, axis=0)
    for name in need.weights:
        of, at_low, at_high = box.ends[name]
        rises = at_high >= at_low
        points[0, of] = np.where(rises, box.low[of], box.high[of])
        points[1, of] = np.where(rises, box.high[of], box.low[of])
    return points


def _raised(check: Check, case: Case, rows: IntArray) -> list[BoolArray]:
    """Phases whose weights are high at the largest share, shape (groups of gears, phases), of each pair of rows.

    The share is largest where the weights of all d above it are high and those of all below it low.
    """
    assert check.weighted is not None
    over = check.over or {}
    names = [name for name, dependence in over.items() if dependence == "weight"]
    weights = np.prod([getattr(case.duty.phases, name)[:, 0] for name in names], axis=0)
    low, high = weights[rows, None], weights[rows + 1, None]
    c = case.asked[PAUSE][rows, None] if PAUSE in over else np.zeros((1, 1, 1))
    with np.errstate(all="ignore"):
        d = check.weighted(case)[rows]
        order = np.argsort(-d, axis=-1, kind="stable")
        descending, more = (
            np.take_along_axis(values, order, -1) for values in (d, np.broadcast_to(high - low, d.shape))
        )
        above = (low * d).sum(axis=-1, keepdims=True) + np.cumsum(more * descending, axis=-1)
        below = low.sum(axis=-1, keepdims=True) + c + np.cumsum(more, axis=-1)
        least = (low * d).sum(axis=-1) / (low.sum(axis=-1) + c[..., 0])
        largest = np.fmax(least, np.fmax.reduce(above / below, axis=-1))
        raised = np.asarray(d > largest[..., None])
    known = np.asarray(np.isfinite(d).all(axis=-1, keepdims=True))
    return [own[rated[:, 0]] for own, rated in zip(raised, known, strict=True)]


def _points(box: Box, need: Need, ends: FloatArray, raised: BoolArray) -> FloatArray:
    """Points with the weights of some phases at their high ends, those of the others at their low ends."""
    columns = [box.columns[name] for name in need.weights if name in box.columns]
    points = {}
    for of_group in raised if len(raised) else np.zeros((1, raised.shape[-1]), np.bool_):
        point = ends[0].copy()
        for of, phases in columns:
            point[of] = np.where(of_group[phases], ends[1, of], ends[0, of])
        points[point.tobytes()] = point
    return np.array(list(points.values()))

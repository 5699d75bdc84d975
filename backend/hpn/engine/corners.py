"""Corners of a box of tolerances with the worst case of each check, from the dependences that the check declares.

A check takes one point, or two where an input counts at both of its ends. Where inputs are weights of a share Σ w d /
(Σ w + c), the largest share gives its high weights to the largest d: sorting finds it, one point for each order that
the gears have.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hpn.catalogue import Catalogue, GearList
from hpn.engine.box import Box, MovedInputs, duty_of, find_extremes
from hpn.engine.check import Case, Check, Dependence
from hpn.engine.figures import Figures
from hpn.physics.equations import FloatArray

BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.intp]

MOST_ENDS = 4
"""Inputs of one check, at most, whose both ends are evaluated."""

PAUSE = "duty_cycle.pause_s"


@dataclass(eq=False)
class Need:
    """Points of a box with the worst case of a check; `is_exact` is False without a proof.

    `is_moved` is False if no interval influences the check.
    """

    check: Check
    points: FloatArray
    is_exact: bool
    is_moved: bool = False
    weights: list[str] = field(default_factory=list)


def needs_of(boxes: Sequence[Box], checks: Sequence[Check], gears: GearList, catalogue: Catalogue) -> list[list[Need]]:
    """Points of the checks in each box."""
    find_extremes(boxes)
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


class _Sense(NamedTuple):
    """Ends of a box at which a check is worst, by its declaration.

    `way` (intervals,) is 1 for the upper end, -1 for the lower one and 0 for the value; `both` are places to evaluate
    at both ends.
    """

    way: NDArray[np.int8]
    both: list[int]
    weights: list[str]
    is_exact: bool
    is_moved: bool


def need_of(box: Box, check: Check) -> Need:
    """Points of a check, its weights at their given values."""
    sense = _sense_of(box.moved, None if check.over is None else tuple(check.over.items()))
    points = np.where(sense.way > 0, box.high, np.where(sense.way < 0, box.low, box.value))[None]
    if both := sense.both:
        choices = np.array(list(product((0, 1), repeat=len(both))))
        points = np.repeat(points, len(choices), axis=0)
        points[:, both] = np.where(choices, box.high[both], box.low[both])
    is_open = bool(check.sampled_beside) and not np.isnan(box.duty.inputs[check.sampled_beside]).all()
    return Need(check, points, sense.is_exact and not is_open, sense.is_moved or is_open, sense.weights)


@lru_cache(maxsize=1024)
def _sense_of(moved: MovedInputs, over: tuple[tuple[str, Dependence], ...] | None) -> _Sense:
    """Sense of a declaration in boxes whose intervals influence the same inputs in the same direction."""
    is_exact, is_moved = over is not None, over is None
    both: list[int] = []
    weights: list[str] = []
    set_high, alike = np.zeros(moved.count, np.int8), np.zeros(moved.count, np.bool_)
    for name, dependence in over or ():
        if name not in moved.places:
            continue
        of, rising = (np.array(values) for values in moved.places[name])
        is_moved = True
        if dependence == "unproven":
            is_exact = False
        elif dependence == "weight":
            weights.append(name)
        elif dependence == "ends":
            both += of.tolist()
        else:
            alike[of[rising == 0]] = True
            way = np.where(rising == 0, set_high[of], rising if dependence == "rising" else -rising)
            if (set_high[of] * way < 0).any():
                is_exact = False  # two figures of a phase are worst at different ends
            set_high[of] = way
    set_high[alike & (set_high == 0)] = 1  # equal magnitudes at both ends, smaller ones between them
    few = len(both) <= MOST_ENDS
    return _Sense(set_high, both if few else [], weights, is_exact and few, is_moved)


def _with_weights(box: Box, need: Need) -> FloatArray:
    """The point of a need with its weights at their low ends, and at their high ends."""
    points = np.repeat(need.points[:1], 2, axis=0)
    for name in need.weights:
        of, rises = box.ends[name].of, box.ends[name].rising >= 0
        points[0, of] = np.where(rises, box.low[of], box.high[of])
        points[1, of] = np.where(rises, box.high[of], box.low[of])
    return points


def _raised(check: Check, case: Case, rows: IntArray) -> list[BoolArray]:
    """Phases whose weights are high at the largest share, shape (groups of gears, phases), for each pair of rows.

    The share is largest where the weights of all d above it are high and those of all d below it low.
    """
    assert check.weighted is not None
    over = check.over or {}
    names = [name for name, dependence in over.items() if dependence == "weight"]
    weights = np.prod([getattr(case.duty.phases, name)[:, 0] for name in names], axis=0)
    low, high = weights[rows, None], weights[rows + 1, None]
    c = case.inputs[PAUSE][rows, None] if PAUSE in over else np.zeros((1, 1, 1))
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

"""Room of a selected gear over its tolerances: where its worst case is, how far they may grow, which of them decide.

Also the share of points of the box at which it fails, by samples, with an upper bound.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Any

import msgspec
import numpy as np
from msgspec import UNSET, UnsetType
from pydantic import Field

from hpn.application import Application, InputError
from hpn.application.tolerances import Deviation, Interval, Tolerance
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.allowed import with_listed_motor
from hpn.engine.duty import Duty
from hpn.engine.evaluation import SUITABLE, Evaluation, evaluate, judged_by
from hpn.engine.members import SAMPLES, Members, members_of, moving_of
from hpn.engine.tolerance import Found, chunks_of, worst_bound, worst_cases
from hpn.physics.equations import ROUNDING
from hpn.words.reply import Reply
from hpn.words.wording import rounded

CLOSE = 1e-9
"""Relative width in which the factor of growth is known."""

MOST_STEPS = 60

CLOSE_BY_SAMPLES, FEW_STEPS = 1e-3, 8
"""The same by all samples, which take long: a factor is not shown closer."""

FEW_SAMPLES = 64
"""Points by which growth is sought where nothing is proved; what is found holds at all samples."""

CONFIDENCE = 0.95

MOST_SAMPLES = 100_000


class Deciding(Reply, frozen=True):
    """One tolerance, and what the worst case falls to without it."""

    path: Annotated[str, Field(description="Path of the tolerance.")]
    worst: Annotated[float | None, Field(description="Worst utilisation of the selected gear with this input exact.")]


class Share(Reply, frozen=True):
    """Points at random at which the selected gear fails."""

    samples: Annotated[int, Field(description="Points that were looked at, evenly spread over the tolerances.")]
    failing: Annotated[int, Field(description="Points at which a check fails.")]
    upper: Annotated[float, Field(description="Upper bound of the share of such points, with 95 % confidence.")]


class Room(Reply, frozen=True):
    """The selected gear over the whole tolerance."""

    holds: Annotated[bool, Field(description="True: the gear passes everywhere inside the tolerances.")]
    exact: Annotated[bool, Field(description="True: proved. False: a check was sampled, so it may be worse somewhere.")]
    case: Annotated[dict[str, Any], Field(description="The application at its worst corner.")]
    link: Annotated[str, Field(description="Address of the page that shows that case.")]
    growth: Annotated[
        float | None,
        Field(
            description="Factor by which all tolerances may grow together, at most up to the first bound of an input; "
            "below 1 where they must shrink; null without limit."
        ),
    ]
    deciding: Annotated[
        tuple[Deciding, ...],
        Field(description="Tolerances without which the worst case falls, the greatest fall first."),
    ]
    share: (
        Annotated[Share, Field(description="Share of the points that fail, where samples were asked for.")] | UnsetType
    ) = UNSET


@dataclass(frozen=True, eq=False)
class _Alone:
    """A gear by itself under an application."""

    application: Application
    base: Evaluation

    @property
    def catalogue(self) -> Catalogue:
        return self.base.catalogue

    def members(self, intervals: Sequence[Interval]) -> Members:
        return members_of(self.application, self.catalogue, intervals)

    def judged(self, cases: Sequence[Found]) -> Evaluation:
        """Evaluation of worst cases, each in the place of an application."""
        count = len(cases)
        used = np.stack([one.used for one in cases], axis=1)
        mask = np.repeat(self.base.asked, count, axis=1)
        bound = np.repeat(worst_bound(self.base), count, axis=1)
        return judged_by(replace(self.base, asked=mask), used, bound)

    def worst(self, boxes: Sequence[Sequence[Interval]], samples: int = FEW_SAMPLES) -> tuple[list[Found], Evaluation]:
        """Worst cases over some intervals, and their evaluation."""
        members = [self.members(intervals) for intervals in boxes]
        cases = worst_cases(members, self.base.checks, self.base.gears, self.catalogue, samples)
        return cases, self.judged(cases)


def room_of(
    application: Application,
    equipped: Application,
    gear: Gear,
    catalogue: Catalogue,
    link_of: Callable[[Application], str],
    samples: int = 0,
) -> Room:
    """Room of a selected gear; `equipped` is the application with the figures of its motor."""
    gears = catalogue.listed([gear])
    alone = _Alone(application, evaluate(Duty.of([equipped]), gears, catalogue))
    intervals = application.intervals
    paths = list(dict.fromkeys(one.path for one in intervals))
    without = [tuple(one for one in intervals if one.path != path) for path in paths]
    (whole,), judged = alone.worst([intervals], SAMPLES)
    holds, worst = bool(judged.verdict.item(0, 0) == SUITABLE), judged.utilisation.item(0, 0)
    governing = judged.governing.item(0, 0)
    samples_of_each = FEW_SAMPLES if moving_of(intervals) else SAMPLES  # a motion's samples take long
    alternatives = alone.worst(without, samples_of_each)[1].utilisation[:, 0] if without else np.empty(0)
    box, point = whole.points[whole.at.item(governing, 0)]
    case = box.application_at(point)
    deciding = [
        Deciding(path, float(value))
        for path, value in zip(paths, alternatives.tolist(), strict=True)
        if value < worst * (1 - ROUNDING) or (math.isfinite(value) and not math.isfinite(worst))
    ]
    return Room(
        holds=holds,
        exact=bool(whole.exact.all()),
        case=msgspec.json.decode(case.model_dump_json(exclude_unset=True)),
        link=link_of(case),
        growth=_growth(alone, intervals, holds),
        deciding=tuple(sorted(deciding, key=lambda one: one.worst or 0.0)),
        share=_share(alone, alone.members(intervals), samples) if samples else UNSET,
    )


# --- Growth -----------------------------------------------------------------------------------------------------------


def allowed_of(application: Application, gear: Gear, catalogue: Catalogue, path: str) -> float | None:
    """Factor by which one tolerance may grow, or must shrink, the others as given, so that a gear holds.

    Exact where every check is proved: a larger box holds the smaller one, so its worst case is no better. None without
    a limit, and 0 where the gear fails though this input is exact.
    """
    equipped, gears = with_listed_motor(application, catalogue), catalogue.listed([gear])
    alone, intervals = _Alone(application, evaluate(Duty.of([equipped]), gears, catalogue)), application.intervals
    holds = alone.worst([intervals], SAMPLES)[1].verdict.item(0, 0) == SUITABLE
    return _growth(alone, intervals, holds, path)


def with_tolerance(application: Application, path: str, factor: float) -> Application:
    """The application with one tolerance by a factor, in three digits that never exceed it."""
    tolerance = (application.tolerances or {})[path]
    return application.model_copy(
        update={"tolerances": {**(application.tolerances or {}), path: scaled(tolerance, factor)}}
    )


def scaled(tolerance: Tolerance, factor: float) -> Tolerance:
    """A tolerance by a factor, in three digits that never exceed it."""

    def number(value: float) -> float:
        return float(rounded(value * factor, 3, "down"))

    def side(deviation: Deviation | None) -> Deviation | None:
        return deviation and Deviation(**{name: number(value) for name, value in deviation if value is not None})

    if tolerance.minus or tolerance.plus:
        return Tolerance(minus=side(tolerance.minus), plus=side(tolerance.plus))
    return Tolerance(**{name: number(value) for name, value in tolerance if isinstance(value, float)})


def share_of(application: Application, gear: Gear, catalogue: Catalogue, samples: int) -> Share:
    """Share of so many points at random at which a gear fails."""
    equipped, gears = with_listed_motor(application, catalogue), catalogue.listed([gear])
    alone = _Alone(application, evaluate(Duty.of([equipped]), gears, catalogue))
    return _share(alone, alone.members(application.intervals), samples)


def _growth(alone: _Alone, intervals: Sequence[Interval], holds: bool, path: str | None = None) -> float | None:
    """Factor by which all tolerances may grow, or must shrink, or that of one path alone; None without a limit."""
    growing = [path is None or one.path == path for one in intervals]
    most = min((one.most_growth for one, grows in zip(intervals, growing, strict=True) if grows), default=math.inf)
    if not math.isfinite(most):
        return None

    def excess(factor: float, samples: int = FEW_SAMPLES) -> float:
        """Largest utilisation over its bound less 1; infinite where a check has no number."""
        try:
            changed = [one.grown(factor) if grows else one for one, grows in zip(intervals, growing, strict=True)]
            _, judged = alone.worst([changed], samples)
        except InputError:
            return math.inf
        if judged.verdict.item(0, 0) == SUITABLE:
            return min(float(np.nanmax(judged.used / judged.bound)) - 1, -0.0)
        used = np.where(judged.asked[:, :1], judged.used, 0.0) / judged.bound
        return max(float(used.max()) - 1, CLOSE) if np.isfinite(used).all() else math.inf

    least, top = 1.0 if holds else 0.0, most * (1 - CLOSE)
    factor = _largest(excess, least, 2.0 if holds else 1.0, top if holds else min(top, 1.0))
    thorough = partial(excess, samples=SAMPLES)
    above = thorough(factor)
    if above > 0:  # at one of the samples that are not among the few
        at_least = thorough(least)
        return 0.0 if at_least > 0 else _zero(thorough, least, factor, at_least, above, CLOSE_BY_SAMPLES, FEW_STEPS)
    return most if holds and factor == top else factor


def _largest(excess: Callable[[float], float], low: float, high: float, top: float) -> float:
    """Largest factor up to `top` at which nothing exceeds its bound; 0 where even the lowest does."""
    at_low = excess(low)
    if at_low > 0:
        return 0.0
    while True:
        high = min(high, top)
        at_high = excess(high)
        if at_high > 0:
            return _zero(excess, low, high, at_low, at_high, CLOSE, MOST_STEPS)
        if high == top:
            return top
        low, at_low, high = high, at_high, 4 * high


def _zero(
    excess: Callable[[float], float],
    low: float,
    high: float,
    at_low: float,
    at_high: float,
    close: float,
    most_steps: int,
) -> float:
    """Largest factor at which nothing exceeds its bound: regula falsi (Illinois), bisection without a number."""
    last = 0
    for _ in range(most_steps):
        if high - low <= close * high:
            break
        middle = (low + high) / 2
        if math.isfinite(at_high) and at_low < 0:
            middle = high - at_high * (high - low) / (at_high - at_low)
            room = close * high / 4
            middle = min(max(middle, low + room), high - room)
        at_middle = excess(middle)
        if at_middle <= 0:
            low, at_low = middle, at_middle
            at_high, last = (at_high / 2 if last > 0 else at_high), 1
        else:
            high, at_high = middle, at_middle
            at_low, last = (at_low / 2 if last < 0 else at_low), -1
    return low


# --- Share ------------------------------------------------------------------------------------------------------------


def _share(alone: _Alone, members: Members, samples: int) -> Share:
    """Share of points at random at which the gear fails."""
    failing = looked = 0
    bound = worst_bound(alone.base)
    for box, points in members.spread(min(samples, MOST_SAMPLES)):
        for part in chunks_of(points):
            judged = evaluate(box.at(part), alone.base.gears, alone.catalogue)
            judged = judged_by(judged, judged.used, np.broadcast_to(bound, judged.bound.shape))
            failing += int((judged.verdict != SUITABLE).sum())
            looked += len(part)
    return Share(looked, failing, upper_share(looked, failing))


def upper_share(samples: int, failing: int) -> float:
    """Upper end of a share's one-sided interval with 95 % confidence (Clopper and Pearson, Biometrika 26, 1934).

    The share at which so few failing samples have a probability of 5 %; without any about 3 / n, the rule of three.
    """
    if failing >= samples:
        return 1.0
    counts = np.arange(failing + 1)
    steps = np.log(np.maximum(samples - counts + 1, 1)) - np.log(np.maximum(counts, 1))
    steps[0] = 0.0
    ways = np.cumsum(steps)  # logarithm of the binomial coefficients
    low, high = failing / samples, 1.0
    for _ in range(MOST_STEPS):
        p = (low + high) / 2
        terms = ways + counts * math.log(p) + (samples - counts) * math.log1p(-p)
        seldom = math.log(1 - CONFIDENCE) > terms.max() + math.log(float(np.exp(terms - terms.max()).sum()))
        low, high = (low, p) if seldom else (p, high)
    return high

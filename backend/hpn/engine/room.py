"""Room of a selected gear over its tolerances: its worst case, the growth left to the tolerances, the deciding ones.

Also the share of points of the box where the gear fails, by samples, with an upper bound.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import Annotated, Any

import msgspec
import numpy as np
from msgspec import UNSET, UnsetType
from pydantic import Field

from hpn.application import Application, InputError
from hpn.application.tolerances import Deviation, Tolerance
from hpn.engine.alone import Alone
from hpn.engine.box import duty_of
from hpn.engine.evaluation import SUITABLE, evaluate, judged_by
from hpn.engine.members import SAMPLES, chunks_of
from hpn.engine.tolerance import worst_bound
from hpn.physics.equations import ROUNDING
from hpn.words.reply import Reply
from hpn.words.wording import rounded

CLOSE = 1e-9
"""Relative accuracy of the factor of growth."""

MOST_STEPS = 60

CLOSE_BY_SAMPLES, FEW_STEPS = 1e-3, 8
"""The same accuracy with all samples, which take long, and the steps of that search."""

FEW_SAMPLES = 64
"""Points that the search for growth uses where nothing is proved; its result holds at all samples."""

CONFIDENCE = 0.95

MOST_SAMPLES = 100_000


class Deciding(Reply, frozen=True):
    """One tolerance, and the utilisation of the worst case without it."""

    path: Annotated[str, Field(description="Path of the tolerance.")]
    worst: Annotated[float | None, Field(description="Worst utilisation of the selected gear with this input exact.")]


class Share(Reply, frozen=True):
    """Sampled points at which the selected gear fails."""

    samples: Annotated[
        int, Field(description="Number of sampled points, spread evenly over the tolerances, always the same.")
    ]
    failing: Annotated[int, Field(description="Number of points at which a check fails.")]
    upper: Annotated[float, Field(description="Upper bound of the share of such points, with 95 % confidence.")]


class Room(Reply, frozen=True):
    """The selected gear over the whole tolerance."""

    holds: Annotated[bool, Field(description="True: the gear passes everywhere inside the tolerances.")]
    exact: Annotated[
        bool,
        Field(
            description="True: proved. False: a check was sampled, always at the same points; a worse one may exist."
        ),
    ]
    case: Annotated[dict[str, Any], Field(description="The application at its worst corner.")]
    link: Annotated[str, Field(description="Address of the page with this case.")]
    growth: Annotated[
        float | None,
        Field(
            description="Factor by which all tolerances may grow together, at most up to the first bound of an input; "
            "below 1 if they must shrink; null without limit."
        ),
    ]
    deciding: Annotated[
        tuple[Deciding, ...],
        Field(description="Tolerances that raise the worst case, the one with the largest effect first."),
    ]
    share: (
        Annotated[Share, Field(description="Share of the points that fail, if samples were requested.")] | UnsetType
    ) = UNSET


def room_of(alone: Alone, link_of: Callable[[Application], str], samples: int = 0) -> Room:
    """Room of a selected gear, with the failing share of `samples` points."""
    whole, judged = alone.whole
    paths = list(dict.fromkeys(one.path for one in alone.intervals))
    worst, governing = judged.utilisation.item(0, 0), judged.governing.item(0, 0)
    alternatives = alone.without(paths) if paths else np.empty(0)
    box, point = whole.points[whole.at.item(governing, 0)]
    case = box.application_at(point)
    deciding = [
        Deciding(path, float(value))
        for path, value in zip(paths, alternatives.tolist(), strict=True)
        if value < worst * (1 - ROUNDING) or (math.isfinite(value) and not math.isfinite(worst))
    ]
    return Room(
        holds=alone.holds,
        exact=bool(whole.exact.all()),
        case=msgspec.json.decode(case.model_dump_json(exclude_unset=True)),
        link=link_of(case),
        growth=_growth(alone),
        deciding=tuple(sorted(deciding, key=lambda one: one.worst or 0.0)),
        share=share_of(alone, samples) if samples else UNSET,
    )


# --- Growth -----------------------------------------------------------------------------------------------------------


def allowed_of(alone: Alone, path: str) -> float | None:
    """Factor by which one tolerance may grow, or must shrink, for a gear to hold with the others as given.

    Exact where every check is proved: a larger box holds the smaller one, so its worst case is no better. None without
    a limit, and 0 where the gear fails even with this input exact.
    """
    return _growth(alone, path)


def with_tolerance(application: Application, path: str, factor: float) -> Application:
    """The application with one tolerance times a factor, rounded down to three digits."""
    tolerance = (application.tolerances or {})[path]
    return application.model_copy(
        update={"tolerances": {**(application.tolerances or {}), path: scaled(tolerance, factor)}}
    )


def scaled(tolerance: Tolerance, factor: float) -> Tolerance:
    """A tolerance times a factor, rounded down to three digits."""

    def number(value: float) -> float:
        return float(rounded(value * factor, 3, "down"))

    def side(deviation: Deviation | None) -> Deviation | None:
        return deviation and Deviation(**{name: number(value) for name, value in deviation if value is not None})

    if tolerance.minus or tolerance.plus:
        return Tolerance(minus=side(tolerance.minus), plus=side(tolerance.plus))
    return Tolerance(**{name: number(value) for name, value in tolerance if isinstance(value, float)})


def _growth(alone: Alone, path: str | None = None) -> float | None:
    """Factor by which all tolerances, or those of one path, may grow or must shrink; None without a limit."""
    intervals, holds = alone.intervals, alone.holds
    growing = [path is None or one.path == path for one in intervals]
    most = min((one.most_growth for one, grows in zip(intervals, growing, strict=True) if grows), default=math.inf)
    if not math.isfinite(most):
        return None

    def excess(factor: float, samples: int = FEW_SAMPLES) -> float:
        """Largest utilisation over its bound less 1; infinite where a check has no number."""
        try:
            changed = [one.grown(factor) if grows else one for one, grows in zip(intervals, growing, strict=True)]
            judged = alone.worst(changed, samples)
        except InputError:
            return math.inf
        if judged.verdict.item(0, 0) == SUITABLE:
            return min(float(np.nanmax(judged.used / judged.bound)) - 1, -0.0)
        used = np.where(judged.applies[:, :1], judged.used, 0.0) / judged.bound
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
    """Largest factor up to `top` at which nothing exceeds its bound; 0 if the lowest one already does."""
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


def share_of(alone: Alone, samples: int) -> Share:
    """Share of random points at which a gear fails."""
    failing = looked = 0
    bound = worst_bound(alone.base)
    for parts in chunks_of(alone.members.spread(min(samples, MOST_SAMPLES))):
        judged = evaluate(duty_of(parts), alone.base.gears, alone.catalogue)
        judged = judged_by(judged, judged.used, np.broadcast_to(bound, judged.bound.shape))
        failing += int((judged.verdict != SUITABLE).sum())
        looked += len(judged.verdict)
    return Share(looked, failing, upper_share(looked, failing))


def upper_share(samples: int, failing: int) -> float:
    """Upper end of a share's one-sided interval with 95 % confidence (Clopper and Pearson, Biometrika 26, 1934).

    The share at which so few failing samples have a probability of 5 %; for no failing sample about 3 / n, the rule of
    three.
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

"""Round numbers along an axis, and ranges of axes."""

import math
import sys
from collections.abc import Iterable

WIDENED = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
"""Factors by which axes widen for a value outside, so that a plot doesn't jump while the user types."""


def round_numbers(low: float, high: float, spaces: int) -> list[float]:
    """Multiples of 1, 2 or 5 times a power of ten from `low` to `high`, with at most `spaces` spaces between them.

    Empty if the range is too small for floating point.
    """
    if not high - low > sys.float_info.min:
        return []
    step = _round_step((high - low) / spaces)
    return [k * step for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def _round_step(rough: float) -> float:
    """Smallest round step not below a rough one."""
    scale = 10.0 ** math.floor(math.log10(rough))
    return scale * next(factor for factor in (1, 2, 5, 10) if factor >= rough / scale - 1e-9)


def widened(limit: float, values: Iterable[float]) -> float:
    """The limit times the smallest of WIDENED that covers all values; if none does, the largest value."""
    largest = max(values, default=0.0)
    return next((limit * step for step in WIDENED if largest <= limit * step), largest)

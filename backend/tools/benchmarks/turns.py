"""Turns in which the variants alternate, and their figures: medians, and ratios taken turn by turn.

The variants of one turn meet the same load of the machine, so it cancels out of their ratio.
"""

import statistics
from collections.abc import Callable, Mapping, Sequence
from itertools import combinations
from typing import TypeVar

Measured = TypeVar("Measured")


def in_turns(
    variants: Mapping[str, Callable[[int], Measured]], turns: int, *, warm_up: bool = True
) -> dict[str, list[Measured]]:
    """Measurements of each variant in each turn, every other turn in reverse order, after one turn to warm up."""
    found: dict[str, list[Measured]] = {name: [] for name in variants}
    for turn in range(0 if warm_up else 1, turns + 1):
        names = list(variants)[:: 1 if turn % 2 else -1]
        for name in names:
            measured = variants[name](turn)
            if turn:
                found[name].append(measured)
    return found


def ratios(values: Mapping[str, Sequence[float]]) -> dict[str, float]:
    """Median over the turns of the ratio of each pair of variants, such as `here_over_plain`."""
    return {
        f"{one}_over_{other}": round(
            statistics.median(a / b for a, b in zip(values[one], values[other], strict=True)), 3
        )
        for one, other in combinations(values, 2)
    }


def p95(values: Sequence[float]) -> float:
    """95th percentile."""
    return statistics.quantiles(values, n=20)[-1]

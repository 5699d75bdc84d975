"""numpy's functions as another processor may round them: roots, powers, logarithms and exponentials by one last bit.

`HPN_TEST_LAST_BITS=up` (or `down`, `mixed`) moves them in a whole run of the tests. `python -m tests.last_bits` prints
the processor's features that numpy has loops for, as NPY_DISABLE_CPU_FEATURES takes them.
"""

from collections.abc import Callable
from typing import Any, Literal, get_args

import numpy as np
import pytest

Way = Literal["up", "down", "mixed"]
WAYS: tuple[Way, ...] = get_args(Way)
FUNCTIONS = ("cbrt", "power", "log10", "exp")
"""Functions that no standard obliges to round correctly; a square root is obliged."""


def way_of(text: str) -> Way:
    """Way of a name; ValueError for another text."""
    if text not in WAYS:
        raise ValueError(f"HPN_TEST_LAST_BITS is one of {', '.join(WAYS)}, and not {text!r}")
    return text


def moved(patch: pytest.MonkeyPatch, way: Way) -> None:
    """Move the results of FUNCTIONS up, down, or by an even last bit up and else down."""
    for name in FUNCTIONS:
        patch.setattr(np, name, _moved(getattr(np, name), way))


def _moved(function: Callable[..., Any], way: Way) -> Callable[..., Any]:
    def computed(*arguments: Any, **named: Any) -> Any:
        result = np.asarray(function(*arguments, **named), dtype=np.float64)
        is_odd = result.view(np.int64) % 2 == 1
        rises = {"up": True, "down": False}.get(way, ~is_odd)
        near = np.nextafter(result, np.where(rises, np.inf, -np.inf))
        return np.where(np.isfinite(result) & (result != 0), near, result)[()]

    return computed


if __name__ == "__main__":
    print(*np.show_config(mode="dicts")["SIMD Extensions"]["found"])

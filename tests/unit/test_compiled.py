"""Compiled equations: by name, on floats and arrays, and without a place to keep what was compiled."""

import numpy as np
import pytest

from hpn.compiled import compiled, equation, over_phases


@equation
def quotient(dividend: float, divisor: float = 2.0) -> float:
    """A quotient."""
    return dividend / divisor


@over_phases("(p),(p),()->()")
def weighted_sum(value: np.ndarray, weight: np.ndarray, offset: float) -> float:
    """A sum over phases."""
    total = offset
    for k in range(value.size):
        total += value[k] * weight[k]
    return total


def test_an_equation_takes_its_arguments_by_name_alone() -> None:
    assert quotient(dividend=3.0) == 1.5
    for wrong in ({}, {"dividend": 1.0, "dividing": 2.0}):
        with pytest.raises(TypeError, match=r"quotient takes dividend, divisor by name"):
            quotient(**wrong)
    with pytest.raises(TypeError):
        quotient(3.0, 2.0)  # type: ignore[call-arg]


def test_an_equation_broadcasts_and_gives_infinity_and_nan_without_a_warning() -> None:
    table = quotient(dividend=np.array([[1], [0]]), divisor=[0, 4])

    np.testing.assert_array_equal(table, [[np.inf, 0.25], [np.nan, 0]])


def test_an_equation_over_phases_sums_along_the_last_axis() -> None:
    value = np.arange(6.0).reshape(2, 3)

    assert weighted_sum(value=value, weight=2, offset=[[0], [10]]).tolist() == [[6.0, 24.0], [16.0, 34.0]]


def test_without_a_place_for_the_cache_a_function_is_compiled_all_the_same() -> None:
    scope: dict[str, object] = {}
    exec("def double(x):\n    return 2 * x", scope)  # no file, so no place beside it
    function = scope["double"]
    assert callable(function)

    assert compiled(function)(2.0) == 4.0

"""Compiled equations: by name, on floats and arrays, and without a place to keep what was compiled."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import hpn
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


AVERAGE_TORQUE = """
from hpn.application import Application
from hpn.duty import Duty
print(Duty([Application.worked_example()]).average_torque_Nm.item())
"""


@pytest.mark.parametrize("kept", ["beside the source", "in a folder of its own"])
def test_a_changed_equation_is_computed_anew_where_other_modules_call_it(tmp_path: Path, kept: str) -> None:
    """Numba keeps compiled callers as long as their own file is the same; 18.1 of the handbook gives 32 Nm."""
    shutil.copytree(Path(hpn.__file__).parent, tmp_path / "hpn", ignore=shutil.ignore_patterns("__pycache__"))
    environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    if kept != "beside the source":
        environment["NUMBA_CACHE_DIR"] = str(tmp_path / "kept")

    def average_torque() -> float:
        command = [sys.executable, "-c", AVERAGE_TORQUE]
        return float(subprocess.check_output(command, env=environment | {"PYTHONPATH": str(tmp_path)}, text=True))

    before = average_torque()
    equations = tmp_path / "hpn/equations.py"
    text = equations.read_text()
    assert text.count("return T_max * (damage / weight) ** 0.3") == 1
    equations.write_text(text.replace("return T_max * (damage", "return 2 * T_max * (damage"))

    assert round(before, 4) == 32.0210
    assert average_torque() == 2 * before

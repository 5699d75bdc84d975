"""Every equation gives for a stack of cycles what it gives for each alone."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from hpn.physics import bearing, equations

positive = st.floats(1e-3, 1e4)
shapes = st.tuples(st.integers(1, 5), st.integers(1, 6))
# Sums over an axis may be taken in another order.
ROUNDING = 1e-13

PER_PHASE: dict[str, Callable[[Any, Any, Any], Any]] = {
    "17.2": lambda T, n, t: equations.average_output_torque(torque_Nm=T, speed_rpm=n, duration_s=t),
    "17.4": lambda T, n, t: equations.average_output_speed(speed_rpm=n, duration_s=t, pause_s=2.5),
    "rms": lambda T, n, t: equations.rms_torque(torque_Nm=T, duration_s=t, pause_s=2.5),
    "P_m": lambda T, n, t: bearing.mean_equivalent_load(equivalent_load=T, speed_rpm=n, duration_s=t),
}
PER_CYCLE: dict[str, Callable[[Any, Any], Any]] = {
    "17.5": lambda x, y: equations.average_input_speed(ratio=x, average_output_speed_rpm=y),
    "17.6": lambda x, y: equations.maximum_input_speed(ratio=x, maximum_output_speed_rpm=y),
    "17.7": lambda x, y: equations.repeated_peak_torque_utilisation(maximum_torque_Nm=x, repeated_peak_torque_Nm=y),
    "17.8": lambda x, y: equations.momentary_peak_torque_utilisation(
        emergency_stop_torque_Nm=x, momentary_peak_torque_Nm=y
    ),
    "17.9": lambda x, y: equations.allowed_momentary_peaks(emergency_stop_torque_Nm=x, repeated_peak_torque_Nm=y),
    "17.10": lambda x, y: equations.life(
        average_torque_Nm=x, average_input_speed_rpm=y, rated_torque_Nm=80, rated_input_speed_rpm=3000
    ),
    "motor": lambda x, y: equations.motor_torque(output_torque_Nm=x, ratio=y, efficiency=0.9),
    "linear": lambda x, y: bearing.linear_load(radial=x, axial=y),
    "iso281": lambda x, y: bearing.iso281_load(radial=x, axial=y),
    "k": lambda x, y: bearing.life_factor(
        average_output_speed_rpm=x, required_life_L50_h=y, reference_speed_rpm=100, reference_life_h=20000
    ),
    "L50": lambda x, y: bearing.life_L50(
        equivalent_load=x, average_output_speed_rpm=y, reference_speed_rpm=100, reference_life_h=20000
    ),
}


@given(shapes, st.data())
def test_equations_over_phases_agree_for_a_stack_and_for_each_cycle(
    shape: tuple[int, int], data: st.DataObject
) -> None:
    T, n, t = (data.draw(arrays.arrays(np.float64, shape, elements=positive)) for _ in range(3))
    for name, equation in PER_PHASE.items():
        stacked = equation(T, n, t)
        assert stacked.shape == shape[:1]
        for index in range(shape[0]):
            alone = float(equation(T[index], n[index], t[index]))
            assert math.isclose(alone, stacked[index], rel_tol=ROUNDING), name


@given(shapes, st.data())
def test_equations_of_a_cycle_agree_for_arrays_and_for_floats(shape: tuple[int, int], data: st.DataObject) -> None:
    x, y = (data.draw(arrays.arrays(np.float64, shape, elements=positive)) for _ in range(2))
    for name, equation in PER_CYCLE.items():
        table = equation(x, y)
        assert table.shape == shape
        for index in np.ndindex(shape):
            # numpy's power of an array may take another path than that of one number: the last place may differ
            assert math.isclose(float(equation(float(x[index]), float(y[index]))), table[index], rel_tol=4e-16), name

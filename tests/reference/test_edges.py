"""Equations at the edges of floating point, where the answer is known by mental arithmetic."""

import numpy as np
import pytest

from hpn import bearing, equations

POWER_AND_ROOT = 1e-14  # a power 10/3 and its root lose some tens of units of 1.1e-16


@pytest.mark.parametrize("held", [1e200, 1.0, 1e-200])
@pytest.mark.parametrize("moving", [1e100, 1e-100])
def test_what_is_held_sets_no_scale_for_what_moves(held: float, moving: float) -> None:
    """One moving phase is its own mean, whatever is held beside it; (1e-300)^(10/3) would vanish."""
    n, t = [100.0, 0.0], [2.0, 2.0]
    torque = equations.average_output_torque(torque_Nm=[moving, held], speed_rpm=n, duration_s=t)
    load = bearing.mean_equivalent_load(equivalent_load=[moving, held], speed_rpm=n, duration_s=t)

    assert float(torque) == pytest.approx(moving, rel=POWER_AND_ROOT)
    assert float(load) == pytest.approx(moving, rel=POWER_AND_ROOT)


def test_whole_numbers_are_read_as_floating_point_before_they_are_multiplied() -> None:
    """4e9 rpm for 4e9 s are 1.6e19 revolutions-per-minute seconds, more than 64 bits of an integer hold."""
    many = 4 * 10**9
    speed = equations.average_output_speed(speed_rpm=[many], duration_s=[many], pause_s=0)

    assert float(speed) == many


def test_an_equation_gives_float64_of_whole_numbers() -> None:
    for value in (
        equations.average_input_speed(ratio=5, average_output_speed_rpm=2),
        equations.maximum_input_speed(ratio=5, maximum_output_speed_rpm=2),
        bearing.linear_load(radial=1, axial=2),
        bearing.required_L50(life_h=20_000, basis="L50"),
    ):
        assert value.dtype == np.float64

"""Equations and curves where mental arithmetic knows the answer: edges of floating point, corners, wrong points."""

import numpy as np
import pytest

from hpn.physics import bearing, equations

POWER_AND_ROOT = 1e-14  # a power 10/3 and its root lose some tens of units of 1.1e-16


@pytest.mark.parametrize("held", [1e200, 1.0, 1e-200])
@pytest.mark.parametrize("moving", [1e150, 1e-150])
def test_what_is_held_sets_no_scale_for_what_moves(held: float, moving: float) -> None:
    """One moving phase is its own mean, whatever is held beside it; (1e-150)^3 would vanish."""
    n, t = [100.0, 0.0], [2e-3, 2.0]
    torque = equations.average_output_torque(torque_Nm=[moving, held], speed_rpm=n, duration_s=t)
    load = bearing.mean_equivalent_load(equivalent_load=[moving, held], speed_rpm=n, duration_s=t)

    assert float(torque) == pytest.approx(moving, rel=POWER_AND_ROOT, abs=0)
    assert float(load) == pytest.approx(moving, rel=POWER_AND_ROOT, abs=0)


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


CURVE = [(0.0, 50.0), (100.0, 0.0), (80.0, 60.0)]
"""Corners (radial, axial) in no order: from (100, 0) over (80, 60) to (0, 50)."""


@pytest.mark.parametrize(
    "point",
    [
        *((100, 0), (80, 60), (0, 50)),  # the corners
        *((90, 30), (40, 55)),  # halfway
        *((80.2, 59.4), (79.2, 59.9)),  # a hundredth of the way before and behind the middle corner
        *((99.8, 0.6), (0.8, 50.1)),  # and beside the axes
    ],
)
def test_a_load_exceeds_a_curve_by_the_factor_that_its_own_direction_says(point: tuple[float, float]) -> None:
    curve = bearing.curve_through(CURVE)
    assert (curve.radial_N.tolist(), curve.axial_N.tolist()) == ([100, 80, 0], [0, 60, 50])
    factors = np.array([0.25, 1.0, 3.0])

    P = curve.equivalent_load(factors * point[0], factors * point[1])

    assert P.dtype == np.float64
    assert P.tolist() == pytest.approx(factors.tolist(), rel=1e-13)  # a load's two products and their difference


def test_a_curve_of_two_points_is_a_straight_line() -> None:
    line = bearing.curve_through([(0, 50), (100, 0)])

    assert line.radial_N.dtype == line.axial_N.dtype == np.float64
    assert line.equivalent_load(np.array([50.0]), np.array([25.0])).tolist() == [1]


FEW = "a curve needs at least two points, one on each axis"
NO_RADIAL = "no point lies on the radial axis (axial_N 0, radial_N above 0)"
NO_AXIAL = "no point lies on the axial axis (radial_N 0, axial_N above 0)"
TWICE = "the curve is not star-shaped: two of its points lie in one direction from the origin"


@pytest.mark.parametrize(
    ("points", "index", "says"),
    [
        ([], 0, FEW),
        ([(100, 0)], 0, FEW),
        ([(0, 50), (100, 1)], 1, NO_RADIAL),
        ([(0, 50), (100, -1)], 1, NO_RADIAL),
        ([(0, 50), (0, 0)], 1, NO_RADIAL),
        ([(100, 0), (1, 50)], 1, NO_AXIAL),
        ([(-1, 50), (100, 0)], 0, NO_AXIAL),
        ([(100, 0), (1, 60), (50, 50)], 1, NO_AXIAL),
        ([(100, 0), (0, 0)], 1, NO_AXIAL),
        ([(100, 0), (0, 50), (50, 50), (40, 40)], 3, TWICE),
        ([(100, 0), (90, 0), (0, 50)], 1, TWICE),
        ([(0, 50), (100, 0), (0, 60)], 2, TWICE),
    ],
)
def test_points_that_make_no_curve_are_refused_with_the_first_wrong_one(
    points: list[tuple[float, float]], index: int, says: str
) -> None:
    with pytest.raises(bearing.CurveError) as refused:
        bearing.curve_through(points)

    assert (refused.value.index, str(refused.value)) == (index, says)


def test_a_curve_of_less_than_a_newton_is_one() -> None:
    line = bearing.curve_through([(0.5, 0), (0, 0.5)])

    assert line.equivalent_load(np.array([0.5]), np.array([0.5])).tolist() == [2]


def test_the_envelope_of_a_curve_is_the_curve_from_the_axial_axis_scaled() -> None:
    limits = {"radial_limit_N": 1.0, "axial_limit_N": 1.0}  # of no effect: the curve has its own
    radial, axial = bearing.envelope(model="digitised", curve=bearing.curve_through(CURVE), factor=0.5, **limits)

    assert (radial.tolist(), axial.tolist()) == ([0, 40, 50], [25, 30, 0])
    with pytest.raises(ValueError, match=r"^the digitised model needs the points of a printed curve$"):
        bearing.envelope(model="digitised", curve=None, factor=1, **limits)


def test_the_straight_line_has_two_corners_and_the_iso_model_a_third() -> None:
    limits = {"radial_limit_N": 100.0, "axial_limit_N": 50.0}
    line = bearing.envelope(model="linear", curve=None, factor=2, **limits)
    knee = bearing.envelope(model="iso281", curve=None, factor=2, **limits)

    assert [part.tolist() for part in line] == [[0, 200], [100, 0]]
    assert [part.tolist() for part in knee] == [[0, 200, 200], [100, pytest.approx(44, rel=1e-15), 0]]

"""Stiffness, position, impact and lever arm, against eigenvalues, time stepping and the reactions of two bearings."""

import math
from collections.abc import Callable

import mpmath
import numpy as np
import pytest
from numpy.random import default_rng
from numpy.typing import NDArray

from hpn.physics import bearing, stiffness, stop

K3_20A = 26_000.0
"""Table 15.2, in Nm/rad."""

Vector = NDArray[np.float64]


def stepped(change: Callable[[float, Vector], Vector], state: Vector, end_s: float, steps: int) -> list[Vector]:
    """States after each step of the classical Runge-Kutta method."""
    states, dt = [state], end_s / steps
    for t in (dt * np.arange(steps)).tolist():
        k1 = change(t, state)
        k2 = change(t + dt / 2, state + dt / 2 * k1)
        k3 = change(t + dt / 2, state + dt / 2 * k2)
        k4 = change(t + dt, state + dt * k3)
        state = state + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        states.append(state)
    return states


# --- Frequencies and position -----------------------------------------------------------------------------------------


def test_frequencies_are_the_eigenvalues_of_two_masses_on_a_spring() -> None:
    draws = default_rng(1)
    for _ in range(100):
        K, J, J_m = (float(10**x) for x in draws.uniform((2, -3, -6), (6, 3, 0)))
        i = float(draws.integers(3, 50))
        m = mpmath.mpf(J_m) * i**2
        matrix = mpmath.matrix([[K / m, -K / m], [-K / mpmath.mpf(J), K / mpmath.mpf(J)]])
        largest = max(mpmath.eig(matrix, left=False, right=False), key=abs)
        free = stiffness.drive_resonance(
            torsional_stiffness_Nm_per_rad=K, load_inertia_kgm2=J, ratio=i, motor_inertia_kgm2=J_m
        )
        value_held = stiffness.natural_frequency(torsional_stiffness_Nm_per_rad=K, load_inertia_kgm2=J)
        assert float(free) == pytest.approx(float(mpmath.sqrt(abs(largest)) / (2 * mpmath.pi)), rel=1e-11)
        assert value_held < free


def test_an_axis_with_and_without_a_held_motor_swings_as_worked_out_by_hand() -> None:
    value_held = stiffness.natural_frequency(torsional_stiffness_Nm_per_rad=K3_20A, load_inertia_kgm2=0.8)
    free = stiffness.drive_resonance(
        torsional_stiffness_Nm_per_rad=K3_20A, load_inertia_kgm2=0.8, ratio=5, motor_inertia_kgm2=0.0015
    )
    assert (float(value_held), float(free)) == pytest.approx((28.692, 135.593), abs=5e-4)


def test_torque_both_ways_winds_the_gear_up_twice_and_crosses_its_backlash() -> None:
    gear = {"torsional_stiffness_Nm_per_rad": K3_20A, "transmission_accuracy_arcmin": 8, "backlash_arcmin": 5}
    error = stiffness.position_error(smallest_torque_Nm=-60, largest_torque_Nm=60, **gear)
    assert float(error) == pytest.approx(28.8665, abs=5e-5)  # 8 + 120 / 26000 rad + 5
    assert float(stiffness.arc_length(angle_arcmin=error, radius_mm=250)) == pytest.approx(2.0992, abs=5e-5)
    one_way = stiffness.position_error(smallest_torque_Nm=20, largest_torque_Nm=60, **gear)
    assert float(one_way) == pytest.approx(8 + math.degrees(40 / K3_20A) * 60, rel=1e-12)


# --- Impact -----------------------------------------------------------------------------------------------------------


def test_what_the_gear_alone_catches_winds_it_up_to_its_momentary_peak_torque() -> None:
    n = float(stop.impact_speed(momentary_peak_torque_Nm=200, torsional_stiffness_Nm_per_rad=K3_20A, inertia_kgm2=0.8))
    states = stepped(lambda t, s: np.array([s[1], -K3_20A / 0.8 * s[0]]), np.array([0.0, n * math.pi / 30]), 0.02, 4000)
    assert K3_20A * max(float(twist) for twist, _ in states) == pytest.approx(200, rel=1e-6)


# --- Lever arm --------------------------------------------------------------------------------------------------------


def test_a_load_beside_the_shaft_centre_counts_as_worked_out_by_hand() -> None:
    inputs = {"radial_position_mm": 45, "axial_radius_mm": 40, "shaft_centre_mm": 21}
    assert float(bearing.radial_load_at_centre(radial_N=600, axial_N=200, **inputs)) == pytest.approx(1666.67, abs=5e-3)


def test_no_bearing_of_any_geometry_bears_more_than_under_the_equivalent_load() -> None:
    draws = default_rng(3)
    n = 200_000
    x, y, x_c, behind, between, F_R, F_A = draws.uniform(
        (-200, 0, 5, 0.1, 5, 0, 0), (200, 200, 100, 100, 300, 1e4, 1e4), (n, 7)
    ).T
    F_eq = bearing.radial_load_at_centre(
        radial_N=F_R, axial_N=F_A, radial_position_mm=x, axial_radius_mm=y, shaft_centre_mm=x_c
    )
    # Moments about the rear bearing give the front one's reaction, and the other way round; either sense of the moment.
    for moment in (F_A * y, -F_A * y):
        front = np.abs(F_R * (x + behind + between) + moment) / between
        rear = np.abs(F_R * (x + behind) + moment) / between
        assert (front <= F_eq * (x_c + behind + between) / between * (1 + 1e-12)).all()
        assert (rear <= F_eq * (x_c + behind) / between * (1 + 1e-12)).all()


def test_a_lever_without_a_known_shaft_centre_is_not_rated_but_where_nothing_acts_on_it() -> None:
    x, y, F_A = np.array([np.nan, 0, 10, np.nan, np.nan]), np.array([0, 0, 0, 5, 5.0]), np.array([9, 9, 9, 9, 0.0])
    F_eq = bearing.radial_load_at_centre(
        radial_N=100, axial_N=F_A, radial_position_mm=x, axial_radius_mm=y, shaft_centre_mm=np.nan
    )
    assert np.isnan(F_eq).tolist() == [False, False, True, True, False]

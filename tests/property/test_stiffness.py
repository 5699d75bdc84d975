"""Stiffness, position, stop and lever arm, against eigenvalues, time stepping and the reactions of two bearings."""

import math
from collections.abc import Callable

import mpmath
import numpy as np
import pytest
from numpy.random import default_rng
from numpy.typing import NDArray

from hpn.physics import bearing, stiffness, stop
from hpn.physics.stop import Brake

K3_20A = 26_000.0
"""Table 15.2, in Nm/rad."""

EXAMPLE = {"torque_Nm": 8.0, "ratio": 5.0, "motor_inertia_kgm2": 0.0015, "load_inertia_kgm2": 0.8}

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
        held = stiffness.natural_frequency(torsional_stiffness_Nm_per_rad=K, load_inertia_kgm2=J)
        assert float(free) == pytest.approx(float(mpmath.sqrt(abs(largest)) / (2 * mpmath.pi)), rel=1e-11)
        assert held < free


def test_an_axis_with_and_without_a_held_motor_swings_as_worked_out_by_hand() -> None:
    held = stiffness.natural_frequency(torsional_stiffness_Nm_per_rad=K3_20A, load_inertia_kgm2=0.8)
    free = stiffness.drive_resonance(
        torsional_stiffness_Nm_per_rad=K3_20A, load_inertia_kgm2=0.8, ratio=5, motor_inertia_kgm2=0.0015
    )
    assert (float(held), float(free)) == pytest.approx((28.692, 135.593), abs=5e-4)


def test_torque_both_ways_winds_the_gear_up_twice_and_crosses_its_backlash() -> None:
    gear = {"torsional_stiffness_Nm_per_rad": K3_20A, "transmission_accuracy_arcmin": 8, "backlash_arcmin": 5}
    error = stiffness.position_error(smallest_torque_Nm=-60, largest_torque_Nm=60, **gear)
    assert float(error) == pytest.approx(28.8665, abs=5e-5)  # 8 + 120 / 26000 rad + 5
    assert float(stiffness.arc_length(angle_arcmin=error, radius_mm=250)) == pytest.approx(2.0992, abs=5e-5)
    one_way = stiffness.position_error(smallest_torque_Nm=20, largest_torque_Nm=60, **gear)
    assert float(one_way) == pytest.approx(8 + math.degrees(40 / K3_20A) * 60, rel=1e-12)


# --- Stop by the brake ------------------------------------------------------------------------------------------------


def simulated_peak(opposing_Nm: float, *, rise_s: float = 0.0, K: float = K3_20A) -> float:
    """Largest torque in the spring between motor and load of EXAMPLE, from uniform running, without damping or loss.

    The torque at the motor passes in a line from what keeps the speed to the brake's.
    """
    J, m = EXAMPLE["load_inertia_kgm2"], EXAMPLE["ratio"] ** 2 * EXAMPLE["motor_inertia_kgm2"]
    braking = EXAMPLE["ratio"] * EXAMPLE["torque_Nm"]

    def change(t: float, state: Vector) -> Vector:
        twist, rate = state  # of the motor against the load
        share = min(t / rise_s, 1.0) if rise_s else 1.0
        motor, load = ((1 - share) * opposing_Nm - share * braking - K * twist) / m, (K * twist - opposing_Nm) / J
        return np.array([rate, motor - load])

    period = 2 * math.pi / math.sqrt(K * (1 / J + 1 / m))
    states = stepped(change, np.array([opposing_Nm / K, 0.0]), 1.1 * period + rise_s, 2000)
    return max(abs(K * float(twist)) for twist, _ in states)


@pytest.mark.parametrize(
    ("opposing_Nm", "peak_Nm", "bound_Nm"), [(12, 87.34, 87.34), (0, 76.42, 76.42), (-12, 65.49, 77.49)]
)
def test_a_step_of_the_brake_swings_to_the_stop_torque_or_stays_below_it(
    opposing_Nm: float, peak_Nm: float, bound_Nm: float
) -> None:
    simulated = simulated_peak(opposing_Nm)
    T_k = float(stop.stop_torque(brake=Brake(**EXAMPLE), opposing_torque_Nm=opposing_Nm, dynamic_factor=2))
    assert simulated == pytest.approx(peak_Nm, abs=5e-3)
    assert T_k == pytest.approx(bound_Nm, abs=5e-3)
    assert simulated <= T_k * (1 + 1e-9)


@pytest.mark.parametrize("opposing_Nm", [-30.0, -12.0, 0.0, 12.0, 30.0])
@pytest.mark.parametrize("periods", [0.1, 0.37, 0.5, 0.9, 1.5])
def test_a_brake_that_closes_slowly_stays_below_the_stop_torque_of_its_dynamic_factor(
    opposing_Nm: float, periods: float
) -> None:
    f_2 = float(
        stiffness.drive_resonance(
            torsional_stiffness_Nm_per_rad=K3_20A, load_inertia_kgm2=0.8, ratio=5, motor_inertia_kgm2=0.0015
        )
    )
    rise_s = periods / f_2
    factor = stop.dynamic_factor(rise_time_s=rise_s, drive_resonance_Hz=f_2)
    T_k = float(stop.stop_torque(brake=Brake(**EXAMPLE), opposing_torque_Nm=opposing_Nm, dynamic_factor=factor))
    assert simulated_peak(opposing_Nm, rise_s=rise_s) <= T_k * (1 + 1e-6)


def test_the_gear_loses_in_the_sense_of_the_power_as_worked_out_by_hand() -> None:
    brake = Brake(**EXAMPLE, efficiency=0.92)
    assert float(stop.deceleration(brake=brake, opposing_torque_Nm=12)) == pytest.approx(65.986, abs=5e-4)
    assert float(stop.stop_torque_at_rest(brake=brake, opposing_torque_Nm=12)) == pytest.approx(40.789, abs=5e-4)
    T_k = stop.stop_torque(brake=brake, opposing_torque_Nm=12, dynamic_factor=2)
    assert float(T_k) == pytest.approx(93.58, abs=5e-3)


@pytest.mark.parametrize("motor_inertia_kgm2", [0.0015, 1.5])
@pytest.mark.parametrize("opposing_Nm", [-20.0, 0.0, 15.0, 100.0, 400.0])
def test_power_balances_in_the_gear_whichever_side_drives(opposing_Nm: float, motor_inertia_kgm2: float) -> None:
    # Motor: i T_B + S = m a, load: T_opp - T = -J a, and the driven side gets η of what the driving one gives.
    eta, brake = 0.8, Brake(**EXAMPLE | {"motor_inertia_kgm2": motor_inertia_kgm2}, efficiency=0.8)
    a = float(stop.deceleration(brake=brake, opposing_torque_Nm=opposing_Nm))
    T_r = float(stop.stop_torque_at_rest(brake=brake, opposing_torque_Nm=opposing_Nm))
    m = EXAMPLE["ratio"] ** 2 * motor_inertia_kgm2
    at_motor = (
        m * a - EXAMPLE["ratio"] * EXAMPLE["torque_Nm"]
    )  # in the sense of the motion, as T_r keeps the load going
    assert T_r == pytest.approx(0.8 * a - opposing_Nm, rel=1e-12)
    assert -at_motor == pytest.approx(T_r * eta if T_r >= 0 else T_r / eta, rel=1e-9)
    assert (T_r < 0) == (motor_inertia_kgm2 > 1 and opposing_Nm >= 15)


def test_without_an_inertia_the_whole_torque_of_the_brake_counts() -> None:
    unknown = Brake(
        torque_Nm=8, ratio=np.array([5.0, 11.0]), motor_inertia_kgm2=np.nan, load_inertia_kgm2=0.8, efficiency=0.8
    )
    assert stop.stop_torque_at_rest(brake=unknown, opposing_torque_Nm=12).tolist() == pytest.approx([50.0, 110.0])
    course = stop.course_of_stop(
        brake=unknown, opposing_torque_Nm=0, speed_rad_per_s=20, reaction_time_s=0, rise_time_s=0
    )
    assert np.isnan([course.time_s, course.angle_rad, course.energy_J]).all()


@pytest.mark.parametrize("opposing_Nm", [-12.0, 0.0, 12.0])
def test_time_and_angle_of_a_stop_are_those_of_stepping_through_it(opposing_Nm: float) -> None:
    reaction, rise, speed = 0.02, 0.03, 26.0
    inertia = 0.8 + 25 * 0.0015

    def change(t: float, state: Vector) -> Vector:
        share = min(max((t - reaction) / rise, 0.0), 1.0)
        return np.array([state[1], -(40 * share + opposing_Nm) / inertia])

    given = {"opposing_torque_Nm": opposing_Nm, "speed_rad_per_s": speed}
    course = stop.course_of_stop(brake=Brake(**EXAMPLE), reaction_time_s=reaction, rise_time_s=rise, **given)
    last = stepped(change, np.array([0.0, speed]), float(course.time_s), 20_000)[-1]
    assert last[1] == pytest.approx(0, abs=1e-6)
    # Half the rise as dead time leaves out (a - c) t_b² / 24 of the angle.
    assert float(course.angle_rad) - last[0] == pytest.approx(40 / inertia * rise**2 / 24, rel=1e-3)


def test_a_stop_from_uniform_running_takes_the_angle_worked_out_by_hand() -> None:
    course = stop.course_of_stop(
        brake=Brake(**EXAMPLE, efficiency=0.92),
        opposing_torque_Nm=12,
        speed_rad_per_s=250 * math.pi / 30,
        reaction_time_s=0,
        rise_time_s=0,
    )
    assert math.degrees(course.angle_rad) == pytest.approx(297.56, abs=5e-3)
    assert float(course.energy_J) == pytest.approx(0.8375 * (250 * math.pi / 30) ** 2 / 2, rel=1e-12)


def test_a_load_that_stops_in_the_dead_time_or_never_is_told_apart() -> None:
    given = {"speed_rad_per_s": 2.0, "reaction_time_s": 1.0, "rise_time_s": 0.0}
    alone = stop.course_of_stop(brake=Brake(**EXAMPLE), opposing_torque_Nm=8.375, **given)
    assert (float(alone.time_s), float(alone.angle_rad), float(alone.energy_J)) == pytest.approx((0.2, 0.2, 0.0))
    never = stop.course_of_stop(brake=Brake(**EXAMPLE), opposing_torque_Nm=-50, **given)
    assert np.isinf([never.time_s, never.angle_rad]).all()


def test_the_largest_brake_torque_is_that_at_which_the_stop_torque_is_just_permissible() -> None:
    draws = default_rng(2)
    for _ in range(300):
        T_opp, eta, f = (float(x) for x in draws.uniform((-30, 0.5, 1), (30, 1, 2)))
        for brake in (Brake(**EXAMPLE, efficiency=eta), Brake(8, 5, np.nan, 0.8, eta)):
            most = stop.largest_brake_torque(
                brake=brake, opposing_torque_Nm=T_opp, dynamic_factor=f, permissible_torque_Nm=156
            )
            asked = Brake(most, 5, brake.motor_inertia_kgm2, 0.8, eta)
            T_k = stop.stop_torque(brake=asked, opposing_torque_Nm=T_opp, dynamic_factor=f)
            assert float(T_k) == pytest.approx(156, rel=1e-11)


def test_no_torque_of_the_brake_is_left_where_the_load_takes_it_all() -> None:
    """f = 2 and T_opp = 200 Nm: T_k is 200 Nm and more, above the 156 Nm that are permissible."""
    most = stop.largest_brake_torque(
        brake=Brake(**EXAMPLE), opposing_torque_Nm=200.0, dynamic_factor=2.0, permissible_torque_Nm=156.0
    )
    assert float(most) == 0


def test_a_load_that_pushes_a_heavy_motor_on_still_winds_the_gear_up() -> None:
    """m = 37.5, J = 0.8 kgm², T_opp = 100 Nm: T_r = 0.8 · 140 / 38.3 - 100 = -97.1 Nm, and T_k = 2 · 97.1 + 100."""
    heavy = Brake(**EXAMPLE | {"motor_inertia_kgm2": 1.5})
    T_k = float(stop.stop_torque(brake=heavy, opposing_torque_Nm=100.0, dynamic_factor=2.0))
    assert T_k == pytest.approx(2 * (100 - 0.8 * 140 / 38.3) + 100, rel=1e-12)


def test_what_the_gear_alone_catches_winds_it_up_to_its_momentary_peak_torque() -> None:
    n = float(stop.impact_speed(momentary_peak_torque_Nm=200, torsional_stiffness_Nm_per_rad=K3_20A, inertia_kgm2=0.8))
    states = stepped(lambda t, s: np.array([s[1], -K3_20A / 0.8 * s[0]]), np.array([0.0, n * math.pi / 30]), 0.02, 4000)
    assert K3_20A * max(float(twist) for twist, _ in states) == pytest.approx(200, rel=1e-6)


# --- Lever arm --------------------------------------------------------------------------------------------------------


def test_a_load_beside_the_shaft_centre_counts_as_worked_out_by_hand() -> None:
    given = {"radial_position_mm": 45, "axial_radius_mm": 40, "shaft_centre_mm": 21}
    assert float(bearing.radial_load_at_centre(radial_N=600, axial_N=200, **given)) == pytest.approx(1666.67, abs=5e-3)


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

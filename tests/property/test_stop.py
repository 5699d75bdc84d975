"""Torque and course of a stop by the brake: what the bounds come to, how they grow, and their inverses."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.random import default_rng

from hpn.physics.stop import (
    BrakeFigures,
    LoadTorques,
    Play,
    course_of_stop,
    is_held,
    is_stopped,
    largest_brake_torque,
    largest_load_inertia,
    settled_torque,
    stop_torque,
)

GEAR = Play(26_000.0, 5 / 10_800 * np.pi)
"""20A-5: table 15.2 and table 15.1."""

brakes = st.builds(
    BrakeFigures,
    torque_Nm=st.floats(0.5, 50),
    ratio=st.sampled_from([3.0, 5.0, 25.0]),
    motor_inertia_kgm2=st.floats(1e-5, 1e-2),
    load_inertia_kgm2=st.floats(1e-3, 10),
    efficiency=st.floats(0.5, 1),
)
loads = st.builds(
    lambda T_d, share, more: LoadTorques(T_d, T_d * share, T_d + more),
    st.floats(0, 100),
    st.floats(0, 1),
    st.floats(0, 100),
)
factors = st.one_of(st.just(np.nan), st.floats(1, 10))


def torque(brake: BrakeFigures, load: LoadTorques, f: float = np.nan) -> float:
    return stop_torque(brake=brake, load=load, gear=GEAR, dynamic_factor=f).item()


@given(brakes, loads)
def test_the_torque_is_that_of_a_flank_let_go_a_gap_crossed_and_a_swing_about_the_other(
    brake: BrakeFigures, load: LoadTorques
) -> None:
    """Work on the spring, times 2 K3: of T_r along the one flank and the gap, and what T_o had stored in the flank."""
    T_k, T_r = torque(brake, load), settled_torque(brake=brake, load=load).item()
    m, J, eta = brake.motor_at_output_kgm2.item(), float(brake.load_inertia_kgm2), float(brake.efficiency)
    T_o = float(load.opposing_Nm)
    wound = (T_k - T_r) ** 2 - T_r**2
    given_up = 2 * T_r * (T_o + GEAR.crossed_Nm.item()) + (m + J / eta) / (m + eta * J) * T_o**2
    assert wound == pytest.approx(given_up, rel=1e-9, abs=1e-9 * T_k**2)
    assert T_k >= 2 * T_r
    assert T_k >= T_o


@given(brakes, loads, factors)
def test_a_harder_brake_and_a_heavier_pull_never_lower_the_torque(
    brake: BrakeFigures, load: LoadTorques, f: float
) -> None:
    T_k = torque(brake, load, f)
    harder = replace(brake, torque_Nm=float(brake.torque_Nm) * 1.1)
    pulled = LoadTorques(float(load.pulling_Nm) * 1.1, load.driving_Nm, float(load.opposing_Nm) * 1.1)
    assert torque(harder, load, f) >= T_k * (1 - 1e-12)
    assert torque(brake, pulled, f) >= T_k * (1 - 1e-12)


@given(brakes, loads, factors, st.floats(5, 500))
def test_the_largest_brake_torque_has_its_stop_at_the_limit_or_there_is_none(
    brake: BrakeFigures, load: LoadTorques, f: float, limit_Nm: float
) -> None:
    for known in (brake, replace(brake, motor_inertia_kgm2=np.nan)):
        largest = largest_brake_torque(
            brake=known, load=load, gear=GEAR, dynamic_factor=f, permissible_torque_Nm=limit_Nm
        ).item()
        weakest = replace(known, torque_Nm=float(load.driving_Nm) / float(known.ratio) * (1 + 1e-9))
        at_most = replace(known, torque_Nm=largest)
        if largest == 0:
            assert torque(weakest, load, f) > limit_Nm * (1 - 1e-6)
            continue
        assert is_stopped(brake=at_most, load=load)
        assert torque(at_most, load, f) == pytest.approx(limit_Nm, rel=1e-9)


@given(brakes, loads, factors, st.floats(5, 500))
def test_the_largest_inertia_is_where_bisection_finds_it(
    brake: BrakeFigures, load: LoadTorques, f: float, limit_Nm: float
) -> None:
    found = largest_load_inertia(
        brake=brake, load=load, gear=GEAR, dynamic_factor=f, permissible_torque_Nm=limit_Nm
    ).item()

    def passes(J: float) -> bool:
        return torque(replace(brake, load_inertia_kgm2=J), load, f) <= limit_Nm

    if not is_held(brake=brake, load=load):
        assert np.isnan(found)
        return
    low, high = 1e-9, 1e9
    if not passes(low):
        assert found <= low * (1 + 1e-9)
        return
    if passes(high):
        assert found >= high * (1 - 1e-3)
        return
    while high > low * (1 + 1e-13):
        middle = np.sqrt(low * high)
        low, high = (middle, high) if passes(middle) else (low, middle)
    # Where the torque hardly grows with J the inertia hangs on its last digits; the torque does not.
    assert torque(replace(brake, load_inertia_kgm2=found), load, f) == pytest.approx(limit_Nm, rel=1e-11)
    assert found == pytest.approx(low, rel=1e-3)


def test_the_torque_rises_with_the_inertia_of_the_load_where_the_brake_holds_it() -> None:
    draws = default_rng(3)
    for _ in range(200):
        i_T_B, T_d, more, eta = draws.uniform((5, 0, 0, 0.5), (200, 1, 50, 1)).tolist()
        load = LoadTorques(i_T_B * T_d, 0.0, i_T_B * T_d + more)
        torques = [
            torque(BrakeFigures(i_T_B / 5, 5, 0.0015, J, eta), load) for J in np.geomspace(1e-4, 1e3, 20).tolist()
        ]
        assert all(after >= before * (1 - 1e-12) for before, after in pairwise(torques))


def test_without_an_inertia_the_whole_torque_of_the_brake_counts_or_what_pulls() -> None:
    """i T_B / η = 50 and 110 Nm against 80 Nm that pull."""
    brake = BrakeFigures(8, np.array([5.0, 11.0]), np.nan, 0.8, 0.8)
    settled = settled_torque(brake=brake, load=LoadTorques(80.0, 80.0, 80.0))
    assert settled.tolist() == pytest.approx([80.0, 110.0])
    course = course_of_stop(
        brake=brake,
        load=LoadTorques(),
        gear=GEAR,
        stop_torque_Nm=100.0,
        speed_rad_per_s=20,
        reaction_time_s=0,
        rise_time_s=0,
    )
    assert np.isnan([course.time_s, course.angle_rad, course.energy_J]).all()


def test_a_load_that_the_brake_does_not_stop_has_neither_time_nor_angle() -> None:
    brake, load = BrakeFigures(8, 5, 0.0015, 0.8), LoadTorques(50.0, 40.0, 50.0)
    course = course_of_stop(
        brake=brake,
        load=load,
        gear=GEAR,
        stop_torque_Nm=torque(brake, load),
        speed_rad_per_s=20,
        reaction_time_s=0,
        rise_time_s=0,
    )
    assert not is_stopped(brake=brake, load=load)
    assert np.isinf([course.time_s, course.angle_rad, course.energy_J]).all()

"""Torques at the motor along a motion, its own inertia included, against mpmath; and the checks of the motor."""

import math
from typing import Any

import pytest
from mpmath import mp, mpf

from hpn.catalogue import Catalogue
from tests.build import Json, answer, candidate, check, cycle, notices, phase
from tests.conftest import Supplement
from tests.reference import motion as reference
from tests.reference.test_motion import CONTRACT, PENDULUM, SCREW, VISCOUS

CLOSE = 1e-9
MOTOR_INERTIA = 4e-3
PAUSE = 0.7


def at_motor(one: reference.Stretch, ratio: int, eta: float) -> Any:
    """Torque at the motor as a function of time."""
    middle = (one.start + one.end) / 2
    drives = one.torque(middle) * one.speed(middle) >= 0
    factor = 1 / (ratio * mpf(eta)) if drives else mpf(eta) / ratio
    return lambda t: one.torque(t) * factor + mpf(MOTOR_INERTIA) * ratio * one.acceleration(t)


def square_of(one: reference.Stretch) -> Any:
    """Integral of the square of the torque."""
    return one.integral(lambda t: one.torque(t) ** 2)


def expected(motion: Json, ratio: int, eta: float) -> tuple[float, float]:
    """Peak and RMS torque at the motor."""
    peak, squares, time = mpf(0), mpf(0), mpf(PAUSE)
    for one in reference.stretches(motion):
        torque = at_motor(one, ratio, eta)
        part = reference.Stretch(one.move, one.start, one.end, one.kinks, torque, one.speed, one.acceleration)
        peak = max(peak, reference.peak(part))
        squares += square_of(part)
        time += one.end - one.start
    return float(peak), float(mp.sqrt(squares / time))


@pytest.mark.parametrize(("motion", "ratio"), [(CONTRACT, 4), (PENDULUM, 15), (SCREW, 4), (VISCOUS, 15)])
def test_torques_at_the_motor_are_those_that_mpmath_integrates(
    motion: Json, ratio: int, soak: bool, catalogue: Catalogue
) -> None:
    document = {"efficiency": 0.85, "motor": {"inertia_kgm2": MOTOR_INERTIA}, "sizes": ["20A"], "ratios": [4, 15]}
    reply = answer({"duty_cycle": {"motion": motion, "pause_s": PAUSE}, "requirements": document}, catalogue)

    for each in (4, 15) if soak else (ratio,):
        gear = candidate(reply, f"HPN-20A-{each}")
        peak, rms = expected(motion, each, 0.85)
        assert math.isclose(gear["motor_peak_torque_Nm"], peak, rel_tol=CLOSE)
        assert math.isclose(gear["motor_rated_torque_Nm"], rms, rel_tol=CLOSE)
    assert "motor_inertia_included" in notices(reply)
    assert gear["reserve"]["torque_factor"] is not None  # no limit is asked of the motor's torque


def test_a_motor_that_speeds_up_a_table_bears_its_own_inertia_and_brakes_with_the_losses(catalogue: Catalogue) -> None:
    """2 kgm² at 10 rad/s², i = 5, η = 0.8, J_m = 0.02: 20/4 + 1 up, and 20 · 0.8/5 + 1 down, by hand; 1 s of pause."""
    table = {"type": "rotary", "inertia_kgm2": 2}
    moves = [{"profile": "triangular", "angle_deg": math.degrees(10), "acceleration_deg_per_s2": math.degrees(10)}]
    motor = {"inertia_kgm2": 0.02, "peak_torque_Nm": 12, "rated_torque_Nm": 4, "rated_speed_rpm": 400}
    document = {"sizes": ["20A"], "ratios": [5], "efficiency": 0.8, "motor": motor | {"inertia_ratio": 4}}
    cycle_ = {"motion": {"mechanism": table, "moves": moves}, "pause_s": 1}
    reply = answer({"duty_cycle": cycle_, "requirements": document, "rank_by": "motor_torque"}, catalogue)
    gear = candidate(reply, "HPN-20A-5")

    assert math.isclose(gear["motor_peak_torque_Nm"], 6, rel_tol=1e-12)
    assert math.isclose(gear["motor_rated_torque_Nm"], math.sqrt((6**2 + 4.2**2) / 3), rel_tol=1e-12)
    assert math.isclose(check(reply, "HPN-20A-5", "motor_peak_torque")["demand"], 6, rel_tol=1e-12)
    mean = 10 / 3 * 30 / math.pi * 5  # 10 rad in 3 s with the pause
    assert math.isclose(check(reply, "HPN-20A-5", "motor_rated_speed")["demand"], mean, rel_tol=1e-12)
    assert math.isclose(check(reply, "HPN-20A-5", "inertia_ratio")["utilisation"], 1, rel_tol=1e-12)
    assert gear["reserve"]["torque_factor"] is None  # no closed form follows a torque with a part of its own


def test_without_its_inertia_the_motor_has_the_torque_over_ratio_and_efficiency_as_before(catalogue: Catalogue) -> None:
    document = {"efficiency": 0.9, "motor": {"peak_torque_Nm": 50}}
    reply = answer({"duty_cycle": {"motion": CONTRACT}, "requirements": document}, catalogue)
    inertia = {"load_inertia_kgm2": reply["duty"]["load_inertia_kgm2"]}
    typed = answer({"duty_cycle": {"phases": reply["duty"]["phases"]}, "requirements": document | inertia}, catalogue)

    assert reply["candidates"] == typed["candidates"]
    assert "motor_torque_partial" in notices(reply)


def test_a_motors_inertia_without_a_motion_changes_no_torque(catalogue: Catalogue) -> None:
    phases = cycle(phase(40, 100), phase(-20, 50, 2))
    motor = {"peak_torque_Nm": 50.0}
    one = answer(phases | {"requirements": {"motor": motor}}, catalogue)
    other = answer(phases | {"requirements": {"motor": motor | {"inertia_kgm2": 0.5}}}, catalogue)

    assert [stopped(gear) for gear in one["candidates"]] == [stopped(gear) for gear in other["candidates"]]
    assert (one["notices"], one["duty"]) == (other["notices"], other["duty"])


def stopped(gear: Json) -> Json:
    """A candidate without the one figure that a motor's inertia alone gives."""
    return {name: value for name, value in gear.items() if name != "end_stop_speed_rpm"}


def test_an_efficiency_curve_is_read_phase_by_phase_with_the_motors_inertia_too(supplemented: Supplement) -> None:
    """The table from above under a curve of η = 0.8 at 20 Nm: what a stated 0.8 gives, on that gear alone."""
    table = {"type": "rotary", "inertia_kgm2": 2}
    moves = [{"profile": "triangular", "angle_deg": math.degrees(10), "acceleration_deg_per_s2": math.degrees(10)}]
    document = {"sizes": ["20A"], "ratios": [4, 5], "motor": {"inertia_kgm2": 0.02}}
    curve = "size,ratio,torque_Nm,efficiency,source\n20A,5,10,0.7,\n20A,5,30,0.9,\n"
    application = {"duty_cycle": {"motion": {"mechanism": table, "moves": moves}}, "requirements": document}
    reply = answer(application, supplemented(efficiency=curve))

    assert math.isclose(candidate(reply, "HPN-20A-5")["motor_peak_torque_Nm"], 6, rel_tol=1e-12)
    assert math.isclose(candidate(reply, "HPN-20A-4")["motor_peak_torque_Nm"], 5.8, rel_tol=1e-12)  # 20/4 + 0.8

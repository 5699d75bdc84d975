"""Phases in which torque and speed vary: a mean, a peak and an RMS each."""

import math
from typing import Any

import pytest

from hpn.catalogue import Catalogue
from tests.build import Json, answer, candidate, cycle, notices, phase
from tests.conftest import Supplement
from tests.unit.test_application import refused

GEAR = {"sizes": ["20A"], "ratios": [5]}
VARYING = phase(-30, 100, 2, peak_torque_Nm=70, peak_speed_rpm=260, rms_torque_Nm=40)


def test_peaks_and_RMS_count_where_they_belong_and_the_means_elsewhere(catalogue: Catalogue) -> None:
    load = {"radial_N": 500.0}
    steady = cycle(phase(30, 100, 2), phase(20, 50, 1), pause_s=1, output_load=load, requirements=GEAR)
    varying = cycle(VARYING, phase(20, 50, 1), pause_s=1, output_load=load, requirements=GEAR)
    one, other = answer(steady, catalogue), answer(varying, catalogue)

    for name in ("average_torque_Nm", "average_output_speed_rpm"):
        assert one["duty"][name] == other["duty"][name]
    assert (other["duty"]["maximum_torque_Nm"], other["duty"]["maximum_output_speed_rpm"]) == (70, 260)
    gear, its = candidate(one, "HPN-20A-5"), candidate(other, "HPN-20A-5")
    for name in ("average_input_speed_rpm", "life_L10_h", "bearing_life_L50_h"):
        assert gear[name] == its[name]
    assert (its["maximum_input_speed_rpm"], its["motor_peak_torque_Nm"]) == (1300, 14)
    assert math.isclose(its["motor_rated_torque_Nm"], math.sqrt((40**2 * 2 + 20**2) / 4) / 5, rel_tol=1e-15)


def test_a_held_phase_has_a_peak_and_an_RMS_and_no_weight(catalogue: Catalogue) -> None:
    value_held = phase(0, 0, 1, peak_torque_Nm=90, rms_torque_Nm=60)
    reply = answer(cycle(phase(10, 100, 1), value_held, requirements=GEAR), catalogue)

    assert reply["duty"]["average_torque_Nm"] == pytest.approx(10, rel=1e-12)
    assert reply["duty"]["maximum_torque_Nm"] == 90
    rated = candidate(reply, "HPN-20A-5")["motor_rated_torque_Nm"]
    assert math.isclose(rated, math.sqrt((10**2 + 60**2) / 2) / 5, rel_tol=1e-15)


def test_figures_of_a_steady_phase_that_are_given_change_not_a_bit(catalogue: Catalogue) -> None:
    plain = [phase(-40.3, 251.7, 0.31), phase(32.1, -500.9, 3.07), phase(19.9, 0, 0.41)]
    values = [
        entry | {"peak_torque_Nm": abs(entry["torque_Nm"]), "rms_torque_Nm": abs(entry["torque_Nm"])} for entry in plain
    ]
    for entry in values:
        entry["peak_speed_rpm"] = abs(entry["speed_rpm"])
    wishes = {"motor": {"peak_torque_Nm": 9, "rated_torque_Nm": 5}}
    one, other = (answer(cycle(*phases, pause_s=1.3, requirements=wishes), catalogue) for phases in (plain, values))

    assert one == other


@pytest.mark.parametrize(
    ("changes", "field", "message"),
    [
        ({"peak_torque_Nm": 39.9}, "peak_torque_Nm", "40"),
        ({"peak_speed_rpm": 249}, "peak_speed_rpm", "250"),
        ({"rms_torque_Nm": 40.1}, "rms_torque_Nm", "40"),
        ({"peak_torque_Nm": 50, "rms_torque_Nm": 50.1}, "rms_torque_Nm", "50"),
        ({"speed_rpm": 0, "peak_speed_rpm": 1}, "peak_speed_rpm", "speed 0"),
        ({"peak_torque_Nm": -50}, "peak_torque_Nm", "0"),
        ({"rms_torque_Nm": 2e6}, "rms_torque_Nm", "1000000"),
        ({"peak_speed_rpm": "250"}, "peak_speed_rpm", "number"),
    ],
)
def test_a_contradiction_is_refused_where_it_stands(changes: Json, field: str, message: str) -> None:
    errors = refused(cycle(phase(1, 1), phase(-40, 250) | changes))
    assert list(errors) == [("duty_cycle", "phases", 1, field)]
    assert message in errors["duty_cycle", "phases", 1, field]


def test_the_bounds_have_room_for_rounding(catalogue: Catalogue) -> None:
    tight = {"peak_torque_Nm": 40 * (1 - 0.9e-9), "rms_torque_Nm": 40.0, "peak_speed_rpm": 250 * (1 - 0.9e-9)}
    answer(cycle(phase(-40, 250) | tight), catalogue)
    for name, value in (("peak_torque_Nm", 40 * (1 - 1.1e-9)), ("rms_torque_Nm", 40 * (1 + 1.1e-9))):
        assert refused(cycle(phase(-40, 250) | {name: value}))


def test_an_efficiency_curve_is_read_at_the_peak_for_the_peak_and_at_the_RMS_for_the_RMS(
    supplemented: Supplement,
) -> None:
    curve = "size,ratio,torque_Nm,efficiency,source\n20A,5,20,0.7,\n20A,5,80,0.9,\n"
    question: dict[str, Any] = {"requirements": GEAR | {"motor": {"peak_torque_Nm": 99}}}
    reply = answer(
        cycle(phase(30, 100, 1, peak_torque_Nm=74, rms_torque_Nm=50), **question), supplemented(efficiency=curve)
    )

    # 0.7 + 0.2 · 54/60 = 0.88 and 0.7 + 0.2 · 30/60 = 0.8, by hand
    gear = candidate(reply, "HPN-20A-5")
    assert math.isclose(gear["motor_peak_torque_Nm"], 74 / (5 * 0.88), rel_tol=1e-14)
    assert math.isclose(gear["motor_rated_torque_Nm"], 50 / (5 * 0.8), rel_tol=1e-14)
    assert "efficiency_beyond_curve" not in notices(reply)

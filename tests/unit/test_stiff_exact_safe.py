"""Stiffness, position error and lever arm, as an application asks for them, and what it cannot ask."""

import math
from typing import Any

import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.notices import ON_MOTOR_TORQUES, on_motor_torques
from hpn.engine.remedy import alternatives_of
from hpn.engine.selection import select
from hpn.engine.tried import tried
from tests.build import Json, answer, candidate, check, cycle, notices, phase
from tests.conftest import Supplement
from tests.unit.test_brake_stops import BOTH_WAYS, GEAR, INERTIAS, braking, crane, refused


def asking(**requirements: Any) -> Json:
    return BOTH_WAYS | {"requirements": {"ratios": [5]} | requirements}


# --- Stiffness and position -------------------------------------------------------------------------------------------


def test_every_candidate_has_its_frequencies_and_its_position_error(catalogue: Catalogue) -> None:
    gear = candidate(answer(asking(**INERTIAS, position_radius_mm=250), catalogue), GEAR)

    assert gear["natural_frequency_Hz"] == pytest.approx(28.692, abs=5e-4)
    assert gear["drive_resonance_Hz"] == pytest.approx(135.593, abs=5e-4)
    assert gear["wind_up_arcmin"] == pytest.approx(math.degrees(60 / 26_000) * 60, rel=1e-12)
    assert gear["position_error_arcmin"] == pytest.approx(28.8665, abs=5e-5)
    assert gear["position_error_mm"] == pytest.approx(2.0992, abs=5e-5)


def test_without_an_inertia_of_the_load_no_frequency_is_invented(catalogue: Catalogue) -> None:
    gear = candidate(answer(BOTH_WAYS, catalogue), GEAR)

    assert [gear[name] for name in ("natural_frequency_Hz", "drive_resonance_Hz", "position_error_mm")] == [None] * 3


@pytest.mark.parametrize(
    ("phases", "pause_s", "reverses", "span_Nm", "backlash", "has_notice"),
    [
        ([40, 20], 0, None, 80, True, True),  # magnitudes: either way
        ([40, 20], 0, False, 20, False, False),
        ([40, 20], 1, False, 40, True, False),  # the pause is a torque of 0
        ([40, -20], 0, None, 60, True, False),
        ([40, -20], 0, True, 80, True, False),
        ([-40, -20], 0, None, 20, False, False),
    ],
)
def test_the_position_error_goes_by_the_torques_between_which_the_gear_winds_up(
    catalogue: Catalogue,
    phases: list[float],
    pause_s: float,
    reverses: bool | None,
    span_Nm: float,
    backlash: bool,
    has_notice: bool,
) -> None:
    question = {} if reverses is None else {"load_reverses": reverses}
    reply = answer(cycle(*(phase(T, 100) for T in phases), pause_s=pause_s, requirements=question), catalogue)
    error = candidate(reply, GEAR)["position_error_arcmin"]

    assert error == pytest.approx(8 + math.degrees(span_Nm / 26_000) * 60 + 5 * backlash, rel=1e-12)
    assert ("torque_signs_not_given" in notices(reply)) == has_notice


def test_a_gear_that_is_too_soft_gives_way_to_the_next_and_says_which_inertia_it_would_bear(
    catalogue: Catalogue,
) -> None:
    question = asking(load_inertia_kgm2=0.8, natural_frequency_Hz=30)
    reply = answer(question, catalogue)
    result = check(reply, GEAR, "natural_frequency")

    assert (result["status"], result["limit"]) == ("fail", 30)
    assert result["utilisation"] == pytest.approx(30 / 28.692, rel=1e-4)
    assert reply["selected"] == "HPN-32A-5"
    most = candidate(reply, GEAR)["reserve"]["load_inertia_kgm2"]
    assert most == pytest.approx(26_000 / (2 * math.pi * 30) ** 2, rel=1e-12)


@pytest.mark.parametrize(
    "inputs", [{"position_error_arcmin": 20}, {"position_error_mm": 1.5, "position_radius_mm": 250}]
)
def test_a_position_error_is_judged_as_an_angle_and_its_remedy_holds(catalogue: Catalogue, inputs: Json) -> None:
    application = Application.model_validate(asking(**inputs))
    gear = select(application, catalogue).candidate(GEAR)
    assert gear is not None
    [result] = gear.failing
    assert result.code == "position_error"
    [alternative] = alternatives_of(gear)
    mended = select(tried(application, alternative, catalogue), catalogue).candidate(GEAR)
    assert mended is not None and mended.status == "suitable"


def test_gears_are_ranked_by_frequency_and_by_position_error(catalogue: Catalogue) -> None:
    for rank_by, figure, sign in (("natural_frequency", "natural_frequency_Hz", -1), ("position_error",) * 2 + (1,)):
        name = figure if figure.endswith("Hz") else "position_error_arcmin"
        reply = answer(asking(load_inertia_kgm2=0.8) | {"rank_by": rank_by}, catalogue)
        ranked = [gear[name] for gear in reply["candidates"] if gear["rank"]]
        assert ranked == sorted(ranked, reverse=sign < 0)


# --- Lever arm --------------------------------------------------------------------------------------------------------

LOADED = {"radial_N": 600, "axial_N": 200, "radial_position_mm": 45, "axial_radius_mm": 40}


def test_a_load_beside_the_shafts_centre_counts_with_its_lever(catalogue: Catalogue) -> None:
    reply = answer(BOTH_WAYS | {"output_load": LOADED | {"shaft_centre_mm": 21}}, catalogue)
    result = check(reply, GEAR, "output_bearing_load")

    assert (result["status"], result["demand"]) == ("fail", pytest.approx(1.0168, abs=5e-5))
    assert "bearing_lever" in notices(reply) and "bearing_load_position" not in notices(reply)


def test_without_the_shafts_centre_its_bearing_is_not_rated(catalogue: Catalogue) -> None:
    reply = answer(BOTH_WAYS | {"output_load": LOADED}, catalogue)

    assert check(reply, GEAR, "output_bearing_load")["status"] == "not_rated"
    assert "HPN-20A" in notices(reply)["bearing_centre_unknown"]


def test_a_shafts_centre_of_the_supplement_goes_before_the_one_that_is_given(supplemented: Supplement) -> None:
    columns = "size,maximum_input_speed_rpm,average_input_speed_rpm,ambient_temperature_minimum_degC,"
    columns += (
        "ambient_temperature_maximum_degC,dynamic_radial_load_N,dynamic_axial_load_N,shaft_centre_mm,note,source\n"
    )
    catalogue = supplemented(sizes=columns + "20A,,,,,,,30,,drawing\n")
    load = BOTH_WAYS | {"output_load": LOADED | {"shaft_centre_mm": 21}}
    radial, axial = (
        catalogue.by_designation[GEAR].dynamic_radial_load_N,
        catalogue.by_designation[GEAR].dynamic_axial_load_N,
    )
    assert radial and axial

    by_own = (600 * 45 / 30 + 200 * 40 / 30) / radial + 200 / axial
    assert check(answer(load, catalogue), GEAR, "output_bearing_load")["demand"] == pytest.approx(by_own, rel=1e-12)


# --- The gear's own inertia and torque without load -------------------------------------------------------------------


def test_a_supplements_inertia_and_torque_without_load_enter_the_motors_figures(supplemented: Supplement) -> None:
    columns = "size,ratio,stages,inertia_kgm2,no_load_torque_Nm,source\n"
    catalogue = supplemented(gears=columns + "20A,5,1,0.0005,0.3,measured\n")
    question = asking(
        load_inertia_kgm2=0.8,
        motor={"inertia_kgm2": 0.0015, "inertia_ratio": 100, "peak_torque_Nm": 50, "rated_torque_Nm": 50},
    )
    reply = answer(question, catalogue)
    gear = candidate(reply, GEAR)

    assert check(reply, GEAR, "inertia_ratio")["demand"] == pytest.approx((0.8 / 25 + 0.0005) / 0.0015, rel=1e-12)
    assert gear["motor_peak_torque_Nm"] == pytest.approx(12.3, rel=1e-12)
    assert gear["motor_rated_torque_Nm"] == pytest.approx(12.3, rel=1e-12)
    m = 25 * 0.002
    expected = math.sqrt(26_000 * (1 / 0.8 + 1 / m)) / (2 * math.pi)
    assert gear["drive_resonance_Hz"] == pytest.approx(expected, rel=1e-12)


def test_notice_and_report_say_what_of_a_supplement_the_motor_torques_include(supplemented: Supplement) -> None:
    move = {"profile": "triangular", "angle_deg": 90.0, "time_s": 0.5}
    motion = {"mechanism": {"type": "rotary", "inertia_kgm2": 0.8}, "moves": [move]}
    motor = {"motor": {"inertia_kgm2": 0.0015, "peak_torque_Nm": 50}, "sizes": ["20A"], "ratios": [5]}
    moving = {"duty_cycle": {"motion": motion}, "requirements": motor}
    for cells, still, turning in (
        ("0.0005,0.3", "motor_losses_included", "motor_all_included"),
        (",0.3", "motor_losses_included", "motor_inertia_included"),
        ("0.0005,", "motor_torque_partial", "motor_inertia_included"),
    ):
        rows = f"size,ratio,stages,inertia_kgm2,no_load_torque_Nm,source\n20A,5,1,{cells},measured\n"
        catalogue = supplemented(gears=rows)
        for application, code in ((asking(**motor), still), (moving, turning)):
            selection = select(Application.model_validate(application), catalogue)
            values = [one for one in selection.notices if one.code in ON_MOTOR_TORQUES]
            assert [one.code for one in values] == [code]
            assert on_motor_torques(selection.notices) == values[0].sentence


# --- Bad input --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("application", "place", "message"),
    [
        (asking(natural_frequency_Hz=25), "requirements.natural_frequency_Hz", "needs a motion"),
        (asking() | {"rank_by": "natural_frequency"}, "rank_by", "needs a motion"),
        (asking(position_error_mm=1), "requirements.position_error_mm", "needs the radius"),
        (
            asking(position_error_mm=1, position_error_arcmin=1, position_radius_mm=9),
            "requirements.position_error_mm",
            "not both",
        ),
        (asking(load_reverses=1), "requirements.load_reverses", "boolean"),
        (BOTH_WAYS | {"emergency_stop": {"count": 3}}, "emergency_stop.torque_Nm", "brake"),
        (
            BOTH_WAYS | {"emergency_stop": {"torque_Nm": 9, "brake": {"torque_Nm": 8}}},
            "emergency_stop.brake",
            "not both",
        ),
        (BOTH_WAYS | {"emergency_stop": {"brake": {}}}, "emergency_stop.brake.torque_Nm", "required"),
        (crane({"torque_Nm": 8, "load_torque_Nm": 1}, [5]), "emergency_stop.brake.load_torque_Nm", "motion"),
        (crane({"torque_Nm": 8, "opposing_torque_Nm": 1}, [5]), "emergency_stop.brake.opposing_torque_Nm", "motion"),
        (
            braking({"torque_Nm": 8, "load_torque_Nm": 2, "opposing_torque_Nm": 1}),
            "emergency_stop.brake.opposing_torque_Nm",
            "load_torque_Nm",
        ),
        (braking({"torque_Nm": 8, "load_torque_Nm": -1}), "emergency_stop.brake.load_torque_Nm", "0"),
        (braking({"torque_Nm": 8, "rise_time_s": -1}), "emergency_stop.brake.rise_time_s", "0"),
        (braking({"torque_Nm": 8, "dynamic_factor": 0.9}), "emergency_stop.brake.dynamic_factor", "1"),
        (BOTH_WAYS | {"output_load": {"radial_N": 9, "axial_radius_mm": -1}}, "output_load.axial_radius_mm", "0"),
        (BOTH_WAYS | {"output_load": {"radial_N": 9, "shaft_centre_mm": 0}}, "output_load.shaft_centre_mm", "0"),
    ],
)
def test_a_question_that_can_not_be_answered_is_refused_at_its_field(
    application: Json, place: str, message: str
) -> None:
    errors = refused(application)
    assert place in errors, errors
    assert message in errors[place]

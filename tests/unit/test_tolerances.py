"""Tolerances of an application: which inputs take one, and every point of the box an application."""

import pytest
from pydantic import ValidationError

from hpn.application import Application, InputError
from hpn.application.faults import faults_of
from hpn.application.input_fields import takes_tolerance
from hpn.catalogue import Catalogue
from tests.build import TURNING, Json, answer, candidate, cycle, phase, worked_example

VARYING = cycle(phase(40, 250, 1, peak_torque_Nm=60, rms_torque_Nm=50), phase(0, 100), pause_s=1)


def faults(application: Json, tolerances: Json) -> list[tuple[str, str]]:
    with pytest.raises(ValidationError) as refused:
        Application.model_validate(application | {"tolerances": tolerances})
    return [(str(fault.location[1]), fault.code) for fault in faults_of(refused.value)]


@pytest.mark.parametrize(
    ("path", "code"),
    [
        ("torque", "tolerance_path"),
        ("requirements.utilisation", "tolerance_path"),
        ("duty_cycle.pause_s", "tolerance_path"),
        ("phases.9.torque_Nm", "tolerance_path"),
        ("requirements.ratios", "tolerance_path"),
        ("requirements.life_h", "tolerance_of_nothing"),
        ("requirements.motor.inertia_kgm2", "tolerance_of_nothing"),
        ("motion.mechanism.mass_kg", "tolerance_of_nothing"),
    ],
)
def test_a_path_that_names_no_given_number_is_an_error_there(path: str, code: str) -> None:
    assert faults(worked_example(), {path: {"percent": 1}}) == [(path, code)]


def test_a_path_for_all_phases_skips_those_without_a_value_and_one_of_a_phase_goes_before() -> None:
    tolerances = {"torque_Nm": {"percent": 10}, "phases.0.torque_Nm": {"absolute": 1}, "radial_N": {"percent": 5}}
    found = Application.model_validate(VARYING | {"tolerances": tolerances}).intervals

    assert [(one.place, one.low, one.high) for one in found] == [(("phases", 0, "torque_Nm"), 39, 41)]


def test_an_input_of_0_takes_no_tolerance_of_its_own() -> None:
    assert faults(VARYING, {"phases.1.torque_Nm": {"absolute": 1}}) == [("phases.1.torque_Nm", "tolerance_of_nothing")]


@pytest.mark.parametrize("path", ["speed_rpm", "duration_s", "pause_s"])
def test_speed_and_times_keep_their_sign(path: str) -> None:
    assert faults(worked_example(), {path: {"percent": 100}}) == [(path, "tolerance_sign")]
    Application.model_validate(worked_example(tolerances={path: {"percent": 99.9}}))


def test_torque_may_cross_0_and_bounds_hold_at_both_ends() -> None:
    (first, *_) = Application.model_validate(worked_example(tolerances={"torque_Nm": {"percent": 150}})).intervals

    assert (first.low, first.high) == (-20, 100)
    assert faults(worked_example(), {"torque_Nm": {"absolute": 1e6}}) == [("torque_Nm", "tolerance_most")]


def test_a_peak_with_a_tolerance_of_its_own_stays_above_its_torque() -> None:
    tolerances = {"phases.0.peak_torque_Nm": {"percent": 30}, "torque_Nm": {"percent": 10}}
    assert faults(VARYING, tolerances)[0] == ("phases.0.peak_torque_Nm", "tolerance_held")
    Application.model_validate(VARYING | {"tolerances": {"phases.0.peak_torque_Nm": {"percent": 10}}})


def test_an_rms_beside_a_peak_that_follows_the_torque_stays_below_it() -> None:
    """The peak of 40 Nm is that of the torque, so an RMS of 39 Nm has room for 1 Nm."""
    phases = cycle(phase(40, 250, rms_torque_Nm=39), phase(0, 100))
    for tolerances in (
        {"phases.0.rms_torque_Nm": {"absolute": 1.1}},
        {"phases.0.rms_torque_Nm": {"absolute": 0.9}, "torque_Nm": {"absolute": 0.2}},
    ):
        assert faults(phases, tolerances) == [("phases.0.rms_torque_Nm", "tolerance_held")]
    Application.model_validate(phases | {"tolerances": {"phases.0.rms_torque_Nm": {"absolute": 0.9}}})


def test_the_worst_corner_of_a_torque_across_0_beside_an_rms_is_an_application(catalogue: Catalogue) -> None:
    """The tolerance of 15 Nm is added to the RMS and to the peak, which is that of the torque: 23 and 25 Nm."""
    motor = {"motor": {"rated_torque_Nm": 2}, "sizes": ["32A"], "ratios": [5]}
    tolerances = {"torque_Nm": {"minus": {"absolute": 15}}}
    reply = answer(cycle(phase(10, 100, rms_torque_Nm=8), requirements=motor, tolerances=tolerances), catalogue)

    (worst,) = reply["candidates"]
    used = {check["code"]: check["worst"] for check in worst["checks"]}
    (case,) = answer(reply["tolerance"]["case"], catalogue)["candidates"]
    at_case = {check["code"]: check["utilisation"] for check in case["checks"]}
    assert reply["tolerance"]["case"]["duty_cycle"]["phases"][0]["peak_torque_Nm"] == 25
    assert used["motor_rated_torque"] == pytest.approx(23 / 5 / 2) == at_case["motor_rated_torque"]
    assert used["repeated_peak_torque"] == pytest.approx(25 / 376) == at_case["repeated_peak_torque"]


SYMMETRIC = {
    "a torque from -60 to 60": phase(20, 250, radial_N=100),
    "a peak that is 80 more at both ends": phase(20, 250, peak_torque_Nm=40, radial_N=100),
}


@pytest.mark.parametrize("own", SYMMETRIC.values(), ids=list(SYMMETRIC))
def test_magnitudes_alike_at_both_ends_are_worse_than_between_them(own: Json, catalogue: Catalogue) -> None:
    """The worst case is that of an application typed at an end."""
    tolerances = {
        "torque_Nm": {"minus": {"absolute": 80}, "plus": {"absolute": 80 if "peak_torque_Nm" in own else 40}},
        "radial_N": {"minus": {"absolute": 400}, "plus": {"absolute": 200}},  # from -300 N to 300 N
    }
    peak = {"peak_torque_Nm": 120} if "peak_torque_Nm" in own else {}
    typed = cycle(phase(-60, 250, radial_N=300, **peak), requirements={"sizes": ["20A"]})
    (first, *_) = answer(cycle(own, requirements={"sizes": ["20A"]}, tolerances=tolerances), catalogue)["candidates"]
    at_end = candidate(answer(typed, catalogue), first["designation"])

    for code in ("repeated_peak_torque", "output_bearing_load"):
        (toleranced,) = [one for one in first["checks"] if one["code"] == code]
        (corner,) = [one for one in at_end["checks"] if one["code"] == code]
        assert toleranced["exact"]
        assert toleranced["worst"] == pytest.approx(corner["utilisation"], rel=1e-12)


WRONG = [{}, {"percent": 1, "absolute": 1}, {"percent": 1, "plus": {"percent": 1}}, {"percent": -1}]


@pytest.mark.parametrize("tolerance", WRONG)
def test_a_tolerance_is_given_in_one_way(tolerance: Json) -> None:
    assert faults(worked_example(), {"torque_Nm": tolerance})[0][0] == "torque_Nm"


def test_there_are_50_at_most_and_null_is_none() -> None:
    many = {f"phases.{k}.torque_Nm": {"percent": 1} for k in range(51)}
    with pytest.raises(ValidationError, match="50"):
        Application.model_validate(cycle(*(phase(40, 250) for _ in range(60)), tolerances=many))
    for nothing in (None, {}, {"torque_Nm": None}):
        assert Application.model_validate(worked_example(tolerances=nothing)).tolerances is None


def test_a_motion_takes_tolerances_of_mechanism_and_moves_alone() -> None:
    motion = {"duty_cycle": {"motion": TURNING}}
    assert faults(motion, {"torque_Nm": {"percent": 1}}) == [("torque_Nm", "tolerance_of_motion")]
    assert Application.model_validate(
        motion | {"tolerances": {"motion.mechanism.inertia_kgm2": {"percent": 5}}}
    ).intervals


def test_mass_and_inertia_keep_their_sign() -> None:
    motion = {"duty_cycle": {"motion": TURNING}}
    path = "motion.mechanism.inertia_kgm2"
    assert faults(motion, {path: {"percent": 100}}) == [(path, "tolerance_sign")]


PATHS = {
    "motion.mechanism.inertia_kgm2": True,
    "motion.moves.3.acceleration_mm_per_s2": True,
    "motion.start_deg": True,
    "motion.mechanism.type": False,
    "motion.mechanism.time_s": False,
    "motion.moves.0.name": False,
}


@pytest.mark.parametrize("path", PATHS)
def test_a_common_tolerance_names_an_input_that_some_motion_has(path: str) -> None:
    assert takes_tolerance(path) is PATHS[path]


def test_a_corner_that_is_no_motion_names_the_input_that_says_so(catalogue: Catalogue) -> None:
    """12 kg at 250 mm have 0.75 kg·m², more than 0.9 · 0.8."""
    application = {"duty_cycle": {"motion": TURNING}, "tolerances": {"motion.mechanism.inertia_kgm2": {"percent": 10}}}
    with pytest.raises(InputError, match=r"Moment of inertia includes the gravity mass and must be at least 0\.75"):
        answer(application, catalogue)

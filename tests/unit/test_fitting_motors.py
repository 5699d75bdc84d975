"""Motors of the user's list that fit a gear, against `select` with each of them; and the gears that a motor fits."""

import math
from typing import Any

import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.motors import MOTOR_CHECKS, motors_on, ratios_with_motor, with_motor
from hpn.engine.selection import select
from hpn.physics.equations import FloatArray
from hpn.physics.motion import motor
from hpn.physics.motion.motor import Courses
from tests.build import Json, cycle, phase
from tests.conftest import Supplement
from tests.reference.test_motion import CONTRACT, SCREW

HEADER = "designation,maximum_speed_rpm,rated_speed_rpm,rated_torque_Nm,peak_torque_Nm,inertia_kgm2,source\n"
MOTORS = (
    HEADER
    + "".join(
        f"M {k},{speed},{speed / 2},{torque},{3 * torque},{inertia},\n"
        for k, (speed, torque, inertia) in enumerate(
            (speed, torque, inertia)
            for speed in (1500, 6000)
            for torque in (0.5, 3, 40)
            for inertia in ("", "0.00004", "0.02")
        )
    )
    + "half,6000,,,12,,\nempty,,,,,,\nslow,100,,,,0.001,\n"
)
CURVE = "size,ratio,torque_Nm,efficiency,source\n20A,5,10,0.7,\n20A,5,30,0.9,\n"
TYPED = cycle(phase(40, 250, 0.3), phase(-20, 250, 0.4, peak_torque_Nm=45, rms_torque_Nm=25), pause_s=2)
LOADS: dict[str, Json] = {
    "typed": TYPED,
    "turning": {"duty_cycle": {"motion": CONTRACT, "pause_s": 0.5}},
    "screw": {"duty_cycle": {"motion": SCREW}},
}
ASKED: tuple[Json, ...] = (
    {},
    {"efficiency": 0.85, "utilisation": 0.8},
    {"motor": {"peak_torque_Nm": 3, "inertia_kgm2": 0.001, "inertia_ratio": 5}},
)


def application_of(load: Json, asked: Json) -> Application:
    wants = "inertia_ratio" in asked.get("motor", {}) and "phases" in load["duty_cycle"]
    more: dict[str, Any] = {"load_inertia_kgm2": 0.3} if wants else {}
    return Application.model_validate(load | {"requirements": asked | more})


OWN = "size,ratio,stages,inertia_kgm2,no_load_torque_Nm,source\n20A,5,1,0.002,0.5,\n"


@pytest.mark.parametrize("own", [{}, {"gears": OWN}], ids=["", "own inertia"])
@pytest.mark.parametrize("question", ASKED)
@pytest.mark.parametrize("load", LOADS.values(), ids=LOADS)
@pytest.mark.parametrize("designation", ["HPN-20A-5", "HPN-20A-15"])
def test_use_of_a_motor_is_what_select_finds_with_it(
    supplemented: Supplement, load: Json, question: Json, designation: str, own: dict[str, str]
) -> None:
    catalogue = supplemented(motors=MOTORS, efficiency=CURVE, **own)
    application = application_of(load, question)
    uses = motors_on(application, catalogue.by_designation[designation], catalogue)

    heavy = "inertia_ratio" in question.get("motor", {})
    assert sorted(use.motor.designation for use in uses) == sorted(
        motor.designation
        for motor in catalogue.motors
        if motor.designation != "empty" and not (heavy and motor.inertia_kgm2 is None)
    )
    for use in uses:
        candidate = select(with_motor(application, use.motor), catalogue).candidate(designation)
        assert candidate is not None
        checks = {one.code: one for one in candidate.checks if one.code in MOTOR_CHECKS}
        assert set(checks) == set(use.used)
        for code, share in use.used.items():
            assert math.isclose(share, checks[code].utilisation or 0, rel_tol=1e-12), (use.motor, code)
        assert use.fits == all(one.status == "pass" for one in checks.values())


def test_motors_that_fit_come_first_the_smallest_first_then_the_nearest_miss(supplemented: Supplement) -> None:
    catalogue = supplemented(motors=MOTORS)
    uses = motors_on(application_of(TYPED, {}), catalogue.by_designation["HPN-20A-5"], catalogue)

    fit = [use for use in uses if use.fits]
    assert uses[: len(fit)] == fit
    rated = [use.motor.rated_torque_Nm or math.inf for use in fit]
    assert rated == sorted(rated)
    assert rated[-1] == math.inf  # of which it is not known
    worst = [use.used[use.governing] for use in uses[len(fit) :]]
    assert worst == sorted(worst)
    assert worst[0] > 1


def test_the_inertia_ratio_stands_there_without_a_limit_too(supplemented: Supplement) -> None:
    catalogue = supplemented(motors=MOTORS)
    gear = catalogue.by_designation["HPN-20A-5"]
    application = application_of(TYPED, {"load_inertia_kgm2": 0.3})

    for use in motors_on(application, gear, catalogue):
        J = use.motor.inertia_kgm2
        assert "inertia_ratio" not in use.used
        assert use.inertia_ratio == (None if J is None else pytest.approx(0.3 / (25 * J), rel=1e-12))


def test_without_a_list_no_motor_fits(catalogue: Catalogue) -> None:
    assert motors_on(application_of(TYPED, {}), catalogue.gears[0], catalogue) == []


def test_gears_for_a_motor_are_those_that_are_suitable_and_those_that_it_alone_rules_out(
    supplemented: Supplement,
) -> None:
    catalogue = supplemented(motors=HEADER + "M,2600,,,11,,\n")
    free = application_of(TYPED, {})
    bound = select(with_motor(free, catalogue.motors[0]), catalogue)
    without = {one.designation for one in select(free, catalogue).candidates if one.status == "suitable"}
    sizes = ratios_with_motor(bound)

    fit = {one.designation for size in sizes for one in size.fit}
    ruled_out = {one.designation for size in sizes for one in size.ruled_out}
    assert fit == {one.designation for one in bound.candidates if one.status == "suitable"}
    assert fit
    assert ruled_out
    assert fit | ruled_out == without
    for size in sizes:
        for row in (size.fit, size.ruled_out):
            assert [one.ratio for one in row] == sorted(one.ratio for one in row)


@pytest.mark.parametrize("load", ["turning", "screw"])
def test_how_many_pieces_are_looked_at_together_changes_no_torque(
    supplemented: Supplement, monkeypatch: pytest.MonkeyPatch, load: str
) -> None:
    catalogue = supplemented(motors=MOTORS, efficiency=CURVE)
    application = application_of(LOADS[load], {"motor": {"peak_torque_Nm": 3, "inertia_kgm2": 0.001}})
    gear = catalogue.by_designation["HPN-20A-5"]

    def found() -> object:
        return select(application, catalogue).candidates, motors_on(application, gear, catalogue)

    at_once = found()
    looked_at: list[int] = []
    peak_torque = motor.peak_torque

    def counted(course: Courses, *, ratio: FloatArray, **more: Any) -> FloatArray:
        looked_at.append(len(ratio))
        return peak_torque(course, ratio=ratio, **more)

    monkeypatch.setattr(motor, "peak_torque", counted)
    monkeypatch.setattr(motor, "PIECES_AT_ONCE", 1)
    assert found() == at_once
    assert set(looked_at) == {1}

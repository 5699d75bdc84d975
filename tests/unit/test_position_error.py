"""Torques between which the position error lies: typed phases, rest, dry friction, every door."""

import json
import math
from typing import Any

import msgspec
import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.remedy import Way
from hpn.engine.selection import encode, select
from hpn.engine.tried import followed
from hpn.explain.calculation import calculation_of
from hpn.explain.differences import differences
from tests.build import Json, answer, candidate, cycle, notices, phase
from tests.reference.test_torque_range import INDEXED, SWIVEL
from tests.unit.test_application import refused
from tests.unit.test_links import read

GEAR = "HPN-20A-5"
PER_NM = math.degrees(1 / 26_000) * 60
"""arcmin of wind-up of the gear to 1 Nm."""


def error_of(application: Json, catalogue: Catalogue) -> float:
    error: float = candidate(answer(application, catalogue), GEAR)["position_error_arcmin"]
    return error


@pytest.mark.parametrize(
    ("phases", "question", "span_Nm", "backlash"),
    [
        ([phase(40, 100, peak_torque_Nm=55), phase(-20, 100)], {}, 75, True),
        ([phase(-40, 100, peak_torque_Nm=55), phase(-20, 100)], {}, 55, True),  # down to 0
        ([phase(-40, 100, peak_torque_Nm=55, least_torque_Nm=30), phase(-20, 100)], {}, 35, False),
        ([phase(-40, 100, rms_torque_Nm=38), phase(-20, 100)], {}, 40, True),
        ([phase(-40, 100, least_torque_Nm=0)], {}, 40, True),
        ([phase(40, 100, peak_torque_Nm=55, least_torque_Nm=30)], {}, 110, True),  # magnitudes: either way
        ([phase(40, 100, peak_torque_Nm=55, least_torque_Nm=30)], {"load_reverses": False}, 25, False),
        ([phase(0, 100, peak_torque_Nm=55), phase(-20, 100)], {}, 110, True),
        ([phase(0, 100, peak_torque_Nm=55), phase(20, 100)], {"load_reverses": False}, 55, True),
        ([phase(40, 100), phase(20, 0)], {"rest_friction_Nm": 6, "load_reverses": False}, 26, False),
        ([phase(40, 100), phase(20, 0)], {"rest_friction_Nm": 30}, 100, True),
        ([phase(40, 100), phase(20, 0)], {"position_error_at": "rest"}, 40, True),
        ([phase(-40, 100), phase(20, 0)], {"position_error_at": "rest"}, 0, False),
        ([phase(-40, 100), phase(20, 0)], {"position_error_at": "rest", "rest_friction_Nm": 6}, 12, False),
        ([phase(-40, 100), phase(20, 0)], {"load_reverses": True, "rest_friction_Nm": 25}, 90, True),
    ],
)
def test_the_error_spans_the_torques_of_the_phases_that_count(
    catalogue: Catalogue, phases: list[Json], question: Json, span_Nm: float, backlash: bool
) -> None:
    error = error_of(cycle(*phases, requirements=question), catalogue)
    assert error == pytest.approx(8 + span_Nm * PER_NM + 5 * backlash, rel=1e-12)


@pytest.mark.parametrize(("at", "span_Nm"), [("cycle", 46), ("rest", 12)])
def test_friction_holds_the_axis_in_the_pause_too(catalogue: Catalogue, at: str, span_Nm: float) -> None:
    question = {"rest_friction_Nm": 6, "position_error_at": at, "load_reverses": False}
    error = error_of(cycle(phase(40, 100), pause_s=2, requirements=question), catalogue)
    assert error == pytest.approx(8 + span_Nm * PER_NM + 5, rel=1e-12)


def test_a_phase_that_varies_without_a_least_torque_is_told_by_its_number(catalogue: Catalogue) -> None:
    varying = [phase(40, 100), phase(40, 100, peak_torque_Nm=55), phase(0, 0, peak_torque_Nm=5), phase(9, 9)]
    reply = answer(cycle(*varying, phase(8, 9, rms_torque_Nm=7)), catalogue)
    [message] = [notice for notice in reply["notices"] if notice["code"] == "torque_range_not_given"]
    assert message["values"] == {"phases": "2, 5"}
    values = [entry | {"least_torque_Nm": 0.0} for entry in varying]
    assert "torque_range_not_given" not in notices(answer(cycle(*values), catalogue))
    assert "torque_range_not_given" not in notices(answer({"duty_cycle": {"motion": SWIVEL}}, catalogue))


def test_many_phases_are_not_all_named(catalogue: Catalogue) -> None:
    phases = [phase(40, 100, peak_torque_Nm=55 if k % 2 else 40) for k in range(200)]
    [notice] = [n for n in answer(cycle(*phases), catalogue)["notices"] if n["code"] == "torque_range_not_given"]
    assert notice["values"]["phases"].endswith("38, 40, …")


@pytest.mark.parametrize(
    ("application", "place"),
    [
        (cycle(phase(40, 100, least_torque_Nm=40.1)), ("duty_cycle", "phases", 0, "least_torque_Nm")),
        (cycle(phase(40, 9, rms_torque_Nm=30, least_torque_Nm=31)), ("duty_cycle", "phases", 0, "least_torque_Nm")),
        (cycle(phase(40, 100, least_torque_Nm=-1)), ("duty_cycle", "phases", 0, "least_torque_Nm")),
        (cycle(phase(40, 100), requirements={"position_error_at": "rest"}), ("requirements", "position_error_at")),
        (cycle(phase(40, 100), requirements={"position_error_at": "x"}), ("requirements", "position_error_at")),
        (cycle(phase(40, 100), requirements={"rest_friction_Nm": -1}), ("requirements", "rest_friction_Nm")),
        (
            {"duty_cycle": {"motion": SWIVEL}, "requirements": {"rest_friction_Nm": 1}},
            ("requirements", "rest_friction_Nm"),
        ),
        (
            {"duty_cycle": {"motion": SWIVEL}, "requirements": {"position_error_at": "rest"}},
            ("requirements", "position_error_at"),
        ),
    ],
)
def test_what_cannot_be_is_refused_where_it_stands(application: Json, place: tuple[Any, ...]) -> None:
    assert place in refused(application)


def test_a_least_torque_has_room_for_rounding() -> None:
    tight = cycle(phase(-40, 100, rms_torque_Nm=39, least_torque_Nm=39 * (1 + 0.9e-9)))
    assert Application.model_validate(tight)
    assert refused(cycle(phase(-40, 100, rms_torque_Nm=39, least_torque_Nm=39 * (1 + 1.1e-9))))


def test_dry_friction_of_a_dwell_takes_the_mechanism_s_efficiency_and_ratio(catalogue: Catalogue) -> None:
    """By hand: held (|T| + T_s)/η up and 2 |T| less that down, over the ratio; the pause T_s/(η ratio)."""
    motion = {
        "mechanism": {"type": "rotary", "inertia_kgm2": 1, "friction_torque_Nm": 6, "efficiency": 0.8, "ratio": 2},
        "moves": [
            {"profile": "dwell", "time_s": 1, "external_torque_Nm": 10},
            {"profile": "trapezoidal", "angle_deg": 9, "time_s": 9},
        ],
    }
    question = {"position_error_at": "rest", "ratios": [5], "sizes": ["20A"]}
    for pause_s, low in ((0.0, (20 - 16 / 0.8) / 2), (1.0, -6 / 0.8 / 2)):
        error = error_of({"duty_cycle": {"motion": motion, "pause_s": pause_s}, "requirements": question}, catalogue)
        assert error == pytest.approx(8 + (16 / 0.8 / 2 - low) * PER_NM + 5, rel=1e-12)


@pytest.mark.parametrize("at", ["cycle", "rest"])
@pytest.mark.parametrize("efficiency", [1, 0.9])
def test_a_motion_whose_phases_are_typed_keeps_its_position_error(
    catalogue: Catalogue, at: str, efficiency: float
) -> None:
    """The largest friction of all rests holds in each: the same where they are alike, else a bound."""
    motion = INDEXED | {"mechanism": INDEXED["mechanism"] | {"efficiency": efficiency}}
    document = {"duty_cycle": {"motion": motion, "pause_s": 1}, "requirements": {"position_error_at": at}}
    application = Application.model_validate(document)
    typed = followed(application, Way(torque=0.5))
    one, other = (select(each, catalogue).candidate(GEAR) for each in (application, typed))
    assert one and other and one.position_error_arcmin and other.position_error_arcmin
    friction = 13.84532 / efficiency - 7.84532  # 4 kg at 200 mm, and T_f 6
    assert typed.requirements.rest_friction_Nm == pytest.approx(0.5 * friction, rel=1e-6)
    half = (one.position_error_arcmin - 13) / 2 + 13
    assert other.position_error_arcmin >= half * (1 - 1e-9)
    if efficiency == 1:
        assert other.position_error_arcmin == pytest.approx(half, rel=1e-9)


def test_phases_copied_out_of_a_motion_bring_their_friction_and_signs_and_give_it_back() -> None:
    link = (
        "mech=rotary&J=2&mg=4&rg=200&Tf=6&etam=0.9&mv=dwell&ms=&mt=0.5&mv=modified_sine&ms=90&mt=0.5"
        "&mv=dwell&ms=&mt=0.5&mv=modified_sine&ms=-90&mt=0.5"
    )
    copied = read(f"{link}&do=take")
    assert copied.application is not None
    assert copied.application.requirements.rest_friction_Nm == pytest.approx(7.53837, abs=1e-5)
    assert copied.application.requirements.load_reverses is False
    assert copied.application.duty_cycle.load_phases[0].least_torque_Nm == 7.84532


def test_a_link_has_what_the_position_error_takes() -> None:
    link = "T=-40&n=250&t=0.3&Tpk=55&npk=&Trms=&Tlo=30&T=9&n=0&t=1&Tpk=&npk=&Trms=&Tlo=&pea=rest&rf=6"
    application = read(link).application
    assert application is not None
    first, second = application.duty_cycle.load_phases
    assert (first.least_torque_Nm, second.least_torque_Nm) == (30, None)
    assert (application.requirements.position_error_at, application.requirements.rest_friction_Nm) == ("rest", 6)
    assert [(p.name, p.index) for p in read("T=40&n=250&t=0.3&pea=rest").problems] == [("pea", None)]


@pytest.mark.parametrize(
    ("question", "messages"),
    [
        ({"duty_cycle": {"motion": INDEXED}}, ("along the motion", "R = ((|T_load| + T_s) / η")),
        (cycle(phase(40, 100), phase(-9, 0), requirements={"rest_friction_Nm": 6}), ("of each phase", "by 6 Nm.")),
        (cycle(phase(40, 100), phase(9, 0), requirements={"position_error_at": "rest"}), ("both ways", "Rest alone")),
    ],
)
def test_the_calculation_says_where_both_torques_come_from(
    catalogue: Catalogue, question: Json, messages: tuple[str, ...]
) -> None:
    application = Application.model_validate(question)
    gear, reply = catalogue.by_designation[GEAR], select(application, catalogue)
    result = reply.candidate(GEAR)
    assert result is not None
    steps = {step.code: step for step in calculation_of(result, reply.duty, gear, application, catalogue)}
    text = " ".join(note.text for note in steps["position_error"].notes)
    assert all(part in text for part in messages), text
    assert len(steps["position_error"].lines) == 2


def test_an_error_that_an_earlier_version_saved_is_not_written_as_the_new_sum(catalogue: Catalogue) -> None:
    application = Application.model_validate({"duty_cycle": {"motion": SWIVEL}})
    gear, reply = catalogue.by_designation["HPN-11A-40"], select(application, catalogue)
    result = reply.candidate("HPN-11A-40")
    assert result is not None
    record = msgspec.structs.replace(result, position_error_arcmin=12.81)
    steps = {step.code: step for step in calculation_of(record, reply.duty, gear, application, catalogue)}
    assert steps["position_error"].lines == ()


def test_a_reply_that_was_saved_before_phases_had_a_least_torque_does_not_differ_by_that(catalogue: Catalogue) -> None:
    today = select(Application.model_validate({"duty_cycle": {"motion": SWIVEL}}), catalogue)
    saved = json.loads(encode(today))
    for one in saved["duty"]["phases"]:
        del one["least_torque_Nm"]
    assert differences(saved, json.loads(encode(today))) == []

"""Emergency stops by a brake: torque of each gear, what stops and holds the load, and what helps."""

import math
from typing import Any

import pytest
from pydantic import ValidationError

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.remedy import Way, alternatives_of
from hpn.engine.selection import select
from hpn.engine.tried import followed, needed_of, tried
from tests.build import Json, answer, candidate, check, cycle, notices, phase

GEAR = "HPN-20A-5"
BOTH_WAYS = cycle(phase(60, 250), phase(-60, 250), requirements={"ratios": [5]})
INERTIAS = {"load_inertia_kgm2": 0.8, "motor": {"inertia_kgm2": 0.0015}, "efficiency": 0.92, "ratios": [5]}


def braking(brake: Json, **requirements: Any) -> Json:
    return BOTH_WAYS | {"emergency_stop": {"brake": brake}, "requirements": INERTIAS | requirements}


def refused(application: Json) -> dict[str, str]:
    """Location of each error, with dots, and its text."""
    with pytest.raises(ValidationError) as refusal:
        Application.model_validate(application)
    return {".".join(map(str, error["loc"])): error["msg"] for error in refusal.value.errors()}


CROSSED_NM = 26_000 * math.radians(5 / 60)
"""K3 γ of 20A-5."""


def swung(T_r: float, T_o: float = 0.0, B: float = 1.0) -> float:
    """T_k of 20A-5."""
    return T_r + math.sqrt(T_r**2 + 2 * T_r * (T_o + CROSSED_NM) + B * T_o**2)


def test_a_brake_gives_each_gear_a_stop_of_its_own(catalogue: Catalogue) -> None:
    reply = answer(braking({"torque_Nm": 8}, position_radius_mm=250), catalogue)
    gear, lam, inertia, omega = candidate(reply, GEAR), 0.8 / 0.0375, 0.8375, 250 * math.pi / 30
    T_k = swung(40 * lam / (1 + 0.92 * lam))
    quarter_s = 1 / (4 * gear["drive_resonance_Hz"])
    angle = omega**2 * inertia / 80 + (T_k + CROSSED_NM) / 26_000

    assert gear["stop_torque_Nm"] == pytest.approx(T_k, rel=1e-12)
    assert check(reply, GEAR, "momentary_peak_torque")["demand"] == gear["stop_torque_Nm"]
    assert gear["stopping_time_s"] == pytest.approx(omega * inertia / 40 + quarter_s, rel=1e-12)
    assert gear["stopping_angle_deg"] == pytest.approx(math.degrees(angle), rel=1e-12)
    assert gear["stopping_distance_mm"] == pytest.approx(250 * angle, rel=1e-12)
    assert gear["stop_energy_J"] == pytest.approx(inertia * omega**2 / 2, rel=1e-12)
    assert gear["motor_lock_speed_rpm"] == pytest.approx(256 / math.sqrt(26_000 * 0.8) * 30 / math.pi, rel=1e-12)


def test_the_time_in_which_the_brake_closes_never_lowers_the_torque(catalogue: Catalogue) -> None:
    values = [
        candidate(answer(braking({"torque_Nm": 8, "rise_time_s": rise}), catalogue), GEAR)["stop_torque_Nm"]
        for rise in (0, 0.004, 0.4)
    ]
    assert values[0] == values[1] == values[2]


def test_a_dynamic_factor_of_the_user_s_own_takes_the_place_of_the_bound(catalogue: Catalogue) -> None:
    brake = {"torque_Nm": 8, "dynamic_factor": 1.5, "load_torque_Nm": 10, "opposing_torque_Nm": 30}
    reply, lam = answer(braking(brake), catalogue), 0.8 / 0.0375

    T_r = (40 * lam + 10) / (1 + 0.92 * lam)
    assert candidate(reply, GEAR)["stop_torque_Nm"] == pytest.approx(1.5 * T_r + 0.5 * 30, rel=1e-12)
    assert "brake_factor_typed" in notices(reply)
    assert "brake_bound" not in notices(reply)


@pytest.mark.parametrize("pull", [{}, {"load_torque_Nm": 6, "opposing_torque_Nm": 20}, {"dynamic_factor": 2}])
def test_the_largest_brake_torque_keeps_the_stop_at_the_momentary_peak_torque(pull: Json, catalogue: Catalogue) -> None:
    for brake in ({"torque_Nm": 8} | pull, {"torque_Nm": 8, "rise_time_s": 0.004} | pull):
        reserve = candidate(answer(braking(brake), catalogue), GEAR)["reserve"]
        for name, torque_Nm in (("brake_torque_Nm", 256), ("brake_torque_repeated_Nm", 149)):
            harder = answer(braking(brake | {"torque_Nm": reserve[name]}), catalogue)
            assert candidate(harder, GEAR)["stop_torque_Nm"] == pytest.approx(torque_Nm, rel=1e-12)


def test_the_largest_inertia_of_the_load_keeps_the_stop_at_the_momentary_peak_torque(catalogue: Catalogue) -> None:
    """At 26 Nm of the brake T_k of 20A-5 passes T_M of 256 Nm somewhere between a light load and 0.8 kg m²."""
    reserve = candidate(answer(braking({"torque_Nm": 26}), catalogue), GEAR)["reserve"]
    lighter = answer(braking({"torque_Nm": 26}, load_inertia_kgm2=reserve["load_inertia_kgm2"]), catalogue)

    assert 0 < reserve["load_inertia_kgm2"] < 0.8
    assert candidate(lighter, GEAR)["stop_torque_Nm"] == pytest.approx(256, rel=1e-12)
    never = candidate(answer(braking({"torque_Nm": 8}), catalogue), GEAR)["reserve"]
    assert never["load_inertia_kgm2"] is None


def test_a_brake_that_is_too_hard_fails_and_its_remedy_holds(catalogue: Catalogue) -> None:
    application = Application.model_validate(braking({"torque_Nm": 30}))
    gear = select(application, catalogue).candidate(GEAR)
    assert gear is not None and gear.status == "unsuitable"
    [alternative] = alternatives_of(gear)
    mended = select(tried(application, alternative, catalogue), catalogue).candidate(GEAR)
    assert mended is not None and mended.status == "suitable"


def test_an_inertia_that_swings_fast_enough_mends_the_stop_too_and_nothing_else_is_asked(catalogue: Catalogue) -> None:
    """The frequency alone would allow 26 000 / (2π 15)² = 2.93 kg m², the stop less."""
    application = Application.model_validate(
        braking({"torque_Nm": 26}, load_inertia_kgm2=4.0, natural_frequency_Hz=15.0)
    )
    gear = select(application, catalogue).candidate(GEAR)
    assert gear is not None
    assert {check.code for check in gear.failing} == {"momentary_peak_torque", "natural_frequency"}
    [alternative] = alternatives_of(gear)
    mended = select(tried(application, alternative, catalogue), catalogue).candidate(GEAR)
    assert mended is not None and mended.status == "suitable"
    assert (alternative.way.brake_torque_Nm, len(alternative.requirements)) == (None, 1)


CRANE: Json = {
    "mechanism": {
        **{"type": "rotary", "inertia_kgm2": 1.0, "gravity_mass_kg": 12, "gravity_radius_mm": 250},
        **{"friction_torque_Nm": 3, "viscous_friction_Nm_per_rpm": 0.1, "efficiency": 0.8, "ratio": 2},
    },
    "moves": [
        {"profile": "trapezoidal", "angle_deg": 90, "time_s": 1, "external_torque_Nm": 10},
        {"profile": "dwell", "time_s": 1, "external_torque_Nm": -7},
        {"profile": "modified_sine", "angle_deg": -90, "time_s": 1.5, "external_torque_Nm": 4},
    ],
}


def crane(brake: Json, ratios: list[int]) -> Json:
    document = {"ratios": ratios, "motor": {"inertia_kgm2": 0.0015}}
    return {"duty_cycle": {"motion": CRANE}, "emergency_stop": {"brake": brake}, "requirements": document}


WEIGHT_NM = 12 * 9.80665 * 0.25


def test_a_motion_has_the_torques_of_its_load_at_any_instant(catalogue: Catalogue) -> None:
    """W 29.42 Nm, of the external torques 10 Nm at most, of which 4 Nm drive: a stop may come in any of the moves."""
    reply = answer(crane({"torque_Nm": 14}, [5]), catalogue)
    gear, m, J = candidate(reply, GEAR), 25 * 0.0015, 1 / 4
    speed = 1.5 * 15  # a third for ramp, run and ramp: 15 rpm are a quarter of a turn in 1 s
    alpha = math.radians(90) / 1 * 4.5
    T_d, T_v = (WEIGHT_NM + 10) / 2, (WEIGHT_NM + 4) / 2
    T_o = (WEIGHT_NM + 10 + 3 + 0.1 * speed + alpha) / (0.8 * 2)
    lam, omega = J / m, 2 * speed * math.pi / 30
    T_k = swung((70 * lam + T_d) / (1 + lam), T_o)
    slowing = (70 - T_v) / (J + m)

    assert gear["stop_torque_Nm"] == pytest.approx(T_k, rel=1e-12)
    quarter_s = 1 / (4 * gear["drive_resonance_Hz"])
    assert gear["stopping_time_s"] == pytest.approx(omega / slowing + quarter_s, rel=1e-12)
    angle = omega**2 / (2 * slowing) + (CROSSED_NM + T_k + T_o) / 26_000
    assert gear["stop_energy_J"] == pytest.approx((J + m) * omega**2 / 2 + T_v * angle, rel=1e-12)


def test_a_brake_that_does_not_stop_or_hold_the_load_is_told(catalogue: Catalogue) -> None:
    """T_v is 16.7 Nm and T_d 19.7 Nm at the gear: 15, 18 and 30 Nm of the brake stop it, hold it, or do neither."""
    application = crane({"torque_Nm": 3}, [5, 10])
    reply = answer(application, catalogue)
    result = check(reply, GEAR, "momentary_peak_torque")

    assert (result["status"], result["utilisation"]) == ("fail", None)
    assert candidate(reply, GEAR)["reason"].startswith("The brake does not stop the load")
    assert candidate(reply, GEAR)["stopping_time_s"] is None
    assert "brake_does_not_hold" not in notices(reply)
    assert check(reply, "HPN-20A-10", "momentary_peak_torque")["status"] == "pass"
    gear = select(Application.model_validate(application), catalogue).candidate(GEAR)
    assert gear is not None and alternatives_of(gear) == ()
    weak = answer(crane({"torque_Nm": 3.6}, [5, 10]), catalogue)
    assert check(weak, GEAR, "momentary_peak_torque")["status"] == "pass"
    assert "ratios 5 " in notices(weak)["brake_does_not_hold"]
    assert candidate(weak, GEAR)["reserve"]["load_inertia_kgm2"] is None


def test_no_remedy_is_offered_whose_phases_the_brake_does_not_stop(catalogue: Catalogue) -> None:
    """3.6 Nm stop the motion of T_v 16.7 Nm, not phases that T_d of 19.7 Nm drives; 14 Nm stop both."""
    for brake_Nm, count in ((3.6, 0), (14, 2)):
        document = crane({"torque_Nm": brake_Nm}, [5])
        document["requirements"] |= {"life_h": 1e9}
        application = Application.model_validate(document)
        gear = select(application, catalogue).candidate(GEAR)
        assert gear is not None and gear.status == "unsuitable"
        assert any(alternative.way.torque < 1 for alternative in alternatives_of(gear))
        assert len(needed_of(gear, application, catalogue)) == count


def test_phases_in_place_of_a_motion_keep_the_torques_of_its_load(catalogue: Catalogue) -> None:
    """A change of the torques turns the motion into phases, which say nothing of weight, friction and acceleration."""
    application = Application.model_validate(crane({"torque_Nm": 14}, [5]))
    moved = select(application, catalogue).candidate(GEAR)
    changed = followed(application, Way(torque=0.9))
    typed = select(changed, catalogue).candidate(GEAR)
    stop = changed.emergency_stop
    assert stop is not None and stop.brake is not None and moved is not None and typed is not None

    assert stop.brake.load_torque_Nm == pytest.approx((WEIGHT_NM + 10) / 2, rel=1e-12)
    assert typed.stop_torque_Nm == pytest.approx(moved.stop_torque_Nm, rel=1e-12)
    assert typed.stopping_time_s is not None and moved.stopping_time_s is not None
    assert typed.stopping_time_s > moved.stopping_time_s  # all of T_d drives


@pytest.mark.parametrize(("mass_kg", "counterweight_kg", "is_told"), [(600, 560, False), (180, 120, True)])
def test_a_stop_harder_than_g_lets_the_rope_of_a_counterweight_go_slack(
    mass_kg: float, counterweight_kg: float, is_told: bool, catalogue: Catalogue
) -> None:
    """(T_k + T_o) / J · 30 mm by hand; without a counterweight nothing hangs."""
    rack: Json = {"type": "rack_and_pinion", "mass_kg": mass_kg, "diameter_mm": 60, "incline_deg": 90}
    rack["counterweight_kg"] = counterweight_kg
    moves = [{"profile": "trapezoidal", "distance_mm": 300, "time_s": 2}]
    document = {"ratios": [5], "sizes": ["20A"], "motor": {"inertia_kgm2": 0.0015}}
    stop = {"brake": {"torque_Nm": 6}}
    application = {"duty_cycle": {"motion": {"mechanism": rack, "moves": moves}}, "emergency_stop": stop}
    reply = answer(application | {"requirements": document}, catalogue)
    J, a = (mass_kg + counterweight_kg) * 0.03**2, 4.5 * 0.3 / 2**2
    T_o = (mass_kg - counterweight_kg) * 9.80665 * 0.03 + J / 0.03 * a
    slowing = (candidate(reply, GEAR)["stop_torque_Nm"] + T_o) / J * 0.03

    assert (slowing > 9.80665) == is_told
    assert ("counterweight_slack" in notices(reply)) == is_told
    rack.pop("counterweight_kg")
    assert "counterweight_slack" not in notices(answer(application | {"requirements": document}, catalogue))


def hanging(mass_kg: float, brake: Json, **requirements: Any) -> Json:
    """A mass at 250 mm that turns over the top, and the brake that stops it."""
    mechanism = {"type": "rotary", "inertia_kgm2": mass_kg * 0.07} | {"gravity_mass_kg": mass_kg}
    moves = [{"profile": "trapezoidal", "angle_deg": 90, "time_s": 2}]
    motion = {"mechanism": mechanism | {"gravity_radius_mm": 250}, "moves": moves}
    return {
        "duty_cycle": {"motion": motion},
        "emergency_stop": {"brake": brake},
        "requirements": {"ratios": [5]} | requirements,
    }


@pytest.mark.parametrize("motor", [{}, {"motor": {"inertia_kgm2": 0.0015}}])
def test_a_brake_below_gravity_fails_whether_the_inertia_of_the_motor_is_known_or_not(
    catalogue: Catalogue, motor: Json
) -> None:
    """18 kg at 250 mm: 44.1 Nm, against 40 Nm of the brake at the output, with which T_k is below T_M."""
    reply = answer(hanging(18, {"torque_Nm": 8}, **motor), catalogue)
    result = check(reply, GEAR, "momentary_peak_torque")

    assert result["demand"] < result["limit"]
    assert (result["status"], result["utilisation"]) == ("fail", None)


@pytest.mark.parametrize("motor", [{}, {"motor": {"inertia_kgm2": 0.0015}}])
def test_no_brake_is_offered_that_would_not_stop_the_load(catalogue: Catalogue, motor: Json) -> None:
    """At T_M the brake could have less at the output than the 88.3 Nm of gravity."""
    reserve = candidate(answer(hanging(36, {"torque_Nm": 40}, **motor), catalogue), GEAR)["reserve"]

    assert (reserve["brake_torque_Nm"], reserve["brake_torque_repeated_Nm"]) == (0, 0)


def test_no_brake_is_offered_where_the_load_alone_exceeds_the_torque_in_every_stop(catalogue: Catalogue) -> None:
    """Friction of 160 Nm that the gear bears before the stop: T_k is above T_R of 149 Nm at every brake."""
    mechanism = {"type": "rotary", "inertia_kgm2": 0.005, "friction_torque_Nm": 160}
    motion = {"mechanism": mechanism, "moves": [{"profile": "trapezoidal", "angle_deg": 90, "time_s": 2}]}
    document = {"ratios": [5], "motor": {"inertia_kgm2": 0.01}}
    stop = {"brake": {"torque_Nm": 8}}
    reply = answer({"duty_cycle": {"motion": motion}, "emergency_stop": stop, "requirements": document}, catalogue)
    gear = candidate(reply, GEAR)

    assert gear["stop_torque_Nm"] > 160
    assert gear["reserve"]["brake_torque_repeated_Nm"] == 0


def test_a_gear_that_is_not_rated_has_no_largest_brake_torque(catalogue: Catalogue) -> None:
    reserve = candidate(answer(braking({"torque_Nm": 8}), catalogue), "HPN-40A-5")["reserve"]

    assert (reserve["brake_torque_Nm"], reserve["brake_torque_repeated_Nm"]) == (None, None)


def test_without_the_inertias_the_whole_brake_counts_and_no_time_is_invented(catalogue: Catalogue) -> None:
    reply = answer(BOTH_WAYS | {"emergency_stop": {"brake": {"torque_Nm": 8}, "count": 100}}, catalogue)
    gear = candidate(reply, GEAR)

    assert gear["stop_torque_Nm"] == pytest.approx(swung(40), rel=1e-12)
    assert [gear[name] for name in ("stopping_time_s", "stopping_angle_deg", "stop_energy_J")] == [None] * 3
    assert "brake_inertia_unknown" in notices(reply)


def test_notices_say_what_is_in_the_torque_of_a_stop_and_what_is_not(catalogue: Catalogue) -> None:
    def told(brake: Json, **requirements: Any) -> set[str]:
        reply = answer(braking({"torque_Nm": 8} | brake, **requirements), catalogue)
        return {code for code in notices(reply) if code.startswith("brake_")}

    assert told({}) == {"brake_bound", "brake_without_load"}
    assert told({"load_torque_Nm": 0}) == {"brake_bound", "brake_while_accelerating"}
    assert told({}, efficiency=None) == {"brake_bound", "brake_without_load", "brake_efficiency_unknown"}
    moved = notices(answer(crane({"torque_Nm": 14}, [5]), catalogue))
    assert {code for code in moved if code.startswith("brake_")} == {"brake_bound", "brake_efficiency_unknown"}

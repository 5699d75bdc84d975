"""Motions as somebody sends them: what is refused and where, what is told, and how large they may be."""

import math
from itertools import combinations
from typing import Any

import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.physics.motion.mechanisms import GRAVITY
from hpn.physics.motion.moves import Turn
from hpn.words.fields import MAXIMUM_PHASES
from tests.build import Json, answer, check, notices, phase
from tests.unit.test_application import refused

TABLE: Json = {"type": "rotary", "inertia_kgm2": 1.0}
SCREW: Json = {"type": "ball_screw", "mass_kg": 100.0, "lead_mm": 10.0}
TURN: Json = {"profile": "trapezoidal", "angle_deg": 90.0, "time_s": 0.8}


def motion(*moves: Json, mechanism: Json = TABLE, **more: Any) -> Json:
    return {"duty_cycle": {"motion": {"mechanism": mechanism, "moves": list(moves), **more}}}


def phases_of(application: Json) -> tuple[Any, ...]:
    return Application.model_validate(application).duty_cycle.load_phases


@pytest.mark.parametrize(
    ("changes", "place", "message"),
    [
        ({"speed_rpm": 18.75}, ("speed_rpm",), "above 18.75 rpm"),
        ({"acceleration_deg_per_s2": 562}, ("acceleration_deg_per_s2",), "562.5 °/s²"),
        (
            {"profile": "s_curve", "acceleration_deg_per_s2": 562.5, "jerk_share": 1},
            ("acceleration_deg_per_s2",),
            "1125 °/s²",
        ),
        ({"speed_rpm": 30, "acceleration_deg_per_s2": 900, "deceleration_time_s": 0.2}, (), "at most one ramp"),
        ({"acceleration_time_s": 0.41}, ("acceleration_time_s",), "at most 0.4 s"),
        ({"deceleration_time_s": 0.41}, ("deceleration_time_s",), "at most 0.4 s"),
        ({"deceleration_deg_per_s2": 562}, ("deceleration_deg_per_s2",), "562.5 °/s²"),
        ({"acceleration_time_s": 0.3, "deceleration_time_s": 0.6}, ("deceleration_time_s",), "at most 0.5 s"),
        ({"acceleration_time_s": 0.9, "deceleration_time_s": 0.8}, ("deceleration_time_s",), "at most 0.4 s"),
        (
            {"acceleration_time_s": 0.3, "deceleration_deg_per_s2": 449},
            ("deceleration_deg_per_s2",),
            "at least 450 °/s²",
        ),
        (
            {"acceleration_deg_per_s2": 900, "deceleration_deg_per_s2": 409},
            ("deceleration_deg_per_s2",),
            "at least 409.091 °/s²",
        ),
        ({"acceleration_time_s": 0.3, "acceleration_deg_per_s2": 449}, ("acceleration_time_s",), "give only one"),
        ({"speed_rpm": 38, "acceleration_time_s": 0.2}, ("speed_rpm",), "at most 37.5 rpm"),
        ({"speed_rpm": 25, "acceleration_time_s": 0.4}, ("acceleration_time_s",), "below 0.4 s"),
        ({"speed_rpm": 25, "deceleration_deg_per_s2": 375}, ("deceleration_deg_per_s2",), "above 375 °/s²"),
        ({"time_s": None, "acceleration_time_s": 0.3, "deceleration_time_s": 0.3}, (), "given: acceleration_time_s"),
        ({"profile": "triangular", "deceleration_time_s": 0.3}, ("deceleration_time_s",), "has no deceleration_time_s"),
        ({"profile": "modified_sine", "acceleration_time_s": 0.3}, ("acceleration_time_s",), "has no"),
        ({"time_s": None, "speed_rpm": 30}, (), "given: speed_rpm"),
        ({"time_s": None}, (), "given: none"),
        ({"profile": "triangular", "speed_rpm": 30}, (), "needs one of"),
        ({"profile": "triangular", "jerk_share": 0.5}, ("jerk_share",), "has no jerk_share"),
        ({"profile": "modified_sine", "speed_rpm": 30}, ("speed_rpm",), "has no speed_rpm"),
        ({"profile": "modified_sine", "time_s": None}, (), "needs time_s"),
        (
            {"profile": "s_curve", "acceleration_deg_per_s2": 900, "jerk_deg_per_s3": 5999},
            ("jerk_deg_per_s3",),
            "at least 6000 °/s³",  # 225 °/s in 0.4 s: 225 / 900 + 900 / j
        ),
        (
            {"profile": "s_curve", "time_s": None, "speed_rpm": 25, "acceleration_deg_per_s2": 900}
            | {"jerk_deg_per_s3": 5000},
            ("jerk_deg_per_s3",),
            "at least 5400 °/s³",  # A² / V = 900² / 150
        ),
        (
            {
                "profile": "s_curve",
                "time_s": None,
                "speed_rpm": 25,
                "acceleration_time_s": 0.3,
                "jerk_deg_per_s3": 6600,
            },
            ("jerk_deg_per_s3",),
            "at least 6666.67 °/s³",  # 4 V / t² = 4 · 150 / 0.3²
        ),
        (
            {"profile": "s_curve", "jerk_deg_per_s3": 9000},
            ("jerk_deg_per_s3",),
            "at least 9492.19 °/s³",  # a third of the time for each ramp: 4 · 168.75 / (0.8 / 3)²
        ),
        ({"profile": "s_curve", "jerk_deg_per_s3": 9e4, "jerk_share": 0.5}, ("jerk_deg_per_s3",), "give only one"),
        ({"jerk_deg_per_s3": 9e4}, ("jerk_deg_per_s3",), "has no jerk_deg_per_s3"),
        (
            {"profile": "s_curve", "acceleration_deg_per_s2": 500, "jerk_deg_per_s3": 9e4},
            ("acceleration_deg_per_s2",),
            "at least 571.575 °/s²",  # 225 = 0.4 A - A² / 90000
        ),
        ({"profile": "dwell"}, ("angle_deg",), "has no angle_deg"),
        ({"angle_deg": 0}, ("angle_deg",), "must not be 0"),
        ({"angle_deg": None}, (), "needs angle_deg"),
        ({"time_s": 0}, ("time_s",), "greater than 0"),
        ({"jerk_share": 1.1, "profile": "s_curve"}, ("jerk_share",), "1"),
        ({"distance_mm": 5}, ("distance_mm",), "Extra inputs"),
        ({"profile": "sine"}, ("profile",), "trapezoidal"),
        ({"time_s": 1e-4}, (), "Nm at most"),
        ({"angle_deg": 9e8, "time_s": 1}, (), "rpm at most"),
        ({"time_s": None, "speed_rpm": 1e-10, "acceleration_deg_per_s2": 1}, (), "s at most"),
    ],
)
def test_a_move_is_refused_where_it_stands_with_the_bound_that_would_do(
    changes: Json, place: tuple[str, ...], message: str
) -> None:
    move = {name: value for name, value in (TURN | changes).items() if value is not None}
    errors = refused(motion(TURN, move))
    where = ("duty_cycle", "motion", "moves", 1, *place)
    assert where in errors
    assert message in errors[where]


@pytest.mark.parametrize(
    ("mechanism", "place", "message"),
    [
        ({"type": "rotary"}, ("inertia_kgm2",), "required"),
        (TABLE | {"gravity_mass_kg": 5}, ("gravity_mass_kg",), "gravity_radius_mm"),
        (TABLE | {"gravity_radius_mm": 5}, ("gravity_radius_mm",), "gravity_mass_kg"),
        (TABLE | {"lead_mm": 5}, ("lead_mm",), "Extra inputs"),
        (TABLE | {"inertia_kgm2": 0}, ("inertia_kgm2",), "greater than 0"),
        (TABLE | {"efficiency": 1.01}, ("efficiency",), "1"),
        (TABLE | {"ratio": 0}, ("ratio",), "greater than 0"),
        (TABLE | {"friction_torque_Nm": -1}, ("friction_torque_Nm",), "0"),
        ({"type": "crank"}, ("type",), "ball_screw"),
        ({}, ("type",), "required"),
        (7, (), "dictionary"),
    ],
)
def test_a_mechanism_is_refused_where_it_stands(mechanism: Any, place: tuple[str, ...], message: str) -> None:
    errors = refused(motion(TURN, mechanism=mechanism))
    where = ("duty_cycle", "motion", "mechanism", *place)
    assert where in errors
    assert message in errors[where]


@pytest.mark.parametrize(
    ("mechanism", "place"),
    [
        (SCREW | {"incline_deg": 90.1}, "incline_deg"),
        (SCREW | {"incline_deg": -90.1}, "incline_deg"),
        (SCREW | {"friction_coefficient": -0.1}, "friction_coefficient"),
        (SCREW | {"inertia_kgm2": -0.1}, "inertia_kgm2"),
        (SCREW | {"diameter_mm": 5.0}, "diameter_mm"),
        (SCREW | {"lead_mm": 0}, "lead_mm"),
        (SCREW | {"friction_force_N": -0.1}, "friction_force_N"),
        (SCREW | {"friction_torque_Nm": -0.1}, "friction_torque_Nm"),
        (SCREW | {"counterweight_kg": -0.1, "incline_deg": 5}, "counterweight_kg"),
        (SCREW | {"counterweight_kg": 5.0}, "counterweight_kg"),
        (SCREW | {"viscous_friction_Nm_per_rpm": 5.0}, "viscous_friction_Nm_per_rpm"),
        ({"type": "belt", "mass_kg": 1.0}, "diameter_mm"),
    ],
)
def test_a_linear_mechanism_likewise(mechanism: Json, place: str) -> None:
    stroke = {"profile": "modified_sine", "distance_mm": 10, "time_s": 1}
    assert list(refused(motion(stroke, mechanism=mechanism))) == [("duty_cycle", "motion", "mechanism", place)]


def test_start_is_of_a_rotary_mechanism_alone() -> None:
    stroke = {"profile": "modified_sine", "distance_mm": 10, "time_s": 1}
    errors = refused(motion(stroke, mechanism=SCREW, start_deg=5))
    assert list(errors) == [("duty_cycle", "motion", "start_deg")]


def test_a_cycle_has_phases_or_a_motion_and_not_both() -> None:
    both = motion(TURN)
    both["duty_cycle"]["phases"] = [phase(1, 1)]
    assert list(refused(both)) == [("duty_cycle", "motion")]
    for neither in ({}, {"phases": None}, {"motion": None}):
        assert list(refused({"duty_cycle": neither})) == [("duty_cycle", "phases")]
    assert list(refused(motion({"profile": "dwell", "time_s": 1}))) == [("duty_cycle", "motion", "moves")]
    assert ("duty_cycle", "motion", "moves") in refused(motion())
    assert list(refused({"duty_cycle": {"motion": 5}})) == [("duty_cycle", "motion")]


def test_a_thousand_moves_are_accepted_and_one_more_is_not() -> None:
    assert len(phases_of(motion(*[TURN] * 1000))) == 3000
    assert ("duty_cycle", "motion", "moves") in refused(motion(*[TURN] * 1001))


def test_the_phases_that_come_out_are_no_more_than_may_be_typed() -> None:
    """Two of a turn change their sign: a pendulum that nothing else moves."""
    swing = TABLE | {"inertia_kgm2": 1e-2, "gravity_mass_kg": 1.0, "gravity_radius_mm": 100.0}
    move = {"profile": "trapezoidal", "angle_deg": 360.0 * 1500, "time_s": 1000}
    errors = refused(motion(move, move, mechanism=swing))
    assert "720000" in errors["duty_cycle", "motion", "moves"]
    six = [move | {"angle_deg": 360.0 * 300}] * 6
    assert len(phases_of(motion(*six, mechanism=swing))) < MAXIMUM_PHASES


@pytest.mark.parametrize(("speed", "is_cut"), [(30, False), (37.4, False), (37.5, True), (50, True)])
def test_a_triangle_that_was_not_asked_for_is_told(catalogue: Catalogue, speed: float, is_cut: bool) -> None:
    """90° in 0.8 s is 18.75 rpm on average: from twice that on there is no time to run."""
    reply = answer(motion(TURN, TURN | {"speed_rpm": speed}), catalogue)
    assert ("motion_triangle" in notices(reply)) is is_cut
    if is_cut:
        assert "Moves 2 " in notices(reply)["motion_triangle"]
        assert math.isclose(reply["duty"]["phases"][-1]["peak_speed_rpm"], 37.5, rel_tol=1e-14)


def test_moves_in_a_row_are_told_as_a_range(catalogue: Catalogue) -> None:
    cut = TURN | {"speed_rpm": 50}
    notice = notices(answer(motion(cut, TURN, cut, cut, cut), catalogue))["motion_triangle"]
    assert "Moves 1, 3–5 " in notice


@pytest.mark.parametrize("ramps", [(0.2, 0.6), (0.7, 0.1), (0.4, 0.4)])
def test_ramps_that_fill_the_time_keep_their_own_lengths(ramps: tuple[float, float]) -> None:
    """90° in 0.8 s are 225°/s at the peak, which each ramp reaches in its own time."""
    times = {"acceleration_time_s": ramps[0], "deceleration_time_s": ramps[1]}
    timing = Turn(profile="trapezoidal", angle_deg=90, time_s=0.8, **times).timing
    assert timing.ramps_s == pytest.approx(ramps, rel=1e-12)
    assert timing.run_s == 0
    assert timing.peak_speed == pytest.approx(225, rel=1e-12)
    assert timing.peak_accelerations == pytest.approx([225 / ramp for ramp in ramps], rel=1e-12)
    assert Turn(profile="triangular", angle_deg=90, time_s=0.8).timing.peak_speed == pytest.approx(225, rel=1e-12)


def test_a_way_below_the_least_number_is_refused() -> None:
    errors = refused(motion(TURN, TURN | {"angle_deg": 1e-13}))
    assert "must be at least 1e-12 in magnitude" in errors["duty_cycle", "motion", "moves", 1, "angle_deg"]


def test_a_speed_never_reached_and_an_acceleration_that_just_suffices_give_the_triangle_too(
    catalogue: Catalogue,
) -> None:
    never = {"profile": "trapezoidal", "angle_deg": 90, "speed_rpm": 100, "acceleration_deg_per_s2": 900}
    just = TURN | {"acceleration_deg_per_s2": 562.5}
    for move in (never, just):
        reply = answer(motion(move), catalogue)
        assert "motion_triangle" in notices(reply)
        assert len(reply["duty"]["phases"]) == 2
    question = answer(motion({"profile": "triangular", "angle_deg": 90, "time_s": 0.8}), catalogue)
    assert "motion_triangle" not in notices(question)


@pytest.mark.parametrize(
    ("angles", "gravity", "has_notice"),
    [((90, -90), 5, False), ((200, 160), 5, False), ((90,), 5, True), ((90,), None, False)],
)
def test_a_motion_that_ends_where_gravity_pulls_otherwise_is_told(
    catalogue: Catalogue, angles: tuple[float, ...], gravity: float | None, has_notice: bool
) -> None:
    mechanism = TABLE | ({"gravity_mass_kg": gravity, "gravity_radius_mm": 100.0} if gravity else {})
    reply = answer(motion(*(TURN | {"angle_deg": angle} for angle in angles), mechanism=mechanism), catalogue)
    assert ("motion_left_off" in notices(reply)) is has_notice


def test_a_move_carries_its_loads_and_the_cycle_fills_what_it_leaves(catalogue: Catalogue) -> None:
    application = motion(TURN | {"radial_N": 900.0}, TURN)
    application |= {"output_load": {"axial_N": 220.0}, "requirements": {"sizes": ["20A"], "ratios": [5]}}
    reply = answer(application, catalogue)

    assert [entry.get("radial_N") for entry in reply["duty"]["phases"]] == [900.0] * 3 + [None] * 3
    demand = check(reply, "HPN-20A-5", "output_bearing_load")["demand"]
    assert math.isclose(demand, 900 / 1800 + 220 / 2200, rel_tol=1e-14)


def test_typed_phases_have_no_phases_in_the_reply(catalogue: Catalogue) -> None:
    reply = answer({"duty_cycle": {"phases": [phase(1, 1)]}}, catalogue)
    assert not {"phases", "load_inertia_kgm2"} & reply["duty"].keys()


def test_a_ratio_of_the_mechanism_counts_in_speed_torque_and_inertia(catalogue: Catalogue) -> None:
    one, three = (answer(motion(TURN, mechanism=TABLE | {"ratio": ratio}), catalogue)["duty"] for ratio in (1, 3))
    assert math.isclose(one["load_inertia_kgm2"], 9 * three["load_inertia_kgm2"], rel_tol=1e-14)
    for first, other in zip(one["phases"], three["phases"], strict=True):
        assert math.isclose(first["torque_Nm"], 3 * other["torque_Nm"], rel_tol=1e-14)
        assert math.isclose(3 * first["speed_rpm"], other["speed_rpm"], rel_tol=1e-14)


def test_an_application_with_a_motion_survives_its_own_json() -> None:
    application = Application.model_validate(motion(TURN, {"profile": "dwell", "time_s": 1}, start_deg=30))
    assert Application.model_validate_json(application.model_dump_json()) == application
    assert hash(application)


@pytest.mark.parametrize("incline_deg", [30.0, -30.0, 17.0])
def test_a_weight_that_its_counterweight_holds_takes_no_torque(incline_deg: float) -> None:
    weight_N = 100.0 * GRAVITY * math.sin(math.radians(incline_deg))
    dwell = {"profile": "dwell", "time_s": 0.5, "external_force_N": -weight_N}
    way = {"profile": "trapezoidal", "distance_mm": 100.0, "time_s": 0.5, "external_force_N": -weight_N}

    _, run, _, rest = phases_of(motion(way, dwell, mechanism=SCREW | {"incline_deg": incline_deg}))

    assert [str(phase.torque_Nm) for phase in (run, rest)] == ["0.0", "0.0"]  # neither -0.0 nor a rounding error
    assert [phase.peak_torque_Nm for phase in (run, rest)] == [0.0, 0.0]


def test_a_ramp_that_friction_alone_brakes_takes_no_torque() -> None:
    braking = {"profile": "trapezoidal", "angle_deg": 90.0, "time_s": 0.9}
    peak = math.radians(90 / 0.6)
    table = TABLE | {"friction_torque_Nm": peak / 0.3}

    _, _, brake = phases_of(motion(braking, mechanism=table))

    assert str(brake.torque_Nm) == "0.0"


def test_an_inertia_below_that_of_the_gravity_mass_is_refused_with_the_bound() -> None:
    heavy = TABLE | {"gravity_mass_kg": 12.0, "gravity_radius_mm": 250.0}

    ((place, message),) = refused(motion(TURN, mechanism=heavy | {"inertia_kgm2": 0.7})).items()

    assert place == ("duty_cycle", "motion", "mechanism", "inertia_kgm2")
    assert "at least 0.75 kg" in message
    assert phases_of(motion(TURN, mechanism=heavy | {"inertia_kgm2": 0.75}))


@pytest.mark.parametrize("profile", ["trapezoidal", "s_curve"])
@pytest.mark.parametrize("inputs", [*combinations(("time_s", "speed_rpm", "acceleration_deg_per_s2"), 2)])
def test_figures_that_follow_give_the_same_move_when_they_are_typed(profile: Any, inputs: tuple[str, str]) -> None:
    """A third of 0.4 s for each ramp: 110 deg at 412.5 deg/s (area of the trapezoid), reached in 0.4 / 3 s."""
    typed = {"time_s": 0.4, "speed_rpm": 68.75, "acceleration_deg_per_s2": 412.5 * 3 / 0.4}
    if profile == "s_curve":
        typed["acceleration_deg_per_s2"] /= 0.75
    move = Turn(profile=profile, angle_deg=110, **{name: typed[name] for name in inputs})
    followed = move.followed
    for name in typed.keys() - {*inputs}:
        assert followed[name] == pytest.approx(typed[name], rel=1e-12)
    assert followed["acceleration_time_s"] == followed["deceleration_time_s"] == pytest.approx(0.4 / 3, rel=1e-9)
    assert "time_s" not in Turn(profile="trapezoidal", angle_deg=110, time_s=0.4).followed
    assert Turn(profile="dwell", time_s=1).followed == {}


def test_a_jerk_gives_each_ramp_its_share() -> None:
    """90° in 0.8 s at 900 °/s² and 20 000 °/s³: V = 900 t - 900² / 20 000, 90 = V (0.8 - t)."""
    move = Turn(profile="s_curve", angle_deg=90, time_s=0.8, acceleration_deg_per_s2=900, jerk_deg_per_s3=20_000)

    assert round(move.timing.peak_speed, 3) == 154.197
    assert [round(t, 6) for t in move.timing.ramps_s] == [0.216330] * 2
    assert [round(share, 6) for share in move.timing.jerk_shares] == [0.416032] * 2
    share = move.followed["jerk_share"]
    typed = Turn(profile="s_curve", angle_deg=90, time_s=0.8, acceleration_deg_per_s2=900, jerk_share=share)
    assert typed.timing.ramps_s == pytest.approx(move.timing.ramps_s, rel=1e-12)
    assert typed.followed["jerk_deg_per_s3"] == pytest.approx(20_000, rel=1e-12)


def test_a_jerk_at_its_bound_fills_the_ramps_and_a_great_one_leaves_them_straight() -> None:
    ends = {"angle_deg": 90, "time_s": 0.8}
    least = Turn(profile="s_curve", **ends, acceleration_time_s=0.2, jerk_deg_per_s3=4 * 150 / 0.2**2)
    assert least.timing.jerk_shares == pytest.approx((1.0, 1.0), rel=1e-12)
    assert least.timing.peak_accelerations == pytest.approx((1500, 1500), rel=1e-12)
    great = Turn(profile="s_curve", **ends, acceleration_deg_per_s2=900, jerk_deg_per_s3=1e12)
    straight = Turn(profile="trapezoidal", **ends, acceleration_deg_per_s2=900)
    assert great.timing.ramps_s == pytest.approx(straight.timing.ramps_s, rel=1e-8)  # A / j is 9e-10 s


@pytest.mark.parametrize(
    ("incline_deg", "coefficient", "has_notice"), [(90, 0.1, True), (-90, 0.1, True), (90, 0, False), (89, 0.1, False)]
)
def test_a_coefficient_of_friction_that_has_no_effect_is_told(
    catalogue: Catalogue, incline_deg: float, coefficient: float, has_notice: bool
) -> None:
    stroke = {"profile": "modified_sine", "distance_mm": 10, "time_s": 1}
    guided = SCREW | {"incline_deg": incline_deg, "friction_coefficient": coefficient}
    assert ("friction_without_effect" in notices(answer(motion(stroke, mechanism=guided), catalogue))) is has_notice


def test_a_weight_and_its_counterweight_leave_no_rounding_error() -> None:
    value_held = SCREW | {"incline_deg": 30.0, "counterweight_kg": 50.0}
    stroke = {"profile": "trapezoidal", "distance_mm": 100.0, "time_s": 0.5}

    _, run, _ = phases_of(motion(stroke, mechanism=value_held))

    assert (str(run.torque_Nm), run.peak_torque_Nm) == ("0.0", 0.0)

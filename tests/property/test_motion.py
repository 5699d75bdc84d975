"""Properties of every motion: samples, splits, energy, turned signs, and advice that works."""

import copy
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from pydantic import ValidationError

from hpn.application import Application
from hpn.application.faults import pointer
from hpn.catalogue import load_catalogue
from hpn.engine.duty import Duty
from hpn.physics.motion.course import course_along, course_of, courses_along
from hpn.physics.motion.pieces import pieces_of
from hpn.physics.motion.torque import cut, integral, torque_at
from hpn.web.door.problems import Problem
from tests.build import Json, answer
from tests.property.draw import linear_motions, motions, rotary_motions, signs
from tests.reference.motion_samples import sampled

CATALOGUE = load_catalogue()

# Zeros and quadrature are good to 1e-13; what is small beside the whole loses some digits of that.
CLOSE = 1e-9
FIGURES = ("average_torque_Nm", "average_output_speed_rpm", "maximum_torque_Nm", "maximum_output_speed_rpm")


def application_of(motion: Json, pause_s: float = 0.0) -> Application:
    return Application.model_validate({"duty_cycle": {"motion": motion, "pause_s": pause_s}})


@given(motion=motions(), pause_s=st.just(0.0) | st.floats(0, 10))
def test_figures_of_a_motion_are_those_of_its_samples(soak: bool, motion: Json, pause_s: float) -> None:
    duty = Duty.of([application_of(motion, pause_s)])
    count = 1_000_000 if soak else 100_000
    expected = sampled(motion, pause_s, count)

    # Speed and angle are summed up from the acceleration: a jump of it is misplaced by up to half a step.
    close = 300 / count
    room = close * expected["maximum_torque_Nm"]
    for name in (*FIGURES, "rms_torque_Nm"):
        assert math.isclose(getattr(duty, name).item(), expected[name], rel_tol=close, abs_tol=room), name


@given(motions(), st.lists(st.floats(0.001, 0.999), min_size=1, max_size=4), st.randoms(use_true_random=False))
def test_splitting_a_move_at_any_instant_changes_nothing(motion: Json, shares: list[float], chance: Any) -> None:
    moving = application_of(motion).duty_cycle.motion
    assert moving is not None
    load = moving.mechanism.load
    pieces = pieces_of(moving.moves, getattr(moving, "start_deg", 0.0), load)
    parted = pieces
    for share in shares:
        place = chance.randrange(len(parted))
        at = parted.start_s[place] + share * (parted.end_s[place] - parted.start_s[place])
        parted = cut(parted, np.array([place]), np.array([at]))
        parted.part[place + 1 :] += 10  # phases of their own from there on
    whole, split = course_along(pieces, load), course_along(parted, load)

    def totals(course: Any) -> list[float]:
        n, t, T = np.abs(course.speed_rpm), course.duration_s, np.abs(course.torque_Nm)
        return [
            (n * t).sum(),
            (n * t * T ** (10 / 3)).sum() ** 0.3,
            t.sum(),
            np.sqrt((course.rms_torque_Nm**2 * t).sum()),
            course.peak_torque_Nm.max(),
            course.peak_speed_rpm.max(),
            course.square_torque.sum(),
            course.square_acceleration.sum(),
        ]

    for one, other in zip(totals(whole), totals(split), strict=True):
        assert math.isclose(one, other, rel_tol=CLOSE, abs_tol=1e-12)


@given(motions())
def test_the_phases_can_be_typed_and_give_the_same_reply(motion: Json) -> None:
    moving = answer({"duty_cycle": {"motion": motion, "pause_s": 1.5}}, CATALOGUE)
    phases, asked = moving["duty"]["phases"], {"load_inertia_kgm2": moving["duty"]["load_inertia_kgm2"]}
    asked["load_reverses"] = False  # no sign is missing
    asked["rest_friction_Nm"] = application_of(motion, 1.5).duty_cycle.rest_friction_Nm
    typed = answer({"duty_cycle": {"phases": phases, "pause_s": 1.5}, "requirements": asked}, CATALOGUE)

    dwells = any(move["profile"] == "dwell" for move in motion["moves"])
    if dwells and motion["mechanism"].get("efficiency", 1) < 1:  # friction differs with what each of them holds
        for gear, its in zip(moving["candidates"], typed["candidates"], strict=True):
            exact, bound = gear.pop("position_error_arcmin"), its.pop("position_error_arcmin")
            assert exact is None or exact <= bound * (1 + 1e-12)
    assert moving["candidates"] == typed["candidates"]
    assert {name: moving["duty"][name] for name in FIGURES} == typed["duty"]


@given(motions())
def test_turned_signs_from_the_mirrored_start_give_phases_of_the_same_magnitudes(motion: Json) -> None:
    turned = copy.deepcopy(motion)
    if motion["mechanism"]["type"] == "rotary":
        turned["start_deg"] = 180 - motion.get("start_deg", 0)
    else:
        turned["mechanism"]["incline_deg"] = -motion["mechanism"].get("incline_deg", 0)
    for move in turned["moves"]:
        for name in ("angle_deg", "distance_mm", "external_torque_Nm", "external_force_N"):
            if name in move:
                move[name] = -move[name]
    one, other = (application_of(each).duty_cycle.load_phases for each in (motion, turned))

    assert len(one) == len(other)
    scale = max(phase.peak_torque_Nm or 0 for phase in one)
    for phase, its in zip(one, other, strict=True):
        for name in ("torque_Nm", "speed_rpm", "peak_torque_Nm", "peak_speed_rpm", "rms_torque_Nm", "duration_s"):
            value, turned_value = abs(getattr(phase, name)), abs(getattr(its, name))
            assert math.isclose(value, turned_value, rel_tol=CLOSE, abs_tol=1e-10 * scale), name


@given(st.floats(-1, 1), st.floats(0.2, 400), st.floats(0.2, 3), st.floats(0, 5), st.floats(0, 0.1), st.floats(0, 9))
def test_over_a_closed_cycle_the_energy_is_what_friction_takes(
    start: float, angle: float, time: float, dry: float, viscous: float, mass: float
) -> None:
    """Trapezoids, a third of the time for each part, there and back: ∫ω² dt = V² (T/3 + 2/3 · T/3) each."""
    mechanism = {"type": "rotary", "inertia_kgm2": 2, "friction_torque_Nm": dry, "viscous_friction_Nm_per_rpm": viscous}
    if mass >= 1:
        mechanism |= {"gravity_mass_kg": mass, "gravity_radius_mm": 300}
    moves = [{"profile": "trapezoidal", "angle_deg": sign * angle, "time_s": time} for sign in (1, -1)]
    moving = application_of({"mechanism": mechanism, "start_deg": 90 * start, "moves": moves}).duty_cycle.motion
    assert moving is not None
    load = moving.mechanism.load
    pieces = course_along(pieces_of(moving.moves, 90 * start, load), load).pieces

    energy = integral(lambda p, t: torque_at(p, t) * p.speed_at(t), pieces).sum()
    V, way = 1.5 * math.radians(angle) / time, 2 * math.radians(angle)
    expected = dry * way + viscous * 30 / math.pi * 2 * V**2 * time * (1 / 3 + 2 / 9)

    turned = 2 * V**2 + mass * 3 * way  # what is put in and taken out again
    assert math.isclose(energy, expected, rel_tol=CLOSE, abs_tol=1e-12 * turned)


# --- Errors -----------------------------------------------------------------------------------------------------------


def refusals(motion: Json) -> list[Json]:
    """Errors of a motion as the API gives them, with the values of each."""
    try:
        application_of(motion)
    except ValidationError as refusal:
        context = {pointer(error["loc"]): error.get("ctx", {}) for error in refusal.errors()}
        return [entry | {"ctx": context[entry["pointer"]]} for entry in Problem.of(refusal).body()["errors"]]
    return []


def at(document: Any, pointer: str) -> Any:
    """Value at a JSON pointer; KeyError or IndexError where there is none."""
    for step in pointer.split("/")[1:]:
        document = document[int(step) if isinstance(document, list) else step]
    return document


NAMES = {
    "rotary": ("angle_deg", "speed_rpm", "acceleration_deg_per_s2"),
    "": ("distance_mm", "speed_mm_per_s", "acceleration_mm_per_s2"),
}
JERKS = {"rotary": "jerk_deg_per_s3", "": "jerk_mm_per_s3"}


@given(
    st.sampled_from(["rotary", ""]),
    st.sampled_from(["trapezoidal", "s_curve", "triangular"]),
    signs,
    st.floats(0.5, 900),
    st.tuples(*[st.none() | st.floats(0.01, 500)] * 3),
    st.sampled_from([None, 0.2, 1.0]),
)
def test_what_the_error_of_a_move_advises_works(
    kind: str, profile: str, sign: float, way: float, given_: tuple[float | None, ...], share: float | None
) -> None:
    names = NAMES[kind]
    move: Json = {"profile": profile, names[0]: sign * way}
    move |= {name: value for name, value in zip(("time_s", *names[1:]), given_, strict=True) if value is not None}
    if share is not None and profile == "s_curve":
        move |= {"jerk_share": share} if share < 1 else {JERKS[kind]: 10 * way}
    mechanism = {"type": "rotary", "inertia_kgm2": 1e-3} if kind else {"type": "belt", "mass_kg": 1, "diameter_mm": 50}
    body = {"mechanism": mechanism, "moves": [move]}

    for _ in range(3):
        errors = refusals(body)
        if not errors:
            break
        [error] = errors
        at({"duty_cycle": {"motion": body}}, error["pointer"])
        context, asked = error["ctx"], move
        if "fields" in context:
            kept = {"triangular": 1}.get(profile, 2)
            offered = [name for name in context["fields"].split(", ") if name in asked]
            for name in offered[kept:]:
                del asked[name]
            if not offered or (len(offered) == 1 and kept == 2 and offered != ["time_s"]):
                asked["time_s"] = 1.0
        else:
            field = error["pointer"].rpartition("/")[2]
            bound = float(str(context["bound"]).partition(" ")[0])
            asked[field] = bound if error["detail"].startswith(("must be at least", "must be at most")) else bound * 1.5
            assert str(context["bound"]).partition(" ")[0] in error["detail"]
    assert refusals(body) == []


@given(motions(), st.floats(1e-9, 1e-3))
def test_a_jerk_that_an_error_advises_works_and_none_below_it_does(motion: Json, low: float) -> None:
    """Every move is possible with some jerk, and with next to none none is."""
    turning = motion["mechanism"]["type"] == "rotary"
    name = JERKS["rotary" if turning else ""]
    light = (
        {"type": "rotary", "inertia_kgm2": 1e-9} if turning else {"type": "belt", "mass_kg": 1e-9, "diameter_mm": 50}
    )
    ramped = [move for move in motion["moves"] if move["profile"] in ("trapezoidal", "s_curve")]
    moves = [move | {"profile": "s_curve", name: low} for move in ramped]
    for move in moves:
        move.pop("jerk_share", None)
        body = {"mechanism": light, "moves": [move]}
        [error] = refusals(body)
        bound = float(str(error["ctx"]["bound"]).partition(" ")[0])
        move[name] = bound * (1 - 2e-5)  # it is said with six digits, rounded up
        assert [error["pointer"].rpartition("/")[2] for error in refusals(body)] == [name]
        move[name] = bound
        assert refusals(body) == []


@pytest.mark.parametrize("extra", ["speed_rpm", "jerk_share", "angle_deg", "acceleration_deg_per_s2"])
def test_a_field_that_a_dwell_has_no_use_for_is_refused_where_it_stands(extra: str) -> None:
    moves = [{"profile": "triangular", "angle_deg": 5, "time_s": 1}, {"profile": "dwell", "time_s": 1, extra: 0.5}]
    body = {"mechanism": {"type": "rotary", "inertia_kgm2": 1}, "moves": moves}

    [error] = refusals(body)
    assert error["pointer"] == f"/duty_cycle/motion/moves/1/{extra}"
    del moves[1][extra]
    assert refusals(body) == []


@given(rotary_motions() | linear_motions(), st.data())
def test_a_field_of_another_mechanism_or_its_moves_is_refused(motion: Json, data: st.DataObject) -> None:
    rotary = motion["mechanism"]["type"] == "rotary"
    place, name = data.draw(
        st.sampled_from(
            [
                ("mechanism", "lead_mm"),
                ("mechanism", "mass_kg"),
                ("moves", "distance_mm"),
                ("moves", "external_force_N"),
            ]
            if rotary
            else [("mechanism", "gravity_mass_kg"), ("moves", "angle_deg"), ("moves", "speed_rpm"), ("", "start_deg")]
        )
    )
    assume(name not in motion["mechanism"])
    body = copy.deepcopy(motion)
    target = body["mechanism"] if place == "mechanism" else body["moves"][0] if place else body
    target[name] = 1.0

    pointers = {error["pointer"] for error in refusals(body)}
    above = {"mechanism": "/mechanism", "moves": "/moves/0", "": ""}[place]
    assert f"/duty_cycle/motion{above}/{name}" in pointers


@given(st.lists(motions(), min_size=2, max_size=4))
def test_courses_that_are_computed_together_are_those_of_each_motion_alone(several: list[Json]) -> None:
    """To 1e-11: an instant at which the torque changes its sign is searched for until all of them are found."""
    moving = [application_of(motion).duty_cycle.motion for motion in several]
    parts = [(pieces_of(*one.driven), one.mechanism.load) for one in moving if one]
    for together, (pieces, load) in zip(courses_along(parts), parts, strict=True):
        alone = course_along(pieces, load)
        assert (together.move == alone.move).all() and (together.phase == alone.phase).all()
        for name in ("duration_s", "torque_Nm", "speed_rpm", "peak_torque_Nm", "rms_torque_Nm", "square_acceleration"):
            expected = getattr(alone, name)
            room = 1e-11 * np.abs(expected).max()
            assert np.allclose(getattr(together, name), expected, rtol=0, atol=room), name


@given(motions(), st.lists(st.floats(0.9, 1.1), min_size=1, max_size=3))
def test_a_changed_motion_is_the_one_that_is_typed_so_or_refused_like_it(motion: Json, factors: list[float]) -> None:
    """Two ways: changed with others at once, and each validated by itself as it is typed."""
    moving = application_of(motion).duty_cycle.motion
    name = "inertia_kgm2" if "inertia_kgm2" in motion["mechanism"] else "mass_kg"
    assert moving is not None
    times = [place for place, move in enumerate(motion["moves"]) if move.get("time_s")]
    assume(times)  # moves may all be given by speed and acceleration
    timed = times[0]

    def at(factor: float) -> dict[tuple[str | int, ...], float]:
        of_load, of_move = motion["mechanism"][name] * factor, motion["moves"][timed]["time_s"] * factor
        return {("mechanism", name): of_load, ("moves", timed, "time_s"): of_move}

    def typed(factor: float) -> Any:
        body = copy.deepcopy(motion)
        body["mechanism"][name], body["moves"][timed]["time_s"] = at(factor).values()
        return type(moving).model_validate(body)

    try:
        expected = [typed(factor) for factor in factors]
    except ValidationError:
        with pytest.raises(ValidationError):
            moving.changed([at(factor) for factor in factors])
        return
    changed = moving.changed([at(factor) for factor in factors])
    assert changed == expected
    for one, other in zip(changed, expected, strict=True):
        for figure in ("torque_Nm", "speed_rpm", "duration_s"):
            course = getattr(other.course, figure)
            assert np.allclose(getattr(one.course, figure), course, rtol=0, atol=1e-11 * np.abs(course).max())


@given(motions(), motions())
def test_a_motion_comes_to_the_same_whichever_were_asked_for_before(motion: Json, another: Json) -> None:
    course_of.cache_clear()
    first = application_of(motion).duty_cycle.load_phases
    application_of(another)
    kept = application_of(motion).duty_cycle.load_phases
    course_of.cache_clear()

    assert kept == first == application_of(motion).duty_cycle.load_phases
    changed = copy.deepcopy(motion)
    changed["mechanism"]["inertia_kgm2"] = changed["mechanism"].get("inertia_kgm2", 0) + 0.01
    course_of.cache_clear()
    expected = application_of(changed).duty_cycle.load_phases
    course_of.cache_clear()
    application_of(motion)
    assert application_of(changed).duty_cycle.load_phases == expected

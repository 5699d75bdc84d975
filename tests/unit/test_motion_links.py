"""Links of motions, of phases that vary and of motors: exact both ways, and each fault at its parameter."""

from itertools import cycle
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hpn.application import Application
from hpn.links.writer import to_link
from tests.property.draw import motions
from tests.unit.test_links import PHASE, applications, found, loaded, names, read, signed, some

TURN = "mech=rotary&J=0.8&mv=trapezoidal&ms=90&mt=0.8"
STROKE = "mech=ball_screw&h=10&ml=80&mv=trapezoidal&ms=500&mt=2"

ROTARY: dict[str, Any] = {
    "mechanism": {
        "type": "rotary",
        "inertia_kgm2": 0.8,
        "gravity_mass_kg": 12.0,
        "gravity_radius_mm": 250.0,
        "friction_torque_Nm": 1.5,
        "viscous_friction_Nm_per_rpm": 0.01,
        "efficiency": 0.9,
        "ratio": 2.0,
    },
    "start_deg": 30.0,
    "moves": [
        {"profile": "trapezoidal", "angle_deg": 90.0, "time_s": 0.8, "acceleration_deg_per_s2": 900.0},
        {"profile": "dwell", "time_s": 0.4, "external_torque_Nm": 30.0},
        {"profile": "s_curve", "angle_deg": -90.0, "time_s": 1.0, "speed_rpm": 25.0, "jerk_share": 0.25},
    ],
}


def application(motion: dict[str, Any], **more: Any) -> Application:
    return Application.model_validate({"duty_cycle": {"motion": motion}} | more)


def test_a_motion_has_the_link_of_the_contract() -> None:
    assert to_link(application(ROTARY, requirements={"motor": {"inertia_kgm2": 2e-4, "inertia_ratio": 5.0}})) == (
        "/?mech=rotary&J=0.8&mg=12&rg=250&Tf=1.5&b=0.01&etam=0.9&im=2&th0=30"
        "&mv=trapezoidal&ms=90&mt=0.8&mn=&ma=900&mj=&mx="
        "&mv=dwell&ms=&mt=0.4&mn=&ma=&mj=&mx=30"
        "&mv=s_curve&ms=-90&mt=1&mn=25&ma=&mj=0.25&mx="
        "&Jm=0.0002&Jr=5"
    )


def test_a_linear_motion_has_the_link_of_the_contract() -> None:
    screw = {"type": "ball_screw", "mass_kg": 80.0, "lead_mm": 10.0, "incline_deg": 30.0, "friction_coefficient": 0.05}
    screw |= {"friction_torque_Nm": 0.8, "friction_force_N": 24.5, "counterweight_kg": 40.0}
    move = {"profile": "triangular", "distance_mm": 500.0, "speed_mm_per_s": 400.0, "external_force_N": 200.0}
    loads = {"radial_N": 500.0, "axial_N": -20.0}
    linear = {"mechanism": screw, "moves": [move | loads, {"profile": "dwell", "time_s": 1.0}]}

    assert to_link(application(linear)) == (
        "/?mech=ball_screw&Tf=0.8&Ff=24.5&mc=40&h=10&ml=80&inc=30&mu=0.05"
        "&mv=triangular&ms=500&mt=&mn=400&mx=200&FRi=500&FAi=-20&mv=dwell&ms=&mt=1&mn=&mx=&FRi=&FAi="
    )


def test_a_jerk_stands_behind_its_share() -> None:
    curve = {"profile": "s_curve", "angle_deg": 90.0, "time_s": 1.0}
    moves = [curve | {"jerk_share": 0.25}, curve | {"jerk_deg_per_s3": 8e3}]
    assert to_link(application(ROTARY | {"moves": moves})).partition("&th0=30")[2] == (
        "&mv=s_curve&ms=90&mt=1&mj=0.25&mjk=&mv=s_curve&ms=90&mt=1&mj=&mjk=8000"
    )


def test_phases_that_vary_and_a_listed_motor_have_the_link_of_the_contract() -> None:
    link = "T=40&n=250&t=0.3&Tpk=55&npk=500&Trms=42&T=32&n=500&t=3&Tpk=&npk=&Trms=&JL=0.8&md=M%2040/B"
    form = read(link)
    assert form.application is not None
    first, second = form.application.duty_cycle.load_phases
    assert (first.peak_torque_Nm, first.peak_speed_rpm, first.rms_torque_Nm) == (55, 500, 42)
    assert (second.peak_torque_Nm, second.peak_speed_rpm, second.rms_torque_Nm) == (None, None, None)
    assert form.application.requirements.motor is not None
    assert form.application.requirements.motor.designation == "M 40/B"
    assert to_link(form.application) == f"/?{link}"


def with_loads(motion: dict[str, Any], loads: list[dict[str, Any]]) -> dict[str, Any]:
    """A motion whose moves carry these loads."""
    return motion | {"moves": [move | load for move, load in zip(motion["moves"], cycle(loads), strict=False)]}


carried = some(radial_N=signed, axial_N=signed, name=names)
moving = st.builds(with_loads, motions(), st.lists(carried, min_size=1, max_size=3))


@given(moving, applications.filter(loaded))
def test_every_motion_survives_its_link(motion: dict[str, Any], document: dict[str, Any]) -> None:
    ratio = {"inertia_kgm2": 0.0002, "inertia_ratio": 5.0}
    asked = {"requirements": document.get("requirements", {}) | {"motor": ratio}}
    duty_cycle = {"motion": motion, "pause_s": document["duty_cycle"].get("pause_s", 0.0)}
    kept = {name: part for name, part in document.items() if name != "output_load"}
    application = Application.model_validate(kept | asked | {"duty_cycle": duty_cycle})

    again = read(to_link(application).removeprefix("/?"))

    assert again.problems == ()
    assert again.application == application
    assert to_link(again.application) == to_link(application)


@pytest.mark.parametrize(
    ("query", "place", "said"),
    [
        (f"{PHASE}&{TURN}", ("T", 0), "give either phases or a motion"),
        (f"{TURN}&n=5", ("n", 0), "give either phases or a motion"),
        (TURN.replace("rotary", "lever"), ("mech", None), "must be one of rotary, rack_and_pinion"),
        ("J=0.8&mv=dwell&mt=1", ("mech", None), "is missing"),
        ("mech=rotary&J=0.8", ("mv", 0), "is missing"),
        ("mech=rotary&J=0.8&mv=dwell&mt=1", ("mv", 0), "nothing moves"),
        (TURN.replace("J=0.8&", ""), ("J", None), "is missing"),
        (TURN.replace("J=0.8", "J=0"), ("J", None), "must be above 0"),
        (TURN.replace("J=0.8", "J=0,8"), ("J", None), "write 0.8"),
        (f"{TURN}&J=1", ("J", None), "must be a single value"),
        (f"{TURN}&mg=12", ("mg", None), "gravity needs Its distance from the shaft as well"),
        (f"{TURN}&h=5", ("h", None), "does not belong to this mechanism"),
        (f"{STROKE}&th0=5", ("th0", None), "does not belong to this mechanism"),
        (f"{STROKE}&d=5", ("d", None), "does not belong to this mechanism"),
        (f"{STROKE}&mc=20", ("mc", None), "acts along an incline alone"),
        (f"{STROKE}&b=5", ("b", None), "does not belong to this mechanism"),
        (f"{TURN}&Ff=5", ("Ff", None), "does not belong to this mechanism"),
        (f"{TURN}&mjk=5", ("mjk", 0), "has no Jerk: leave it out"),
        (TURN.replace("trapezoidal", "s_curve") + "&mjk=5", ("mjk", 0), "must be at least 9492.19"),
        (TURN.replace("trapezoidal", "s_curve") + "&mjk=9999&mj=0.5", ("mjk", 0), "replaces Jerk share"),
        (f"{STROKE}&etam=1.5", ("etam", None), "must be at most 1"),
        (f"{STROKE}&inc=100", ("inc", None), "must be at most 90"),
        (f"{TURN}&mn=5", ("mn", 0), "must be above 18.75"),
        (f"{TURN}&mj=0.5", ("mj", 0), "has no Jerk share: leave it out"),
        (f"{TURN}&mv=dwell", ("ms", 1), "missing"),
        (f"{TURN}&mv=dwell&ms=&mt=x", ("mt", 1), "is not a number"),
        (f"{TURN}&FRi=1&mv=dwell&ms=&mt=1", ("FRi", 1), "missing"),
        (TURN.replace("trapezoidal", "sine"), ("mv", 0), "must be one of"),
        (f"{TURN}&JL=1", ("JL", None), "the load’s inertia follows from the motion"),
        (f"{TURN}&Jr=5", ("Jr", None), "needs “Inertia of the motor” as well"),
        (f"{PHASE}&Jr=5&Jm=1", ("Jr", None), "needs a motion, or “Inertia of the load”"),
        (f"{PHASE}&pem=1", ("pem", None), "needs “Radius of the position” as well"),
        (f"{PHASE}&TB=9&TL=9&To=3", ("To", None), "must be at least “Load’s torque in the stop”"),
        (f"{PHASE}&Lh=1e-300", ("Lh", None), "must be at least 1e-12"),
        (
            f"{PHASE}&nm=3000&Tm=9&Tmn=3&mcv=9",
            ("mcv", None),
            "point 1: give speed, continuous and peak torque, as 3000 : 2.4 : 7",
        ),
        (f"{PHASE}&Tpk=30", ("Tpk", 0), "must be at least 40"),
        (f"{PHASE}&Trms=41", ("Trms", 0), "must be at most 40"),
        (f"{PHASE}&npk=300&{PHASE}", ("npk", 1), "missing"),
        (f"{PHASE}&md=M&nm=3000", ("md", None), "selects a motor"),
    ],
)
def test_a_fault_stands_at_its_parameter(query: str, place: tuple[str, int | None], said: str) -> None:
    assert said in found(query)[place]


def test_blank_fields_of_a_form_beside_a_motion_count_as_absent() -> None:
    form = read(f"T=&n=&t=&Tpk=&{TURN}&mj=&mv=&ms=&mt=&mj=&d=&Jm=")
    assert form.problems == ()
    assert form.application == read(TURN).application
    assert [move["mv"] for move in form.moves] == ["trapezoidal", ""]


def test_blank_fields_of_a_motion_beside_phases_count_as_absent() -> None:
    form = read(f"{PHASE}&FRi=5&mech=&J=&mv=&ms=&mt=")
    assert form.problems == ()
    assert form.application == read(f"{PHASE}&FRi=5").application


def test_a_button_opens_and_closes_the_columns_of_what_varies_without_script() -> None:
    opened = read(f"{PHASE}&do=varying")
    blank = dict.fromkeys(("Tpk", "npk", "Trms", "Tlo"), "")
    assert [dict(row) for row in opened.rows] == [{"T": "40", "n": "250", "t": "0.3"} | blank]
    assert (opened.focus, opened.application) == ("varying", read(PHASE).application)
    closed = read(f"{PHASE}&Tpk=55&npk=&Trms=&do=varying")
    assert ("varying" in closed.groups, closed.application) == (False, read(PHASE).application)
    assert "varying" in read(f"{PHASE}&Tpk=&npk=&Trms=").groups

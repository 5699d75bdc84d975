"""Inputs of a pinion or pulley on the shaft: what is refused, what a link keeps, and what a remedy leaves as it is."""

from urllib.parse import parse_qsl

import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.duty import Duty
from hpn.engine.remedy import Way
from hpn.engine.tried import followed
from hpn.links.writer import to_link
from hpn.web.form.link_reader import parse
from tests.build import Json, answer, candidate, cycle, notices, phase
from tests.reference.test_shaft_load import MOVE, RACK, axis
from tests.unit.test_application import refused
from tests.unit.test_links import read

DRIVE: Json = {"type": "belt", "diameter_mm": 80.0}


@pytest.mark.parametrize(
    ("application", "place", "message"),
    [
        (cycle(phase(1, 1), output_load={"from_motion": True}), ("from_motion",), "motion of a rack or belt"),
        (axis(RACK | {"ratio": 2}), ("from_motion",), "ratio 1"),
        (axis({"type": "ball_screw", "mass_kg": 1, "lead_mm": 5}), ("from_motion",), "rack or belt"),
        (axis(drive=DRIVE, from_motion=False), ("drive",), "typed phases"),
        (axis(drive=DRIVE), ("drive",), "typed phases"),
        (cycle(phase(1, 1), output_load={"drive": DRIVE, "from_motion": True}), ("from_motion",), "motion"),
        (cycle(phase(1, 1), output_load={"drive": {"type": "belt"}}), ("drive", "diameter_mm"), "required"),
        (cycle(phase(1, 1), output_load={"drive": DRIVE | {"type": "rotary"}}), ("drive", "type"), "belt"),
        (cycle(phase(1, 1), output_load={"drive": DRIVE, "rack_helix_deg": 46}), ("rack_helix_deg",), "45"),
        (cycle(phase(1, 1), output_load={"drive": DRIVE, "belt_tension_factor": 0.9}), ("belt_tension_factor",), "1"),
        (cycle(phase(1, 1), output_load={"from_motion": False}), (), "no load"),
    ],
)
def test_a_drive_is_refused_where_it_stands(application: Json, place: tuple[str, ...], message: str) -> None:
    errors = refused(application)
    assert list(errors) == [("output_load", *place)]
    assert message in errors["output_load", *place]


@pytest.mark.parametrize(
    ("application", "end"),
    [
        (axis(belt_tension_factor=1.5), "&fm=1&kb=1.5&size=20A"),
        (axis(rack_helix_deg=20.0, radial_N=5.0), "&FR=5&fm=1&hx=20&size=20A"),
        (cycle(phase(1, 1), output_load={"drive": DRIVE}), "&dt=belt&dd=80"),
    ],
)
def test_a_link_keeps_what_sits_on_the_shaft(application: Json, end: str) -> None:
    question = Application.model_validate(application)
    link = to_link(question)
    assert link.endswith(end)
    assert read(link.removeprefix("/?")).application == question


def test_one_press_counts_the_load_of_the_motion() -> None:
    link = to_link(Application.model_validate({"duty_cycle": axis()["duty_cycle"]})).removeprefix("/?")
    pressed = parse([*parse_qsl(link), ("do", "from_motion")])
    assert pressed.application is not None and pressed.application.shaft_drive == "rack_and_pinion"
    assert pressed.focus == "f-fm"


@pytest.mark.parametrize(
    ("changed", "has_notice"),
    [
        ({}, True),
        ({"type": "belt"}, True),
        ({"ratio": 2}, False),
    ],
)
def test_an_uncounted_load_is_told_where_a_wheel_may_sit_on_the_shaft(
    catalogue: Catalogue, changed: Json, has_notice: bool
) -> None:
    def told_of(move: Json, **load: Json) -> bool:
        motion = {"mechanism": RACK | changed, "moves": [move]}
        return "shaft_load_of_motion" in notices(answer({"duty_cycle": {"motion": motion}} | load, catalogue))

    assert told_of(MOVE) is told_of(MOVE, output_load={"axial_N": 9}) is has_notice
    assert not told_of(MOVE, output_load={"radial_N": 9})
    assert not told_of(MOVE | {"radial_N": 9})
    if has_notice:
        assert not told_of(MOVE, output_load={"from_motion": True})


def radial_of(application: Application) -> list[float]:
    return [float(load) for load in Duty.of([application]).phases.radial_N[0, 0]]


def test_trying_fewer_newton_metres_keeps_the_load_of_the_motion_as_it_came_out() -> None:
    application = Application.model_validate(axis(radial_N=100.0))
    tried = followed(application, Way(torque=0.8, load=0.5))
    assert tried.duty_cycle.motion is None and tried.output_load is not None and not tried.output_load.from_motion
    assert radial_of(tried) == pytest.approx([load - 50 for load in radial_of(application)], rel=1e-12)
    assert Application.model_validate(tried.model_dump()) == tried
    scaled = followed(application, Way(load=0.5))
    assert scaled.shaft_drive == "rack_and_pinion"
    assert radial_of(scaled) == pytest.approx([load - 50 for load in radial_of(application)], rel=1e-12)


def test_a_remedy_names_what_relieves_the_shaft(catalogue: Catalogue) -> None:
    heavy = axis(RACK | {"mass_kg": 300}, MOVE) | {"requirements": {"sizes": ["11A"]}}
    reply = answer(heavy, catalogue)
    result = candidate(reply, "HPN-11A-5")
    assert result["governing_check"].startswith("output_bearing")
    assert result["reserve"]["load_factor"] is None
    assert result["reserve"]["torque_factor"] == pytest.approx(1 / result["utilisation"], rel=1e-12)

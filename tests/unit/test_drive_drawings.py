"""Drawings of motions and of torques at their speeds: what is read off their axes is what the figures say."""

import itertools
from xml.etree.ElementTree import Element

import numpy as np
import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue, load_catalogue
from hpn.engine.candidates import Candidate
from hpn.engine.selection import select
from hpn.explain.drawings import Subject
from hpn.explain.drawings.plane import gear_plane, motor_plane
from hpn.explain.drawings.svg import markup, runs
from hpn.physics.motion import trace_of
from hpn.words.reader import Reader
from tests.build import Json, cycle, phase
from tests.conftest import Supplement
from tests.reference.test_motion import CONTRACT, SCREW
from tests.unit.test_envelope import Point, Shown

CATALOGUE: Catalogue = load_catalogue()
TYPED = cycle(
    phase(40, 250, 0.3), phase(-32, 500, 3, peak_torque_Nm=60, peak_speed_rpm=660), phase(20, 0, 0.4), pause_s=4
)
TURNING: Json = {"duty_cycle": {"motion": CONTRACT, "pause_s": 1.0}}
LIFTING: Json = {"duty_cycle": {"motion": SCREW}}


def subject_of(document: Json, designation: str = "HPN-20A-5", catalogue: Catalogue = CATALOGUE) -> Subject:
    return Subject(Application.model_validate(document), catalogue.by_designation[designation], catalogue)


def candidate_of(subject: Subject) -> Candidate:
    result = select(subject.application, subject.catalogue).candidate(subject.gear.designation)
    assert result is not None
    return result


def near(expected: list[Point], shown: Shown) -> object:
    """The same points, to what a thousandth of a unit of the drawing is, and half of one of its ticks."""
    return pytest.approx(np.array(expected).ravel(), abs=0.01 * max(abs(shown.across[1]), abs(shown.down[1])))


def flat(points: list[Point]) -> list[float]:
    return [value for point in points for value in point]


# --- Torque against speed ---------------------------------------------------------------------------------------------


def test_phases_and_averages_stand_at_their_torque_and_speed_within_the_limits_of_the_gear() -> None:
    subject = subject_of(TYPED)
    view = Shown(gear_plane(subject).drawing)
    gear, duty = subject.gear, subject.duty

    assert sorted(view.dots("load")) == [pytest.approx(p, abs=0.5) for p in [(0, 20), (250, 40), (660, 60)]]
    means = [(duty.average_output_speed_rpm.item(), duty.average_torque_Nm.item())]
    assert flat(view.dots("equivalent")) == near(means, view)
    assert flat(view.dots("mean")) == near([(500, 32)], view)
    assert flat(view.line("span")[0]) == near([(500, 32), (660, 60)], view)
    assert gear.rated_torque_Nm and gear.average_input_speed_rpm and gear.maximum_input_speed_rpm
    n = gear.average_input_speed_rpm / 5
    across, down = view.line("mean")
    assert flat(across) == near([(0, gear.rated_torque_Nm), (n, gear.rated_torque_Nm)], view)
    assert flat(down) == near([(n, gear.rated_torque_Nm), (n, 0)], view)
    assert flat(view.line("limit")[-1])[::2] == near([(gear.maximum_input_speed_rpm / 5,) * 2], view)


def test_a_limit_far_beyond_the_cycle_is_named_with_an_arrow_and_leaves_the_scale_to_the_cycle() -> None:
    view = Shown(gear_plane(subject_of(cycle(phase(2, 20))), Reader(language="de")).drawing, ",")

    assert view.line("limit") == view.line("mean") == []
    named = [Shown.said(text) for text in view.of("text", "beyond")]
    gear = CATALOGUE.by_designation["HPN-20A-5"]
    assert named[0].startswith(f"↑ T_R {gear.repeated_peak_torque_Nm:g}".replace("T_R", "TR"))
    assert "→" in named[0]
    assert view.load((400 - 12, 26))[0] == pytest.approx(1.15 * 20, rel=1e-3)


def test_with_a_reserve_of_their_own_limits_are_drawn_where_it_puts_them() -> None:
    view = Shown(gear_plane(subject_of(TYPED | {"requirements": {"utilisation": 0.8}})).drawing)
    gear = CATALOGUE.by_designation["HPN-20A-5"]

    assert gear.rated_torque_Nm
    assert view.line("mean")[0][0][1] == pytest.approx(0.8 * gear.rated_torque_Nm, abs=0.2)
    assert "u·TN" in {Shown.said(text) for text in view.of("text", "name")}


@pytest.mark.parametrize("document", [TURNING, LIFTING])
def test_the_curve_of_a_motion_goes_through_its_largest_torque_and_speed(document: Json) -> None:
    subject = subject_of(document)
    view = Shown(gear_plane(subject).drawing)
    points = np.array([point for curve in view.line("curve") for point in curve])

    assert points[:, 0].max() == pytest.approx(subject.duty.maximum_output_speed_rpm.item(), rel=1e-3)
    assert points[:, 1].max() == pytest.approx(subject.duty.maximum_torque_Nm.item(), rel=1e-3)
    trace = trace_of(subject.duty.courses[0])
    known = np.stack((np.abs(trace.speed_rpm).ravel(), np.abs(trace.torque_Nm).ravel()), axis=1)
    scale = known.max(axis=0)
    gaps = [np.abs((known - point) / scale).max(axis=1).min() for point in points]
    assert max(gaps) < 1e-3


@pytest.mark.parametrize("motor", [{}, {"inertia_kgm2": 0.004}, {"inertia_kgm2": 0.004, "peak_torque_Nm": 9.0}])
@pytest.mark.parametrize("document", [TYPED, TURNING, LIFTING])
def test_peak_and_rms_at_the_motor_are_those_of_the_checks(document: Json, motor: Json) -> None:
    subject = subject_of(document | {"requirements": {"motor": motor, "efficiency": 0.85}})
    candidate = candidate_of(subject)
    view = Shown(motor_plane(subject).drawing)

    points = [*(point for curve in view.line("curve") for point in curve), *view.dots("load")]
    assert max(T for _, T in points) == pytest.approx(candidate.motor_peak_torque_Nm, rel=2e-3)
    assert max(n for n, _ in points) == pytest.approx(candidate.maximum_input_speed_rpm, rel=2e-3)
    [(n, T)] = view.dots("equivalent")
    assert n == pytest.approx(candidate.average_input_speed_rpm, rel=2e-3)
    assert pytest.approx(candidate.motor_rated_torque_Nm, rel=5e-3) == T


def test_a_listed_motor_brings_its_limits_and_its_inertia(supplemented: Supplement) -> None:
    header = "designation,maximum_speed_rpm,rated_speed_rpm,rated_torque_Nm,peak_torque_Nm,inertia_kgm2,source\n"
    catalogue = supplemented(motors=header + "M 1,150,100,6,18,0.004,\n")
    listed = subject_of(TURNING | {"requirements": {"motor": {"designation": "M 1"}}}, catalogue=catalogue)
    figures = {"maximum_speed_rpm": 150, "rated_speed_rpm": 100, "rated_torque_Nm": 6, "peak_torque_Nm": 18}
    typed = subject_of(TURNING | {"requirements": {"motor": figures | {"inertia_kgm2": 0.004}}})

    assert markup(motor_plane(listed).drawing) == markup(motor_plane(typed).drawing)


@pytest.mark.parametrize("document", [TYPED, TURNING, LIFTING])
def test_no_disc_lies_over_another_or_outside_the_axes(document: Json) -> None:
    for plane in (gear_plane(subject_of(document)), motor_plane(subject_of(document))):
        discs = Shown(plane.drawing).of("rect", "disc")
        boxes = [[float(disc.get(name, "")) for name in ("x", "y", "width", "height")] for disc in discs]
        assert boxes
        for x, y, width, height in boxes:
            assert x >= 0
            assert y >= 0
            assert x + width <= 400
            assert y + height <= 260
        for (x1, y1, w1, h1), (x2, y2, w2, h2) in itertools.combinations(boxes, 2):
            assert x1 + w1 <= x2 or x2 + w2 <= x1 or y1 + h1 <= y2 or y2 + h2 <= y1


def test_a_limit_next_to_the_edge_keeps_its_name() -> None:
    gear = CATALOGUE.by_designation["HPN-20A-4"]
    assert gear.maximum_input_speed_rpm
    fast = cycle(phase(40, 0.9 * gear.maximum_input_speed_rpm / 4)) | {"requirements": {"utilisation": 0.9}}
    view = Shown(gear_plane(subject_of(fast, gear.designation)).drawing)

    assert "u·nin(max)/i" in {Shown.said(text) for text in view.of("text", "name")}


def test_planes_say_in_words_what_they_show() -> None:
    document = TYPED | {"requirements": {"motor": {"peak_torque_Nm": 14.0}, "efficiency": 0.8}}
    german = Reader(language="de")
    subject = subject_of(document)

    gear = " ".join(map(german.sentence, gear_plane(subject, german).words))
    motor = " ".join(map(german.sentence, motor_plane(subject, german).words))
    assert gear.startswith("Größtes Drehmoment 60\u202fNm von 149\u202fNm, größte Drehzahl 660")
    assert motor.startswith("Größtes Drehmoment 15\u202fNm von 14\u202fNm, größte Drehzahl 3.300")


def test_what_follows_an_index_stands_on_the_line_again() -> None:
    """Shifts add up along a text: 3 down for the index, 3 up once behind it, and none for a letter without one."""
    element = runs(Element("g"), "name", (0.0, 0.0), [("limit", "n_av(max)/i 750"), ("limit", "T_R")])
    values = [(run.text, float(run.get("dy", "0"))) for run in element]
    assert values == [
        *(("n", 0.0), ("av(max)", 3.0), ("/", -3.0), ("i", 0.0), (" 750", 0.0)),
        *(("\N{EN SPACE}", 0.0), ("T", 0.0), ("R", 3.0)),
    ]

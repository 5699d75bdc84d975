"""Drawings of motions and of torques at their speeds: what is read off their axes is what the figures say."""

import itertools
import math
import re
from xml.etree.ElementTree import Element, fromstring

import numpy as np
import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue, load_catalogue
from hpn.engine.selection import Candidate, select
from hpn.explain import drawings
from hpn.explain.drawings import Subject
from hpn.explain.drawings.svg import markup
from hpn.physics.motion import trace_of
from hpn.words.reader import Reader
from tests.build import Json, cycle, phase
from tests.conftest import Supplement
from tests.reference.test_motion import CONTRACT, SCREW
from tests.unit.test_envelope import SVG, Point, Shown

CATALOGUE: Catalogue = load_catalogue()
TYPED = cycle(
    phase(40, 250, 0.3), phase(-32, 500, 3, peak_torque_Nm=60, peak_speed_rpm=660), phase(20, 0, 0.4), pause_s=4
)
TURNING: Json = {"duty_cycle": {"motion": CONTRACT, "pause_s": 1.0}}
LIFTING: Json = {"duty_cycle": {"motion": SCREW}}


def subject_of(document: Json, designation: str = "HPN-20A-5", catalogue: Catalogue = CATALOGUE) -> Subject:
    return Subject(Application.model_validate(document), catalogue.by_designation[designation], catalogue)


def candidate_of(subject: Subject) -> Candidate:
    found = select(subject.application, subject.catalogue).candidate(subject.gear.designation)
    assert found is not None
    return found


def near(expected: list[Point], shown: Shown) -> object:
    """The same points, to what a thousandth of a unit of the drawing is, and half of one of its ticks."""
    return pytest.approx(np.array(expected).ravel(), abs=0.01 * max(abs(shown.across[1]), abs(shown.down[1])))


def flat(points: list[Point]) -> list[float]:
    return [value for point in points for value in point]


# --- Torque against speed ---------------------------------------------------------------------------------------------


def test_phases_and_averages_stand_at_their_torque_and_speed_within_the_limits_of_the_gear() -> None:
    subject = subject_of(TYPED)
    shown = Shown(drawings.gear_plane(subject).drawing)
    gear, duty = subject.gear, subject.duty

    assert sorted(shown.dots("load")) == [pytest.approx(p, abs=0.5) for p in [(0, 20), (250, 40), (660, 60)]]
    means = [(duty.average_output_speed_rpm.item(), duty.average_torque_Nm.item())]
    assert flat(shown.dots("equivalent")) == near(means, shown)
    assert flat(shown.dots("mean")) == near([(500, 32)], shown)
    assert flat(shown.line("span")[0]) == near([(500, 32), (660, 60)], shown)
    assert gear.rated_torque_Nm and gear.average_input_speed_rpm and gear.maximum_input_speed_rpm
    n = gear.average_input_speed_rpm / 5
    across, down = shown.line("mean")
    assert flat(across) == near([(0, gear.rated_torque_Nm), (n, gear.rated_torque_Nm)], shown)
    assert flat(down) == near([(n, gear.rated_torque_Nm), (n, 0)], shown)
    assert flat(shown.line("limit")[-1])[::2] == near([(gear.maximum_input_speed_rpm / 5,) * 2], shown)


def test_a_limit_far_beyond_the_cycle_is_named_with_an_arrow_and_leaves_the_scale_to_the_cycle() -> None:
    shown = Shown(drawings.gear_plane(subject_of(cycle(phase(2, 20))), Reader(language="de")).drawing, ",")

    assert shown.line("limit") == shown.line("mean") == []
    named = [Shown.said(text) for text in shown.of("text", "beyond")]
    gear = CATALOGUE.by_designation["HPN-20A-5"]
    assert named[0].startswith(f"↑ T_R {gear.repeated_peak_torque_Nm:g}".replace("T_R", "TR"))
    assert "→" in named[0]
    assert shown.load((440 - 16, 8))[0] == pytest.approx(1.15 * 20, rel=1e-3)


def test_with_a_reserve_of_their_own_limits_are_drawn_where_it_puts_them() -> None:
    shown = Shown(drawings.gear_plane(subject_of(TYPED | {"requirements": {"utilisation": 0.8}})).drawing)
    gear = CATALOGUE.by_designation["HPN-20A-5"]

    assert gear.rated_torque_Nm
    assert shown.line("mean")[0][0][1] == pytest.approx(0.8 * gear.rated_torque_Nm, abs=0.2)
    assert "u·TN" in {Shown.said(text) for text in shown.of("text", "name")}


@pytest.mark.parametrize("document", [TURNING, LIFTING])
def test_the_curve_of_a_motion_goes_through_its_largest_torque_and_speed(document: Json) -> None:
    subject = subject_of(document)
    shown = Shown(drawings.gear_plane(subject).drawing)
    points = np.array([point for curve in shown.line("curve") for point in curve])

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
    shown = Shown(drawings.motor_plane(subject).drawing)

    points = [*(point for curve in shown.line("curve") for point in curve), *shown.dots("load")]
    assert max(T for _, T in points) == pytest.approx(candidate.motor_peak_torque_Nm, rel=2e-3)
    assert max(n for n, _ in points) == pytest.approx(candidate.maximum_input_speed_rpm, rel=2e-3)
    [(n, T)] = shown.dots("equivalent")
    assert n == pytest.approx(candidate.average_input_speed_rpm, rel=2e-3)
    assert pytest.approx(candidate.motor_rated_torque_Nm, rel=5e-3) == T


def test_a_listed_motor_brings_its_limits_and_its_inertia(supplemented: Supplement) -> None:
    header = "designation,maximum_speed_rpm,rated_speed_rpm,rated_torque_Nm,peak_torque_Nm,inertia_kgm2,source\n"
    catalogue = supplemented(motors=header + "M 1,150,100,6,18,0.004,\n")
    listed = subject_of(TURNING | {"requirements": {"motor": {"designation": "M 1"}}}, catalogue=catalogue)
    figures = {"maximum_speed_rpm": 150, "rated_speed_rpm": 100, "rated_torque_Nm": 6, "peak_torque_Nm": 18}
    typed = subject_of(TURNING | {"requirements": {"motor": figures | {"inertia_kgm2": 0.004}}})

    assert markup(drawings.motor_plane(listed).drawing) == markup(drawings.motor_plane(typed).drawing)


@pytest.mark.parametrize("document", [TYPED, TURNING, LIFTING])
def test_no_disc_lies_over_another_or_outside_the_axes(document: Json) -> None:
    for plane in (drawings.gear_plane(subject_of(document)), drawings.motor_plane(subject_of(document))):
        discs = Shown(plane.drawing).of("rect", "disc")
        boxes = [[float(disc.get(name, "")) for name in ("x", "y", "width", "height")] for disc in discs]
        assert boxes
        for x, y, width, height in boxes:
            assert x >= 0
            assert y >= 0
            assert x + width <= 440
            assert y + height <= 250
        for (x1, y1, w1, h1), (x2, y2, w2, h2) in itertools.combinations(boxes, 2):
            assert x1 + w1 <= x2 or x2 + w2 <= x1 or y1 + h1 <= y2 or y2 + h2 <= y1


def test_a_limit_next_to_the_edge_keeps_its_name() -> None:
    gear = CATALOGUE.by_designation["HPN-20A-4"]
    assert gear.maximum_input_speed_rpm
    fast = cycle(phase(40, 0.9 * gear.maximum_input_speed_rpm / 4)) | {"requirements": {"utilisation": 0.9}}
    shown = Shown(drawings.gear_plane(subject_of(fast, gear.designation)).drawing)

    assert "u·nin(max)/i" in {Shown.said(text) for text in shown.of("text", "name")}


def test_planes_say_in_words_what_they_show() -> None:
    document = TYPED | {"requirements": {"motor": {"peak_torque_Nm": 14.0}, "efficiency": 0.8}}
    german = Reader(language="de")
    subject = subject_of(document)

    gear = " ".join(map(german.told, drawings.gear_plane(subject, german).words))
    motor = " ".join(map(german.told, drawings.motor_plane(subject, german).words))
    assert gear.startswith("Größtes Drehmoment 60\u202fNm von 149\u202fNm, größte Drehzahl 660")
    assert motor.startswith("Größtes Drehmoment 15\u202fNm von 14\u202fNm, größte Drehzahl 3.300")


# --- The motion over time ---------------------------------------------------------------------------------------------


class Diagrams:
    """The drawing of a motion as a reader sees it: each curve by the numbers on its own axis."""

    def __init__(self, drawing: Element) -> None:
        self.root = fromstring(markup(drawing))
        self.curves = [self.read(place) for place in range(4)]

    def of(self, name: str, kind: str) -> list[Element]:
        return [each for each in self.root.iter(SVG + name) if kind in each.get("class", "").split()]

    def read(self, place: int) -> list[float]:
        """Values of a curve, from the top the `place`th."""
        children = list(self.root)
        start = [k for k, each in enumerate(children) if each.get("class") == "title"][place]
        steps = next(k for k in range(start, len(children)) if children[k].get("class") == "steps")
        ticks = [each for each in children[start:steps] if each.get("class") == "tick"]
        (y0, v0), (y1, v1) = ((float(t.get("y", "")), self.number(t)) for t in (ticks[0], ticks[-1]))
        heights = [float(y) + 4 for _, y in re.findall(r"(-?[\d.]+) (-?[\d.]+)", children[steps].get("d", ""))]
        return [v0 + (y - y0) * (v1 - v0) / (y1 - y0) for y in heights]

    @staticmethod
    def number(text: Element) -> float:
        return float("".join(text.itertext()).replace("\u202f", "").replace("\N{MINUS SIGN}", "-"))


def drawn(document: Json, reader: Reader | None = None) -> Diagrams:
    drawing = drawings.motion_drawing(subject_of(document), reader or Reader())
    assert drawing is not None
    return Diagrams(drawing)


@pytest.mark.parametrize("document", [TURNING, LIFTING])
def test_the_curves_of_a_motion_reach_from_its_least_to_its_largest_values(document: Json) -> None:
    motion = subject_of(document).application.duty_cycle.motion
    assert motion is not None
    trace, load = trace_of(motion.course), motion.mechanism.load
    way = load.way_per_rad / load.ratio if document is LIFTING else math.degrees(1)

    values = (trace.angle_rad * way, trace.speed_rpm, trace.acceleration_rad_per_s2 * way, trace.torque_Nm)
    for curve, expected in zip(drawn(document).curves, values, strict=True):
        span = expected.max() - expected.min()
        assert min(curve) == pytest.approx(expected.min(), abs=0.005 * span)
        assert max(curve) == pytest.approx(expected.max(), abs=0.005 * span)


def test_phases_are_marked_where_they_begin_and_the_pause_behind_them() -> None:
    diagrams = drawn(TURNING)
    phases = [float(step.get("x", "")) for step in diagrams.of("rect", "phase-step")]
    [pause] = diagrams.of("rect", "pause")
    motion = subject_of(TURNING).application.duty_cycle.motion
    assert motion is not None
    begun = np.concatenate(([0.0], np.cumsum(motion.course.duration_s)))

    left, right = phases[0], float(pause.get("x", ""))
    assert [*phases, right] == pytest.approx(left + begun / begun[-1] * (right - left), abs=0.01)
    assert [step.get("data-phase") for step in diagrams.of("rect", "phase-step")] == [
        str(k) for k in range(len(motion.phases))
    ]


def test_typed_phases_have_no_drawing_of_a_motion() -> None:
    assert drawings.motion_drawing(subject_of(TYPED)) is None
    assert drawings.motion_words(subject_of(TYPED)) == []


@pytest.mark.parametrize("gravity", [{}, {"gravity_mass_kg": 3, "gravity_radius_mm": 100}])
def test_a_thousand_moves_make_a_small_drawing_that_misses_no_peak(gravity: Json) -> None:
    moves = [{"profile": "s_curve", "angle_deg": (90 + k) * (-1) ** k, "time_s": 1} for k in range(600)]
    document: Json = {
        "duty_cycle": {"motion": {"mechanism": {"type": "rotary", "inertia_kgm2": 1} | gravity, "moves": moves}}
    }
    subject = subject_of(document)
    drawing = drawings.motion_drawing(subject)
    assert drawing is not None

    assert len(markup(drawing)) < 200_000
    peak = max(map(abs, Diagrams(drawing).curves[3]))
    assert peak == pytest.approx(subject.duty.maximum_torque_Nm.item(), rel=0.01)


def test_a_motion_is_told_in_the_readers_language_and_units() -> None:
    reader = Reader(language="de", units=("lb_in",))
    words = " ".join(map(reader.told, drawings.motion_words(subject_of(LIFTING))))

    assert words.startswith("Bewegung von ")
    assert "lb·in" in words
    assert "Weg und Beschleunigung gelten für die Last" in words
    titles = {"".join(t.itertext()) for t in drawn(TURNING, Reader(language="de")).of("text", "title")}
    assert titles == {"Winkel in °", "Drehzahl in min⁻¹", "Beschleunigung in °/s²", "Drehmoment in Nm", "Zeit in s"}

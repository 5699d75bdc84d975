"""Drawings over time, of cycles and of motions: their curves, read off the numbers beside them, are the figures."""

import math
import re
from collections.abc import Iterator, Sequence
from itertools import combinations, pairwise
from xml.etree.ElementTree import Element, fromstring

import numpy as np
import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue, load_catalogue
from hpn.explain import drawings
from hpn.explain.drawings import Subject
from hpn.explain.drawings.cycle import CyclePicture
from hpn.explain.drawings.svg import markup
from hpn.physics.motion import trace_of
from hpn.words.reader import DEFAULT, Reader
from tests.build import Json, cycle, phase
from tests.reference.test_motion import CONTRACT, SCREW

CATALOGUE: Catalogue = load_catalogue()
EXAMPLE = (phase(40, 250, 0.3), phase(32, 500, 3), phase(-20, -250, 0.4))
STOPPED = cycle(*EXAMPLE, pause_s=4.0, emergency_stop={"torque_Nm": 200.0})
TURNING: Json = {"duty_cycle": {"motion": CONTRACT, "pause_s": 1.0}}
LIFTING: Json = {"duty_cycle": {"motion": SCREW}}


class Shown:
    """A drawing as a reader sees it: each curve by the numbers on its own axis."""

    def __init__(self, drawing: Element) -> None:
        self.root = fromstring(markup(drawing))
        self.curves = [self.read(place) for place in range(len(self.of("text", "title")))]

    def of(self, name: str, kind: str) -> list[Element]:
        """Elements of a name whose class holds a kind."""
        return [each for each in self.root.iter(name) if kind in each.get("class", "").split()]

    def said(self, kind: str) -> list[str]:
        return ["".join(text.itertext()) for text in self.of("text", kind)]

    def read(self, place: int, kind: str = "steps") -> list[float]:
        """Values of a curve, from the top the `place`th."""
        children = list(self.root)
        start = [k for k, each in enumerate(children) if each.get("class") == "title"][place]
        line = next(k for k in range(start, len(children)) if children[k].get("class") == kind)
        ticks = [each for each in children[start:line] if "tick" in each.get("class", "").split()]
        (y0, v0), (y1, v1) = ((float(t.get("y", "")), self.number(t)) for t in (ticks[0], ticks[-1]))
        heights = [float(y) + 4 for _, y in re.findall(r"(-?[\d.]+) (-?[\d.]+)", children[line].get("d", ""))]
        return [v0 + (y - y0) * (v1 - v0) / (y1 - y0) for y in heights]

    @staticmethod
    def number(text: Element) -> float:
        return float("".join(text.itertext()).replace("\u202f", "").replace("\N{MINUS SIGN}", "-").replace(",", "."))


def subject_of(document: Json, designation: str = "HPN-20A-5") -> Subject:
    return Subject(Application.model_validate(document), CATALOGUE.by_designation[designation], CATALOGUE)


def picture_of(
    document: Json,
    reader: Reader = DEFAULT,
    governing: Sequence[int] = (),
    check: str | None = None,
    *,
    designation: str = "HPN-20A-5",
) -> CyclePicture:
    subject = subject_of(document, designation)
    return drawings.cycle_picture(subject.application, subject, reader, governing, check)


def drawn(document: Json, reader: Reader = DEFAULT, governing: Sequence[int] = (), check: str | None = None) -> Shown:
    return Shown(picture_of(document, reader, governing, check).drawing)


def texts(shown: Shown, letter: float = 6.8) -> Iterator[tuple[str, float, float, float, float]]:
    """Text, left, right, top and bottom of every text, by the mean width of the page's letters; an index is smaller."""
    for text in shown.root.iter("text"):
        message = "".join(text.itertext())
        index = sum(len("".join(part.itertext())) for part in text.iter("tspan") if "index" in part.get("class", ""))
        width = letter * (len(message) - 0.2 * index)
        x, y = float(text.get("x", "")), float(text.get("y", ""))
        left = x - {"start": 0.0, "middle": 0.5, "end": 1.0}[text.get("text-anchor", "start")] * width
        yield message, left, left + width, y - 9, y + 2


# --- Phases -----------------------------------------------------------------------------------------------------------


def test_steps_are_the_torques_and_speeds_of_the_phases_and_the_pause_is_zero() -> None:
    torque, speed = drawn(cycle(*EXAMPLE, pause_s=4.0)).curves

    assert torque == pytest.approx([0, 40, 40, 32, 32, -20, -20, 0, 0, 0], abs=0.05)
    assert speed == pytest.approx([0, 250, 250, 500, 500, -250, -250, 0, 0, 0], abs=0.5)


def test_peaks_have_a_line_of_their_own_with_the_sign_of_the_mean_within_the_frame() -> None:
    varying = (phase(30, 100, peak_torque_Nm=45), phase(-20, -80, peak_torque_Nm=33, peak_speed_rpm=120))
    view = drawn(cycle(*varying))

    assert view.read(0, "peaks") == pytest.approx([45, 45, -33, -33], abs=0.05)
    assert view.read(1, "peaks") == pytest.approx([100, 100, -120, -120], abs=0.1)
    assert drawn(cycle(*EXAMPLE)).of("path", "peaks") == []


@pytest.mark.parametrize("count", [1, 3, 24, 25, 50, 10_000])
def test_the_cycle_is_drawn_within_its_frame_and_its_numbers_stand_apart(count: int) -> None:
    phases = [phase((-1) ** k * 10.0 * (k % 7), 100.0, 1e-3 if k % 2 else 5.0) for k in range(count)]
    picture = picture_of(cycle(*phases, pause_s=3.0))
    view = Shown(picture.drawing)

    discs = [float(disc.get("cx", "")) for disc in view.of("circle", "disc")]
    assert len(discs) == {1: 1, 3: 3}.get(count, len(discs))
    assert (len(discs) > 0) == (count <= 24)
    assert view.said("phase") == (["tp"] if count <= 24 else [f"1 … {count}", "tp"])
    places = sorted([*discs, float(view.of("text", "phase")[-1].get("x", ""))])
    assert min((after - before for before, after in pairwise(places)), default=18) >= 18  # a disc, and a little more
    assert len(markup(picture.drawing)) < 75_000
    _, _, width, height = map(float, picture.drawing.get("viewBox", "").split())
    for path in view.root.iter("path"):
        for x, y in re.findall(r"(-?[\d.]+) (-?[\d.]+)", path.get("d", "")):
            assert 0 <= float(x) <= width
            assert 0 <= float(y) <= height


def test_ten_thousand_phases_miss_no_peak() -> None:
    phases = [phase(10.0 + (k == 7123) * 90, 100.0 - (k == 77) * 250, 1.0) for k in range(10_000)]
    torque, speed = drawn(cycle(*phases)).curves
    assert [max(torque), min(speed)] == pytest.approx([100, -150], abs=0.5)


def test_extreme_durations_stay_in_the_frame_and_the_note_says_that_they_are_not_to_scale() -> None:
    document = cycle(phase(1e6, 1e6, 1e9), phase(1e-300, 1e-6, 1e-300), pause_s=1e9)
    picture = picture_of(document, designation="HPN-11A-4")
    assert picture.note is not None
    assert picture.note.text == "Short phases are drawn wider than they are."
    assert "nan" not in markup(picture.drawing).replace("governing", "")
    long = picture_of(cycle(*EXAMPLE, pause_s=1e5)).note
    assert long is not None
    assert long.text == "The pause is drawn shorter than it is."
    assert picture_of(cycle(phase(1, 10), phase(2, 10))).note is None


def test_the_cycle_in_words_reaches_from_peak_to_peak() -> None:
    typed = cycle(phase(30.123, 100, peak_torque_Nm=45), phase(-20, -80, peak_torque_Nm=33, peak_speed_rpm=120))
    words = [sentence.text for sentence in picture_of(typed).words]
    assert words[1:] == ["Torque from -33 Nm to 45 Nm.", "Speed from -120 rpm to 100 rpm."]


def test_the_name_of_a_phase_is_the_title_of_its_step_and_stands_beside_its_number_where_there_is_room() -> None:
    names = ["lift", "go back", "wait as long as the press is open"]
    phases = (phase(40, 250, 0.3), phase(32, 500, 3), phase(20, 50, 3))
    view = drawn(cycle(*(one | {"name": name} for one, name in zip(phases, names, strict=True))))

    assert [step.findtext("title") for step in view.of("rect", "phase-step")] == names
    assert view.said("phase-name") == ["go back"]
    assert sorted(view.said("number")) == ["1", "2", "3"]


# --- Limits -----------------------------------------------------------------------------------------------------------


def test_limits_far_above_the_cycle_are_named_beyond_the_scale() -> None:
    view = drawn(cycle(*EXAMPLE, emergency_stop={"torque_Nm": 200.0}))

    assert [name.split()[0] for name in view.said("name")] == ["TN", "Tav", "nav(max)/i", "nout,av"]
    assert view.said("beyond") == ["↑ TR 149\u2002↑ Tk 200", "↑ nin(max)/i 1\u202f200"]


@pytest.mark.parametrize(
    ("check", "accented"),
    [
        ("average_torque", "TN 80"),
        ("repeated_peak_torque", "↑ TR 149"),
        ("momentary_peak_torque", "↑ Tk 200"),
        ("maximum_input_speed", "↑ nin(max)/i 1\u202f200"),
        ("output_bearing_life", ""),
        (None, ""),
    ],
)
def test_the_limit_of_the_check_that_governs_alone_takes_the_accent(check: str | None, accented: str) -> None:
    view = drawn(cycle(*EXAMPLE, emergency_stop={"torque_Nm": 200.0}), Reader(), (), check)
    result = [*view.of("text", "governing"), *view.of("tspan", "governing")]
    assert "".join(text for each in result for text in each.itertext()).strip() == accented


def test_phases_that_govern_stand_out_in_the_steps_and_in_their_numbers() -> None:
    view = drawn(cycle(*EXAMPLE), Reader(), (1,))
    assert [step.get("data-phase") for step in view.of("rect", "governing")] == ["1"]
    assert [mark.get("data-phase") for mark in view.of("g", "governing")] == ["1"]


@pytest.mark.parametrize("reader", [Reader(), Reader("de", ("lb_in",))])
@pytest.mark.parametrize("scale", [0.02, 0.3, 1, 4, 1000])
@pytest.mark.parametrize(
    "document", [cycle(*EXAMPLE, pause_s=4.0, emergency_stop={"torque_Nm": 200.0}), TURNING, LIFTING]
)
def test_no_text_lies_over_another_or_outside_whatever_the_limits_are(
    document: Json, scale: float, reader: Reader
) -> None:
    if "phases" in document["duty_cycle"]:
        phases = [one | {"torque_Nm": scale * one["torque_Nm"]} for one in document["duty_cycle"]["phases"]]
        document = document | {"duty_cycle": document["duty_cycle"] | {"phases": phases}}
    for gear in ("HPN-11A-5", "HPN-20A-5", "HPN-32A-25"):
        picture = picture_of(document, reader, designation=gear)
        result = list(texts(Shown(picture.drawing)))
        _, _, width, height = map(float, picture.drawing.get("viewBox", "").split())
        for one, other in combinations(result, 2):
            apart = one[2] <= other[1] or other[2] <= one[1] or one[4] <= other[3] + 1 or other[4] <= one[3] + 1
            assert apart, (gear, one, other)
        assert [one for one in result if one[1] < -1 or one[2] > width + 6 or one[3] < 0 or one[4] > height] == []


# --- Motions ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("document", [TURNING, LIFTING])
def test_the_curves_of_a_motion_reach_from_its_least_to_its_largest_values(document: Json) -> None:
    motion = subject_of(document).application.duty_cycle.motion
    assert motion is not None
    trace, load = trace_of(motion.course), motion.mechanism.load
    way = load.way_per_rad / load.ratio if document is LIFTING else math.degrees(1)

    values = (trace.angle_rad * way, trace.speed_rpm, trace.torque_Nm)
    for curve, expected in zip(drawn(document).curves, values, strict=True):
        span = expected.max() - expected.min()
        assert min(curve) == pytest.approx(min(expected.min(), 0), abs=0.005 * span)
        assert max(curve) == pytest.approx(max(expected.max(), 0), abs=0.005 * span)


def test_phases_are_marked_where_they_begin_moves_are_numbered_and_the_pause_follows_them() -> None:
    view = drawn(TURNING)
    phases = [float(step.get("x", "")) for step in view.of("rect", "phase-step")]
    [pause] = view.of("rect", "pause")
    motion = subject_of(TURNING).application.duty_cycle.motion
    assert motion is not None
    begun = np.concatenate(([0.0], np.cumsum(motion.course.duration_s)))

    left, right = phases[0], float(pause.get("x", ""))
    assert [*phases, right] == pytest.approx(left + begun / begun[-1] * (right - left), abs=0.01)
    places = [str(k) for k in range(len(motion.phases))]
    assert [step.get("data-phase") for step in view.of("rect", "phase-step")] == places
    numbered = [mark.get("data-phase", "").split() for mark in view.of("g", "mark")]
    of = motion.course.move.tolist()
    assert numbered == [[place for place in places if of[int(place)] == row] for row in range(len(motion.moves))]


def test_the_last_time_of_a_motion_is_its_end() -> None:
    motion = subject_of(TURNING).application.duty_cycle.motion
    assert motion is not None
    times = [text for text in drawn(TURNING).said("tick") if text.endswith("\u202fs")]
    assert times == [f"{motion.course.duration_s.sum():g}\u202fs"]


@pytest.mark.parametrize("gravity", [{}, {"gravity_mass_kg": 3, "gravity_radius_mm": 100}])
def test_a_thousand_moves_make_a_small_drawing_that_misses_no_peak(gravity: Json) -> None:
    moves = [{"profile": "s_curve", "angle_deg": (90 + k) * (-1) ** k, "time_s": 1} for k in range(600)]
    document: Json = {
        "duty_cycle": {"motion": {"mechanism": {"type": "rotary", "inertia_kgm2": 1} | gravity, "moves": moves}}
    }
    picture = picture_of(document)

    assert len(markup(picture.drawing)) < 200_000
    peak = max(map(abs, Shown(picture.drawing).curves[2]))
    assert peak == pytest.approx(subject_of(document).duty.maximum_torque_Nm.item(), rel=0.01)


def test_a_motion_is_told_in_the_readers_language_and_units_with_its_peak() -> None:
    reader = Reader(language="de", units=("lb_in",))
    words = " ".join(map(reader.sentence, picture_of(LIFTING, reader).words))

    assert words.startswith("Bewegung von ")
    assert "lb·in" in words
    assert "Der Weg gilt für die Last" in words
    titles = set(drawn(TURNING, Reader(language="de")).said("title"))
    assert titles == {"Winkel in °", "Drehzahl in min⁻¹", "Drehmoment in Nm"}
    highest = max(phase.peak_torque_Nm or 0 for phase in subject_of(TURNING).application.duty_cycle.load_phases)
    assert f"{highest:.3g} Nm." in picture_of(TURNING).words[0].text

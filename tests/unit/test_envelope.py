"""The drawing of loads in their envelopes: what it shows, read back from the SVG, is what the equations say."""

import math
import re
from itertools import combinations, pairwise
from xml.etree.ElementTree import Element, fromstring

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hpn.application import Application
from hpn.catalogue import Catalogue, load_catalogue
from hpn.engine.envelopes import EnvelopeQuery
from hpn.engine.selection import select
from hpn.explain.drawings import Subject, chart, gear_envelope, published_condition
from hpn.explain.drawings.chart import LARGE, SMALL
from hpn.explain.drawings.envelope import envelope_scene, sizes_scene
from hpn.explain.drawings.picture import BearingPicture, bearing_picture
from hpn.explain.drawings.pictures import governing_phases
from hpn.explain.drawings.sizes import size_uses
from hpn.explain.drawings.svg import LETTER, markup
from hpn.words.reader import DEFAULT, Reader
from tests.build import Json, cycle, phase
from tests.conftest import Supplement

CATALOGUE: Catalogue = load_catalogue()
F_R, F_A = 1800.0, 2200.0
"""Published limits of size 20A."""

CURVE = "size,load_coefficient,axial_N,radial_N,source\n20A,1,2200,0,print\n20A,1,1300,1200,print\n20A,1,0,1800,print\n"
THREE = (
    phase(40, 250, 0.3, radial_N=900, axial_N=300),
    phase(32, 500, 3, radial_N=500, axial_N=200),
    phase(20, 250, 0.4, radial_N=700, axial_N=500),
)

Point = tuple[float, float]


class Shown:
    """A drawing as a reader sees it: places become loads by the numbers on the axes."""

    def __init__(self, drawing: Element, decimal: str = ".") -> None:
        self.root = fromstring(markup(drawing))
        plain = [text for text in self.of("text", "tick") if text.get("class") == "tick"]  # a limit's own is rounded
        ticks = [(self._at(text), self.said(text)) for text in plain]
        number = [float(said.replace("\u202f", "").replace(decimal, ".")) for _, said in ticks]
        anchors = [text.get("text-anchor") for text in plain]
        down = [(y - 4.5, n) for ((_, y), _), n, side in zip(ticks, number, anchors, strict=True) if side == "end"]
        across = [(x, n) for ((x, _), _), n, side in zip(ticks, number, anchors, strict=True) if side == "middle"]
        self.across, self.down = self._scale(across), self._scale(down)

    @staticmethod
    def _scale(ticks: list[tuple[float, float]]) -> tuple[float, float]:
        (first, low), (last, high) = ticks[0], ticks[-1]
        step = (high - low) / (last - first)
        return low - step * first, step

    def of(self, name: str, kind: str) -> list[Element]:
        """Elements of a name whose class holds a kind."""
        return [each for each in self.root.iter(name) if kind in each.get("class", "").split()]

    @staticmethod
    def said(text: Element) -> str:
        return "".join(text.itertext())

    @staticmethod
    def _at(text: Element) -> Point:
        return float(text.get("x", "nan")), float(text.get("y", "nan"))

    def load(self, place: Point) -> Point:
        """Load that a place stands for."""
        (x, y), (left, step), (top, rise) = place, self.across, self.down
        return left + step * x, top + rise * y

    def line(self, kind: str) -> list[list[Point]]:
        """Corners of the lines of a kind, as loads."""
        paths = [each.get("d", "") for each in self.of("path", kind)]
        pairs = [re.findall(r"(-?[\d.]+) (-?[\d.]+)", path) for path in paths]
        return [[self.load((float(x), float(y))) for x, y in pair] for pair in pairs]

    def dots(self, kind: str) -> list[Point]:
        """Exact places of the marks of a kind, as loads."""
        groups = self.of("g", kind)
        circles = [next(each for each in group if each.get("class") == "dot") for group in groups]
        return [self.load((float(c.get("cx", "")), float(c.get("cy", "")))) for c in circles]


def subject_of(document: Json, designation: str = "HPN-20A-5", catalogue: Catalogue = CATALOGUE) -> Subject:
    return Subject(Application.model_validate(document), catalogue.by_designation[designation], catalogue)


def picture_of(subject: Subject) -> BearingPicture:
    candidate = select(subject.application, subject.catalogue).candidate(subject.gear.designation)
    assert candidate is not None
    found = bearing_picture(subject, candidate.check("output_bearing_life"))
    assert found is not None
    return found


def drawing_of(
    picture: BearingPicture,
    reader: Reader = DEFAULT,
    check: str | None = None,
    size: Point = SMALL,
) -> Element:
    return chart(envelope_scene(picture, reader, (), check), reader, size)


def shown(document: Json, reader: Reader | None = None, catalogue: Catalogue = CATALOGUE) -> Shown:
    reader = reader or Reader()
    picture = picture_of(subject_of(document, catalogue=catalogue))
    return Shown(drawing_of(picture, reader), reader.decimal)


def near(points: list[Point]) -> object:
    """The same loads, to what a thousandth of a unit of the drawing is: 0.01 N on an axis to some 2000 N."""
    return pytest.approx(np.array(points).ravel(), abs=0.05)


def flat(points: list[Point]) -> list[float]:
    return [value for point in points for value in point]


# --- Numbers ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("u", [1.0, 0.8])
def test_lines_read_off_the_axes_are_the_formula_of_the_life(u: float) -> None:
    load = {"load_coefficient": 1.2, "life_h": 30_000.0, "life_basis": "L10"}
    drawn = shown(cycle(*THREE, pause_s=4.0, output_load=load, requirements={"utilisation": u}))

    n_out_av = (250 * 0.3 + 500 * 3 + 250 * 0.4) / (0.3 + 3 + 0.4 + 4)
    k = (100 / n_out_av * 20_000 / (5 * 30_000)) ** (1 / 3)
    assert k < 1
    for lines, f_w in [(drawn.line("limit"), 1.2)]:
        assert flat(lines[0]) == near([(0, u * k * F_A / f_w), (u * k * F_R / f_w, 0)])
    for line, f_w in zip(drawn.line("coefficient"), (1, 1.5), strict=True):
        assert flat(line) == near([(0, u * k * F_A / f_w), (u * k * F_R / f_w, 0)])
    assert flat(drawn.line("single")[0]) == near([(0, u * F_A / 1.2), (u * F_R / 1.2, 0)])


def test_loads_read_off_the_axes_are_the_phases_and_the_equivalent_load_has_P_m_in_the_worst_ones_direction() -> None:
    drawn = shown(cycle(*THREE, pause_s=4.0, output_load={"load_coefficient": 1.2}))

    assert flat(drawn.dots("load")) == near([(900, 300), (500, 200), (700, 500)])
    P = [radial / F_R + axial / F_A for radial, axial in ((900, 300), (500, 200), (700, 500))]
    weights = (250 * 0.3, 500 * 3, 250 * 0.4)
    P_m = (sum(w * p**3 for w, p in zip(weights, P, strict=True)) / sum(weights)) ** (1 / 3)
    assert flat(drawn.dots("equivalent")) == near([(900 * P_m / P[0], 300 * P_m / P[0])])


@pytest.mark.parametrize("model", ["iso281", "digitised"])
def test_every_corner_of_another_model_is_drawn(supplemented: Supplement, model: str) -> None:
    catalogue = supplemented(bearing_envelopes=CURVE)
    drawn = shown(cycle(phase(10, 50, radial_N=300), output_load={"model": model}), catalogue=catalogue)

    knee = (F_R, 0.44 * F_A) if model == "iso281" else (1200.0, 1300.0)
    assert flat(drawn.line("limit")[0]) == near([(0, F_A), knee, (F_R, 0)])


def test_without_a_load_the_drawing_shows_what_20_000_hours_allow_at_the_speed_of_the_cycle() -> None:
    drawn = shown(cycle(phase(10, 400, 2), phase(10, 200, 2)))

    k = (100 / 300) ** (1 / 3)
    assert flat(drawn.line("limit")[0]) == near([(0, k * F_A), (k * F_R, 0)])
    assert drawn.of("g", "mark") == []


def test_axes_reach_115_percent_of_the_largest_value_with_round_numbers_in_the_readers_units() -> None:
    for reader in (Reader(), Reader(language="de", units=("lbf",))):
        unit = 4.4482216152605 if reader.units else 1.0
        drawn = shown(cycle(phase(10, 50), output_load={"radial_N": 2500.0}), reader)
        (left, bottom), right = drawn.load((0.0, 0.0)), drawn.load((348.0 - 12, 26.0))
        assert left < 0 < bottom
        assert right[0] * unit == pytest.approx(1.15 * 2500, abs=0.1)
        assert right[1] * unit == pytest.approx(1.15 * F_A, abs=0.1)
        said = {Shown.said(text) for text in drawn.of("text", "tick")}
        assert said >= ({"0", "200", "400"} if reader.units else {"0", "500", "1\u202f000"})


def test_the_limit_has_its_two_values_on_the_axes() -> None:
    drawn = shown(cycle(phase(10, 50), output_load={"load_coefficient": 1.2, "radial_N": 500.0}))
    own = [Shown.said(text) for text in drawn.of("text", "own")]
    assert own == ["1\u202f833", "1\u202f500"]  # 2200 and 1800 N over 1.2


@pytest.mark.parametrize(
    ("check", "kinds"),
    [("output_bearing_load", ["single"]), ("output_bearing_life", ["limit"]), ("average_torque", []), (None, [])],
)
def test_the_limit_that_governs_alone_takes_the_accent(check: str | None, kinds: list[str]) -> None:
    picture = picture_of(subject_of(cycle(*THREE)))
    for size in (SMALL, LARGE):
        drawn = Shown(drawing_of(picture, Reader(), check, size))
        assert [line.get("class", "").split()[1] for line in drawn.of("path", "governing")] == kinds
        said = [text for text in drawn.of("text", "governing") if "own" not in text.get("class", "")]
        assert [name.get("class", "").split()[1] for name in said] == kinds
        assert len(drawn.of("text", "governing")) == 3 * len(kinds)  # with the values at which it meets the axes


def test_the_ray_is_solid_up_to_the_worst_load_and_goes_on_to_its_limit() -> None:
    drawn = shown(cycle(*THREE, output_load={"load_coefficient": 1.2}))
    solid, rest = drawn.line("ray")
    assert flat(solid) == near([(0, 0), (900, 300)])
    radial, axial = rest[1]
    assert 1.2 * (radial / F_R + axial / F_A) == pytest.approx(1, abs=1e-3)


def test_a_load_beyond_the_single_limit_has_a_ring_a_cross_and_words_and_no_other_has() -> None:
    phases = (phase(1, 300, radial_N=1000), phase(1, 300, radial_N=1900), phase(1, 300, axial_N=100))
    drawn = shown(cycle(*phases))

    marked = {group.get("data-phase"): group for group in drawn.of("g", "load")}
    for place, group in marked.items():
        kinds = [each.get("class") for each in group]
        outside = place == "1"
        assert ("ring" in kinds) == ("cross" in kinds) == outside
        assert ("outside the limit" in (group.findtext("title") or "")) == outside


# --- Places for texts -------------------------------------------------------------------------------------------------


def boxes(drawn: Shown) -> list[tuple[str, float, float, float, float]]:
    """Text, left, top, right and bottom of every text, by the widest of the usual fonts."""
    found = []
    for text in drawn.root.iter("text"):
        said, anchor = Shown.said(text), text.get("text-anchor")
        (x, y), width = Shown._at(text), 0.6 * LETTER * len(said)
        if turned := text.get("transform"):
            x, y, turn = map(float, re.findall(r"-?[\d.]+", turned))
            across, down = math.cos(math.radians(turn)), math.sin(math.radians(turn))
            for k in range(len(said)):
                step = (k + 0.5) * width / len(said) - width / 2
                at, half = (x + step * across, y + step * down), 0.35 * LETTER
                found.append((said, at[0] - half, at[1] - half, at[0] + half, at[1] + half))
            continue
        left = x - {"start": 0.0, "middle": 0.5, "end": 1.0}[anchor or "start"] * width
        found.append((said, left, y - 0.75 * LETTER, left + width, y + 0.2 * LETTER))
    return found


def _is_over(dot: Element | None, disc: Element | None) -> bool:
    """True where a dot that is drawn later lies on a disc, and so on its number."""
    if dot is None or disc is None:
        return False
    left, top, width, height = (float(disc.get(name, "")) for name in ("x", "y", "width", "height"))
    x, y = (float(dot.get(name, "")) for name in ("cx", "cy"))
    return left < x < left + width and top < y < top + height


loads = st.floats(0, 5000)
rows = st.tuples(st.floats(1, 2000), st.floats(0.1, 10), loads, loads)
close = st.tuples(st.floats(1, 2000), st.just(1.0), st.floats(900, 960), st.floats(290, 320))


@settings(deadline=None, max_examples=60)
@given(
    st.lists(st.one_of(rows, close), min_size=1, max_size=40),
    st.floats(1, 3),
    st.sampled_from(["HPN-11A-5", "HPN-20A-5", "HPN-32A-25"]),
    st.sampled_from(["linear", "iso281"]),
    st.sampled_from([Reader(), Reader("de", ("lbf",))]),
    st.floats(0.3, 1),
)
def test_no_text_lies_over_another_and_each_stays_inside(
    entries: list[tuple[float, float, float, float]], f_w: float, gear: str, model: str, reader: Reader, u: float
) -> None:
    phases = [phase(1, n, t, radial_N=r, axial_N=a) for n, t, r, a in entries]
    document = cycle(*phases, output_load={"load_coefficient": f_w, "model": model}, requirements={"utilisation": u})
    picture = picture_of(subject_of(document, gear))

    drawing = drawing_of(picture, reader)
    drawn = Shown(drawing, reader.decimal)

    texts = boxes(drawn)
    over = [
        (one[0], other[0])
        for one, other in combinations(texts, 2)
        if one[0] != other[0] and one[1] < other[3] and other[1] < one[3] and one[2] < other[4] and other[2] < one[4]
    ]
    assert over == []
    _, _, width, height = map(float, drawing.get("viewBox", "").split())
    assert [said for said, left, top, right, bottom in texts if left < -1 or right > width + 1 or top < 0] == []
    assert all(bottom <= height for *_, bottom in texts)
    groups = [(group.find("rect[@class='disc']"), group.find("circle")) for group in drawn.of("g", "mark")]
    assert [dot for (disc, _), (_, dot) in combinations(groups, 2) if _is_over(dot, disc)] == []
    assert markup(drawing) == markup(drawing_of(picture, reader))


def test_a_load_without_room_for_its_number_covers_no_number_of_the_same_place() -> None:
    phases = [phase(1, 100, radial_N=900 + 0.001 * k, axial_N=300) for k in range(40)]
    drawn = Shown(drawing_of(picture_of(subject_of(cycle(*phases)))))
    groups = [(group.find("rect[@class='disc']"), group.find("circle")) for group in drawn.of("g", "mark")]
    assert sum(disc is None for disc, _ in groups) > 1
    assert [dot for (disc, _), (_, dot) in combinations(groups, 2) if _is_over(dot, disc)] == []


@pytest.mark.parametrize("count", [1, 7, 24])
def test_loads_apart_from_each_other_all_have_their_number(count: int) -> None:
    phases = [phase(1, 100, radial_N=60 + 65.0 * (k % 24), axial_N=200.0 * (1 + k % 3)) for k in range(count)]
    picture = picture_of(subject_of(cycle(*phases)))
    drawn = Shown(drawing_of(picture, size=LARGE))
    assert [Shown.said(text) for text in drawn.of("text", "number")][:-1] == [str(k + 1) for k in range(count)]


def test_of_more_than_24_loads_those_nearest_to_their_limit_have_a_number() -> None:
    phases = [phase(1, 100, radial_N=10.0 + 40 * k, axial_N=900 - 20 * k) for k in range(40)]
    drawn = shown(cycle(*phases))
    numbered = {int(Shown.said(text)) for text in drawn.of("text", "number") if Shown.said(text) != "Pm"}
    assert numbered <= set(range(17, 41))
    assert len(drawn.dots("load")) == 40


# --- All sizes, and a gear in the catalogue ---------------------------------------------------------------------------


def test_every_size_is_a_line_and_the_gears_own_is_the_strong_one() -> None:
    subject = subject_of(cycle(phase(10, 100), output_load={"radial_N": 300.0}))
    picture = picture_of(subject)
    drawn = Shown(chart(sizes_scene(size_uses(subject, picture), picture), DEFAULT))

    limits = [(gear.dynamic_radial_load_N, gear.dynamic_axial_load_N) for gear in subject.sizes.rows]
    lines = [*drawn.line("limit"), *drawn.line("size")]
    ends = sorted((line[-1][0], line[0][1]) for line in lines)
    assert flat(ends) == pytest.approx(flat(sorted((r, a) for r, a in limits if r and a)), abs=0.2)
    assert drawn.line("limit")[0][-1][0] == pytest.approx(F_R, abs=0.2)


def test_a_gear_in_the_catalogue_shows_its_published_limits() -> None:
    gear, lacking = (CATALOGUE.by_designation[name] for name in ("HPN-20A-5", "HPN-40A-5"))
    envelope = gear_envelope(CATALOGUE, gear, published_condition(CATALOGUE, gear))
    assert envelope is not None
    drawn = Shown(envelope.drawing)
    for line, f_w in zip([*drawn.line("limit"), *drawn.line("coefficient")], (1, 1.2, 1.5), strict=True):
        assert flat(line) == near([(0, F_A / f_w), (F_R / f_w, 0)])
    assert drawn.line("single") == []  # it would be the same line
    assert gear_envelope(CATALOGUE, lacking, published_condition(CATALOGUE, lacking)) is None


def test_a_gear_in_the_catalogue_shows_what_it_may_carry_at_a_speed_life_and_coefficient_that_are_asked_for() -> None:
    """The published line over (n L / n₀ L₀)^(1/3) and f_w, written out here; the largest single load stays."""
    gear = CATALOGUE.by_designation["HPN-20A-5"]
    asked = EnvelopeQuery(speed_rpm=150, life_h=30_000, load_coefficient=1.3)
    envelope = gear_envelope(CATALOGUE, gear, asked)
    assert envelope is not None
    k = (100 * 20_000 / (150 * 30_000)) ** (1 / 3)
    own = envelope.curves[-1]
    assert own.radial_N == pytest.approx([0, F_R * k / 1.3], rel=1e-12)
    assert own.axial_N == pytest.approx([F_A * k / 1.3, 0], rel=1e-12)
    drawn = Shown(envelope.drawing)
    limit, single = (np.array(drawn.line(kind)[0]) for kind in ("limit", "single"))
    # one scale for both: 1e-4 is a thousandth of a unit of the drawing on the shorter line
    assert limit.sum(axis=0) / single.sum(axis=0) == pytest.approx(np.array([k / 1.3] * 2), rel=1e-4)
    assert len(drawn.line("coefficient")) == 3


@pytest.mark.parametrize(("radial", "axial"), [(0.0, 0.0), (1e-300, 0.0), (1e9, 1e9), (0.0, 1e-12)])
def test_extreme_loads_have_a_drawing(radial: float, axial: float) -> None:
    picture = picture_of(subject_of(cycle(phase(1, 100), output_load={"radial_N": radial, "axial_N": axial})))
    text = markup(drawing_of(picture))
    assert "nan" not in text.lower().replace("governing", "")
    assert "inf" not in text


def test_corners_lie_in_order_so_that_the_area_below_the_limit_is_the_permissible_one() -> None:
    corners = shown(cycle(*THREE)).line("limit")[0]
    assert all(after[0] >= before[0] and after[1] <= before[1] for before, after in pairwise(corners))
    assert not any(math.isnan(value) for value in flat(corners))


# --- The phases that govern -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("check", "places"),
    [
        ("output_bearing_load", (1,)),
        ("output_bearing_life", (1,)),
        ("repeated_peak_torque", (2,)),
        ("maximum_input_speed", (0, 3)),
        ("average_torque", ()),
        ("momentary_peak_count", ()),
        ("weight", ()),
        (None, ()),
    ],
)
def test_phases_that_a_check_goes_by(check: str | None, places: tuple[int, ...]) -> None:
    phases = (phase(10, 500, radial_N=10), phase(10, 100, axial_N=900), phase(-40, 100), phase(5, -500))
    subject = subject_of(cycle(*phases))
    assert governing_phases(subject, check, picture_of(subject)) == places

"""Pictures as data: every figure is valid for Plotly, shows what the checks compute, and says so in words."""

import re
from collections.abc import Sequence

import plotly.graph_objects as go
import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.candidates import CheckResult
from hpn.engine.selection import select
from hpn.explain.drawings import Figure, Subject, chart
from hpn.explain.drawings.bearing import bearing_figure, sizes_figure
from hpn.explain.drawings.envelope import envelope_scene, sizes_scene
from hpn.explain.drawings.picture import BearingPicture, bearing_picture
from hpn.explain.drawings.sizes import size_uses
from hpn.explain.drawings.stops import emergency_stop_words, stop_scene
from hpn.explain.drawings.verdict import bearing_verdict, bearing_words
from hpn.words.reader import DEFAULT, Reader
from tests.build import Json, cycle, phase
from tests.conftest import Supplement

CURVES = (
    "size,load_coefficient,axial_N,radial_N,source\n20A,1,2200,0,print\n20A,1,1300,1200,print\n20A,1,0,1800,print\n"
)
N_PER_LBF = 4.4482216152605
LOADS = {"radial_N": 500.0, "axial_N": 200.0, "load_coefficient": 1.2}


def shown_on(document: Json, catalogue: Catalogue, designation: str = "HPN-20A-5") -> Subject:
    return Subject(Application.model_validate(document), catalogue.by_designation[designation], catalogue)


def example(catalogue: Catalogue, designation: str = "HPN-20A-5", **parts: object) -> Subject:
    phases = (phase(40, 250, 0.3, radial_N=900, axial_N=300), phase(32, 500, 3), phase(-20, -250, 0.4))
    return shown_on(cycle(*phases, pause_s=4.0, **parts), catalogue, designation)


def picture(subject: Subject) -> BearingPicture:
    loads = subject.application.loads
    life = check(subject, subject.gear.designation, "output_bearing_life") if loads else None
    result = bearing_picture(subject, life)
    assert result is not None
    return result


def figure_of(shown: BearingPicture, reader: Reader = DEFAULT, governing: Sequence[int] = ()) -> Figure:
    return bearing_figure(envelope_scene(shown, reader, governing), shown, reader)


def check(subject: Subject, designation: str, code: str) -> CheckResult:
    candidate = select(subject.application, subject.catalogue).candidate(designation)
    assert candidate is not None
    result = candidate.check(code)
    assert result is not None
    return result


def traces(figure: Figure, kind: str) -> list[Json]:
    return [trace for trace in figure["data"] if trace["meta"]["kind"] == kind]


@pytest.mark.parametrize("model", ["linear", "iso281", "digitised"])
@pytest.mark.parametrize("coefficient", [1.0, 1.2, 1.37, 3.0])
def test_figures_of_the_bearing_are_valid_in_every_model(
    supplemented: Supplement, model: str, coefficient: float
) -> None:
    catalogue = supplemented(bearing_envelopes=CURVES)
    subject = example(catalogue, output_load=LOADS | {"model": model, "load_coefficient": coefficient})
    view = picture(subject)

    figure = figure_of(view)

    go.Figure(figure)
    uses = size_uses(subject, view)
    sizes = sizes_figure(sizes_scene(uses, view), uses, view)
    go.Figure(sizes)
    drawn = {trace["meta"]["load_coefficient"] for trace in traces(figure, "limit") + traces(figure, "coefficient")}
    assert drawn == {1.0, 1.2, 1.5, coefficient}
    published = {gear.size for gear in catalogue.gears if gear.dynamic_radial_load_N is not None}
    assert len(traces(sizes, "size") + traces(sizes, "limit")) == (1 if model == "digitised" else len(published))


@pytest.mark.parametrize("life_h", [1000.0, 60_000.0])
def test_each_curve_of_the_plot_has_the_drawings_name_on_it_and_no_legend(catalogue: Catalogue, life_h: float) -> None:
    subject = example(catalogue, output_load=LOADS | {"life_h": life_h})
    view = picture(subject)

    figure = figure_of(view)

    assert figure["layout"]["showlegend"] is False
    kinds = ("limit", "coefficient", "single")
    names = [[trace["meta"]["label"]] for kind in kinds for trace in traces(figure, kind)]
    names += [trace["text"] for trace in traces(figure, "equivalent")]
    single = [["single load"]] if view.life_factor < 1 else []
    life = [["f<sub>w</sub> 1"], ["f<sub>w</sub> 1.5"]]
    assert sorted(names) == sorted([["limit now, f<sub>w</sub> 1.2"], *life, *single, ["P<sub>m</sub>"]])
    drawing = "".join(chart(envelope_scene(view), DEFAULT).itertext())
    assert all(re.sub("<.*?>", "", name) in drawing.replace("f_w", "fw") for one in names for name in one)


@pytest.mark.parametrize("model", ["linear", "iso281", "digitised"])
def test_the_picture_uses_what_the_checks_say(supplemented: Supplement, model: str) -> None:
    subject = example(supplemented(bearing_envelopes=CURVES), output_load=LOADS | {"model": model})
    view = picture(subject)

    largest, life = (check(subject, "HPN-20A-5", f"output_bearing_{name}") for name in ("load", "life"))
    assert view.worst.published == largest.utilisation
    candidate = select(subject.application, subject.catalogue).candidate("HPN-20A-5")
    assert candidate is not None
    assert view.life_h == pytest.approx(candidate.bearing_life_L50_h, rel=1e-12)
    assert view.life_utilisation == pytest.approx(life.utilisation, rel=1e-14)
    assert view.life_factor == life.limit


def test_distance_leads_from_the_worst_load_to_the_published_curve(catalogue: Catalogue) -> None:
    view = picture(example(catalogue, output_load=LOADS))
    line = traces(figure_of(view), "distance")[0]

    radial, axial = line["x"][1], line["y"][1]
    assert 1.2 * (radial / 1800 + axial / 2200) == pytest.approx(1, rel=1e-12)
    assert view.worst.distance_N == pytest.approx(
        ((radial - line["x"][0]) ** 2 + (axial - line["y"][0]) ** 2) ** 0.5, rel=1e-12
    )


def test_phases_with_one_load_are_one_point(catalogue: Catalogue) -> None:
    phases = [phase(10, 100, 1.0, radial_N=300)] * 3 + [phase(10, 100, 1.0, radial_N=100)]
    subject = shown_on(cycle(*phases), catalogue)

    view = picture(subject)
    figure = figure_of(view, governing=(1,))
    points = traces(figure, "load")[0]

    assert points["text"] == ["phase 1–3", "phase 4"]
    assert points["x"] == [300, 100]
    assert points["marker"]["color"] == ["var(--governing)", "var(--ink)"]
    assert set(traces(figure_of(view), "load")[0]["marker"]["color"]) == {"var(--ink)"}
    go.Figure(figure)


def test_of_very_many_loads_the_worst_are_shown_and_the_rest_counted(catalogue: Catalogue) -> None:
    phases = [phase(1, 100, 1.0, radial_N=float(k)) for k in range(1000)]
    subject = shown_on(cycle(*phases), catalogue)
    view = picture(subject)

    assert len(view.loads) == 200
    assert view.hidden == 800
    assert view.worst.phases == "1000"
    go.Figure(figure_of(view))


def test_axes_stay_for_any_load_within_the_limits_and_widen_beyond(catalogue: Catalogue) -> None:
    def ranges(radial: float) -> tuple[list[float], list[float]]:
        layout = figure_of(picture(shown_on(cycle(phase(1, 100), output_load={"radial_N": radial}), catalogue)))[
            "layout"
        ]
        return layout["xaxis"]["range"], layout["yaxis"]["range"]

    assert ranges(1.0) == ranges(900.0) == ranges(1800.0)
    assert ranges(1801.0) != ranges(1800.0)
    assert ranges(1e9)[0][1] > 1e9


def words(document: Json, catalogue: Catalogue) -> str:
    view = picture(shown_on(document, catalogue))
    return " ".join(sentence.text for sentence in (bearing_verdict(view), *bearing_words(view)))


def test_the_words_say_what_governs(catalogue: Catalogue) -> None:
    fast = words(cycle(phase(10, 500), output_load={"radial_N": 800.0}), catalogue)
    slow = words(cycle(phase(10, 50), output_load={"radial_N": 800.0}), catalogue)

    assert "Bearing life decides." in fast
    assert "Equivalent load: 76 % of the permissible constant load (500 rpm, 20000 h, L50)." in fast
    assert "With f_w" not in fast + slow
    assert "The largest single load decides." in slow
    life_factor = (100 / 50) ** (1 / 3)  # the handbook's maximum holds for 100 rpm
    assert f"Equivalent load: {44.4444 / life_factor:.1f} % of the constant load with the required life (50 rpm" in slow
    assert "44.4 % of the published maximum. Single load" in slow
    assert "Single load: 44.4 % of the published maximum." in slow


@pytest.mark.parametrize(
    ("radial", "message"),
    [
        (1260.0, "The output bearing carries these loads within u = 80 %."),
        (1530.0, "The loads exceed u = 80 %: they use 85 % of the permissible load of the output bearing."),
        (1440.1, "The loads exceed u = 80 %: they use 80.01 % of the permissible load of the output bearing."),
        (1980.0, "The output bearing does not carry these loads, even without u = 80 %."),
    ],
)
def test_a_reserve_of_ones_own_is_named_and_no_load_within_the_maximum_is_said_not_to_be_carried(
    catalogue: Catalogue, radial: float, message: str
) -> None:
    document = cycle(phase(10, 50), output_load={"radial_N": radial}, requirements={"utilisation": 0.8})
    assert words(document, catalogue).startswith(message)


def test_the_condition_of_the_curves_names_speed_life_basis_and_a_reserve_of_ones_own(catalogue: Catalogue) -> None:
    load = {"radial_N": 100.0, "life_h": 8000.0, "life_basis": "L10"}
    plain, reserved = (
        picture(shown_on(cycle(phase(10, 50), output_load=load, requirements=case), catalogue)).condition.text
        for case in ({}, {"utilisation": 0.8})
    )
    assert (plain, reserved) == ("50 rpm, 8000 h, L10", "50 rpm, 8000 h, L10, u = 80 %")


def test_a_use_next_to_its_limit_is_never_called_100_percent(catalogue: Catalogue) -> None:
    message = words(cycle(phase(10, 50), output_load={"radial_N": 1800.0001}), catalogue)
    assert ": 100 %" not in message
    assert "100.00" in message


def test_without_limits_there_is_no_picture_of_the_bearing(catalogue: Catalogue) -> None:
    plain, unrated = example(catalogue, output_load=LOADS), example(catalogue, "HPN-40A-5", output_load=LOADS)

    assert bearing_picture(unrated, check(unrated, "HPN-40A-5", "output_bearing_life")) is None
    uses = {use.gear.size: use.carries for use in size_uses(plain, picture(plain))}
    assert uses.items() >= {"11A": False, "14A": False, "20A": True, "32A": True, "40A": None}.items()


# --- Emergency stops --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("stop", "place", "outside"),
    [
        ({"torque_Nm": 200.0}, (200.0, 3066035), False),
        ({"torque_Nm": 200.0, "count": 1000}, (200.0, 1000), False),
        ({"torque_Nm": 200.0, "count": 10**15}, (200.0, 10**15), True),
        ({"torque_Nm": 149.0}, (149.0, 10**8), False),
        ({"torque_Nm": 300.0}, (300.0, 301901), True),
    ],
)
def test_a_stop_stands_at_its_torque_and_number_beside_the_line_of_equation_17_9(
    catalogue: Catalogue, stop: Json, place: tuple[float, int], outside: bool
) -> None:
    scene = stop_scene(example(catalogue, emergency_stop=stop))
    assert scene is not None
    [mark], [line] = scene.marks, [line for line in scene.lines if line.kind == "limit"]
    assert (mark.place[0], round(10 ** mark.place[1])) == place
    assert mark.outside == outside
    assert [*line.corners[0], *line.corners[1]] == pytest.approx([149.0, 7.0, 256.0, 8.5 - 1.5 * 256 / 149], rel=1e-12)


@pytest.mark.parametrize("stop", [None, {"torque_Nm": 1e6}])
def test_without_a_stop_that_is_permitted_once_the_line_stands_alone(catalogue: Catalogue, stop: Json | None) -> None:
    scene = stop_scene(example(catalogue, emergency_stop=stop))
    assert scene is not None
    assert scene.marks == []


@pytest.mark.parametrize(
    ("stop", "message"),
    [
        ({"torque_Nm": 200.0, "count": 1000}, "permits 3066035 stops over the life; your 1000 use 0.0326 %"),
        ({"torque_Nm": -200.0}, "At 200 Nm equation 17.9 permits 3066035 stops over the life."),
        ({"torque_Nm": 149.0}, "149 Nm is at or below T_R = 149 Nm: equation 17.9 sets no limit"),
        ({"torque_Nm": 300.0}, "300 Nm is above T_M = 256 Nm, whatever the number."),
        ({"torque_Nm": 1e6}, "no emergency stop is permitted (eq. 17.9)"),
        (None, "Enter an emergency-stop torque"),
    ],
)
def test_emergency_stops_in_words(catalogue: Catalogue, stop: Json | None, message: str) -> None:
    subject = example(catalogue, emergency_stop=stop)
    words = emergency_stop_words(subject)
    assert message in " ".join(sentence.text for sentence in words)


@pytest.mark.parametrize(
    "stop", [{"torque_Nm": 200}, {"torque_Nm": 200, "count": 10**7}, {"torque_Nm": 200, "count": 10**5}]
)
def test_the_stop_covers_no_name_and_numbers_are_powers_of_ten(catalogue: Catalogue, stop: Json) -> None:
    scene = stop_scene(example(catalogue, emergency_stop=stop))
    assert scene is not None
    drawing = chart(scene, Reader())
    [disc] = [each for each in drawing.iter("rect") if each.get("class") == "disc"]
    x, y, width, height = (float(disc.get(name, "")) for name in ("x", "y", "width", "height"))
    names = [each.get("transform", "") for each in drawing.iter("text") if "name" in each.get("class", "")]
    places = [tuple(map(float, re.findall(r"[\d.]+", name)[:2])) for name in names]
    ticks = {"".join(each.itertext()) for each in drawing.iter("text") if each.get("class") == "tick"}
    assert len(places) == 3
    assert not any(x < across < x + width and y < down < y + height for across, down in places)
    assert ticks > {"10⁰", "10²", "10⁴", "10⁶", "10⁸"}


def test_emergency_stops_of_an_unrated_gear_have_words_but_no_drawing(catalogue: Catalogue) -> None:
    subject = example(catalogue, "HPN-40A-5")
    assert stop_scene(subject) is None
    assert "not in this catalogue’s source" in emergency_stop_words(subject)[0].text


def test_a_reader_of_other_units_sees_other_numbers(catalogue: Catalogue) -> None:
    view = picture(example(catalogue, output_load=LOADS))
    figure, plain = figure_of(view, Reader(units=("lbf",))), figure_of(view)
    pairs = [
        (figure["data"][0]["x"], plain["data"][0]["x"]),
        (figure["layout"]["xaxis"]["range"], plain["layout"]["xaxis"]["range"]),
    ]
    for pounds, newtons in pairs:
        assert [N_PER_LBF * value for value in pounds] == pytest.approx(newtons, rel=1e-12)
    assert figure["layout"]["xaxis"]["title"]["text"] == "radial load in lbf"


@pytest.mark.parametrize("allowed", [1.0, 0.8, 0.5])
@pytest.mark.parametrize("radial", [100.0, 700.0, 1500.0])
@pytest.mark.parametrize("life", [200.0, 20_000.0, 200_000.0])
def test_a_size_carries_the_load_where_both_checks_of_its_bearing_pass(
    catalogue: Catalogue, allowed: float, radial: float, life: float
) -> None:
    loads = LOADS | {"radial_N": radial, "life_h": life}
    subject = example(catalogue, output_load=loads, requirements={"utilisation": allowed})

    for use in size_uses(subject, picture(subject)):
        codes = ("output_bearing_load", "output_bearing_life")
        states = [check(subject, use.gear.designation, code).status for code in codes]
        assert use.carries == (None if "not_rated" in states else states == ["pass", "pass"])

"""Form of a motion without a browser: switching, rows, bodies, errors, and taking over of phases."""

import re
from collections.abc import Sequence
from typing import Any
from urllib.parse import parse_qsl, urlencode

import pytest
from pydantic import ValidationError
from starlette.testclient import TestClient

from hpn.application import Application
from hpn.links import row_symbols, symbols
from hpn.links.labels import LABELS
from hpn.links.rows import MOVE_COLUMNS
from hpn.links.writer import to_link
from hpn.physics.motion.moves import Move, Stroke, Turn
from hpn.web.form.form import Form
from hpn.web.form.link_reader import parse
from hpn.web.form.ways import EXAMPLES, START
from hpn.web.pages.templates import parted
from tests.web.test_carried import Fields

PHASES = "T=40&n=250&t=0.3&T=-20&n=100&t=2&FRi=5&FRi=&FAi=&FAi="
TURN = "mech=rotary&J=0.8&Tf=1.5&mv=trapezoidal&ms=90&mt=0.8&mv=dwell&ms=&mt=0.4"
STROKE = "mech=ball_screw&h=10&ml=80&inc=30&mv=s_curve&ms=500&mt=2"
BODIES = "qs=disc&qm=60&qd=500&qs=point_mass&qm=5&qe=180&qn=4"


def read(query: str) -> Form:
    return parse(parse_qsl(query, keep_blank_values=True))


def fields_of(page: str) -> list[tuple[str, str]]:
    """Fields that the form of a page submits."""
    fields = Fields()
    fields.feed(page)
    return fields.pairs


def pressed(api: TestClient, query: str, *presses: str, cookies: str = "") -> str:
    """Page after pressing buttons one after the other, as without script; each sends the whole form."""
    page = api.get(f"/?{query}", headers={"Cookie": cookies})
    for press in presses:
        page = api.get(f"/?{urlencode([*fields_of(page.text), ('do', press)])}", headers={"Cookie": cookies})
    return page.text


def given(page: str, *names: str) -> list[tuple[str, str]]:
    return [(name, text) for name, text in fields_of(page) if name in names and text]


def moves_of(query: str) -> Sequence[Move]:
    application = read(query).application
    assert application and application.duty_cycle.motion
    return application.duty_cycle.motion.moves


def bodies(*rows: dict[str, Any]) -> str:
    names = [symbol.name for symbol in row_symbols.BODY_SYMBOLS]
    return urlencode([(name, row.get(name, "")) for row in rows for name in names])


TABLE = bodies({"qs": "disc", "qm": 60, "qd": 500}, {"qs": "point_mass", "qm": 5, "qe": 180, "qn": 4})


@pytest.mark.parametrize("query", [PHASES, TURN, STROKE, f"{TURN}&{BODIES}&d=5&ml=4", f"{PHASES}&tp=4&title=x&md=M"])
def test_the_form_sends_each_single_value_once(api: TestClient, query: str) -> None:
    page = api.get(f"/?{query}").text
    single = [symbol.name for symbol in (*symbols.SYMBOLS, *symbols.MECHANISM_SYMBOLS) if not symbol.many]
    names = [name for name, _ in fields_of(page)]

    assert {name for name in (*single, *LABELS) if names.count(name) > 1} == set()
    assert "tp" in names


@pytest.mark.parametrize("cookies", ["", "hpn_language=de; hpn_units=lb_in.lbf.lb.in.deg_per_s"])
def test_switching_there_and_back_loses_nothing(api: TestClient, cookies: str) -> None:
    ways = ("way:motion", "way:ball_screw", "way:phases", "way:motion", "way:rotary", "way:phases")
    for query in (PHASES, TURN, STROKE):
        page = pressed(api, f"{query}&tp=3&Tk=200", *ways, cookies=cookies)
        here = {"r": "way:rotary", "b": "way:ball_screw"}.get(query[5], "way:phases")
        again = fields_of(pressed(api, urlencode(fields_of(page)), here, cookies=cookies))
        assert parse(again).application == read(f"{query}&tp=3&Tk=200").application


def test_another_way_begins_without_the_worked_example(api: TestClient) -> None:
    example = to_link(Application.worked_example()).removeprefix("/?")
    page = pressed(api, example, "way:motion")
    assert given(page, "T", "tp", "Tk", "i") == [] and parse(fields_of(page)).empty
    assert given(pressed(api, urlencode(fields_of(page)), "way:phases"), "T", "tp") == [
        ("T", "40"),
        ("T", "32"),
        ("T", "20"),
    ]
    changed = pressed(api, example.replace("T=40", "T=41"), "way:motion")
    assert given(changed, "tp", "Tk") == [("tp", "4"), ("Tk", "200")]


def test_a_text_that_is_no_number_comes_back_as_typed(api: TestClient) -> None:
    page = pressed(api, "T=4o&n=250&t=0.3", "way:motion", "way:phases")
    assert given(page, "T") == [("T", "4o")]


def test_a_form_without_moves_asks_for_them_and_reports_nothing(api: TestClient) -> None:
    page = api.get(f"/?{START['rotary']}&tp=3")
    assert page.status_code == 200
    assert "Moves, each from rest to rest" in page.text
    part = api.get(f"/?{urlencode(fields_of(page.text))}", headers={"HX-Request": "true"})
    assert part.headers["HX-Push-Url"] == f"/?{START['rotary']}&tp=3"


def test_a_move_begins_with_a_profile_and_the_page_names_what_is_still_to_enter(api: TestClient) -> None:
    page = api.get(f"/?{START['ball_screw']}")
    assert given(page.text, "mv", "aside") == [("mv", "trapezoidal")] and "Four ways to begin" in page.text
    assert given(pressed(api, urlencode(fields_of(page.text)), "way:phases"), "aside") == []
    half = api.get(f"/?{START['ball_screw']}&h=20")
    assert half.status_code == 200
    assert "Still to enter: Moved mass, a move." in half.text
    assert api.get("/?mech=ball_screw&h=20&mv=trapezoidal").status_code == 422


def test_another_linear_mechanism_keeps_what_it_has_too(api: TestClient) -> None:
    page = pressed(api, STROKE, "way:belt")
    assert given(page, "mech", "h", "d", "ml", "inc", "ms") == [
        ("mech", "belt"), ("ml", "80"), ("inc", "30"), ("ms", "500")
    ]  # fmt: skip
    back = pressed(api, urlencode(fields_of(page)), "way:ball_screw")
    assert ("h", "10") in given(back, "h")


def test_figures_of_another_geometry_are_never_taken_for_this_one(api: TestClient) -> None:
    page = pressed(api, TURN, "way:ball_screw")
    assert given(page, "J", "ms", "mt", "mv", "Tf") == [("mv", "trapezoidal")]  # its own start


def test_phases_beside_a_motion_are_parted_by_the_switch(api: TestClient) -> None:
    both = f"{TURN}&T=40&n=250&t=0.3"
    page = api.get(f"/?{both}")
    assert page.status_code == 422
    assert "give either phases or a motion" in page.text
    for way, query in (("way:motion", TURN), ("way:phases", "T=40&n=250&t=0.3")):
        assert parse(fields_of(pressed(api, both, way))).application == read(query).application


def test_row_buttons_edit_moves_as_they_edit_phases() -> None:
    def moves(press: str) -> list[str]:
        return [f"{row['mv']} {row['mt']}".strip() for row in read(f"{TURN}&{urlencode({'do': press})}").moves]

    assert moves("down:1") == moves("up:2") == ["dwell 0.4", "trapezoidal 0.8"]
    assert moves("remove:1") == ["dwell 0.4"]
    assert moves("add") == ["trapezoidal 0.8", "dwell 0.4", ""]
    added = read(f"{TURN}&do=add")
    assert added.focus == "mv-2"
    assert added.application == read(TURN).application
    assert read(f"{TURN}&do=down:1").focus == "mv-1"
    assert [symbol.name for symbol in read(f"{TURN}&do=loads").move_columns][-2:] == ["FRi", "FAi"]


def test_the_columns_of_a_profile_are_those_that_the_model_lets_it_have() -> None:
    for table, model, way in ((row_symbols.TURN_SYMBOLS, Turn, 90.0), (row_symbols.STROKE_SYMBOLS, Stroke, 500.0)):
        for profile, columns in MOVE_COLUMNS.items():
            for symbol in table[1:]:
                start = {"profile": profile, "time_s": 2.0} | ({} if profile == "dwell" else {model.WAY: way})
                added = start | {symbol.path[-1]: {"mj": 0.5, "ms": way}.get(symbol.name, 1e4)}
                try:
                    model.model_validate(added)
                    refused = set()
                except ValidationError as error:
                    refused = {result["type"] for result in error.errors()}
                assert ("move_has_no" in refused) == (symbol.name not in columns), (profile, symbol.name)


def test_ramps_are_a_pair_of_columns_in_one_unit_and_turn_into_the_other_without_another_move() -> None:
    """600 mm at 400 mm/s up in 0.2 s and down in 0.5 s: 2000 and 800 mm/s2."""
    query = (
        "mech=ball_screw&h=20&ml=180&mv=trapezoidal&ms=600&mt=&mn=400&mta=0.2&mtd=0.5&mv=dwell&ms=&mt=1&mn=&mta=&mtd="
    )

    def shown(asked: str) -> list[str]:
        return [
            symbol.name
            for symbol in read(asked).move_columns
            if symbol.name not in ("mv", "ms", "mt", "mn", "mj", "mx")
        ]

    assert shown(query) == ["mta", "mtd"]
    turned = f"{query}&do=ramps:acceleration"
    assert shown(turned) == ["ma", "md2"]
    assert [read(turned).moves[0][name] for name in ("mn", "ma", "md2")] == ["400", "2000", "800"]
    assert moves_of(turned)[0].timing.ramps_s == pytest.approx(moves_of(query)[0].timing.ramps_s, rel=1e-12)
    both = read(f"{query}&do=ramps:acceleration&do=ramps:time")
    assert both.application == read(query).application
    assert shown(query.replace("&mta=0.2&mtd=0.5", "&mta=&mtd=") + "&do=ramps") == ["ma"]


def test_a_ramp_that_never_reaches_its_speed_turns_into_the_same_move() -> None:
    """90 degrees never reach 500 rpm at 900 deg/s2: 90 = a t2 makes 0.316 s for each ramp."""
    query = "mech=rotary&J=0.8&mv=trapezoidal&ms=90&mt=&mn=500&ma=900&md2="
    (one,), (other,) = moves_of(query), moves_of(f"{query}&do=ramps:time")
    assert other.acceleration_time_s == pytest.approx(0.1**0.5, rel=1e-11)
    assert other.timing.ramps_s == pytest.approx(one.timing.ramps_s, rel=1e-11)


def test_the_ramps_of_an_unfinished_move_stay_where_they_are() -> None:
    form = read("mech=rotary&J=0.8&mv=trapezoidal&ms=&mt=&mn=50&ma=900&md2=400&do=ramps:time")
    assert [form.moves[0][name] for name in ("mta", "mtd", "ma", "md2")] == ["", "", "900", "400"]


@pytest.mark.parametrize(
    ("move", "place"),
    [
        ("mv=trapezoidal&ms=&mt=1", "ms-0"),
        ("mv=trapezoidal&ms=90&mt=&mn=20", "mt-0"),
        ("mv=triangular&ms=90&mt=", "mt-0"),
    ],
)
def test_a_figure_that_a_move_lacks_is_named_at_its_cell_and_in_the_result(
    api: TestClient, move: str, place: str
) -> None:
    page = api.get(f"/?mech=rotary&J=0.8&{move}").text
    assert re.search(rf'id="{place}"[^>]*aria-invalid="true"', page)
    assert f'<li data-field="{place}"' in page[page.index('id="result"') :]


@pytest.mark.parametrize(
    ("query", "place", "message"),
    [
        (f"{TURN}&mj=&mj=0.5", "mj-1", "has no Jerk share: leave it out"),
        (TURN.replace("mt=0.8", "mt=x"), "mt-0", "is not a number"),
        (TURN.replace("mv=dwell", "mv="), "mv-1", "is missing"),
        (f"{TURN}&FRi=&FRi=x", "FRi-1", "is not a number"),
    ],
)
def test_an_error_of_a_move_stands_below_the_table_and_is_tied_to_its_cell(
    api: TestClient, query: str, place: str, message: str
) -> None:
    page = api.get(f"/?{query}").text
    below = page[page.index('id="duty-errors"') :]
    assert re.search(rf'<a href="#{place}">[^<]*, move 2</a>|<a href="#{place}">[^<]*, move 1</a>', below)
    assert re.search(rf'id="e-{place}">[^<]*{re.escape(message)}', below)
    assert re.search(rf'id="{place}"[^>]*aria-invalid="true" aria-describedby="e-{place}"', page)


@pytest.mark.parametrize(
    ("query", "place", "is_asked_for"),
    [
        ("T=18&n=150&t=1&dt=belt", "f-dd", True),
        ("T=18&n=150&t=1&dt=belt&dd=x", "f-dd", False),
        (TURN.replace("J=0.8&", ""), "f-J", True),
        (TURN.replace("mv=dwell", "mv="), "mv-1", True),
    ],
)
def test_an_input_that_is_missing_is_asked_for_and_a_wrong_one_refused(
    api: TestClient, query: str, place: str, is_asked_for: bool
) -> None:
    page = api.get(f"/?{query}").text
    assert bool(re.search(rf'id="{place}"[^>]*data-missing aria-invalid="true"', page)) is is_asked_for
    assert ("Still to enter:" in page[page.index('class="named"') :]) is is_asked_for
    assert ("Not recalculated: one input is missing." in page) is is_asked_for


def test_an_error_of_a_mechanism_stands_beside_its_field(api: TestClient) -> None:
    page = api.get(f"/?{TURN}&mg=12").text
    assert re.search(r'id="e-mg">gravity needs Its distance from the shaft as well', page)
    assert re.search(r'id="e-h">does not belong to this mechanism', api.get(f"/?{TURN}&h=5").text)
    german = api.get(f"/?{TURN}&mg=12", headers={"Cookie": "hpn_language=de"}).text
    assert re.search(r'id="e-mg">[^<]*Ihr Abstand von der Welle', german)


def test_only_what_the_mechanism_has_can_be_typed(api: TestClient) -> None:
    for kind, query in (("rotary", TURN), ("ball_screw", STROKE)):
        names = {name for name, _ in fields_of(api.get(f"/?{query}").text)} & {
            symbol.name for symbol in symbols.MECHANISM_SYMBOLS
        }
        assert names == {"mech", *(symbol.name for symbol in symbols.mechanism_symbols(kind))}


def test_the_sum_of_bodies_becomes_the_inertia_and_the_link_has_the_sum(api: TestClient) -> None:
    query = f"{TURN.replace('J=0.8', 'J=')}&{TABLE}"
    page = pressed(api, query, "inertia")
    assert given(page, "J", "mg", "rg") == [("J", "2.523")]
    form = parse(fields_of(page))
    assert form.application is not None
    assert to_link(form.application) == f"/?{TURN.replace('0.8', '2.523', 1)}"
    assert given(page, "qs", "qd") == [("qs", "disc"), ("qd", "500"), ("qs", "point_mass")]


def test_gravity_of_bodies_comes_only_where_it_is_asked_for(api: TestClient) -> None:
    page = pressed(api, f"{TURN}&{TABLE}", "gravity")
    assert given(page, "J", "mg", "rg") == [("J", "2.523"), ("mg", "20"), ("rg", "180")]
    linear = pressed(api, f"{STROKE}&{TABLE}", "gravity")
    assert given(linear, "J", "mg", "rg") == [("J", "2.523")]


def test_bodies_are_read_in_the_units_of_the_reader(api: TestClient) -> None:
    table = bodies({"qs": "disc", "qm": "10", "qd": "20"})
    cookies = "hpn_units=lb_in.lbf.lb.in.degF"
    page = pressed(api, f"{TURN}&{table}&written=en.lb_in.lbf.lb.in.degF", "inertia", cookies=cookies)
    assert float(dict(given(page, "J"))["J"]) == pytest.approx(10 * 0.45359237 * 0.508**2 / 8, rel=1e-5)


def test_a_figure_that_a_body_lacks_is_named_and_the_selection_goes_on(api: TestClient) -> None:
    page = api.get(f"/?{TURN}&{bodies({'qs': 'ring', 'qm': 5, 'qd': 'x'}, {'qs': 'disc', 'qm': 3})}")
    assert page.status_code == 200
    assert re.search(r'<a href="#qd-0">Diameter, body 1</a>: <span>is not a number', page.text)
    assert re.search(r'<a href="#qd-1">Diameter, body 2</a>: <span>this shape needs Diameter', page.text)
    assert 'value="inertia"' not in page.text


def test_phases_that_come_out_are_taken_over_with_peaks_and_rms_and_give_the_same_answer(api: TestClient) -> None:
    query = f"{TURN}&mg=12&rg=250&FRi=300&FRi="
    before = read(query).application
    assert before is not None
    page = pressed(api, query, "take")
    after = parse(fields_of(page)).application
    assert after is not None
    assert after.duty_cycle.motion is None
    for typed, result in zip(after.duty_cycle.load_phases, before.duty_cycle.load_phases, strict=True):
        for name, value in result:
            assert getattr(typed, name) == (value if value is None else pytest.approx(value, rel=1e-5))
    assert parse(fields_of(pressed(api, urlencode(fields_of(page)), "way:motion"))).application == before


def test_a_motion_of_hundreds_of_moves_is_taken_over_as_text(api: TestClient) -> None:
    query = "mech=rotary&J=0.8" + "&mv=trapezoidal&ms=90&mt=0.8" * 150
    form = [*fields_of(api.get(f"/?{query}").text), ("do", "take")]
    encoded = {"Content-Type": "application/x-www-form-urlencoded"}
    page = api.post("/", content=urlencode(form), headers=encoded)
    assert 'name="phases"' in page.text
    fields = fields_of(page.text)
    back = api.post("/", content=urlencode([*fields, ("do", "way:motion")]), headers=encoded)
    assert [name for name, _ in fields_of(back.text)].count("mv") == 150


def test_bounds_of_a_move_are_numbers_of_the_reader(api: TestClient) -> None:
    link = "/?mech=rotary&J=0.08&mv=trapezoidal&ms=90&mt=0.8&mn=5"
    assert "must be above 18.75 (" in api.get(link).text
    assert "muss über 18,75 liegen" in api.get(link, headers={"Accept-Language": "de"}).text


def test_notices_of_a_motion_stand_beside_its_moves(api: TestClient) -> None:
    page = api.get("/?mech=rotary&J=0.8&mg=12&rg=250&mv=trapezoidal&ms=90&mn=500&ma=900").text
    form = page[: page.index('id="result"')]
    assert "Moves 1 leave no time at constant speed" in form
    assert "does not end at its start angle" in form


@pytest.mark.parametrize("link", EXAMPLES)
def test_examples_are_canonical_links_with_a_suitable_gear(api: TestClient, link: str) -> None:
    form = read(link.removeprefix("/?"))
    assert form.application is not None
    assert to_link(form.application) == link
    assert re.search(r"suitable</span> · first of \d+ suitable", api.get(link).text)
    assert link.replace("&", "&amp;") in api.get(f"/?{TURN}").text


def test_hostile_asides_are_left_alone(api: TestClient) -> None:
    for aside in ("%00", "mech=rotary&" * 30_000, "a=b&do=take", "mech=lever&T=1", "&;&;%zz"):
        for press in ("way:motion", "way:phases", "way:nothing", "take", "inertia"):
            page = api.post("/", data={"T": "1", "n": "1", "t": "1", "aside": aside, "do": press})
            assert page.status_code in (200, 413, 422)


@pytest.mark.parametrize(
    ("cookies", "speed", "acceleration"),
    [("", "28.1", "633"), ("hpn_language=de", "28,1", "633")],
    ids=["en", "de"],
)
def test_cells_left_blank_show_what_follows(api: TestClient, cookies: str, speed: str, acceleration: str) -> None:
    """90 deg in 0.8 s with a third for each ramp: 168.75 deg/s or 28.125 rpm, 632.8 deg/s2."""
    page = api.get(f"/?{TURN}", headers={"Cookie": cookies}).text
    view = dict(re.findall(r'<input id="(\w+-0)"[^>]*placeholder="([^"]*)"', page))
    assert (view["mn-0"], view["ma-0"]) == (speed, acceleration)
    assert view["mt-0"] == " "


def test_the_governing_check_names_its_move_or_phase(api: TestClient) -> None:
    """A quarter turn in 0.4 s after five turns in 8 s has the peak torque; of two phases the faster has the speed."""
    moves = "mech=rotary&J=0.8&Tf=1.5&mv=trapezoidal&ms=1800&mt=8&mv=trapezoidal&ms=-90&mt=0.4"
    of_moves, of_phases = (api.get(f"/?{query}").text for query in (moves, "T=1&n=10&t=1&T=1&n=900&t=0.001&tp=1"))
    assert re.search(r'id="check-repeated_peak_torque"(?:(?!</th>).)*· move 2\b', of_moves, re.DOTALL)
    assert re.search(r'id="check-maximum_input_speed"(?:(?!</th>).)*· phase 2\b', of_phases, re.DOTALL)


def test_a_head_parts_its_words_with_soft_hyphens_where_the_column_is_narrow() -> None:
    words = "Drehzahl", "Spitzendrehzahl", "Beschleunigung", "Ruckanteil", "Acceleration", "Torque", "Dauer"
    assert [parted(word).replace("\N{SOFT HYPHEN}", "|") for word in words] == [
        *("Dreh|zahl", "Spitzen|drehzahl", "Beschleuni|gung", "Ruck|anteil", "Acceler|ation", "Torque", "Dauer")
    ]

"""Tolerances at the doors: the reply of `select`, a line of a batch, links, and the page."""

import re

import pytest
from starlette.testclient import TestClient

from hpn.application import Application
from hpn.links.writer import to_link
from hpn.web.door.bodies import pairs_of
from hpn.web.form import link_reader
from hpn.web.form.form import for_reader
from hpn.words.reader import Reader
from tests.build import TURNING, Json, cycle, phase, worked_example

PATH = "/api/v1/select"
STOP = "emergency_stop.torque_Nm"
TOLERANCES: Json = {"torque_Nm": {"percent": 10}, "pause_s": {"percent": 50}, STOP: {"percent": 20}}
WIDE = worked_example(tolerances=TOLERANCES | {STOP: {"percent": 40}})


def select(api: TestClient, application: Json, query: str = "") -> Json:
    reply = api.post(PATH + query, json=application)
    assert reply.status_code == 200, reply.text
    body: Json = reply.json()
    return body


def test_without_tolerances_the_reply_has_none_of_their_fields(api: TestClient) -> None:
    reply = select(api, worked_example(tolerances=None))

    assert "tolerance" not in reply
    assert all("worst" not in candidate for candidate in reply["candidates"])
    assert all("worst" not in check and "exact" not in check for check in reply["candidates"][0]["checks"])


def test_a_gear_that_holds_has_its_worst_case_as_an_application(api: TestClient) -> None:
    reply = select(api, worked_example(tolerances=TOLERANCES))
    room, best = reply["tolerance"], reply["candidates"][0]

    assert room["holds"]
    assert room["exact"]
    assert best["worst"] == {"utilisation": 0.9375, "governing_check": "momentary_peak_torque", "status": "suitable"}
    assert room["growth"] == pytest.approx(1.4, rel=1e-8)  # 200 Nm · (1 + 1.4 · 0.2) is T_M, 256 Nm
    assert room["deciding"] == [{"path": STOP, "worst": 0.78125}]
    case = select(api, room["case"])
    assert case["candidates"][0]["utilisation"] == 0.9375
    assert room["link"] == case["link"]


def test_a_case_that_fails_opens_and_fails(api: TestClient) -> None:
    reply = select(api, WIDE)
    room, selected = reply["tolerance"], reply["selected"]
    case = select(api, room["case"])

    assert not room["holds"]
    assert room["growth"] == pytest.approx(0.7, rel=1e-8)
    assert next(one for one in case["candidates"] if one["designation"] == selected)["status"] == "unsuitable"


def test_over_tolerance_judges_by_the_worst(api: TestClient) -> None:
    by_worst = select(api, WIDE | {"requirements": {"ratios": [5], "over_tolerance": True}})

    assert by_worst["selected"] == "HPN-32A-5"
    rejected = next(one for one in by_worst["candidates"] if one["designation"] == "HPN-20A-5")
    assert (rejected["status"], rejected["utilisation"]) == ("unsuitable", 280 / 256)


def test_the_worst_case_has_a_limit_of_its_own(api: TestClient) -> None:
    document = {"ratios": [5], "utilisation": 0.8, "worst_case_utilisation": 1.0}
    reply = select(api, worked_example(tolerances=TOLERANCES, requirements=document))

    assert reply["tolerance"]["holds"]
    assert select(api, reply["tolerance"]["case"])["selected"] == reply["selected"]  # judged by the limit 1, as here


LEVER: Json = cycle(
    phase(5, 100),
    output_load={"radial_N": 350, "radial_position_mm": 40},  # x_c is unknown: 350 N at the centre are a lower bound
    tolerances={"output_load.radial_N": {"percent": 25}},
)


@pytest.mark.parametrize(("u", "of_worst"), [(0.8, 1.0), (1.0, 0.8)])
def test_a_lower_bound_passes_no_worst_case(api: TestClient, u: float, of_worst: float) -> None:
    """It fails above the limit of the worst case, and is unrated below; u applies only to the nominal case."""
    document = {"sizes": ["11A"], "utilisation": u, "worst_case_utilisation": of_worst}
    nominal = select(api, LEVER | {"requirements": document})["candidates"][0]
    by_worst = select(api, LEVER | {"requirements": document | {"over_tolerance": True}})["candidates"][0]

    assert nominal["status"] == "unrated"
    fails = of_worst < 350 * 1.25 / 480  # F_R,dyn(max) of HPN-11A is 480 N
    assert nominal["worst"]["status"] == ("unsuitable" if fails else "unrated")
    assert by_worst["status"] == nominal["worst"]["status"]


def test_a_share_of_samples_is_an_interval(api: TestClient) -> None:
    share = select(api, worked_example(tolerances=TOLERANCES), "?samples=1000")["tolerance"]["share"]
    failing = select(api, WIDE, "?samples=1000")["tolerance"]["share"]

    assert (share["samples"], share["failing"]) == (1000, 0)
    assert share["upper"] == pytest.approx(1 - 0.05 ** (1 / 1000), rel=1e-9)  # about 3 / n
    assert failing["failing"] / 1000 < failing["upper"] < 1.5 * failing["failing"] / 1000


def test_a_line_of_a_batch_says_what_select_says(api: TestClient) -> None:
    items = [worked_example(tolerances=TOLERANCES), WIDE, worked_example()]
    lines = api.post(f"{PATH}/batch", json={"applications": items}).json()["results"]

    for item, line in zip(items[:2], lines[:2], strict=True):
        reply = select(api, item)
        worst = reply["candidates"][0]["worst"]
        notice = line["holds"], line["worst_utilisation"], line["worst_governing_check"]
        assert notice == (reply["tolerance"]["holds"], worst["utilisation"], worst["governing_check"])
    assert "holds" not in lines[2]


TURNED: Json = {"duty_cycle": {"motion": TURNING, "pause_s": 1.0}}


def test_a_corner_that_is_no_application_is_an_error_of_its_line_alone(api: TestClient) -> None:
    """With +2 %, 12 kg at 255 mm have 0.780 kg·m², more than the 0.76 kg·m² of the whole load."""
    moved = {"motion.mechanism.gravity_radius_mm": {"percent": 2}}
    mechanism = {**TURNING["mechanism"], "inertia_kgm2": 0.76}
    bad = {"duty_cycle": {"motion": {**TURNING, "mechanism": mechanism}}, "tolerances": moved}
    good = {**TURNED, "tolerances": moved, "reference": "the same with a name of its own"}
    lines = api.post(f"{PATH}/batch", json={"applications": [good, bad, worked_example(tolerances=TOLERANCES)]})
    first, second, third = lines.json()["results"]

    assert first["status"] == third["status"] == "ok" and first["holds"] is not None
    assert second["problem"]["errors"] == api.post(PATH, json=bad).json()["errors"]


LINKS = {
    "tol=T:10p": {"torque_Nm": {"percent": 10.0}},
    "tol=T.2:0.5": {"phases.1.torque_Nm": {"absolute": 0.5}},
    "tol=tp:0p/15p": {"pause_s": {"minus": {"percent": 0.0}, "plus": {"percent": 15.0}}},
    "tol=T:10p&tol=n:5p": {"torque_Nm": {"percent": 10.0}, "speed_rpm": {"percent": 5.0}},
}
EXAMPLE = "T=40&n=250&t=0.3&T=32&n=500&t=3&tp=4&i=5"


@pytest.mark.parametrize("link", LINKS)
def test_a_link_has_tolerances_and_comes_back_to_the_byte(link: str) -> None:
    form = link_reader.parse(pairs_of(f"{EXAMPLE}&{link}"))

    assert form.application is not None
    assert form.application.model_dump(exclude_none=True)["tolerances"] == LINKS[link]
    assert to_link(form.application) == f"/?{EXAMPLE}&{link}"


def test_a_link_of_a_motion_has_the_tolerance_of_a_move() -> None:
    of_move, of_mechanism = "motion.moves.1.external_torque_Nm", "motion.mechanism.inertia_kgm2"
    tolerances = {of_mechanism: {"percent": 5.0}, of_move: {"absolute": 2.0}}
    question = Application.model_validate({"duty_cycle": {"motion": TURNING}, "tolerances": tolerances})
    link = to_link(question)

    assert link.endswith("&tol=J:5p&tol=mx.2:2")
    assert link_reader.parse(pairs_of(link[2:])).application == question


WRONG = {
    "T": "tol-0",
    "T.0:1": "tol-0",
    "X:1p": "tol-0",
    "T:1p&tol=T:2p": "tol-0",
    "T.9:1": "tol-0",
    "J:1p": "tol-0",
    "T:": "tol-0",
    "n:100p": "f-tol_n",
    "n.2:100p": "tols_n-1",
    "FR:5p": "f-tol_FR",
    "tp:1p/2p/3p": "tol-0",
}
"""Invalid tolerances, and the field beside which each error is shown; `tol-0` is the link's own, for the others."""


@pytest.mark.parametrize("link", WRONG)
def test_a_tolerance_without_sense_answers_422_beside_its_field(api: TestClient, link: str) -> None:
    reply = api.get(f"/?{EXAMPLE}&tol={link}")

    assert reply.status_code == 422
    field = re.search(f'<input[^>]*id="{WRONG[link]}"[^>]*>', reply.text)
    assert field and 'aria-invalid="true"' in field[0]


TYPED = {
    "10": {"percent": 10.0},
    "±10 %": {"percent": 10.0},
    "0.5 Nm": {"absolute": 0.5},
    "+5 −2": {"minus": {"percent": 2.0}, "plus": {"percent": 5.0}},
    "+5 % -2 Nm": {"minus": {"absolute": 2.0}, "plus": {"percent": 5.0}},
    "+1e-3 Nm": {"minus": {"percent": 0.0}, "plus": {"absolute": 1e-3}},
    "-2": {"minus": {"percent": 2.0}, "plus": {"percent": 0.0}},
    "500 Nmm": {"absolute": 0.5},
}


@pytest.mark.parametrize("text", TYPED)
def test_a_tolerance_is_typed_in_percent_or_in_a_unit(text: str) -> None:
    form = link_reader.parse([*pairs_of(EXAMPLE), ("written", "en"), ("tols_T", ""), ("tols_T", text)])

    assert form.application is not None
    assert form.application.model_dump(exclude_none=True)["tolerances"] == {"phases.1.torque_Nm": TYPED[text]}


@pytest.mark.parametrize("reader", [Reader(), Reader("de"), Reader("de", ("lb_in", "degF")), Reader("en", ("lb_ft",))])
def test_what_a_field_shows_of_a_tolerance_is_read_as_the_same(reader: Reader) -> None:
    question = "tol=T:10p&tol=Tk:0.3&tol=tp:0p/15p&tol=fw:0.05&tol=ta:5&tol=T.1:0.7/3p&tol=t.2:0.1"
    form = link_reader.parse(pairs_of(f"{EXAMPLE}&Tk=100&FR=100&fw=1.2&ta=25&{question}"))
    view = for_reader(form, reader)
    rows = [(name, text) for row in view.rows for name, text in row.items()]
    again = link_reader.parse(
        [*rows, *view.texts.items(), ("i", "5"), ("written", reader.marker or "en"), ("was", view.was)]
    )

    assert form.application is not None and len(form.application.tolerances or {}) == 7
    assert again.application == form.application, again.problems


ROWS = {
    "up:2": "T.1",
    "down:1": "T.1",
    "remove:1": "T.1",
    "add&do=up:3": "T.3",
    "down:2": "T.2",
}


@pytest.mark.parametrize("press", ROWS)
def test_the_tolerance_of_a_row_goes_with_its_row(press: str) -> None:
    """The second phase's 32 Nm keep it, wherever that phase is moved; a blank row between does not count."""
    form = link_reader.parse(pairs_of(f"{EXAMPLE}&tol=T.2:10p&do={press}"))
    (at,) = (k for k, row in enumerate(form.rows) if row["T"] == "32")

    assert form.rows[at]["tols_T"] == "10p"
    assert f"T.{at + 1}" == ROWS[press]
    assert form.application is not None
    (path,) = form.application.tolerances or {}
    phases = form.application.duty_cycle.load_phases
    assert phases[int(path.split(".")[1])].torque_Nm == 32


def test_the_tolerance_of_a_removed_row_is_gone() -> None:
    form = link_reader.parse(pairs_of(f"{EXAMPLE}&tol=T.2:10p&do=remove:2"))

    assert form.application is not None and not form.application.tolerances


def test_exact_puts_tolerances_out_of_count_and_keeps_what_was_typed(api: TestClient) -> None:
    exact = api.get(f"/?{EXAMPLE}&tol=T.2:10p&do=tolerances").text
    form = link_reader.parse(pairs_of(f"{EXAMPLE}&written=en&tols_T=&tols_T=10+%25&exact=1"))
    again = link_reader.parse(pairs_of(f"{EXAMPLE}&written=en&tols_T=&tols_T=10+%25&exact=1&do=tolerances"))

    assert "Holds over" not in exact
    assert '<input type="hidden" id="tols_T-1" name="tols_T" value="10 %">' in exact
    assert form.application is not None and not form.application.tolerances
    assert again.application is not None and list(again.application.tolerances or ()) == ["phases.1.torque_Nm"]


def test_who_does_not_ask_for_tolerances_sees_no_field_of_them(api: TestClient) -> None:
    plain, case = api.get(f"/?{EXAMPLE}").text, api.get(f"/?{EXAMPLE}&do=tolerances").text

    assert "tol_" not in plain.split("<dialog")[0] and "Judge" not in plain
    assert 'name="tol_T"' in case and 'name="tols_n"' in case and 'name="tol_Tk"' in case


def test_the_page_says_whether_the_gear_holds_and_keeps_the_tolerance(api: TestClient) -> None:
    holds, fails = (api.get(f"/?{EXAMPLE}&Tk=200&tol=Tk:{percent}p").text for percent in (20, 40))

    assert "Holds over the whole tolerance: momentary peak torque at most at 93.75" in holds
    assert "Fails inside the tolerance: momentary peak torque reaches 109.4" in fails
    assert "Open that case" in fails
    assert re.search('name="tol_Tk"[^>]*value="20 %"', holds)


def test_a_saved_selection_keeps_its_tolerances(api: TestClient) -> None:
    saved = api.post("/api/v1/selections", json={"application": WIDE})
    reply = api.get(saved.headers["Location"]).json()

    assert reply["result"]["tolerance"]["holds"] is False
    assert reply["application"]["tolerances"]["pause_s"] == {"percent": 50}
    assert api.get(f"/selections/{saved.json()['id']}").status_code == 200


def test_the_worst_cycle_is_drawn_at_the_edge_of_its_tolerances(api: TestClient) -> None:
    """A torque that is worst at its maximum: the case reaches the band's edge instead of the given value."""
    page = api.get(f"/?{EXAMPLE}&tol=T:10p", headers={"HPN-Parts": "tolerance"}).text
    figure = page.partition('aria-labelledby="worst-cycle-heading"')[2].partition("</figure>")[0]
    torque = {
        kind: min(float(y) for y in re.findall(r"[ML][\d.]+ ([\d.]+)", d))
        for kind, d in re.findall(r'<path class="(band|given|steps worst)" d="([^"]+)"', figure)[:3]
    }

    assert torque["steps worst"] == torque["band"] < torque["given"]


def test_a_motion_has_no_worst_cycle_of_typed_phases(api: TestClient) -> None:
    page = api.get("/?mech=rotary&J=0.8&mv=trapezoidal&ms=90&mt=0.8&tol=J:5p", headers={"HPN-Parts": "tolerance"}).text

    assert "Deciding inputs" in page
    assert "worst-cycle-heading" not in page


VARYING: Json = TURNED | {"tolerances": {"motion.moves.0.time_s": {"percent": 5}, "pause_s": {"percent": 10}}}


def on_the_edge(api: TestClient) -> Json:
    """Motion with a varying time, restricted to its gear, with a limit just above its utilisation for given values."""
    best = select(api, TURNED)["candidates"][0]
    document = {"sizes": [best["size"]], "ratios": [best["ratio"]], "utilisation": best["utilisation"] * (1 + 1e-6)}
    return VARYING | {"requirements": document}


def test_a_sampled_case_that_fails_opens_and_fails(api: TestClient) -> None:
    """The sample is an ordinary application, with the same utilisation apart from rounding."""
    reply = select(api, on_the_edge(api))
    room, (candidate, *_) = reply["tolerance"], reply["candidates"]
    opened = select(api, room["case"])["candidates"][0]

    assert (room["holds"], room["exact"]) == (False, False)
    assert "tolerances" not in room["case"] and opened["status"] == "unsuitable"
    assert opened["utilisation"] == pytest.approx(candidate["worst"]["utilisation"], rel=1e-12)
    assert api.get(room["link"]).status_code == 200


def test_what_is_sampled_is_the_same_each_time_and_a_bound(api: TestClient) -> None:
    first, again = (select(api, on_the_edge(api), "?samples=1000")["tolerance"] for _ in range(2))
    holding = select(api, VARYING, "?samples=1000")["tolerance"]["share"]

    assert first == again
    assert 0 < first["share"]["failing"] / first["share"]["samples"] < first["share"]["upper"] < 1
    assert (holding["failing"], holding["samples"]) == (0, 256)
    assert holding["upper"] == pytest.approx(1 - 0.05 ** (1 / 256), rel=1e-9)


@pytest.mark.parametrize(("language", "message"), [("en", "always the same"), ("de", "immer die gleichen")])
def test_the_page_says_that_it_is_sampled_and_never_that_nothing_fails(
    api: TestClient, language: str, message: str
) -> None:
    link = select(api, VARYING)["link"]
    page = api.get(link, headers={"HPN-Parts": "tolerance", "Accept-Language": language}).text
    of_share = page.partition("share-of-cases")[2].partition("</p>")[0]

    assert message in page and "≈" in page
    assert "1.2" in of_share or "1,2" in of_share  # 1 - 0.05^(1/256), rounded up
    assert not re.search(r"[^0-9.,]0\s?%", of_share)

"""Labels of a selection are carried in the address and through every edit, but never in the canonical link."""

import html
import re
from urllib.parse import parse_qsl, urlencode

import pytest
from starlette.testclient import TestClient

from hpn.catalogue import Catalogue
from hpn.links.labels import LABELS
from tests.build import worked_example
from tests.state import state_of
from tests.web.test_carried import Fields

CYCLE = [("T", "40"), ("n", "250"), ("t", "0.3")]
WRITTEN = {"title": "Rotary table <7> & Ä", "ref": "4711-07", "author": "M. Muster", "rev": "B"}
ORDERED = {"order_output": "J8", "order_motor": "BH-AF1"}
GIVEN = [*CYCLE, *WRITTEN.items(), *ORDERED.items()]
ADDRESS = "/?" + urlencode(GIVEN)


def edit(api: TestClient, pairs: list[tuple[str, str]], target: str = "section#result") -> str:
    """Address that htmx gets after an edit of the form."""
    reply = api.get("/?" + urlencode(pairs), headers={"HX-Request": "true", "HX-Target": target})
    return str(reply.headers["hx-push-url"])


def labels_in(address: str) -> dict[str, str]:
    return {name: text for name, text in parse_qsl(address.partition("?")[2]) if name in LABELS}


@pytest.mark.parametrize(
    "more",
    [[], [("tp", "4")], [("gear", "HPN-32A-5")], [("pin", "HPN-20A-4")], [("do", "add")], [("written", "de")]],
)
def test_an_edit_keeps_what_is_written_on_the_selection(api: TestClient, more: list[tuple[str, str]]) -> None:
    assert labels_in(edit(api, [*GIVEN, *more])) == WRITTEN | ORDERED


def test_the_head_has_the_whole_title_where_its_line_is_too_short_for_it(api: TestClient) -> None:
    link = next(line for line in api.get(ADDRESS).text.splitlines() if 'class="subject"' in line)
    assert f'title="{html.escape(WRITTEN["title"])}"' in link
    unnamed = next(line for line in api.get("/").text.splitlines() if 'class="subject"' in line)
    assert 'title="Title, reference, author and revision"' in unnamed


def test_a_form_without_a_phase_keeps_it_too(api: TestClient) -> None:
    blank = [(name, "") for name, _ in CYCLE]
    assert labels_in(edit(api, [*blank, *WRITTEN.items()])) == WRITTEN


def test_a_blank_label_stands_in_no_address(api: TestClient) -> None:
    blank = {name: " " for name in LABELS} | {"order_output": "J6"}
    assert edit(api, [*CYCLE, *blank.items()]) == "/?T=40&n=250&t=0.3"


def test_it_is_no_part_of_the_canonical_link(api: TestClient) -> None:
    link = re.search(r'name="link" value="([^"]*)"', api.get(ADDRESS).text)
    assert link and labels_in(html.unescape(link[1])) == WRITTEN | ORDERED
    application = api.post("/application.json", data={"link": html.unescape(link[1])}).json()
    assert api.post("/api/v1/select", json=application).json()["link"] == "/?" + urlencode(CYCLE)


def test_every_way_of_the_page_to_another_of_its_states_keeps_it(api: TestClient) -> None:
    page = api.get(ADDRESS + "&pin=HPN-32A-5&Tm=0.1").text
    tried = [link for link in map(html.unescape, re.findall(r'href="(/\?[^"]*)"', page)) if "T=" in link.split("&")[0]]
    assert [link for link in tried if labels_in(link) not in ({}, WRITTEN | ORDERED)] == []
    ways = re.findall(r'<button[^>]* form="application"\s+name="(gear|pin|unpin)"\s+value="([^"]*)"', page)
    assert len({gear for way, gear in ways if way != "gear"}) == 64  # every gear of the catalogue
    assert len({gear for way, gear in ways if way == "gear"}) == 51  # those with ratings, in the map
    fields = Fields()
    fields.feed(page)
    assert labels_in(edit(api, [*fields.pairs, ("gear", "HPN-14A-5")])) == WRITTEN | ORDERED


def test_the_page_of_a_gear_gives_it_back(api: TestClient) -> None:
    to_gear = re.search(r'href="(/catalogue/HPN-20A-5\?[^"]*)"', api.get(ADDRESS + "&gear=HPN-20A-5").text)
    assert to_gear
    back = re.search(r'href="([^"]*)">Use in selection', api.get(html.unescape(to_gear[1])).text)
    assert back and labels_in(html.unescape(back[1])) == WRITTEN | ORDERED


@pytest.mark.parametrize("name", LABELS)
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a\nb", "must not contain control characters or line breaks"),
        ("a\u202eb", "must not contain control characters or line breaks"),
        ("x" * 201, "must have at most 200 characters"),
        ("a\u200bb", re.escape("must not contain the invisible character U+200B ZERO WIDTH SPACE")),
        ("a\u2060b", re.escape("must not contain the invisible character U+2060 WORD JOINER")),
        ("a\ufeff", re.escape("must not contain the invisible character U+FEFF ZERO WIDTH NO-BREAK SPACE")),
        ("a\U000e0041", re.escape("must not contain the invisible character U+E0041 TAG LATIN CAPITAL LETTER A")),
        ("a\U000e0000", re.escape("must not contain the invisible character U+E0000")),
        ("a" + "\u0301\u0323\u0330\u0331\u0332\u0333", "must have at most 4 combining marks in a row"),
    ],
)
def test_a_label_that_can_not_be_taken_is_named(api: TestClient, name: str, text: str, message: str) -> None:
    reply = api.get("/?" + urlencode([*CYCLE, (name, text)]))
    assert reply.status_code == 422
    assert re.search(rf'href="#f-{name}">{LABELS[name]}</a>: <span>{message}', reply.text)


def test_a_label_given_twice_is_asked_for_once(api: TestClient) -> None:
    reply = api.get("/?" + urlencode([*CYCLE, ("title", "a"), ("title", "b")]))
    assert reply.status_code == 422
    assert "must be a single value; given: a, b" in reply.text


SPELT = [
    "\U0001f468\u200d\U0001f469\u200d\U0001f467",
    "\u0645\u06cc\u200c\u062e\u0648\u0627\u0647\u0645",  # Persian, with a joiner that keeps letters apart
    "a\u0301\u0323\u0330\u0331\u0332",  # five marks, of which one is composed with its letter
    "\u0e17\u0e35\u0e48",  # Thai, a vowel and a tone above one letter
]


@pytest.mark.parametrize("text", SPELT)
def test_characters_of_spelling_stay(api: TestClient, text: str) -> None:
    assert labels_in(edit(api, [*CYCLE, ("title", text)])) == {"title": text}
    saved = api.post("/api/v1/selections", json={"application": worked_example(), "title": text})
    assert api.get(saved.headers["Location"]).json()["title"] == text


LOOK_ALIKE = ["Axis\u200b 7", "Axis\u2060 7", "Axis 7\ufeff.", "Axis 7\U000e0037", "Axis 7\u0301" + "\u0335" * 4]


@pytest.mark.parametrize("text", [*LOOK_ALIKE, "a\nb", "x" * 41])
def test_rest_refuses_such_names_of_phases_and_moves(api: TestClient, text: str) -> None:
    phase, move = {"torque_Nm": 1, "speed_rpm": 1, "duration_s": 1}, {"profile": "dwell", "time_s": 1}
    motion = {"mechanism": {"type": "rotary", "inertia_kgm2": 1}, "moves": [move | {"name": text}]}
    for cycle, place in (({"phases": [phase | {"name": text}]}, "phases/0"), ({"motion": motion}, "motion/moves/0")):
        answer = api.post("/api/v1/select", json={"duty_cycle": cycle})
        assert answer.status_code == 422
        assert answer.json()["errors"][0]["pointer"] == f"/duty_cycle/{place}/name"


@pytest.mark.parametrize("text", SPELT)
def test_spelling_stays_in_the_name_of_a_phase(api: TestClient, text: str) -> None:
    page = api.get("/?" + urlencode([*CYCLE, ("pn", text)]))
    assert f'value="{text}"' in page.text
    link = edit(api, [*CYCLE, ("pn", text)])
    assert parse_qsl(link.partition("?")[2])[-1] == ("pn", text)


@pytest.mark.parametrize("text", LOOK_ALIKE)
@pytest.mark.parametrize("name", ["title", "reference", "author", "revision"])
def test_rest_refuses_names_that_look_like_others(api: TestClient, name: str, text: str) -> None:
    answer = api.post("/api/v1/selections", json={"application": worked_example(), name: text})

    assert answer.status_code == 422
    (error,) = answer.json()["errors"]
    assert error["pointer"] == f"/{name}" and "U+" in error["detail"]
    if name in ("title", "reference"):
        place = api.post("/api/v1/selections", json={"application": worked_example()}).headers["Location"]
        assert api.patch(place, json={name: text}).json()["errors"] == [error]


@pytest.mark.parametrize("text", LOOK_ALIKE)
def test_forms_refuse_names_that_look_like_others(api: TestClient, text: str) -> None:
    link = {"link": "/?T=40&n=250&t=0.3"}
    refused = api.post("/selections", data={**link, "title": text}, follow_redirects=False)
    assert refused.status_code == 422 and "U+" in refused.text
    saved = api.post("/selections", data={**link, "title": "Axis 7"}, follow_redirects=False)

    renamed = api.post(f"{saved.headers['Location']}/rename", data={"title": "Axis 7", "ref": text})

    assert renamed.status_code == 422
    assert re.search(r'class="reason">Reference: [^<]*U\+', renamed.text)


@pytest.mark.parametrize("text", LOOK_ALIKE)
def test_a_selection_saved_before_opens_is_found_and_may_be_renamed(api: TestClient, text: str) -> None:
    old = {"title": text, "reference": text}
    saved = api.post("/selections", data={"link": "/?T=40&n=250&t=0.3"}, follow_redirects=False)
    place = saved.headers["Location"]
    assert api.portal is not None
    api.portal.call(state_of(api).store.rename, place.rpartition("/")[2], old)

    assert api.get(place).status_code == api.get("/selections").status_code == 200
    response = api.get(f"/api/v1{place}")
    assert (response.status_code, response.json()["title"]) == (200, text)
    assert len(api.get("/api/v1/selections", params={"reference": text}).json()["selections"]) == 1
    # A form sends both fields: an invalid but unchanged one does not block the other.
    assert api.post(f"{place}/rename", data={"title": "new", "ref": text}, follow_redirects=False).status_code == 303
    assert api.patch(f"/api/v1{place}", json={"reference": "new"}).status_code == 200
    assert api.delete(f"/api/v1{place}").status_code == 204


@pytest.mark.parametrize("path", ["/catalogue", "/catalogue/HPN-20A-5", "/selections", "/paste"])
def test_the_links_of_every_page_lead_back_to_the_whole_selection(api: TestClient, path: str) -> None:
    query = urlencode([*GIVEN, ("i", "5"), ("gear", "HPN-32A-5"), ("pin", "HPN-20A-4")])
    page = api.get(f"{path}?{query}").text

    for name, place in (("Selection", "/"), ("Catalogue", "/catalogue"), ("Saved", "/selections")):
        current = ' aria-current="page"' if path.startswith(place.rstrip("/") or "-") else ""
        assert f'<a href="{place}?{html.escape(query)}"{current}>{name}</a>' in page


def test_the_catalogue_shows_all_gears_whatever_the_selection_asks_for_and_filters_beside_it(
    api: TestClient, catalogue: Catalogue
) -> None:
    query = urlencode([*GIVEN, ("i", "5"), ("size", "20A")])
    whole = api.get(f"/catalogue?{query}").text
    filtered = re.search(r'href="([^"]*only_size=14A)"', whole)

    assert filtered
    assert len(re.findall('<th scope="row"><a href="/catalogue/HPN', whole)) == len(catalogue.gears)
    part = api.get(html.unescape(filtered[1])).text
    gears = re.findall(r'<th scope="row"><a href="([^"]*)">(HPN-14A-[0-9]+)<', part)
    assert len(re.findall('<th scope="row"><a href="/catalogue/HPN', part)) == len(gears) > 0
    assert {labels_in(html.unescape(link)) == WRITTEN | ORDERED for link, _ in gears} == {True}


def test_an_ordering_code_put_together_on_the_page_of_a_gear_goes_into_the_selection(api: TestClient) -> None:
    page = api.get("/catalogue/HPN-20A-5?" + urlencode([*CYCLE, ("output", "J8"), ("motor", "BH-AF2")])).text
    use = re.search(r'href="([^"]*)">Use in selection', page)

    assert use and labels_in(html.unescape(use[1])) == {"order_output": "J8", "order_motor": "BH-AF2"}

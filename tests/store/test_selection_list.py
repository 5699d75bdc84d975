"""The table of saved selections in the browser, at the address that lists them."""

import base64
import html
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.door.keys import new_key
from hpn.web.settings import Settings
from tests.build import Json, cycle, phase, worked_example

LINES = 2
HEAVY = cycle(phase(9000, 100))


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A client of a service that runs for all tests of this file."""
    folder = tmp_path_factory.mktemp("list")
    with TestClient(create_app(Settings(database_url=f"sqlite:///{folder}/store.sqlite3"))) as client:
        yield client


@pytest.fixture
def client(service: TestClient, monkeypatch: pytest.MonkeyPatch) -> TestClient:
    """The same with nothing saved, and few lines on a page."""
    for selection in service.get("/api/v1/selections?limit=200").json()["selections"]:
        service.delete(f"/api/v1{selection['url']}")
    monkeypatch.setattr("hpn.web.pages.saved_list.LINES_ON_PAGE", LINES)
    return service


def saved(client: TestClient, application: Json | None = None, **labels: str) -> str:
    """Address of the page of a selection that is now saved."""
    response = client.post("/api/v1/selections", json={"application": application or worked_example(), **labels})
    assert response.status_code == 201, response.text
    return str(response.json()["url"])


def rows(page: str) -> list[list[str]]:
    """Texts of the cells of the table, row by row."""
    body = re.search("<tbody>(.*?)</tbody>", page, re.S)
    matches = re.findall("<tr.*?</tr>", body[1], re.S) if body else []
    cells = [re.findall(r"<t[hd].*?</t[hd]>", row, re.S) for row in matches]
    return [[_text(cell) for cell in row if _says(cell)] for row in cells]


def _text(cell: str) -> str:
    return " ".join(html.unescape(re.sub("<[^>]*>", "", cell)).split())


def _says(cell: str) -> bool:
    """True for a cell of data; False for one of buttons."""
    return 'class="pick"' not in cell and 'class="changes"' not in cell


def test_a_line_says_what_was_saved_and_leads_to_its_page(client: TestClient) -> None:
    address = saved(client, title="Axis <7>", reference="4711", author="M. Muster")
    reply = client.get(f"/api/v1{address}").json()

    page = client.get("/selections")

    best = next(entry for entry in reply["result"]["candidates"] if entry["rank"] == 1)
    share, when = f"{100 * best['utilisation']:.0f} %", reply["created"][:16].replace("T", " ")
    assert page.status_code == 200
    [[name, _, gear, _, use, record]] = rows(page.text)
    assert (name, gear, use, record) == ("Axis <7> 4711", reply["selected"], f"{share} ✓suitable", f"{when} M. Muster")
    assert f'<a href="{address}">Axis &lt;7&gt;</a>' in page.text


def test_without_a_suitable_gear_the_nearest_stands_there_as_its_page_shows_it(client: TestClient) -> None:
    address = saved(client, HEAVY, reference="4712")

    [[title, _, gear, _, use, _]] = rows(client.get("/selections").text)

    share, _, verdict = use.partition(" % ")
    assert (title, verdict) == ("4712", "✕not suitable")
    assert float(share.replace(" ", "")) > 100
    assert re.search(f'id="verdict"[^>]*>.*?{gear}</a>', client.get(address).text)


def test_the_list_unpacks_and_computes_nothing(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    saved(client)
    before = rows(client.get("/selections").text)
    for name in ("hpn.engine.selection.evaluate", "hpn.store.store.unpacked"):
        monkeypatch.setattr(name, None)

    assert rows(client.get("/selections").text) == before


def test_parts_follow_each_other_newest_first(client: TestClient) -> None:
    count = LINES + 2
    for k in range(count):
        saved(client, title=f"t{k}", reference="4711" if k % 2 else "other")

    first = client.get("/selections").text
    older = re.search('<a href="([^"]*)" rel="next">', first)
    assert older
    second = client.get(html.unescape(older[1])).text

    titles = [row[0] for page in (first, second) for row in rows(page)]
    assert titles == [f"t{k} {'4711' if k % 2 else 'other'}" for k in reversed(range(count))]
    assert 'rel="next"' not in second
    assert 'href="/selections">Newest' in second
    assert "Newest" not in first


def test_a_reference_filters_as_it_does_over_rest_where_an_empty_field_is_none(client: TestClient) -> None:
    for reference in ("4711", "47 & 11"):
        saved(client, reference=reference)

    for reference in ("4711", " 4711 ", "47 & 11", "471", ""):
        question = {"reference": reference} if reference else {}
        listed = client.get("/api/v1/selections", params=question).json()["selections"]
        page = client.get("/selections", params={"reference": reference}).text
        assert [row[0] for row in rows(page)] == [selection["reference"] for selection in listed]
        assert f'value="{html.escape(reference)}"' in page


def test_the_next_part_keeps_the_reference(client: TestClient) -> None:
    for _ in range(LINES + 1):
        saved(client, reference="47 & 11")
    saved(client, reference="other")

    page = client.get("/selections", params={"reference": "47 & 11"}).text
    older = re.search('<a href="([^"]*)" rel="next">', page)

    assert older
    assert len(rows(client.get(html.unescape(older[1])).text)) == 1


@pytest.mark.parametrize(
    ("query", "text"),
    [
        ("", "Nothing is saved yet."),
        ("?reference=4711", "No saved selection has the reference “4711”."),
    ],
)
def test_an_empty_list_says_so(client: TestClient, query: str, text: str) -> None:
    page = client.get(f"/selections{query}")

    assert page.status_code == 200
    assert text in page.text
    assert "<table" not in page.text


@pytest.mark.parametrize(
    ("query", "text"),
    [
        ("?cursor=x", "This part of the list can’t be found"),
        ("?cursor=" + base64.urlsafe_b64encode(b"9999-99-99 x").decode(), "This part of the list can’t be found"),
        ("?reference=a%07b", 'id="e-reference">must not contain control characters'),
        ("?reference=" + "a" * 201, 'id="e-reference">'),
    ],
)
def test_a_parameter_that_no_list_has_is_refused_on_the_page(client: TestClient, query: str, text: str) -> None:
    page = client.get(f"/selections{query}")

    assert page.status_code == 422
    assert text in page.text


@pytest.mark.parametrize("empty", ["", "%20"])
def test_the_api_refuses_an_empty_reference_instead_of_listing_everything(client: TestClient, empty: str) -> None:
    saved(client, reference="4711")

    reply = client.get(f"/api/v1/selections?reference={empty}")

    assert reply.status_code == 422
    assert [error["pointer"] for error in reply.json()["errors"]] == ["/reference"]
    assert "must not be empty" in reply.json()["detail"]


def test_the_api_answers_json_to_a_browser_too(client: TestClient) -> None:
    response = client.get("/api/v1/selections", headers={"Accept": "text/html,*/*;q=0.8"})

    assert response.headers["content-type"] == "application/json"


def test_a_guarded_list_asks_the_browser_for_the_key(tmp_path: Path) -> None:
    key, pair = new_key("plm")
    settings = Settings(database_url=f"sqlite:///{tmp_path}/store.sqlite3", api_keys=pair)
    with TestClient(create_app(settings)) as client:
        refused, view = client.get("/selections"), client.get("/selections", auth=("anybody", key))

    assert (refused.status_code, refused.headers["www-authenticate"]) == (401, 'Basic realm="HPN Select"')
    assert view.status_code == 200
    assert "private" in view.headers["cache-control"]


@pytest.mark.parametrize("path", ["/", "/catalogue", "/catalogue/HPN-20A-5", "/selections", "/paste", "/nowhere"])
def test_every_page_leads_to_the_list(client: TestClient, path: str) -> None:
    page = client.get(path, headers={"Accept": "text/html"}).text

    assert re.search(r'<a href="/selections(\?T=[^"]*)?"( aria-current="page")?>Saved</a>', page)


def test_a_list_out_of_reach_says_so_in_words(tmp_path: Path) -> None:
    settings = Settings(database_url="postgresql://nobody@127.0.0.1:9/none", database_seconds=2)
    with TestClient(create_app(settings)) as client:
        response = client.get("/selections")

    assert response.status_code == 503
    assert "Saved selections are temporarily unavailable." in response.text
    assert response.headers["retry-after"]


# --- Searching, renaming and deleting, without script -----------------------------------------------------------------


def test_a_search_keeps_its_words_and_its_parts(client: TestClient) -> None:
    for title in ("drive 1", "other", "drive 2", "drive 3"):
        saved(client, title=title)

    page = client.get("/selections", params={"search": "drive HPN-20A"}).text
    older = re.search('<a href="([^"]*)" rel="next">', page)

    assert older
    assert 'value="drive HPN-20A"' in page
    assert [row[0] for row in rows(page)] == ["drive 3", "drive 2"]
    assert [row[0] for row in rows(client.get(html.unescape(older[1])).text)] == ["drive 1"]
    assert "No saved selection has “x y”" in client.get("/selections?search=x+y").text


def form(page: str, action: str) -> dict[str, str]:
    """Fields of the form with this action, as they stand there."""
    match = re.search(rf'<form[^>]*action="{re.escape(action)}".*?</form>', page, re.S)
    assert match, action
    fields = re.findall(r'name="(\w+)"[^>]*value="([^"]*)"', match[0])
    return {name: html.unescape(value) for name, value in fields}


def test_a_selection_is_renamed_in_the_list_and_stays_in_view(client: TestClient) -> None:
    address, here = saved(client, title="old", reference="4711"), "/selections?search=4711"
    fields = form(client.get(here).text, f"{address}/rename")

    answer = client.post(f"{address}/rename", data=fields | {"title": "new"}, follow_redirects=False)

    assert (answer.status_code, answer.headers["location"]) == (303, here)
    assert [row[0] for row in rows(client.get(here).text)] == ["new 4711"]


def test_a_selection_is_deleted_once_somebody_has_said_so_twice(client: TestClient) -> None:
    address, here = saved(client, title="Axis <7>"), "/selections?search=axis"
    fields = form(client.get(here).text, f"{address}/delete")

    question = client.get(f"{address}/delete", params=fields).text
    assert "Delete this selection?" in question and "Axis &lt;7&gt;" in question
    assert client.get(address).status_code == 200
    answer = client.post(f"{address}/delete", data=form(question, f"{address}/delete"), follow_redirects=False)

    assert (answer.status_code, answer.headers["location"]) == (303, here)
    gone = [client.get(address), client.get(f"{address}/delete")]
    gone += [client.post(f"{address}/{change}", data={"title": "x"}) for change in ("delete", "rename")]
    assert [answer.status_code for answer in gone] == [404] * 4


@pytest.mark.parametrize("change", ["rename", "delete"])
def test_no_other_site_changes_anything_and_no_change_leads_to_one(client: TestClient, change: str) -> None:
    address = saved(client, title="t")

    foreign = client.post(f"{address}/{change}", headers={"Sec-Fetch-Site": "cross-site"})
    assert foreign.status_code == 403
    assert client.get(f"/api/v1{address}").json()["title"] == "t"

    for back in ("https://elsewhere.example/", "//elsewhere.example", "/selections.elsewhere", "/selections?a\nb"):
        other = saved(client, title="t")
        answer = client.post(f"{other}/{change}", data={"back": back}, follow_redirects=False)
        assert (answer.status_code, answer.headers["location"]) == (303, "/selections")


def test_a_name_that_cannot_be_is_refused_in_words(client: TestClient) -> None:
    address = saved(client, title="t")

    answer = client.post(f"{address}/rename", data={"title": "x" * 201, "ref": "a\nb"})

    assert answer.status_code == 422
    assert "must have at most 200 characters" in answer.text and "must not contain control characters" in answer.text
    assert client.get(f"/api/v1{address}").json()["title"] == "t"


def test_where_there_are_keys_the_page_asks_for_the_owners(tmp_path: Path) -> None:
    keys = {name: new_key(name) for name in ("plm", "erp")}
    settings = Settings(
        database_url=f"sqlite:///{tmp_path}/store.sqlite3",
        api_keys=",".join(pair for _, pair in keys.values()),
        guarded="writing",
    )
    with TestClient(create_app(settings)) as client:
        body, header = {"application": worked_example()}, {"X-API-Key": keys["plm"][0]}
        address = client.post("/api/v1/selections", json=body, headers=header).json()["url"]
        assert client.patch(f"/api/v1{address}", json={"title": "x"}).status_code == 403
        owner, other = (("anybody", keys[name][0]) for name in ("plm", "erp"))
        for change in ("rename", "delete"):
            place, data = f"{address}/{change}", {"title": "x"}
            response = client.post(place, data=data)
            assert (response.status_code, response.headers["www-authenticate"]) == (401, 'Basic realm="HPN Select"')
            assert [client.post(place, data=data, auth=who).status_code for who in (other, owner)] == [403, 200]

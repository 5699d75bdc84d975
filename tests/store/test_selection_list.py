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
    found = re.findall("<tr.*?</tr>", body[1], re.S) if body else []
    return [
        [" ".join(html.unescape(re.sub("<[^>]*>", "", cell)).split()) for cell in re.findall(r"<t[hd].*?</t[hd]>", row)]
        for row in found
    ]


def test_a_line_says_what_was_saved_and_leads_to_its_page(client: TestClient) -> None:
    address = saved(client, title="Axis <7>", reference="4711")
    reply = client.get(f"/api/v1{address}").json()

    page = client.get("/selections")

    best = next(entry for entry in reply["result"]["candidates"] if entry["rank"] == 1)
    share, when = f"{100 * best['utilisation']:.0f} %", reply["created"][:16].replace("T", " ")
    assert page.status_code == 200
    assert rows(page.text) == [["Axis <7>", "4711", reply["selected"], "✓ suitable", share, when]]
    assert f'<a href="{address}">Axis &lt;7&gt;</a>' in page.text


def test_without_a_suitable_gear_the_nearest_stands_there_as_its_page_shows_it(client: TestClient) -> None:
    address = saved(client, HEAVY, reference="4712")

    [[title, _, gear, verdict, share, _]] = rows(client.get("/selections").text)

    assert (title, verdict) == ("4712", "✕ not suitable")
    assert float(share.rstrip(" %").replace(" ", "")) > 100
    assert f'id="verdict">{gear}' in client.get(address).text


def test_what_today_says_changes_no_line(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    saved(client)
    before = rows(client.get("/selections").text)
    monkeypatch.setattr("hpn.selection.evaluate", None)

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
    assert titles == [f"t{k}" for k in reversed(range(count))]
    assert 'rel="next"' not in second
    assert 'href="/selections">Newest' in second
    assert "Newest" not in first


def test_a_reference_filters_as_it_does_over_rest(client: TestClient) -> None:
    for reference in ("4711", "47 & 11"):
        saved(client, reference=reference)

    for reference in ("4711", " 4711 ", "47 & 11", "471", ""):
        listed = client.get("/api/v1/selections", params={"reference": reference}).json()["selections"]
        page = client.get("/selections", params={"reference": reference}).text
        assert [row[1] for row in rows(page)] == [selection["reference"] for selection in listed]
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
def test_what_no_list_has_is_refused_on_the_page(client: TestClient, query: str, text: str) -> None:
    page = client.get(f"/selections{query}")

    assert page.status_code == 422
    assert text in page.text


def test_a_selection_deleted_between_the_two_readings_is_left_out(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    for title in ("a", "b"):
        saved(client, title=title)
    store = client.app.state.store  # type: ignore[attr-defined]
    results = store.results

    async def later(ids: list[str]) -> dict[str, bytes]:
        await store.delete(ids[0])
        found: dict[str, bytes] = await results(ids)
        return found

    monkeypatch.setattr(store, "results", later)

    assert [row[0] for row in rows(client.get("/selections").text)] == ["a"]


def test_the_api_answers_json_to_a_browser_too(client: TestClient) -> None:
    response = client.get("/api/v1/selections", headers={"Accept": "text/html,*/*;q=0.8"})

    assert response.headers["content-type"] == "application/json"


def test_a_guarded_list_asks_the_browser_for_the_key(tmp_path: Path) -> None:
    key, pair = new_key("plm")
    settings = Settings(database_url=f"sqlite:///{tmp_path}/store.sqlite3", api_keys=pair)
    with TestClient(create_app(settings)) as client:
        refused, shown = client.get("/selections"), client.get("/selections", auth=("anybody", key))

    assert (refused.status_code, refused.headers["www-authenticate"]) == (401, 'Basic realm="HPN Select"')
    assert shown.status_code == 200
    assert "private" in shown.headers["cache-control"]


@pytest.mark.parametrize("path", ["/", "/catalogue", "/catalogue/HPN-20A-5", "/selections", "/paste", "/nowhere"])
def test_every_page_leads_to_the_list(client: TestClient, path: str) -> None:
    assert '<a href="/selections">Saved</a>' in client.get(path, headers={"Accept": "text/html"}).text


def test_a_list_out_of_reach_says_so_in_words(tmp_path: Path) -> None:
    settings = Settings(database_url="postgresql://nobody@127.0.0.1:9/none", database_seconds=2)
    with TestClient(create_app(settings)) as client:
        response = client.get("/selections")

    assert response.status_code == 503
    assert "Saved selections are out of reach for the moment." in response.text
    assert response.headers["retry-after"]

"""The page of machines: what it says of each is what the machine itself says, filtered and sorted by the database."""

import hashlib
import re
from functools import partial
from pathlib import Path
from urllib.parse import quote

import pytest
from starlette.testclient import TestClient

from hpn.store import LineFilter, MachineLine, SavedAxis, Sorting
from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.build import cycle, phase, worked_example
from tests.state import state_of
from tests.store.test_machines_api import AXES, read, save

PATCH = {"Content-Type": "application/merge-patch+json"}


def text_of(page: str) -> str:
    return " ".join(re.sub(r"<[^>]+>", " ", page).split())


def listed(client: TestClient, **wanted: Sorting | str) -> list[tuple[MachineLine, SavedAxis | None]]:
    """Lines with their governing axes."""
    assert client.portal is not None
    filter = LineFilter(**wanted)  # type: ignore[arg-type]
    record = client.portal.call(partial(state_of(client).store.machine_list, None, 50, filter, {}))
    return [(line, record.governing.get(line.id)) for line in record.lines]


def require_same(client: TestClient, place: str) -> None:
    """Assert that the line of a machine says what the machine says."""
    id = place.rpartition("/")[2]
    line, governing = next(each for each in listed(client) if each[0].id == id)
    order, axes = read(client, f"{place}/gears"), read(client, place)["axes"]
    assert line.gears == sum(gear["quantity"] for gear in order["gears"])
    assert line.kinds == len({gear["designation"] for gear in order["gears"]})
    # The database sums in another order than the list of gears.
    assert line.weight_kg == pytest.approx(order["weight_kg"], rel=1e-12)
    used = {axis["number"]: axis["answer"]["utilisation"] for axis in axes if axis["answer"]["status"] == "suitable"}
    assert line.utilisation == max(used.values(), default=None)
    assert (governing.number if governing else None) == max(used, key=lambda number: used[number], default=None)


def test_a_line_says_what_the_machine_says_whatever_is_changed(client: TestClient) -> None:
    place = save(client)
    require_same(client, place)
    gear = read(client, place)["axes"][1]["answer"]["selected"]
    for method, path, body in (
        ("PATCH", "/axes/1", {"ordering_code": gear, "quantity": 7}),
        ("PATCH", "/axes/2", {"quantity": 1_000_000}),
        ("PATCH", "", {"common": {"requirements": {"utilisation": 0.5}}}),
        ("DELETE", "/axes/2", None),
        ("POST", "/axes", {"axes": [{"number": 2}]}),
        ("DELETE", "/axes/1", None),
        ("DELETE", "/axes/2", None),
    ):
        headers = {"If-Match": client.get(place).headers["etag"]} if method == "POST" else {}
        reply = client.request(method, place + path, json=body, headers=headers | (PATCH if method == "PATCH" else {}))
        assert reply.is_success, (method, path, reply.text)
        require_same(client, place)


def test_of_axes_that_are_used_alike_the_first_governs(client: TestClient) -> None:
    require_same(client, save(client, axes=[AXES[1], AXES[0], AXES[1], AXES[0]]))


def test_an_open_axis_with_an_ordering_code_is_a_gear_to_order_of_which_no_answer_says_the_mass(
    client: TestClient,
) -> None:
    place = save(client, axes=AXES[:1])
    gear = read(client, place)["axes"][0]["answer"]["selected"]
    for own in ({}, worked_example(requirements={"sizes": ["65A"]})):  # incomplete, or of other gears
        body = {"axes": [{"quantity": 4, "ordering_code": gear, "application": own}]}
        headers = {"If-Match": client.get(place).headers["etag"]}
        assert client.post(f"{place}/axes", json=body, headers=headers).is_success
    assert [axis["answer"]["status"] for axis in read(client, place)["axes"]] == ["suitable", "open", "open"]

    ((line, _),) = listed(client)
    assert line.gears == sum(each["quantity"] for each in read(client, f"{place}/gears")["gears"]) == 10
    assert (line.kinds, line.weight_kg) == (None, None)
    row = client.get("/machines").text.partition('<td class="figure weight">')[2].partition("</td>")[0]
    assert "–" in row and "kg" not in row and "kind" not in row

    for number in (2, 3):
        assert client.delete(f"{place}/axes/{number}").is_success
    require_same(client, place)


def test_changes_are_counted_since_the_latest_revision(client: TestClient) -> None:
    place = save(client)

    def changes() -> tuple[int, bool]:
        page = text_of(client.get("/machines").text)
        (line, _), *_ = listed(client)
        match = re.search(r"\b(\d+) changes?\b", page)
        assert (int(match[1]) if match else 0) == line.changes
        return line.changes, "no revision yet" in page

    assert changes() == (0, True)
    assert client.post(f"{place}/revisions", json={"label": "A"}).status_code == 201
    assert changes() == (0, False)
    client.patch(f"{place}/axes/1", json={"quantity": 3}, headers=PATCH)
    client.patch(f"{place}/axes/1", json={"quantity": 4}, headers=PATCH)
    assert changes() == (1, False)
    client.delete(f"{place}/axes/2")
    assert changes() == (2, False)
    client.patch(place, json={"title": "Other"}, headers=PATCH)
    client.patch(place, json={"common": {"requirements": {"utilisation": 0.8}}}, headers=PATCH)
    assert changes() == (3, False)
    assert client.post(f"{place}/revisions", json={"label": "B"}).status_code == 201
    assert changes() == (0, False)
    version = read(client, place)
    renamed = client.post(f"{version['url']}/rename", data={"title": "Third", "ref": ""})
    assert renamed.status_code in (200, 303)
    assert changes() == (1, False)


def test_a_machine_with_changes_in_no_revision_is_to_do(client: TestClient) -> None:
    place = save(client, axes=AXES[:1])
    url = read(client, place)["url"]
    client.post(f"{place}/revisions", json={"label": "A"})
    assert f'href="{url}"' not in client.get("/machines?show=todo").text
    client.patch(f"{place}/axes/1", json={"quantity": 3}, headers=PATCH)
    page = client.get("/machines?show=todo").text
    assert f'href="{url}"' in page and "To do 1" in text_of(page)


def test_machines_are_found_by_their_axes_and_gears(client: TestClient) -> None:
    save(client, title="one", axes=[{"name": "Rüttler 5_%", "application": cycle(phase(4, 300))}])
    save(client, title="other", axes=[{"name": "Wurf/Arm", "application": cycle(phase(60, 100))}])
    gears = {line.title: axis.answer["designation"] for line, axis in listed(client) if axis}
    for word, titles in {
        "rüttler": ["one"],
        "5_%": ["one"],
        "_": ["one"],
        "f/a": ["other"],
        "WURF other": ["other"],
        "wurf one": [],
        gears["one"].lower(): ["one"],
        gears["other"]: ["other"],
    }.items():
        assert [line.title for line, _ in listed(client, search=word)] == titles, word
        page = client.get(f"/machines?search={quote(word)}").text
        assert re.findall(r'<a href="/machines/[^"]+">(\w+)</a>', page) == titles


def test_columns_sort_the_list_and_sorting_stays_with_the_search(client: TestClient) -> None:
    for title, torque in (("b", 60), ("a", 4), ("c", 20)):
        save(client, title=title, axes=[{"application": cycle(phase(torque, 100))}])
    for sort, titles in {"weight": "acb", "-weight": "bca", "title": "abc", "-title": "cba", "": "cab"}.items():
        page = client.get(f"/machines?sort={sort or '-updated'}").text
        assert "".join(re.findall(r'<a href="/machines/[^"]+">(\w)</a>', page)) == titles
    page = client.get("/machines?search=4711&sort=-weight").text
    assert 'aria-sort="descending"' in page and "search=4711&amp;sort=weight" in page
    assert client.get("/machines?sort=nothing").status_code == 422


def test_a_machine_is_begun_without_axes(client: TestClient) -> None:
    begun = client.post("/machines", files={"new": (None, "machine")}, follow_redirects=False)
    assert begun.status_code == 303 and begun.headers["location"].endswith("?edit=common")
    page = client.get(begun.headers["location"]).text
    assert 'id="every-axis"' in page and "This machine has no axes yet." in page


def test_the_machines_of_a_key_are_its_own(tmp_path: Path) -> None:
    pairs = [f"{name}:{hashlib.sha256(name.encode()).hexdigest()}" for name in ("anna", "bert")]
    settings = Settings.model_validate({"database_url": f"sqlite:///{tmp_path / 'db'}", "api_keys": " ".join(pairs)})
    with TestClient(create_app(settings)) as client:
        for name in ("anna", "bert"):
            save(client, {"X-API-Key": name}, title=name, axes=[])
        page = client.get("/machines?show=mine", headers={"X-API-Key": "anna"}).text
        assert re.findall(r'<a href="/machines/[^"]+">(\w+)</a>', page) == ["anna"]
        assert "Mine 1" in text_of(page) and "All 2" in text_of(page)

"""Revisions of machines and selections over REST, and what has changed since."""

import re
from html import unescape
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.build import worked_example
from tests.conftest import Supplement
from tests.state import state_of
from tests.store.drafts import WEAKER
from tests.store.test_machines_api import ADDRESS, AXES, COMMON, read, save

# --- Revisions --------------------------------------------------------------------------------------------------------


def test_a_revision_stays_as_it_is_when_everything_changes(client: TestClient) -> None:
    place = save(client)
    frozen = client.post(f"{place}/revisions", json={"label": "A", "author": "MA", "checked": "KR", "note": "first"})
    assert frozen.status_code == 201 and frozen.headers["location"] == f"{place}/revisions/A"
    kept = read(client, f"{place}/revisions/A")

    client.patch(place, json={"common": {"requirements": {"utilisation": 0.3}}, "title": "other"})
    client.patch(f"{place}/axes/1", json={"application": {"requirements": None}})
    client.delete(f"{place}/axes/2")

    assert read(client, f"{place}/revisions/a") == kept  # in any case
    assert kept["title"] == "Packing line" and kept["common"] == COMMON
    assert [axis["application"] for axis in kept["axes"]] == [axis["application"] for axis in AXES]
    assert kept["axes"][0]["resolved"]["requirements"] == {"utilisation": 0.8, "life_h": 20000}
    client.post(f"{place}/revisions", json={"label": "b"})
    listed = read(client, f"{place}/revisions")["revisions"]
    assert [(line["label"], line["number"], line["axis_count"]) for line in listed] == [("b", 2, 2), ("A", 1, 3)]
    assert (listed[1]["checked"], listed[1]["note"]) == ("KR", "first")
    assert read(client, place)["revision"] == "b"


@pytest.mark.parametrize(
    ("label", "status"), [("A", 409), ("a", 409), ("now", 422), ("Today", 422), ("saved", 422), ("x y", 422)]
)
def test_a_label_is_unique_without_case_and_some_are_reserved(client: TestClient, label: str, status: int) -> None:
    place = save(client)
    client.post(f"{place}/revisions", json={"label": "A"})
    assert client.post(f"{place}/revisions", json={"label": label}).status_code == status
    assert client.get(f"{place}/revisions/nothing").status_code == 404


def test_a_retry_of_freezing_with_its_key_gives_the_same_revision(client: TestClient) -> None:
    place, key = save(client), {"Idempotency-Key": "freeze"}
    first, again = (client.post(f"{place}/revisions", json={"label": "A"}, headers=key) for _ in range(2))
    assert (first.status_code, again.status_code) == (201, 201) and first.json() == again.json()
    assert "idempotency-replayed" not in first.headers and again.headers["idempotency-replayed"] == "true"


def test_a_saved_selection_has_its_first_revision(client: TestClient) -> None:
    for given, label, note in (("B", "B", None), ("rev. 3", "saved", "rev. 3"), (None, "saved", None)):
        body = {"application": worked_example(), "revision": given}
        id = client.post("/api/v1/selections", json=body).json()["id"]
        (line,) = read(client, f"{ADDRESS}/{id}/revisions")["revisions"]
        assert (line["label"], line["note"]) == (label, note)
        frozen = read(client, f"{ADDRESS}/{id}/revisions/{label}")
        assert frozen["axes"][0]["resolved"] == read(client, f"/api/v1/selections/{id}")["application"]


def test_two_states_are_compared_by_axis(client: TestClient) -> None:
    place = save(client)
    client.post(f"{place}/revisions", json={"label": "A"})
    client.patch(place, json={"title": "new", "common": {"requirements": {"utilisation": 0.2}}})
    client.delete(f"{place}/axes/3")
    client.post(f"{place}/axes", json={"axes": [AXES[1]]})
    client.post(f"{place}/revisions", json={"label": "B"})

    found = read(client, f"{place}/differences?from=a&to=B")

    assert [(each["pointer"], each["from"], each["to"]) for each in found["common"]] == [
        ("/title", "Packing line", "new"),
        ("/common/requirements/utilisation", 0.9, 0.2),
    ]
    by_number = {axis["number"]: axis for axis in found["axes"]}
    assert {number: axis["change"] for number, axis in by_number.items()} == {2: "changed", 3: "removed", 4: "added"}
    assert found["same"] == 1  # the first has its own value
    assert by_number[2]["inputs"] == []  # what both inherit stands among the common values
    assert by_number[2]["figures"] or by_number[2]["verdicts"]
    assert (found["from"]["axes"], found["to"]["axes"]) == (3, 3)
    assert found["from"]["weight_kg"] is not None
    assert read(client, f"{place}/differences?from=B&to=now")["axes"] == []
    assert read(client, f"{place}/differences?from=A&to=today")["axes"] == []  # the same engine and catalogue
    back = read(client, f"{place}/differences?from=B&to=A")
    assert {axis["number"]: axis["change"] for axis in back["axes"]} == {2: "changed", 3: "added", 4: "removed"}
    for query, status in (("from=A&to=C", 404), ("from=today&to=today", 422), ("from=A", 422)):
        assert client.get(f"{place}/differences?{query}").status_code == status


def test_another_catalogue_says_which_axes_get_another_gear(
    client: TestClient, ready_database: str, tmp_path: Path
) -> None:
    place = save(client, axes=[{"application": worked_example(requirements={"ratios": [5]})}, AXES[1]])
    client.post(f"{place}/revisions", json={"label": "A"})
    (tmp_path / "ratings.csv").write_text(WEAKER)
    with TestClient(create_app(Settings(database_url=ready_database, catalogue_supplement=tmp_path))) as later:
        found = read(later, f"{place}/differences?from=A&to=today")
        assert [axis["number"] for axis in found["axes"] if axis["verdicts"]] == [1]
        selected = next(cell for cell in found["axes"][0]["verdicts"] if cell["field"] == "selected")
        assert (selected["from"], selected["to"]) == ("HPN-20A-5", "HPN-32A-5")
        assert read(later, f"{place}/revisions/A")["axes"][0]["answer"]["selected"] == "HPN-20A-5"


def test_an_axis_added_to_a_selection_makes_a_new_machine_that_begins_with_it(client: TestClient) -> None:
    body = {"application": worked_example(), "title": "Rotary table"}
    selection = client.post("/api/v1/selections", json=body).json()["id"]
    before = read(client, f"/api/v1/selections/{selection}")

    added = client.post(f"{ADDRESS}/{selection}/axes", json={"axes": [AXES[1]]})

    assert added.status_code == 201 and added.json()["numbers"] == [2]
    machine = read(client, added.headers["location"])
    assert (machine["kind"], machine["title"], machine["order"]) == ("machine", "Rotary table", [1, 2])
    assert machine["axes"][0]["application"] == before["application"]
    assert read(client, f"/api/v1/selections/{selection}") == before
    assert client.delete(f"{ADDRESS}/{selection}/axes/1").status_code == 409
    assert read(client, f"{ADDRESS}/{selection}")["counts"]["axes"] == 1


def test_a_selection_s_working_copy_changes_and_the_selection_stays(client: TestClient) -> None:
    id = client.post("/api/v1/selections", json={"application": worked_example(), "title": "one"}).json()["id"]
    before = read(client, f"/api/v1/selections/{id}")

    changed = client.patch(f"{ADDRESS}/{id}/axes/1", json={"application": {"requirements": {"utilisation": 0.1}}})

    assert changed.json()["answer"]["selected"] != before["selected"]
    assert read(client, f"/api/v1/selections/{id}") == before


def test_what_today_says_of_a_machine_is_saved_as_the_next_revision(
    client: TestClient, supplemented: Supplement
) -> None:
    place = save(client, axes=[{"name": "Turret", "application": worked_example(requirements={"ratios": [5]})}])
    url = read(client, place)["url"]
    for label in "AB":
        assert client.post(f"{place}/revisions", json={"label": label}).status_code == 201
    before = read(client, f"{place}/revisions/B")["axes"]
    assert "Save today’s as" not in client.get(f"{url}/revisions").text
    state_of(client).catalogue = supplemented(ratings=WEAKER)

    page = client.get(f"{url}/revisions").text
    form = re.search(r'<form class="save-today".*?</form>', page, re.DOTALL)
    assert form is not None and "Save today’s as C" in form[0]
    fields = {name: unescape(text) for name, text in re.findall(r'name="(\w+)"\s+value="([^"]*)"', form[0])}
    saved = client.post(f"{url}/revisions", data=fields, follow_redirects=False)

    assert saved.status_code == 303, saved.text
    listed = read(client, f"{place}/revisions")["revisions"]
    assert [line["label"] for line in listed] == ["C", "B", "A"] and "engine" in listed[0]["note"]
    (then,), (now,) = before, read(client, f"{place}/revisions/C")["axes"]
    assert now["application"] == then["application"] and now["answer"]["selected"] != then["answer"]["selected"]
    assert now["answer"]["catalogue_version"] == state_of(client).catalogue.version
    assert read(client, f"{place}/revisions/B")["axes"] == before
    assert read(client, f"{place}/differences?from=C&to=today")["axes"] == []
    assert client.post(f"{url}/revisions", data=fields, follow_redirects=False).status_code in (409, 412)

"""Machines over REST, with the store on each kind of database: a test for each sentence of the contract."""

from typing import Any

import pytest
from starlette.testclient import TestClient

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.selection import select
from hpn.store import Limits
from hpn.web import machines as web_machines
from tests.build import Json, cycle, phase, worked_example

ADDRESS = "/api/v1/machines"
COMMON: Json = {"requirements": {"utilisation": 0.9, "life_h": 20000}, "rank_by": "weight"}
AXES: list[Json] = [
    {"name": "Y bridge", "quantity": 2, "application": worked_example(requirements={"utilisation": 0.8})},
    {"name": "gripper", "application": cycle(phase(4, 300))},
    {"name": "not ready", "application": {}},
]
MACHINE: Json = {
    "title": "Packing line",
    "reference": "4711",
    "author": "MA",
    "note": None,
    "common": COMMON,
    "axes": AXES,
}


def save(client: TestClient, /, headers: dict[str, str] | None = None, **parts: Any) -> str:
    """Address of a new machine."""
    answer = client.post(ADDRESS, json=MACHINE | parts, headers=headers)
    assert answer.status_code == 201, answer.text
    return str(answer.headers["location"])


def read(client: TestClient, place: str) -> Json:
    answer = client.get(place)
    assert answer.status_code == 200, answer.text
    found: Json = answer.json()
    return found


# --- Saving and reading -----------------------------------------------------------------------------------------------


def test_a_machine_is_saved_and_read(client: TestClient, catalogue: Catalogue) -> None:
    answer = client.post(ADDRESS, json=MACHINE)

    assert answer.status_code == 201
    found = read(client, answer.headers["location"])
    assert answer.json() == {"id": found["id"], "url": f"/machines/{found['id']}"}
    assert (found["title"], found["reference"], found["author"], found["note"]) == ("Packing line", "4711", "MA", None)
    assert found["common"] == COMMON and found["order"] == [1, 2, 3]
    assert found["counts"] == {"axes": 3, "suitable": 2, "unsuitable": 0, "open": 1}
    assert [axis["application"] for axis in found["axes"]] == [axis["application"] for axis in AXES]
    first = found["axes"][0]
    assert first["resolved"]["requirements"] == {"utilisation": 0.8, "life_h": 20000}
    best = select(Application.model_validate(first["resolved"]), catalogue).candidates[0]
    assert (first["answer"]["selected"], first["answer"]["status"]) == (best.designation, "suitable")
    assert first["answer"]["utilisation"] == pytest.approx(best.utilisation, rel=1e-12)  # alone, and among others
    assert client.get(found["url"]).status_code == 200


def test_an_axis_that_cannot_be_calculated_is_kept_open_with_its_problem(client: TestClient) -> None:
    axes = [{"application": worked_example(unknown=1)}, {}, {"application": {"requirements": {"life_h": 10**30}}}]
    found = read(client, save(client, axes=axes))
    for axis in found["axes"]:
        assert axis["answer"]["status"] == "open" and axis["answer"]["problem"]["status"] == 422
    assert found["axes"][0]["answer"]["problem"]["errors"][0]["pointer"] == "/unknown"
    assert found["axes"][2]["application"]["requirements"]["life_h"] == 10**30


def test_what_is_read_is_saved_again(client: TestClient) -> None:
    first = read(client, save(client))
    again = read(client, save(client, **first))

    changing = ("id", "url", "created", "updated", "saved")
    assert {k: v for k, v in again.items() if k not in (*changing, "axes")} == {
        k: v for k, v in first.items() if k not in (*changing, "axes")
    }
    for one, other in zip(first["axes"], again["axes"], strict=True):
        assert {k: v for k, v in one.items() if k != "updated"} == {k: v for k, v in other.items() if k != "updated"}


def test_some_fields_alone_are_read(client: TestClient) -> None:
    place = save(client)
    found = client.get(f"{place}?fields=title,axes.number,axes.answer").json()
    assert found.keys() == {"title", "axes"} and found["axes"][0].keys() == {"number", "answer"}
    whole = read(client, place)
    assert client.get(f"{place}?fields=axes, order").json() == {"axes": whole["axes"], "order": whole["order"]}
    assert client.get(f"{place}?fields=title,nothing").status_code == 422
    changed = client.patch(f"{place}?fields=common,counts", json={"common": {"rank_by": "life"}})
    assert changed.json() == {"common": COMMON | {"rank_by": "life"}, "counts": whole["counts"]}
    assert client.patch(f"{place}?fields=nothing", json={"title": "other"}).status_code == 422
    assert read(client, place)["title"] == whole["title"]


@pytest.mark.parametrize(
    ("wrong", "pointer"),
    [
        ({"common": {"requirements": {"motor": {}}}}, "/common/requirements/motor"),
        ({"common": {"output_load": {"radial_N": 5}}}, "/common/output_load/radial_N"),
        ({"common": {"duty_cycle": {}}}, "/common/duty_cycle"),
        ({"axes": [{"quantity": 0}]}, "/axes/0/quantity"),
        ({"axes": [{"name": "x" * 41}]}, "/axes/0/name"),
        ({"axes": [{"without": ["duty_cycle"]}]}, "/axes/0/without/0"),
        ({"axes": [{"application": []}]}, "/axes/0/application"),
        ({"note": "x" * 2001}, "/note"),
        ({"nonsense": 1}, "/nonsense"),
        ({"axes": [{}] * 10_001}, "/axes"),
    ],
)
def test_a_machine_with_a_wrong_field_is_refused_there(client: TestClient, wrong: Json, pointer: str) -> None:
    answer = client.post(ADDRESS, json={**MACHINE, **wrong})
    assert answer.status_code == 422, answer.text
    assert pointer in [error["pointer"] for error in answer.json()["errors"]]


def test_the_same_key_saves_once_and_other_content_is_refused(client: TestClient) -> None:
    key = {"Idempotency-Key": "k"}
    first = client.post(ADDRESS, json=MACHINE, headers=key)
    again = client.post(ADDRESS, json=MACHINE, headers=key)
    other = client.post(ADDRESS, json=MACHINE | {"title": "x"}, headers=key)

    assert again.json() == first.json() and again.headers["idempotency-replayed"] == "true"
    assert other.status_code == 422 and other.json()["type"].endswith("idempotency-key-reused")
    client.delete(first.headers["location"])
    assert client.post(ADDRESS, json=MACHINE, headers=key).status_code == 410


# --- Lists ------------------------------------------------------------------------------------------------------------


def test_machines_and_selections_are_listed_apart_and_together(client: TestClient) -> None:
    machine = save(client).rpartition("/")[2]
    selection = client.post("/api/v1/selections", json={"application": worked_example(), "title": "one"}).json()["id"]

    def ids(query: str) -> list[str]:
        return [line["id"] for line in client.get(f"{ADDRESS}{query}").json()["machines"]]

    assert ids("") == [machine] and ids("?kind=selection") == [selection]
    assert ids("?kind=all") == [selection, machine]
    (alone,) = client.get("/api/v1/selections").json()["selections"]
    assert alone["id"] == selection
    listed = client.get(f"{ADDRESS}?kind=selection").json()["machines"]
    assert [line["utilisation"] for line in listed] == [alone["utilisation"]] != [None]
    assert read(client, f"{ADDRESS}/{selection}")["kind"] == "selection"
    assert client.get(f"/api/v1/selections/{machine}").status_code == 404


def test_a_list_is_searched_and_given_in_parts(client: TestClient) -> None:
    ids = [save(client, title=f"line {n}", reference=f"r{n % 2}").rpartition("/")[2] for n in range(5)]

    first = client.get(f"{ADDRESS}?limit=3")
    rest = client.get(first.headers["link"].partition(">")[0][1:])

    listed = [line["id"] for answer in (first, rest) for line in answer.json()["machines"]]
    assert listed == ids[::-1] and rest.json()["next_cursor"] is None
    found = {
        query: len(client.get(f"{ADDRESS}?{query}").json()["machines"])
        for query in ("search=LINE+3", "reference=r1", "author=MA", "author=x", "created_since=2000-01-01")
    }
    assert found == {
        "search=LINE+3": 1,
        "reference=r1": 2,
        "author=MA": 5,
        "author=x": 0,
        "created_since=2000-01-01": 5,
    }
    gear = read(client, f"{ADDRESS}/{ids[0]}")["axes"][0]["answer"]["selected"]
    assert len(client.get(f"{ADDRESS}?selected={gear}").json()["machines"]) == 5
    assert client.get(f"{ADDRESS}?updated_since=2999-01-01T00:00:00Z").json()["machines"] == []
    for wrong in ("limit=0", "limit=201", "cursor=x", "updated_since=yesterday", "kind=fleet", "nothing=1"):
        assert client.get(f"{ADDRESS}?{wrong}").status_code in (400, 422)


def test_deleted_ids_are_listed(client: TestClient) -> None:
    place = save(client)
    assert client.delete(place).status_code == 204
    assert client.get(place).status_code == 404
    listed = client.get(f"{ADDRESS}?deleted_since=2026-01-01").json()
    assert listed["deleted"] == [place.rpartition("/")[2]] and listed["machines"] == []
    assert client.get(f"{ADDRESS}?deleted_since=2999-01-01").json()["deleted"] == []


# --- Changing a machine -----------------------------------------------------------------------------------------------


def test_common_values_are_patched_and_every_axis_answered_anew(client: TestClient) -> None:
    place = save(client)
    before = read(client, place)
    patch = {"common": {"requirements": {"utilisation": 0.1, "life_h": None}}, "title": None}

    after = client.patch(place, json=patch).json()

    assert after["common"] == {"requirements": {"utilisation": 0.1}, "rank_by": "weight"}
    assert after["title"] is None and after["reference"] == "4711"
    own, inherited, _ = after["axes"]
    assert own["answer"]["selected"] == before["axes"][0]["answer"]["selected"]
    assert inherited["resolved"]["requirements"] == {"utilisation": 0.1}
    assert inherited["answer"] != before["axes"][1]["answer"]
    refused = client.patch(place, json={"common": {"requirements": {"utilisation": 7}}})
    assert refused.status_code == 422
    assert refused.json()["errors"][0]["pointer"] == "/common/requirements/utilisation"
    assert refused.json()["detail"].startswith("/common/requirements/utilisation: ")


def test_a_change_of_common_values_is_never_refused_for_an_axis(client: TestClient) -> None:
    place = save(client)
    after = client.patch(place, json={"common": {"requirements": {"ratios": [9999]}}}).json()
    assert after["counts"] == {"axes": 3, "suitable": 0, "unsuitable": 0, "open": 3}


def test_the_order_is_a_field_of_its_own(client: TestClient) -> None:
    place = save(client)
    after = client.patch(place, json={"order": [3, 1, 2]}).json()
    assert [axis["number"] for axis in after["axes"]] == after["order"] == [3, 1, 2]
    for wrong in ([1, 2], [1, 2, 3, 4], [1, 1, 2]):
        assert client.patch(place, json={"order": wrong}).status_code == 422


def test_of_two_who_change_one_state_the_second_learns_it(client: TestClient) -> None:
    place = save(client)
    seen = {"If-Match": client.get(place).headers["etag"]}
    assert client.patch(place, json={"title": "a"}, headers=seen).status_code == 200
    assert client.patch(place, json={"title": "b"}, headers=seen).status_code == 412
    assert client.delete(place, headers=seen).status_code == 412
    assert read(client, place)["title"] == "a"


# --- Gears ------------------------------------------------------------------------------------------------------------


def test_the_gear_list_counts_quantities_and_ordering_codes(client: TestClient) -> None:
    place = save(client)
    client.patch(f"{place}/axes/3", json={"ordering_code": "HPN-20A-5-J6", "application": worked_example()})

    found = read(client, f"{place}/gears")

    listed = {gear["ordering_code"]: (gear["quantity"], gear["axes"]) for gear in found["gears"]}
    axes = read(client, place)["axes"]
    assert listed["HPN-20A-5-J6"] == (1, [3])
    assert listed[axes[0]["answer"]["selected"]][0] >= 2
    assert found["weight_kg"] == pytest.approx(sum(gear["weight_kg"] for gear in found["gears"]), rel=1e-12)
    assert read(client, f"{place}/kinds")["least"] >= 1


# --- Bounds -----------------------------------------------------------------------------------------------------------


def test_bounds_hold_for_what_is_added(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(web_machines, "LIMITS", Limits(axes=4, phases=6, revisions=1))
    place = save(client)
    assert client.post(f"{place}/axes", json={"axes": [{}, {}]}).status_code == 422
    assert client.post(f"{place}/axes", json={"axes": [{"application": worked_example()}]}).status_code == 422
    assert client.post(f"{place}/axes", json={"axes": [{}]}).status_code == 201
    assert read(client, place)["counts"]["axes"] == 4


def test_a_machine_that_nobody_has_saved_takes_edits_and_no_revision(client: TestClient) -> None:
    table = b"axis,torque_Nm,speed_rpm,duration_s\nhub,[40],[250],[1]\n"
    page = client.post("/machines", files={"file": ("axes.csv", table)}, follow_redirects=False)
    place = f"/api/v1{page.headers['location']}"
    assert client.patch(f"{place}/axes/1", json={"quantity": 4}).json()["quantity"] == 4
    refused = client.post(f"{place}/revisions", json={"label": "A"})
    assert refused.status_code == 409 and "save it first" in refused.json()["detail"]
    assert client.get(ADDRESS).json()["machines"] == []

"""Revisions of saved selections over REST, with the store on each kind of database."""

import itertools
from typing import Any

import pytest
from starlette.testclient import TestClient

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.selection import select
from tests.build import Json, cycle, phase, worked_example

SELECTIONS, MACHINES = "/api/v1/selections", "/api/v1/machines"
HEAVIER = cycle(phase(200, 300))


def save(client: TestClient, **labels: Any) -> str:
    """Id of a saved selection of the worked example."""
    answer = client.post(SELECTIONS, json={"application": worked_example(), "title": "Table", **labels})
    assert answer.status_code == 201, answer.text
    return str(answer.json()["id"])


def read(client: TestClient, place: str) -> Json:
    answer = client.get(place)
    assert answer.status_code == 200, answer.text
    found: Json = answer.json()
    return found


def test_an_application_is_frozen_with_its_whole_reply_as_the_next_revision(
    client: TestClient, catalogue: Catalogue
) -> None:
    id = save(client, revision="A")
    before = read(client, f"{SELECTIONS}/{id}")
    body = {"application": HEAVIER, "label": "B", "author": "MA", "checked": "KR", "note": "heavier"}
    frozen = client.post(f"{SELECTIONS}/{id}/revisions", json=body)

    assert frozen.status_code == 201, frozen.text
    assert frozen.headers["location"] == f"{SELECTIONS}/{id}/revisions/B"
    assert {name: frozen.json()[name] for name in ("label", "author", "checked", "note", "number")} == {
        **{name: body[name] for name in ("label", "author", "checked", "note")},
        "number": 2,
    }
    latest = read(client, f"{SELECTIONS}/{id}")
    best = select(Application.model_validate(HEAVIER), catalogue)
    assert latest["application"] == HEAVIER and latest["label"] == latest["revision"] == "B"
    assert latest["selected"] == latest["result"]["selected"] == best.selected != before["selected"]
    assert latest["utilisation"] == pytest.approx(best.foremost.utilisation, rel=1e-12)
    assert [line["label"] for line in latest["revisions"]] == ["B", "A"]
    # The working copy is that application, and the list finds the selection by its gear.
    assert read(client, f"{MACHINES}/{id}/axes/1")["application"] == HEAVIER
    (line,) = read(client, f"{SELECTIONS}?search={latest['selected']}")["selections"]
    assert (line["id"], line["selected"], line["revision"]) == (id, latest["selected"], "B")


def test_an_earlier_revision_stays_as_it_was(client: TestClient) -> None:
    id = save(client, revision="A")
    before = read(client, f"{SELECTIONS}/{id}")
    client.post(f"{SELECTIONS}/{id}/revisions", json={"application": HEAVIER, "label": "B"})
    same = ("application", "result", "selected", "designation", "status", "utilisation", "gear", "revision", "label")
    for place in (f"{SELECTIONS}/{id}?revision=a", f"{SELECTIONS}/{id}/revisions/A"):
        then = read(client, place)
        assert {name: then[name] for name in same} == {name: before[name] for name in same}
        assert then["today"]["difference_count"] == 0
    page = client.get(f"/selections/{id}?revision=A")
    assert page.status_code == 200 and before["selected"] in page.text
    tags = {client.get(f"{SELECTIONS}/{id}{query}").headers["etag"] for query in ("", "?revision=A", "?revision=B")}
    assert len(tags) == 2


@pytest.mark.parametrize("label", ["C", "%00", "ä", "x" * 21, "a%2Fb", "now"])
def test_a_revision_that_there_is_not_is_a_refusal(client: TestClient, label: str) -> None:
    id = save(client)
    for place in (
        f"{SELECTIONS}/{id}?revision={label}",
        f"{SELECTIONS}/{id}/revisions/{label}",
        f"{SELECTIONS}/{id}/report.xlsx?revision={label}",
        f"{MACHINES}/{id}/revisions/{label}",
        f"/selections/{id}?revision={label}",
    ):
        assert client.get(place).status_code in (404, 422), place


def test_a_revision_that_there_is_not_is_named_with_those_that_there_are(client: TestClient) -> None:
    id = save(client, revision="A")
    client.post(f"{SELECTIONS}/{id}/revisions", json={"application": HEAVIER, "label": "B"})
    text = "There is no revision “C”; there are B, A."
    for place in (
        f"{SELECTIONS}/{id}?revision=C",
        f"{SELECTIONS}/{id}/revisions/C",
        f"{SELECTIONS}/{id}/report.xlsx?revision=C",
        f"{MACHINES}/{id}/revisions/C",
        f"{MACHINES}/{id}/axes.csv?revision=C",
        f"{MACHINES}/{id}/differences?from=A&to=C",
    ):
        reply = client.get(place)
        assert (reply.status_code, reply.json()["detail"]) == (404, text), place
    for place in (f"/selections/{id}?revision=C", f"/selections/{id}/revisions?from=A&to=C"):
        page = client.get(place)
        assert page.status_code == 404 and text in page.text, place
        assert all(f'href="/selections/{id}?revision={label}"' in page.text for label in "AB")
    assert "It may have been deleted" in client.get("/selections/AAAAAAAAAAAAAAAAAAAAAA?revision=C").text


def test_of_many_revisions_the_latest_twenty_are_named(client: TestClient) -> None:
    place = f"{MACHINES}/{save(client)}"
    for number in range(2, 23):
        assert client.post(f"{place}/revisions", json={"label": str(number)}).status_code == 201
    text = client.get(f"{place}/revisions/x").json()["detail"]
    assert text.startswith("There is no revision “x”; there are 22, 21, 20, ") and text.endswith("3 and 2 older ones.")


def test_a_key_freezes_once_and_a_label_is_taken_once(client: TestClient) -> None:
    id, place = (made := save(client)), f"{SELECTIONS}/{made}/revisions"
    body: Json = {"application": HEAVIER, "label": "B"}
    key = {"Idempotency-Key": "table-b"}
    first, again = (client.post(place, json=body, headers=key) for _ in range(2))
    assert (first.status_code, again.status_code) == (201, 201) and first.json() == again.json()
    assert "idempotency-replayed" not in first.headers and again.headers["idempotency-replayed"] == "true"
    assert client.post(place, json=body | {"label": "C"}, headers=key).status_code == 422
    assert client.post(place, json=body | {"label": "b"}).status_code == 409
    assert [line["label"] for line in read(client, f"{MACHINES}/{id}/revisions")["revisions"]] == ["B", "saved"]


def test_the_tag_of_a_selection_is_that_of_its_latest_revision(client: TestClient) -> None:
    id = save(client)
    tag = client.get(f"{SELECTIONS}/{id}").headers["etag"]
    place, own = f"{SELECTIONS}/{id}/revisions", {"If-Match": tag}
    frozen = client.post(place, json={"application": HEAVIER, "label": "B"}, headers=own)
    assert frozen.status_code == 201
    assert frozen.headers["etag"] == client.get(frozen.headers["location"]).headers["etag"]
    assert frozen.headers["etag"] == client.get(f"{SELECTIONS}/{id}").headers["etag"]
    assert client.post(place, json={"application": HEAVIER, "label": "C"}, headers=own).status_code == 412
    assert client.get(f"{SELECTIONS}/{id}", headers={"If-None-Match": tag}).status_code == 200


def test_what_is_wrong_is_named_where_it_stands_and_nothing_is_frozen(client: TestClient) -> None:
    id = save(client)
    place = f"{SELECTIONS}/{id}/revisions"
    for body, pointer in (
        ({"label": "B", "application": worked_example(ratios=[7])}, "/application/ratios"),
        ({"label": "B", "application": worked_example(), "ordering_code": "HPN-99Z-5"}, "/ordering_code"),
        ({"label": "today", "application": worked_example()}, "/label"),
    ):
        refused = client.post(place, json=body)
        assert refused.status_code == 422 and refused.json()["errors"][0]["pointer"].startswith(pointer), refused.text
    machine = client.post(MACHINES, json={"axes": [{"application": worked_example()}]}).json()["id"]
    whole = {"label": "B", "application": worked_example()}
    assert client.post(f"{SELECTIONS}/{machine}/revisions", json=whole).status_code == 404
    assert len(read(client, place)["revisions"]) == 1


def freeze(client: TestClient, id: str, label: str) -> int:
    return client.post(f"{MACHINES}/{id}/revisions", json={"label": label}).status_code


def test_a_selection_frozen_as_a_document_keeps_its_whole_reply(client: TestClient, catalogue: Catalogue) -> None:
    id = save(client)
    place = f"{MACHINES}/{id}"
    assert client.patch(f"{place}/axes/1", json={"application": HEAVIER}).status_code == 200
    assert read(client, f"{SELECTIONS}/{id}")["label"] == "saved"  # the working copy is not what it shows
    client.patch(place, json={"common": {"requirements": {"utilisation": 0.5}}})
    assert freeze(client, id, "B") == 201
    latest, resolved = read(client, f"{SELECTIONS}/{id}"), read(client, f"{place}/axes/1")["resolved"]
    assert latest["label"] == "B" and latest["application"] == resolved
    assert latest["result"] == select_of(client, resolved)
    assert client.get(f"/selections/{id}").status_code == 200


def select_of(client: TestClient, application: Json) -> Json:
    answer: Json = client.post("/api/v1/select", json=application).json()
    return answer


def test_an_open_selection_is_not_frozen_and_its_page_stays(client: TestClient) -> None:
    id = save(client)
    client.put(f"{MACHINES}/{id}/axes/1", json={"application": {}})
    assert freeze(client, id, "B") == 409
    assert read(client, f"{SELECTIONS}/{id}")["label"] == "saved"


def test_no_order_of_calls_makes_a_selection_unreadable(client: TestClient) -> None:
    calls = {
        "open": lambda id, label: client.put(f"{MACHINES}/{id}/axes/1", json={"application": {}}),
        "change": lambda id, label: client.patch(f"{MACHINES}/{id}/axes/1", json={"application": HEAVIER}),
        "code": lambda id, label: client.patch(f"{MACHINES}/{id}/axes/1", json={"ordering_code": "HPN-14A-5"}),
        "common": lambda id, label: client.patch(f"{MACHINES}/{id}", json={"common": {"ratios": [5]}}),
        "freeze": lambda id, label: client.post(f"{MACHINES}/{id}/revisions", json={"label": label}),
        "revise": lambda id, label: client.post(
            f"{SELECTIONS}/{id}/revisions", json={"label": label, "application": worked_example()}
        ),
    }
    for order in itertools.permutations(calls, 2):
        id = save(client)
        for place, name in enumerate((*order, "freeze")):
            done = calls[name](id, f"R{place}")
            assert done.status_code < 500, (order, name, done.text)
        lines = read(client, f"{SELECTIONS}/{id}")["revisions"]
        places = [f"{SELECTIONS}/{id}/revisions/{line['label']}" for line in lines]
        for address in (*places, f"{MACHINES}/{id}", f"/selections/{id}"):
            assert client.get(address).status_code == 200, (order, address)

"""Names of saved selections over REST: the title block, searching and renaming, on each kind of database."""

import threading
from typing import Any

import pytest
from starlette.testclient import TestClient

from hpn.web.api import selections
from hpn.web.door.bodies import parsed
from tests.build import Json, worked_example
from tests.store.drafts import ADDRESS, save

WRITTEN: Json = {"author": "M. Muster", "revision": "B", "ordering_code": "HPN-32A-5-J8-BH-AF1"}


def test_title_block_and_ordering_code_are_kept_and_listed(client: TestClient) -> None:
    id = save(client, title="Axis 7", **WRITTEN | {"ordering_code": " hpn-32-5-j8-bh-af1 "})

    for saved in (client.get(f"{ADDRESS}/{id}").json(), *client.get(ADDRESS).json()["selections"]):
        assert {name: saved[name] for name in WRITTEN} == WRITTEN
        assert (saved["selected"], saved["designation"], saved["status"]) == ("HPN-20A-4", "HPN-32A-5", "suitable")


def test_a_selection_saved_without_labels_has_none(client: TestClient) -> None:
    saved = client.get(f"{ADDRESS}/{save(client)}").json()

    assert {name: saved[name] for name in WRITTEN} == dict.fromkeys(WRITTEN)
    assert saved["designation"] == saved["selected"]
    assert saved["utilisation"] == saved["result"]["candidates"][0]["utilisation"]


@pytest.mark.parametrize(
    ("code", "detail"),
    [
        ("BH-AF1", "must be a gear of the catalogue"),
        ("HPN-20A-5-J7", "must be a gear of the catalogue"),
        ("HPN-20A-5-J6-?", "must be a gear of the catalogue"),
        ("HPN-32A-7-J6", "HPN-32A-7 is not a candidate"),
    ],
)
def test_an_ordering_code_that_cannot_be_is_refused(client: TestClient, code: str, detail: str) -> None:
    body = {"application": worked_example(requirements={"ratios": [5]}), "ordering_code": code}

    [error] = client.post(ADDRESS, json=body).json()["errors"]

    assert error["pointer"] == "/ordering_code"
    assert detail in error["detail"]


# --- Searching and renaming -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("search", "result"),
    [
        ("ÄXIS", ["a", "b"]),
        ("axis 4711-b", ["b"]),
        ("muster", ["a"]),
        ("20A", ["a", "b", "c"]),
        ("bh-af1", ["a"]),
        ("%", ["c"]),
        ("100_", []),
        ("", ["a", "b", "c"]),
        ("nothing of the kind", []),
    ],
)
def test_a_search_finds_each_word_in_any_case_wherever_it_stands(
    client: TestClient, search: str, result: list[str]
) -> None:
    labels: list[Json] = [
        {"title": "Äxis a", "reference": "4711-A", "author": "M. Muster", "ordering_code": "HPN-20A-5-J6-BH-AF1"},
        {"title": "äxis b is an axis", "reference": "4711-B"},
        {"title": "100 % c"},
    ]
    for parts in labels:
        save(client, **parts)

    listed = client.get(ADDRESS, params={"search": search}).json()["selections"]

    assert [entry["title"].split(" ")[1 if "xis" in entry["title"] else 2] for entry in listed[::-1]] == result


def test_the_next_part_of_a_search_is_of_the_same_search(client: TestClient) -> None:
    for title in ("one", "other", "one"):
        save(client, title=title)

    first = client.get(ADDRESS, params={"search": "one", "limit": 1})
    second = client.get(first.links["next"]["url"])

    assert [entry["title"] for entry in second.json()["selections"]] == ["one"]
    assert second.json()["next_cursor"] is None


def test_a_selection_is_renamed_and_nothing_else_of_it_changes(client: TestClient) -> None:
    address = f"{ADDRESS}/{save(client, title='old', reference='4711', **WRITTEN)}"
    before = client.get(address)

    answer = client.patch(address, json={"title": " new "}, headers={"If-Match": before.headers["etag"]})

    assert answer.status_code == 200, answer.text
    after = client.get(address)
    assert answer.json() == after.json() == before.json() | {"title": "new"}
    assert answer.headers["etag"] == after.headers["etag"] != before.headers["etag"]
    assert [client.get(ADDRESS, params={"search": word}).json()["selections"] for word in ("old", "new")] == [
        [],
        client.get(ADDRESS).json()["selections"],
    ]
    assert client.patch(address, json={"reference": None}).json()["reference"] is None
    assert client.patch(address, json={}).json()["title"] == "new"


def test_long_names_are_read_beside_the_event_loop(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    address = f"{ADDRESS}/{save(client, **WRITTEN)}"
    threads: list[int] = []
    assert client.portal is not None
    loop = client.portal.call(threading.get_ident)

    def seen(*arguments: Any) -> Any:
        threads.append(threading.get_ident())
        return parsed(*arguments)

    monkeypatch.setattr(selections, "parsed", seen)
    content = b"{%s}" % b",".join([b'"title":"new"'] * 80_000)
    answer = client.patch(address, content=content, headers={"Content-Type": "application/json"})

    assert answer.status_code == 422
    assert answer.json()["detail"] == "contains the name 'title' 80000 times in one object"
    assert len(threads) == 1
    assert loop not in threads


def test_a_selection_is_renamed_by_a_merge_patch(client: TestClient) -> None:
    address = f"{ADDRESS}/{save(client, title='old', reference='4711', **WRITTEN)}"

    headers = {"Content-Type": "application/merge-patch+json; charset=utf-8"}
    answer = client.patch(address, content='{"title": null}', headers=headers)

    assert answer.status_code == 200, answer.text
    assert (answer.json()["title"], answer.json()["reference"]) == (None, "4711")
    refused = client.patch(address, content="[]", headers={"Content-Type": "application/json-patch+json"})
    assert refused.status_code == 415
    assert "application/json or application/merge-patch+json" in refused.json()["detail"]


@pytest.mark.parametrize(
    ("body", "status", "pointer"),
    [
        ({"title": "x" * 201}, 422, "/title"),
        ({"reference": "a\nb"}, 422, "/reference"),
        ({"application": worked_example()}, 422, "/application"),
        ({"ordering_code": "HPN-20A-5"}, 422, "/ordering_code"),
        ([], 422, ""),
    ],
)
def test_a_body_without_a_name_changes_nothing(client: TestClient, body: Any, status: int, pointer: str) -> None:
    address = f"{ADDRESS}/{save(client, title='t')}"

    answer = client.patch(address, json=body)

    assert answer.status_code == status
    assert answer.json()["errors"][0]["pointer"] == pointer
    assert client.get(address).json()["title"] == "t"


def test_renaming_asks_for_the_state_that_is_meant_and_for_one_that_is_there(client: TestClient) -> None:
    address = f"{ADDRESS}/{save(client)}"

    assert client.patch(address, json={"title": "t"}, headers={"If-Match": '"other"'}).status_code == 412
    client.delete(address)
    assert client.patch(address, json={"title": "t"}).status_code == 404


def test_a_renamed_selection_is_what_its_idempotency_key_finds(client: TestClient) -> None:
    id = save(client, {"Idempotency-Key": "k"}, title="t")
    client.patch(f"{ADDRESS}/{id}", json={"title": "u"})

    assert save(client, {"Idempotency-Key": "k"}, title="t") == id

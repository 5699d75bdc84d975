"""Axes of a machine over REST: read, replaced, patched, added, many at once, and by several people at once."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from threading import Barrier
from typing import Any

import pytest
from starlette.testclient import TestClient

from hpn.documents.merge import resolve
from tests.build import worked_example
from tests.store.test_machines_api import ADDRESS, AXES, read, save


def test_an_axis_is_read_with_its_selection(client: TestClient) -> None:
    place = save(client)
    axis = read(client, f"{place}/axes/1")
    assert axis == read(client, place)["axes"][0]
    selection = read(client, f"{place}/axes/1/selection")
    posted = client.post("/api/v1/select", json=axis["resolved"]).json()
    assert selection == posted
    assert client.get(f"{place}/axes/3/selection").status_code == 409
    assert client.get(f"{place}/axes/4").status_code == 404


def test_an_axis_is_replaced_patched_and_two_axes_never_meet(client: TestClient) -> None:
    place = save(client)
    machine = client.get(place).headers["etag"]
    tags = {n: client.get(f"{place}/axes/{n}").headers["etag"] for n in (1, 2)}

    patch = {"application": {"requirements": {"utilisation": None}}, "quantity": 7}
    one = client.patch(f"{place}/axes/1", json=patch, headers={"If-Match": tags[1]})
    two = client.put(f"{place}/axes/2", json={"name": "new"}, headers={"If-Match": tags[2]})
    late = client.patch(f"{place}/axes/1", json={"quantity": 8}, headers={"If-Match": tags[1]})

    assert (one.status_code, two.status_code, late.status_code) == (200, 200, 412)
    assert late.json()["detail"] == "If-Match names an earlier or other state; read this address again"
    assert one.json()["resolved"]["requirements"]["utilisation"] == 0.9 and one.json()["quantity"] == 7
    assert two.json()["application"] == {} and two.json()["answer"]["status"] == "open"
    assert client.get(place).headers["etag"] == machine  # it stands for the set of axes, not for what they say
    assert read(client, place)["counts"]["open"] == 2
    assert client.patch(f"{place}/axes/1", json={"colour": "red"}).status_code == 422
    assert client.patch(f"{place}/axes/1", json={"name": "x" * 41}).status_code == 422


def test_numbers_are_never_used_again_and_bring_an_axis_back(client: TestClient) -> None:
    place = save(client)
    before = read(client, f"{place}/axes/3")
    assert client.delete(f"{place}/axes/3").status_code == 204
    assert client.delete(f"{place}/axes/3").status_code == 404

    added = client.post(f"{place}/axes", json={"axes": [AXES[1], {"number": 3}]})

    assert added.status_code == 201 and added.json()["numbers"] == [4, 3]
    assert read(client, place)["order"] == [1, 2, 4, 3]
    back = read(client, f"{place}/axes/3")
    assert (back["name"], back["application"]) == (before["name"], before["application"])
    for number in (3, 9):
        assert client.post(f"{place}/axes", json={"axes": [{"number": number}]}).status_code == 422


def test_axes_are_added_once_with_a_key(client: TestClient) -> None:
    place, key = save(client), {"Idempotency-Key": "add"}
    key["If-Match"] = client.get(place).headers["etag"]  # of the state before, which the retry names, too
    first, again = (client.post(f"{place}/axes", json={"axes": AXES}, headers=key) for _ in range(2))
    assert first.json() == again.json() == {"numbers": [4, 5, 6]}
    assert "idempotency-replayed" not in first.headers and again.headers["idempotency-replayed"] == "true"
    assert len(read(client, place)["axes"]) == 6
    assert client.post(f"{place}/axes", json={"axes": AXES[:1]}, headers=key).status_code == 422


def test_an_axis_comes_back_once_with_a_key(client: TestClient) -> None:
    """The retry names an axis that is there again, which without the key is refused."""
    place, key = save(client), {"Idempotency-Key": "restore"}
    client.delete(f"{place}/axes/3")
    first, again = (client.post(f"{place}/axes", json={"axes": [{"number": 3}]}, headers=key) for _ in range(2))
    assert (first.status_code, again.status_code) == (201, 201), again.text
    assert first.json() == again.json() == {"numbers": [3]}
    assert again.headers["idempotency-replayed"] == "true"


def test_a_selection_becomes_a_machine_once_with_a_key(client: TestClient) -> None:
    saved = client.post("/api/v1/selections", json={"application": worked_example()}).json()["id"]
    place, key = f"{ADDRESS}/{saved}/axes", {"Idempotency-Key": "begin"}
    first, again = (client.post(place, json={"axes": AXES[:1]}, headers=key) for _ in range(2))
    assert first.json() == again.json() == {"numbers": [2]}
    assert first.headers["location"] == again.headers["location"]
    assert "idempotency-replayed" not in first.headers and again.headers["idempotency-replayed"] == "true"


def test_many_axes_change_at_once_and_the_effect_is_known_before(client: TestClient) -> None:
    place = save(client)
    body = {"numbers": [1, 2], "patch": {"application": {"requirements": {"utilisation": 0.05}}}}

    dry = client.patch(f"{place}/axes?dry=1", json=body)
    assert dry.status_code == 200, dry.text
    assert read(client, place)["axes"][0]["application"] == AXES[0]["application"]  # nothing is saved
    assert client.patch(f"{place}/axes", json=body).status_code == 428
    tag = client.get(place).headers["etag"]
    done = client.patch(f"{place}/axes", json=body, headers={"If-Match": tag})

    assert done.status_code == 200 and done.json() == dry.json()
    after = read(client, place)["axes"]
    assert [axis["application"]["requirements"]["utilisation"] for axis in after[:2]] == [0.05, 0.05]
    gone = [axis["number"] for axis in after[:2] if axis["answer"]["selected"] is None]
    assert done.json()["without_gear"] == gone
    assert client.patch(f"{place}/axes?dry=1", json=body | {"numbers": [99]}).status_code == 422
    every = client.patch(f"{place}/axes", json={"numbers": "all", "patch": {"quantity": 3}}, headers={"If-Match": "*"})
    assert every.status_code == 200 and {axis["quantity"] for axis in read(client, place)["axes"]} == {3}


def test_people_on_two_axes_at_once_all_succeed(client: TestClient) -> None:
    place = save(client, axes=[AXES[1]] * 6)
    start = Barrier(6)

    def change(number: int) -> int:
        start.wait()
        tag = client.get(f"{place}/axes/{number}").headers["etag"]
        return client.patch(
            f"{place}/axes/{number}", json={"quantity": 10 + number}, headers={"If-Match": tag}
        ).status_code

    with ThreadPoolExecutor(6) as pool:
        assert list(pool.map(change, range(1, 7))) == [200] * 6
    assert [axis["quantity"] for axis in read(client, place)["axes"]] == [10 + n for n in range(1, 7)]


def test_of_those_who_change_one_axis_at_once_one_succeeds(client: TestClient) -> None:
    place = save(client)
    seen = {"If-Match": client.get(f"{place}/axes/1").headers["etag"]}
    start = Barrier(4)

    def change(number: int) -> int:
        start.wait()
        return client.patch(f"{place}/axes/1", json={"quantity": number}, headers=seen).status_code

    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(change, range(2, 6)))
    assert sorted(found) == [200, 412, 412, 412]
    assert read(client, f"{place}/axes/1")["quantity"] == found.index(200) + 2


def test_an_axis_saved_while_common_values_change_has_an_answer_under_the_new_ones(client: TestClient) -> None:
    place = save(client, axes=[AXES[1]] * 3)
    calls: list[Callable[[], Any]] = [
        partial(client.patch, place, json={"common": {"requirements": {"utilisation": u}}}) for u in (0.2, 0.3, 0.4)
    ]
    calls += [partial(client.patch, f"{place}/axes/{n}", json={"quantity": 5}) for n in (1, 2, 3)]
    with ThreadPoolExecutor(6) as pool:
        assert {answer.status_code for answer in pool.map(lambda call: call(), calls)} == {200}

    found = read(client, place)
    for axis in found["axes"]:
        whole = resolve(axis["application"], found["common"]).whole
        assert axis["resolved"] == whole
        answer = client.post("/api/v1/select", json=whole).json()
        assert axis["answer"]["selected"] == answer["selected"] and axis["quantity"] == 5


@pytest.mark.parametrize(
    ("numbers", "pointer", "detail"),
    [
        ("7", "/numbers", 'must be a list of numbers, such as [1, 2], or "all"'),
        ([1, "x"], "/numbers/1", "must be a whole number, such as 5"),
        (None, "/numbers", 'must be a list of numbers, such as [1, 2], or "all"'),
    ],
)
def test_a_wrong_choice_of_axes_is_named_where_it_stands(
    client: TestClient, numbers: Any, pointer: str, detail: str
) -> None:
    place = save(client)

    answer = client.patch(f"{place}/axes?dry=1", json={"numbers": numbers, "patch": {"quantity": 2}})

    assert answer.status_code == 422
    assert [(error["pointer"], error["detail"]) for error in answer.json()["errors"]] == [(pointer, detail)]


def test_a_wrong_value_for_many_axes_is_named_where_it_stands(client: TestClient) -> None:
    place = save(client)
    answer = client.patch(f"{place}/axes?dry=1", json={"numbers": "all", "patch": {"quantity": 0}})
    assert answer.status_code == 422
    assert [error["pointer"] for error in answer.json()["errors"]] == ["/patch/quantity"]
    assert answer.json()["detail"].startswith("/patch/quantity: ")

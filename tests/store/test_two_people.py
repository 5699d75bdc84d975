"""Two people who change one thing at once: of those who saw one version, one changes it, and the others learn that."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from threading import Barrier
from typing import Any

import pytest
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.build import worked_example
from tests.state import state_of
from tests.store.test_machines import MOST_BYTES
from tests.store.test_machines import draft as machine_draft

SAVE = {"application": worked_example(), "title": "Axis"}
ROUNDS = 8
CALLERS = 6


@pytest.fixture
def client(ready_database: str) -> Iterator[TestClient]:
    """A client of a service on each kind of database."""
    with TestClient(create_app(Settings(database_url=ready_database)), follow_redirects=False) as client:
        yield client


def at_once(calls: Sequence[Callable[[], Any]]) -> list[int]:
    """Status of each of several requests that start together."""
    start = Barrier(len(calls))

    def run(call: Callable[[], Any]) -> int:
        start.wait()
        return int(call().status_code)

    with ThreadPoolExecutor(len(calls)) as pool:
        return list(pool.map(run, calls))


def saved(client: TestClient) -> tuple[str, dict[str, str]]:
    """Address of a new selection, and the condition that it is as it was saved."""
    place = client.post("/api/v1/selections", json=SAVE).headers["Location"]
    return place, {"If-Match": client.get(place).headers["ETag"]}


def test_of_those_who_rename_one_state_at_once_one_succeeds(client: TestClient) -> None:
    for _ in range(ROUNDS):
        place, seen = saved(client)
        titles = [{"title": f"by {number}"} for number in range(CALLERS)]

        result = at_once([partial(client.patch, place, json=title, headers=seen) for title in titles])

        assert sorted(result) == [200] + [412] * (CALLERS - 1)
        assert client.get(place).json()["title"] == f"by {result.index(200)}"


def test_a_rename_and_a_delete_of_one_state_at_once_do_not_both_succeed(client: TestClient) -> None:
    for _ in range(ROUNDS):
        place, seen = saved(client)
        renamed, deleted = at_once(
            [
                partial(client.patch, place, json={"title": "kept"}, headers=seen),
                partial(client.delete, place, headers=seen),
            ]
        )

        assert (renamed, deleted) in ((200, 412), (412, 204), (404, 204))
        assert client.get(place).status_code == (200 if renamed == 200 else 404)


def test_any_state_is_changed_by_everybody(client: TestClient) -> None:
    place, _ = saved(client)

    assert at_once([partial(client.patch, place, json={"title": "a"}, headers={"If-Match": "*"})] * 3) == [200] * 3
    assert client.patch(place, json={"title": "b"}).status_code == 200


def kept(client: TestClient) -> str:
    """Address of a saved machine."""
    assert client.portal is not None
    store = state_of(client).store
    id: str = client.portal.call(store.keep_machine, machine_draft(), MOST_BYTES)
    assert client.post(f"/machines/{id}", data={"title": "Line"}).status_code == 303
    return f"/machines/{id}"


@pytest.mark.parametrize("kind_of_thing", ["selection", "machine"])
def test_forms_of_one_version_that_are_sent_at_once_change_it_once(client: TestClient, kind_of_thing: str) -> None:
    for _ in range(ROUNDS):
        place = kept(client) if kind_of_thing == "machine" else saved(client)[0].removeprefix("/api/v1")
        form = {"ref": "", "version": "2" if kind_of_thing == "machine" else "1"}

        renames = [{"title": f"by {number}", **form} for number in range(CALLERS - 1)]
        calls = [partial(client.post, f"{place}/rename", data=data) for data in renames]
        calls.append(partial(client.post, f"{place}/delete", data=form))
        result = at_once(calls)

        assert result.count(303) == 1
        assert set(result) <= {303, 404, 412}


def test_a_page_says_that_somebody_was_faster(client: TestClient) -> None:
    place = saved(client)[0].removeprefix("/api/v1")
    page_text = client.get(f"{place}/delete").text
    assert '<input type="hidden" name="version" value="1">' in page_text
    assert '<input type="hidden" name="version" value="1">' in client.get("/selections").text
    assert client.post(f"{place}/rename", data={"title": "new", "version": "1"}).status_code == 303

    late = client.post(f"{place}/delete", data={"version": "1"})

    assert late.status_code == 412
    assert "This was renamed or deleted" in late.text
    assert client.post(f"{place}/delete", data={"version": "nonsense"}).status_code == 412
    assert client.post(f"{place}/delete", data={"version": "2"}).status_code == 303


def test_a_machine_that_two_save_at_once_has_the_names_of_one_and_the_other_learns_it(client: TestClient) -> None:
    assert client.portal is not None
    for _ in range(ROUNDS):
        place = f"/machines/{client.portal.call(state_of(client).store.keep_machine, machine_draft(), MOST_BYTES)}"
        result = at_once([partial(client.post, place, data={"title": f"of {n}"}) for n in range(3)])

        assert sorted(result) == [303, 412, 412]
        assert f"of {result.index(303)}" in client.get("/machines").text
        assert client.post(place, data={"title": f"of {result.index(303)}"}).status_code == 303  # sent once more

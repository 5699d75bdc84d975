"""After a new catalogue, lists say what gets another verdict: asked in the background, each axis once."""

import asyncio
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.documents.answers import AxisAnswer, AxisQuestion, answers
from hpn.documents.merge import resolve
from hpn.engine.selection import encode, select
from hpn.store import Store
from hpn.web import todays
from hpn.web.app import create_app
from hpn.web.columns import columns_of
from hpn.web.settings import Settings
from tests.build import Json, cycle, phase, worked_example
from tests.store.drafts import WEAKER, draft, save

SLOW, NEAR = cycle(phase(4, 300)), worked_example(requirements={"ratios": [5]})
"""Applications whose gear stays, and becomes another one."""

MACHINE: Json = {"title": "Line", "axes": [{"name": "a", "application": NEAR}, {"application": SLOW}, {}]}
SECONDS = 60
"""Patience with the background, many times what it takes."""

Asking = list[int]
Later = Callable[[], Any]


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> Asking:
    """Numbers of axes that the background has asked, one for each time."""
    counts = Asking()

    def counted(axes: Sequence[AxisQuestion], catalogue: Catalogue) -> list[AxisAnswer]:
        counts.append(len(axes))
        return answers(axes, catalogue)

    monkeypatch.setattr(todays, "answers", counted)
    return counts


@pytest.fixture
def later(ready_database: str, tmp_path: Path) -> Later:
    """Opens a service on the same database with a catalogue in which HPN-20A-5 is weaker."""
    (tmp_path / "ratings.csv").write_text(WEAKER)

    @contextmanager
    def opened() -> Iterator[TestClient]:
        settings = Settings(database_url=ready_database, catalogue_supplement=tmp_path)
        with TestClient(create_app(settings)) as client:
            yield client

    return opened


def settled(client: TestClient, query: str = "") -> Json:
    """A list whose documents are all asked."""
    end = time.monotonic() + SECONDS
    while (result := read(client, query))["pending"]:
        assert time.monotonic() < end, result
        time.sleep(0.05)
    return result


def read(client: TestClient, query: str) -> Json:
    answer = client.get(f"/api/v1/{query or 'machines?kind=all'}")
    assert answer.status_code == 200, answer.text
    reply: Json = answer.json()
    return reply


def make(client: TestClient) -> tuple[str, str, str]:
    """Ids of a machine, and of a selection that gets another verdict and one that doesn't."""
    machine = client.post("/api/v1/machines", json=MACHINE).json()["id"]
    return machine, save(client, title="other", application=NEAR), save(client, title="same", application=SLOW)


def test_what_was_saved_a_moment_ago_is_known(client: TestClient, asked: Asking) -> None:
    make(client)
    result = read(client, "machines?kind=all")
    assert result["pending"] == 0 and {each["today"]["verdict_changed"] for each in result["machines"]} == {0}
    first = read(client, "selections?search=other")["selections"][0]
    assert first["today"] == {"selected": first["selected"], "status": first["status"], "verdict_changed": False}
    assert not asked


def test_a_new_catalogue_says_what_gets_another_verdict(client: TestClient, later: Later, asked: Asking) -> None:
    machine, other, same = make(client)
    with later() as new:
        by_name = {each["id"]: each["today"] for each in settled(new)["machines"]}
        assert by_name == {
            machine: {"verdict_changed": 1, "axes": [1]},
            other: {"verdict_changed": 1, "axes": []},
            same: {"verdict_changed": 0, "axes": []},
        }
        assert [each["id"] for each in read(new, "machines?differs=verdict")["machines"]] == [machine]
        (line,) = read(new, "selections?differs=verdict")["selections"]
        # the same as reading each one says, which asks by itself
        today = new.get(f"/api/v1/selections/{other}").json()["today"]
        selected = next(each for each in today["differences"] if each["field"] == "selected")
        assert line["id"] == other and line["selected"] == selected["saved"]
        assert line["today"] == {"selected": selected["today"], "status": "suitable", "verdict_changed": True}
        compared = read(new, f"machines/{machine}/differences?from=now&to=today")
        assert [each["number"] for each in compared["axes"] if each["verdicts"]] == [1]
        assert sum(asked) == 5  # three axes, two selections


def test_an_axis_that_is_ordered_keeps_its_verdict_where_another_gear_is_selected(
    client: TestClient, later: Later
) -> None:
    """HPN-20A-5 was selected before and fails today; ordered is HPN-32A-5, which both catalogues rate alike."""
    axes = [{"application": NEAR, "ordering_code": code} for code in ("HPN-32A-5-J6", "HPN-20A-5-J6", None)]
    client.post("/api/v1/machines", json={"title": "Ordered", "axes": axes}).raise_for_status()
    with later() as new:
        (line,) = settled(new, "machines")["machines"]
        assert line["today"] == {"verdict_changed": 2, "axes": [2, 3]}


def test_nothing_is_asked_twice(client: TestClient, later: Later, asked: Asking) -> None:
    machine, *_ = make(client)
    with later() as new, later() as beside:
        settled(new), settled(beside)
        assert sum(asked) == 5
        tag = new.get(f"/api/v1/machines/{machine}/axes/2").headers["etag"]
        changed = new.patch(f"/api/v1/machines/{machine}/axes/2", json={"quantity": 3}, headers={"If-Match": tag})
        assert changed.status_code == 200
        new.patch(f"/api/v1/machines/{machine}", json={"title": "Other"})
        (line,) = settled(new, "machines")["machines"]
        assert line["today"] == {"verdict_changed": 1, "axes": [1]}
        assert sum(asked) == 5  # neither for the changed axis, nor for those beside it
        new.patch(f"/api/v1/machines/{machine}", json={"common": {"rank_by": "life"}})
        assert settled(new, "machines")["machines"][0]["today"]["verdict_changed"] == 0  # it is answered anew
    with later() as again:
        assert settled(again)["pending"] == 0 and sum(asked) == 5


def test_while_two_versions_run_neither_asks_what_the_other_has_asked(
    client: TestClient, later: Later, asked: Asking
) -> None:
    make(client)
    with later() as new:
        settled(new)
        for _ in range(5):
            assert read(client, "machines?kind=all")["pending"] == 3
            assert read(new, "machines?kind=all")["pending"] == 0
        other = save(client, title="saved by the older one", application=NEAR)
        lines = {each["id"]: each for each in settled(new, "selections")["selections"]}
        assert lines[other]["today"]["verdict_changed"] and sum(asked) == 6


def test_a_revision_of_a_selection_is_of_today(
    client: TestClient, ready_database: str, later: Later, asked: Asking
) -> None:
    id = save(client, application=NEAR)
    with later() as new:
        assert settled(new, "selections")["selections"][0]["today"]["verdict_changed"]
        revision = {"application": NEAR, "label": "B"}
        assert new.post(f"/api/v1/selections/{id}/revisions", json=revision).status_code == 201
        (line,) = read(new, "selections")["selections"]
        assert line["selected"] == line["today"]["selected"] and not line["today"]["verdict_changed"]
        assert sum(asked) == 1
    with TestClient(create_app(Settings(database_url=ready_database))) as older:  # the older catalogue again
        result = settled(older, "selections")["selections"][0]
        assert result["today"]["verdict_changed"] and sum(asked) == 2


def test_five_hundred_selections_are_one_request_of_some_20_kb(
    ready_database: str, later: Later, asked: Asking, catalogue: Catalogue
) -> None:
    asyncio.run(_fill(ready_database, catalogue))
    with later() as new:
        settled(new, "selections?limit=1")
        answer = new.get("/api/v1/selections?differs=verdict&limit=200")
        assert len(answer.json()["selections"]) == 25 and len(answer.content) < 20_000
        assert sum(asked) == 500 and max(asked) <= 20


async def _fill(database: str, catalogue: Catalogue) -> None:
    """Save 500 selections, of which 25 have the gear that gets weaker."""
    store = Store(database)
    drafts = []
    for application in (NEAR, SLOW):
        selection = select(Application.model_validate(application), catalogue)
        view = selection.candidate(str(selection.selected))
        assert view is not None
        (answer,) = answers([AxisQuestion(resolve(application, {}))], catalogue)
        parts: Json = {
            "application": Application.model_validate(application).model_dump_json(exclude_unset=True).encode()
        }
        parts |= {"result": encode(selection), "selected": selection.selected, "designation": view.designation}
        parts |= {"status": view.status, "utilisation": view.utilisation, "catalogue_version": catalogue.version}
        drafts.append(parts | {"answer": columns_of(answer)})
    for number in range(500):
        await store.save(draft(**drafts[number >= 25], title=f"Axis {number}", reference="4711"))
    await store.close()


# --- Filters, orders, parts -------------------------------------------------------------------------------------------


@pytest.fixture
def line(client: TestClient) -> TestClient:
    """A service with five machines."""
    for title, reference, torque in (("b", "1", 4), ("A", None, 40), (None, "3", 9), ("a", "1", 20), ("Z", None, 3)):
        axes = [{"application": cycle(phase(torque, 250))}] * (torque % 4)
        client.post("/api/v1/machines", json={"title": title, "reference": reference, "author": "MA", "axes": axes})
    return client


@pytest.mark.parametrize("address", ["machines", "machines?kind=all"])
@pytest.mark.parametrize("name", ["saved", "created", "updated", "title", "reference", "utilisation", "axes", "weight"])
def test_each_order_is_the_other_reversed_whole_or_in_parts(line: TestClient, address: str, name: str) -> None:
    and_ = "&" if "?" in address else "?"

    def ids(sort: str, limit: int) -> list[str]:
        result, cursor = list[str](), ""
        while cursor is not None:
            part = read(line, f"{address}{and_}sort={sort}&limit={limit}{cursor and f'&cursor={cursor}'}")
            result += [each["id"] for each in part["machines"]]
            cursor = part["next_cursor"]
        return result

    whole = ids(name, 200)
    assert len(whole) == 5 and ids(f"-{name}", 200) == whole[::-1]
    assert ids(name, 2) == whole and ids(f"-{name}", 1) == whole[::-1]


def test_titles_are_sorted_without_case_and_figures_by_their_size(line: TestClient) -> None:
    titles = [each["title"] for each in read(line, "machines?sort=title")["machines"]]
    assert titles[0] is None and [title.lower() for title in titles[1:]] == ["a", "a", "b", "z"]
    counts = [each["counts"]["axes"] for each in read(line, "machines?sort=-axes")["machines"]]
    assert counts == sorted(counts, reverse=True)


@pytest.mark.parametrize("address", ["machines", "selections"])
@pytest.mark.parametrize(
    "query",
    [
        *("sort=colour", "sort=-", "sort=title&cursor=x", "sort=axes&cursor=bmFuIGFh", "differs=figures", "limit=201"),
        *("sort=utilisation&cursor=MWU5OTkgQUFBQUFBQUFBQUFBQUFBQUFBQUFBQQ==", "reference=", "updated_since=soon"),
        "sort=title&cursor=AGEgQUFBQUFBQUFBQUFBQUFBQUFBQUFBQQ==",
    ],
)
def test_what_no_list_has_is_refused(client: TestClient, address: str, query: str) -> None:
    assert client.get(f"/api/v1/{address}?{query}").status_code == 422


def test_selections_take_the_filters_of_machines(client: TestClient) -> None:
    first = save(client, title="one", author="MA", reference="7", application=NEAR)
    second = save(client, title="two", application=SLOW)
    gear = read(client, f"selections/{first}")["selected"]
    for query, expected in {
        "author=MA": [first],
        f"selected={gear}": [first],
        "search=two": [second],
        "reference=7": [first],
        "sort=title": [first, second],
        "created_since=2000-01-01T00:00:00Z": [second, first],
        "updated_since=2999-01-01T00:00:00Z": [],
    }.items():
        assert [each["id"] for each in read(client, f"selections?{query}")["selections"]] == expected, query
    client.delete(f"/api/v1/selections/{first}")
    assert read(client, "selections?deleted_since=2000-01-01T00:00:00Z")["deleted"] == [first]


@pytest.mark.parametrize("text", ["soon", "2026-13-01", "2026-11-27T8"])
def test_a_time_is_asked_for_by_an_example(client: TestClient, text: str) -> None:
    (error,) = client.get(f"/api/v1/selections?updated_since={text}").json()["errors"]

    assert error["pointer"] == "/updated_since"
    assert error["detail"] == "must be a date or time, such as 2026-11-27 or 2026-11-27T08:00:00Z"

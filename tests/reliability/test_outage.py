"""A database that is gone or stuck takes down saving, nothing else; and saving comes back by itself."""

import asyncio
import threading
import time
from pathlib import Path

import psycopg
import pytest
from sqlalchemy import Connection, Engine, event

from hpn.store import Store, StoreUnavailableError, upgrade
from hpn.web.door.pools import SMALL_BYTES
from tests.build import cycle, phase
from tests.databases import PostgreSQL
from tests.reliability.faults import (
    SAVE,
    SLACK_S,
    WAIT_S,
    Outage,
    assert_unavailable,
    client_of,
    postgresql_locked,
    sqlite_locked,
    stopped,
)
from tests.store.drafts import draft


@pytest.fixture(params=["sqlite locked", "postgresql locked", "postgresql stopped"])
def outage(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[str, Outage]:
    """Address of a database, and what makes it unusable for a while."""
    if request.param == "sqlite locked":
        path = tmp_path / "store.sqlite3"
        return f"sqlite:///{path}", lambda: sqlite_locked(path)
    server: PostgreSQL = request.getfixturevalue("postgresql")
    address = server.new_database()
    if request.param == "postgresql locked":
        return address, lambda: postgresql_locked(address)
    return address, lambda: stopped(server)


def test_while_the_database_is_gone_saving_says_when_to_retry_and_the_calculator_works_on(
    outage: tuple[str, Outage], soak: bool
) -> None:
    database, broken = outage
    with client_of(database) as client:
        before = client.post("/api/v1/selections", json=SAVE)
        with broken():
            end = time.monotonic() + (5 if soak else 2)
            while time.monotonic() < end:
                start = time.monotonic()
                assert_unavailable(client.post("/api/v1/selections", json=SAVE))
                assert time.monotonic() - start < WAIT_S + SLACK_S
                assert client.post("/api/v1/select", json=SAVE["application"]).status_code == 200
                assert client.get("/?T=40&n=250&t=1").status_code == 200
                assert client.get("/healthz").status_code == 200

        assert client.post("/api/v1/selections", json=SAVE).status_code == 201
        assert client.get(before.headers["location"]).status_code == 200
        assert client.get("/readyz").status_code == 200


def test_while_the_server_is_stopped_nothing_of_the_store_answers_and_readiness_says_so(postgresql: PostgreSQL) -> None:
    with client_of(postgresql.new_database()) as client:
        saved = client.post("/api/v1/selections", json=SAVE).json()
        with stopped(postgresql):
            address = f"/api/v1/selections/{saved['id']}"
            for response in (client.get(address), client.get("/api/v1/selections"), client.delete(address)):
                assert_unavailable(response)
            assert_unavailable(client.get("/readyz"))
            page = client.get(saved["url"])
            assert (page.status_code, page.headers["content-type"]) == (503, "text/html; charset=utf-8")
            assert "Retry-After" in page.headers

        assert client.get(saved["url"]).status_code == 200


def test_a_service_that_starts_before_its_database_saves_as_soon_as_it_can(postgresql: PostgreSQL) -> None:
    database = postgresql.new_database()
    with stopped(postgresql):
        client = client_of(database)
        client.__enter__()
        assert client.post("/api/v1/select", json=SAVE["application"]).status_code == 200
        assert_unavailable(client.get("/readyz"))
        assert_unavailable(client.post("/api/v1/selections", json=SAVE))

    assert client.post("/api/v1/selections", json=SAVE).status_code == 201
    client.__exit__(None, None, None)


def test_a_service_whose_database_takes_long_at_its_start_answers_meanwhile(postgresql: PostgreSQL) -> None:
    database = postgresql.new_database()
    with psycopg.connect(database, autocommit=True) as other:
        other.execute("SELECT pg_advisory_lock(%s)", [upgrade.LOCK])  # as another worker has it, which migrates

        start = time.monotonic()
        slow = client_of(database)
        slow.__enter__()
        assert time.monotonic() - start < WAIT_S + SLACK_S
        assert slow.get("/healthz").status_code == 200
        assert slow.get("/?T=40&n=250&t=1").status_code == 200
        assert_unavailable(slow.get("/readyz"))

        other.execute("SELECT pg_advisory_unlock(%s)", [upgrade.LOCK])
        assert slow.post("/api/v1/selections", json=SAVE).status_code == 201
        slow.__exit__(None, None, None)


def test_a_file_that_cannot_be_opened_keeps_only_the_store_from_working(tmp_path: Path) -> None:
    (tmp_path / "store.sqlite3").mkdir()

    with client_of(f"sqlite:///{tmp_path}/store.sqlite3") as client:
        assert_unavailable(client.post("/api/v1/selections", json=SAVE))
        assert_unavailable(client.get("/readyz"))
        assert client.post("/api/v1/select", json=SAVE["application"]).status_code == 200


@pytest.mark.parametrize("phases", [1, SMALL_BYTES // 40])
def test_a_refusal_does_not_wait_behind_a_stuck_caller(outage: tuple[str, Outage], phases: int) -> None:
    database, broken = outage
    wrong = cycle(*[phase(1, 1)] * phases, requirements={"ratios": [6]})
    with client_of(database) as client:
        assert any(client.post("/api/v1/selections", json=SAVE).status_code == 201 for _ in range(20))  # a busy disk
        with broken():
            stuck = threading.Thread(target=client.post, args=("/api/v1/selections",), kwargs={"json": SAVE})
            stuck.start()
            time.sleep(WAIT_S / 5)
            answer = client.post("/api/v1/selections", json={"application": wrong})
            stuck.join()

    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/application/requirements/ratios/0"


def test_many_savers_wait_for_a_stuck_database_only_once(outage: tuple[str, Outage]) -> None:
    """A request that comes while a transaction is stuck does not queue behind it, to begin one of its own later.

    15 transactions begin at once, the connections of a pool. A saver that a busy machine starts late may get the place
    of one that has given up, so that a few more begin; with a queue all of them do.
    """
    database, broken = outage
    savers, begun = 200, 0

    def count(connection: Connection) -> None:
        nonlocal begun
        begun += 1

    async def main() -> list[object]:
        store = Store(database, seconds=WAIT_S)
        await store.open()
        entered, leave = threading.Event(), threading.Event()

        def hold() -> None:
            with broken():
                entered.set()
                leave.wait()

        holding = asyncio.create_task(asyncio.to_thread(hold))
        await asyncio.to_thread(entered.wait)
        event.listen(Engine, "begin", count)
        outcomes = await asyncio.gather(*(store.save(draft()) for _ in range(savers)), return_exceptions=True)
        event.remove(Engine, "begin", count)
        leave.set()
        await holding
        assert isinstance(await store.save(draft()), str)
        await store.close()
        return list(outcomes)

    outcomes = asyncio.run(main())

    assert {type(outcome) for outcome in outcomes} == {StoreUnavailableError}
    assert begun < savers / 4


def test_the_event_loop_runs_on_while_the_database_is_stuck(tmp_path: Path) -> None:
    path = tmp_path / "store.sqlite3"

    async def main() -> int:
        store = Store(f"sqlite:///{path}", seconds=WAIT_S)
        await store.open()
        turns = 0
        with sqlite_locked(path):
            saving = asyncio.create_task(store.save(draft()))
            while not saving.done():
                await asyncio.sleep(WAIT_S / 100)
                turns += 1
        assert isinstance(saving.exception(), StoreUnavailableError)
        await store.close()
        return turns

    assert asyncio.run(main()) > 10  # a blocked loop has one or two in the whole wait

"""Full disks, locked and read-only databases: what was acknowledged is found, the rest is told when to come again."""

import asyncio
import os
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import psycopg
import pytest
from starlette.testclient import TestClient

from hpn.store import Store
from tests.databases import PostgreSQL
from tests.reliability import faults
from tests.reliability.faults import SAVE, SLACK_S, WAIT_S, Outage, assert_unavailable, client_of

COME_BACK_S = 30.0
NOBODY = 65534
SHORT = ("sqlite full", "sqlite locked", "postgresql full", "postgresql read-only")
LONG = ("postgresql locked", "postgresql stopped")
MOST_SAVES = 2000
"""More than fit on a small disk."""


@pytest.fixture(params=[*SHORT, *(pytest.param(name, marks=pytest.mark.soak) for name in LONG)])
def fault(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[tuple[str, Outage]]:
    """Address of a database, and what makes it unusable for a while."""
    database, _, kind = request.param.partition(" ")
    with ExitStack() as stack:
        if database == "sqlite":
            path = tmp_path / "store.sqlite3"
            if kind == "full":
                stack.enter_context(faults.small_disk(tmp_path))
            yield f"sqlite:///{path}", lambda: faults.full(tmp_path) if kind == "full" else faults.sqlite_locked(path)
            return
        server: PostgreSQL = request.getfixturevalue("postgresql")
        if kind == "full":
            address, folder = stack.enter_context(faults.database_on_small_disk(server))
            yield address, lambda: faults.full(folder)
            return
        address = server.new_database()
        outages: dict[str, Outage] = {
            "locked": lambda: faults.postgresql_locked(address),
            "read-only": lambda: faults.postgresql_read_only(address),
            "stopped": lambda: faults.stopped(server),
        }
        yield address, outages[kind]


def save(client: TestClient, acknowledged: set[str]) -> bool:
    """True for an acknowledged save; any other answer is a 503 that says when to retry."""
    response = client.post("/api/v1/selections", json=SAVE)
    if response.status_code == 201:
        acknowledged.add(response.json()["id"])
        return True
    assert_unavailable(response)
    return False


def await_ready(client: TestClient) -> None:
    """Wait until something can be saved again."""
    end = time.monotonic() + COME_BACK_S
    while client.get("/readyz").status_code != 200:
        assert time.monotonic() < end, "it does not come back"
        time.sleep(0.1)


async def found(database: str) -> list[str]:
    """Ids of the list, page by page."""
    store, ids, cursor = Store(database), list[str](), None
    while True:
        page = await store.page(cursor=cursor, limit=200)
        ids += [summary.id for summary in page.selections]
        cursor = page.next_cursor
        if cursor is None:
            await store.close()
            return ids


def test_a_save_acknowledged_around_a_fault_is_found_and_readiness_tells_of_it(
    fault: tuple[str, Outage], soak: bool, request: pytest.FixtureRequest
) -> None:
    database, broken = fault
    acknowledged: set[str] = set()
    refused = 0
    with client_of(database) as client:
        for _ in range(20 if soak else 1):
            await_ready(client)
            for _ in range(5):
                assert save(client, acknowledged)
            with broken():
                for _ in range(MOST_SAVES):  # a full disk still has room in files that are there
                    if not save(client, acknowledged):
                        break
                else:
                    pytest.fail("the fault does not show")
                refused += 1
                time.sleep(1.1)  # after which readiness is tried anew
                start = time.monotonic()
                assert_unavailable(client.get("/readyz"))
                assert time.monotonic() - start < WAIT_S + SLACK_S
                assert client.get("/healthz").status_code == 200
                assert client.post("/api/v1/select", json=SAVE["application"]).status_code == 200
            await_ready(client)
            assert save(client, acknowledged)

    ids = asyncio.run(found(database))
    print(f"\n{request.node.callspec.id}: acknowledged {len(acknowledged)}, found {len(acknowledged & set(ids))}")
    assert acknowledged <= set(ids)
    assert len(ids) == len(set(ids))
    assert len(ids) <= len(acknowledged) + refused  # one that was refused may have been saved, but never twice


def test_room_that_trials_left_in_one_file_of_a_full_database_is_no_readiness(postgresql: PostgreSQL) -> None:
    """PostgreSQL keeps long results in a file of their own: VACUUM frees only what trials took there."""
    acknowledged: set[str] = set()
    with faults.database_on_small_disk(postgresql) as (address, folder), client_of(address) as client:
        for _ in range(5):
            await_ready(client)
            assert save(client, acknowledged)
            time.sleep(1.1)  # after which readiness is tried anew
        with psycopg.connect(address, autocommit=True) as connection:
            connection.execute("VACUUM documents")
        with faults.full(folder):
            for _ in range(5):
                while save(client, acknowledged):
                    assert len(acknowledged) < MOST_SAVES
                time.sleep(1.1)
                if (ready := client.get("/readyz")).status_code != 200:
                    assert_unavailable(ready)
                    break
                assert save(client, acknowledged)  # the server has made room meanwhile, as it does at any time
            else:
                pytest.fail("readiness does not tell of the full disk")
        await_ready(client)


@pytest.fixture
def open_folder() -> Iterator[Path]:
    """A folder that others may enter, unlike pytest's own."""
    with tempfile.TemporaryDirectory(dir="/tmp") as name:
        Path(name).chmod(0o777)
        yield Path(name)


def test_a_read_only_file_keeps_only_saving_from_working_and_it_comes_back_by_itself(open_folder: Path) -> None:
    path = open_folder / "store.sqlite3"
    database = f"sqlite:///{path}"
    acknowledged: set[str] = set()
    with client_of(database) as client:
        assert save(client, acknowledged)
    path.chmod(0o444)
    with faults.as_user(NOBODY), client_of(database) as client:
        for _ in range(2):
            assert not save(client, acknowledged)
            assert_unavailable(client.get("/readyz"))
        assert client.get("/healthz").status_code == 200
        assert client.post("/api/v1/select", json=SAVE["application"]).status_code == 200
        with faults.as_user(os.getuid()):
            for file in open_folder.iterdir():  # SQLite gives those beside it the same rights
                file.chmod(0o666)
        await_ready(client)
        assert save(client, acknowledged)

    ids = asyncio.run(found(database))
    print(f"\nread-only file: acknowledged {len(acknowledged)}, found {len(acknowledged & set(ids))}")
    assert acknowledged == set(ids)

"""Databases are brought up to date at start: once, completely, and never by a version that is too old."""

import asyncio
import multiprocessing
import os
import subprocess
import sys
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection, text

from hpn.store import NewerDatabaseError, Store, upgrade
from hpn.store.tables import metadata
from tests.store.drafts import change, draft

pytestmark = pytest.mark.anyio


async def run(store: Store, statement: str) -> None:
    await change(store, lambda connection: connection.execute(text(statement)))


async def test_the_migrations_make_the_tables_that_the_code_uses(store: Store) -> None:
    def differences(connection: Connection) -> object:
        return compare_metadata(MigrationContext.configure(connection, opts={"compare_type": True}), metadata)

    async with store._engine.connect() as connection:
        assert await connection.run_sync(differences) == []


def test_there_is_one_line_of_migrations() -> None:
    assert len(ScriptDirectory(str(upgrade.MIGRATIONS)).get_heads()) == 1


async def test_opening_again_changes_nothing(store: Store, database: str) -> None:
    id = await store.save(draft())
    again = Store(database)

    await again.open()

    assert await again.find(id) is not None
    await again.close()


async def test_a_newer_database_is_refused_and_left_alone(store: Store, database: str) -> None:
    await run(store, "UPDATE alembic_version SET version_num = '9999'")
    older = Store(database)

    with pytest.raises(NewerDatabaseError, match=r"revision 9999.*newer version"):
        await older.open()

    await older.close()
    async with store._engine.connect() as connection:
        assert (await connection.execute(text("SELECT version_num FROM alembic_version"))).scalar_one() == "9999"


async def test_the_service_refuses_to_start_on_a_newer_database_with_a_clear_text(store: Store, database: str) -> None:
    await run(store, "UPDATE alembic_version SET version_num = '9999'")
    command = [str(Path(sys.executable).with_name("hpn")), "serve", "--port", "1"]

    def serve() -> subprocess.CompletedProcess[str]:
        environment = {**os.environ, "HPN_DATABASE_URL": database}
        return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=180)

    outcome = await asyncio.to_thread(serve)

    assert outcome.returncode == 2
    assert "revision 9999" in outcome.stderr
    assert "Start that version" in outcome.stderr
    assert "Traceback" not in outcome.stderr


async def test_a_migration_that_breaks_off_leaves_nothing_behind(
    database: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def migrate_and_fail(connection: Connection) -> None:
        real(connection)
        raise OSError("broken off")

    real = upgrade._migrate
    monkeypatch.setattr(upgrade, "_migrate", migrate_and_fail)
    store = Store(database)
    with pytest.raises(Exception, match="not available"):
        await store.open()
    monkeypatch.undo()

    await store.open()

    assert await store.find(await store.save(draft())) is not None
    await store.close()


def _open_and_save(database: str, barrier: "multiprocessing.synchronize.Barrier") -> None:
    async def main() -> None:
        store = Store(database, seconds=20)
        barrier.wait(180)
        await store.open()
        await store.save(draft(idempotency_key="the same"))
        await store.save(draft())
        await store.close()

    asyncio.run(main())


def test_many_workers_can_start_at_once_on_an_empty_database(database: str) -> None:
    context = multiprocessing.get_context("spawn")
    barrier = context.Barrier(4)
    workers = [context.Process(target=_open_and_save, args=(database, barrier)) for _ in range(4)]

    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join(240)

    assert [worker.exitcode for worker in workers] == [0, 0, 0, 0]

    async def rows() -> int:
        store = Store(database)
        page = await store.page()
        await store.close()
        return len(page.selections)

    assert asyncio.run(rows()) == 5  # one each, and one for the key that all had

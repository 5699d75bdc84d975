"""Engine for the address of a database: SQLite in write-ahead mode, or PostgreSQL."""

import os
import sqlite3
from collections.abc import Sequence
from contextlib import closing, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from sqlalchemy import URL, Connection, event, make_url
from sqlalchemy.exc import ArgumentError
from sqlalchemy.ext.asyncio import AsyncEngine, create_async_engine

from hpn.installed import require
from hpn.store.errors import StoreError

WRITES = {"writes": True}
"""Execution options of transactions that write: on SQLite they take the write lock when they begin."""


def make_engine(address: str, *, seconds: float, password: str | None = None) -> AsyncEngine:
    """Engine for `sqlite:///file` or `postgresql://user:password@host/database`; it connects at its first use.

    `seconds` is the longest wait for a connection or for another writer's lock. `password` is the password of the
    database's user, of any characters; in the address some characters need an escape such as %40.
    """
    try:
        url = make_url(address)
    except ArgumentError:
        url = make_url("none://")  # the text may hold a password, so it is not repeated
    backend = url.get_backend_name()
    if backend == "sqlite" and url.database not in (None, "", ":memory:"):
        return _sqlite(url, seconds)
    if backend in ("postgresql", "postgres"):
        return _postgresql(url if password is None else url.set(password=password), seconds)
    raise StoreError(
        "HPN_DATABASE_URL must be sqlite:///file.sqlite3 (four slashes for an absolute path) "
        "or postgresql://user:password@host/database"
    )


def _postgresql(url: URL, seconds: float) -> AsyncEngine:
    require("postgres")
    return create_async_engine(
        url.set(drivername="postgresql+psycopg"),
        hide_parameters=True,
        pool_pre_ping=True,
        pool_timeout=seconds,
        connect_args={
            "connect_timeout": max(2, round(seconds)),
            "tcp_user_timeout": round(seconds * 1000),
            "application_name": "hpn-select",
        },
    )


def _sqlite(url: URL, seconds: float) -> AsyncEngine:
    assert url.database is not None
    _create(Path(url.database).absolute())
    engine = create_async_engine(
        url.set(drivername="sqlite+aiosqlite"),
        hide_parameters=True,  # errors are logged, and parameters must not be
        pool_timeout=seconds,
        connect_args={"timeout": seconds},
    )
    event.listen(engine.sync_engine, "do_connect", _try)
    event.listen(engine.sync_engine, "connect", _prepare)
    event.listen(engine.sync_engine, "begin", _begin)
    return engine


def _create(file: Path) -> None:
    """Make an empty database in write-ahead mode where there is none; the file appears under its name when it is
    complete.

    Where several connections change the mode at once, SQLite fails all but one without waiting.
    """
    file.parent.mkdir(parents=True, exist_ok=True)
    if file.exists() or not os.access(file.parent, os.W_OK):  # in a read-only folder the connection raises the error
        return
    with TemporaryDirectory(dir=file.parent, prefix=f".{file.name}-") as folder:
        new = Path(folder, file.name)
        with closing(sqlite3.connect(new)) as connection:
            connection.execute("PRAGMA journal_mode=WAL")
            connection.execute("PRAGMA user_version=0")  # writes the first page, which keeps the mode
        with suppress(FileExistsError):  # another process was first
            os.link(new, file)


def _try(dialect: object, record: object, arguments: Sequence[Any], options: object) -> None:
    """Raise the error of a file that can't be opened: the thread of a connection that fails would report its end to the
    event loop, which may be closed by then."""
    sqlite3.connect(arguments[0]).close()


def _prepare(connection: Any, record: object) -> None:
    """Set up a connection: readers never wait for the writer, and a commit is on disk before it returns."""
    connection.isolation_level = None  # `_begin` begins transactions, not the driver
    cursor = connection.cursor()
    for pragma in ("journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON"):
        cursor.execute(f"PRAGMA {pragma}")
    cursor.close()


def _begin(connection: Connection) -> None:
    """Begin a transaction; one that writes takes the write lock now: taking it later can fail without waiting."""
    writes = connection.get_execution_options().get("writes", False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")

"""From an address to an engine: SQLite in write-ahead mode, or PostgreSQL."""

from pathlib import Path
from typing import Any

from sqlalchemy import URL, Connection, Engine, create_engine, event, make_url
from sqlalchemy.exc import ArgumentError
from sqlalchemy.ext.asyncio import AsyncEngine, create_async_engine

from hpn.store.errors import StoreError
from hpn.store.transactions import OnLoop, OnThread, Transactions

WRITES = {"writes": True}
"""Execution options of an engine whose transactions write from their start."""


def make_engine(address: str, *, seconds: float) -> AsyncEngine:
    """Engine for `sqlite:///file` or `postgresql://user:password@host/database`; connects when it is first used.

    `seconds` is the longest wait for a connection or for another writer's lock.
    """
    try:
        url = make_url(address)
    except ArgumentError:
        url = make_url("none://")  # the text may hold a password, so it is not repeated
    backend = url.get_backend_name()
    if backend == "sqlite" and url.database not in (None, "", ":memory:"):
        return _sqlite(url, seconds)
    if backend in ("postgresql", "postgres"):
        return _postgresql(url, seconds)
    raise StoreError(
        "HPN_DATABASE_URL must be sqlite:///file.sqlite3 (four slashes for an absolute path) "
        "or postgresql://user:password@host/database"
    )


def _postgresql(url: URL, seconds: float) -> AsyncEngine:
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
    Path(url.database).absolute().parent.mkdir(parents=True, exist_ok=True)
    engine = create_async_engine(
        url.set(drivername="sqlite+aiosqlite"),
        hide_parameters=True,  # errors are logged, and what was asked is not
        pool_timeout=seconds,
        connect_args={"timeout": seconds},
    )
    _listen(engine.sync_engine)
    return engine


def make_transactions(engine: AsyncEngine, *, seconds: float) -> Transactions:
    """Transactions that write from their start, on the database of an engine."""
    if engine.dialect.name != "sqlite":
        return OnLoop(engine.execution_options(**WRITES))
    own = create_engine(
        engine.url.set(drivername="sqlite+pysqlite"),
        hide_parameters=True,
        pool_size=1,
        connect_args={"timeout": seconds},
    )
    _listen(own)
    return OnThread(own.execution_options(**WRITES))


def _listen(engine: Engine) -> None:
    event.listen(engine, "connect", _prepare)
    event.listen(engine, "begin", _begin)


def _prepare(connection: Any, record: object) -> None:
    """Readers never wait for the writer, and a commit is on disk before it returns."""
    connection.isolation_level = None  # `_begin` begins transactions, not the driver
    cursor = connection.cursor()
    for pragma in ("journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON"):
        cursor.execute(f"PRAGMA {pragma}")
    cursor.close()


def _begin(connection: Connection) -> None:
    """Take the write lock at once where the transaction will write: to take it later can fail without waiting."""
    options = connection.get_execution_options()
    if options.get("begins", True):
        connection.exec_driver_sql("BEGIN IMMEDIATE" if options.get("writes", False) else "BEGIN")

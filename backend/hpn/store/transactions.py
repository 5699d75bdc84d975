"""Where the store's transactions run: on a thread of their own for SQLite, on the event loop for PostgreSQL."""

import asyncio
import logging
import sqlite3
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Protocol, TypeVar, cast

from sqlalchemy import Connection, Engine
from sqlalchemy.ext.asyncio import AsyncEngine

logger = logging.getLogger(__name__)

CHANGES_IN_LOG = 64
"""Changed rows after which the write-ahead log is put into its place, far fewer than SQLite waits for by itself."""

T = TypeVar("T")
Work = Callable[[Connection], T]


class Transactions(Protocol):
    """Runs work in one transaction each; what has returned is durable."""

    engine: Engine

    async def run(self, work: Work[T], *, one_statement: bool = False) -> T:
        """Result of the work, once its transaction is committed; one statement may be a transaction by itself."""

    async def close(self) -> None:
        """Close the connections; the next work opens new ones."""


class OnThread:
    """One thread for all that a process writes: SQLite has one writer at a time anyway.

    A whole transaction costs one hand-over between threads. With a driver for the event loop each statement does, and
    beside a busy loop every hand-over costs as much as the statement. The write-ahead log is put into its place between
    transactions: SQLite would do it at the end of one, while everybody waits.
    """

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self._thread: ThreadPoolExecutor | None = None
        self._connection: Connection | None = None
        self._changes = self._counted = 0

    async def run(self, work: Work[T], *, one_statement: bool = False) -> T:
        """See Transactions. Work that has begun goes on when nobody waits for it any more."""
        if self._thread is None:
            self._thread = ThreadPoolExecutor(1, thread_name_prefix="hpn-store")
        result = await asyncio.get_running_loop().run_in_executor(self._thread, self._transact, work, one_statement)
        if self._changes >= CHANGES_IN_LOG and self._thread is not None:
            self._thread.submit(self._put_log_in_place)
        return result

    def _transact(self, work: Work[T], one_statement: bool) -> T:
        if self._connection is None:
            self._connection, self._counted = self.engine.connect(), 0
        try:
            with self._connection.execution_options(begins=not one_statement).begin():
                result = work(self._connection)
        except BaseException:
            self._disconnect()
            raise
        self._changes = self._driver.total_changes - self._counted
        return result

    @property
    def _driver(self) -> sqlite3.Connection:
        assert self._connection is not None
        return cast(sqlite3.Connection, self._connection.connection.driver_connection)

    def _put_log_in_place(self) -> None:
        if self._connection is None:
            return
        try:
            self._changes, self._counted = 0, self._driver.total_changes
            self._driver.execute("PRAGMA wal_checkpoint(PASSIVE)").fetchall()
        except sqlite3.Error as error:  # nothing is lost: it stays in the log, and SQLite tries again
            logger.warning("the write-ahead log can't be put into its place: %s", error)

    def _disconnect(self) -> None:
        if self._connection is not None:
            self._connection.close()
        self._connection = None
        self.engine.dispose()

    async def close(self) -> None:
        """See Transactions."""
        thread, self._thread = self._thread, None
        if thread is not None:
            await asyncio.get_running_loop().run_in_executor(thread, self._disconnect)
            thread.shutdown(wait=False)


class OnLoop:
    """Transactions of an engine for the event loop; who gives up waiting breaks them off."""

    def __init__(self, engine: AsyncEngine) -> None:
        self.engine = engine.sync_engine
        self._engine = engine

    async def run(self, work: Work[T], *, one_statement: bool = False) -> T:
        """See Transactions."""
        async with self._engine.begin() as connection:
            return await connection.run_sync(work)

    async def close(self) -> None:
        """See Transactions."""
        await self._engine.dispose()

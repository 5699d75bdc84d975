"""Transactions on the database of a store, each within a time limit; every failure is raised as a StoreError."""

import asyncio
import logging
import sqlite3
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from typing import TypeVar

from sqlalchemy.exc import DBAPIError, SQLAlchemyError
from sqlalchemy.ext.asyncio import AsyncConnection

from hpn.store.engine import WRITES, make_engine
from hpn.store.errors import NewerDatabaseError, StoreFullError, StoreUnavailableError
from hpn.store.upgrade import bring_up_to_date

logger = logging.getLogger(__name__)
T = TypeVar("T")

DISK_FULL = "53100"
"""SQLSTATE of PostgreSQL for a full disk."""
SNAPSHOT = {"isolation_level": "REPEATABLE READ"}
"""Execution options of reads on PostgreSQL, where else each query sees the newest state; SQLite needs none."""

UNAVAILABLE = "saved selections are temporarily unavailable"


class Transactions:
    """Database that opens at first need, and its transactions.

    Every function raises StoreUnavailableError where the database can't be reached or takes longer than `seconds`, and
    works again as soon as the database does; StoreFullError where a disk is full.
    """

    def __init__(self, address: str, *, seconds: float = 5.0, password: str | None = None) -> None:
        # A busy database gives up by itself, just before this limit.
        self._engine = make_engine(address, seconds=seconds * 0.8, password=password)
        self._seconds = seconds
        self._turn = asyncio.Lock()
        self._opening: asyncio.Task[None] | None = None

    async def open(self) -> None:
        """Upgrade the database, however long that takes; a second call costs nothing."""
        if self._opening is None or (self._opening.done() and self._failed_to_open()):
            self._opening = asyncio.create_task(bring_up_to_date(self._engine))
        try:
            # The upgrade serves all waiting callers: a caller that gives up must not cancel it.
            await asyncio.shield(self._opening)
        except (SQLAlchemyError, OSError) as error:
            raise _unavailable(error) from error

    def _failed_to_open(self) -> bool:
        assert self._opening is not None
        return self._opening.cancelled() or self._opening.exception() is not None

    async def close(self) -> None:
        """Close the connections; the next call opens new ones. SQLite finishes its current write first."""
        if self._opening is not None:
            self._opening.cancel()
        async with self._turn:
            await self._engine.dispose()

    @asynccontextmanager
    async def _reachable(self) -> AsyncIterator[None]:
        """Limit the time of the block, and raise every failure of the database as StoreUnavailableError."""
        try:
            async with asyncio.timeout(self._seconds):
                await self.open()
                yield
        except (SQLAlchemyError, OSError, NewerDatabaseError) as error:  # OSError: TimeoutError too
            raise _unavailable(error) from error

    @asynccontextmanager
    async def _reading(self) -> AsyncIterator[AsyncConnection]:
        """Connection for queries that all see one state, even while others write."""
        options = {} if self._engine.dialect.name == "sqlite" else SNAPSHOT
        async with self._reachable(), self._engine.execution_options(**options).connect() as connection:
            yield connection

    async def _write(self, work: Callable[[AsyncConnection], Awaitable[T]]) -> T:
        """Result of the work, once its transaction is on disk; it is rolled back where the work raises.

        On PostgreSQL a caller that stops waiting cancels the transaction. SQLite has one writer at a time: writers of
        this process take turns, and wait in SQLite only for other processes. A transaction that has begun in SQLite
        runs to its end even if no caller waits any more: a cancelled one may leave the database locked by the driver.
        """
        async with self._reachable():
            if self._engine.dialect.name != "sqlite":
                return await self._transact(work)
            await self._turn.acquire()
            transaction = asyncio.create_task(self._transact(work))
            transaction.add_done_callback(lambda _: self._turn.release())
            return await asyncio.shield(transaction)

    async def _transact(self, work: Callable[[AsyncConnection], Awaitable[T]]) -> T:
        async with self._engine.execution_options(**WRITES).connect() as connection:
            try:
                async with connection.begin():
                    return await work(connection)
            except DBAPIError as error:
                # A connection may stay faulty, for instance read-only; the next one is new.
                await connection.invalidate()
                if getattr(error.orig, "sqlite_errorcode", 0) & 0xFF == sqlite3.SQLITE_READONLY:
                    await self._engine.dispose()  # all connections of a process share SQLite's knowledge of the file
                raise


def _unavailable(error: Exception) -> StoreUnavailableError:
    cause = (error.orig if isinstance(error, DBAPIError) else None) or error
    logger.warning("the store is not available: %s: %s", type(cause).__name__, " ".join(str(cause).split()))
    return StoreFullError() if _is_of_full_disk(error) else StoreUnavailableError(UNAVAILABLE)


def _is_of_full_disk(error: Exception) -> bool:
    cause = error.orig if isinstance(error, DBAPIError) else None
    return (
        getattr(cause, "sqlite_errorcode", None) == sqlite3.SQLITE_FULL or getattr(cause, "sqlstate", None) == DISK_FULL
    )

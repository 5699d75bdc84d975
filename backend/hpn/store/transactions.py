"""Transactions on the database of a store, each within a time limit; whatever fails in it, fails as a StoreError."""

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
"""State of an error by which PostgreSQL says that."""
SNAPSHOT = {"isolation_level": "REPEATABLE READ"}
"""Execution options of reads on PostgreSQL, where each query else sees what is newest; on SQLite there is no other."""

UNAVAILABLE = "saved selections are temporarily unavailable"


class Transactions:
    """A database that is opened when it is first needed, and what is done in it.

    Every function raises StoreUnavailableError where the database can't be reached or takes longer than `seconds`, and
    works again as soon as it can; StoreFullError where a disk is full.
    """

    def __init__(self, address: str, *, seconds: float = 5.0, password: str | None = None) -> None:
        # A database that is only busy gives up by itself, just before we would.
        self._engine = make_engine(address, seconds=seconds * 0.8, password=password)
        self._seconds = seconds
        self._turn = asyncio.Lock()
        self._opening: asyncio.Task[None] | None = None

    async def open(self) -> None:
        """Bring the database up to date, however long it takes; once done, this costs nothing.

        Raises NewerDatabaseError, for good, where a newer version has changed the database.
        """
        if self._opening is None or (self._opening.done() and self._failed_to_open()):
            self._opening = asyncio.create_task(bring_up_to_date(self._engine))
        try:
            # The work belongs to all who wait for it: one who gives up must not cancel it.
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
        """Limits what happens inside in time, and says of every failure of the database that it is one."""
        try:
            async with asyncio.timeout(self._seconds):
                await self.open()
                yield
        except (SQLAlchemyError, OSError, NewerDatabaseError) as error:  # OSError: TimeoutError too
            raise _unavailable(error) from error

    @asynccontextmanager
    async def _reading(self) -> AsyncIterator[AsyncConnection]:
        """Connection whose queries all see the same state, whatever is written between them."""
        options = {} if self._engine.dialect.name == "sqlite" else SNAPSHOT
        async with self._reachable(), self._engine.execution_options(**options).connect() as connection:
            yield connection

    async def _write(self, work: Callable[[AsyncConnection], Awaitable[T]]) -> T:
        """Result of the work, once its transaction is on disk; it is rolled back where the work raises.

        On PostgreSQL a caller that stops waiting cancels the transaction. SQLite has one writer at a time: those of
        this process take turns, and wait in SQLite only for other processes. There a transaction that has begun runs to
        its end even if nobody waits for it any more: if it is cancelled, the driver may leave the database locked.
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
                # A connection may keep what is wrong, such as that the database is read-only; the next one is new.
                await connection.invalidate()
                if getattr(error.orig, "sqlite_errorcode", 0) & 0xFF == sqlite3.SQLITE_READONLY:
                    await self._engine.dispose()  # all of a process share what SQLite knows of the file
                raise


def _unavailable(error: Exception) -> StoreUnavailableError:
    logger.warning("the store is not available: %s: %s", type(error).__name__, error)
    return StoreFullError() if _is_of_full_disk(error) else StoreUnavailableError(UNAVAILABLE)


def _is_of_full_disk(error: Exception) -> bool:
    cause = error.orig if isinstance(error, DBAPIError) else None
    return (
        getattr(cause, "sqlite_errorcode", None) == sqlite3.SQLITE_FULL or getattr(cause, "sqlstate", None) == DISK_FULL
    )

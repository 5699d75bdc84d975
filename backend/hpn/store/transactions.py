"""Where the store's transactions run: on a thread of their own for SQLite, on the event loop for PostgreSQL."""

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Protocol, TypeVar

from sqlalchemy import Connection, Engine
from sqlalchemy.ext.asyncio import AsyncEngine

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
    beside a busy loop every hand-over costs as much as the statement.
    """

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self._thread: ThreadPoolExecutor | None = None
        self._connection: Connection | None = None

    async def run(self, work: Work[T], *, one_statement: bool = False) -> T:
        """See Transactions. Work that has begun goes on when nobody waits for it any more."""
        if self._thread is None:
            self._thread = ThreadPoolExecutor(1, thread_name_prefix="hpn-store")
        return await asyncio.get_running_loop().run_in_executor(self._thread, self._transact, work, one_statement)

    def _transact(self, work: Work[T], one_statement: bool) -> T:
        if self._connection is None:
            self._connection = self.engine.connect()
        try:
            with self._connection.execution_options(begins=not one_statement).begin():
                return work(self._connection)
        except BaseException:
            self._disconnect()
            raise

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

"""The store: a few functions over a database, each within a time limit."""

import asyncio
import base64
import logging
import re
import sqlite3
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from contextlib import asynccontextmanager
from datetime import UTC, datetime
from typing import TypeVar

import brotli
from sqlalchemy import select, tuple_
from sqlalchemy.exc import DBAPIError, SQLAlchemyError
from sqlalchemy.ext.asyncio import AsyncConnection

from hpn.catalogue import Catalogue
from hpn.catalogue.copy import UnreadableCopyError, read_copy
from hpn.store.engine import WRITES, make_engine
from hpn.store.errors import NewerDatabaseError, StoreError, StoreFullError, StoreUnavailableError
from hpn.store.fleets import (
    FleetDraft,
    FleetSummary,
    SavedFleet,
    insert_fleet,
    name_fleet,
    read_fleet,
    read_fleets,
    remove_fleet,
    rename_fleet,
    require_room,
)
from hpn.store.rehearsal import rehearse
from hpn.store.saved import Draft, Page, SavedSelection, Summary, search_text, unpacked
from hpn.store.tables import catalogues, selections
from hpn.store.upgrade import bring_up_to_date, missing_parts
from hpn.store.writing import insert, remove, rename

logger = logging.getLogger(__name__)
T = TypeVar("T")

TRIAL_SECONDS = 1.0
DISK_FULL = "53100"
"""State of an error by which PostgreSQL says that."""
UNAVAILABLE = "saved selections are temporarily unavailable"

ID = re.compile(r"[A-Za-z0-9_-]{22}")
"""An id: 128 random bits."""

SUMMARY = [selections.c[name] for name in Summary.__dataclass_fields__]


class Store:
    """Saved selections. A selection is durable once `save` has returned; only its title and reference can be changed.

    Every function raises StoreUnavailableError where the database can't be reached or takes longer than `seconds`, and
    works again as soon as it can; StoreFullError where a disk is full. Nothing is connected before it is needed.
    """

    def __init__(self, address: str, *, seconds: float = 5.0, password: str | None = None) -> None:
        # A database that is only busy gives up by itself, just before we would.
        self._engine = make_engine(address, seconds=seconds * 0.8, password=password)
        self._seconds = seconds
        self._turn = asyncio.Lock()
        self._opening: asyncio.Task[None] | None = None
        self._trial: asyncio.Task[StoreUnavailableError | None] | None = None
        self._next_trial = 0.0

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
        for task in (self._opening, self._trial):
            if task is not None:
                task.cancel()
        async with self._turn:
            await self._engine.dispose()

    async def check(self, catalogue: Catalogue | None = None) -> None:
        """Raise StoreUnavailableError unless something could be saved now, under a catalogue where one is given.

        That is tried, at most once in TRIAL_SECONDS; who asks in between gets the same answer.
        """
        now = time.monotonic()
        if self._trial is None or (self._trial.done() and now >= self._next_trial):
            self._next_trial = now + TRIAL_SECONDS
            self._trial = asyncio.create_task(self._try_saving(catalogue))
        if failed := await asyncio.shield(self._trial):
            raise failed.with_traceback(None)  # of the trial, which all who ask share

    async def _try_saving(self, catalogue: Catalogue | None) -> StoreUnavailableError | None:
        try:
            await self._write(lambda connection: rehearse(connection, catalogue))
        except StoreUnavailableError as error:
            return error
        return None

    async def require_complete(self) -> None:
        """Raise StoreError where the database lacks a table, column or index of this version."""
        async with self._reading() as connection:
            missing = await connection.run_sync(missing_parts)
        if missing:
            raise StoreError(f"the database lacks {', '.join(missing)}: it is damaged, or not one of HPN Select")

    async def save(self, draft: Draft) -> str:
        """Id of the saved selection: a new one, or the one that the same idempotency key has saved before.

        Raises KeyReusedError where the key came with other content, and KeySpentError where its selection was deleted.
        A caller that stops waiting does not know whether it is saved; the same key finds that out.
        """
        return await self._write(lambda connection: insert(connection, draft))

    async def find(self, id: str) -> SavedSelection | None:
        """The selection with this id, or None."""
        if not ID.fullmatch(id):
            return None
        columns = [*SUMMARY, selections.c.owner, selections.c.application, selections.c.result_packed]
        async with self._reading() as connection:
            row = (await connection.execute(select(*columns).where(selections.c.id == id))).one_or_none()
        if row is None:
            return None
        fields = row._asdict()
        application, result = fields.pop("application"), fields.pop("result_packed")
        return SavedSelection(**fields, application=application.encode(), result=unpacked(result))

    async def catalogue(self, version: str) -> Catalogue | None:
        """The catalogue that selections were saved under; None where no copy of it was kept, or none we can read."""
        query = select(catalogues.c.content_brotli).where(catalogues.c.version == version)
        async with self._reading() as connection:
            packed = (await connection.execute(query)).scalar_one_or_none()
        try:
            return None if packed is None else read_copy(brotli.decompress(packed))
        except (UnreadableCopyError, brotli.error) as error:
            logger.warning("catalogue %s: %s", version, error)
            return None

    async def page(
        self, *, reference: str | None = None, search: str | None = None, cursor: str | None = None, limit: int = 50
    ) -> Page:
        """Saved selections, newest first: all, those of a reference, or those that have every word of a search.

        Words are found in title, reference, author, gear and ordering code, in any case. ValueError for a cursor that
        isn't one.
        """
        c = selections.c
        query = select(*SUMMARY).order_by(c.created.desc(), c.id.desc()).limit(limit + 1)
        if reference is not None:
            query = query.where(c.reference == reference)
        for word in search_text(search).split():
            query = query.where(c.search_text.contains(word, autoescape=True))
        if cursor is not None:
            query = query.where(tuple_(c.created, c.id) < tuple_(*_position(cursor)))
        async with self._reading() as connection:
            found = [Summary(*row) for row in await connection.execute(query)]
        more = len(found) > limit
        return Page(found[:limit], _cursor(found[limit - 1].created, found[limit - 1].id) if more else None)

    async def rename(self, id: str, names: Mapping[str, str | None], version: int | None = None) -> bool:
        """Give a selection another `title` or `reference`, or both; False where there is none with this id.

        With a version, False also where it has been changed since: of those who saw one version, one can change it.
        """
        return bool(ID.fullmatch(id)) and await self._write(lambda connection: rename(connection, id, names, version))

    async def delete(self, id: str, version: int | None = None) -> bool:
        """Delete a selection; False as `rename`."""
        return bool(ID.fullmatch(id)) and await self._write(lambda connection: remove(connection, id, version))

    # --- Fleets -------------------------------------------------------------------------------------------------------

    async def require_room(self, caller: str, most_bytes: int) -> None:
        """Raise what `keep_fleet` would, before a fleet is calculated."""
        async with self._reading() as connection:
            await require_room(connection, caller, most_bytes)

    async def keep_fleet(self, draft: FleetDraft, most_bytes: int) -> str:
        """Id of a calculated fleet, which is kept for a day.

        Raises ShareSpentError where its caller has as many as one may have, and NoRoomError where this one would take
        all that nobody has saved beyond so many bytes; none goes before its day to make room.
        """
        return await self._write(lambda connection: insert_fleet(connection, draft, most_bytes))

    async def save_fleet(self, id: str, names: Mapping[str, str | None], owner: str | None) -> bool:
        """Keep a calculated fleet for good, with title, reference, author and revision; False where there is none."""
        return bool(ID.fullmatch(id)) and await self._write(lambda connection: name_fleet(connection, id, names, owner))

    async def rename_fleet(self, id: str, names: Mapping[str, str | None], version: int | None = None) -> bool:
        """Give a saved fleet another `title` or `reference`, or both; False as `rename`."""
        return bool(ID.fullmatch(id)) and await self._write(
            lambda connection: rename_fleet(connection, id, names, version)
        )

    async def find_fleet(self, id: str) -> SavedFleet | None:
        """The fleet with this id, saved or calculated not long ago, or None."""
        if not ID.fullmatch(id):
            return None
        async with self._reading() as connection:
            return await read_fleet(connection, id)

    async def fleets(self, cursor: str | None = None, limit: int = 50) -> tuple[list[FleetSummary], str | None]:
        """Saved fleets, newest first, and a cursor to those that follow; ValueError for one that isn't."""
        before = None if cursor is None else _position(cursor)
        async with self._reading() as connection:
            found = await read_fleets(connection, before, limit + 1)
        if len(found) <= limit:
            return found, None
        last = found[limit - 1]
        return found[:limit], _cursor(last.saved or last.created, last.id)

    async def delete_fleet(self, id: str, version: int | None = None) -> bool:
        """Delete a fleet; False as `rename`."""
        return bool(ID.fullmatch(id)) and await self._write(lambda connection: remove_fleet(connection, id, version))

    # --- Transactions -------------------------------------------------------------------------------------------------

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
        async with self._reachable(), self._engine.connect() as connection:
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


def _cursor(moment: datetime, id: str) -> str:
    return base64.urlsafe_b64encode(f"{moment.isoformat()} {id}".encode()).decode()


def _position(cursor: str) -> tuple[datetime, str]:
    try:
        created, _, id = base64.urlsafe_b64decode(cursor.encode()).decode().partition(" ")
        if not ID.fullmatch(id):
            raise ValueError
        return datetime.fromisoformat(created).astimezone(UTC), id
    except (ValueError, OverflowError):
        raise ValueError("is not a cursor that this list has given") from None

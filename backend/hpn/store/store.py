"""The store: a few functions over a database, each within a time limit."""

import asyncio
import base64
import logging
import re
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from datetime import UTC, datetime
from typing import Any

import brotli
from sqlalchemy import select, text, tuple_
from sqlalchemy.exc import DataError, SQLAlchemyError
from sqlalchemy.ext.asyncio import AsyncConnection

from hpn.catalogue import Catalogue
from hpn.catalogue.copy import UnreadableCopyError, read_copy
from hpn.store.engine import make_engine, make_transactions
from hpn.store.errors import NewerDatabaseError, StoreUnavailableError
from hpn.store.inserting import Outcome, insert, insertion_of, remove
from hpn.store.packing import unpacked
from hpn.store.saved import Draft, Page, SavedSelection, Summary
from hpn.store.tables import catalogues, selections
from hpn.store.upgrade import bring_up_to_date
from hpn.store.writer import Make, Writer

logger = logging.getLogger(__name__)

ID = re.compile(r"[A-Za-z0-9_-]{22}")
"""An id: 128 random bits."""

SUMMARY = [selections.c[name] for name in Summary.__dataclass_fields__]


class Store:
    """Saved selections. What `save` has returned is durable, and nothing is ever rewritten.

    Every function raises StoreUnavailableError where the database can't be reached or takes longer than `seconds`, and
    works again as soon as it can. Nothing is connected before it is needed. `make` makes drafts of what is to be saved,
    where those are not drafts already.
    """

    def __init__(self, address: str, *, seconds: float = 5.0, make: Make = list) -> None:
        # A database that is only busy gives up by itself, just before we would.
        self._engine = make_engine(address, seconds=seconds * 0.8)
        self._transactions = make_transactions(self._engine, seconds=seconds * 0.8)
        self._seconds = seconds
        self._writer = Writer(make, self._commit)
        self._opening: asyncio.Task[None] | None = None
        self._kept: set[str] = set()  # versions of catalogues that the database has for sure

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
        """Save what still waits, and close the connections."""
        await self._writer.finish()
        if self._opening is not None:
            self._opening.cancel()
        await self._transactions.close()
        await self._engine.dispose()

    async def check(self) -> None:
        """Raise StoreUnavailableError unless the database answers."""
        async with self._reading() as connection:
            await connection.execute(text("SELECT 1"))

    async def save(self, wanted: Any) -> str:
        """Id of the saved selection: a new one, or the one that the same idempotency key has saved before.

        Raises why there is no draft of it, KeyReusedError where the key came with other content, and KeySpentError
        where what it saved was deleted.
        """
        return await self._writer.save(wanted)

    async def find(self, id: str) -> SavedSelection | None:
        """The selection with this id, or None."""
        if not ID.fullmatch(id):
            return None
        columns = [*SUMMARY, selections.c.application, selections.c.result_packed]
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

    async def page(self, *, reference: str | None = None, cursor: str | None = None, limit: int = 50) -> Page:
        """Saved selections, newest first, all or those of a reference; ValueError for a cursor that isn't one."""
        c = selections.c
        query = select(*SUMMARY).order_by(c.created.desc(), c.id.desc()).limit(limit + 1)
        if reference is not None:
            query = query.where(c.reference == reference)
        if cursor is not None:
            query = query.where(tuple_(c.created, c.id) < tuple_(*_position(cursor)))
        async with self._reading() as connection:
            found = [Summary(*row) for row in await connection.execute(query)]
        more = len(found) > limit
        return Page(found[:limit], _cursor(found[limit - 1]) if more else None)

    async def delete(self, id: str) -> bool:
        """Delete a selection; False where there is none with this id."""
        if not ID.fullmatch(id):
            return False
        async with self._reachable():
            return await self._transactions.run(lambda connection: remove(connection, id))

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

    async def _commit(self, drafts: Sequence[Draft]) -> list[Outcome]:
        """Save drafts in one transaction: an id for each, or why it has none."""
        insertion = insertion_of(drafts, self._engine.dialect)
        used = {draft.catalogue_version: draft.catalogue for draft in drafts}
        new = {version: book for version, book in used.items() if book is not None and version not in self._kept}
        try:
            async with self._reachable():
                outcomes = await self._transactions.run(
                    lambda connection: insert(connection, insertion, new),
                    one_statement=not new and not any(draft.idempotency_key for draft in drafts),
                )
        except StoreUnavailableError as error:
            self._kept.clear()  # the database that comes back may be one from a backup
            if len(drafts) == 1 or not isinstance(error.__cause__, DataError):
                raise
            # One selection that the database can't hold must not fail its neighbours.
            return [await self._commit_alone(draft) for draft in drafts]
        self._kept |= new.keys()
        return outcomes

    async def _commit_alone(self, draft: Draft) -> Outcome:
        try:
            return (await self._commit([draft]))[0]
        except StoreUnavailableError as error:
            return error


def _unavailable(error: Exception) -> StoreUnavailableError:
    logger.warning("the store is not available: %s: %s", type(error).__name__, error)
    return StoreUnavailableError("saved selections are not available at the moment")


def _cursor(last: Summary) -> str:
    return base64.urlsafe_b64encode(f"{last.created.isoformat()} {last.id}".encode()).decode()


def _position(cursor: str) -> tuple[datetime, str]:
    try:
        created, _, id = base64.urlsafe_b64decode(cursor.encode()).decode().partition(" ")
        if not ID.fullmatch(id):
            raise ValueError
        return datetime.fromisoformat(created).astimezone(UTC), id
    except (ValueError, OverflowError):
        raise ValueError("is not a cursor that this list has given") from None

"""Statements of a transaction that saves, renames or deletes."""

import asyncio
import hashlib
from collections.abc import Mapping
from datetime import UTC, datetime
from types import SimpleNamespace
from typing import Any

import brotli
from sqlalchemy import ColumnElement, Table, delete, select, update
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.ext.asyncio import AsyncConnection

from hpn.catalogue import Catalogue
from hpn.catalogue.copy import copy_of
from hpn.store.errors import KeyReusedError, KeySpentError
from hpn.store.saved import Draft, packed, search_text
from hpn.store.tables import catalogues, selections, spent_keys


async def insert(connection: AsyncConnection, draft: Draft) -> str:
    """Id of the new selection, or of the one that the same idempotency key has saved before.

    Raises KeyReusedError and KeySpentError; the caller then rolls the transaction back.
    """
    if draft.catalogue is not None:
        await _keep_catalogue(connection, draft.catalogue_version, draft.catalogue)
    await _insert_new(connection, selections, _row_of(draft))
    if draft.idempotency_key is None:
        return draft.id
    # After the insertion, which has waited for any other transaction that had this key in hand.
    return await _holder(connection, draft.idempotency_key, draft.digest)


def _row_of(draft: Draft) -> dict[str, Any]:
    return {
        "id": draft.id,
        "created": datetime.now(UTC),
        "title": draft.title,
        "reference": draft.reference,
        "selected": draft.selected,
        "engine_version": draft.engine_version,
        "catalogue_version": draft.catalogue_version,
        "application": draft.application.decode(),
        "result_packed": packed(draft.result),
        "idempotency_key": draft.idempotency_key,
        "digest": draft.digest if draft.idempotency_key else None,
        "owner": draft.owner,
        "author": draft.author,
        "revision": draft.revision,
        "ordering_code": draft.ordering_code,
        "designation": draft.designation,
        "status": draft.status,
        "utilisation": draft.utilisation,
        "search_text": _search_text(draft),
    }


def _search_text(named: Any) -> str:
    """Columns by which a selection is found, by their names."""
    return search_text(named.title, named.reference, named.author, named.ordering_code, named.designation)


async def _insert_new(connection: AsyncConnection, table: Table, *rows: dict[str, Any]) -> None:
    """Insert rows unless those with the same unique key are there; SQLAlchemy has this for each database apart."""
    dialect = sqlite if connection.dialect.name == "sqlite" else postgresql
    await connection.execute(dialect.insert(table).values(rows).on_conflict_do_nothing())


async def _keep_catalogue(connection: AsyncConnection, version: str, catalogue: Catalogue) -> None:
    known = select(catalogues.c.version).where(catalogues.c.version == version)
    if (await connection.execute(known)).one_or_none() is None:
        content = await asyncio.to_thread(lambda: brotli.compress(copy_of(catalogue)))
        await _insert_new(connection, catalogues, {"version": version, "content_brotli": content})


async def _holder(connection: AsyncConnection, key: str, digest: str) -> str:
    """Id of the selection that holds an idempotency key."""
    spent = select(spent_keys.c.key_sha256).where(spent_keys.c.key_sha256 == _hash(key))
    holding = select(selections.c.id, selections.c.digest).where(selections.c.idempotency_key == key)
    is_spent = (await connection.execute(spent)).one_or_none() is not None
    held = None if is_spent else (await connection.execute(holding)).one_or_none()
    if held is None:  # deleted, if not before then by another transaction a moment ago
        raise KeySpentError(
            "the selection saved under this idempotency key has been deleted; take a new key to save it anew"
        )
    if held.digest != digest:
        raise KeyReusedError(
            "this idempotency key was used before, with other content; take a new key for a new selection"
        )
    return str(held.id)


async def rename(
    connection: AsyncConnection, id: str, names: Mapping[str, str | None], version: int | None = None
) -> bool:
    """Give a selection another title or reference; False where there is none, or none in the version that is given."""
    c = selections.c
    columns = (c.title, c.reference, c.author, c.ordering_code, c.designation)
    state = in_version(selections, id, version)
    row = (await connection.execute(select(*columns).where(*state).with_for_update())).one_or_none()
    if row is None:
        return False
    named = SimpleNamespace(**{**row._asdict(), **names})
    values = {"title": named.title, "reference": named.reference, "search_text": _search_text(named)}
    renamed = update(selections).where(*state).values(**values, version=c.version + 1).returning(c.id)
    return (await connection.execute(renamed)).one_or_none() is not None


async def remove(connection: AsyncConnection, id: str, version: int | None = None) -> bool:
    """Delete a selection, and remember that its idempotency key is spent; False where there is none, as `rename`."""
    statement = delete(selections).where(*in_version(selections, id, version)).returning(selections.c.idempotency_key)
    gone = (await connection.execute(statement)).one_or_none()
    if gone is not None and gone.idempotency_key is not None:
        spent = {"key_sha256": _hash(gone.idempotency_key), "deleted": datetime.now(UTC)}
        await _insert_new(connection, spent_keys, spent)
    return gone is not None


def in_version(table: Table, id: str, version: int | None) -> list[ColumnElement[bool]]:
    """Condition for a row in the version that somebody has seen: a change since then leaves none. None: any version."""
    c = table.c
    return [c.id == id] if version is None else [c.id == id, c.version == version]


def _hash(key: str) -> str:
    return hashlib.sha256(key.encode()).hexdigest()

"""Idempotency keys: the same key with the same content makes one document, even after its deletion."""

import hashlib
from datetime import datetime
from typing import Any, NamedTuple

from sqlalchemy import Table, select, update
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.ext.asyncio import AsyncConnection

from hpn.store.errors import KeyReusedError, KeySpentError
from hpn.store.tables import idempotency_keys


class Once(NamedTuple):
    """Idempotency key with the fingerprint of its request."""

    key: str
    digest: str


class KeyResult(NamedTuple):
    """Result of a key: a document, or a part of one."""

    document: str
    part: str | None


async def insert_new(connection: AsyncConnection, table: Table, row: dict[str, Any]) -> bool:
    """Insert a row; False where a row with the same primary key exists. SQLAlchemy has this per database only."""
    dialect = sqlite if connection.dialect.name == "sqlite" else postgresql
    new = dialect.insert(table).values(row).on_conflict_do_nothing().returning(*table.primary_key)
    return (await connection.execute(new)).first() is not None


async def take(connection: AsyncConnection, key: str, digest: str, document: str) -> KeyResult | None:
    """Earlier result of the key; None where the key is new: this transaction then makes the document.

    The insertion waits for any other transaction that uses the key. Raises KeyReusedError and KeySpentError; the caller
    then rolls the transaction back.
    """
    row = {"key_sha256": hash_of(key), "digest": digest, "document": document}
    is_new = await insert_new(connection, idempotency_keys, row)
    earlier = await made_by(connection, key, digest)
    return None if is_new else earlier


async def made_by(connection: AsyncConnection, key: str, digest: str) -> KeyResult | None:
    """Result of a key; None for a new one. Raises as `take`."""
    c = idempotency_keys.c
    query = select(c.digest, c.document, c.part, c.deleted).where(c.key_sha256 == hash_of(key))
    row = (await connection.execute(query)).one_or_none()
    if row is None:
        return None
    if row.deleted is not None:
        raise KeySpentError(
            "what was saved under this idempotency key has been deleted; take a new key to save it anew"
        )
    if row.digest != digest:
        raise KeyReusedError(
            "this idempotency key was used before, with other content; take a new key for a new request"
        )
    return KeyResult(row.document, row.part)


async def keep_part(connection: AsyncConnection, key: str, part: str) -> None:
    """Remember the part of its document that a key has made."""
    remembered = update(idempotency_keys).where(idempotency_keys.c.key_sha256 == hash_of(key)).values(part=part)
    await connection.execute(remembered)


async def spend(connection: AsyncConnection, document: str, moment: datetime) -> None:
    """Mark the keys of a deleted document as spent, and erase all else about them."""
    c = idempotency_keys.c
    values = {"digest": None, "document": None, "part": None, "deleted": moment}
    await connection.execute(update(idempotency_keys).where(c.document == document).values(values))


def hash_of(key: str) -> str:
    """Hash under which a key is kept."""
    return hashlib.sha256(key.encode()).hexdigest()

"""What one transaction of saving or deleting does: rows, the catalogues behind them, and whose keys they have."""

import hashlib
import secrets
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import lru_cache
from itertools import chain
from typing import Any

import brotli
from sqlalchemy import Connection, Dialect, bindparam, delete, select, text

from hpn.catalogue import Catalogue
from hpn.catalogue.copy import copy_of
from hpn.store.errors import KeyReusedError, KeySpentError
from hpn.store.packing import packed
from hpn.store.saved import Draft
from hpn.store.tables import UtcTime, selections, spent_keys

Row = dict[str, Any]
Outcome = str | Exception

COLUMNS = [column.name for column in selections.c]
SPEND = text("INSERT INTO spent_keys (key_sha256, deleted) VALUES (:hash, :moment) ON CONFLICT DO NOTHING").bindparams(
    bindparam("moment", type_=UtcTime)
)
KEEP = text("INSERT INTO catalogues (version, content_brotli) VALUES (:version, :content) ON CONFLICT DO NOTHING")


@dataclass(frozen=True, slots=True)
class Insertion:
    """Rows of new selections, and the one statement that inserts them all, with its values."""

    rows: Sequence[Row]
    statement: str
    values: tuple[Any, ...]


def insertion_of(drafts: Sequence[Draft], dialect: Dialect) -> Insertion:
    """How to insert drafts: past SQLAlchemy's own statement, which takes longer to make than to run.

    Nothing of it is left to the transaction, which may run on a thread of its own, where all is cold.
    """
    # As the dialect writes it: the driver's own way differs from it, and moments are compared as they are written.
    written: Any = UtcTime().dialect_impl(dialect).bind_processor(dialect) or (lambda moment: moment)
    rows = [_row_of(draft, written(datetime.now(UTC))) for draft in drafts]
    # In one order: two processes with the same two keys would otherwise wait for each other.
    ordered = sorted(rows, key=lambda row: row["idempotency_key"] or "")
    statement = _statement(len(rows), "?" if dialect.paramstyle == "qmark" else "%s")
    return Insertion(rows, statement, tuple(chain.from_iterable(row.values() for row in ordered)))


def _row_of(draft: Draft, created: Any) -> Row:
    """Row of a new selection, under a new id; in the order of the columns."""
    return {
        "id": secrets.token_urlsafe(16),
        "created": created,
        "title": draft.title,
        "reference": draft.reference,
        "selected": draft.selected,
        "engine_version": draft.engine_version,
        "catalogue_version": draft.catalogue_version,
        "application": draft.application.decode(),
        "result_packed": packed(draft.result),
        "idempotency_key": draft.idempotency_key,
        "digest": draft.digest if draft.idempotency_key else None,
    }


@lru_cache(maxsize=128)
def _statement(count: int, mark: str) -> str:
    rows = ", ".join([f"({', '.join([mark] * len(COLUMNS))})"] * count)
    return f"INSERT INTO selections ({', '.join(COLUMNS)}) VALUES {rows} ON CONFLICT (idempotency_key) DO NOTHING"


def insert(connection: Connection, insertion: Insertion, catalogues: Mapping[str, Catalogue]) -> list[Outcome]:
    """Insert selections and the catalogues, by version, that may not be there yet.

    For each selection the id under which it is saved, or why it is not.
    """
    # In one order, too.
    for version in sorted(catalogues):
        connection.execute(KEEP, {"version": version, "content": brotli.compress(copy_of(catalogues[version]))})
    connection.exec_driver_sql(insertion.statement, insertion.values)
    rows = insertion.rows
    keys = {row["idempotency_key"] for row in rows} - {None}
    if keys:
        # After the insertion, which has waited for whoever else had one of these keys in hand.
        _withdraw_spent(connection, rows)
    holders = _holders(connection, keys) if keys else {}
    return [_outcome(row, holders) for row in rows]


def remove(connection: Connection, id: str) -> bool:
    """Delete a selection, and remember that its idempotency key is spent; False where there is none."""
    c = selections.c
    gone = connection.execute(delete(selections).where(c.id == id).returning(c.idempotency_key)).one_or_none()
    if gone is not None and gone.idempotency_key is not None:
        connection.execute(SPEND, {"hash": _hash(gone.idempotency_key), "moment": datetime.now(UTC)})
    return gone is not None


def _hash(key: str) -> str:
    return hashlib.sha256(key.encode()).hexdigest()


def _withdraw_spent(connection: Connection, rows: Sequence[Row]) -> None:
    """Take back those of these rows whose keys are spent."""
    hashes = {row["id"]: _hash(row["idempotency_key"]) for row in rows if row["idempotency_key"] is not None}
    c = spent_keys.c
    query = select(c.key_sha256).where(c.key_sha256.in_(set(hashes.values())))
    spent = set(connection.execute(query).scalars())
    if spent:
        ids = [id for id, key_hash in hashes.items() if key_hash in spent]
        connection.execute(delete(selections).where(selections.c.id.in_(ids)))


def _holders(connection: Connection, keys: Iterable[str]) -> dict[str, tuple[str, str]]:
    """Id and digest of the selections that hold these idempotency keys."""
    c = selections.c
    query = select(c.idempotency_key, c.id, c.digest).where(c.idempotency_key.in_(list(keys)))
    return {key: (id, digest) for key, id, digest in connection.execute(query)}


def _outcome(row: Row, holders: Mapping[str, tuple[str, str]]) -> Outcome:
    """Id under which a row is saved: its own, or that of the row that was first with its idempotency key."""
    key = row["idempotency_key"]
    if key is None:
        return str(row["id"])
    if key not in holders:
        return KeySpentError(
            "what was saved under this idempotency key has been deleted; take a new key to save it anew"
        )
    id, digest = holders[key]
    if digest != row["digest"]:
        return KeyReusedError(
            "this idempotency key was used before, with other content; take a new key for a new selection"
        )
    return str(id)

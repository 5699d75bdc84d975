"""What one transaction of saving does: rows, the catalogues behind them, and whose idempotency keys they are."""

import secrets
from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime
from functools import lru_cache
from typing import Any

import brotli
from sqlalchemy import Connection, select, text

from hpn.catalogue import Catalogue
from hpn.catalogue_copy import copy_of
from hpn.store.errors import KeyReusedError
from hpn.store.packing import packed
from hpn.store.saved import Draft
from hpn.store.tables import UtcTime, selections

Row = dict[str, Any]
Outcome = str | Exception

COLUMNS = [column.name for column in selections.c]
KEEP = text("INSERT INTO catalogues (version, content_brotli) VALUES (:version, :content) ON CONFLICT DO NOTHING")


def row_of(draft: Draft) -> Row:
    """Row of a new selection, under a new id; in the order of the columns."""
    return {
        "id": secrets.token_urlsafe(16),
        "created": datetime.now(UTC),
        "title": draft.title,
        "reference": draft.reference,
        "selected": draft.selected,
        "engine_version": draft.engine_version,
        "catalogue_version": draft.catalogue_version,
        "application": draft.application.decode(),
        "result_brotli": packed(draft.result),
        "idempotency_key": draft.idempotency_key,
        "digest": draft.digest if draft.idempotency_key else None,
    }


def insert(connection: Connection, rows: Sequence[Row], catalogues: Mapping[str, Catalogue]) -> list[Outcome]:
    """Insert selections and the catalogues, by version, that may not be there yet.

    For each selection the id under which it is saved, or why it is not.
    """
    # Always in the same order: two processes with the same two keys would otherwise wait for each other.
    for version in sorted(catalogues):
        connection.execute(KEEP, {"version": version, "content": brotli.compress(copy_of(catalogues[version]))})
    _insert_rows(connection, sorted(rows, key=lambda row: row["idempotency_key"] or ""))
    holders = _holders(connection, {row["idempotency_key"] for row in rows} - {None})
    return [_outcome(row, holders.get(row["idempotency_key"])) for row in rows]


def _insert_rows(connection: Connection, rows: Sequence[Row]) -> None:
    """One statement for all rows, past SQLAlchemy's own, which takes longer to make than to run."""
    dialect = connection.dialect
    written: Callable[[datetime], Any] = UtcTime().bind_processor(dialect) or (lambda moment: moment)
    values = [value for row in rows for value in (row | {"created": written(row["created"])}).values()]
    connection.exec_driver_sql(_insertion(len(rows), "?" if dialect.paramstyle == "qmark" else "%s"), tuple(values))


@lru_cache(maxsize=128)
def _insertion(count: int, mark: str) -> str:
    rows = ", ".join([f"({', '.join([mark] * len(COLUMNS))})"] * count)
    return f"INSERT INTO selections ({', '.join(COLUMNS)}) VALUES {rows} ON CONFLICT (idempotency_key) DO NOTHING"


def _holders(connection: Connection, keys: set[str]) -> dict[str, tuple[str, str]]:
    """Id and digest of the selections that hold these idempotency keys."""
    if not keys:
        return {}
    c = selections.c
    query = select(c.idempotency_key, c.id, c.digest).where(c.idempotency_key.in_(keys))
    return {key: (id, digest) for key, id, digest in connection.execute(query)}


def _outcome(row: Row, holder: tuple[str, str] | None) -> Outcome:
    """Id under which a row is saved: its own, or that of the row that was first with its idempotency key."""
    id, digest = holder or (row["id"], row["digest"])
    if digest != row["digest"]:
        return KeyReusedError(
            "this idempotency key was used before, with other content; take a new key for a new selection"
        )
    return str(id)

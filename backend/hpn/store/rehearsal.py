"""Rehearsal of saving: writes the same rows as saving, then takes them back in the same transaction."""

import secrets
from dataclasses import replace

from sqlalchemy import delete, literal, select
from sqlalchemy.ext.asyncio import AsyncConnection

from hpn.catalogue import Catalogue
from hpn.store.saved import Draft
from hpn.store.tables import catalogues, deletions, documents, idempotency_keys
from hpn.store.writing import insert


def _rehearsed(size: int) -> Draft:
    """Draft with a result of `size` bytes that can't be compressed."""
    return Draft(
        application=b"{}", result=secrets.token_bytes(size), engine_version="", catalogue_version="", selected=None
    )


REHEARSED = (_rehearsed(64 * 1024), *[_rehearsed(1500)] * 12)
"""Drafts of a rehearsal, each saved under a new id; no reader ever sees them.

They take more room than most selections, since a small row still finds a place in the file on a full disk. In
PostgreSQL they need room in both files: long results stand in a file of their own, and rows in pages of 8 kB.
"""


async def rehearse(connection: AsyncConnection, catalogue: Catalogue | None = None) -> None:
    """Save and take it back; fails where saving would fail. The catalogue stays, as the first saving would keep it.

    The first draft is saved twice under one key and must appear once: a database that was restored without its unique
    indexes fails here, and a catalogue that exists twice can't be found.
    """
    for table in (catalogues, deletions):
        await connection.execute(select(literal(1)).select_from(table).limit(1))
    first = replace(REHEARSED[0], idempotency_key=f"rehearsal {secrets.token_urlsafe(16)}")
    if catalogue is not None:
        first = replace(first, catalogue=catalogue, catalogue_version=catalogue.version)
    ids = [await insert(connection, draft) for draft in map(replace, (first, first, *REHEARSED[1:]))]
    for table, column in ((documents, documents.c.id), (idempotency_keys, idempotency_keys.c.document)):
        await connection.execute(delete(table).where(column.in_(ids)))

"""Columns of a list: labels, the gear that a page shows first, and the text for searches.

Replies saved before are read once to fill them, where they are readable. Imports no module that later versions change.
"""

from collections.abc import Iterator
from typing import Any

import brotli
import msgspec
import sqlalchemy as sa
import zstandard
from alembic import op

revision = "0006"
down_revision = "0005"

BATCH = 200


class _Check(msgspec.Struct):
    status: str


class _Candidate(msgspec.Struct):
    designation: str
    status: str
    utilisation: float | None = None
    checks: tuple[_Check, ...] = ()


class _Reply(msgspec.Struct):
    candidates: tuple[_Candidate, ...]


def upgrade() -> None:
    """Add the columns and fill them."""
    for name in ("author", "revision", "ordering_code", "designation", "status"):
        op.add_column("selections", sa.Column(name, sa.Text()))
    op.add_column("selections", sa.Column("utilisation", sa.Double()))
    op.add_column("selections", sa.Column("search_text", sa.Text(), nullable=False, server_default=""))
    connection = op.get_bind()
    for rows in _batches(connection):
        connection.execute(_FILL, [_filled(row) for row in rows])


_selections = sa.table(
    "selections",
    *map(sa.column, ("id", "title", "reference", "result_packed", "designation", "status", "utilisation")),
    sa.column("search_text"),
)
_FILL = (
    sa.update(_selections)
    .where(_selections.c.id == sa.bindparam("row"))
    .values({name: sa.bindparam(name) for name in ("designation", "status", "utilisation", "search_text")})
)


def _batches(connection: sa.Connection) -> Iterator[list[Any]]:
    c = _selections.c
    query = sa.select(c.id, c.title, c.reference, c.result_packed).order_by(c.id).limit(BATCH)
    last = ""
    while rows := list(connection.execute(query.where(c.id > last))):
        yield rows
        last = rows[-1].id


def _filled(row: Any) -> dict[str, Any]:
    first = _first(row.result_packed)
    designation = first.designation if first else None
    return {
        "row": row.id,
        "designation": designation,
        "status": first.status if first else None,
        "utilisation": first.utilisation if first else None,
        "search_text": "\n".join(filter(None, (row.title, row.reference, designation))).casefold(),
    }


def _first(packed: bytes) -> _Candidate | None:
    """Selected gear, else the nearest miss that could be judged, else the first; None for an unreadable reply."""
    try:
        frame = packed.startswith(zstandard.FRAME_HEADER)
        candidates = msgspec.json.decode(
            zstandard.decompress(packed) if frame else brotli.decompress(packed), type=_Reply
        ).candidates
    except (msgspec.MsgspecError, zstandard.ZstdError, brotli.error, UnicodeDecodeError):
        return None
    judged = (one for one in candidates if all(check.status != "not_rated" for check in one.checks))
    return next(judged, next(iter(candidates), None))

"""Verdicts of today: documents that get another verdict by today's engine and catalogue, asked once for each version.

`today_of` names the versions of that verdict. A document or axis whose own answer is of these versions needs none.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime, timedelta
from typing import Any, NamedTuple

import msgspec
from sqlalchemy import ColumnElement, and_, bindparam, delete, func, or_, select, update
from sqlalchemy.ext.asyncio import AsyncConnection

from hpn.store.keys import insert_new
from hpn.store.machines import AXIS, axis_in
from hpn.store.records import DocumentKind, SavedAxis
from hpn.store.saved import unpacked
from hpn.store.tables import askings, axes, documents, revisions
from hpn.store.writing import order_text

LEASE = timedelta(minutes=5)
"""Time after which a process may take a document that another has taken to ask and has not answered."""

MOST_NAMED = 100
"""Most axes with another verdict that a machine lists by number."""


class Versions(NamedTuple):
    """Versions of engine and catalogue."""

    engine: str
    catalogue: str

    @property
    def key(self) -> str:
        """Both versions as one text."""
        return f"{self.engine} {self.catalogue}"


@dataclass(frozen=True, slots=True)
class Stale:
    """Document to ask again; for a selection with the application and the verdict of its latest revision."""

    id: str
    kind: DocumentKind
    revisions: int
    selected: str | None
    designation: str | None
    status: str | None
    ordering_code: str | None
    is_of_today: bool
    application: bytes = field(default=b"", repr=False)


NAMED = ("id", "kind", "revisions", "selected", "designation", "status", "ordering_code")


class AxisVerdict(NamedTuple):
    """Axis as it was asked, and whether its verdict has changed."""

    axis: SavedAxis
    changed: bool


class _Resolved(msgspec.Struct):
    resolved: msgspec.Raw


class _Revision(msgspec.Struct):
    axes: tuple[_Resolved]


_revision = msgspec.json.Decoder(_Revision).decode


def pending(versions: Versions) -> ColumnElement[bool]:
    """Condition for a saved document without a verdict by these versions."""
    c, key = documents.c, versions.key
    return and_(c.saved.is_not(None), or_(c.today_of.is_(None), c.today_of < key, c.today_of > key))


async def count_pending(connection: AsyncConnection, versions: Versions, kind: DocumentKind | None) -> int:
    """Number of saved documents without a verdict by these versions."""
    of_kind = [] if kind is None else [documents.c.kind == kind]
    query = select(func.count()).select_from(documents).where(pending(versions), *of_kind)
    return int((await connection.execute(query)).scalar_one())


async def _is_their_turn(connection: AsyncConnection, versions: Versions, now: datetime, started: datetime) -> bool:
    """True where it is these versions' turn: they began last, or the other versions' turn is over.

    While two versions run side by side, neither asks again for documents that the other has just asked.
    """
    c = askings.c
    last = (await connection.execute(select(c.versions, c.begun).order_by(c.begun.desc()).limit(1))).one_or_none()
    if last is not None and last.versions == versions.key:
        return True
    if last is None or last.begun < max(started, now - LEASE):
        await connection.execute(delete(askings).where(c.versions == versions.key))
        await insert_new(connection, askings, {"versions": versions.key, "begun": now})
        return True
    return False


async def take_stale(connection: AsyncConnection, versions: Versions, most: int, started: datetime) -> list[Stale]:
    """Documents that a process, started at a moment, is to ask again from now on, the newest first; they are locked for
    others until LEASE is over."""
    c, now = documents.c, datetime.now(UTC)
    if not await _is_their_turn(connection, versions, now, started):
        return []
    free = or_(c.today_taken.is_(None), c.today_taken < now - LEASE)
    newest = select(c.id).where(pending(versions), free).order_by(c.saved.desc()).limit(most)
    # A subquery may be run again for each row, and takes others each time; PostgreSQL runs a common table once.
    free_rows = newest.with_for_update(skip_locked=True).cte()
    columns = [c[name] for name in NAMED]
    mine = update(documents).where(c.id.in_(select(free_rows.c.id)), free).values(today_taken=now)
    rows = list(await connection.execute(mine.returning(*columns, c.engine_version, c.catalogue_version)))
    stale = [Stale(**dict(zip(NAMED, row, strict=False)), is_of_today=tuple(row[-2:]) == versions) for row in rows]
    selections = [each for each in stale if each.kind == "selection" and not each.is_of_today]
    contents = await _contents(connection, [each.id for each in selections])
    return [replace(each, application=contents.get(each.id, b"")) for each in stale]


async def _contents(connection: AsyncConnection, ids: Sequence[str]) -> dict[str, bytes]:
    """Applications of the latest revisions of selections."""
    c, r = documents.c, revisions.c
    latest = (r.document == c.id) & (r.number == c.revisions)
    query = select(c.id, r.content_packed).join_from(documents, revisions, latest).where(c.id.in_(ids))
    return {id: bytes(_revision(unpacked(packed)).axes[0].resolved) for id, packed in await connection.execute(query)}


async def settle(connection: AsyncConnection, stale: Stale, versions: Versions, values: dict[str, Any] | None) -> None:
    """Keep a selection's verdict of today, unless it has a newer revision; None leaves it to be asked again."""
    c = documents.c
    own = update(documents).where(c.id == stale.id, c.revisions == stale.revisions)
    columns = {} if values is None else {**values, "today_of": versions.key}
    await connection.execute(own.values(today_taken=None, **columns))


# --- Axes of machines -------------------------------------------------------------------------------------------------


def _axes_of(id: str) -> ColumnElement[bool]:
    return and_(axes.c.document == id, axes.c.removed.is_(None))


def _unasked(versions: Versions) -> ColumnElement[bool]:
    """Condition for an axis whose answer is of other versions, and that has no verdict by these."""
    c = axes.c
    of_others = or_(c.engine_version != versions.engine, c.catalogue_version != versions.catalogue)
    return and_(of_others, or_(c.today_of.is_(None), c.today_of != versions.key))


async def read_unasked(
    connection: AsyncConnection, id: str, versions: Versions, most: int
) -> tuple[str, list[SavedAxis]]:
    """Common values of a machine as JSON, and some of its axes without a verdict of today."""
    common = await connection.execute(select(documents.c.common).where(documents.c.id == id))
    query = select(*AXIS).where(_axes_of(id), _unasked(versions)).order_by(axes.c.number).limit(most)
    return common.scalar_one_or_none() or "{}", [axis_in(row) for row in await connection.execute(query)]


async def keep_verdicts(
    connection: AsyncConnection, id: str, versions: Versions, verdicts: Sequence[AxisVerdict]
) -> None:
    """Keep today's verdicts on axes, except on axes that have changed since they were asked."""
    c = axes.c
    state = ("number", "version", "engine_version", "catalogue_version")
    one = update(axes).where(c.document == id, *(c[name] == bindparam(f"own_{name}") for name in state))
    rows = [
        {
            "own_number": axis.number,
            "own_version": axis.version,
            "own_engine_version": axis.answer["engine_version"],
            "own_catalogue_version": axis.answer["catalogue_version"],
            "today_of": versions.key,
            "today_changed": changed,
        }
        for axis, changed in verdicts
    ]
    await connection.execute(one, rows)
    await connection.execute(update(documents).where(documents.c.id == id).values(today_taken=datetime.now(UTC)))


async def settle_machine(connection: AsyncConnection, id: str, versions: Versions) -> bool:
    """Count the axes of a machine with another verdict; False, and no count kept, while some have not been asked."""
    c = documents.c
    await connection.execute(select(c.id).where(c.id == id).with_for_update())
    remaining = select(func.count()).select_from(axes).where(_axes_of(id), _unasked(versions))
    values: dict[str, Any] = {"today_taken": None}
    is_whole = (await connection.execute(remaining)).scalar_one() == 0
    if is_whole:
        of_others = or_(axes.c.engine_version != versions.engine, axes.c.catalogue_version != versions.catalogue)
        query = select(axes.c.number).where(_axes_of(id), of_others, axes.c.today_changed.is_(True))
        numbers = [number for (number,) in await connection.execute(query.order_by(axes.c.number))]
        values |= {"today_of": versions.key, "today_changed": len(numbers)}
        values["today_axes"] = order_text(numbers[:MOST_NAMED])
    await connection.execute(update(documents).where(c.id == id).values(values))
    return is_whole

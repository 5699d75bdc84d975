"""Verdicts of today: which documents get another one by today's engine and catalogue, asked once for each version.

`today_of` names the versions that were asked. A document or axis whose own answer is of these versions needs no asking.
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
"""Time after which a document that a process has taken to ask, and has not answered, may be taken by another."""

MOST_NAMED = 100
"""Axes of a machine with another verdict that are named."""


class Versions(NamedTuple):
    """Versions of engine and catalogue."""

    engine: str
    catalogue: str

    @property
    def key(self) -> str:
        """Both as one text."""
        return f"{self.engine} {self.catalogue}"


@dataclass(frozen=True, slots=True)
class Stale:
    """A document to be asked again; of a selection its latest revision: the application and the verdict of then."""

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
    """An axis as it was asked, and whether it gets another verdict."""

    axis: SavedAxis
    changed: bool


class _Resolved(msgspec.Struct):
    resolved: msgspec.Raw


class _Revision(msgspec.Struct):
    axes: tuple[_Resolved]


_revision = msgspec.json.Decoder(_Revision).decode


def pending(versions: Versions) -> ColumnElement[bool]:
    """Condition for a saved document that has not been asked by these versions."""
    c, key = documents.c, versions.key
    return and_(c.saved.is_not(None), or_(c.today_of.is_(None), c.today_of < key, c.today_of > key))


async def count_pending(connection: AsyncConnection, versions: Versions, kind: DocumentKind | None) -> int:
    """Number of documents that have not been asked by these versions."""
    of_kind = [] if kind is None else [documents.c.kind == kind]
    query = select(func.count()).select_from(documents).where(pending(versions), *of_kind)
    return int((await connection.execute(query)).scalar_one())


async def _is_their_turn(connection: AsyncConnection, versions: Versions, now: datetime, started: datetime) -> bool:
    """True where documents are asked by these versions: those of the process that came last, or whose turn is over.

    While two versions run beside each other, neither asks again what the other has just asked.
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
    """Documents that a process that has started at a moment asks from now on, the newest first; no other takes them
    before their time is up."""
    c, now = documents.c, datetime.now(UTC)
    if not await _is_their_turn(connection, versions, now, started):
        return []
    free = or_(c.today_taken.is_(None), c.today_taken < now - LEASE)
    newest = select(c.id).where(pending(versions), free).order_by(c.saved.desc()).limit(most)
    taken = newest.with_for_update(skip_locked=True).subquery()
    columns = [c[name] for name in NAMED]
    mine = update(documents).where(c.id.in_(select(taken.c.id)), free).values(today_taken=now)
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
    """Keep what a selection gets today, unless it has another revision since; None leaves it to be asked again."""
    c = documents.c
    own = update(documents).where(c.id == stale.id, c.revisions == stale.revisions)
    columns = {} if values is None else {**values, "today_of": versions.key}
    await connection.execute(own.values(today_taken=None, **columns))


# --- Axes of machines -------------------------------------------------------------------------------------------------


def _axes_of(id: str) -> ColumnElement[bool]:
    return and_(axes.c.document == id, axes.c.removed.is_(None))


def _unasked(versions: Versions) -> ColumnElement[bool]:
    """Condition for an axis whose answer is of other versions, and that was not asked by these."""
    c = axes.c
    of_others = or_(c.engine_version != versions.engine, c.catalogue_version != versions.catalogue)
    return and_(of_others, or_(c.today_of.is_(None), c.today_of != versions.key))


async def read_unasked(
    connection: AsyncConnection, id: str, versions: Versions, most: int
) -> tuple[str, list[SavedAxis]]:
    """Common values of a machine as JSON, and some of its axes that have not been asked."""
    common = await connection.execute(select(documents.c.common).where(documents.c.id == id))
    query = select(*AXIS).where(_axes_of(id), _unasked(versions)).order_by(axes.c.number).limit(most)
    return common.scalar_one_or_none() or "{}", [axis_in(row) for row in await connection.execute(query)]


async def keep_verdicts(
    connection: AsyncConnection, id: str, versions: Versions, verdicts: Sequence[AxisVerdict]
) -> None:
    """Keep what axes get today, but for those that have changed since they were asked."""
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
    """Count the axes of a machine with another verdict; False, and nothing kept, where some have not been asked."""
    c = documents.c
    await connection.execute(select(c.id).where(c.id == id).with_for_update())
    left = select(func.count()).select_from(axes).where(_axes_of(id), _unasked(versions))
    values: dict[str, Any] = {"today_taken": None}
    is_whole = (await connection.execute(left)).scalar_one() == 0
    if is_whole:
        of_others = or_(axes.c.engine_version != versions.engine, axes.c.catalogue_version != versions.catalogue)
        query = select(axes.c.number).where(_axes_of(id), of_others, axes.c.today_changed.is_(True))
        numbers = [number for (number,) in await connection.execute(query.order_by(axes.c.number))]
        values |= {"today_of": versions.key, "today_changed": len(numbers)}
        values["today_axes"] = order_text(numbers[:MOST_NAMED])
    await connection.execute(update(documents).where(c.id == id).values(values))
    return is_whole

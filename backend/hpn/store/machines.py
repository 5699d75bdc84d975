"""Statements of transactions on machines: a calculated machine stays for a day, a saved one for good."""

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from datetime import UTC, datetime, timedelta
from typing import Any

from sqlalchemy import ColumnElement, delete, func, or_, select, text, update
from sqlalchemy.ext.asyncio import AsyncConnection

from hpn.store.errors import NoRoomError, ShareSpentError
from hpn.store.keys import Once, take
from hpn.store.records import (
    ANSWER,
    AxesOfGear,
    DocumentKind,
    DocumentLine,
    Machine,
    MachineDraft,
    RevisionDraft,
    SavedAxis,
)
from hpn.store.saved import search_text
from hpn.store.tables import axes, deletions, documents
from hpn.store.writing import insert_axes, insert_revision, of_today, order_of, order_text, recount

UNSAVED_LASTS = timedelta(days=1)
MOST_OF_CALLER = 20
"""Most unsaved machines of one caller."""

LOCK = 0x48504F  # any number but that of the migrations: on PostgreSQL unsaved machines are counted one after another

LINE = [documents.c[field.name] for field in fields(DocumentLine)]
OWN_COLUMNS = [field.name for field in fields(SavedAxis) if field.name not in ("application", "answer")]
AXIS = [axes.c[name] for name in (*OWN_COLUMNS, *ANSWER, "application")]


async def insert_unsaved(connection: AsyncConnection, draft: MachineDraft, most_bytes: int) -> str:
    """Id of a new unsaved machine. Unsaved machines older than a day go, and no others. Raises as `require_room`.

    On PostgreSQL a lock orders the insertions: of two machines inserted at once, each alone would fit.
    """
    now, c = datetime.now(UTC), documents.c
    if connection.dialect.name == "postgresql":
        await connection.execute(text("SELECT pg_advisory_xact_lock(:lock)"), {"lock": LOCK})
    await connection.execute(delete(documents).where(c.saved.is_(None), c.created < now - UNSAVED_LASTS))
    await require_room(connection, draft.caller, most_bytes - draft.bytes)
    return await insert_machine(connection, replace(draft), now, saved=None)  # replace() makes a new id each time


async def insert_machine(
    connection: AsyncConnection, draft: MachineDraft, now: datetime, saved: datetime | None
) -> str:
    """Id of a new machine."""
    id = draft.id
    numbers = list(range(1, len(draft.axes) + 1))
    same = ("title", "reference", "author", "note", "common", "owner", "caller", "engine_version", "catalogue_version")
    row: dict[str, Any] = {name: getattr(draft, name) for name in same}
    row |= {"id": id, "kind": "machine", "created": now, "updated": now, "saved": saved}
    row |= {"axis_order": order_text(numbers), "numbers": len(numbers), "bytes": draft.bytes}
    row["search_text"] = search_text(draft.title, draft.reference, draft.author)
    if draft.revisions:
        row |= {"revisions": len(draft.revisions), "revision": draft.revisions[-1][1].label, "revised": now}
    row |= of_today(draft.engine_version, draft.catalogue_version)
    await connection.execute(documents.insert(), row)
    await insert_axes(connection, id, list(zip(numbers, draft.axes, strict=True)), now, draft.owner or draft.author)
    for number, (created, each) in enumerate(draft.revisions, start=1):
        await insert_revision(connection, id, number, each, created)
    await recount(connection, id, now)
    return id


async def require_room(connection: AsyncConnection, caller: str, most_bytes: int) -> None:
    """Raise ShareSpentError for a caller at its limit of unsaved machines, NoRoomError where all exceed
    `most_bytes`."""
    c = documents.c
    unsaved = c.saved.is_(None) & (c.created >= datetime.now(UTC) - UNSAVED_LASTS)
    of_caller = select(func.count()).where(unsaved, c.caller == caller)
    if (await connection.execute(of_caller)).scalar_one() >= MOST_OF_CALLER:
        raise ShareSpentError(f"{MOST_OF_CALLER} machines of this caller are kept for a day without being saved")
    room = select(func.coalesce(func.sum(c.bytes), 0)).where(unsaved)
    if (await connection.execute(room)).scalar_one() > most_bytes:
        raise NoRoomError("the machines that nobody has saved take all the room that they may")


async def save_machine(
    connection: AsyncConnection, id: str, names: Mapping[str, str | None], owner: str | None, first: RevisionDraft
) -> bool:
    """Save a calculated machine under a title block, with its first revision; False where there is no unsaved one."""
    c, now = documents.c, datetime.now(UTC)
    values: dict[str, Any] = {**names, "owner": owner, "caller": "", "saved": now, "updated": now}
    values |= {"version": c.version + 1, "revisions": 1, "revised": now, "changes": 0}
    values["search_text"] = search_text(names.get("title"), names.get("reference"), names.get("author"))
    named = update(documents).where(c.id == id, c.saved.is_(None)).values(values).returning(c.id)
    if (await connection.execute(named)).one_or_none() is None:
        return False
    await insert_revision(connection, id, 1, first, now)
    return True


def alive() -> ColumnElement[bool]:
    """Condition for a document that is saved, or was calculated within a day."""
    c = documents.c
    return or_(c.saved.is_not(None), c.created >= datetime.now(UTC) - UNSAVED_LASTS)


async def read_machine(
    connection: AsyncConnection, id: str, kind: DocumentKind | None = None, numbers: Sequence[int] | None = None
) -> Machine | None:
    """Document with an id and all its axes in their order, or those with given numbers; None for an unknown id, and for
    an unsaved document older than a day."""
    c = documents.c
    of_kind = [] if kind is None else [c.kind == kind]
    query = select(*LINE, c.common, c.axis_order).where(c.id == id, alive(), *of_kind)
    row = (await connection.execute(query)).one_or_none()
    if row is None:
        return None
    named = row._asdict()
    order, axes = order_of(named.pop("axis_order")), await read_axes(connection, id, numbers)
    return Machine(**named, order=tuple(order), items=tuple(axes[number] for number in order if number in axes))


async def read_axes(
    connection: AsyncConnection, id: str, numbers: Sequence[int] | None = None, *, with_removed: bool = False
) -> dict[int, SavedAxis]:
    """Axes of a document by their numbers: all present ones, or those with given numbers; or the removed ones."""
    c = axes.c
    query = select(*AXIS).where(c.document == id, c.removed.is_not(None) if with_removed else c.removed.is_(None))
    if numbers is not None:
        query = query.where(c.number.in_(numbers))
    return {(axis := axis_in(row)).number: axis for row in await connection.execute(query)}


async def read_gears(connection: AsyncConnection, id: str, without: int, most: int = 3) -> dict[str, AxesOfGear]:
    """Axes of a document by their gears, without one of them: that of the ordering code, else the selected one."""
    c = axes.c
    each = select(
        *(c.number, c.name, c.designation),
        func.count().over(partition_by=c.designation).label("axes"),
        func.sum(c.quantity).over(partition_by=c.designation).label("quantity"),
        func.row_number().over(partition_by=c.designation, order_by=c.number).label("place"),
    ).where(
        *(c.document == id, c.removed.is_(None), c.number != without, c.designation.is_not(None)),
        or_(c.selected.is_not(None), c.ordering_code.is_not(None)),
    )
    placed = each.subquery()
    query = select(placed).where(placed.c.place <= most).order_by(placed.c.designation, placed.c.number)
    gears = dict[str, AxesOfGear]()
    for row in await connection.execute(query):
        known = gears.get(row.designation)
        first = (*(known.first if known else ()), (row.number, row.name))
        gears[row.designation] = AxesOfGear(row.axes, int(row.quantity), first)
    return gears


def axis_in(row: Sequence[Any]) -> SavedAxis:
    """Axis from a row of the columns AXIS."""
    values, count = tuple(row), len(OWN_COLUMNS)
    answer = dict(zip(ANSWER, values[count:-1], strict=True))
    return SavedAxis(application=values[-1].encode(), answer=answer, **dict(zip(OWN_COLUMNS, values, strict=False)))


async def read_deletions(
    connection: AsyncConnection, since: datetime, kind: DocumentKind | None
) -> list[tuple[str, datetime]]:
    """Ids and moments of documents deleted since a moment; the latest last."""
    c = deletions.c
    query = select(c.document, c.deleted).where(c.deleted >= since).order_by(c.deleted, c.document)
    if kind is not None:
        query = query.where(c.kind == kind)
    return [(id, deleted) for id, deleted in await connection.execute(query)]


async def add_machine(connection: AsyncConnection, draft: MachineDraft, once: Once | None = None) -> str:
    """Id of a new saved machine, or of the one that the same key has saved before; raises as `take`."""
    now = datetime.now(UTC)
    if once is not None and (earlier := await take(connection, once.key, once.digest, draft.id)) is not None:
        return earlier.document
    return await insert_machine(connection, draft, now, saved=now)

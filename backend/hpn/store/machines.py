"""Statements of the transactions on machines: kept for a day when calculated, for good once saved."""

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from datetime import UTC, datetime, timedelta
from typing import Any

from sqlalchemy import ColumnElement, delete, func, or_, select, text, update
from sqlalchemy.ext.asyncio import AsyncConnection

from hpn.store.errors import NoRoomError, ShareSpentError
from hpn.store.keys import Once, take
from hpn.store.records import ANSWER, DocumentKind, DocumentLine, Machine, MachineDraft, RevisionDraft, SavedAxis
from hpn.store.saved import search_text
from hpn.store.tables import axes, deletions, documents
from hpn.store.writing import counts_of, insert_axes, insert_revision, of_today, order_of, order_text

UNSAVED_LASTS = timedelta(days=1)
MOST_OF_CALLER = 20
"""Machines of one caller that are kept without being saved."""

LOCK = 0x48504F  # any number but that of the migrations: on PostgreSQL unsaved machines are counted one after another

LINE = [documents.c[field.name] for field in fields(DocumentLine)]
OWN_COLUMNS = [field.name for field in fields(SavedAxis) if field.name not in ("application", "answer")]
AXIS = [axes.c[name] for name in (*OWN_COLUMNS, *ANSWER, "application")]


async def insert_unsaved(connection: AsyncConnection, draft: MachineDraft, most_bytes: int) -> str:
    """Id of a new machine that nobody has saved. Those older than a day go, and no other: raises as `require_room`.

    Of two that are added at once, each would fit alone; so they are counted one after the other.
    """
    now, c = datetime.now(UTC), documents.c
    if connection.dialect.name == "postgresql":
        await connection.execute(text("SELECT pg_advisory_xact_lock(:lock)"), {"lock": LOCK})
    await connection.execute(delete(documents).where(c.saved.is_(None), c.created < now - UNSAVED_LASTS))
    await require_room(connection, draft.caller, most_bytes - draft.bytes)
    return await insert_machine(connection, replace(draft), now, saved=None)  # under an id of its own each time


async def insert_machine(
    connection: AsyncConnection, draft: MachineDraft, now: datetime, saved: datetime | None
) -> str:
    """Id of a new machine."""
    id = draft.id
    numbers = list(range(1, len(draft.axes) + 1))
    used = [axis.answer["utilisation"] for axis in draft.axes if axis.answer["status"] == "suitable"]
    same = ("title", "reference", "author", "note", "common", "owner", "caller", "engine_version", "catalogue_version")
    row: dict[str, Any] = {name: getattr(draft, name) for name in same}
    row |= counts_of([axis.answer["status"] for axis in draft.axes])
    row |= {"id": id, "kind": "machine", "created": now, "updated": now, "saved": saved}
    row |= {"axis_order": order_text(numbers), "numbers": len(numbers), "bytes": draft.bytes}
    row["utilisation"] = max((each for each in used if each is not None), default=None)
    row["search_text"] = search_text(draft.title, draft.reference, draft.author)
    if draft.revisions:
        row |= {"revisions": len(draft.revisions), "revision": draft.revisions[-1][1].label}
    versions = {(axis.answer["engine_version"], axis.answer["catalogue_version"]) for axis in draft.axes}
    if len(versions) < 2:
        row |= of_today(*next(iter(versions), (draft.engine_version, draft.catalogue_version)))
    await connection.execute(documents.insert(), row)
    await insert_axes(connection, id, list(zip(numbers, draft.axes, strict=True)), now, draft.owner or draft.author)
    for number, (created, each) in enumerate(draft.revisions, start=1):
        await insert_revision(connection, id, number, each, created)
    return id


async def require_room(connection: AsyncConnection, caller: str, most_bytes: int) -> None:
    """Raise ShareSpentError for a caller with enough unsaved machines, NoRoomError where all take more than that."""
    c = documents.c
    unsaved = c.saved.is_(None) & (c.created >= datetime.now(UTC) - UNSAVED_LASTS)
    of_caller = select(func.count()).where(unsaved, c.caller == caller)
    if (await connection.execute(of_caller)).scalar_one() >= MOST_OF_CALLER:
        raise ShareSpentError(f"{MOST_OF_CALLER} machines of this caller are kept for a day without being saved")
    taken = select(func.coalesce(func.sum(c.bytes), 0)).where(unsaved)
    if (await connection.execute(taken)).scalar_one() > most_bytes:
        raise NoRoomError("the machines that nobody has saved take all the room that they may")


async def save_machine(
    connection: AsyncConnection, id: str, names: Mapping[str, str | None], owner: str | None, first: RevisionDraft
) -> bool:
    """Save a calculated machine under a title and the like, with its first revision; False where none is unsaved."""
    c, now = documents.c, datetime.now(UTC)
    values: dict[str, Any] = {**names, "owner": owner, "caller": "", "saved": now, "updated": now}
    values |= {"version": c.version + 1, "revisions": 1}
    values["search_text"] = search_text(names.get("title"), names.get("reference"), names.get("author"))
    named = update(documents).where(c.id == id, c.saved.is_(None)).values(values).returning(c.id)
    if (await connection.execute(named)).one_or_none() is None:
        return False
    await insert_revision(connection, id, 1, first, now)
    return True


def alive() -> ColumnElement[bool]:
    """Condition for a document that is saved, or was calculated not long ago."""
    c = documents.c
    return or_(c.saved.is_not(None), c.created >= datetime.now(UTC) - UNSAVED_LASTS)


async def read_machine(
    connection: AsyncConnection, id: str, kind: DocumentKind | None = None, numbers: Sequence[int] | None = None
) -> Machine | None:
    """The document with an id and its axes in their order, or those of some numbers; None where there is none, or it
    has had its time.
    """
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
    connection: AsyncConnection, id: str, numbers: Sequence[int] | None = None, *, removed: bool = False
) -> dict[int, SavedAxis]:
    """Axes of a document by their numbers: all that are there, or some of them; or those that were removed."""
    c = axes.c
    query = select(*AXIS).where(c.document == id, c.removed.is_not(None) if removed else c.removed.is_(None))
    if numbers is not None:
        query = query.where(c.number.in_(numbers))
    return {(axis := axis_in(row)).number: axis for row in await connection.execute(query)}


def axis_in(row: Sequence[Any]) -> SavedAxis:
    """Axis of a row of the columns AXIS."""
    count = len(OWN_COLUMNS)
    named, answer = dict(zip(OWN_COLUMNS, row[:count], strict=True)), dict(zip(ANSWER, row[count:-1], strict=True))
    return SavedAxis(application=row[-1].encode(), answer=answer, **named)


async def read_deletions(
    connection: AsyncConnection, since: datetime, kind: DocumentKind | None
) -> list[tuple[str, datetime]]:
    """Ids of documents that were deleted since then, and when; the latest last."""
    c = deletions.c
    query = select(c.document, c.deleted).where(c.deleted >= since).order_by(c.deleted, c.document)
    if kind is not None:
        query = query.where(c.kind == kind)
    return [(id, deleted) for id, deleted in await connection.execute(query)]


async def add_machine(connection: AsyncConnection, draft: MachineDraft, once: Once | None = None) -> str:
    """Id of a new machine that is saved, or of the one that the same key has saved before; raises as `take`."""
    now = datetime.now(UTC)
    if once is not None and (made := await take(connection, once.key, once.digest, draft.id)) is not None:
        return made.document
    return await insert_machine(connection, draft, now, saved=now)

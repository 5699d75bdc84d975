"""Changes of a document's working copy and its revisions, each made for the state that the caller has seen."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import bindparam, func, select, update
from sqlalchemy.ext.asyncio import AsyncConnection

from hpn.store.errors import ExcessError, LabelTakenError
from hpn.store.keys import Once, keep_part, take
from hpn.store.machines import alive
from hpn.store.records import Answer, AxisDraft, RevisionDraft, RevisionLine
from hpn.store.saved import search_text, unpacked
from hpn.store.tables import axes, documents, revisions
from hpn.store.writing import (
    SEARCHED,
    axis_row,
    insert_axes,
    insert_revision,
    keep_catalogue,
    of_today,
    order_of,
    order_text,
    recount,
)

Row = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of a document: most axes, phases or moves of all axes together, and revisions."""

    axes: int
    phases: int
    revisions: int


@dataclass(frozen=True, slots=True)
class Change:
    """Changes of a document in version `version`.

    `values` are columns of its title block and common values, `order` the numbers of its present axes. `changed`,
    `answered` and `removed` name an axis by its number and the version seen, `restored` by its number.
    """

    version: int
    by: str | None = None
    values: Mapping[str, Any] = field(default_factory=dict)
    order: Sequence[int] | None = None
    new: Sequence[AxisDraft] = ()
    changed: Sequence[tuple[int, int, AxisDraft]] = ()
    answered: Sequence[tuple[int, int, Answer]] = ()
    removed: Sequence[tuple[int, int]] = ()
    restored: Sequence[tuple[int, Answer]] = ()

    @property
    def is_of_document(self) -> bool:
        """True where the title block, common values, order or set of axes change."""
        return bool(self.values or self.order is not None or self.new or self.removed or self.restored)


async def change(
    connection: AsyncConnection, id: str, change: Change, limits: Limits, once: Once | None = None
) -> list[int] | None:
    """Numbers of the new and the restored axes; None where the document or an axis is not in the version seen.

    Raises ExcessError beyond the limits, and KeyReusedError and KeySpentError as `take`; the same key returns the same
    numbers as before.
    """
    machine = await _lock_row(connection, id)
    if machine is None:
        return None
    if once is not None and (before := await take(connection, once.key, once.digest, id)) is not None:
        return order_of(before.part or "[]")
    if machine.version != change.version or not await _as_seen(connection, id, change):
        return None
    now, order = datetime.now(UTC), order_of(machine.axis_order)
    numbers = [machine.numbers + place for place in range(1, len(change.new) + 1)]
    await insert_axes(connection, id, list(zip(numbers, change.new, strict=True)), now, change.by)
    await _update_axes(connection, id, change, now, order)
    values = await _document_values(connection, id, change, order, numbers)
    if change.is_of_document:
        values["version"] = documents.c.version + 1
    values["numbers"] = machine.numbers + len(numbers)
    if change.values or change.order is not None:
        values["edited"] = now
    if machine.saved is None:  # unsaved documents are limited in bytes
        own = select(func.coalesce(func.sum(func.length(axes.c.application)), 0)).where(axes.c.document == id)
        values["bytes"] = own.scalar_subquery()
    await connection.execute(update(documents).where(documents.c.id == id).values(values))
    await recount(connection, id, now)
    await _require_within(connection, id, limits)
    numbers += [number for number, _ in change.restored]
    if once is not None:
        await keep_part(connection, once.key, order_text(numbers))
    return numbers


async def _lock_row(connection: AsyncConnection, id: str) -> Any:
    """Row of the document, locked against other transactions until this one ends."""
    c = documents.c
    columns = (c.version, c.axis_order, c.numbers, c.revisions, c.saved)
    query = select(*columns).where(c.id == id, alive()).with_for_update()
    return (await connection.execute(query)).one_or_none()


async def _as_seen(connection: AsyncConnection, id: str, change: Change) -> bool:
    """True where every axis of a change is in the version seen."""
    named = [(number, version) for number, version, _ in (*change.changed, *change.answered)]
    seen: dict[int, int] = dict([*named, *change.removed])
    if not seen and not change.restored:
        return True
    c = axes.c
    query = select(c.number, c.version, c.removed).where(c.document == id)
    if len(seen) + len(change.restored) < 100:
        query = query.where(c.number.in_([*seen, *(number for number, _ in change.restored)]))
    there, removed_numbers = {}, set()
    for number, version, removed in await connection.execute(query):
        if removed is None:
            there[number] = version
        else:
            removed_numbers.add(number)
    return all(there.get(number) == version for number, version in seen.items()) and all(
        number in removed_numbers for number, _ in change.restored
    )


async def _update_axes(connection: AsyncConnection, id: str, change: Change, now: datetime, order: list[int]) -> None:
    """Write the changed, answered, restored and removed axes; take the removed ones out of `order`."""
    c = axes.c
    one = update(axes).where(c.document == id, c.number == bindparam("row"))
    changed = [{"row": number, **axis_row(axis, now, change.by)} for number, _, axis in change.changed]
    answered = [{"row": number, **answer, "today_of": None} for number, _, answer in change.answered]
    back = [{"row": number, **answer, "today_of": None, "removed": None} for number, answer in change.restored]
    counted = one.values(version=c.version + 1)
    for statement, rows in ((counted, changed), (one, answered), (counted, back)):
        if rows:
            await connection.execute(statement, rows)
    for number, _ in change.removed:
        gone = {"removed": now, "updated": now, "updated_by": change.by, "version": c.version + 1}
        await connection.execute(update(axes).where(c.document == id, c.number == number).values(gone))
        order.remove(number)


async def _document_values(
    connection: AsyncConnection, id: str, change: Change, order: list[int], numbers: list[int]
) -> Row:
    """Columns of a document that a change sets."""
    values: Row = dict(change.values)
    if change.order is not None:
        order[:] = change.order
    order += [*numbers, *(number for number, _ in change.restored)]
    values["axis_order"] = order_text(order)
    return values | await _search_values(connection, id, values)


async def _search_values(connection: AsyncConnection, id: str, values: Row) -> Row:
    """Text for searches, where a changed column is part of it."""
    if not values.keys() & set(SEARCHED):
        return {}
    query = select(*(documents.c[name] for name in SEARCHED)).where(documents.c.id == id)
    named = (await connection.execute(query)).one()._asdict() | values
    return {"search_text": search_text(*(named[name] for name in SEARCHED))}


async def _require_within(connection: AsyncConnection, id: str, limits: Limits) -> None:
    c = axes.c
    query = select(func.count(), func.coalesce(func.sum(c.phases), 0)).where(c.document == id, c.removed.is_(None))
    count, phases = (await connection.execute(query)).one()
    if count > limits.axes:
        raise ExcessError("axes", limits.axes)
    if phases > limits.phases:
        raise ExcessError("phases", limits.phases)


async def freeze(
    connection: AsyncConnection, id: str, version: int, draft: RevisionDraft, limits: Limits, once: Once | None = None
) -> str | None:
    """Label of the new revision, or of the one that the same key has made; None where the document has changed or is
    not saved.

    Raises LabelTakenError, ExcessError, and as `take`.
    """
    machine = await _lock_row(connection, id)
    if machine is None:
        return None
    if once is not None and (before := await take(connection, once.key, once.digest, id)) is not None:
        return before.part
    if machine.version != version or machine.saved is None:
        return None
    c, now, number = revisions.c, datetime.now(UTC), machine.revisions + 1
    same = select(c.label).where(c.document == id, c.label_key == draft.label.casefold())
    if (await connection.execute(same)).one_or_none() is not None:
        raise LabelTakenError(draft.label)
    if number > limits.revisions:
        raise ExcessError("revisions", limits.revisions)
    if draft.catalogue is not None:
        await keep_catalogue(connection, draft.catalogue_version, draft.catalogue)
    await insert_revision(connection, id, number, draft, now)
    values: Row = {"revisions": number, "revision": draft.label, "updated": now, "revised": now}
    values |= {"changes": 0, **draft.head}
    values |= await _search_values(connection, id, values)
    if draft.axis is not None:
        values |= await _working_copy(connection, id, draft, draft.axis, now)
    if draft.head:
        verdict = draft.head.get("selected"), draft.head.get("status")
        values |= of_today(draft.engine_version, draft.catalogue_version, *verdict)
    await connection.execute(update(documents).where(documents.c.id == id).values(values))
    if draft.axis is not None:
        await recount(connection, id, now)
    if once is not None:
        await keep_part(connection, once.key, draft.label)
    return draft.label


async def _working_copy(
    connection: AsyncConnection, id: str, draft: RevisionDraft, axis: AxisDraft, now: datetime
) -> Row:
    """Make an axis the working copy of a selection; returns the columns of the document that change with it.

    Common values become empty: the axis's application is complete.
    """
    c = axes.c
    row = axis_row(axis, now, draft.created_by or draft.author) | {"version": c.version + 1}
    await connection.execute(update(axes).where(c.document == id, c.removed.is_(None)).values(row))
    return {"common": "{}", "version": documents.c.version + 1, "bytes": len(axis.application)}


LINE = [revisions.c[each.name] for each in fields(RevisionLine)]


async def read_revisions(connection: AsyncConnection, id: str) -> list[RevisionLine]:
    """Revisions of a document, the latest first."""
    query = select(*LINE).where(revisions.c.document == id).order_by(revisions.c.number.desc())
    return [RevisionLine(*row) for row in await connection.execute(query)]


async def read_revision(connection: AsyncConnection, id: str, label: str) -> tuple[RevisionLine, bytes] | None:
    """Revision with a label, in any case, and its content."""
    c = revisions.c
    query = select(*LINE, c.content_packed).where(c.document == id, c.label_key == label.casefold())
    row = (await connection.execute(query)).one_or_none()
    return None if row is None else (RevisionLine(*row[:-1]), unpacked(row[-1]))


async def read_contents(connection: AsyncConnection, id: str, most: int) -> dict[int, bytes]:
    """Contents of the latest revisions of a document, by their numbers."""
    c = revisions.c
    query = select(c.number, c.content_packed).where(c.document == id).order_by(c.number.desc()).limit(most)
    return {number: unpacked(content) for number, content in await connection.execute(query)}

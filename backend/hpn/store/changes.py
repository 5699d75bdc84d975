"""Changes of a document's working copy and its revisions, each for the state that its maker has seen."""

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
    """Most axes that are there, phases or moves of them, and revisions of a document."""

    axes: int
    phases: int
    revisions: int


@dataclass(frozen=True, slots=True)
class Change:
    """Changes of a document that is in version `version`.

    `values` are columns of its title block and common values; `order` the numbers of the axes that are there. Axes that
    change, are answered anew or go are named with the version that was seen; those that come back by their numbers.
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
    connection: AsyncConnection, id: str, made: Change, limits: Limits, once: Once | None = None
) -> list[int] | None:
    """Numbers of the axes that are new or back; None where document or axis is not in the version that was seen.

    Raises ExcessError beyond the limits, and KeyReusedError and KeySpentError as `take`; the same key gives the numbers
    that it gave before.
    """
    machine = await _locked(connection, id)
    if machine is None:
        return None
    if once is not None and (before := await take(connection, once.key, once.digest, id)) is not None:
        return order_of(before.part or "[]")
    if machine.version != made.version or not await _as_seen(connection, id, made):
        return None
    now, order = datetime.now(UTC), order_of(machine.axis_order)
    numbers = [machine.numbers + place for place in range(1, len(made.new) + 1)]
    await insert_axes(connection, id, list(zip(numbers, made.new, strict=True)), now, made.by)
    await _update_axes(connection, id, made, now, order)
    values = await _document_values(connection, id, made, order, numbers)
    if made.is_of_document:
        values["version"] = documents.c.version + 1
    values["numbers"] = machine.numbers + len(numbers)
    if machine.saved is None:  # what nobody has saved is bounded in bytes
        own = select(func.coalesce(func.sum(func.length(axes.c.application)), 0)).where(axes.c.document == id)
        values["bytes"] = own.scalar_subquery()
    await connection.execute(update(documents).where(documents.c.id == id).values(values))
    await recount(connection, id, now)
    await _require_within(connection, id, limits)
    numbers += [number for number, _ in made.restored]
    if once is not None:
        await keep_part(connection, once.key, order_text(numbers))
    return numbers


async def _locked(connection: AsyncConnection, id: str) -> Any:
    """The document, which no other transaction changes until this one ends."""
    c = documents.c
    columns = (c.version, c.axis_order, c.numbers, c.revisions, c.saved)
    query = select(*columns).where(c.id == id, alive()).with_for_update()
    return (await connection.execute(query)).one_or_none()


async def _as_seen(connection: AsyncConnection, id: str, made: Change) -> bool:
    """True where every axis of a change is in the version that was seen."""
    named = [(number, version) for number, version, _ in (*made.changed, *made.answered)]
    seen: dict[int, int] = dict([*named, *made.removed])
    if not seen and not made.restored:
        return True
    c = axes.c
    query = select(c.number, c.version, c.removed).where(c.document == id)
    if len(seen) + len(made.restored) < 100:
        query = query.where(c.number.in_([*seen, *(number for number, _ in made.restored)]))
    there, gone = {}, set()
    for number, version, removed in await connection.execute(query):
        if removed is None:
            there[number] = version
        else:
            gone.add(number)
    return all(there.get(number) == version for number, version in seen.items()) and all(
        number in gone for number, _ in made.restored
    )


async def _update_axes(connection: AsyncConnection, id: str, made: Change, now: datetime, order: list[int]) -> None:
    """Write what changes of axes that there are."""
    c = axes.c
    one = update(axes).where(c.document == id, c.number == bindparam("row"))
    changed = [{"row": number, **axis_row(axis, now, made.by)} for number, _, axis in made.changed]
    answered = [{"row": number, **answer, "today_of": None} for number, _, answer in made.answered]
    back = [{"row": number, **answer, "today_of": None, "removed": None} for number, answer in made.restored]
    counted = one.values(version=c.version + 1)
    for statement, rows in ((counted, changed), (one, answered), (counted, back)):
        if rows:
            await connection.execute(statement, rows)
    for number, _ in made.removed:
        gone = {"removed": now, "updated": now, "updated_by": made.by, "version": c.version + 1}
        await connection.execute(update(axes).where(c.document == id, c.number == number).values(gone))
        order.remove(number)


async def _document_values(
    connection: AsyncConnection, id: str, made: Change, order: list[int], numbers: list[int]
) -> Row:
    """Columns of a document that change with it."""
    values: Row = dict(made.values)
    if made.order is not None:
        order[:] = made.order
    order += [*numbers, *(number for number, _ in made.restored)]
    values["axis_order"] = order_text(order)
    return values | await _search_values(connection, id, values)


async def _search_values(connection: AsyncConnection, id: str, values: Row) -> Row:
    """Text by which a document is found, where values change that stand in it."""
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
    """Label of the new revision, or of the one that the same key has made; None where the document has changed.

    Raises LabelTakenError, ExcessError, and as `take`.
    """
    machine = await _locked(connection, id)
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
    values: Row = {"revisions": number, "revision": draft.label, "updated": now, **draft.head}
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
    """Make an axis the working copy of a selection; columns of the document that change with it.

    Common values end with it: its application is whole.
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
    """The revision of a label in any case, and what is frozen in it."""
    c = revisions.c
    query = select(*LINE, c.content_packed).where(c.document == id, c.label_key == label.casefold())
    row = (await connection.execute(query)).one_or_none()
    return None if row is None else (RevisionLine(*row[:-1]), unpacked(row[-1]))

"""Statements of a transaction that saves, renames or deletes a document."""

import asyncio
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime, timedelta
from types import SimpleNamespace
from typing import Any

import brotli
import msgspec
import orjson
from sqlalchemy import ColumnElement, case, delete, func, or_, select, update
from sqlalchemy.ext.asyncio import AsyncConnection

from hpn.catalogue import Catalogue
from hpn.catalogue.copy import copy_of
from hpn.store.keys import insert_new, spend, take
from hpn.store.records import LISTS, AxisDraft, DocumentKind, RevisionDraft
from hpn.store.saved import Draft, packed, search_text
from hpn.store.tables import axes, catalogues, deletions, documents, revisions

DELETIONS_LISTED = timedelta(days=366)
SAVED_LABEL = "saved"
"""Label of the first revision where its author gives none."""

Row = dict[str, Any]


async def insert(connection: AsyncConnection, draft: Draft) -> str:
    """Id of the new selection, or of the one that the same idempotency key has saved before; raises as `take`."""
    if draft.idempotency_key is not None:
        earlier = await take(connection, draft.idempotency_key, draft.digest, draft.id)
        if earlier is not None:
            return earlier.document
    if draft.catalogue is not None:
        await keep_catalogue(connection, draft.catalogue_version, draft.catalogue)
    axis = AxisDraft(draft.application, draft.phases, draft.columns, ordering_code=draft.ordering_code)
    now = datetime.now(UTC)
    if await insert_new(connection, documents, _selection_row(draft, now)):
        await insert_axes(connection, draft.id, [(1, axis)], now, draft.owner)
        await insert_revision(connection, draft.id, 1, _first_revision(draft), now)
    return draft.id


def _selection_row(draft: Draft, now: datetime) -> Row:
    named = ("title", "reference", "author", "revision", "ordering_code", "owner")
    judged = ("selected", "designation", "status", "utilisation", "engine_version", "catalogue_version")
    return {
        **{name: getattr(draft, name) for name in (*named, *judged)},
        **counts_of([draft.status or "open"]),
        **of_today(draft.engine_version, draft.catalogue_version, draft.selected, draft.status),
        "id": draft.id,
        "kind": "selection",
        "created": now,
        "updated": now,
        "saved": now,
        "search_text": _search_text(draft),
        "numbers": 1,
        "revisions": 1,
        "revised": now,
        "axis_order": "[1]",
        "bytes": len(draft.application),
    }


def _first_revision(draft: Draft) -> RevisionDraft:
    """First revision of a selection: its page and its files show it from then on."""
    own, answer = msgspec.Raw(draft.application), draft.columns
    lists = {name: msgspec.Raw(answer[name].encode()) for name in LISTS}
    axis: Row = {
        "number": 1,
        "name": None,
        "quantity": 1,
        "note": None,
        "ordering_code": draft.ordering_code,
        "without": (),
    }
    axis |= {"application": own, "resolved": own, "answer": {**answer, **lists}}
    block = {"title": draft.title, "reference": draft.reference, "author": draft.author, "note": None}
    return RevisionDraft(
        label=draft.label,
        content=msgspec.json.encode({**block, "common": {}, "axes": [axis]}),
        axes=1,
        engine_version=draft.engine_version,
        catalogue_version=draft.catalogue_version,
        author=draft.author,
        note=None if draft.label == draft.revision else draft.revision,
        created_by=draft.owner,
        result=draft.result,
    )


async def insert_axes(
    connection: AsyncConnection, document: str, drafts: Sequence[tuple[int, AxisDraft]], now: datetime, by: str | None
) -> None:
    """Insert new axes by their numbers."""
    rows = [{"document": document, "number": number, **axis_row(axis, now, by)} for number, axis in drafts]
    if rows:
        await connection.execute(axes.insert(), rows)


def axis_row(axis: AxisDraft, now: datetime, by: str | None) -> Row:
    """Columns of an axis."""
    named = ("name", "quantity", "note", "ordering_code", "without", "phases")
    own = {name: getattr(axis, name) for name in named} | {"application": axis.application.decode()}
    return own | dict(axis.answer) | {"updated": now, "updated_by": by, "today_of": None}


async def insert_revision(
    connection: AsyncConnection, document: str, number: int, draft: RevisionDraft, now: datetime
) -> None:
    """Insert a revision, which never changes afterwards."""
    same = ("label", "axes", "engine_version", "catalogue_version", "author", "checked", "approved", "note")
    row = {name: getattr(draft, name) for name in (*same, "created_by")} | {"document": document, "number": number}
    row |= {"label_key": draft.label.casefold(), "created": now, "content_packed": packed(draft.content)}
    row["result_packed"] = None if draft.result is None else packed(draft.result)
    await connection.execute(revisions.insert(), row)


def of_today(engine: str, catalogue: str, selected: str | None = None, status: str | None = None) -> Row:
    """Columns of a document that was answered a moment ago: today's verdict is its own."""
    own: Row = {"today_of": f"{engine} {catalogue}", "today_changed": 0, "today_axes": "[]"}
    return own | {"today_selected": selected, "today_status": status}


def counts_of(states: Sequence[str]) -> Row:
    """Number of axes, and numbers by status."""
    return {"axes": len(states), **{state: states.count(state) for state in ("suitable", "unsuitable", "open")}}


async def recount(connection: AsyncConnection, document: str, now: datetime) -> None:
    """Update the counts of a document from its axes."""
    c, d = axes.c, documents.c

    def of(state: str) -> ColumnElement[int]:
        return func.count(case((c.status == state, 1)))

    versions = c.engine_version + " " + c.catalogue_version
    query = select(
        *(func.count(), of("suitable"), of("unsuitable"), of("open"), func.min(versions), func.max(versions)),
        *_gears(),
    )
    there = (c.document == document, c.removed.is_(None))
    total, suitable, unsuitable, open, oldest, newest, gears, kinds, weight_kg = (
        await connection.execute(query.where(*there))
    ).one()
    values: Row = {"axes": total, "suitable": suitable, "unsuitable": unsuitable, "open": open, "updated": now}
    await connection.execute(update(documents).where(d.id == document).values(values))
    most = select(c.number, c.utilisation).where(*there, c.status == "suitable", c.utilisation.is_not(None))
    governing = (await connection.execute(most.order_by(c.utilisation.desc(), c.number).limit(1))).one_or_none()
    number, used = governing or (None, None)
    values = {"gears": gears or 0, "kinds": kinds, "weight_kg": weight_kg}
    values |= {"governing_axis": number, "utilisation": used, "today_changed": 0, "today_axes": "[]"}
    if total:
        values["today_of"] = newest if oldest == newest else None
    await connection.execute(update(documents).where(d.id == document, d.kind == "machine").values(values))
    await recount_changes(connection, document)


def _gears() -> tuple[ColumnElement[Any], ...]:
    """Number of gears, number of their kinds, and their mass in kg; null where the kind or mass of one is unknown.

    An open axis with an ordering code has a gear to order; no answer names its kind and mass.
    """
    c = axes.c
    gear = case((c.ordering_code.is_(None), c.selected), else_=c.designation)
    has_gear = or_(c.ordering_code.is_not(None), c.selected.is_not(None))
    open_, unknown = (func.count(case((has_gear & each.is_(None), 1))) for each in (gear, c.weight_kg))
    mass = func.coalesce(func.sum(case((has_gear, c.quantity * c.weight_kg))), 0.0)
    kinds = case((open_ == 0, func.count(gear.distinct())))
    return func.sum(case((has_gear, c.quantity))), kinds, case((unknown == 0, mass))


async def recount_changes(connection: AsyncConnection, document: str) -> None:
    """Update the number of changes since the latest revision of a document."""
    c, d = axes.c, documents.c
    changed = select(func.count()).where(c.document == document, c.updated > d.revised).scalar_subquery()
    count = changed + case((d.edited > d.revised, 1), else_=0)
    await connection.execute(update(documents).where(d.id == document).values(changes=count))


def _search_text(named: Any) -> str:
    """Text for searches of a document, from the columns SEARCHED."""
    return search_text(named.title, named.reference, named.author, named.ordering_code, named.designation)


async def keep_catalogue(connection: AsyncConnection, version: str, catalogue: Catalogue) -> None:
    """Keep a copy of a catalogue, unless its version is kept already."""
    known = select(catalogues.c.version).where(catalogues.c.version == version)
    if (await connection.execute(known)).one_or_none() is None:
        content = await asyncio.to_thread(lambda: brotli.compress(copy_of(catalogue)))
        await insert_new(connection, catalogues, {"version": version, "content_brotli": content})


SEARCHED = ("title", "reference", "author", "ordering_code", "designation")


async def rename(
    connection: AsyncConnection,
    id: str,
    names: Mapping[str, str | None],
    version: int | None = None,
    kind: DocumentKind | None = None,
) -> bool:
    """Change parts of the title block of a saved document; False where there is none, or where its version differs."""
    c = documents.c
    state = [*in_version(id, version, kind), c.saved.is_not(None)]
    row = (
        await connection.execute(select(*(c[name] for name in SEARCHED)).where(*state).with_for_update())
    ).one_or_none()
    if row is None:
        return False
    search = _search_text(SimpleNamespace(**{**row._asdict(), **names}))
    now = datetime.now(UTC)
    values = {**names, "search_text": search, "version": c.version + 1, "updated": now, "edited": now}
    await connection.execute(update(documents).where(*state).values(values))
    await recount_changes(connection, id)
    return True


async def remove(
    connection: AsyncConnection, id: str, version: int | None = None, kind: DocumentKind | None = None
) -> bool:
    """Delete a document with its axes and revisions, list the deletion, and mark its idempotency keys as spent; False
    as `rename`."""
    c, now = documents.c, datetime.now(UTC)
    query = delete(documents).where(*in_version(id, version, kind)).returning(c.kind, c.saved)
    row = (await connection.execute(query)).one_or_none()
    if row is None:
        return False
    await spend(connection, id, now)
    if row.saved is not None:
        await connection.execute(delete(deletions).where(deletions.c.deleted < now - DELETIONS_LISTED))
        await insert_new(connection, deletions, {"document": id, "kind": row.kind, "deleted": now})
    return True


def in_version(id: str, version: int | None, kind: DocumentKind | None = None) -> list[ColumnElement[bool]]:
    """Condition for a document in the version that the caller has seen, so not for a changed one. None: any version."""
    c = documents.c
    conditions = [c.id == id, *([] if version is None else [c.version == version])]
    return conditions if kind is None else [*conditions, c.kind == kind]


def order_of(text: str) -> list[int]:
    """Numbers of axes in their order, from the text of the column."""
    numbers: list[int] = orjson.loads(text)
    return numbers


def order_text(numbers: Sequence[int]) -> str:
    """Text of the column for numbers of axes in their order."""
    return orjson.dumps(numbers).decode()

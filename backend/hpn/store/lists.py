"""Lists of saved documents: filtered, sorted, and read part by part with a cursor."""

import base64
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from datetime import UTC, datetime
from math import isfinite
from typing import Any, Literal, TypeVar

from sqlalchemy import ColumnElement, Double, cast, exists, func, literal, or_, select, tuple_
from sqlalchemy.ext.asyncio import AsyncConnection

from hpn.store.machines import AXIS, axis_in
from hpn.store.records import DocumentKind, DocumentLine, MachineLine, MachineList
from hpn.store.saved import SelectionLine
from hpn.store.tables import UtcTime, axes, documents

T = TypeVar("T", DocumentLine, MachineLine, SelectionLine)

ID = re.compile(r"[A-Za-z0-9_-]{22}")
"""Id: 128 random bits."""

Sorting = Literal[
    "saved",
    "-saved",
    "created",
    "-created",
    "updated",
    "-updated",
    "title",
    "-title",
    "reference",
    "-reference",
    "utilisation",
    "-utilisation",
    "axes",
    "-axes",
    "weight",
    "-weight",
]
"""Orders of a list; a minus puts the last, the newest or the largest first."""

NEWEST: Sorting = "-saved"


@dataclass(frozen=True, slots=True)
class LineFilter:
    """Filters of a list of saved documents, None for no filter, and its order."""

    kind: DocumentKind | None = "machine"
    search: str | None = None
    reference: str | None = None
    author: str | None = None
    selected: str | None = None
    updated_since: datetime | None = None
    created_since: datetime | None = None
    todo: bool = False
    """True for documents with an axis without a suitable gear, or with changes that are in no revision."""
    owner: str | None = None
    changed_by: str | None = None
    """Versions of engine and catalogue: only documents that get another verdict by them."""
    sort: Sorting = NEWEST

    def conditions(self) -> Iterator[ColumnElement[bool]]:
        """Conditions for the rows of `documents` that pass the filter."""
        c = documents.c
        yield c.saved.is_not(None)
        for name in ("kind", "reference", "author", "owner"):
            if (value := getattr(self, name)) is not None:
                yield c[name] == value
        for word in (self.search or "").split():
            yield or_(c.search_text.contains(word.casefold(), autoescape=True), _has_axis(word))
        if self.selected is not None:
            own = (axes.c.document == c.id, axes.c.removed.is_(None), axes.c.selected == self.selected)
            yield exists().where(*own)
        if self.updated_since is not None:
            yield c.updated >= self.updated_since
        if self.created_since is not None:
            yield c.created >= self.created_since
        if self.todo:
            yield or_(c.suitable < c.axes, c.changes > 0)
        if self.changed_by is not None:
            yield c.today_of == self.changed_by
            yield c.today_changed > 0


async def read_lines(
    connection: AsyncConnection, record: type[T], filter: LineFilter, cursor: str | None, limit: int
) -> tuple[list[T], str | None]:
    """Saved documents as records of a type, and a cursor to the next part; ValueError for an invalid cursor."""
    name, is_falling = filter.sort.lstrip("-"), filter.sort.startswith("-")
    key, c = _key(name), documents.c
    columns = [c[field.name] for field in fields(record)]
    order = (key.desc(), c.id.desc()) if is_falling else (key, c.id)
    query = select(*columns, key).where(*filter.conditions()).order_by(*order).limit(limit + 1)
    if cursor is not None:
        last = _position(cursor, name)
        query = query.where(tuple_(key, c.id) < tuple_(*last) if is_falling else tuple_(key, c.id) > tuple_(*last))
    rows = list(await connection.execute(query))
    lines = [record(*row[:-1]) for row in rows[:limit]]
    return lines, _cursor(rows[limit - 1][-1], lines[-1].id) if len(rows) > limit else None


async def read_machine_lines(
    connection: AsyncConnection,
    filter: LineFilter,
    filters: Mapping[str, LineFilter],
    cursor: str | None,
    limit: int,
) -> MachineList:
    """Machines as their page lists them, and the number of machines of each filter; ValueError as `read_lines`."""
    lines, following = await read_lines(connection, MachineLine, filter, cursor, limit)
    c = documents.c
    governing = select(c.id, *AXIS).join(axes, (axes.c.document == c.id) & (axes.c.number == c.governing_axis))
    rows = await connection.execute(governing.where(c.id.in_([line.id for line in lines])))
    by_id = {row[0]: axis_in(row[1:]) for row in rows}
    counted = [select(func.count()).select_from(documents).where(*each.conditions()) for each in filters.values()]
    counts = [(await connection.execute(query)).scalar_one() for query in counted]
    return MachineList(lines, by_id, following, dict(zip(filters, counts, strict=True)))


def _has_axis(word: str) -> ColumnElement[bool]:
    """Condition for a document with an axis whose name, gear or ordering code contains a word, in any case (as far as
    the database knows cases)."""
    escaped = word.translate({ord(sign): f"/{sign}" for sign in "/%_"})
    pattern, c = func.lower(f"%{escaped}%"), axes.c
    named = [func.lower(each).like(pattern, escape="/") for each in (c.name, c.designation, c.ordering_code)]
    return exists().where(c.document == documents.c.id, c.removed.is_(None), or_(*named))


TIMES, NUMBERS = ("saved", "created", "updated"), ("utilisation", "axes", "weight")


def _key(name: str) -> ColumnElement[Any]:
    """Key of an order of documents; a missing title or figure sorts before all others."""
    column: ColumnElement[Any] = documents.c["weight_kg" if name == "weight" else name]
    if name in TIMES:
        return column
    return func.coalesce(cast(column, Double), -1.0) if name in NUMBERS else func.lower(func.coalesce(column, ""))


def _cursor(value: Any, id: str) -> str:
    text = value.isoformat() if isinstance(value, datetime) else str(value)
    return base64.urlsafe_b64encode(f"{text} {id}".encode()).decode()


def _position(cursor: str, name: str) -> tuple[ColumnElement[Any], ColumnElement[str]]:
    """Value and id in a cursor of a list that is sorted by a column; ValueError for an invalid cursor."""
    try:
        text, _, id = base64.urlsafe_b64decode(cursor.encode()).decode().rpartition(" ")
        if not ID.fullmatch(id) or "\0" in text:
            raise ValueError
        value: ColumnElement[Any] = literal(text)
        if name in TIMES:
            value = literal(datetime.fromisoformat(text).astimezone(UTC), UtcTime)
        elif name in NUMBERS:
            if not isfinite(number := float(text)):
                raise ValueError
            value = literal(number, Double)
    except (ValueError, OverflowError):
        raise ValueError("is not a cursor that this list has given") from None
    return value, literal(id)

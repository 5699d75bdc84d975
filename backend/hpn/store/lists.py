"""Lists of saved documents: filtered, sorted, in parts that follow one another by a cursor."""

import base64
import re
from collections.abc import Iterator
from dataclasses import dataclass, fields
from datetime import UTC, datetime
from math import isfinite
from typing import Any, Literal, TypeVar

from sqlalchemy import ColumnElement, Double, cast, exists, func, literal, select, tuple_
from sqlalchemy.ext.asyncio import AsyncConnection

from hpn.store.records import DocumentKind, DocumentLine
from hpn.store.saved import SelectionLine, search_text
from hpn.store.tables import UtcTime, axes, documents

T = TypeVar("T", DocumentLine, SelectionLine)

ID = re.compile(r"[A-Za-z0-9_-]{22}")
"""An id: 128 random bits."""

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
]
"""Orders of a list; with a minus the last, the newest or the largest comes first."""

NEWEST: Sorting = "-saved"


@dataclass(frozen=True, slots=True)
class LineFilter:
    """Which saved documents a list has, None for whichever, and their order."""

    kind: DocumentKind | None = "machine"
    search: str | None = None
    reference: str | None = None
    author: str | None = None
    selected: str | None = None
    updated_since: datetime | None = None
    created_since: datetime | None = None
    todo: bool = False
    """Only those with an axis that has no suitable gear."""
    changed_by: str | None = None
    """Only those with another verdict by these versions of engine and catalogue."""
    sort: Sorting = NEWEST

    def conditions(self) -> Iterator[ColumnElement[bool]]:
        """Conditions for them."""
        c = documents.c
        yield c.saved.is_not(None)
        for name in ("kind", "reference", "author"):
            if (value := getattr(self, name)) is not None:
                yield c[name] == value
        for word in search_text(self.search).split():
            yield c.search_text.contains(word, autoescape=True)
        if self.selected is not None:
            own = (axes.c.document == c.id, axes.c.removed.is_(None), axes.c.selected == self.selected)
            yield exists().where(*own)
        if self.updated_since is not None:
            yield c.updated >= self.updated_since
        if self.created_since is not None:
            yield c.created >= self.created_since
        if self.todo:
            yield c.suitable < c.axes
        if self.changed_by is not None:
            yield c.today_of == self.changed_by
            yield c.today_changed > 0


async def read_lines(
    connection: AsyncConnection, record: type[T], wanted: LineFilter, cursor: str | None, limit: int
) -> tuple[list[T], str | None]:
    """Saved documents as records of a kind, and a cursor to those that follow; ValueError for one that isn't."""
    name, is_falling = wanted.sort.lstrip("-"), wanted.sort.startswith("-")
    key, c = _key(name), documents.c
    columns = [c[field.name] for field in fields(record)]
    order = (key.desc(), c.id.desc()) if is_falling else (key, c.id)
    query = select(*columns, key).where(*wanted.conditions()).order_by(*order).limit(limit + 1)
    if cursor is not None:
        last = _position(cursor, name)
        query = query.where(tuple_(key, c.id) < tuple_(*last) if is_falling else tuple_(key, c.id) > tuple_(*last))
    rows = list(await connection.execute(query))
    lines = [record(*row[:-1]) for row in rows[:limit]]
    return lines, _cursor(rows[limit - 1][-1], lines[-1].id) if len(rows) > limit else None


TIMES, NUMBERS = ("saved", "created", "updated"), ("utilisation", "axes")


def _key(name: str) -> ColumnElement[Any]:
    """Value by which a document is sorted; one without a title comes before all with one."""
    column: ColumnElement[Any] = documents.c[name]
    if name in TIMES:
        return column
    return func.coalesce(cast(column, Double), -1.0) if name in NUMBERS else func.lower(func.coalesce(column, ""))


def _cursor(value: Any, id: str) -> str:
    text = value.isoformat() if isinstance(value, datetime) else str(value)
    return base64.urlsafe_b64encode(f"{text} {id}".encode()).decode()


def _position(cursor: str, name: str) -> tuple[ColumnElement[Any], ColumnElement[str]]:
    """Value and id that a cursor stands for in a list that is sorted by a column."""
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

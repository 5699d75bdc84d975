"""Lists of motors saved under a name, unique for each owner."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import ColumnElement, delete, func, select, update
from sqlalchemy.exc import IntegrityError
from sqlalchemy.ext.asyncio import AsyncConnection

from hpn.store.errors import ListsSpentError, NameTakenError
from hpn.store.records import new_id
from hpn.store.saved import packed, unpacked
from hpn.store.tables import motor_lists

MOST_LISTS = 200
"""Most lists of one owner; lists without an owner count together."""


@dataclass(frozen=True, slots=True)
class MotorListDraft:
    """List to save: its name, the number of its motors, and the motors as JSON."""

    name: str
    motors: int
    content: bytes = field(repr=False)


@dataclass(frozen=True, slots=True)
class MotorListLine:
    """Line of the lists of motors; `version` counts changes from 1, `owner` is a key's name, blank without a key."""

    id: str
    owner: str
    name: str
    created: datetime
    updated: datetime
    version: int
    motors: int


@dataclass(frozen=True, slots=True)
class SavedMotorList(MotorListLine):
    """List of motors with its content as JSON."""

    content: bytes = field(repr=False, kw_only=True)


_LINE = [motor_lists.c[name] for name in MotorListLine.__dataclass_fields__]


async def add_list(connection: AsyncConnection, draft: MotorListDraft, owner: str) -> str:
    """Id of a new list; raises NameTakenError, and ListsSpentError beyond MOST_LISTS."""
    c = motor_lists.c
    count = (await connection.execute(select(func.count()).where(c.owner == owner))).scalar_one()
    if count >= MOST_LISTS:
        raise ListsSpentError
    now, id = datetime.now(UTC), new_id()
    row = {**_row(draft), "id": id, "owner": owner, "created": now, "updated": now}
    try:
        await connection.execute(motor_lists.insert(), row)
    except IntegrityError:
        raise NameTakenError from None
    return id


async def replace_list(connection: AsyncConnection, id: str, draft: MotorListDraft, version: int | None) -> bool:
    """Replace a list; False where there is none, or where its version differs. Raises NameTakenError."""
    c = motor_lists.c
    values = {**_row(draft), "version": c.version + 1, "updated": datetime.now(UTC)}
    replaced = update(motor_lists).where(*_in_version(id, version)).values(values).returning(c.id)
    try:
        return (await connection.execute(replaced)).one_or_none() is not None
    except IntegrityError:
        raise NameTakenError from None


async def remove_list(connection: AsyncConnection, id: str, version: int | None) -> bool:
    """Delete a list; False as `replace_list`. Applications keep the figures of its motors: they are copies."""
    query = delete(motor_lists).where(*_in_version(id, version)).returning(motor_lists.c.id)
    return (await connection.execute(query)).one_or_none() is not None


async def read_list(connection: AsyncConnection, id: str) -> SavedMotorList | None:
    """List with this id, or None."""
    c = motor_lists.c
    row = (await connection.execute(select(*_LINE, c.content_packed).where(c.id == id))).one_or_none()
    return None if row is None else SavedMotorList(*row[:-1], content=unpacked(row.content_packed))


async def read_lists(connection: AsyncConnection) -> Sequence[MotorListLine]:
    """All lists, in the order of their names."""
    c = motor_lists.c
    rows = await connection.execute(select(*_LINE).order_by(c.name_key, c.owner))
    return [MotorListLine(*row) for row in rows]


def _row(draft: MotorListDraft) -> dict[str, Any]:
    return {
        "name": draft.name,
        "name_key": draft.name.casefold(),
        "motors": draft.motors,
        "content_packed": packed(draft.content),
    }


def _in_version(id: str, version: int | None) -> list[ColumnElement[bool]]:
    """Condition for a list in the version that the caller has seen; None: any version."""
    c = motor_lists.c
    return [c.id == id, *([] if version is None else [c.version == version])]

"""Lists of motors that people keep under a name; each has the owner's name once."""

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
"""Lists of one owner, at most; those without one count together."""


@dataclass(frozen=True, slots=True)
class MotorListDraft:
    """A list to be kept: its name, the number of its motors, and these as JSON."""

    name: str
    motors: int
    content: bytes = field(repr=False)


@dataclass(frozen=True, slots=True)
class MotorListLine:
    """One line of the lists of motors; `version` counts changes from 1, `owner` is a key's name, blank without one."""

    id: str
    owner: str
    name: str
    created: datetime
    updated: datetime
    version: int
    motors: int


@dataclass(frozen=True, slots=True)
class SavedMotorList(MotorListLine):
    """A list of motors with its content as JSON."""

    content: bytes = field(repr=False)


_LINE = [motor_lists.c[name] for name in MotorListLine.__dataclass_fields__]


async def add_list(connection: AsyncConnection, draft: MotorListDraft, owner: str) -> str:
    """Id of a new list; raises NameTakenError, and ListsSpentError beyond what an owner may have."""
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
    """Replace a list; False where there is none, or none in the version given. Raises NameTakenError."""
    c = motor_lists.c
    values = {**_row(draft), "version": c.version + 1, "updated": datetime.now(UTC)}
    replaced = update(motor_lists).where(*_in_version(id, version)).values(values).returning(c.id)
    try:
        return (await connection.execute(replaced)).one_or_none() is not None
    except IntegrityError:
        raise NameTakenError from None


async def remove_list(connection: AsyncConnection, id: str, version: int | None) -> bool:
    """Delete a list; False as `replace_list`. What has been taken from it stays: figures are copied."""
    gone = delete(motor_lists).where(*_in_version(id, version)).returning(motor_lists.c.id)
    return (await connection.execute(gone)).one_or_none() is not None


async def read_list(connection: AsyncConnection, id: str) -> SavedMotorList | None:
    """The list with this id, or None."""
    c = motor_lists.c
    row = (await connection.execute(select(*_LINE, c.content_packed).where(c.id == id))).one_or_none()
    return None if row is None else SavedMotorList(**_named(row), content=unpacked(row.content_packed))


async def read_lists(connection: AsyncConnection) -> Sequence[MotorListLine]:
    """All lists by their names."""
    c = motor_lists.c
    rows = await connection.execute(select(*_LINE).order_by(c.name_key, c.owner))
    return [MotorListLine(**_named(row)) for row in rows]


def _named(row: Any) -> dict[str, Any]:
    """Columns of a line by their names."""
    return {name: getattr(row, name) for name in MotorListLine.__dataclass_fields__}


def _row(draft: MotorListDraft) -> dict[str, Any]:
    return {
        "name": draft.name,
        "name_key": draft.name.casefold(),
        "motors": draft.motors,
        "content_packed": packed(draft.content),
    }


def _in_version(id: str, version: int | None) -> list[ColumnElement[bool]]:
    """Condition for a list in the version that somebody has seen; None: any."""
    c = motor_lists.c
    return [c.id == id, *([] if version is None else [c.version == version])]

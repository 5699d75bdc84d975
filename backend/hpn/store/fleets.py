"""Records of fleets, and the statements of the transactions on them.

A fleet is kept for a day when it is calculated, and for good when it is saved; it is then only renamed and deleted.
"""

import secrets
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime, timedelta
from typing import Any

from sqlalchemy import delete, func, or_, select, text, tuple_, update
from sqlalchemy.ext.asyncio import AsyncConnection

from hpn.store.errors import NoRoomError, ShareSpentError
from hpn.store.tables import fleets
from hpn.store.writing import in_version

UNSAVED_LASTS = timedelta(days=1)
MOST_OF_CALLER = 20
"""Fleets of one caller that are kept without being saved."""

LOCK = 0x48504F  # any number but that of the migrations: who adds a fleet on PostgreSQL counts what there is alone


@dataclass(frozen=True, slots=True)
class FleetCounts:
    """Outcome of a fleet in numbers of axes, with engine and catalogue."""

    axes: int
    selected: int
    unsuitable: int
    rejected: int
    engine_version: str
    catalogue_version: str


@dataclass(frozen=True, slots=True)
class FleetDraft(FleetCounts):
    """A fleet that was calculated: counts of its axes, and tables of what they were asked with and of their answers.

    `owner` is the name of the API key that calculated it, None without one; `caller` stands for that key or else the
    address, whose unsaved fleets are counted.
    """

    asked: bytes = field(repr=False)
    answers: bytes = field(repr=False)
    owner: str | None = None
    caller: str = ""


@dataclass(frozen=True, slots=True)
class FleetSummary(FleetCounts):
    """One line of a list of fleets; `saved` is None while it is only calculated, `version` counts changes from 1."""

    id: str
    created: datetime
    saved: datetime | None
    title: str | None
    reference: str | None
    author: str | None
    revision: str | None
    owner: str | None
    version: int


@dataclass(frozen=True, slots=True)
class SavedFleet(FleetSummary):
    """A fleet, whole."""

    asked: bytes = field(repr=False)
    answers: bytes = field(repr=False)


SUMMARY = [fleets.c[name] for name in FleetSummary.__dataclass_fields__]
WHOLE = [fleets.c[name] for name in SavedFleet.__dataclass_fields__]


async def insert_fleet(connection: AsyncConnection, draft: FleetDraft, most_bytes: int) -> str:
    """Id of the new fleet. Those that nobody has saved for a day are gone then, and no other: raises as `require_room`.

    Of two that are added at once, each would fit alone; so they are counted one after the other.
    """
    id, now, c = secrets.token_urlsafe(16), datetime.now(UTC), fleets.c
    if connection.dialect.name == "postgresql":
        await connection.execute(text("SELECT pg_advisory_xact_lock(:lock)"), {"lock": LOCK})
    await connection.execute(delete(fleets).where(c.saved.is_(None), c.created < now - UNSAVED_LASTS))
    await require_room(connection, draft.caller, most_bytes - len(draft.asked) - len(draft.answers))
    await connection.execute(fleets.insert().values(id=id, created=now, **asdict(draft)))
    return id


async def require_room(connection: AsyncConnection, caller: str, most_bytes: int) -> None:
    """Raise ShareSpentError where a caller has enough unsaved fleets, NoRoomError where all take more than that."""
    c = fleets.c
    kept = c.saved.is_(None) & (c.created >= datetime.now(UTC) - UNSAVED_LASTS)
    of_caller = select(func.count()).where(kept, c.caller == caller)
    if (await connection.execute(of_caller)).scalar_one() >= MOST_OF_CALLER:
        raise ShareSpentError(f"{MOST_OF_CALLER} fleets of this caller are kept for a day without being saved")
    taken = select(func.coalesce(func.sum(func.length(c.asked) + func.length(c.answers)), 0)).where(kept)
    if (await connection.execute(taken)).scalar_one() > most_bytes:
        raise NoRoomError("the fleets that nobody has saved take all the room that they may")


async def name_fleet(connection: AsyncConnection, id: str, names: Mapping[str, str | None], owner: str | None) -> bool:
    """Save a calculated fleet under a title and the like; False where there is none that is not saved."""
    values = {**names, "owner": owner, "caller": "", "saved": datetime.now(UTC), "version": fleets.c.version + 1}
    named = update(fleets).where(fleets.c.id == id, fleets.c.saved.is_(None)).values(values).returning(fleets.c.id)
    return (await connection.execute(named)).one_or_none() is not None


async def rename_fleet(
    connection: AsyncConnection, id: str, names: Mapping[str, str | None], version: int | None = None
) -> bool:
    """Give a saved fleet another title or reference; False where there is none, or none in the version given."""
    c = fleets.c
    renamed = update(fleets).where(*in_version(fleets, id, version), c.saved.is_not(None))
    values = {**names, "version": c.version + 1}
    return (await connection.execute(renamed.values(values).returning(c.id))).one_or_none() is not None


async def remove_fleet(connection: AsyncConnection, id: str, version: int | None = None) -> bool:
    """Delete a fleet; False as `rename_fleet`."""
    gone = delete(fleets).where(*in_version(fleets, id, version)).returning(fleets.c.id)
    return (await connection.execute(gone)).one_or_none() is not None


async def read_fleet(connection: AsyncConnection, id: str) -> SavedFleet | None:
    """The fleet with an id; None where there is none, or it has had its time."""
    alive = or_(fleets.c.saved.is_not(None), fleets.c.created >= datetime.now(UTC) - UNSAVED_LASTS)
    row = (await connection.execute(select(*WHOLE).where(fleets.c.id == id, alive))).one_or_none()
    return None if row is None else SavedFleet(*row)


async def read_fleets(
    connection: AsyncConnection, before: tuple[datetime, str] | None, limit: int
) -> list[FleetSummary]:
    """Saved fleets, newest first."""
    c = fleets.c
    query: Any = select(*SUMMARY).where(c.saved.is_not(None)).order_by(c.saved.desc(), c.id.desc()).limit(limit)
    if before is not None:
        query = query.where(tuple_(c.saved, c.id) < tuple_(*before))
    return [FleetSummary(*row) for row in await connection.execute(query)]

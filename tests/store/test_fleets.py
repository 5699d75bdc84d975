"""A fleet is kept for a day when it is calculated, for good when it is saved, and only renamed after that."""

import asyncio
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from sqlalchemy import update

from hpn.store import FleetDraft, NoRoomError, ShareSpentError, Store
from hpn.store.engine import WRITES
from hpn.store.fleets import MOST_OF_CALLER
from hpn.store.tables import fleets

pytestmark = pytest.mark.anyio

MOST_BYTES = 1_000_000
"""Room for what nobody has saved that these tests never fill."""

NAMES: dict[str, str | None] = {"title": "Line 4", "reference": "P-77", "author": None, "revision": "B"}


def draft(**changes: Any) -> FleetDraft:
    """A fleet of five axes."""
    given = {"axes": 5, "selected": 3, "unsuitable": 1, "rejected": 1, "engine_version": "1", "catalogue_version": "c"}
    return FleetDraft(**{**given, "asked": b"PAR1\x00asked", "answers": b"PAR1\xffanswers", **changes})


async def age(store: Store, id: str, by: timedelta) -> None:
    """Have a fleet be as if it was calculated long ago."""
    async with store._engine.execution_options(**WRITES).begin() as connection:
        await connection.execute(update(fleets).where(fleets.c.id == id).values(created=datetime.now(UTC) - by))


async def test_a_calculated_fleet_is_found_and_listed_once_it_is_saved(store: Store) -> None:
    given = draft()
    id = await store.keep_fleet(given, MOST_BYTES)

    found = await store.find_fleet(id)
    assert found is not None and found.saved is None
    assert (found.asked, found.answers, found.axes) == (given.asked, given.answers, 5)
    assert await store.fleets() == ([], None)

    assert await store.save_fleet(id, NAMES, "anna")
    saved = await store.find_fleet(id)
    assert saved is not None and saved.saved is not None
    assert (saved.title, saved.reference, saved.author, saved.revision, saved.owner) == (*NAMES.values(), "anna")
    assert [line.id for line in (await store.fleets())[0]] == [id]


async def test_a_saved_fleet_is_not_saved_again_under_another_name(store: Store) -> None:
    id = await store.keep_fleet(draft(), MOST_BYTES)
    assert await store.save_fleet(id, NAMES, "anna")

    assert not await store.save_fleet(id, {**NAMES, "title": "another"}, "bert")

    found = await store.find_fleet(id)
    assert found is not None and (found.title, found.owner) == ("Line 4", "anna")


async def test_a_saved_fleet_is_renamed_and_nothing_else_of_it_changes(store: Store) -> None:
    id, left = await store.keep_fleet(draft(), MOST_BYTES), await store.keep_fleet(draft(), MOST_BYTES)
    await store.save_fleet(id, NAMES, "anna")
    before = await store.find_fleet(id)

    assert await store.rename_fleet(id, {"title": "Line 5", "reference": None})
    assert not await store.rename_fleet(left, {"title": "not saved", "reference": None})

    assert before is not None
    assert await store.find_fleet(id) == replace(before, title="Line 5", reference=None, version=before.version + 1)


async def test_a_fleet_that_nobody_saves_goes_after_a_day(store: Store) -> None:
    kept, left = await store.keep_fleet(draft(), MOST_BYTES), await store.keep_fleet(draft(), MOST_BYTES)
    await store.save_fleet(kept, NAMES, None)
    for id in (kept, left):
        await age(store, id, timedelta(hours=25))

    assert await store.find_fleet(left) is None
    assert await store.find_fleet(kept) is not None
    await store.keep_fleet(draft(), MOST_BYTES)
    assert not await store.delete_fleet(left)


async def test_fleets_of_others_take_nothing_away_that_is_younger_than_a_day(store: Store) -> None:
    first = await store.keep_fleet(draft(caller="anna"), MOST_BYTES)
    await age(store, first, timedelta(hours=23))

    for number in range(105):
        await store.keep_fleet(draft(caller=f"other {number}"), MOST_BYTES)

    assert await store.find_fleet(first) is not None


async def test_a_caller_has_so_many_unsaved_and_room_again_once_one_is_saved_or_a_day_old(store: Store) -> None:
    ids = [await store.keep_fleet(draft(caller="anna"), MOST_BYTES) for _ in range(MOST_OF_CALLER)]

    with pytest.raises(ShareSpentError):
        await store.require_room("anna", MOST_BYTES)
    with pytest.raises(ShareSpentError):
        await store.keep_fleet(draft(caller="anna"), MOST_BYTES)
    await store.keep_fleet(draft(caller="bert"), MOST_BYTES)

    assert None not in [await store.find_fleet(id) for id in ids]
    await store.save_fleet(ids[0], NAMES, "anna")
    await store.keep_fleet(draft(caller="anna"), MOST_BYTES)
    await age(store, ids[1], timedelta(hours=25))
    await store.keep_fleet(draft(caller="anna"), MOST_BYTES)


async def test_unsaved_fleets_of_all_are_bounded_in_bytes_and_a_new_one_gives_way(store: Store) -> None:
    size = len(draft().asked) + len(draft().answers)
    first = await store.keep_fleet(draft(), 2 * size)
    saved = await store.keep_fleet(draft(), 2 * size)

    with pytest.raises(NoRoomError):
        await store.keep_fleet(draft(caller="other"), 2 * size)
    with pytest.raises(NoRoomError):
        await store.require_room("other", 2 * size - 1)

    assert await store.find_fleet(first) is not None
    await store.save_fleet(saved, NAMES, None)
    await store.keep_fleet(draft(), 2 * size)


async def test_those_that_come_at_once_do_not_pass_the_bounds_together(store: Store) -> None:
    size = len(draft().asked) + len(draft().answers)
    others = [draft(caller=f"other {number}") for number in range(8)]

    of_all = await asyncio.gather(*(store.keep_fleet(one, 3 * size) for one in others), return_exceptions=True)
    of_one = await asyncio.gather(
        *(store.keep_fleet(draft(caller="anna"), MOST_BYTES) for _ in range(MOST_OF_CALLER + 8)), return_exceptions=True
    )

    assert [type(found) for found in of_all].count(str) == 3
    assert [type(found) for found in of_one].count(str) == MOST_OF_CALLER


async def test_fleets_are_listed_newest_first_in_parts(store: Store) -> None:
    ids = [await store.keep_fleet(draft(), MOST_BYTES) for _ in range(3)]
    for id in ids:
        await store.save_fleet(id, NAMES, None)

    first, cursor = await store.fleets(limit=2)
    rest, end = await store.fleets(cursor, limit=2)

    assert [line.id for line in (*first, *rest)] == ids[::-1]
    assert end is None
    with pytest.raises(ValueError, match="cursor"):
        await store.fleets("nonsense")


async def test_a_deleted_fleet_is_gone(store: Store) -> None:
    id = await store.keep_fleet(draft(), MOST_BYTES)

    assert await store.delete_fleet(id)

    assert await store.find_fleet(id) is None
    assert (
        not await store.delete_fleet(id)
        and not await store.delete_fleet("no id")
        and not await store.save_fleet(id, NAMES, None)
    )

"""A machine is kept for a day when it is calculated, and for good once it is saved, with its first revision."""

import asyncio
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from sqlalchemy import update

from hpn.store import AxisDraft, MachineDraft, NoRoomError, RevisionDraft, ShareSpentError, Store
from hpn.store.engine import WRITES
from hpn.store.machines import MOST_OF_CALLER
from hpn.store.records import ANSWER, LISTS
from hpn.store.tables import documents

pytestmark = pytest.mark.anyio

MOST_BYTES = 1_000_000
"""Room for what nobody has saved that these tests never fill."""

NAMES: dict[str, str | None] = {"title": "Line 4", "reference": "P-77", "author": None, "revision": "B"}


FIRST = RevisionDraft("B", b'{"axes": []}', 5, "1", "c", author="anna")


def axis(name: str, status: str = "suitable", utilisation: float | None = 0.5) -> AxisDraft:
    """An axis with an answer."""
    judged = {"status": status, "utilisation": utilisation, "engine_version": "1", "catalogue_version": "c"}
    answer = dict.fromkeys(ANSWER) | dict.fromkeys(LISTS, "[]") | judged
    return AxisDraft(b'{"duty_cycle": {"x": "\\u00e4"}}', 2, answer, name=name)


STATES = ("suitable", "suitable", "suitable", "unsuitable", "open")


def draft(**changes: Any) -> MachineDraft:
    """A machine of five axes."""
    names = {"axes": [axis(f"axis {n}", state, n / 10) for n, state in enumerate(STATES)]}
    return MachineDraft(**{"engine_version": "1", "catalogue_version": "c", **names, **changes})


async def age(store: Store, id: str, by: timedelta) -> None:
    """Have a machine be as if it was calculated long ago."""
    async with store._engine.execution_options(**WRITES).begin() as connection:
        await connection.execute(update(documents).where(documents.c.id == id).values(created=datetime.now(UTC) - by))


async def test_a_calculated_machine_is_found_and_listed_once_it_is_saved(store: Store) -> None:
    inputs = draft()
    id = await store.keep_machine(inputs, MOST_BYTES)

    record = await store.find_machine(id)
    assert record is not None and record.saved is None
    assert (record.axes, record.suitable, record.unsuitable, record.open, record.utilisation) == (5, 3, 1, 1, 0.2)
    assert [(each.number, each.name, each.application, each.answer) for each in record.items] == [
        (number, one.name, one.application, one.answer) for number, one in enumerate(inputs.axes, 1)
    ]
    assert await store.machines() == ([], None)

    assert await store.save_machine(id, NAMES, "anna", FIRST)
    saved = await store.find_machine(id)
    assert saved is not None and saved.saved is not None
    assert (saved.title, saved.reference, saved.author, saved.revision, saved.owner) == (*NAMES.values(), "anna")
    assert [line.id for line in (await store.machines())[0]] == [id]


async def test_a_saved_machine_is_not_saved_again_under_another_name(store: Store) -> None:
    id = await store.keep_machine(draft(), MOST_BYTES)
    assert await store.save_machine(id, NAMES, "anna", FIRST)

    assert not await store.save_machine(id, {**NAMES, "title": "another"}, "bert", FIRST)

    record = await store.find_machine(id)
    assert record is not None and (record.title, record.owner) == ("Line 4", "anna")


async def test_a_saved_machine_is_renamed_and_nothing_else_of_it_changes(store: Store) -> None:
    id, left = await store.keep_machine(draft(), MOST_BYTES), await store.keep_machine(draft(), MOST_BYTES)
    await store.save_machine(id, NAMES, "anna", FIRST)
    before = await store.find_machine(id)

    assert await store.rename(id, {"title": "Line 5", "reference": None}, kind="machine")
    assert not await store.rename(left, {"title": "not saved", "reference": None}, kind="machine")

    after = await store.find_machine(id)
    assert before is not None and after is not None
    assert after == replace(before, title="Line 5", reference=None, version=before.version + 1, updated=after.updated)


async def test_a_machine_that_nobody_saves_goes_after_a_day(store: Store) -> None:
    record, left = await store.keep_machine(draft(), MOST_BYTES), await store.keep_machine(draft(), MOST_BYTES)
    await store.save_machine(record, NAMES, None, FIRST)
    for id in (record, left):
        await age(store, id, timedelta(hours=25))

    assert await store.find_machine(left) is None
    assert await store.find_machine(record) is not None
    await store.keep_machine(draft(), MOST_BYTES)
    assert not await store.delete(left, kind="machine")


async def test_machines_of_others_take_nothing_away_that_is_younger_than_a_day(store: Store) -> None:
    first = await store.keep_machine(draft(caller="anna"), MOST_BYTES)
    await age(store, first, timedelta(hours=23))

    for number in range(105):
        await store.keep_machine(draft(caller=f"other {number}"), MOST_BYTES)

    assert await store.find_machine(first) is not None


async def test_a_caller_has_so_many_unsaved_and_room_again_once_one_is_saved_or_a_day_old(store: Store) -> None:
    ids = [await store.keep_machine(draft(caller="anna"), MOST_BYTES) for _ in range(MOST_OF_CALLER)]

    with pytest.raises(ShareSpentError):
        await store.require_room("anna", MOST_BYTES)
    with pytest.raises(ShareSpentError):
        await store.keep_machine(draft(caller="anna"), MOST_BYTES)
    await store.keep_machine(draft(caller="bert"), MOST_BYTES)

    assert None not in [await store.find_machine(id) for id in ids]
    await store.save_machine(ids[0], NAMES, "anna", FIRST)
    await store.keep_machine(draft(caller="anna"), MOST_BYTES)
    await age(store, ids[1], timedelta(hours=25))
    await store.keep_machine(draft(caller="anna"), MOST_BYTES)


async def test_unsaved_machines_of_all_are_bounded_in_bytes_and_a_new_one_gives_way(store: Store) -> None:
    size = draft().bytes
    first = await store.keep_machine(draft(), 2 * size)
    saved = await store.keep_machine(draft(), 2 * size)

    with pytest.raises(NoRoomError):
        await store.keep_machine(draft(caller="other"), 2 * size)
    with pytest.raises(NoRoomError):
        await store.require_room("other", 2 * size - 1)

    assert await store.find_machine(first) is not None
    await store.save_machine(saved, NAMES, None, FIRST)
    await store.keep_machine(draft(), 2 * size)


async def test_those_that_come_at_once_do_not_pass_the_bounds_together(store: Store) -> None:
    size = draft().bytes
    others = [draft(caller=f"other {number}") for number in range(8)]

    of_all = await asyncio.gather(*(store.keep_machine(one, 3 * size) for one in others), return_exceptions=True)
    of_one = await asyncio.gather(
        *(store.keep_machine(draft(caller="anna"), MOST_BYTES) for _ in range(MOST_OF_CALLER + 8)),
        return_exceptions=True,
    )

    assert [type(result) for result in of_all].count(str) == 3
    assert [type(results) for results in of_one].count(str) == MOST_OF_CALLER


async def test_machines_are_listed_newest_first_in_parts(store: Store) -> None:
    ids = [await store.keep_machine(draft(), MOST_BYTES) for _ in range(3)]
    for id in ids:
        await store.save_machine(id, NAMES, None, FIRST)

    first, cursor = await store.machines(limit=2)
    rest, end = await store.machines(cursor, limit=2)

    assert [line.id for line in (*first, *rest)] == ids[::-1]
    assert end is None
    with pytest.raises(ValueError, match="cursor"):
        await store.machines("nonsense")


async def test_a_deleted_machine_is_gone(store: Store) -> None:
    id = await store.keep_machine(draft(), MOST_BYTES)

    assert await store.delete(id, kind="machine")

    assert await store.find_machine(id) is None
    assert (
        not await store.delete(id, kind="machine")
        and not await store.delete("no id", kind="machine")
        and not await store.save_machine(id, NAMES, None, FIRST)
    )

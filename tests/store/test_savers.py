"""Keys that are used twice, and savers who come together or leave, on each kind of database."""

import asyncio
import hashlib

import pytest
from sqlalchemy import text

from hpn.store import KeyReusedError, KeySpentError, Store
from tests.store.drafts import draft
from tests.store.test_store import count

pytestmark = pytest.mark.anyio


async def test_the_same_key_with_the_same_content_is_saved_once(store: Store) -> None:
    first = await store.save(draft(idempotency_key="k", title="t"))

    # The reply may have changed between the two, because the service was updated; the request is still the same.
    assert await store.save(draft(idempotency_key="k", title="t", result=b"{}", engine_version="2")) == first
    assert await count(store) == 1


@pytest.mark.parametrize("other", [{"title": "u"}, {"reference": "r"}, {"application": b"{}"}])
async def test_the_same_key_with_other_content_is_refused(store: Store, other: dict[str, str]) -> None:
    first = await store.save(draft(idempotency_key="k", title="t"))

    with pytest.raises(KeyReusedError, match="used before"):
        await store.save(draft(**{"idempotency_key": "k", "title": "t"} | other))

    assert await count(store) == 1
    assert await store.find(first) is not None


async def test_a_late_retry_of_what_was_deleted_is_refused_and_saves_nothing(store: Store, ready_database: str) -> None:
    once = draft(idempotency_key="k", title="t")
    assert await store.delete(await store.save(once))
    other = Store(ready_database)  # another worker, or this one after a restart

    for each in (store, other):
        with pytest.raises(KeySpentError, match="has been deleted"):
            await each.save(once)
        with pytest.raises(KeySpentError, match="has been deleted"):
            await each.save(draft(idempotency_key="k", title="u"))

    assert await count(store) == 0
    assert isinstance(await store.save(draft(idempotency_key="l", title="t")), str)
    await other.close()


async def test_a_spent_key_fails_alone(store: Store) -> None:
    await store.delete(await store.save(draft(idempotency_key="spent")))

    keys = ("a", "spent", None, "b", "a")
    outcomes = await asyncio.gather(*(store.save(draft(idempotency_key=key)) for key in keys), return_exceptions=True)

    assert [isinstance(outcome, str) for outcome in outcomes] == [True, False, True, True, True]
    assert outcomes[0] == outcomes[4]
    assert await count(store) == 3


async def test_a_deletion_leaves_nothing_of_the_key_but_its_hash(store: Store) -> None:
    await store.delete(await store.save(draft(idempotency_key="part 4711")))
    await store.delete(await store.save(draft()))

    async with store._engine.connect() as connection:
        (row,) = (await connection.execute(text("SELECT * FROM idempotency_keys"))).mappings()

    by_name = {name: value for name, value in row.items() if value is not None}
    assert by_name.pop("key_sha256") == hashlib.sha256(b"part 4711").hexdigest()
    assert by_name.keys() == {"deleted"}


async def test_retries_and_deletions_at_once_never_bring_back_what_was_deleted(
    store: Store, ready_database: str
) -> None:
    other = Store(ready_database)
    for number in range(20):
        once = draft(idempotency_key=f"k{number}")
        id = await store.save(once)

        outcomes = await asyncio.gather(
            other.save(once),
            store.delete(id),
            other.save(once),
            store.save(once),
            return_exceptions=True,
        )

        assert outcomes[1] is True
        assert all(outcome == id or isinstance(outcome, KeySpentError) for outcome in outcomes[::2])
    assert await count(store) == 0
    await other.close()


async def test_identical_requests_at_once_make_one_row_also_from_several_workers(
    store: Store, ready_database: str
) -> None:
    others = [Store(ready_database) for _ in range(3)]
    stores = [store, *others] * 10

    ids = await asyncio.gather(*(each.save(draft(idempotency_key=f"k{n}")) for each in stores for n in range(3)))

    assert len(set(ids)) == await count(store) == 3
    for other in others:
        await other.close()


async def test_savers_who_come_together_each_get_their_own(store: Store, ready_database: str) -> None:
    """Each of them, and a retry of each, beside another worker's savers: one row each, with its own content."""
    other = Store(ready_database)
    drafts = [draft(title=str(k), result=b"%d" % k, idempotency_key=f"k{k}" if k % 2 else None) for k in range(60)]

    ids = await asyncio.gather(*((store, other)[k % 2].save(each) for k, each in enumerate(drafts)))
    retries = await asyncio.gather(*(store.save(each) for each in drafts[1::2]))
    await other.close()

    values = [await store.find(id) for id in ids]
    assert [(each and each.title, each and each.result) for each in values] == [(d.title, d.result) for d in drafts]
    assert retries == ids[1::2]
    assert await count(store) == 60


async def test_one_draft_that_the_database_refuses_fails_alone(store: Store) -> None:
    outcomes = await asyncio.gather(
        *(store.save(draft(title=title)) for title in ("a", "b\0", "c")), return_exceptions=True
    )

    good = [outcome for outcome in outcomes if isinstance(outcome, str)]
    assert isinstance(outcomes[0], str)
    assert isinstance(outcomes[2], str)
    assert await count(store) == len(good)


async def test_a_saver_who_leaves_does_not_take_the_others_along(store: Store) -> None:
    tasks = [asyncio.create_task(store.save(draft())) for _ in range(3)]
    await asyncio.sleep(0)
    tasks[1].cancel()

    outcomes = await asyncio.gather(*tasks, return_exceptions=True)

    assert isinstance(outcomes[0], str)
    assert isinstance(outcomes[1], asyncio.CancelledError)
    assert isinstance(outcomes[2], str)


@pytest.mark.parametrize("turns", [*range(0, 40, 3), 60, 100])
async def test_a_saver_who_gives_up_at_any_moment_leaves_all_or_nothing(store: Store, turns: int) -> None:
    once = draft(idempotency_key="k", title="t")
    saving = asyncio.create_task(store.save(once))
    for _ in range(turns):
        await asyncio.sleep(0.0001)
    saving.cancel()
    await asyncio.gather(saving, return_exceptions=True)

    id = await asyncio.wait_for(store.save(once), 5)  # nobody holds a lock any more

    assert await count(store) == 1
    assert await store.find(id) is not None
    if not saving.cancelled():
        assert saving.result() == id


async def test_hundreds_of_savers_at_once_are_all_saved(ready_database: str) -> None:
    store = Store(ready_database, seconds=60)  # the last of them waits for all others
    ids = await asyncio.gather(*(store.save(draft()) for _ in range(500)))

    assert len(set(ids)) == await count(store) == 500
    await store.close()

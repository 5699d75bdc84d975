"""Group commit: while one transaction reaches the disk, those who come meanwhile gather for the next."""

import asyncio
from collections.abc import Awaitable, Callable, Sequence

from hpn.store.errors import StoreUnavailableError
from hpn.store.inserting import Outcome
from hpn.store.saved import Draft

AT_ONCE = 64
MAXIMUM_WAITING = 512
PATIENCE = 10
"""Turns of the loop, of some 10 us when nothing else is to be done."""

Commit = Callable[[Sequence[Draft]], Awaitable[Sequence[Outcome]]]


class Writer:
    """Saves drafts in the order of their arrival, many to a transaction, one transaction at a time."""

    def __init__(self, commit: Commit) -> None:
        self._commit = commit
        self._waiting: list[tuple[Draft, asyncio.Future[str]]] = []
        self._task: asyncio.Task[None] | None = None
        self._last = 0

    async def save(self, draft: Draft) -> str:
        """Id of the draft, once it is durable. Who stops waiting does not keep the draft from being saved."""
        if len(self._waiting) >= MAXIMUM_WAITING:
            raise StoreUnavailableError("too many selections are waiting to be saved")
        outcome: asyncio.Future[str] = asyncio.get_running_loop().create_future()
        self._waiting.append((draft, outcome))
        if self._task is None or self._task.done():
            self._task = asyncio.create_task(self._run())
        return await outcome

    async def finish(self) -> None:
        """Wait until nothing waits."""
        if self._task is not None:
            await self._task

    async def _run(self) -> None:
        while self._waiting:
            await self._gather()
            batch, self._waiting = self._waiting[:AT_ONCE], self._waiting[AT_ONCE:]
            try:
                outcomes = await self._commit([draft for draft, _ in batch])
            except Exception as error:
                # Who waits behind would wait as long again, for the same answer.
                batch, self._waiting = batch + self._waiting, []
                outcomes = [error] * len(batch)
            for (_, future), outcome in zip(batch, outcomes, strict=True):
                _settle(future, outcome)

    async def _gather(self) -> None:
        """Let all who are on their way arrive: one transaction of all costs much less than several of some.

        A turn of the loop reads what clients have sent, the next one computes it. Where more came together the last
        time, some turns without anybody new are waited for them.
        """
        before = quiet = 0
        while len(self._waiting) < AT_ONCE and quiet <= (PATIENCE if len(self._waiting) < self._last else 0):
            quiet = quiet + 1 if len(self._waiting) == before else 0
            before = len(self._waiting)
            await asyncio.sleep(0)
            await asyncio.sleep(0)
        self._last = len(self._waiting)


def _settle(future: asyncio.Future[str], outcome: Outcome) -> None:
    if future.done():  # its client has gone
        return
    if isinstance(outcome, str):
        future.set_result(outcome)
    else:
        future.set_exception(outcome)

"""Group commit: while one transaction reaches the disk, those who come meanwhile gather for the next.

Those of a group are worked out together, too, as those of a batch are.
"""

import asyncio
from collections.abc import Awaitable, Callable, Sequence
from typing import Any

from hpn.store.errors import StoreUnavailableError
from hpn.store.inserting import Outcome
from hpn.store.saved import Draft

AT_ONCE = 64
TOGETHER = 16
"""Drafts that are made before others have a turn of the loop."""

MAXIMUM_WAITING = 512
PATIENCE = 10
"""Turns of the loop, of some 10 us when nothing else is to be done."""

Make = Callable[[Sequence[Any]], Sequence[Draft | Exception]]
"""Gives a draft of each thing that is to be saved, or why there is none."""

Commit = Callable[[Sequence[Draft]], Awaitable[Sequence[Outcome]]]


class Writer:
    """Makes drafts in the order of their arrival and saves them, many to a transaction, one transaction at a time."""

    def __init__(self, make: Make, commit: Commit) -> None:
        self._make = make
        self._commit = commit
        self._waiting: list[tuple[Any, asyncio.Future[str]]] = []
        self._task: asyncio.Task[None] | None = None
        self._last = 0

    async def save(self, wanted: Any) -> str:
        """Id of what is made of `wanted`, once it is durable. Who stops waiting does not keep it from being saved."""
        if len(self._waiting) >= MAXIMUM_WAITING:
            raise StoreUnavailableError("too many selections are waiting to be saved")
        outcome: asyncio.Future[str] = asyncio.get_running_loop().create_future()
        self._waiting.append((wanted, outcome))
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
            drafts, futures = await self._made(batch)
            if not drafts:
                continue
            try:
                outcomes = await self._commit(drafts)
            except Exception as error:
                # Who waits behind would wait as long again, for the same answer.
                futures += [future for _, future in self._waiting]
                self._waiting, outcomes = [], [error] * len(futures)
            for future, outcome in zip(futures, outcomes, strict=True):
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

    async def _made(
        self, batch: Sequence[tuple[Any, asyncio.Future[str]]]
    ) -> tuple[list[Draft], list[asyncio.Future[str]]]:
        """Drafts and who waits for each; who waits for one that can't be made is told why."""
        drafts, futures = [], []
        for start in range(0, len(batch), TOGETHER):
            if start:
                await asyncio.sleep(0)
            wanted, waiting = zip(*batch[start : start + TOGETHER], strict=True)
            for made, future in zip(self._made_together(wanted), waiting, strict=True):
                if isinstance(made, Exception):
                    _settle(future, made)
                else:
                    drafts.append(made)
                    futures.append(future)
        return drafts, futures

    def _made_together(self, wanted: Sequence[Any]) -> Sequence[Draft | Exception]:
        try:
            return self._make(wanted)
        except Exception as error:
            # What fails in a way nobody has thought of must not fail its neighbours.
            return [error] if len(wanted) == 1 else [made for one in wanted for made in self._made_together([one])]


def _settle(future: asyncio.Future[str], outcome: Outcome) -> None:
    if future.done():  # its client has gone
        return
    if isinstance(outcome, str):
        future.set_result(outcome)
    else:
        future.set_exception(outcome)

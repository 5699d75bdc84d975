"""Today's verdicts on saved documents: computed in the background, once for each version of engine and catalogue.

Several processes share the work: each reserves some documents at a time.
"""

import asyncio
import logging
import time
from collections.abc import Iterable, Sequence
from contextlib import suppress
from datetime import UTC, datetime
from typing import Any

import msgspec
import orjson
from starlette.datastructures import State

from hpn import ENGINE_VERSION
from hpn.catalogue import Catalogue
from hpn.documents.answers import AxisAnswer, AxisQuestion, answers
from hpn.documents.merge import resolve
from hpn.store import AxisVerdict, DocumentLine, SavedAxis, SelectionLine, Stale, Store, StoreError, Versions
from hpn.web.columns import resolved
from hpn.web.door.pools import Pool

MOST_DOCUMENTS, MOST_AXES = 20, 100
"""Documents that are taken at once, and axes that are answered at once: they bound the memory and a batch's wait."""

START_SECONDS, PATIENCE_SECONDS = 5.0, 60.0
"""Time from the start to the first check for documents to ask about, and between checks; a list that shows such
documents triggers a check at once."""

logger = logging.getLogger(__name__)


def versions_of(state: State) -> Versions:
    """Today's versions of engine and catalogue."""
    return Versions(ENGINE_VERSION, state.catalogue.version)


class Todays:
    """Background work of one process, at `app.state.todays`."""

    def __init__(self, state: State) -> None:
        self._state = state
        self._wake = asyncio.Event()
        self._started = datetime.now(UTC)

    def wake(self) -> None:
        """Trigger a check."""
        self._wake.set()

    def note(self, lines: Iterable[DocumentLine | SelectionLine]) -> None:
        """Trigger a check if a list has documents without today's verdict."""
        key = versions_of(self._state).key
        if any(each.today_of != key for each in lines):
            self.wake()

    async def run(self) -> None:
        """Compute missing verdicts and wait for more until cancelled; the first check waits for the service's start."""
        patience = START_SECONDS
        while True:
            with suppress(TimeoutError):
                async with asyncio.timeout(patience):
                    await self._wake.wait()
            self._wake.clear()
            patience = PATIENCE_SECONDS
            try:
                while await self.ask_some():
                    await asyncio.sleep(0)
            except StoreError:  # the log says so already
                pass
            except Exception:
                logger.exception("what saved documents get today can’t be asked")

    async def ask_some(self) -> int:
        """Compute verdicts on some documents; their number, 0 if none is left."""
        store: Store = self._state.store
        versions = versions_of(self._state)
        if not await store.pending(versions, None):
            return 0
        documents = await store.take_stale(versions, MOST_DOCUMENTS, self._started)
        selections = [each for each in documents if each.kind == "selection"]
        values = await self._work(_today_of, selections, self._state.catalogue) if selections else []
        for stale, answer in zip(selections, values, strict=True):
            await store.settle(stale, versions, answer)
        for stale in documents:
            if stale.kind == "machine":
                await self._try_machine(stale, versions)
        return len(documents)

    async def _try_machine(self, stale: Stale, versions: Versions) -> None:
        """Compute verdicts on a machine; a failure is logged, delays no other machine, and is tried again later."""
        try:
            await self._ask_machine(stale, versions)
        except StoreError:
            raise
        except Exception:
            logger.exception("what machine %s gets today can’t be asked", stale.id)

    async def _ask_machine(self, stale: Stale, versions: Versions) -> None:
        store: Store = self._state.store
        while True:
            common, axes = await store.unasked_axes(stale.id, versions, MOST_AXES)
            if not axes:
                break
            verdicts = await self._work(_verdicts, axes, common, self._state.catalogue)
            await store.keep_verdicts(stale.id, versions, verdicts)
        await store.settle_machine(stale.id, versions)

    async def _work(self, work: Any, *arguments: Any) -> Any:
        """Result of work in the pool of batches; it takes at most half of the pool's time."""
        pool: Pool = self._state.pools["batches"]
        begun = time.monotonic()
        result = await pool.run(work, *arguments)
        await asyncio.sleep(time.monotonic() - begun)
        return result


def _verdict(answer: AxisAnswer, ordering_code: str | None) -> tuple[str, str | None]:
    """Status and gear of an answer: that of the ordering code, else the selected one."""
    return answer.status, answer.selected if ordering_code is None else answer.designation


def _verdicts(axes: Sequence[SavedAxis], common: str, catalogue: Catalogue) -> list[AxisVerdict]:
    """Axes of a machine, each with a mark of whether today's verdict differs."""
    values = orjson.loads(common)
    fresh = answers([AxisQuestion(resolved(axis, values), axis.ordering_code) for axis in axes], catalogue)
    return [
        AxisVerdict(axis, _verdict(answer, axis.ordering_code) != _verdict_of(axis.answer, axis.ordering_code))
        for axis, answer in zip(axes, fresh, strict=True)
    ]


def _verdict_of(answer: Any, ordering_code: str | None) -> tuple[str, str | None]:
    return answer["status"], answer["selected" if ordering_code is None else "designation"]


def _today_of(selections: Sequence[Stale], catalogue: Catalogue) -> list[dict[str, Any]]:
    """Columns of today's answers to selections; a selection that fails gets `today_changed` None."""
    try:
        return _answers(selections, catalogue)
    except Exception:
        if len(selections) > 1:
            return [columns for each in selections for columns in _today_of([each], catalogue)]
        logger.exception("what selection %s gets today can’t be asked", selections[0].id)
        return [{"today_changed": None}]


def _answers(selections: Sequence[Stale], catalogue: Catalogue) -> list[dict[str, Any]]:
    stale = [each for each in selections if not each.is_of_today]
    wholes = [AxisQuestion(resolve(msgspec.json.decode(each.application), {}), each.ordering_code) for each in stale]
    by_id = dict(zip((each.id for each in stale), answers(wholes, catalogue), strict=True))
    return [_columns(each, by_id.get(each.id)) for each in selections]


def _columns(then: Stale, answer: AxisAnswer | None) -> dict[str, Any]:
    if answer is None:
        return {"today_selected": then.selected, "today_status": then.status, "today_changed": 0}
    is_other = answer.selected != then.selected
    if then.status is not None:  # None if an earlier version has kept no verdict
        is_other = is_other or _verdict(answer, then.ordering_code) != (
            then.status,
            then.selected if then.ordering_code is None else then.designation,
        )
    return {"today_selected": answer.selected, "today_status": answer.status, "today_changed": int(is_other)}

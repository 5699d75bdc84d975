"""Work on the axes of a machine in steps: counted for its page, and given up once nobody waits for it any more.

What is given up has saved nothing: a change is one transaction behind the last step.
"""

import asyncio
import threading
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar, copy_context
from itertools import islice

import msgspec
from starlette.requests import Request
from starlette.responses import Response, StreamingResponse
from starlette.types import Receive, Scope, Send

from hpn.catalogue import Catalogue
from hpn.documents.answers import AxisAnswer, AxisQuestion, answers
from hpn.web.door.pools import while_present
from hpn.web.door.problems import Problem
from hpn.words.reader import Reader
from hpn.words.wording import N_, Sentence

STEP = 200
"""Axes that are answered between two looks at whether somebody still waits."""

EVENTS = "text/event-stream"
"""Media type of an answer that counts; Starlette compresses no such answer, which would hold the count back."""

PAUSE_SECONDS = 0.2
COUNTED, SAVING = N_("{done} of {all}"), N_("saving")


class GivenUpError(Exception):
    """Nobody waits for the work any more."""


class WorkProgress:
    """Count of the axes that are answered, of how many."""

    def __init__(self) -> None:
        self.done, self.of, self.is_saving = 0, 0, False
        self._given_up = threading.Event()

    def give_up(self) -> None:
        """Have the work end at its next step, if it is not saving yet."""
        self._given_up.set()

    def count(self, done: int, of: int, *, is_saving: bool = False) -> None:
        """Say how far the work is; raises GivenUpError where nobody waits for it."""
        if self._given_up.is_set():
            raise GivenUpError
        self.done, self.of, self.is_saving = done, of, is_saving


_PROGRESS: ContextVar[WorkProgress | None] = ContextVar("progress", default=None)


@contextmanager
def given_up_at_end() -> Iterator[None]:
    """Have what a request has begun end with it, at the next step."""
    progress = WorkProgress()
    token = _PROGRESS.set(progress)
    try:
        yield
    finally:
        _PROGRESS.reset(token)
        progress.give_up()


def answers_in_steps(questions: Iterable[AxisQuestion], count: int, catalogue: Catalogue) -> list[AxisAnswer]:
    """Answers to so many axes; raises GivenUpError where nobody waits for them any more."""
    progress, rest, replies = _PROGRESS.get(), iter(questions), list[AxisAnswer]()
    while step := list(islice(rest, STEP)):
        if progress is not None:
            progress.count(len(replies), count)
        replies += answers(step, catalogue)
    return replies


def begin_to_save() -> None:
    """Say that from now on the change is made; raises GivenUpError where nobody waits for it."""
    if (progress := _PROGRESS.get()) is not None:
        progress.count(progress.of, progress.of, is_saving=True)


class CountedAnswer(StreamingResponse):
    """Events that count the axes of a change, the last of which has its page; the work ends when the client leaves."""

    def __init__(self, request: Request, work: Callable[[], Awaitable[Response]]) -> None:
        self._request, self._work, self._progress = request, work, WorkProgress()
        headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
        super().__init__(self._pieces(), media_type=EVENTS, headers=headers)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send them while the client is there; what is being saved then is saved."""
        context = copy_context()
        context.run(_PROGRESS.set, self._progress)
        self._working = asyncio.create_task(self._result(), context=context)
        try:
            with suppress(Problem):
                await while_present(self._request, self.stream_response(send))
        finally:
            self._progress.give_up()
            await asyncio.wait({self._working})

    async def _result(self) -> Response | None:
        try:
            return await self._work()
        except GivenUpError:
            return None

    async def _pieces(self) -> AsyncIterator[bytes]:
        reader: Reader = self._request.state.reader
        while not self._working.done():
            yield _event(_told(self._progress, reader))
            await asyncio.wait({self._working}, timeout=PAUSE_SECONDS)
        if (response := self._working.result()) is not None:
            yield _event({"status": response.status_code, "page": bytes(response.body).decode()})


def _event(said: dict[str, object]) -> bytes:
    return b"data: " + msgspec.json.encode(said) + b"\n\n"


def _told(progress: WorkProgress, reader: Reader) -> dict[str, object]:
    values = {"done": reader.exact(progress.done), "all": reader.exact(progress.of)}
    text = reader.told(Sentence(SAVING) if progress.is_saving else Sentence(COUNTED, values))
    return {"done": progress.done, "of": progress.of, "saving": progress.is_saving, "told": text}

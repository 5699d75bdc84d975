"""Work on the axes of a machine in steps: counted for its page, and given up when its client has left.

Work that is given up has saved nothing: a change is one transaction after the last step.
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
"""Axes that are answered between two checks that the client still waits."""

EVENTS = "text/event-stream"
"""Media type of an answer that counts; Starlette doesn't compress it, as compression would delay the count."""

PAUSE_SECONDS = 0.2
COUNTED, SAVING = N_("{done} of {all}"), N_("saving")


class GivenUpError(Exception):
    """The client no longer waits for the work."""


class WorkProgress:
    """Count of answered axes, and their total."""

    def __init__(self) -> None:
        self.done, self.of, self.is_saving = 0, 0, False
        self._given_up = threading.Event()

    def give_up(self) -> None:
        """End the work at its next step, unless it is saving already."""
        self._given_up.set()

    def count(self, steps: int, of: int, *, is_saving: bool = False) -> None:
        """Record the progress of the work; raises GivenUpError if the work is given up."""
        if self._given_up.is_set():
            raise GivenUpError
        self.done, self.of, self.is_saving = steps, of, is_saving


_PROGRESS: ContextVar[WorkProgress | None] = ContextVar("progress", default=None)


@contextmanager
def given_up_at_end() -> Iterator[None]:
    """Give up the work of a request at the request's end."""
    progress = WorkProgress()
    token = _PROGRESS.set(progress)
    try:
        yield
    finally:
        _PROGRESS.reset(token)
        progress.give_up()


def answers_in_steps(questions: Iterable[AxisQuestion], count: int, catalogue: Catalogue) -> list[AxisAnswer]:
    """Answers to `count` questions; raises GivenUpError if the work is given up."""
    progress, rest, replies = _PROGRESS.get(), iter(questions), list[AxisAnswer]()
    while step := list(islice(rest, STEP)):
        if progress is not None:
            progress.count(len(replies), count)
        replies += answers(step, catalogue)
    return replies


def begin_to_save() -> None:
    """Record that the change is being saved; raises GivenUpError if the work is given up."""
    if (progress := _PROGRESS.get()) is not None:
        progress.count(progress.of, progress.of, is_saving=True)


class CountedAnswer(StreamingResponse):
    """Events that count the axes of a change; the last contains its page. The work ends when the client leaves."""

    def __init__(self, request: Request, work: Callable[[], Awaitable[Response]]) -> None:
        self._request, self._work, self._progress = request, work, WorkProgress()
        headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
        super().__init__(self._pieces(), media_type=EVENTS, headers=headers)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send the events until the client leaves; a change that is being saved then is completed."""
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
            yield _event(_status(self._progress, reader))
            await asyncio.wait({self._working}, timeout=PAUSE_SECONDS)
        if (response := self._working.result()) is not None:
            yield _event({"status": response.status_code, "page": bytes(response.body).decode()})


def _event(fields: dict[str, object]) -> bytes:
    return b"data: " + msgspec.json.encode(fields) + b"\n\n"


def _status(progress: WorkProgress, reader: Reader) -> dict[str, object]:
    values = {"done": reader.exact(progress.done), "all": reader.exact(progress.of)}
    text = reader.sentence(Sentence(SAVING) if progress.is_saving else Sentence(COUNTED, values))
    return {"done": progress.done, "of": progress.of, "saving": progress.is_saving, "text": text}

"""`POST /api/v1/select/batch`: one result line per application, as one JSON object or as lines of JSON."""

import asyncio
import re
import tempfile
import time
from collections.abc import AsyncIterator, Iterator, Sequence
from contextlib import ExitStack, suppress
from functools import cache
from itertools import count
from typing import Any, BinaryIO, NamedTuple, cast

import msgspec
import numpy as np
from fastapi import APIRouter
from msgspec import UNSET, Raw, UnsetType
from msgspec.structs import replace
from pydantic import ValidationError
from pydantic_core import from_json
from starlette.datastructures import State
from starlette.requests import Request
from starlette.responses import Response, StreamingResponse
from starlette.types import Message, Receive, Scope, Send

from hpn.application import BatchItem, InputError, unique
from hpn.application.faults import unknown_field
from hpn.application.unique import RepeatedNameError
from hpn.catalogue import Catalogue
from hpn.engine.batch import judge_batch
from hpn.engine.selection import Judgement, Outcome
from hpn.links.writer import to_link
from hpn.web import spool
from hpn.web.api import schemas
from hpn.web.api.replies import BatchLine, BatchReply, JSONBytes, ProblemReply, encode
from hpn.web.door.access import admit
from hpn.web.door.bodies import (
    JSON,
    NDJSON,
    content_type_of,
    pass_body,
    read_body,
    require_bounded,
    require_unique,
    wrong_type,
)
from hpn.web.door.pools import Pool, pool_of, while_present
from hpn.web.door.problems import MAXIMUM_ERRORS, Problem
from hpn.web.settings import Settings

SLICE_ITEMS, SLICE_SECONDS = 256, 0.25
"""Items that are evaluated in one slice, and maximum time for reading them: a motion may take half a second."""

MEMORY_BYTES = 512 * 1024
SHARES = 7
"""Number of largest bodies of lines that together fill the disk's share."""

BYTE_ORDER_MARK = b"\xef\xbb\xbf"
SHAPE = 'the body must be {"applications": [ … ]}'
MOST_BESIDE = 64 * 1024
"""Maximum bytes of a body beside its applications."""

NO_NUMBERS = re.compile(rb'"[^"\\]*+(?:\\.[^"\\]*+)*+"|-?(?:NaN|Infinity)', re.DOTALL)
RETRY_SECONDS = 5

router = APIRouter(prefix="/api/v1", tags=["Selection"], dependencies=[admit("batch")])


@router.post(
    "/select/batch",
    operation_id="selectBatch",
    summary="Select gears for many applications",
    openapi_extra=schemas.batch_body(),
    response_model=BatchReply,
    responses=schemas.batch_answers(400, 408, 413, 415, 422),
)
async def select_batch(request: Request) -> Response:
    """Returns one line per application; an error in one application never affects the others.

    JSON takes up to 10000 applications. Newline-delimited JSON takes any number; its answer starts when the whole body
    has arrived.
    """
    state: State = request.app.state
    settings: Settings = state.settings
    if content_type_of(request) in NDJSON:
        return await LineAnswers.to(request)
    if content_type_of(request) != JSON:
        raise wrong_type(request, f"{JSON} or {NDJSON[0]}")
    body = await read_body(request, maximum_bytes=settings.maximum_batch_body_bytes)
    pool = pool_of(request, "batches")
    with pool.place():
        lines = await while_present(request, _answer(body, state, pool))
    return JSONBytes(b'{"results":[' + lines[:-1].replace(b"\n", b",") + b"]}")


async def _answer(body: bytes, state: State, pool: Pool) -> bytes:
    """Result lines of a batch, made in slices, so that others get their turn and an abandoned batch ends."""
    settings: Settings = state.settings
    deadline = time.monotonic() + settings.batch_seconds
    texts = await pool.run(items_of, body, settings.maximum_batch_count)
    items = (_item(bytes(text), settings.maximum_body_bytes) for text in texts)
    answers = list[bytes]()
    while (piece := await pool.run(_evaluated, items, state)) is not None:
        if time.monotonic() > deadline:
            text = f"the batch took longer than {settings.batch_seconds:g} s; send fewer items at once"
            raise Problem.later(text, RETRY_SECONDS)
        answers.append(piece)
    return b"".join(answers)


# --- Items of a JSON body ---------------------------------------------------------------------------------------------


def items_of(body: bytes, most: int) -> list[Raw]:
    """Texts of the items, unparsed: as Python objects, 32 MB of JSON can take a gigabyte.

    Raises Problem 400 for malformed JSON, 413 for more than `most` items, 422 for another shape.
    """
    try:
        body, items = _items_of(body, _shape(most))
        _require_alone(_beside(body, items))
    except msgspec.ValidationError as error:
        if "of at most length" in str(error):
            errors = [(("applications",), f"has more than {most} items")]
            raise Problem(413, f"at most {most} applications at once", errors) from None
        raise Problem(422, SHAPE, [(("applications",), "must be a list")]) from None
    except RepeatedNameError:
        raise Problem(422, SHAPE, [(("applications",), "is there twice")]) from None
    except (msgspec.DecodeError, RecursionError, ValueError) as error:
        raise Problem(400, f"the body is not JSON: {error}") from None
    return items


def _items_of(body: bytes, shape: Any) -> tuple[bytes, list[Raw]]:
    """Body and its items; numbers unknown to JSON, such as NaN, are replaced by 1e999, which no field accepts."""
    try:
        document = msgspec.json.decode(body, type=shape)
    except msgspec.DecodeError:
        if not (b"NaN" in body or b"Infinity" in body):
            raise
        body = NO_NUMBERS.sub(lambda token: token[0] if token[0].startswith(b'"') else b"1e999", body)
        document = msgspec.json.decode(body, type=shape)
    items = document.applications
    return body, [] if items is UNSET else [item for item in msgspec.structs.astuple(items) if item is not UNSET]


@cache
def _shape(most: int) -> Any:
    """Type of a body with at most `most` items: a list would first take any number of items into memory."""
    fields = [(f"item_{number}", Raw | UnsetType, UNSET) for number in range(most)]
    items = msgspec.defstruct("Items", fields, array_like=True, forbid_unknown_fields=True)
    return msgspec.defstruct("Body", [("applications", items | UnsetType, UNSET)])


def _beside(body: bytes, items: Sequence[Raw]) -> bytes:
    """Body without its items; each item is a slice of the body's memory."""
    if not items:
        return body
    whole, first, last = (np.frombuffer(part, np.uint8) for part in (body, items[0], items[-1]))
    start, end = (part.ctypes.data - whole.ctypes.data for part in (first, last))
    return body[:start] + body[end + len(last) :]


def _require_alone(beside: bytes) -> None:
    """Raise Problem 422 for a body without a list of applications, or with another field, and RepeatedNameError for two
    lists."""
    if len(beside) > MOST_BESIDE:
        raise Problem(422, f"{SHAPE} alone")
    others = msgspec.json.decode(beside, type=dict[str, Raw])
    if "applications" not in others:
        raise Problem(422, SHAPE, [(("applications",), "must be a list")])
    if unknown := [name for name in others if name != "applications"]:
        known = [("applications",) if place < MAXIMUM_ERRORS else () for place in range(len(unknown))]
        errors = [((name,), unknown_field(name, each).text) for name, each in zip(unknown, known, strict=True)]
        raise Problem(422, f"{SHAPE} alone", errors)
    unique.require_unique(beside)


class _Item(NamedTuple):
    """Item of a batch with its reference and its line: its content, or its problem."""

    reference: str | None
    content: BatchItem | Problem
    line: int = 0


def _item(text: bytes, most: int, line: int = 0) -> _Item:
    """Item of at most `most` bytes, read as `select` reads an application, with the same order of checks."""
    reference = None
    try:
        if len(text) > most:
            raise Problem(413, f"an application may have {most} bytes at most")
        require_bounded(text)
        value = from_json(text)
        name = value.get("reference") if isinstance(value, dict) else None
        reference = name if isinstance(name, str) else None
        question = BatchItem.model_validate(value)
        require_unique(text, value)
    except ValidationError as error:
        return _Item(reference, Problem.of(error), line)
    except ValueError as error:
        return _Item(None, Problem(400, f"is not JSON: {str(error).replace(' at line 1 ', ' at ')}"), line)
    except Problem as problem:
        return _Item(reference, problem, line)
    return _Item(reference, question, line)


# --- Answers ----------------------------------------------------------------------------------------------------------


def _evaluated(items: Iterator[_Item | None], state: State) -> bytes | None:
    """Result lines of the next items, as many as can be read in SLICE_SECONDS; None at the end."""
    end, slice = time.monotonic() + SLICE_SECONDS, list[_Item]()
    for item in items:
        slice += [item] if item else []
        if len(slice) == SLICE_ITEMS or time.monotonic() > end:
            break
    else:
        if not slice:
            return None
    results = _lines_of(slice, state.catalogue)
    state.metrics.selections(result.verdict for result in results)
    return b"".join([encode(result) + b"\n" for result in results])


def _lines_of(items: Sequence[_Item], catalogue: Catalogue) -> list[BatchLine]:
    """Result lines of items, in their order."""
    judged = iter(
        judge_batch([item.content for item in items if isinstance(item.content, BatchItem)], catalogue, _brief)
    )
    return [_line(item, next(judged) if isinstance(item.content, BatchItem) else item.content) for item in items]


def _brief(judged: Judgement) -> tuple[Outcome, str]:
    return judged.outcome(), to_link(judged.application)


def _line(item: _Item, outcome: tuple[Outcome, str] | InputError | Problem) -> BatchLine:
    """Result line of an item; a problem without a reference names the line, as blank lines have no result."""
    if isinstance(outcome, tuple):
        brief, link = outcome
        return BatchLine(item.reference, "ok", *brief, link=link)
    problem = Problem.of(outcome) if isinstance(outcome, InputError) else outcome
    reply = msgspec.convert(problem.body(), ProblemReply)
    if item.line and item.reference is None:
        reply = replace(reply, detail=f"line {item.line}: {reply.detail}")
    return BatchLine(item.reference, "error", problem=reply)


# --- Lines ------------------------------------------------------------------------------------------------------------


def items_of_lines(file: BinaryIO, most: int) -> Iterator[_Item | None]:
    """Yield the items of lines of at most `most` bytes; None for a blank line."""
    for number in count(1):
        line = file.readline(most + 2)
        is_cut = len(line) == most + 2 and not line.endswith(b"\n")
        while is_cut and len(more := file.readline(most)) == most and not more.endswith(b"\n"):
            pass
        if not line:
            return
        text = line if is_cut else line.removeprefix(BYTE_ORDER_MARK if number == 1 else b"").strip()
        yield _item(text, most, number) if text else None


class LineAnswers(StreamingResponse):
    """Answer line for each line of a body, which is set aside first: most clients send everything before they read.

    The answer ends if the client reads nothing for the time of the settings.
    """

    def __init__(self, request: Request, file: BinaryIO, resources: ExitStack) -> None:
        self._request, self._held = request, resources
        super().__init__(self._pieces(file), media_type=NDJSON[0], headers={"Cache-Control": "no-store"})

    @classmethod
    async def to(cls, request: Request) -> "LineAnswers":
        """Answers to a request; Problem as `pass_body` raises, 413 or 503 if the disk has no room for the body."""
        state: State = request.app.state
        settings: Settings = state.settings
        with ExitStack() as stack, spool.usable():
            share = stack.enter_context(state.disk.share())
            folder = settings.spool_folder
            file = stack.enter_context(tempfile.SpooledTemporaryFile(MEMORY_BYTES, dir=str(folder) if folder else None))

            async def take(piece: bytes) -> None:
                share.take(len(piece))
                await pool_of(request, "pages").run(file.write, piece)  # this pool's work is short

            seconds, most = settings.body_seconds, state.disk.total // SHARES
            await pass_body(request, take, maximum_bytes=most, pause_seconds=seconds, seconds=seconds)
            file.seek(0)
            stack.enter_context(pool_of(request, "batches").place())
            return cls(request, cast(BinaryIO, file), stack.pop_all())

    async def _pieces(self, file: BinaryIO) -> AsyncIterator[bytes]:
        state: State = self._request.app.state
        items = items_of_lines(file, state.settings.maximum_body_bytes)
        while (piece := await pool_of(self._request, "batches").run(_evaluated, items, state)) is not None:
            yield piece

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send the lines while the client reads; then give back the disk's share and the place in the pool."""
        seconds: float = self._request.app.state.settings.body_seconds

        async def send_in_time(message: Message) -> None:
            async with asyncio.timeout(seconds):
                await send(message)

        with self._held, suppress(TimeoutError, Problem):  # the server closes the connection of an incomplete answer
            await while_present(self._request, self.stream_response(send_in_time))

"""`POST /api/v1/select/batch`: one result line per application, as one JSON object or as a stream of lines."""

import time
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple

import msgspec
from fastapi import APIRouter
from msgspec.structs import replace
from pydantic import ValidationError
from pydantic_core import from_json, to_json
from starlette.datastructures import State
from starlette.requests import Request
from starlette.responses import Response

from hpn.application import BatchItem, InputError
from hpn.catalogue import Catalogue
from hpn.engine.batch import judge_batch
from hpn.engine.selection import Judged, Outcome
from hpn.web.api import schemas, streaming
from hpn.web.api.items import Span, items_of
from hpn.web.api.replies import BatchLine, BatchReply, JSONBytes, ProblemReply, encode
from hpn.web.api.streaming import Line
from hpn.web.door.access import admit
from hpn.web.door.bodies import (
    JSON,
    content_type_of,
    read_body,
    require_bounded,
    require_plain,
    require_unique,
    wrong_type,
)
from hpn.web.door.metrics import Metrics
from hpn.web.door.pools import Pool, pool_of, while_present
from hpn.web.door.problems import Problem
from hpn.web.form.link_writer import to_link
from hpn.web.settings import Settings

SLICE_ITEMS, SLICE_BYTES, SLICE_SECONDS = 256, 1_000_000, 0.25
"""Items that are evaluated in one go, their bytes, and the time for reading them: a motion may take half a second."""

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
    """One line per application; an error in one never affects the others.

    As JSON up to 10000 applications; as newline-delimited JSON any number, answered while they still arrive.
    """
    state: State = request.app.state
    settings: Settings = state.settings
    if content_type_of(request) in streaming.MEDIA_TYPES:
        return _stream(request)
    if content_type_of(request) != JSON:
        raise wrong_type(request, f"{JSON} or {streaming.MEDIA_TYPES[0]}")
    body = await read_body(request, maximum_bytes=settings.maximum_batch_body_bytes)
    pool = pool_of(request, "batches")
    with pool.place():
        lines = await while_present(request, _answered(body, state, pool))
    return JSONBytes(b'{"results":[' + lines[:-1].replace(b"\n", b",") + b"]}")


async def _answered(body: bytes, state: State, pool: Pool) -> bytes:
    """Result lines of a batch, a slice at a time, so that others get their turn and one that was left ends."""
    settings: Settings = state.settings
    deadline = time.monotonic() + settings.batch_seconds
    spans = await pool.run(_cut, body, settings)
    lines: list[bytes] = []
    done = 0
    while done < len(spans):
        if time.monotonic() > deadline:
            text = f"the batch took longer than {settings.batch_seconds:g} s; send fewer items at once"
            raise Problem.later(text, RETRY_SECONDS)
        answers, count = await pool.run(_evaluated, body, spans, done, state)
        lines.append(answers)
        done += count
    return b"".join(lines)


def _cut(body: bytes, settings: Settings) -> list[Span]:
    try:
        return items_of(body, settings.maximum_batch_count, settings.maximum_body_bytes)
    except ValueError as error:
        raise _no_json(error) from None


def _slice(spans: Sequence[Span], first: int) -> Sequence[Span]:
    """Items that are evaluated together: so many, and so many bytes."""
    most = spans[first].start + SLICE_BYTES
    part = spans[first : first + SLICE_ITEMS]
    return part[: max(sum(span.end <= most for span in part), 1)]


def _evaluated(body: bytes, spans: Sequence[Span], first: int, state: State) -> tuple[bytes, int]:
    """Result lines of the items from the first one on that are evaluated together, and how many these are."""
    places = enumerate(_slice(spans, first), first)
    items = (_numbered(number, body[span.start : span.end]) for number, span in places)
    results = _results(items, state.catalogue, state.metrics)
    return _encoded(results), len(results)


class _Item(NamedTuple):
    """An item of a batch by its own reference: what it asks, or what is wrong with it."""

    reference: str | None
    asked: BatchItem | Problem


def _numbered(number: int, text: bytes) -> _Item:
    """An item; Problem 400 that names it for what is no JSON."""
    try:
        return _item(text)
    except ValueError as error:
        detail = f"is not JSON: {error} of this item"
        raise Problem(400, f"/applications/{number} {detail}", [(("applications", number), detail)]) from None


def _item(text: bytes) -> _Item:
    """An item as `select` reads an application, in the same order of its refusals; ValueError for what is no JSON."""
    reference = None
    try:
        require_bounded(text)
        value = from_json(text)
        given = value.get("reference") if isinstance(value, dict) else None
        reference = given if isinstance(given, str) else None
        asked = BatchItem.model_validate(value)
        require_unique(text, value)
    except ValidationError as error:
        return _Item(reference, Problem.of(error))
    except Problem as problem:
        return _Item(reference, problem)
    return _Item(reference, asked)


def _no_json(error: ValueError) -> Problem:
    return Problem(400, f"the body is not JSON: {error}")


def _results(items: Iterable[_Item], catalogue: Catalogue, metrics: Metrics) -> list[BatchLine]:
    """Result lines of the items that could be read in time: one at least."""
    results = _lines_of(_in_time(items), catalogue)
    metrics.selections(result.verdict for result in results)
    return results


def _encoded(results: Iterable[BatchLine]) -> bytes:
    return b"".join([encode(result) + b"\n" for result in results])


def _in_time(items: Iterable[_Item]) -> Iterator[_Item]:
    """Items as long as whoever takes them one by one has time for another."""
    end = time.monotonic() + SLICE_SECONDS
    for item in items:
        yield item
        if time.monotonic() > end:
            return


def batch_lines(items: Iterable[Any], catalogue: Catalogue) -> list[BatchLine]:
    """Result lines of batch items, given as values of JSON, in their order."""
    return _lines_of([_item(to_json(item)) for item in items], catalogue)


def _lines_of(items: Iterable[_Item], catalogue: Catalogue) -> list[BatchLine]:
    """Result lines of items, in their order; each is validated on its own, before the next one is taken."""
    read = list(items)
    judged = iter(judge_batch([item.asked for item in read if isinstance(item.asked, BatchItem)], catalogue, _brief))
    return [_line(item.reference, next(judged) if isinstance(item.asked, BatchItem) else item.asked) for item in read]


def _brief(judged: Judged) -> tuple[Outcome, str]:
    return judged.outcome(), to_link(judged.application)


def _line(reference: str | None, outcome: tuple[Outcome, str] | InputError | Problem) -> BatchLine:
    if isinstance(outcome, tuple):
        brief, link = outcome
        return BatchLine(reference, "ok", *brief, link=link)
    problem = Problem.of(outcome) if isinstance(outcome, InputError) else outcome
    return BatchLine(reference, "error", problem=msgspec.convert(problem.body(), ProblemReply))


def _placed(line: Line, result: BatchLine) -> BatchLine:
    """Result of a line, whose problem names the line where the line gives no reference."""
    if not result.problem or result.reference is not None:
        return result
    return replace(result, problem=replace(result.problem, detail=f"line {line.number}: {result.problem.detail}"))


# --- Lines ------------------------------------------------------------------------------------------------------------


def _stream(request: Request) -> Response:
    require_plain(request)
    state: State = request.app.state
    settings: Settings = state.settings
    return streaming.LineStream(
        line_evaluator(state.catalogue, state.metrics, settings.maximum_body_bytes),
        pool=pool_of(request, "batches"),
        disk=state.disk,
        maximum_line_bytes=settings.maximum_body_bytes,
        spool_folder=settings.spool_folder,
        seconds=settings.body_seconds,
    )


def line_evaluator(catalogue: Catalogue, metrics: Metrics, maximum_line_bytes: int) -> streaming.Evaluate:
    """Evaluator of lines of JSON for `LineStream`: the same result lines as `batch_lines` gives.

    The problem of a line without a reference names the line: blank ones have no result, so that counting finds another.
    """

    def read(line: Line) -> _Item:
        if line.content is None:
            return _Item(None, Problem(413, f"a line may have {maximum_line_bytes} bytes at most"))
        try:
            return _item(line.content)
        except ValueError as error:
            return _Item(None, Problem(400, f"is not JSON: {str(error).replace(' at line 1 ', ' at ')}"))

    def evaluate(lines: Sequence[Line]) -> tuple[bytes, int]:
        results = _results(map(read, lines), catalogue, metrics)
        return _encoded(map(_placed, lines, results)), len(results)

    return evaluate

"""`POST /api/v1/select/batch`: one result line per application, as one JSON object or as a stream of lines."""

import time
from collections.abc import Callable, Sequence
from typing import Any

import msgspec
from fastapi import APIRouter
from pydantic import ValidationError
from pydantic_core import from_json
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import State
from starlette.requests import Request
from starlette.responses import Response

from hpn.application import BatchItem, InputError
from hpn.catalogue import Catalogue
from hpn.fleet import judge_fleet
from hpn.selection import Judged
from hpn.web.api import schemas, streaming
from hpn.web.api.replies import BatchLine, BatchReply, JSONBytes, ProblemReply, encode, json_response
from hpn.web.api.streaming import Line
from hpn.web.door.access import admit
from hpn.web.door.bodies import content_type_of, read_body
from hpn.web.door.metrics import Metrics
from hpn.web.door.problems import Problem
from hpn.web.form.write import to_link
from hpn.web.settings import Settings

BATCH_SLICE = 256
"""Items between two looks at the clock."""

RETRY_SECONDS = 5

router = APIRouter(prefix="/api/v1", tags=["Selection"], dependencies=[admit("batch")])


@router.post(
    "/select/batch",
    operation_id="selectBatch",
    summary="Select gears for many applications",
    openapi_extra=schemas.batch_body(),
    responses=schemas.batch_answers(400, 408, 413, 415, 422, 503),
    response_class=JSONBytes,
)
async def select_batch(request: Request) -> Response:
    """One line per application; one with errors never fails its neighbours.

    As JSON up to 10000 applications; as newline-delimited JSON any number, answered while they still arrive.
    """
    state: State = request.app.state
    settings: Settings = state.settings
    if content_type_of(request) in streaming.MEDIA_TYPES:
        return _stream(state)
    body = await read_body(request, maximum_bytes=settings.maximum_batch_body_bytes, seconds=settings.body_seconds)
    items = batch_items(body, settings.maximum_batch_count)
    lines: list[BatchLine] = []
    deadline = time.monotonic() + settings.batch_seconds
    for start in range(0, len(items), BATCH_SLICE):
        if time.monotonic() > deadline:
            text = f"the batch took longer than {settings.batch_seconds:g} s; send fewer items at once"
            raise Problem(503, text, headers={"Retry-After": str(RETRY_SECONDS)})
        lines += await run_in_threadpool(batch_lines, items[start : start + BATCH_SLICE], state.catalogue)
    state.metrics.selections(line.verdict for line in lines)
    return json_response(BatchReply(lines))


def batch_items(body: bytes, maximum: int) -> list[Any]:
    """Items of a JSON batch, not yet validated; Problem 400, 413 or 422 for what is none."""
    try:
        batch = _parsed(body)
    except ValueError as error:
        raise Problem(400, f"the body is not JSON: {error}") from None
    if not isinstance(batch, dict) or not isinstance(batch.get("applications"), list):
        raise Problem(422, 'the body must be {"applications": [ … ]}', [(("applications",), "must be a list")])
    unknown = [((name,), "is not a field of this object") for name in batch if name != "applications"]
    if unknown:
        raise Problem(422, 'the body must be {"applications": [ … ]} alone', unknown)
    items: list[Any] = batch["applications"]
    if len(items) > maximum:
        raise Problem(
            413,
            f"at most {maximum} applications at once",
            [(("applications",), f"has {len(items)} items, at most {maximum}")],
        )
    return items


def _parsed(text: bytes) -> Any:
    """Value of JSON as pydantic reads it: a number that is none leads to an error of its field, not of the whole."""
    return from_json(text)


def batch_lines(items: Sequence[Any], catalogue: Catalogue) -> list[BatchLine]:
    """Result lines of batch items, in their order; each item is validated on its own.

    An item that is a Problem already becomes its line.
    """
    read = [_validated(item) for item in items]
    judged = iter(judge_fleet([item for item in read if isinstance(item, BatchItem)], catalogue))
    return [
        _line(item, next(judged) if isinstance(outcome, BatchItem) else outcome)
        for item, outcome in zip(items, read, strict=True)
    ]


def _validated(item: Any) -> BatchItem | Problem:
    if isinstance(item, Problem):
        return item
    try:
        return BatchItem.model_validate(item)
    except ValidationError as error:
        return Problem.of(error)


def _line(item: Any, outcome: Judged | InputError | Problem) -> BatchLine:
    given = item.get("reference") if isinstance(item, dict) else None
    reference = given if isinstance(given, str) else None
    if isinstance(outcome, Judged):
        brief = outcome.outcome()
        return BatchLine(reference, "ok", *brief, link=to_link(outcome.application))
    problem = Problem.of(outcome) if isinstance(outcome, InputError) else outcome
    return BatchLine(reference, "error", problem=msgspec.convert(problem.body(), ProblemReply))


# --- Lines ------------------------------------------------------------------------------------------------------------


def _stream(state: State) -> Response:
    settings: Settings = state.settings
    return streaming.LineStream(
        line_evaluator(state.catalogue, state.metrics, settings.maximum_body_bytes),
        maximum_line_bytes=settings.maximum_body_bytes,
        maximum_spool_bytes=settings.maximum_spool_bytes,
        spool_folder=settings.spool_folder,
        seconds=settings.body_seconds,
    )


def line_evaluator(
    catalogue: Catalogue, metrics: Metrics, maximum_line_bytes: int
) -> Callable[[Sequence[Line]], bytes]:
    """Evaluator of lines of JSON for `LineStream`: the same result lines as `batch_lines` gives."""

    def read(line: Line) -> Any:
        if line is None:
            return Problem(413, f"a line may have {maximum_line_bytes} bytes at most")
        try:
            return _parsed(line)
        except ValueError as error:
            return Problem(400, f"the line is not JSON: {error}")

    def evaluate(lines: Sequence[Line]) -> bytes:
        results = batch_lines([read(line) for line in lines], catalogue)
        metrics.selections(result.verdict for result in results)
        return b"".join([encode(result) + b"\n" for result in results])

    return evaluate

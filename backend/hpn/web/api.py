"""The REST interface, version 1: parse, one call into the domain, render."""

import time
from collections.abc import Sequence
from typing import Annotated, Any

import orjson
from fastapi import APIRouter, Query
from pydantic import ValidationError
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from hpn.application import Application, BatchItem, InputError
from hpn.catalogue import Catalogue
from hpn.envelopes import EnvelopeQuery, life_envelopes
from hpn.fleet import select_fleet
from hpn.gear import Gear
from hpn.selection import select
from hpn.web import schemas
from hpn.web.bodies import read_json
from hpn.web.links import to_link
from hpn.web.problems import Problem
from hpn.web.settings import Settings

LONG_CYCLE = 500
"""Phases from which a single selection leaves the event loop to others."""

BATCH_SLICE = 1024


router = APIRouter(prefix="/api/v1")


@router.post(
    "/select",
    summary="Select a gear for one application",
    openapi_extra=schemas.request_body(Application),
    responses=schemas.replies(schemas.SelectReply, 400, 408, 413, 415, 422),
    response_class=schemas.JSONBytes,
)
async def select_one(request: Request) -> Response:
    """Evaluates every size and ratio, ranks the candidates, and says why each stands where it does."""
    settings: Settings = request.app.state.settings
    body = await read_json(request, maximum_bytes=settings.maximum_body_bytes, seconds=settings.body_seconds)
    application = Application.model_validate_json(body)
    if len(application.duty_cycle.phases) > LONG_CYCLE:
        return schemas.JSONBytes(await run_in_threadpool(_reply, application, request.app.state.catalogue))
    return schemas.JSONBytes(_reply(application, request.app.state.catalogue))


def _reply(application: Application, catalogue: Catalogue) -> bytes:
    return select(application, catalogue).json(to_link(application))


@router.post(
    "/select/batch",
    summary="Select gears for up to 10000 applications",
    openapi_extra=schemas.request_body(schemas.Batch),
    responses=schemas.replies(schemas.BatchReply, 400, 408, 413, 415, 422, 503),
    response_class=schemas.JSONBytes,
)
async def select_batch(request: Request) -> Response:
    """One line per application; an item with errors never fails its neighbours."""
    settings: Settings = request.app.state.settings
    body = await read_json(request, maximum_bytes=settings.maximum_batch_body_bytes, seconds=settings.body_seconds)
    items = _batch_items(body, settings.maximum_batch_count)
    results: list[dict[str, Any]] = []
    deadline = time.monotonic() + settings.batch_seconds
    for start in range(0, len(items), BATCH_SLICE):
        if time.monotonic() > deadline:
            raise Problem(503, f"the batch took longer than {settings.batch_seconds:g} s; send fewer items at once")
        results += await run_in_threadpool(batch_lines, items[start : start + BATCH_SLICE], request.app.state.catalogue)
    return schemas.JSONBytes(orjson.dumps({"results": results}))


def _batch_items(body: bytes, maximum: int) -> list[Any]:
    try:
        batch = orjson.loads(body)
    except orjson.JSONDecodeError as error:
        raise Problem(400, f"the body is not JSON: {error}") from None
    if not isinstance(batch, dict) or not isinstance(batch.get("applications"), list) or len(batch) != 1:
        raise Problem(
            422, 'the body must be {"applications": [ … ]}', [(("applications",), "must be a list, and the only field")]
        )
    items: list[Any] = batch["applications"]
    if len(items) > maximum:
        raise Problem(
            413,
            f"at most {maximum} applications at once",
            [(("applications",), f"has {len(items)} items, at most {maximum}")],
        )
    return items


def batch_lines(items: Sequence[Any], catalogue: Catalogue) -> list[dict[str, Any]]:
    """Result lines of batch items, in their order; each item is validated on its own."""
    lines: list[dict[str, Any]] = []
    valid: list[tuple[int, BatchItem]] = []
    for item in items:
        reference = item.get("reference") if isinstance(item, dict) else None
        line: dict[str, Any] = {"reference": reference if isinstance(reference, str) else None}
        lines.append(line)
        try:
            valid.append((len(lines) - 1, BatchItem.model_validate(item)))
        except ValidationError as error:
            line |= {"status": "error", "problem": Problem.of(error).body()}
    selections = select_fleet([item for _, item in valid], catalogue)
    for (index, item), selection in zip(valid, selections, strict=True):
        if isinstance(selection, InputError):
            lines[index] |= {"status": "error", "problem": Problem.of(selection).body()}
        else:
            lines[index] |= selection.summary(to_link(item))
    return lines


@router.get("/catalogue", response_model=schemas.CatalogueReply, responses=schemas.problems(406))
async def catalogue(request: Request) -> Response:
    """Every gear of the series with every published figure and its source; null where not published."""
    book: Catalogue = request.app.state.catalogue
    return schemas.JSONBytes(
        orjson.dumps({"catalogue_version": book.version, "gears": book.gears, "series": book.series})
    )


@router.get("/catalogue/{designation}", response_model=schemas.GearReply, responses=schemas.problems(404))
async def gear(request: Request, designation: str) -> Response:
    """One gear, by its designation in any of the printed spellings."""
    return schemas.JSONBytes(orjson.dumps(_gear(request.app.state.catalogue, designation)))


def _gear(book: Catalogue, designation: str) -> Gear:
    found = book.find(designation)
    if found is None:
        raise Problem(404, f"the catalogue has no gear {designation[:60]!r}; a designation is written like HPN-20A-5")
    return found


@router.get("/bearing-envelopes/{size}", response_model=schemas.EnvelopeReply, responses=schemas.problems(404, 422))
async def bearing_envelopes(request: Request, size: str, query: Annotated[EnvelopeQuery, Query()]) -> Response:
    """What a constant load may be at this speed and life: one curve per load coefficient, from axial to radial axis."""
    book: Catalogue = request.app.state.catalogue
    gear = book.find_size(size)
    if gear is None:
        raise Problem(404, f"the catalogue has no size {size[:60]!r}; there are {', '.join(book.sizes)}")
    curves = life_envelopes(book, gear, query)
    return schemas.JSONBytes(orjson.dumps({"size": gear.size, "model": query.model, "curves": curves}))


FAST_ROUTES = (Route("/api/v1/select", select_one, methods=["POST"]),)
"""Routes that Starlette runs without FastAPI's dependency machinery, which costs more than the selection does."""

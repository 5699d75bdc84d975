"""The REST interface, version 1: parse, one call into the domain, render."""

import dataclasses
import time
from typing import Annotated, Any

import orjson
from fastapi import APIRouter, Query
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import State
from starlette.requests import Request
from starlette.responses import Response

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.envelopes import EnvelopeQuery, life_envelopes
from hpn.gear import Gear
from hpn.selection import select
from hpn.web.api import schemas, streaming
from hpn.web.api.batch import batch_items, batch_lines, line_evaluator
from hpn.web.door.access import admit
from hpn.web.door.bodies import content_type_of, read_body
from hpn.web.door.problems import Problem
from hpn.web.form.write import to_link
from hpn.web.settings import Settings

LONG_CYCLE = 500
"""Phases from which a single selection leaves the event loop to others."""

BATCH_SLICE = 64
"""Items between two looks at the clock."""

RETRY_SECONDS = 5


router = APIRouter(prefix="/api/v1", dependencies=[admit("calculator")])
batch_router = APIRouter(prefix="/api/v1", dependencies=[admit("batch")])


@router.post(
    "/select",
    summary="Select a gear for one application",
    openapi_extra=schemas.request_body(Application),
    responses=schemas.replies(schemas.SelectReply, 400, 408, 413, 415, 422),
    response_class=schemas.JSONBytes,
)
async def select_one(request: Request) -> Response:
    """Evaluates every size and ratio, ranks the candidates, and says why each stands where it does."""
    state: State = request.app.state
    settings: Settings = state.settings
    body = await read_body(request, maximum_bytes=settings.maximum_body_bytes, seconds=settings.body_seconds)
    application = Application.model_validate_json(body)
    long = len(application.duty_cycle.phases) > LONG_CYCLE
    selected, reply = await run_in_threadpool(_reply, application, state) if long else _reply(application, state)
    state.metrics.selection(selected)
    return schemas.JSONBytes(reply)


def _reply(application: Application, state: State) -> tuple[str | None, bytes]:
    selection = select(application, state.catalogue)
    return selection.selected, selection.json(to_link(application))


@batch_router.post(
    "/select/batch",
    summary="Select gears for many applications",
    openapi_extra=schemas.batch_body(),
    responses=schemas.batch_replies(400, 408, 413, 415, 422, 503),
    response_class=schemas.JSONBytes,
)
async def select_batch(request: Request) -> Response:
    """One line per application; one with errors never fails its neighbours.

    As JSON up to 10000 applications; as newline-delimited JSON any number, answered while they still arrive.
    """
    settings: Settings = request.app.state.settings
    if content_type_of(request) in streaming.MEDIA_TYPES:
        return _stream(request.app.state)
    body = await read_body(request, maximum_bytes=settings.maximum_batch_body_bytes, seconds=settings.body_seconds)
    items = batch_items(body, settings.maximum_batch_count)
    results: list[dict[str, Any]] = []
    deadline = time.monotonic() + settings.batch_seconds
    for start in range(0, len(items), BATCH_SLICE):
        if time.monotonic() > deadline:
            text = f"the batch took longer than {settings.batch_seconds:g} s; send fewer items at once"
            raise Problem(503, text, headers={"Retry-After": str(RETRY_SECONDS)})
        results += await run_in_threadpool(batch_lines, items[start : start + BATCH_SLICE], request.app.state.catalogue)
    request.app.state.metrics.batch(results)
    return schemas.JSONBytes(orjson.dumps({"results": results}))


def _stream(state: State) -> Response:
    settings: Settings = state.settings
    return streaming.LineStream(
        line_evaluator(state.catalogue, state.metrics, settings.maximum_body_bytes),
        maximum_line_bytes=settings.maximum_body_bytes,
        maximum_spool_bytes=settings.maximum_spool_bytes,
        spool_folder=settings.spool_folder,
        seconds=settings.body_seconds,
    )


@router.get("/catalogue", summary="Every gear", response_model=schemas.CatalogueReply, responses=schemas.problems(406))
async def catalogue(request: Request) -> Response:
    """Every gear of the series with every published figure and its source; null where not published."""
    book: Catalogue = request.app.state.catalogue
    return schemas.JSONBytes(
        orjson.dumps({"catalogue_version": book.version, "gears": book.gears, "series": book.series})
    )


@router.get(
    "/catalogue/{designation}",
    summary="One gear",
    response_model=schemas.OneGearReply,
    responses=schemas.problems(404),
)
async def gear(request: Request, designation: str) -> Response:
    """One gear, by its designation in any of the printed spellings: by itself, and as the list has it."""
    book: Catalogue = request.app.state.catalogue
    found = _gear(book, designation)
    fields = {field.name: getattr(found, field.name) for field in dataclasses.fields(found)}
    return schemas.JSONBytes(orjson.dumps({"catalogue_version": book.version, **fields, "gears": [found]}))


def _gear(book: Catalogue, designation: str) -> Gear:
    found = book.find(designation)
    if found is None:
        raise Problem(404, f"the catalogue has no gear {designation[:60]!r}; a designation is written like HPN-20A-5")
    return found


@router.get(
    "/bearing-envelopes/{size}",
    summary="Life envelopes of a size's output bearing",
    response_model=schemas.EnvelopeReply,
    responses=schemas.problems(404, 422),
)
async def bearing_envelopes(request: Request, size: str, query: Annotated[EnvelopeQuery, Query()]) -> Response:
    """What a constant load may be at this speed and life: one curve per load coefficient, from axial to radial axis."""
    book: Catalogue = request.app.state.catalogue
    gear = book.find_size(size)
    if gear is None:
        raise Problem(404, f"the catalogue has no size {size[:60]!r}; there are {', '.join(book.sizes)}")
    curves = life_envelopes(book, gear, query)
    sources = (
        {"curve": "supplied by the user: points of bearing_envelopes.csv"}
        if query.model == "digitised"
        else {name: gear.sources[name] for name in ("dynamic_radial_load_N", "dynamic_axial_load_N")}
    )
    reply = {"size": gear.size, "model": query.model, "curves": curves, "sources": sources}
    return schemas.JSONBytes(orjson.dumps(reply))

"""Saved selections over REST: save, read with what differs today, list, delete."""

from dataclasses import dataclass
from typing import Annotated, Any
from urllib.parse import urlencode

import orjson
from fastapi import APIRouter, Query
from pydantic import ValidationError
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import State
from starlette.requests import Request
from starlette.responses import Response

from hpn import ENGINE_VERSION
from hpn.application import Application, InputError
from hpn.candidates import foremost
from hpn.catalogue import Catalogue
from hpn.differences import Difference, FigureDifference, differences, figure_differences
from hpn.selection import select
from hpn.store import Draft, KeyReusedError, KeySpentError, SavedSelection, Store, Summary
from hpn.web.api import schemas
from hpn.web.api.select import LONG_CYCLE
from hpn.web.api.selection_schemas import (
    Labels,
    Line,
    SavedReply,
    SavedSelectionReply,
    SaveRequest,
    SelectionListReply,
)
from hpn.web.door.access import admit
from hpn.web.door.bodies import read_body
from hpn.web.door.conditions import conditional, idempotency_key, preferred_return, require_match
from hpn.web.door.problems import Problem
from hpn.web.form.write import to_link
from hpn.web.settings import Settings

DIFFERENCES_SHOWN = 500
RETRY_SECONDS = 5
KEY = (
    "Makes a retry safe: the same key and content is saved once, other content is a 422. A key belongs to its caller "
    "and lasts: once its selection is deleted it is answered with 410, so that a late retry saves nothing anew."
)

router = APIRouter(prefix="/api/v1/selections")
"""Its routes are of different groups, which each declares."""


@router.post(
    "",
    dependencies=[admit("writing")],
    summary="Save a selection",
    status_code=201,
    openapi_extra=schemas.request_body(SaveRequest)
    | {
        "parameters": [
            schemas.header("Idempotency-Key", KEY),
            schemas.header("Prefer", "return=minimal: no body; return=representation: the whole saved selection."),
        ]
    },
    responses={
        201: {"model": SavedReply, "headers": schemas.LOCATION},
        **schemas.problems(400, 408, 410, 413, 415, 422, 503),
    },
    response_class=schemas.JSONBytes,
)
async def save_selection(request: Request) -> Response:
    """Saves an application with its result; once answered with 201 it is durable."""
    settings: Settings = request.app.state.settings
    key = idempotency_key(request)
    body = await read_body(request, maximum_bytes=settings.maximum_body_bytes, seconds=settings.body_seconds)
    wanted = SaveRequest.model_validate_json(body)
    try:
        id = await save(request.app.state, wanted.application, wanted, key)
    except InputError as error:
        raise error.below("application") from None
    headers = {"Location": f"/api/v1/selections/{id}"}
    preferred = preferred_return(request)
    if preferred:
        headers["Preference-Applied"] = f"return={preferred}"
    if preferred == "minimal":
        return Response(status_code=201, headers=headers)
    if preferred == "representation":
        return schemas.JSONBytes(await _representation(request, id), 201, headers)
    return schemas.JSONBytes(orjson.dumps({"id": id, "url": url_of(id)}), 201, headers)


@router.get(
    "/{id}",
    dependencies=[admit("reading")],
    summary="Read a saved selection",
    response_model=SavedSelectionReply,
    openapi_extra=schemas.IF_NONE_MATCH,
    responses={200: {"headers": schemas.ETAG}} | schemas.HAS_IT_ALREADY | schemas.problems(404, 503),
)
async def read_selection(request: Request, id: str) -> Response:
    """Input and result as saved, and what today's engine and catalogue say differently, verdicts first."""
    return conditional(request, await _representation(request, id))


@router.get(
    "",
    dependencies=[admit("listing")],
    summary="List saved selections",
    response_model=SelectionListReply,
    openapi_extra=schemas.IF_NONE_MATCH,
    responses={200: {"headers": schemas.ETAG | schemas.NEXT_PART}}
    | schemas.HAS_IT_ALREADY
    | schemas.problems(422, 503),
)
async def list_selections(
    request: Request,
    reference: Annotated[Line | None, Query(description="Only those with this reference.")] = None,
    cursor: Annotated[str | None, Query(max_length=200, description="From an earlier part of the list.")] = None,
    limit: Annotated[int, Query(ge=1, le=200, description="How many at most.")] = 50,
) -> Response:
    """Saved selections, newest first; the Link header leads to the next part."""
    store: Store = request.app.state.store
    try:
        page = await store.page(reference=reference, cursor=cursor, limit=limit)
    except ValueError as error:
        raise Problem(422, f"cursor {error}", [(("cursor",), str(error))]) from None
    lines = [_summary(selection) for selection in page.selections]
    response = conditional(request, orjson.dumps({"selections": lines, "next_cursor": page.next_cursor}))
    if page.next_cursor:
        query = {"reference": reference, "cursor": page.next_cursor, "limit": limit}
        address = urlencode({name: value for name, value in query.items() if value is not None})
        response.headers["Link"] = f'</api/v1/selections?{address}>; rel="next"'
    return response


@router.delete(
    "/{id}",
    dependencies=[admit("deleting")],
    summary="Delete a saved selection",
    status_code=204,
    responses=schemas.problems(404, 412, 503),
    openapi_extra={"parameters": [schemas.header("If-Match", "Delete only this state of it.")]},
)
async def delete_selection(request: Request, id: str) -> Response:
    """Deletes a saved selection for good. A retry of saving it, with its Idempotency-Key, is then answered with 410."""
    store: Store = request.app.state.store
    if "if-match" in request.headers:
        require_match(request, await _representation(request, id))
    if not await store.delete(id):
        raise not_found(id)
    return Response(status_code=204)


# --- What the page of a saved selection needs too ---------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Today:
    """What today's engine and catalogue say to a saved application: differences, or why they have no answer.

    `link` leads to the live form with a copy of the application. `then` is the catalogue of that time, and `figures`
    what today's publishes differently; None where that of then is not kept.
    """

    differences: list[Difference]
    problem: dict[str, Any] | None
    link: str
    then: Catalogue | None
    figures: list[FigureDifference] | None


def url_of(id: str) -> str:
    """Address of the page of a saved selection."""
    return f"/selections/{id}"


async def save(state: State, application: Application, labels: Labels, key: str | None = None) -> str:
    """Select and save; the id under which it is durable.

    Raises InputError as `select` does, before the store is asked; Problem 422 or 410 for a key that was used before.
    """
    long = len(application.duty_cycle.phases) > LONG_CYCLE
    arguments = state.catalogue, application, labels, key
    draft = await run_in_threadpool(draft_of, *arguments) if long else draft_of(*arguments)
    state.metrics.selection(draft.selected)
    try:
        id: str = await state.store.save(draft)
    except KeyReusedError as error:
        raise Problem(422, str(error)) from None
    except KeySpentError as error:
        raise Problem(410, str(error)) from None
    return id


def draft_of(catalogue: Catalogue, application: Application, labels: Labels, key: str | None) -> Draft:
    """What is saved of an application: its own JSON, and the reply that `select` gives it."""
    selection = select(application, catalogue)
    return Draft(
        application=application.model_dump_json(exclude_unset=True).encode(),
        result=selection.json(to_link(application)),
        engine_version=ENGINE_VERSION,
        catalogue_version=catalogue.version,
        selected=selection.selected,
        title=labels.title,
        reference=labels.reference,
        idempotency_key=key,
        catalogue=catalogue,
    )


async def found(state: State, id: str) -> tuple[SavedSelection, Today]:
    """A saved selection and what differs today; Problem 404 where there is none."""
    saved, then = await with_catalogue(state, id)
    return saved, await run_in_threadpool(reopen, saved, then, state.catalogue)


async def with_catalogue(state: State, id: str) -> tuple[SavedSelection, Catalogue | None]:
    """A saved selection and the catalogue it was saved under, None where that is not kept; Problem 404."""
    saved = await state.store.find(id)
    if saved is None:
        raise not_found(id)
    if saved.catalogue_version == state.catalogue.version:
        return saved, state.catalogue
    return saved, await state.store.catalogue(saved.catalogue_version)


def not_found(id: str) -> Problem:
    """There is no such saved selection."""
    return Problem(404, f"there is no saved selection {id[:60]!r}; it may have been deleted")


def reopen(saved: SavedSelection, then: Catalogue | None, catalogue: Catalogue) -> Today:
    """Ask today's engine and catalogue again, and compare; what was saved stays as it is."""
    before = orjson.loads(saved.result)
    gears = [candidate["designation"] for candidate in before["candidates"]]
    figures = None if then is None else [] if then is catalogue else figure_differences(then, catalogue, gears)
    try:
        application = Application.model_validate_json(saved.application)
        link = to_link(application)
        after = select(application, catalogue).json(link)
    except (ValidationError, InputError) as error:
        return Today([], Problem.of(error).body(), before["link"], then, figures)
    same = after == saved.result
    return Today([] if same else differences(before, orjson.loads(after)), None, link, then, figures)


async def unavailable(request: Request, error: Exception) -> Response:
    """The store is out of reach for now."""
    return Problem(503, str(error), headers={"Retry-After": str(RETRY_SECONDS)}).response()


async def _representation(request: Request, id: str) -> bytes:
    saved, today = await found(request.app.state, id)
    first = foremost(orjson.loads(saved.result)["candidates"])["designation"]
    return orjson.dumps(
        _summary(saved)
        | {
            "application": orjson.Fragment(saved.application),
            "gear": today.then and today.then.by_designation.get(first),
            "result": orjson.Fragment(saved.result),
            "today": {
                "engine_version": ENGINE_VERSION,
                "catalogue_version": request.app.state.catalogue.version,
                "difference_count": len(today.differences),
                "differences": today.differences[:DIFFERENCES_SHOWN],
                "figure_differences": today.figures and today.figures[:DIFFERENCES_SHOWN],
                "problem": today.problem,
            },
        }
    )


def _summary(selection: Summary) -> dict[str, Any]:
    return {
        "id": selection.id,
        "url": url_of(selection.id),
        "created": selection.created.isoformat(timespec="microseconds").replace("+00:00", "Z"),
        "title": selection.title,
        "reference": selection.reference,
        "selected": selection.selected,
        "engine_version": selection.engine_version,
        "catalogue_version": selection.catalogue_version,
    }

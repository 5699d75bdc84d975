"""Saved selections over REST: save, read with today's differences, list, search, rename, delete."""

from functools import partial
from typing import Annotated, Any

from fastapi import APIRouter, Query
from msgspec import Raw, convert, structs
from starlette.requests import Request
from starlette.responses import Response

from hpn import ENGINE_VERSION
from hpn.application import Application, InputError
from hpn.catalogue import Catalogue
from hpn.store import Draft, LineFilter, SavedSelection, SelectionLine, Store
from hpn.web.api import machine_replies as replies
from hpn.web.api import schemas
from hpn.web.api.lists import ListQuery, linked, part_of
from hpn.web.api.replies import (
    DIFFERENCES_SHOWN,
    JSONBytes,
    ProblemReply,
    SavedReply,
    SavedSelectionReply,
    SelectionLineReply,
    SelectionListReply,
    SelectionToday,
    SummaryReply,
    TodayReply,
)
from hpn.web.api.replies import encode as encode_reply
from hpn.web.archive import (
    Labels,
    Names,
    Reopened,
    SaveRequest,
    changeable,
    draft_of,
    keep,
    not_found,
    on_saved,
    url_of,
    with_catalogue,
)
from hpn.web.door.access import admit
from hpn.web.door.bodies import JSON, MERGE_PATCH, parsed, read_body
from hpn.web.door.conditions import (
    REPLAYED,
    conditional,
    etag_of,
    idempotency_key,
    prefers_representation,
    require_done,
    require_match,
)
from hpn.web.door.observation import note
from hpn.web.door.pools import calculate
from hpn.web.todays import versions_of

KEY = (
    "Makes a retry safe: the same key with the same content is saved once; with other content it is a 422. A key "
    "belongs to its caller (API key, else address) and does not expire: after its selection is deleted, a late retry "
    "is answered with 410 and saves nothing."
)


router = APIRouter(prefix="/api/v1/selections", tags=["Saved selections"])
"""Router without a common group: each route declares its own."""


@router.post(
    "",
    dependencies=[admit("writing")],
    operation_id="saveSelection",
    summary="Save a selection",
    status_code=201,
    openapi_extra=schemas.request_body(SaveRequest)
    | {
        "parameters": [
            schemas.header("Idempotency-Key", KEY),
            schemas.header("Prefer", "return=representation: returns the whole saved selection."),
        ]
    },
    response_model=SavedReply,
    responses=schemas.answers(
        *(400, 408, 410, 413, 415, 422),
        status=201,
        headers=schemas.headers("Location", "ETag", REPLAYED, "Preference-Applied"),
        links=schemas.FROM_SAVED,
    ),
)
async def save_selection(request: Request) -> Response:
    """Saves an application with its result; the selection is durable once the reply is 201."""
    key = idempotency_key(request)
    body = await read_body(request)
    owner, catalogue = request.state.api_key, request.app.state.catalogue
    draft = await calculate(request, body, _draft, body, catalogue, key, owner)
    id = await keep(request, draft)
    headers = {"Location": f"/api/v1/selections/{id}"}
    if id == draft.id:
        headers["ETag"] = _tag(id, (1, draft.label), catalogue.version, catalogue)
    else:
        headers |= {"ETag": _tag_of(*await with_catalogue(request.app.state, id), catalogue), REPLAYED: "true"}
    if prefers_representation(request):
        headers["Preference-Applied"] = "return=representation"
        whole, headers["ETag"] = await represented(request, id)
        return JSONBytes(whole, 201, headers)
    return JSONBytes(encode_reply(SavedReply(id, url_of(id))), 201, headers)


def _draft(body: bytes, catalogue: Catalogue, key: str | None, owner: str | None) -> Draft:
    save = parsed(SaveRequest, body)
    return draft_in(catalogue, save.application, save, key, owner)


def draft_in(
    catalogue: Catalogue, application: Application, labels: Labels, key: str | None = None, owner: str | None = None
) -> Draft:
    """Record of an application in a body; its faults have the pointers of the body."""
    try:
        return draft_of(catalogue, application, labels, key, owner)
    except InputError as error:
        if error.sentences[0][0] == ("ordering_code",):
            raise
        raise error.below("application") from None


@router.get(
    "/{id}",
    dependencies=[admit("reading")],
    operation_id="getSelection",
    summary="Read a saved selection",
    openapi_extra=schemas.IF_NONE_MATCH,
    response_model=SavedSelectionReply,
    responses=schemas.tagged(404, 409, 422, links=schemas.FROM_SELECTION),
)
async def read_selection(
    request: Request,
    id: schemas.Id,
    revision: schemas.Revision = None,
) -> Response:
    """Input and result as saved, and the differences by today's engine and catalogue, verdicts first."""
    return conditional(request, *await represented(request, id, revision))


@router.get(
    "",
    dependencies=[admit("listing")],
    operation_id="listSelections",
    summary="List saved selections",
    openapi_extra=schemas.IF_NONE_MATCH,
    response_model=SelectionListReply,
    responses=schemas.answers(422, headers=schemas.headers("ETag", "Link"), links=schemas.FROM_LIST)
    | schemas.HAS_IT_ALREADY,
)
async def list_selections(request: Request, query: Annotated[ListQuery, Query()]) -> Response:
    """Saved selections, newest first; the Link header gives the next page.

    `today` is the gear and verdict by today's engine and catalogue. It is computed in the background; `pending` is the
    number of selections that still lack it. `differs=verdict` lists the selections with another gear or verdict.
    """
    store: Store = request.app.state.store

    async def read(filter: LineFilter, cursor: str | None, limit: int) -> tuple[list[Any], str | None]:
        page = await store.page(cursor=cursor, limit=limit, filter=filter)
        return page.selections, page.next_cursor

    part = await part_of(request, query, "selection", read)
    key = versions_of(request.app.state).key
    lines = [_line(selection, key) for selection in part.lines]
    response = conditional(request, encode_reply(SelectionListReply(lines, *part[1:])))
    return linked(response, request, "/api/v1/selections", part)


@router.patch(
    "/{id}",
    dependencies=[admit("deleting")],
    operation_id="renameSelection",
    summary="Rename a saved selection",
    openapi_extra=schemas.request_body(Names, JSON, MERGE_PATCH)
    | {"parameters": [schemas.header("If-Match", "Tag of the version to rename.")]},
    response_model=SavedSelectionReply,
    responses=schemas.answers(*(400, 403, 404, 408, 409, 412, 413, 415, 422), headers=schemas.headers("ETag")),
)
async def rename_selection(request: Request, id: schemas.Id) -> Response:
    """Changes title or reference of a saved selection; null removes a field, an omitted field stays.

    The body is a JSON merge patch (RFC 7396). Calculated figures are never rewritten. Where the service has API keys, a
    key renames the selections that it saved, and the key named `admin` renames any.
    """
    store: Store = request.app.state.store
    body = await read_body(request, JSON, MERGE_PATCH)
    names = (await calculate(request, body, parsed, Names, body)).model_dump(exclude_unset=True)
    await changeable(request, id)
    version = await matched_version(request, id)
    require_done(await store.rename(id, names, version), version, not_found(id))
    note(request, selection=id)
    renamed, etag = await represented(request, id)
    return JSONBytes(renamed, headers={"ETag": etag, "Cache-Control": "no-cache"})


@router.delete(
    "/{id}",
    dependencies=[admit("deleting")],
    operation_id="deleteSelection",
    summary="Delete a saved selection",
    status_code=204,
    responses=schemas.DELETED | schemas.problems(403, 404, 412, 422),
    openapi_extra={"parameters": [schemas.header("If-Match", "Tag of the version to delete.")]},
)
async def delete_selection(request: Request, id: schemas.Id) -> Response:
    """Deletes a saved selection permanently. A retry of saving it, with its Idempotency-Key, is then answered with 410.

    Where the service has API keys, a key deletes the selections that it saved, and the key named `admin` deletes any.
    """
    store: Store = request.app.state.store
    await changeable(request, id)
    version = await matched_version(request, id)
    require_done(await store.delete(id, version), version, not_found(id))
    note(request, selection=id)
    return Response(status_code=204)


async def matched_version(request: Request, id: str) -> int | None:
    """Present version if `If-Match` names its state, None if it accepts any; Problem 412 for another state.

    The write must then ask for this version, as others may write after this check.
    """
    if request.headers.get("if-match", "*").strip() == "*":  # any existing state
        return None
    saved, then = await with_catalogue(request.app.state, id)
    require_match(request, _tag_of(saved, then, request.app.state.catalogue))
    return saved.version


async def tag_at(request: Request, id: str, label: str) -> str:
    """Entity tag of a saved selection in the revision of a label."""
    state = request.app.state
    return _tag_of(*await with_catalogue(state, id, label), state.catalogue)


def _tag_of(saved: SavedSelection, then: Catalogue | None, today: Catalogue) -> str:
    return _tag(saved.id, (saved.version, saved.label), None if then is None else then.version, today)


def _tag(id: str, state: tuple[int, str], then: str | None, today: Catalogue) -> str:
    """Entity tag of a saved selection, from the versions of everything in its representation."""
    return etag_of(f"{id} {' '.join(map(str, state))} {then} {today.version} {ENGINE_VERSION}".encode())


async def represented(request: Request, id: str, label: str | None = None) -> tuple[bytes, str]:
    """JSON of a saved selection as `SavedSelectionReply`, application and result in the saved bytes; its entity tag."""
    return await on_saved(request, id, partial(_represented, catalogue=request.app.state.catalogue), label)


def _represented(reopened: Reopened, catalogue: Catalogue) -> tuple[bytes, str]:
    saved, then = reopened.saved, reopened.then
    gear = saved.designation or reopened.selection.foremost.designation
    body = encode_reply(
        {
            **structs.asdict(_summary(saved)),
            "application": Raw(saved.application),
            "gear": then and then.by_designation.get(gear),
            "result": Raw(saved.result),
            "label": saved.label,
            "revisions": [replies.revision(each) for each in saved.revisions],
            "today": _today(reopened, catalogue),
        }
    )
    return body, _tag_of(saved, then, catalogue)


def _today(reopened: Reopened, catalogue: Catalogue) -> TodayReply:
    problem, figures = reopened.problem, reopened.figures
    return TodayReply(
        engine_version=ENGINE_VERSION,
        catalogue_version=catalogue.version,
        difference_count=len(reopened.differences),
        differences=reopened.differences[:DIFFERENCES_SHOWN],
        figure_differences=None if figures is None else figures[:DIFFERENCES_SHOWN],
        problem=None if problem is None else convert(problem.body(), ProblemReply),
    )


def _line(selection: SelectionLine, key: str) -> SelectionLineReply:
    """Line of the list, with its verdict by the versions of a key, if that is known."""
    today = None
    if selection.today_of == key and selection.today_changed is not None:
        verdict = selection.today_selected, selection.today_status
        today = SelectionToday(*verdict, verdict_changed=selection.today_changed > 0)
    return SelectionLineReply(**structs.asdict(_summary(selection)), today=today)


def _summary(selection: SelectionLine) -> SummaryReply:
    own: dict[str, Any] = {name: getattr(selection, name, None) for name in SummaryReply.__struct_fields__}
    return SummaryReply(**own | {"url": url_of(selection.id), "created": replies.moment(selection.created)})

"""Revisions of saved selections over REST: each is the whole selection in its state under a label."""

from typing import Annotated

from fastapi import APIRouter, Path
from pydantic import Field
from starlette.requests import Request
from starlette.responses import Response

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.documents.revision import RevisionBlock
from hpn.store import Draft
from hpn.web.api import machine_replies as replies
from hpn.web.api import schemas
from hpn.web.api.replies import JSONBytes, RevisionReply, SavedSelectionReply, encode
from hpn.web.api.selections import draft_in, matched_version, represented, tag_at
from hpn.web.archive import Labels, Line, changeable, with_catalogue
from hpn.web.door.access import admit
from hpn.web.door.bodies import parsed, read_body
from hpn.web.door.conditions import REPLAYED, conditional
from hpn.web.door.pools import calculate
from hpn.web.freezing import freeze, revision
from hpn.web.machines import made_before, once_of

Label = Annotated[str, Path(max_length=20, description="Label of the revision; upper and lower case are the same.")]

router = APIRouter(prefix="/api/v1/selections/{id}/revisions", tags=["Saved selections"])


class SelectionRevision(RevisionBlock):
    """An application to be frozen as the next revision of a selection."""

    application: Application = Field(description="The complete application; it replaces the previous one.")
    ordering_code: Line | None = Field(
        None,
        description="Gear, output version and motor adapter as ordered, as far as known; if omitted, the revision has "
        "none.",
        examples=["HPN-20A-5-J6-BH-AF1"],
    )


@router.post(
    "",
    dependencies=[admit("deleting")],
    operation_id="saveSelectionRevision",
    summary="Freeze a revision of a selection",
    status_code=201,
    openapi_extra=schemas.request_body(SelectionRevision) | schemas.ONCE_OF_STATE,
    response_model=RevisionReply,
    responses=schemas.FREEZES,
)
async def save_revision(request: Request, id: schemas.Id) -> Response:
    """Calculates an application and freezes it with its whole result as the next revision. A revision never changes."""
    once = once_of(request, body := await read_body(request))
    before = label = None if once is None else await made_before(request, once)
    if label is None:
        await changeable(request, id)
        version = await matched_version(request, id)
        block, draft = await calculate(request, body, _drafted, body, request.app.state.catalogue)
        label = await freeze(request, id, block, once, draft, version)
    (line, _), tag = await revision(request, id, label), await tag_at(request, id, label)
    headers = {"Location": f"/api/v1/selections/{id}/revisions/{line.label}", "ETag": tag}
    if before is not None:
        headers[REPLAYED] = "true"
    return JSONBytes(encode(replies.revision(line)), 201, headers)


def _drafted(body: bytes, catalogue: Catalogue) -> tuple[SelectionRevision, Draft]:
    revision = parsed(SelectionRevision, body)
    return revision, draft_in(catalogue, revision.application, Labels(ordering_code=revision.ordering_code))


@router.get(
    "",
    dependencies=[admit("reading")],
    operation_id="listSelectionRevisions",
    summary="List revisions of a selection",
    response_model=replies.RevisionsReply,
    responses=schemas.answers(404, 422),
)
async def list_revisions(request: Request, id: schemas.Id) -> Response:
    """Revisions of a selection, the latest first."""
    saved, _ = await with_catalogue(request.app.state, id)
    body = encode(replies.RevisionsReply([replies.revision(each) for each in saved.revisions]))
    return JSONBytes(body, headers={"Cache-Control": "no-cache"})


@router.get(
    "/{label}",
    dependencies=[admit("reading")],
    operation_id="getSelectionRevision",
    summary="Read a revision of a selection",
    openapi_extra=schemas.IF_NONE_MATCH,
    response_model=SavedSelectionReply,
    responses=schemas.tagged(404, 409, 422),
)
async def read_revision(request: Request, id: schemas.Id, label: Label) -> Response:
    """Input and result as frozen, and today's differences, in the form of GET /api/v1/selections/{id}."""
    return conditional(request, *await represented(request, id, label))

"""Revisions of documents over REST, and figures of the working copy: gears to order and fewest kinds."""

from collections.abc import Mapping
from typing import Annotated

from fastapi import APIRouter, Path, Query
from starlette.requests import Request
from starlette.responses import Response

from hpn.documents.axis import MOST_AXES
from hpn.documents.differences import DocumentDifferences, differences
from hpn.documents.gears import GearOrder, gears_of
from hpn.documents.kinds import MachineKinds
from hpn.documents.revision import RevisionBlock, decode
from hpn.web.api import machine_replies as replies
from hpn.web.api import schemas
from hpn.web.api.machines import ADDRESS
from hpn.web.api.replies import JSONBytes, RevisionReply, encode
from hpn.web.door.access import admit
from hpn.web.door.bodies import parsed, read_body
from hpn.web.door.conditions import REPLAYED, etag_of
from hpn.web.door.pools import compute
from hpn.web.edits import kinds_in, order_axis
from hpn.web.freezing import freeze, revision
from hpn.web.machines import machine_of, made_before, once_of
from hpn.web.states import catalogues_of, documents_of, states_of

Label = Annotated[str, Path(max_length=20, description="Label of the revision; upper and lower case are the same.")]

router = APIRouter(prefix=f"{ADDRESS}/{{id}}", tags=["Machines"])


@router.post(
    "/revisions",
    dependencies=[admit("deleting")],
    operation_id="saveRevision",
    summary="Freeze a revision",
    status_code=201,
    openapi_extra=schemas.request_body(RevisionBlock) | schemas.ONCE_OF_STATE,
    response_model=RevisionReply,
    responses=schemas.FREEZES,
)
async def save_revision(request: Request, id: schemas.Id) -> Response:
    """Freezes the working copy under a label: own, inherited and resolved values, and answers. It never changes."""
    once = once_of(request, body := await read_body(request))
    block = parsed(RevisionBlock, body)
    if once is not None and (label := await made_before(request, once)) is not None:
        return await _kept_revision(request, id, label, {REPLAYED: "true"})
    label = await freeze(request, id, block, once)
    return await _kept_revision(request, id, label, {})


async def _kept_revision(request: Request, id: str, label: str, replayed: Mapping[str, str]) -> Response:
    line, content = await revision(request, id, label)
    headers = {"Location": f"{ADDRESS}/{id}/revisions/{line.label}", "ETag": etag_of(content), **replayed}
    return JSONBytes(encode(replies.revision(line)), 201, headers)


@router.get(
    "/revisions",
    dependencies=[admit("reading")],
    operation_id="listRevisions",
    summary="List revisions",
    response_model=replies.RevisionsReply,
    responses=schemas.answers(403, 404, 422),
)
async def list_revisions(request: Request, id: schemas.Id) -> Response:
    """Revisions of a document, the latest first."""
    await machine_of(request, id, [])
    lines = await request.app.state.store.revisions(id)
    body = encode(replies.RevisionsReply([replies.revision(each) for each in lines]))
    return JSONBytes(body, headers={"Cache-Control": "no-cache"})


@router.get(
    "/revisions/{label}",
    dependencies=[admit("reading")],
    operation_id="getRevision",
    summary="Read a revision",
    response_model=replies.FrozenReply,
    responses=schemas.answers(403, 404, 422, headers=schemas.headers("ETag")),
)
async def read_revision(request: Request, id: schemas.Id, label: Label) -> Response:
    """A document as it was frozen, with its answers of that time."""
    await machine_of(request, id, [])
    line, content = await revision(request, id, label)
    body = await compute(request, "pages", lambda: encode(replies.revision_reply(line, decode(content))))
    return JSONBytes(body, headers={"ETag": etag_of(content), "Cache-Control": "no-cache"})


@router.get(
    "/differences",
    dependencies=[admit("reading")],
    operation_id="getDifferences",
    summary="Differences between two states",
    response_model=DocumentDifferences,
    responses=schemas.answers(403, 404, 422),
)
async def read_differences(
    request: Request,
    id: schemas.Id,
    before: Annotated[str, Query(alias="from", max_length=20, description="Label of a revision, now or today.")],
    after: Annotated[str, Query(alias="to", max_length=20, description="Label of a revision, now or today.")],
) -> Response:
    """Differences between two revisions, between a revision and the working copy (`now`), or between a state and its
    recalculation by today's catalogue and engine (`today`); by axis, changed verdicts first."""
    machine = await machine_of(request, id)
    states = await states_of(request, machine, before, after)
    body = await compute(
        request, "batches", lambda: encode(differences(*documents_of(*states), catalogues_of(*states)))
    )
    return JSONBytes(body, headers={"Cache-Control": "no-cache"})


@router.get(
    "/gears",
    dependencies=[admit("reading")],
    operation_id="getGears",
    summary="Gears to order",
    response_model=GearOrder,
    responses=schemas.answers(403, 404, 422),
)
async def read_gears(request: Request, id: schemas.Id) -> Response:
    """Gears of all axes by ordering code, with quantities and masses."""
    machine = await machine_of(request, id)
    body = encode(gears_of((order_axis(axis.number, axis) for axis in machine.items), request.app.state.catalogue))
    return JSONBytes(body, headers={"Cache-Control": "no-cache"})


@router.get(
    "/kinds",
    dependencies=[admit("reading")],
    operation_id="getKinds",
    summary="Fewest kinds of gears",
    response_model=MachineKinds,
    responses=schemas.answers(403, 404, 422),
)
async def read_kinds(
    request: Request,
    id: schemas.Id,
    most: Annotated[int | None, Query(ge=1, le=MOST_AXES, description="Largest number of kinds to compute.")] = None,
) -> Response:
    """Lightest set of gears for each number of kinds, from the machine's own number down to the smallest possible."""
    machine = await machine_of(request, id)
    catalogue = request.app.state.catalogue
    body = await compute(request, "batches", lambda: encode(kinds_in(machine, catalogue, most)))
    return JSONBytes(body, headers={"Cache-Control": "no-cache"})

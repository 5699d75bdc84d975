"""Revisions of documents over REST, and what is read out of the working copy: gears to order and fewest kinds."""

from typing import Annotated

from fastapi import APIRouter, Path, Query
from starlette.requests import Request
from starlette.responses import Response

from hpn.catalogue import Catalogue
from hpn.documents.axis import MOST_AXES
from hpn.documents.differences import DocumentDifferences, differences
from hpn.documents.gears import GearOrder, Placed, gears_of
from hpn.documents.kinds import MachineKinds
from hpn.documents.revision import RevisionBlock, decode
from hpn.store import Machine
from hpn.web.api import machine_replies as replies
from hpn.web.api import schemas
from hpn.web.api.machines import ADDRESS
from hpn.web.api.replies import JSONBytes, RevisionReply, encode
from hpn.web.door.access import admit
from hpn.web.door.bodies import parsed, read_body
from hpn.web.door.conditions import etag_of
from hpn.web.door.pools import compute
from hpn.web.edits import kinds_in
from hpn.web.freezing import freeze, revision
from hpn.web.machines import found, made_before, once_of
from hpn.web.states import catalogues_of, documents_of, states_of

Label = Annotated[str, Path(max_length=20, description="Label of the revision, in any case.")]

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
    """Freezes the working copy under a label: own, inherited and resolved values and answers. It never changes."""
    once = once_of(request, body := await read_body(request))
    block = parsed(RevisionBlock, body)
    if once is not None and (label := await made_before(request, once)) is not None:
        return await _kept_revision(request, id, label)
    label = await freeze(request, id, block, once)
    return await _kept_revision(request, id, label)


async def _kept_revision(request: Request, id: str, label: str) -> Response:
    line, content = await revision(request, id, label)
    headers = {"Location": f"{ADDRESS}/{id}/revisions/{line.label}", "ETag": etag_of(content)}
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
    await found(request, id, [])
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
    """A document as it was frozen, its answers of then."""
    await found(request, id, [])
    line, content = await revision(request, id, label)
    body = await compute(request, "pages", lambda: encode(replies.frozen(line, decode(content))))
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
    """Differences between two revisions, a revision and the working copy (`now`), or a state and what today's
    catalogue and engine say to it (`today`); by axis, those with another verdict first.
    """
    machine = await found(request, id)
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
    """Gears of all axes by their ordering codes, with quantities and masses."""
    machine = await found(request, id)
    axes = (Placed(axis.number, axis.quantity, axis.ordering_code, axis.answer["selected"]) for axis in machine.items)
    body = encode(gears_of(axes, request.app.state.catalogue))
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
    most: Annotated[
        int | None, Query(ge=1, le=MOST_AXES, description="Largest number of kinds that is asked for.")
    ] = None,
) -> Response:
    """Sets of least weight for each number of kinds, from the machine's own down to the least."""
    machine = await found(request, id)
    body = await compute(request, "batches", _kinds, machine, request.app.state.catalogue, most)
    return JSONBytes(body, headers={"Cache-Control": "no-cache"})


def _kinds(machine: Machine, catalogue: Catalogue, most: int | None) -> bytes:
    return encode(kinds_in(machine, catalogue, most))

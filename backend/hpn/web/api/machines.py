"""Machines over REST: create, list, read, change, delete."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from datetime import datetime
from typing import Annotated, Any

import msgspec
from fastapi import APIRouter, Query
from pydantic import Field, ValidationError
from starlette.requests import Request
from starlette.responses import Response

from hpn import ENGINE_VERSION
from hpn.application import InputError
from hpn.catalogue import Catalogue
from hpn.documents.axis import MOST_AXES, MOST_BYTES, MOST_PHASES
from hpn.documents.common import Common
from hpn.documents.document import Document, TitleBlock
from hpn.store import Change, LineFilter, Machine, MachineDraft, RevisionDraft, Store
from hpn.store.records import DocumentKind
from hpn.web.api import machine_replies as replies
from hpn.web.api import schemas
from hpn.web.api.field_names import FieldNames, field_names
from hpn.web.api.lists import KindQuery, linked, part_of
from hpn.web.api.machine_tables import TABLES, draft_of_table
from hpn.web.api.replies import JSONBytes, SavedReply, encode
from hpn.web.columns import common_of, drafts_of
from hpn.web.door.access import admit
from hpn.web.door.bodies import JSON, MERGE_PATCH, content_type_of, parsed, read_body
from hpn.web.door.conditions import REPLAYED, require_done
from hpn.web.door.observation import note
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.machines import (
    answers_under,
    apply,
    editable,
    guarded,
    machine_of,
    no_document,
    once_of,
    patched,
    require_document,
    tag_of,
)
from hpn.web.todays import versions_of

ADDRESS = "/api/v1/machines"
MOST_ANSWERS, MOST_ANSWER = 90, 300
"""Maximum answers to the questions about a table, and characters of an answer."""

TEXTS = 12
"""Allowance for JSON of a machine beyond that of its phases, per axis; a reply of `GET` repeats each value three
times."""

KINDS: Mapping[str, DocumentKind | None] = {"machine": "machine", "selection": "selection", "all": None}

router = APIRouter(prefix=ADDRESS, tags=["Machines"])


def require_machine(text: bytes) -> None:
    """Raise Problem 422 for JSON with more objects, names or lists than any machine has, before it is parsed."""
    objects, names = 3 * MOST_PHASES + TEXTS * MOST_AXES, 30 * MOST_PHASES + 10 * TEXTS * MOST_AXES
    if text.count(b"{") > objects or text.count(b":") > names or text.count(b"[") > objects:
        detail = f"has more in it than a machine with {MOST_AXES} axes and {MOST_PHASES} phases"
        raise Problem(422, detail, [((), detail)])


class MachinePatch(TitleBlock):
    """Changes of a machine: a merge patch of title block and common values, and a new order of its axes."""

    common: dict[str, Any] | None = Field(None, description="Merge patch of the common values; null removes a value.")
    order: Annotated[tuple[int, ...], Field(max_length=MOST_AXES)] | None = Field(
        None, description="Numbers of all axes in their new order."
    )


@router.post(
    "",
    dependencies=[admit("writing")],
    operation_id="saveMachine",
    summary="Save a machine",
    status_code=201,
    openapi_extra=schemas.with_tables(schemas.request_body(Document), TABLES)
    | {"parameters": [schemas.header("Idempotency-Key", "Makes a retry safe: see POST /api/v1/selections.")]},
    response_model=SavedReply,
    responses=schemas.answers(
        *(400, 408, 410, 413, 415, 422, 501),
        status=201,
        headers=schemas.headers("Location", "ETag", REPLAYED),
        links=schemas.FROM_SAVED_MACHINE,
    ),
)
async def save_machine(
    request: Request,
    answer: Annotated[
        list[Annotated[str, Query(max_length=MOST_ANSWER)]],
        Query(
            description="Answer to a question about a table, as `column:meaning`: the heading or number of the "
            "column, then the symbol or name of an input, a unit, or skip, such as `Moment:T`, `3:Nm`, `Remark:skip`. "
            "Or `question:answer`, such as `decimal:,`.",
            max_length=MOST_ANSWERS,
        ),
    ] = [],  # noqa: B006
) -> Response:
    """Saves a machine with its axes and the answer of each axis; the machine is durable once the reply is 201.

    A table of axes is read as on the page /machines: nothing ambiguous is guessed. Each open question is an error of a
    422; repeat the request with one `answer` for each.
    """
    once = once_of(request, body := await read_body(request, JSON, *TABLES, maximum_bytes=MOST_BYTES))
    if content_type_of(request) == JSON:
        key, catalogue = request.state.api_key, request.app.state.catalogue
        draft = await compute(
            request, "batches", lambda: draft_of(parsed(Document, body, require_machine), catalogue, key)
        )
    else:
        draft = await draft_of_table(request, body, answer)
    id: str = await guarded(request.app.state.store.add_machine(draft, once))
    note(request, machine=id)
    headers = {"Location": f"{ADDRESS}/{id}", "ETag": tag_of(await machine_of(request, id, []))}
    if id != draft.id:
        headers[REPLAYED] = "true"
    return JSONBytes(encode(SavedReply(id, f"/machines/{id}")), 201, headers)


def draft_of(
    document: Document,
    catalogue: Catalogue,
    owner: str | None,
    revisions: Sequence[tuple[datetime, RevisionDraft]] = (),
) -> MachineDraft:
    """Draft of a machine with its answers, and with revisions from elsewhere."""
    common = document.common.as_json
    return MachineDraft(
        axes=drafts_of(document.axes, common, catalogue),
        engine_version=ENGINE_VERSION,
        catalogue_version=catalogue.version,
        title=document.title,
        reference=document.reference,
        author=document.author,
        note=document.note,
        common=msgspec.json.encode(common).decode(),
        owner=owner,
        revisions=revisions,
    )


Fields = Annotated[
    str | None,
    Query(
        max_length=1000,
        description="Names of the fields to return, separated by commas; fields of an axis as `axes.name`.",
    ),
]


@router.get(
    "",
    dependencies=[admit("listing")],
    operation_id="listMachines",
    summary="List machines",
    response_model=replies.MachineListReply,
    responses=schemas.answers(422, headers=schemas.headers("Link")),
)
async def list_machines(request: Request, query: Annotated[KindQuery, Query()]) -> Response:
    """Saved machines, newest first; the Link header gives the next page. `deleted` lists the ids of deleted documents.

    `today` counts and lists the axes with another gear or verdict by today's engine and catalogue. It is computed in
    the background; `pending` is the number of documents that still lack it.
    """
    store: Store = request.app.state.store

    async def read(filter: LineFilter, cursor: str | None, limit: int) -> tuple[list[Any], str | None]:
        return await store.machines(cursor, limit, filter)

    part = await part_of(request, query, KINDS[query.kind], read)
    key = versions_of(request.app.state).key
    listed = replies.MachineListReply([replies.line_reply(each, key) for each in part.lines], *part[1:])
    response = JSONBytes(encode(listed), headers={"Cache-Control": "no-cache"})
    return linked(response, request, ADDRESS, part)


@router.get(
    "/{id}",
    dependencies=[admit("reading")],
    operation_id="getMachine",
    summary="Read a machine",
    response_model=replies.MachineReply,
    responses=schemas.answers(403, 404, 422, headers=schemas.headers("ETag"), links=schemas.FROM_MACHINE),
)
async def read_machine(
    request: Request,
    id: schemas.Id,
    fields: Fields = None,
) -> Response:
    """The machine with its working copy. Its ETag covers title block, common values, order and set of axes."""
    return await _reply(request, id, await _names_in(request, id, fields))


async def _reply(request: Request, id: str, names: FieldNames | None) -> Response:
    """A machine, or some fields of it; where these are none of its axes, no axis is read."""
    machine = await machine_of(request, id, None if names is None or names.of_each else [])
    body = await compute(
        request,
        "pages",
        lambda: encode(replies.machine(machine) if names is None else replies.parts(machine, *names)),
    )
    return JSONBytes(body, headers={"ETag": tag_of(machine), "Cache-Control": "no-cache"})


async def _names_in(request: Request, id: str, fields: str | None) -> FieldNames | None:
    """Requested fields of a machine, None for all; Problem 404 for an unknown machine, 422 for an unknown name."""
    if fields is None:
        return None
    try:
        return field_names(fields, "a machine", replies.MachineReply.__struct_fields__, "axes", replies.PARTS)
    except Problem:
        await machine_of(request, id, [])
        raise


@router.patch(
    "/{id}",
    dependencies=[admit("deleting")],
    operation_id="changeMachine",
    summary="Change title block, common values or order",
    openapi_extra=schemas.request_body(MachinePatch, JSON, MERGE_PATCH)
    | {"parameters": [schemas.header("If-Match", "Tag of the version to change.")]},
    response_model=replies.MachineReply,
    responses=schemas.answers(*(400, 403, 404, 408, 412, 413, 415, 422), headers=schemas.headers("ETag")),
)
async def change_machine(request: Request, id: schemas.Id, fields: Fields = None) -> Response:
    """Merge patch (RFC 7396) of title block and common values; `order` lists the numbers of all axes.

    If common values change, every axis is calculated again; an axis that can no longer be calculated becomes open and
    does not block the change. The reply is the machine, or the requested fields.
    """
    names = await _names_in(request, id, fields)
    body = await read_body(request, JSON, MERGE_PATCH, maximum_bytes=MOST_BYTES)
    patch = await compute(request, "pages", parsed, MachinePatch, body, require_machine)
    catalogue: Catalogue = request.app.state.catalogue
    by = request.state.api_key

    def make(machine: Machine) -> Change:
        require_document(request, machine)
        return _change(machine, patch, catalogue, by)

    needs_axes = "common" in patch.model_fields_set
    await apply(request, id, make, None if needs_axes else [])
    return await _reply(request, id, names)


def _change(machine: Machine, patch: MachinePatch, catalogue: Catalogue, by: str | None) -> Change:
    fields = patch.model_fields_set
    values: dict[str, Any] = {n: getattr(patch, n) for n in ("title", "reference", "author", "note") if n in fields}
    change = Change(machine.version, by, values, _order(machine, patch.order) if patch.order is not None else None)
    if "common" not in fields:
        return change
    try:
        common = Common.model_validate(patched(common_of(machine), patch.common) or {}).as_json
    except (ValidationError, InputError) as error:
        raise Problem.below(error, "common") from None
    values["common"] = msgspec.json.encode(common).decode()
    return replace(change, answered=answers_under(machine, common, catalogue))


def _order(machine: Machine, order: tuple[int, ...]) -> list[int]:
    if sorted(order) != sorted(machine.order):
        detail = "must name each axis of the machine once"
        raise Problem(422, f"order {detail}", [(("order",), detail)])
    return list(order)


@router.delete(
    "/{id}",
    dependencies=[admit("deleting")],
    operation_id="deleteMachine",
    summary="Delete a machine",
    status_code=204,
    responses=schemas.DELETED | schemas.problems(403, 404, 412, 422),
    openapi_extra={"parameters": [schemas.header("If-Match", "Tag of the version to delete.")]},
)
async def delete_machine(request: Request, id: schemas.Id) -> Response:
    """Deletes a machine and its revisions permanently. A retry of saving it is then answered with 410."""
    machine = await editable(request, id, [])
    require_document(request, machine)
    version = None if request.headers.get("if-match", "*").strip() == "*" else machine.version
    require_done(await request.app.state.store.delete(id, version, None), version, no_document(id))
    note(request, machine=id)
    return Response(status_code=204)

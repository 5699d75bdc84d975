"""Axes of machines over REST: add, read, replace, change one or many, remove, restore."""

from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Path, Query
from pydantic import Field, RootModel, TypeAdapter, ValidationError, WrapValidator
from pydantic_core import PydanticCustomError
from starlette.requests import Request
from starlette.responses import Response

from hpn import ENGINE_VERSION
from hpn.application.faults import NO_FIELD
from hpn.catalogue import Catalogue
from hpn.documents.answers import AxisQuestion, answers
from hpn.documents.axis import MOST_AXES, MOST_BYTES, Axis
from hpn.documents.merge import resolve
from hpn.engine.selection import Selection
from hpn.store import AxisDraft, Change, Machine, MachineDraft, Once, SavedAxis
from hpn.store.writing import order_of
from hpn.web.api import machine_replies as replies
from hpn.web.api import schemas
from hpn.web.api.machines import ADDRESS, require_machine
from hpn.web.api.replies import JSONBytes, encode
from hpn.web.columns import columns_of, common_of, draft_of, drafts_of, resolved
from hpn.web.door.access import admit
from hpn.web.door.bodies import JSON, MERGE_PATCH, parsed, read_body
from hpn.web.door.conditions import REPLAYED, require_match
from hpn.web.door.observation import note
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.edits import FIELDS, Effect, after, axes_by_number, drafted, effect_of, replace_axis
from hpn.web.machines import (
    apply,
    author_of,
    axis_of,
    axis_tag,
    editable,
    guarded,
    machine_of,
    made_before,
    no_axis,
    once_of,
    require_document,
    selection_of,
    tag_of,
)
from hpn.words.fields import Model

Number = Annotated[int, Path(ge=1, le=2**31 - 1, description="Number of the axis.")]

router = APIRouter(prefix=f"{ADDRESS}/{{id}}/axes", tags=["Machines"])


class SentAxes(Model):
    """Several axes."""

    axes: tuple[Axis, ...] = Field(min_length=1, max_length=MOST_AXES, description="Axes to add, in their order.")


class AxisPatch(RootModel[dict[str, Any]]):
    """Merge patch of an axis."""


_Numbers = Annotated[tuple[int, ...], Field(max_length=MOST_AXES)]
_LIST = TypeAdapter[tuple[int, ...]](_Numbers)


def _of_either(value: Any, _: Any) -> tuple[int, ...] | Literal["all"]:
    """Numbers of axes, or all, validated by type, so that an error has its place in the request."""
    if value == "all":
        return "all"
    if not isinstance(value, list):
        raise PydanticCustomError("axis_numbers", 'must be a list of numbers, such as [1, 2], or "all"')
    return _LIST.validate_python(value)


class ManyAxes(Model):
    """A change of several axes at once."""

    numbers: Annotated[_Numbers | Literal["all"], WrapValidator(_of_either)] = Field(
        description="Numbers of the axes, or all.", examples=[[1, 2]]
    )
    patch: dict[str, Any] = Field(
        description="Merge patch of each axis.", examples=[{"application": {"requirements": {"utilisation": 0.9}}}]
    )


def _tagged(machine: Machine, axis: SavedAxis) -> Response:
    """Response with an axis and the tag of its own values."""
    body = encode(replies.axis(axis, common_of(machine)))
    return JSONBytes(body, headers={"ETag": axis_tag(machine, axis), "Cache-Control": "no-cache"})


TAGGED = schemas.headers("ETag")
IF_MATCH = {"parameters": [schemas.header("If-Match", "Tag of the axis to change.")]}
REFUSED = (400, 403, 404, 408, 412, 413, 415, 422)


@router.post(
    "",
    dependencies=[admit("deleting")],
    operation_id="addAxes",
    summary="Add axes",
    status_code=201,
    openapi_extra=schemas.request_body(SentAxes) | schemas.ONCE_OF_STATE,
    response_model=replies.NumbersReply,
    responses=schemas.answers(*(*REFUSED, 410), status=201, headers=schemas.headers("Location", "ETag", REPLAYED)),
)
async def add_axes(request: Request, id: schemas.Id) -> Response:
    """Appends axes under new numbers. An axis with the number of a removed one restores the removed axis as it was.

    A selection keeps its single axis: the request creates a new machine that begins with it; see `Location`.
    """
    body = await read_body(request, maximum_bytes=MOST_BYTES)
    axes = await compute(request, "pages", parsed, SentAxes, body, require_machine)
    once = once_of(request, body)
    if (selection := await machine_of(request, id, kind=None)).kind == "selection":
        return await _as_machine(request, selection, axes, once)
    if once is not None and (before := await made_before(request, once)) is not None:
        return await _added(request, id, order_of(before), {REPLAYED: "true"})
    back = [axis.number for axis in axes.axes if axis.number is not None]
    if len(set(back)) < len(back):
        raise Problem(422, "axes must name each number once", [(("axes",), "must name each number once")])
    gone = [await _removed_axis(request, id, number) for number in back]
    catalogue: Catalogue = request.app.state.catalogue

    def make(machine: Machine) -> Change:
        require_document(request, machine)
        common = common_of(machine)
        new = [axis for axis in axes.axes if axis.number is None]
        questions = [AxisQuestion(resolve(axis.application, common, axis.without), axis.ordering_code) for axis in new]
        questions += [AxisQuestion(resolved(axis, common), axis.ordering_code) for axis in gone]
        answered = answers(questions, catalogue)
        drafts = [draft_of(axis, answer) for axis, answer in zip(new, answered[: len(new)], strict=True)]
        restored = [(axis.number, columns_of(answer)) for axis, answer in zip(gone, answered[len(new) :], strict=True)]
        return Change(machine.version, author_of(request, machine), new=drafts, restored=restored)

    return await _added(request, id, await apply(request, id, make, [], once), {})


async def _added(request: Request, id: str, numbers: Sequence[int], headers: Mapping[str, str]) -> Response:
    tag = tag_of(await editable(request, id, []))
    return JSONBytes(encode(replies.NumbersReply(tuple(numbers))), 201, {"ETag": tag, **headers})


async def _as_machine(request: Request, selection: Machine, axes: SentAxes, once: Once | None) -> Response:
    """Save a new machine that begins with a selection's axis; response with its address."""
    draft = await compute(
        request, "batches", _machine_draft, selection, axes, request.app.state.catalogue, request.state.api_key
    )
    id: str = await guarded(request.app.state.store.add_machine(draft, once))
    note(request, machine=id)
    headers = {"Location": f"{ADDRESS}/{id}", "ETag": tag_of(await machine_of(request, id, []))}
    if id != draft.id:
        headers[REPLAYED] = "true"
    numbers = tuple(range(2, 2 + len(axes.axes)))
    return JSONBytes(encode(replies.NumbersReply(numbers)), 201, headers)


def _machine_draft(selection: Machine, axes: SentAxes, catalogue: Catalogue, owner: str | None) -> MachineDraft:
    same = AxisDraft.__dataclass_fields__
    first = [AxisDraft(**{name: getattr(axis, name) for name in same}) for axis in selection.items]
    return MachineDraft(
        axes=[*first, *drafts_of(axes.axes, common_of(selection), catalogue)],
        engine_version=ENGINE_VERSION,
        catalogue_version=catalogue.version,
        title=selection.title,
        reference=selection.reference,
        author=selection.author,
        note=selection.note,
        common=selection.common,
        owner=owner,
    )


async def _removed_axis(request: Request, id: str, number: int) -> SavedAxis:
    await editable(request, id, [])
    axis: SavedAxis | None = await request.app.state.store.removed_axis(id, number)
    if axis is None:
        detail = f"names {number}, which is no removed axis of this machine"
        raise Problem(422, f"axes {detail}", [(("axes",), detail)])
    return axis


@router.get(
    "/{number}",
    dependencies=[admit("reading")],
    operation_id="getAxis",
    summary="Read an axis",
    response_model=replies.AxisReply,
    responses=schemas.answers(403, 404, 422, headers=TAGGED),
)
async def read_axis(request: Request, id: schemas.Id, number: Number) -> Response:
    """An axis with its own values, its resolved application and its answer. Its ETag covers its own values."""
    return _tagged(*await axis_of(request, id, number))


@router.get(
    "/{number}/selection",
    dependencies=[admit("reading")],
    operation_id="getAxisSelection",
    summary="Selection of an axis",
    response_model=Selection,
    responses=schemas.answers(403, 404, 409, 422),
)
async def read_selection(request: Request, id: schemas.Id, number: Number) -> Response:
    """Reply of POST /api/v1/select for the axis; 409 for an open axis."""
    machine, axis = await axis_of(request, id, number)
    body = await compute(request, "pages", selection_of, machine, axis, request.app.state.catalogue)
    return JSONBytes(body, headers={"Cache-Control": "no-cache"})


@router.put(
    "/{number}",
    dependencies=[admit("deleting")],
    operation_id="putAxis",
    summary="Replace an axis",
    openapi_extra=schemas.request_body(Axis) | IF_MATCH,
    response_model=replies.AxisReply,
    responses=schemas.answers(*REFUSED, headers=TAGGED),
)
async def put_axis(request: Request, id: schemas.Id, number: Number) -> Response:
    """Replaces an axis by the body; `number`, `resolved`, `answer`, `updated` and `updated_by` are ignored."""
    body = await read_body(request)
    new = await compute(request, "pages", parsed, Axis, body)
    whole = {name: getattr(new, name) for name in FIELDS}
    return await _change(request, id, number, lambda axis: whole)


@router.patch(
    "/{number}",
    dependencies=[admit("deleting")],
    operation_id="changeAxis",
    summary="Change an axis",
    openapi_extra=schemas.request_body(AxisPatch, JSON, MERGE_PATCH) | IF_MATCH,
    response_model=replies.AxisReply,
    responses=schemas.answers(*REFUSED, headers=TAGGED),
)
async def change_axis(request: Request, id: schemas.Id, number: Number) -> Response:
    """Merge patch (RFC 7396) of an axis, its own part of the application included."""
    body = await read_body(request, JSON, MERGE_PATCH)
    patch = await compute(request, "pages", _patch_in, body)
    return await _change(request, id, number, lambda axis: after(axis, patch))


def _patch_in(body: bytes) -> dict[str, Any]:
    """Merge patch of an axis; Problem 422 for a name that is not one of its fields."""
    patch = parsed(AxisPatch, body).root
    _require_fields(patch)
    return patch


async def _change(request: Request, id: str, number: int, values: Callable[[SavedAxis], dict[str, Any]]) -> Response:
    """Change the own values of an axis; response with the axis."""

    def require(machine: Machine, axis: SavedAxis) -> None:
        require_match(request, axis_tag(machine, axis))

    await replace_axis(request, id, number, values, require)
    return _tagged(*await axis_of(request, id, number))


@router.delete(
    "/{number}",
    dependencies=[admit("deleting")],
    operation_id="removeAxis",
    summary="Remove an axis",
    status_code=204,
    openapi_extra=IF_MATCH,
    responses=schemas.DELETED | schemas.problems(403, 404, 409, 412, 422),
)
async def remove_axis(request: Request, id: schemas.Id, number: Number) -> Response:
    """Removes an axis. Its number is never given to another axis; a POST with this number restores the axis."""

    def make(machine: Machine) -> Change:
        if not machine.items:
            raise no_axis(number)
        if machine.kind == "selection":
            raise Problem(409, "a selection keeps its one axis; delete the selection")
        (axis,) = machine.items
        require_match(request, axis_tag(machine, axis))
        return Change(machine.version, author_of(request, machine), removed=[(number, axis.version)])

    await apply(request, id, make, [number])
    return Response(status_code=204)


@router.patch(
    "",
    dependencies=[admit("deleting")],
    operation_id="changeAxes",
    summary="Change several axes",
    openapi_extra=schemas.request_body(ManyAxes)
    | {"parameters": [schemas.header("If-Match", "Tag of the machine; required except for a dry run.")]},
    response_model=replies.EffectReply,
    responses=schemas.answers(*REFUSED, 428, headers=TAGGED),
)
async def change_axes(
    request: Request,
    id: schemas.Id,
    dry: Annotated[bool, Query(description="1: returns the effect and saves nothing.")] = False,
) -> Response:
    """Applies one merge patch to many axes and returns the effect; `dry=1` saves nothing."""
    body = await read_body(request, JSON, maximum_bytes=MOST_BYTES)
    changes = await compute(request, "pages", parsed, ManyAxes, body, require_machine)
    _require_fields(changes.patch, "patch")
    if not dry and "if-match" not in request.headers:
        raise Problem(428, "send the machine’s ETag as If-Match")
    catalogue: Catalogue = request.app.state.catalogue
    effects: list[Effect] = []

    def make(machine: Machine) -> Change:
        require_document(request, machine)
        axes = axes_by_number(machine, changes.numbers)
        drafts = drafted([(axis, _after(axis, changes.patch)) for axis in axes], common_of(machine), catalogue)
        changed = [(axis.number, axis.version, draft) for axis, draft in zip(axes, drafts, strict=True)]
        effects.append(effect_of(machine, {number: draft for number, _, draft in changed}, catalogue))
        return Change(machine.version, author_of(request, machine), changed=changed)

    if dry:
        await compute(request, "batches", make, await editable(request, id))
    else:
        await apply(request, id, make)
    tag = tag_of(await editable(request, id, []))
    return JSONBytes(encode(replies.EffectReply(*effects[-1])), headers={"ETag": tag})


def _after(axis: SavedAxis, patch: Mapping[str, Any]) -> dict[str, Any]:
    """Own values of an axis after a patch of several; Problem 422 with the place in the request."""
    try:
        return after(axis, patch)
    except ValidationError as error:
        raise Problem.below(error, "patch") from None


def _require_fields(patch: Mapping[str, Any], *place: str) -> None:
    """Raise Problem 422 for a patch of an unknown field; read-only fields are ignored."""
    for name in patch:
        if name not in {*FIELDS, *Axis.read_only, "number"}:
            raise Problem(422, f"{name!r:.80} is not a field of an axis", [((*place, name), NO_FIELD)])

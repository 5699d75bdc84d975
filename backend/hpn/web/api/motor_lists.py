"""Lists of motors over REST: keep one under a name, list, read, replace, delete; `server` is motors.csv."""

from datetime import datetime
from typing import Annotated

import msgspec
from fastapi import APIRouter
from msgspec import Raw
from pydantic import AfterValidator, Field, WrapValidator
from pydantic_core import PydanticCustomError
from starlette.datastructures import State
from starlette.requests import Request
from starlette.responses import Response

from hpn.application import InputError, MotorEntry
from hpn.application.pairing import Distinct
from hpn.engine.motors import entries_of
from hpn.store import (
    MOST_LISTS,
    ListsSpentError,
    MotorListDraft,
    MotorListLine,
    NameTakenError,
    SavedMotorList,
    Store,
)
from hpn.web.api import schemas
from hpn.web.api.replies import JSONBytes, Moment, encode
from hpn.web.door.access import admit
from hpn.web.door.bodies import parsed, read_body
from hpn.web.door.conditions import conditional, etag_of, require_done, require_match
from hpn.web.door.observation import note
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.words.fields import at_most, in_parts
from hpn.words.reply import Reply
from hpn.words.titles import Title
from hpn.words.wording import N_, Sentence

ADDRESS = "/api/v1/motor-lists"
SERVER = "server"
"""Id of the list that motors.csv is."""

MOST_LISTED = 5000
"""Motors of a list, at most."""

IF_MATCH = {"parameters": [schemas.header("If-Match", "Tag of the state that is to change.")]}

router = APIRouter(prefix=ADDRESS, tags=["Motors"])
"""Its routes are of different groups, which each declares."""


def _name(name: str | None) -> str:
    if not name:
        raise PydanticCustomError("empty", "must not be empty")
    return name


class MotorList(Distinct):
    """A list of motors under a name."""

    name: Annotated[Title, AfterValidator(_name)] = Field(
        description="Name, which its owner gives one list alone.", examples=["Our servo motors"]
    )
    motors: Annotated[
        tuple[MotorEntry, ...],
        Field(min_length=1, max_length=MOST_LISTED),
        WrapValidator(in_parts),
        at_most(MOST_LISTED),
    ] = Field(description="Its motors, each designation once.")


class MotorListSummary(Reply, frozen=True):
    """One line of the lists of motors."""

    id: Annotated[str, Field(description="Id of the list; `server` for motors.csv, which is read-only.")]
    name: Annotated[str, Field(description="Name.")]
    motors: Annotated[int, Field(description="Number of its motors.")]
    created: Annotated[Moment | None, Field(description="When it was kept first; null for `server`.")]
    updated: Annotated[Moment | None, Field(description="When it was changed last; null for `server`.")]


class MotorListsReply(Reply, frozen=True):
    """All lists of motors by their names, `server` first where there is one."""

    lists: Annotated[list[MotorListSummary], Field(description="The lists.")]


class EntryReply(Reply, frozen=True):
    """A motor of a list; null is a figure that is not known."""

    designation: Annotated[str, Field(description="Name of the motor.")]
    maximum_speed_rpm: Annotated[float | None, Field(description="Maximum motor speed.")] = None
    rated_speed_rpm: Annotated[float | None, Field(description="Rated motor speed.")] = None
    rated_torque_Nm: Annotated[float | None, Field(description="Continuous torque up to the rated speed.")] = None
    stall_torque_Nm: Annotated[float | None, Field(description="Continuous torque at standstill, M₀.")] = None
    peak_torque_Nm: Annotated[float | None, Field(description="Peak motor torque.")] = None
    inertia_kgm2: Annotated[float | None, Field(description="Moment of inertia of the motor’s rotor.")] = None
    weight_kg: Annotated[float | None, Field(description="Weight of the motor.")] = None


class MotorListReply(Reply, frozen=True):
    """A list of motors."""

    id: Annotated[str, Field(description="Id of the list.")]
    name: Annotated[str, Field(description="Name.")]
    motors: Annotated[list[EntryReply], Field(description="Its motors, in its order.")]


@router.post(
    "",
    dependencies=[admit("writing")],
    operation_id="saveMotorList",
    summary="Keep a list of motors",
    status_code=201,
    openapi_extra=schemas.request_body(MotorList),
    response_model=MotorListSummary,
    responses=schemas.answers(*(400, 408, 409, 413, 415, 422), status=201, headers=schemas.headers("Location", "ETag")),
)
async def save_list(request: Request) -> Response:
    """Keeps up to 5000 motors under a name, which a key or whoever has none gives one list alone; up to 200 lists."""
    draft = await compute(request, "pages", _draft, await read_body(request))
    store: Store = request.app.state.store
    try:
        id = await store.add_motor_list(draft, request.state.api_key)
    except NameTakenError:
        raise _taken(draft.name) from None
    except ListsSpentError:
        said = Sentence(N_("there are {most} lists of motors, as many as one may keep"), {"most": str(MOST_LISTS)})
        raise Problem(409, said) from None
    note(request, motor_list=id)
    saved = await _found(request, id)
    return JSONBytes(encode(_line(saved)), 201, {"Location": f"{ADDRESS}/{id}", "ETag": _tag(saved)})


@router.get(
    "",
    dependencies=[admit("listing")],
    operation_id="listMotorLists",
    summary="Lists of motors",
    openapi_extra=schemas.IF_NONE_MATCH,
    response_model=MotorListsReply,
    responses=schemas.tagged(422),
)
async def list_lists(request: Request) -> Response:
    """All lists by their names, without their motors; `server` first where the service has a motors.csv."""
    state: State = request.app.state
    own = state.catalogue.motors
    server = [MotorListSummary(SERVER, SERVER, len(own), None, None)] if own else []
    lists = [*server, *(_line(line) for line in await state.store.motor_lists())]
    return conditional(request, encode(MotorListsReply(lists)))


@router.get(
    "/{id}",
    dependencies=[admit("reading")],
    operation_id="getMotorList",
    summary="Read a list of motors",
    openapi_extra=schemas.IF_NONE_MATCH,
    response_model=MotorListReply,
    responses=schemas.tagged(404, 422),
)
async def read_motor_list(request: Request, id: schemas.ListId) -> Response:
    """A list with its motors; null is a figure that is not known."""
    if id == SERVER:
        motors = entries_of(request.app.state.catalogue.motors)
        return conditional(request, _whole(id, SERVER, [motor.model_dump() for motor in motors]))
    saved = await _found(request, id)
    return conditional(request, _whole(id, saved.name, Raw(saved.content)), _tag(saved))


@router.put(
    "/{id}",
    dependencies=[admit("deleting")],
    operation_id="putMotorList",
    summary="Replace a list of motors",
    openapi_extra=schemas.request_body(MotorList) | IF_MATCH,
    response_model=MotorListSummary,
    responses=schemas.answers(*(400, 403, 404, 408, 409, 412, 413, 415, 422), headers=schemas.headers("ETag")),
)
async def replace_motor_list(request: Request, id: schemas.ListId) -> Response:
    """Replaces name and motors. What was taken from the list before keeps its figures."""
    body = await read_body(request)
    version = await _changeable(request, id)
    draft = await compute(request, "pages", _draft, body)
    try:
        replaced = await request.app.state.store.replace_motor_list(id, draft, version)
    except NameTakenError:
        raise _taken(draft.name) from None
    require_done(replaced, version, _not_found(id))
    note(request, motor_list=id)
    saved = await _found(request, id)
    return JSONBytes(encode(_line(saved)), headers={"ETag": _tag(saved), "Cache-Control": "no-cache"})


@router.delete(
    "/{id}",
    dependencies=[admit("deleting")],
    operation_id="deleteMotorList",
    summary="Delete a list of motors",
    status_code=204,
    responses=schemas.DELETED | schemas.problems(403, 404, 412, 422),
    openapi_extra=IF_MATCH,
)
async def delete_motor_list(request: Request, id: schemas.ListId) -> Response:
    """Deletes a list permanently. What was taken from it keeps its figures."""
    version = await _changeable(request, id)
    require_done(await request.app.state.store.delete_motor_list(id, version), version, _not_found(id))
    note(request, motor_list=id)
    return Response(status_code=204)


async def motors_of(request: Request, id: str) -> list[MotorEntry]:
    """Motors of a list, `server` included; InputError at `list` where there is none."""
    state: State = request.app.state
    if id == SERVER:
        if not state.catalogue.motors:
            said = Sentence(N_("there are no motors: list them in motors.csv of a catalogue supplement"))
            raise InputError((("list",), said))
        return entries_of(state.catalogue.motors)
    saved = await state.store.motor_list(id)
    if saved is None:
        raise InputError((("list",), Sentence(N_("there is no such list of motors"))))
    return [MotorEntry.model_construct(**motor) for motor in msgspec.json.decode(saved.content)]


def _draft(body: bytes) -> MotorListDraft:
    sent = parsed(MotorList, body)
    content = msgspec.json.encode([motor.model_dump() for motor in sent.motors])
    return MotorListDraft(sent.name, len(sent.motors), content)


async def _found(request: Request, id: str) -> SavedMotorList:
    saved: SavedMotorList | None = await request.app.state.store.motor_list(id)
    if saved is None:
        raise _not_found(id)
    return saved


async def _changeable(request: Request, id: str) -> int | None:
    """Version that `If-Match` names, None where it names none; Problem 404, 403 and 412."""
    if id == SERVER:
        raise Problem(403, Sentence(N_("the list server is motors.csv of the service, which is read-only")))
    saved, state = await _found(request, id), request.app.state
    if state.gate.has_keys:
        state.gate.require_owner(request, saved.owner or None)
    if request.headers.get("if-match", "*").strip() == "*":
        return None
    require_match(request, _tag(saved))
    return saved.version


def _taken(name: str) -> Problem:
    return Problem(409, Sentence(N_("there is a list of motors named {name} already"), {"name": repr(name)}))


def _not_found(id: str) -> Problem:
    return Problem(404, f"there is no list of motors {id[:60]!r}; it may have been deleted")


def _tag(line: MotorListLine) -> str:
    return etag_of(f"{line.id} {line.version}".encode())


def _line(line: MotorListLine) -> MotorListSummary:
    return MotorListSummary(line.id, line.name, line.motors, _moment(line.created), _moment(line.updated))


def _moment(time: datetime) -> str:
    return time.isoformat(timespec="microseconds").replace("+00:00", "Z")


def _whole(id: str, name: str, motors: object) -> bytes:
    return encode({"id": id, "name": name, "motors": motors})

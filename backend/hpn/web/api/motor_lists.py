"""Lists of motors over REST: save under a name, list, read, replace, delete; `server` is motors.csv."""

from collections.abc import Sequence
from functools import partial
from typing import Annotated

from fastapi import APIRouter, Query
from msgspec import Raw
from pydantic import Field, ValidationError
from starlette.datastructures import State
from starlette.requests import Request
from starlette.responses import Response

from hpn.application.faults import Fault
from hpn.engine.motors import entries_of
from hpn.store import MotorListDraft, MotorListLine
from hpn.tables.reading import Reading
from hpn.tables.table import Table
from hpn.web import motor_lists
from hpn.web.api import schemas
from hpn.web.api.fleet import MEDIA_TYPES
from hpn.web.api.machine_replies import moment
from hpn.web.api.machine_tables import ANSWER, WORKBOOK, require_whole
from hpn.web.api.machines import MOST_ANSWER, MOST_ANSWERS
from hpn.web.api.replies import JSONBytes, Moment, encode
from hpn.web.door.access import admit
from hpn.web.door.bodies import JSON, content_type_of, parsed, read_body
from hpn.web.door.conditions import conditional
from hpn.web.door.pools import compute, compute_beside
from hpn.web.door.problems import Problem
from hpn.web.motor_lists import SERVER, MotorList, draft_of, tag_of
from hpn.web.motor_tables import left_out, motors_in, read_answered
from hpn.words.reply import Reply
from hpn.words.wording import N_, Sentence

ADDRESS = "/api/v1/motor-lists"

TABLES = (MEDIA_TYPES[".csv"], WORKBOOK)
NO_TABLE = N_("the content is no table of motors: send CSV or XLSX")

IF_MATCH = {"parameters": [schemas.header("If-Match", "Tag of the state to change.")]}

router = APIRouter(prefix=ADDRESS, tags=["Motors"])
"""Router without a common group: each route declares its own."""


class MotorListSummary(Reply, frozen=True):
    """One line of the lists of motors."""

    id: Annotated[str, Field(description="Id of the list; `server` for motors.csv, which is read-only.")]
    name: Annotated[str, Field(description="Name.")]
    motors: Annotated[int, Field(description="Number of its motors.")]
    created: Annotated[Moment | None, Field(description="Moment of creation; null for `server`.")]
    updated: Annotated[Moment | None, Field(description="Moment of the last change; null for `server`.")]


class MotorListsReply(Reply, frozen=True):
    """All lists of motors in the order of their names; `server` first, if the service has it."""

    lists: Annotated[list[MotorListSummary], Field(description="The lists.")]


class PointReply(Reply, frozen=True):
    """A point of a motor's torque over speed."""

    speed_rpm: Annotated[float, Field(description="Motor speed.")]
    continuous_Nm: Annotated[float, Field(description="Continuous torque at this speed.")]
    peak_Nm: Annotated[float, Field(description="Peak torque at this speed.")]


class EntryReply(Reply, frozen=True):
    """A motor of a list; an unknown figure is null."""

    designation: Annotated[str, Field(description="Name of the motor.")]
    maximum_speed_rpm: Annotated[float | None, Field(description="Maximum motor speed.")] = None
    rated_speed_rpm: Annotated[float | None, Field(description="Rated motor speed.")] = None
    rated_torque_Nm: Annotated[float | None, Field(description="Continuous torque up to the rated speed.")] = None
    stall_torque_Nm: Annotated[float | None, Field(description="Continuous torque at standstill, M₀.")] = None
    peak_torque_Nm: Annotated[float | None, Field(description="Peak motor torque.")] = None
    inertia_kgm2: Annotated[float | None, Field(description="Moment of inertia of the motor’s rotor.")] = None
    weight_kg: Annotated[float | None, Field(description="Weight of the motor.")] = None
    curve: Annotated[list[PointReply] | None, Field(description="Torque over speed, by rising speed from 0.")] = None


class MotorListReply(Reply, frozen=True):
    """A list of motors."""

    id: Annotated[str, Field(description="Id of the list.")]
    name: Annotated[str, Field(description="Name.")]
    motors: Annotated[list[EntryReply], Field(description="Motors in the order of the list.")]


@router.post(
    "",
    dependencies=[admit("writing")],
    operation_id="saveMotorList",
    summary="Save a list of motors",
    status_code=201,
    openapi_extra=schemas.with_tables(schemas.request_body(MotorList), TABLES, schemas.OF_MOTORS),
    response_model=MotorListSummary,
    responses=schemas.answers(*(400, 408, 409, 413, 415, 422), status=201, headers=schemas.headers("Location", "ETag")),
)
async def save_list(
    request: Request,
    name: Annotated[str | None, Query(description="Name of the list; only for a table.", max_length=200)] = None,
    answer: Annotated[
        list[Annotated[str, Query(max_length=MOST_ANSWER)]],
        Query(
            description="Answer to a question about a table, as `column:meaning`: the heading or number of the "
            "column, then the name of a figure, a unit, or skip, such as `M0:stall_torque_Nm`, `3:Nm`, `k_T:skip`. Or "
            "`question:answer`, such as `zeros:unknown`.",
            max_length=MOST_ANSWERS,
        ),
    ] = [],  # noqa: B006
) -> Response:
    """Stores up to 5000 motors under a name. Each API key has up to 200 lists with unique names; callers without a key
    share theirs.

    A table of motors is read as on the page /motor-lists: nothing ambiguous is guessed. Each open question is an error
    of a 422; repeat the request with one `answer` for each.
    """
    body = await read_body(request, JSON, *TABLES)
    if content_type_of(request) == JSON:
        draft = await compute(request, "pages", _draft, body)
    else:
        reading, faults = await compute_beside(request, "files", partial(read_answered, body, answer))
        draft = await compute(request, "pages", _draft_of_table, reading, faults, name)
    saved = await motor_lists.keep(request, draft)
    return JSONBytes(encode(_line(saved)), 201, {"Location": f"{ADDRESS}/{saved.id}", "ETag": tag_of(saved)})


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
    """All lists in the order of their names, without their motors; `server` first, if the service has a motors.csv."""
    state: State = request.app.state
    own = state.catalogue.motors
    server = [MotorListSummary(SERVER, SERVER, len(own), None, None)] if own else []
    lists = [*server, *(_line(line) for line in await motor_lists.lines_of(request))]
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
    """A list with its motors; an unknown figure is null."""
    if id == SERVER:
        motors = entries_of(request.app.state.catalogue.motors)
        return conditional(request, _whole(id, SERVER, [motor.model_dump() for motor in motors]))
    saved = await motor_lists.list_of(request, id)
    return conditional(request, _whole(id, saved.name, Raw(saved.content)), tag_of(saved))


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
    """Replaces name and motors of a list. Applications keep figures already taken from it."""
    body = await read_body(request)
    version = motor_lists.version_in(request, await motor_lists.changeable(request, id))
    draft = await compute(request, "pages", _draft, body)
    saved = await motor_lists.replace(request, id, draft, version)
    return JSONBytes(encode(_line(saved)), headers={"ETag": tag_of(saved), "Cache-Control": "no-cache"})


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
    """Deletes a list permanently. Applications keep figures already taken from it."""
    version = motor_lists.version_in(request, await motor_lists.changeable(request, id))
    await motor_lists.remove(request, id, version)
    return Response(status_code=204)


def _draft(body: bytes) -> MotorListDraft:
    return draft_of(parsed(MotorList, body))


def _draft_of_table(reading: Reading, faults: Sequence[Sentence], name: str | None) -> MotorListDraft:
    """Draft of a list from a table; Problem 422 for invalid answers, open questions, and invalid motors."""
    if faults:
        raise Problem(422, faults, [Fault(ANSWER, fault.text, "answer") for fault in faults])
    table = reading.table or Table(problem=Sentence(NO_TABLE))
    require_whole(table)
    motors, notes = motors_in(table)
    if refused := left_out(table, notes):
        raise Problem(422, refused)
    try:
        return draft_of(MotorList.model_validate({"name": name, "motors": motors}))
    except ValidationError as error:
        raise Problem.of(error) from None


def _line(line: MotorListLine) -> MotorListSummary:
    return MotorListSummary(line.id, line.name, line.motors, moment(line.created), moment(line.updated))


def _whole(id: str, name: str, motors: object) -> bytes:
    return encode({"id": id, "name": name, "motors": motors})

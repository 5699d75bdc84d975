"""Lists of motors over REST: keep one under a name, list, read, replace, delete; `server` is motors.csv."""

from collections.abc import Sequence
from datetime import datetime
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
from hpn.tables.motors import NO_FIGURE, NO_NAME
from hpn.tables.reading import Reading
from hpn.tables.table import Table
from hpn.web import motor_lists
from hpn.web.api import schemas
from hpn.web.api.fleet import MEDIA_TYPES
from hpn.web.api.machine_tables import ANSWER, WORKBOOK, require_whole
from hpn.web.api.machines import MOST_ANSWER, MOST_ANSWERS
from hpn.web.api.replies import JSONBytes, Moment, encode
from hpn.web.door.access import admit
from hpn.web.door.bodies import JSON, content_type_of, parsed, read_body
from hpn.web.door.conditions import conditional
from hpn.web.door.pools import compute, compute_beside
from hpn.web.door.problems import Problem
from hpn.web.motor_lists import SERVER, MotorList, draft_of, tag_of
from hpn.web.motor_tables import motors_in, read_answered
from hpn.words.reply import Reply
from hpn.words.wording import N_, Sentence

ADDRESS = "/api/v1/motor-lists"

TABLES = (MEDIA_TYPES[".csv"], WORKBOOK)
NO_TABLE = N_("the content is no table of motors: send CSV or XLSX")

IF_MATCH = {"parameters": [schemas.header("If-Match", "Tag of the state that is to change.")]}

router = APIRouter(prefix=ADDRESS, tags=["Motors"])
"""Its routes are of different groups, which each declares."""


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
    openapi_extra=schemas.with_tables(schemas.request_body(MotorList), TABLES, schemas.OF_MOTORS),
    response_model=MotorListSummary,
    responses=schemas.answers(*(400, 408, 409, 413, 415, 422), status=201, headers=schemas.headers("Location", "ETag")),
)
async def save_list(
    request: Request,
    name: Annotated[str | None, Query(description="Of a table: the name of the list.", max_length=200)] = None,
    answer: Annotated[
        list[Annotated[str, Query(max_length=MOST_ANSWER)]],
        Query(
            description="Of a table: a column, by heading or number, and what it is: a figure by its name, a unit, or "
            "skip, such as `M0:stall_torque_Nm`, `3:Nm`, `k_T:skip`; or a question and its answer, such as "
            "`zeros:unknown`.",
            max_length=MOST_ANSWERS,
        ),
    ] = [],  # noqa: B006
) -> Response:
    """Keeps up to 5000 motors under a name, which a key or whoever has none gives one list alone; up to 200 lists.

    A table of motors is read as on the page /motor-lists: what it leaves open is never guessed, but listed as the
    errors of a 422, to be answered by repeated `answer`.
    """
    body = await read_body(request, JSON, *TABLES)
    if content_type_of(request) == JSON:
        draft = await compute(request, "pages", _draft, body)
    else:
        reading, faults = await compute_beside(request, "files", partial(read_answered, body, answer))
        draft = await compute(request, "pages", _draft_of_table, reading, faults, name)
    saved = await motor_lists.kept(request, draft)
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
    """All lists by their names, without their motors; `server` first where the service has a motors.csv."""
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
    """A list with its motors; null is a figure that is not known."""
    if id == SERVER:
        motors = entries_of(request.app.state.catalogue.motors)
        return conditional(request, _whole(id, SERVER, [motor.model_dump() for motor in motors]))
    saved = await motor_lists.found(request, id)
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
    """Replaces name and motors. What was taken from the list before keeps its figures."""
    body = await read_body(request)
    version = motor_lists.version_in(request, await motor_lists.changeable(request, id))
    draft = await compute(request, "pages", _draft, body)
    saved = await motor_lists.replaced(request, id, draft, version)
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
    """Deletes a list permanently. What was taken from it keeps its figures."""
    version = motor_lists.version_in(request, await motor_lists.changeable(request, id))
    await motor_lists.removed(request, id, version)
    return Response(status_code=204)


def _draft(body: bytes) -> MotorListDraft:
    return draft_of(parsed(MotorList, body))


def _draft_of_table(reading: Reading, faults: Sequence[Sentence], name: str | None) -> MotorListDraft:
    """A list out of a table; Problem 422 for answers that are none, open questions, and motors that can't be."""
    if faults:
        raise Problem(422, faults, [Fault(ANSWER, fault.text, "answer") for fault in faults])
    table = reading.table or Table(problem=Sentence(NO_TABLE))
    require_whole(table)
    motors, refused = motors_in(table)
    refused += [note for note in table.notes if note.template in (NO_FIGURE, NO_NAME)]
    if refused:
        raise Problem(422, refused)
    try:
        return draft_of(MotorList.model_validate({"name": name, "motors": motors}))
    except ValidationError as error:
        raise Problem.of(error) from None


def _line(line: MotorListLine) -> MotorListSummary:
    return MotorListSummary(line.id, line.name, line.motors, _moment(line.created), _moment(line.updated))


def _moment(time: datetime) -> str:
    return time.isoformat(timespec="microseconds").replace("+00:00", "Z")


def _whole(id: str, name: str, motors: object) -> bytes:
    return encode({"id": id, "name": name, "motors": motors})

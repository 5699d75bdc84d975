"""Stored lists of motors: reading, storing, replacing and deleting, for REST and pages; `server` is motors.csv."""

from typing import Annotated, Any

import msgspec
from pydantic import AfterValidator, Field, WrapValidator
from pydantic_core import PydanticCustomError
from starlette.datastructures import State
from starlette.requests import Request

from hpn.application import CurvePoint, InputError, MotorEntry
from hpn.application.pairing import Distinct
from hpn.engine.motors import entries_of
from hpn.store import MOST_LISTS, ListsSpentError, MotorListDraft, MotorListLine, NameTakenError, SavedMotorList, Store
from hpn.web.door.conditions import etag_of, require_done, require_match
from hpn.web.door.observation import note
from hpn.web.door.problems import Problem
from hpn.words.fields import at_most, in_parts
from hpn.words.titles import Title
from hpn.words.wording import N_, Sentence

SERVER = "server"
"""Id of the list in motors.csv."""

MOST_LISTED = 5000
"""Maximum number of motors in a list."""


def _name(name: str | None) -> str:
    if not name:
        raise PydanticCustomError("empty", "must not be empty")
    return name


class MotorList(Distinct):
    """A list of motors under a name."""

    name: Annotated[Title, AfterValidator(_name)] = Field(
        description="Name, unique among the lists of its owner.", examples=["Our servo motors"]
    )
    motors: Annotated[
        tuple[MotorEntry, ...],
        Field(min_length=1, max_length=MOST_LISTED),
        WrapValidator(in_parts),
        at_most(MOST_LISTED),
    ] = Field(description="Motors of the list, each designation once.")


def draft_of(list_: MotorList) -> MotorListDraft:
    """Draft of a list for the store."""
    content = msgspec.json.encode([motor.model_dump() for motor in list_.motors])
    return MotorListDraft(list_.name, len(list_.motors), content)


async def lines_of(request: Request) -> list[MotorListLine]:
    """All stored lists in the order of their names; none if the request may not list them."""
    may_list = request.app.state.gate.may(request, "listing")
    return list(await request.app.state.store.motor_lists()) if may_list else []


async def keep(request: Request, draft: MotorListDraft) -> SavedMotorList:
    """Store a new list; Problem 409 if its owner has a list of that name, or MOST_LISTS lists, already."""
    store: Store = request.app.state.store
    try:
        id = await store.add_motor_list(draft, request.state.api_key)
    except NameTakenError:
        raise _name_taken(draft.name) from None
    except ListsSpentError:
        reason = Sentence(N_("there are {most} lists of motors, as many as one may keep"), {"most": str(MOST_LISTS)})
        raise Problem(409, reason) from None
    note(request, motor_list=id)
    return await list_of(request, id)


async def replace(
    request: Request, id: str, draft: MotorListDraft, version: int | None, overtaken: Problem | None = None
) -> SavedMotorList:
    """Replace name and motors of a list; Problem 404, 409, or `overtaken`, by default 412, for another version."""
    try:
        is_replaced = await request.app.state.store.replace_motor_list(id, draft, version)
    except NameTakenError:
        raise _name_taken(draft.name) from None
    require_done(is_replaced, version, not_found(id), overtaken)
    note(request, motor_list=id)
    return await list_of(request, id)


async def remove(request: Request, id: str, version: int | None, overtaken: Problem | None = None) -> None:
    """Delete a list; Problem 404, or `overtaken`, by default 412, for another version."""
    is_removed = await request.app.state.store.delete_motor_list(id, version)
    require_done(is_removed, version, not_found(id), overtaken)
    note(request, motor_list=id)


async def list_of(request: Request, id: str) -> SavedMotorList:
    """Stored list; Problem 404 for an unknown id."""
    saved: SavedMotorList | None = await request.app.state.store.motor_list(id)
    if saved is None:
        raise not_found(id)
    return saved


async def changeable(request: Request, id: str) -> SavedMotorList:
    """List that the caller may change; Problem 404 or 403."""
    if id == SERVER:
        raise Problem(403, Sentence(N_("the list server is motors.csv of the service, which is read-only")))
    saved = await list_of(request, id)
    request.app.state.gate.require_owner(request, saved.owner)
    return saved


def version_in(request: Request, saved: SavedMotorList) -> int | None:
    """Version of the list if `If-Match` names its state, None if it accepts any; Problem 412 for another state."""
    if request.headers.get("if-match", "*").strip() == "*":
        return None
    require_match(request, tag_of(saved))
    return saved.version


async def motors_of(request: Request, id: str) -> list[MotorEntry]:
    """Motors of a list, which may be `server`; InputError at `list` for an unknown list, Problem 401 without a key."""
    state: State = request.app.state
    if id == SERVER:
        if not state.catalogue.motors:
            reason = Sentence(N_("there are no motors: list them in motors.csv of a catalogue supplement"))
            raise InputError((("list",), reason))
        return entries_of(state.catalogue.motors)
    state.gate.require(request, "reading")
    saved = await state.store.motor_list(id)
    if saved is None:
        raise InputError((("list",), Sentence(N_("there is no such list of motors"))))
    return entries_in(saved)


def entries_in(saved: SavedMotorList) -> list[MotorEntry]:
    """Motors of a stored list; they were checked when it was stored."""
    return [_entry_of(motor) for motor in msgspec.json.decode(saved.content)]


def _entry_of(motor: dict[str, Any]) -> MotorEntry:
    points = motor.pop("curve", None)
    curve = tuple(CurvePoint.model_construct(**point) for point in points) if points else None
    return MotorEntry.model_construct(**motor, curve=curve)


def tag_of(line: MotorListLine) -> str:
    """Entity tag of a list."""
    return etag_of(f"{line.id} {line.version}".encode())


def _name_taken(name: str) -> Problem:
    return Problem(409, Sentence(N_("there is a list of motors named {name} already"), {"name": repr(name)}))


def not_found(id: str) -> Problem:
    """Problem 404 for an unknown list."""
    return Problem(404, f"there is no list of motors {id[:60]!r}; it may have been deleted")

"""Lists of motors that are kept: read, kept, replaced and deleted, for REST and the pages; `server` is motors.csv."""

from collections.abc import Sequence
from typing import Annotated

import msgspec
from pydantic import AfterValidator, Field, WrapValidator
from pydantic_core import PydanticCustomError
from starlette.datastructures import State
from starlette.requests import Request

from hpn.application import InputError, MotorEntry
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
"""Id of the list that motors.csv is."""

MOST_LISTED = 5000
"""Motors of a list, at most."""


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


def draft_of(sent: MotorList) -> MotorListDraft:
    """A list as it is kept."""
    content = msgspec.json.encode([motor.model_dump() for motor in sent.motors])
    return MotorListDraft(sent.name, len(sent.motors), content)


async def lines_of(request: Request) -> list[MotorListLine]:
    """All kept lists by their names."""
    return list(await request.app.state.store.motor_lists())


async def kept(request: Request, draft: MotorListDraft) -> SavedMotorList:
    """A new list, now kept; Problem 409 where its owner has one of that name, or as many as one may have."""
    store: Store = request.app.state.store
    try:
        id = await store.add_motor_list(draft, request.state.api_key)
    except NameTakenError:
        raise _taken(draft.name) from None
    except ListsSpentError:
        said = Sentence(N_("there are {most} lists of motors, as many as one may keep"), {"most": str(MOST_LISTS)})
        raise Problem(409, said) from None
    note(request, motor_list=id)
    return await found(request, id)


async def replaced(request: Request, id: str, draft: MotorListDraft, version: int | None) -> SavedMotorList:
    """A list with other name and motors, now kept; Problem 404, 409 or 412."""
    try:
        done = await request.app.state.store.replace_motor_list(id, draft, version)
    except NameTakenError:
        raise _taken(draft.name) from None
    require_done(done, version, not_found(id))
    note(request, motor_list=id)
    return await found(request, id)


async def removed(request: Request, id: str, version: int | None) -> None:
    """Delete a list; Problem 404 or 412."""
    require_done(await request.app.state.store.delete_motor_list(id, version), version, not_found(id))
    note(request, motor_list=id)


async def found(request: Request, id: str) -> SavedMotorList:
    """A kept list; Problem 404 without one."""
    saved: SavedMotorList | None = await request.app.state.store.motor_list(id)
    if saved is None:
        raise not_found(id)
    return saved


async def changeable(request: Request, id: str) -> SavedMotorList:
    """A list that the caller may change; Problem 404 or 403."""
    if id == SERVER:
        raise Problem(403, Sentence(N_("the list server is motors.csv of the service, which is read-only")))
    saved, state = await found(request, id), request.app.state
    if state.gate.has_keys:
        state.gate.require_owner(request, saved.owner or None)
    return saved


def version_in(request: Request, saved: SavedMotorList) -> int | None:
    """Version that `If-Match` names, None where it names none; Problem 412."""
    if request.headers.get("if-match", "*").strip() == "*":
        return None
    require_match(request, tag_of(saved))
    return saved.version


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
    return entries_in(saved)


def entries_in(saved: SavedMotorList) -> list[MotorEntry]:
    """Motors of a kept list, which were checked when it was kept."""
    return [MotorEntry.model_construct(**motor) for motor in msgspec.json.decode(saved.content)]


def tag_of(line: MotorListLine) -> str:
    """ETag of a list."""
    return etag_of(f"{line.id} {line.version}".encode())


def _taken(name: str) -> Problem:
    return Problem(409, Sentence(N_("there is a list of motors named {name} already"), {"name": repr(name)}))


def not_found(id: str) -> Problem:
    """Problem 404 for an id without a list."""
    return Problem(404, f"there is no list of motors {id[:60]!r}; it may have been deleted")


def named(motors: Sequence[MotorEntry], name: str) -> MotorEntry | None:
    """The motor of a designation."""
    return next((motor for motor in motors if motor.designation == name), None)

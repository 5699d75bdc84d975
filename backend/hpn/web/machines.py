"""Machines as they are read and changed, for the API and the pages alike: each change for the state that it was made
for, again where somebody else was faster elsewhere in the machine."""

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from starlette.datastructures import State
from starlette.requests import Request

from hpn import ENGINE_VERSION
from hpn.application import InputError
from hpn.application.faults import Fault
from hpn.catalogue import Catalogue
from hpn.documents.answers import AxisQuestion
from hpn.documents.axis import MOST_AXES, MOST_PHASES, MOST_REVISIONS
from hpn.engine.selection import encode as encode_selection
from hpn.engine.selection import select
from hpn.links.writer import to_link
from hpn.store import Change, ExcessError, KeyReusedError, KeySpentError, Limits, Machine, Once, SavedAxis
from hpn.store.records import Answer, DocumentKind
from hpn.store.writing import order_of
from hpn.web.columns import columns_of, common_of, resolved
from hpn.web.door.access import key_needed
from hpn.web.door.conditions import etag_of, idempotency_key, require_match
from hpn.web.door.observation import note
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.long_work import answers_in_steps, begin_to_save
from hpn.words.wording import N_, Sentence

LIMITS = Limits(MOST_AXES, MOST_PHASES, MOST_REVISIONS)
TRIES, RETRY_SECONDS = 8, 1
"""Times that a change is made anew where somebody else was faster, before its maker is asked to try again."""

FEW_AXES = 100
"""Axes that are answered on a worker for pages; more have a worker of their own."""

EXCESS = {
    "axes": N_("a machine may have {most} axes at most"),
    "phases": N_("a machine may have {most} phases and moves in all its axes together"),
    "revisions": N_("a document may have {most} revisions at most"),
}
NOT_YOURS = N_("Only the key that calculated this machine may see it and save it.")


def gone(id: str) -> Problem:
    """There is no such document."""
    return Problem(404, f"there is no machine {id[:60]!r}; it may have been deleted, or nobody has saved it for a day")


def no_axis(number: int) -> Problem:
    """There is no such axis."""
    return Problem(404, f"the machine has no axis {number}; it may have been removed")


async def found(
    request: Request, id: str, numbers: Sequence[int] | None = None, kind: DocumentKind | None = None
) -> Machine:
    """A document with its axes, or those of some numbers; Problem 404, and 403 for one that another key calculates."""
    machine: Machine | None = await request.app.state.store.find_machine(id, kind, numbers)
    if machine is None:
        raise gone(id)
    require_seen(request, machine)
    return machine


def require_seen(request: Request, machine: Machine) -> None:
    """Raise Problem 403 for another key than the one that calculated a machine that nobody has saved, 401 without."""
    if machine.saved is not None or machine.owner is None or not request.app.state.gate.has_keys:
        return
    if request.state.api_key is None:
        raise key_needed(request.scope["path"])
    if request.state.api_key != machine.owner:
        raise Problem(403, Sentence(NOT_YOURS))


async def editable(request: Request, id: str, numbers: Sequence[int] | None = None) -> Machine:
    """The same for whoever may change it: Problem 403 without its key."""
    machine = await found(request, id, numbers)
    state: State = request.app.state
    if state.gate.has_keys:
        state.gate.require_owner(request, machine.owner)
    return machine


async def axis_of(request: Request, id: str, number: int) -> tuple[Machine, SavedAxis]:
    """An axis and its document without the other axes; Problem 404."""
    machine = await found(request, id, [number])
    if not machine.items:
        raise no_axis(number)
    return machine, machine.items[0]


async def apply(
    request: Request,
    id: str,
    make: Callable[[Machine], Change],
    numbers: Sequence[int] | None = None,
    once: Once | None = None,
) -> list[int]:
    """Numbers of the axes that are new or back after a change, which is made for the document with some of its axes.

    `make` raises Problem where it can't be made, 412 where `If-Match` names another state. Raises Problem 403, 404,
    410, 422, and 503 where others are faster again and again.
    """
    if once is not None and (before := await made_before(request, once)) is not None:
        return order_of(before)
    for _ in range(TRIES):
        machine = await editable(request, id, numbers)
        few = len(machine.items) <= FEW_AXES
        made = await compute(request, "pages" if few else "batches", make, machine)
        begin_to_save()
        done = await guarded(request.app.state.store.change(id, made, LIMITS, once))
        if done is not None:
            note(request, machine=id)
            numbers_done: list[int] = done
            return numbers_done
    raise Problem.later("others are changing this machine at the moment; try again", RETRY_SECONDS)


async def made_before(request: Request, once: Once) -> str | None:
    """Answer that an idempotency key has made of its document, whatever state the retry names; Problem 422 and 410."""
    made = await guarded(request.app.state.store.made_by(once))
    return None if made is None else made.part or "[]"


async def guarded(writing: Any) -> Any:
    """Result of the store; Problem 422 or 410 for a key that was used before, and for more than there may be."""
    try:
        return await writing
    except KeyReusedError as error:
        raise Problem(422, str(error), kind="idempotency-key-reused") from None
    except KeySpentError as error:
        raise Problem(410, str(error), kind="idempotency-key-spent") from None
    except ExcessError as error:
        raise Problem(422, Sentence(EXCESS[error.what], {"most": str(error.most)})) from None


def once_of(request: Request, body: bytes) -> Once | None:
    """Idempotency key of a request with the fingerprint of its content."""
    key = idempotency_key(request)
    path = request.scope["path"].encode()
    return None if key is None else Once(key, hashlib.sha256(path + b"\n" + body).hexdigest())


def author_of(request: Request, machine: Machine) -> str | None:
    """Key of whoever changes a document, else the author as typed."""
    key: str | None = request.state.api_key
    return key or machine.author


# --- States -----------------------------------------------------------------------------------------------------------


def tag_of(machine: Machine) -> str:
    """Entity tag of a document: of its title block, common values, order and set of axes."""
    return etag_of(f"document {machine.id} {machine.version}".encode())


def axis_tag(machine: Machine, axis: SavedAxis) -> str:
    """Entity tag of an axis: of its own values."""
    return etag_of(f"axis {machine.id} {axis.number} {axis.version}".encode())


def require_document(request: Request, machine: Machine) -> None:
    """Raise Problem 412 where `If-Match` names another state of a document."""
    require_match(request, tag_of(machine))


# --- Answers ----------------------------------------------------------------------------------------------------------


def answered(machine: Machine, common: Mapping[str, Any], catalogue: Catalogue) -> list[tuple[int, int, Answer]]:
    """Answers of the axes of a document under common values, as a change has them."""
    questions = (AxisQuestion(resolved(axis, common), axis.ordering_code) for axis in machine.items)
    replies = answers_in_steps(questions, len(machine.items), catalogue)
    return [
        (axis.number, axis.version, columns_of(answer)) for axis, answer in zip(machine.items, replies, strict=True)
    ]


def selection_of(machine: Machine, axis: SavedAxis, catalogue: Catalogue) -> bytes:
    """JSON of the selection of an axis; Problem 409 for one that is open."""
    application = resolved(axis, common_of(machine))
    if application.application is None:
        faults = [Fault(location, sentence.text, code) for location, sentence, code in application.faults]
        raise Problem(409, "the axis is open: its application is incomplete, or has errors", faults)
    try:
        return encode_selection(select(application.application, catalogue, to_link))
    except InputError as error:
        raise Problem(409, str(error), Problem.of(error).errors) from None


def of_today(machine: Machine, catalogue: Catalogue) -> Machine:
    """A document whose axes have the answers of today's engine and catalogue."""
    today = (ENGINE_VERSION, catalogue.version)
    if all((axis.answer["engine_version"], axis.answer["catalogue_version"]) == today for axis in machine.items):
        return machine
    fresh = answered(machine, common_of(machine), catalogue)
    items = [replace(axis, answer=answer) for axis, (_, _, answer) in zip(machine.items, fresh, strict=True)]
    return replace(machine, items=tuple(items))


def patched(target: Any, patch: Any) -> Any:
    """A value after a JSON merge patch (RFC 7396)."""
    if not isinstance(patch, dict):
        return patch
    result = dict(target) if isinstance(target, dict) else {}
    for name, value in patch.items():
        if value is None:
            result.pop(name, None)
        else:
            result[name] = patched(result.get(name), value)
    return result

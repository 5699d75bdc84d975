"""Reading and changing of machines, for both API and pages: each change applies to the state that it was made for, and
is repeated if somebody else has changed another part of the machine meanwhile."""

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

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
"""Attempts at a change that others overtake, and the time after which the caller should then try again."""

FEW_AXES = 100
"""Number of axes up to which a change is computed on a worker of `pages`, else of `batches`."""

EXCESS = {
    "axes": N_("a machine may have {most} axes at most"),
    "phases": N_("a machine may have {most} phases and moves in all its axes together"),
    "revisions": N_("a document may have {most} revisions at most"),
}
NOT_YOURS = N_("Only the key that calculated this machine may see it and save it.")


def no_document(id: str) -> Problem:
    """Problem 404 for an unknown document."""
    return Problem(404, f"there is no machine {id[:60]!r}; it may have been deleted, or nobody has saved it for a day")


def no_axis(number: int) -> Problem:
    """Problem 404 for an unknown axis."""
    return Problem(404, f"the machine has no axis {number}; it may have been removed")


async def machine_of(
    request: Request, id: str, numbers: Sequence[int] | None = None, kind: DocumentKind | None = None
) -> Machine:
    """Document with all axes or those of `numbers`; Problem 404, and 401 or 403 as `require_seen` raises."""
    machine: Machine | None = await request.app.state.store.find_machine(id, kind, numbers)
    if machine is None:
        raise no_document(id)
    require_seen(request, machine)
    return machine


def require_seen(request: Request, machine: Machine) -> None:
    """Raise Problem 403 for an unsaved machine that another key calculated, 401 without a key."""
    if machine.saved is not None or machine.owner is None or not request.app.state.gate.has_keys:
        return
    if request.state.api_key is None:
        raise key_needed(request.scope["path"])
    if request.state.api_key != machine.owner:
        raise Problem(403, Sentence(NOT_YOURS))


async def editable(request: Request, id: str, numbers: Sequence[int] | None = None) -> Machine:
    """Document as of `found` that the caller may change; Problem 403 without its key."""
    machine = await machine_of(request, id, numbers)
    request.app.state.gate.require_owner(request, machine.owner)
    return machine


async def axis_of(request: Request, id: str, number: int) -> tuple[Machine, SavedAxis]:
    """Document without its other axes, and the axis; Problem 404."""
    machine = await machine_of(request, id, [number])
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
    """Change a document; numbers of the axes that are new or restored. `make` gets the document with axes of `numbers`.

    `make` raises Problem if the change is impossible, 412 if `If-Match` names another state. Raises Problem 403, 404,
    410, 422, and 503 if others overtake every attempt.
    """
    for _ in range(TRIES):
        machine = await editable(request, id, numbers)
        few = len(machine.items) <= FEW_AXES
        change = await compute(request, "pages" if few else "batches", make, machine)
        begin_to_save()
        outcome = await guarded(request.app.state.store.change(id, change, LIMITS, once))
        if outcome is not None:
            note(request, machine=id)
            numbers_done: list[int] = outcome
            return numbers_done
    raise Problem.later("others are changing this machine at the moment; try again", RETRY_SECONDS)


async def made_before(request: Request, once: Once) -> str | None:
    """Earlier answer under an idempotency key, None if the key is new; the retry's `If-Match` is ignored.

    Raises Problem 422 and 410 as `guarded` does.
    """
    document = await guarded(request.app.state.store.made_by(once))
    return None if document is None else document.part or "[]"


async def guarded(writing: Any) -> Any:
    """Result of the store; Problem 422 or 410 for a key that was used before, 422 beyond a limit."""
    try:
        return await writing
    except KeyReusedError as error:
        raise Problem(422, str(error), kind="idempotency-key-reused") from None
    except KeySpentError as error:
        raise Problem(410, str(error), kind="idempotency-key-spent") from None
    except ExcessError as error:
        raise Problem(422, Sentence(EXCESS[error.what], {"most": str(error.most)})) from None


def once_of(request: Request, body: bytes) -> Once | None:
    """Idempotency key of a request with the fingerprint of its path and body; None without a key."""
    key = idempotency_key(request)
    path = request.scope["path"].encode()
    return None if key is None else Once(key, hashlib.sha256(path + b"\n" + body).hexdigest())


def author_of(request: Request, machine: Machine) -> str | None:
    """Name of the caller's key, else the document's author as typed."""
    key: str | None = request.state.api_key
    return key or machine.author


# --- States -----------------------------------------------------------------------------------------------------------


def tag_of(machine: Machine) -> str:
    """Entity tag of a document's title block, common values, order and set of axes."""
    return etag_of(f"document {machine.id} {machine.version}".encode())


def axis_tag(machine: Machine, axis: SavedAxis) -> str:
    """Entity tag of an axis's own values."""
    return etag_of(f"axis {machine.id} {axis.number} {axis.version}".encode())


def require_document(request: Request, machine: Machine) -> None:
    """Raise Problem 412 if `If-Match` names another state of a document."""
    require_match(request, tag_of(machine))


# --- Answers ----------------------------------------------------------------------------------------------------------


def answers_under(machine: Machine, common: Mapping[str, Any], catalogue: Catalogue) -> list[tuple[int, int, Answer]]:
    """Number, version and answer of each axis of a document under other common values, for a change."""
    questions = (AxisQuestion(resolved(axis, common), axis.ordering_code) for axis in machine.items)
    replies = answers_in_steps(questions, len(machine.items), catalogue)
    return [
        (axis.number, axis.version, columns_of(answer)) for axis, answer in zip(machine.items, replies, strict=True)
    ]


def selection_of(machine: Machine, axis: SavedAxis, catalogue: Catalogue) -> bytes:
    """JSON of the selection of an axis; Problem 409 for an open axis."""
    application = resolved(axis, common_of(machine))
    if application.application is None:
        faults = [Fault(location, sentence.text, code) for location, sentence, code in application.faults]
        raise Problem(409, "the axis is open: its application is incomplete, or has errors", faults)
    try:
        return encode_selection(select(application.application, catalogue, to_link))
    except InputError as error:
        raise Problem(409, str(error), Problem.of(error).errors) from None


def of_today(machine: Machine, catalogue: Catalogue) -> Machine:
    """Document whose axes have the answers of today's engine and catalogue."""
    today = (ENGINE_VERSION, catalogue.version)
    if all((axis.answer["engine_version"], axis.answer["catalogue_version"]) == today for axis in machine.items):
        return machine
    fresh = answers_under(machine, common_of(machine), catalogue)
    items = [replace(axis, answer=answer) for axis, (_, _, answer) in zip(machine.items, fresh, strict=True)]
    return replace(machine, items=tuple(items))


def patched(target: Any, patch: Any) -> Any:
    """Value after a JSON merge patch (RFC 7396)."""
    if not isinstance(patch, dict):
        return patch
    result = dict(target) if isinstance(target, dict) else {}
    for name, value in patch.items():
        if value is None:
            result.pop(name, None)
        else:
            result[name] = patched(result.get(name), value)
    return result

"""States of documents to be read and compared: revisions, the working copy, and what today says to one of them."""

from typing import NamedTuple

from starlette.requests import Request

from hpn.catalogue import Catalogue
from hpn.documents.differences import today
from hpn.documents.revision import NOW, TODAY, Frozen, decode, label_key
from hpn.store import Machine, RevisionLine
from hpn.web.columns import frozen_of
from hpn.web.door.problems import Problem
from hpn.web.freezing import revision


class State(NamedTuple):
    """A revision as it was frozen, or the working copy, or None for what today says to the other; and its catalogue."""

    content: bytes | Machine | None
    catalogue: Catalogue | None
    line: RevisionLine | None = None


async def state_of(request: Request, machine: Machine, label: str) -> State:
    """A revision by its label, the working copy or today; Problem 404."""
    today_s: Catalogue = request.app.state.catalogue
    if label_key(label) == TODAY:
        return State(None, today_s)
    if label_key(label) == NOW:
        return State(machine, await _catalogue_of(request, machine.catalogue_version))
    line, frozen = await revision(request, machine.id, label)
    return State(frozen, await _catalogue_of(request, line.catalogue_version), line)


async def states_of(request: Request, machine: Machine, before: str, after: str) -> tuple[State, State]:
    """Two states to be compared; Problem 404, and 422 for today twice."""
    if label_key(before) == label_key(after) == TODAY:
        detail = "today is compared with a revision, or with now"
        raise Problem(422, detail, [(("to",), detail)])
    return await state_of(request, machine, before), await state_of(request, machine, after)


async def _catalogue_of(request: Request, version: str) -> Catalogue | None:
    """Catalogue of a version; None where it is not kept."""
    catalogue: Catalogue = request.app.state.catalogue
    if version == catalogue.version:
        return catalogue
    book: Catalogue | None = await request.app.state.store.catalogue(version)
    return book


def documents_of(one: State, other: State) -> tuple[Frozen, Frozen]:
    """The documents of two states of which one at least is not today."""
    known = [document_of(each.content) for each in (one, other)]
    there = next(each for each in known if each is not None)
    first, second = (
        today(there, state.catalogue) if each is None and state.catalogue else each or there
        for each, state in zip(known, (one, other), strict=True)
    )
    return first, second


def catalogues_of(one: State, other: State) -> tuple[Catalogue | None, Catalogue | None]:
    """Their catalogues."""
    return one.catalogue, other.catalogue


def document_of(state: bytes | Machine | None) -> Frozen | None:
    """The document of a state; None for today."""
    if isinstance(state, Machine):
        return frozen_of(state, state.items)
    return None if state is None else decode(state)

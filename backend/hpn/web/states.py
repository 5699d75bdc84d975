"""States of documents to read and compare: revisions, the working copy, and either with today's answers."""

from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from typing import NamedTuple

from starlette.requests import Request

from hpn.catalogue import Catalogue
from hpn.documents.differences import today
from hpn.documents.revision import NOW, TODAY, Frozen, decode, label_key
from hpn.files.export import ExportTitle
from hpn.files.machine.changes import DifferencesExport
from hpn.store import Machine, RevisionLine
from hpn.store.records import DocumentKind
from hpn.web.columns import frozen_of
from hpn.web.door.problems import Problem
from hpn.web.door.visit import absolute
from hpn.web.freezing import revision

PLACES: Mapping[DocumentKind, str] = {"machine": "/machines", "selection": "/selections"}
"""Paths of the pages of documents."""


class State(NamedTuple):
    """Frozen revision, or working copy, or None for today's answers to the other state; with its catalogue."""

    content: bytes | Machine | None
    catalogue: Catalogue | None
    line: RevisionLine | None = None


async def state_of(request: Request, machine: Machine, label: str) -> State:
    """State by its label: a revision, the working copy or today; Problem 404."""
    today_s: Catalogue = request.app.state.catalogue
    if label_key(label) == TODAY:
        return State(None, today_s)
    if label_key(label) == NOW:
        return State(machine, await _catalogue_of(request, machine.catalogue_version))
    line, frozen = await revision(request, machine.id, label, machine.kind)
    return State(frozen, await _catalogue_of(request, line.catalogue_version), line)


async def frozen_states(request: Request, id: str, latest: Sequence[RevisionLine]) -> dict[int, State]:
    """States of a document's latest revisions by their numbers."""
    contents: Mapping[int, bytes] = await request.app.state.store.revision_contents(id, len(latest))
    versions = {line.catalogue_version for line in latest}
    books = {version: await _catalogue_of(request, version) for version in versions}
    return {line.number: State(contents[line.number], books[line.catalogue_version], line) for line in latest}


async def states_of(request: Request, machine: Machine, before: str, after: str) -> tuple[State, State]:
    """Two states to compare; Problem 404, and 422 for today twice."""
    if label_key(before) == label_key(after) == TODAY:
        detail = "today is compared with a revision, or with now"
        raise Problem(422, detail, [(("to",), detail)])
    return await state_of(request, machine, before), await state_of(request, machine, after)


async def _catalogue_of(request: Request, version: str) -> Catalogue | None:
    """Catalogue of a version; None if it is not kept."""
    catalogue: Catalogue = request.app.state.catalogue
    if version == catalogue.version:
        return catalogue
    book: Catalogue | None = await request.app.state.store.catalogue(version)
    return book


def documents_of(one: State, other: State) -> tuple[Frozen, Frozen]:
    """Documents of two states; at most one may be today."""
    known = [document_of(each.content) for each in (one, other)]
    there = next(each for each in known if each is not None)
    first, second = (
        today(there, state.catalogue) if each is None and state.catalogue else each or there
        for each, state in zip(known, (one, other), strict=True)
    )
    return first, second


def catalogues_of(one: State, other: State) -> tuple[Catalogue | None, Catalogue | None]:
    """Catalogues of two states."""
    return one.catalogue, other.catalogue


def document_of(state: bytes | Machine | None) -> Frozen | None:
    """Document of a state; None for today."""
    if isinstance(state, Machine):
        return frozen_of(state, state.items)
    return None if state is None else decode(state)


def comparison(machine: Machine, labels: tuple[str, str]) -> str:
    """Address of the page that compares two states of a document."""
    return f"{PLACES[machine.kind]}/{machine.id}/revisions?from={labels[0]}&to={labels[1]}"


def differences(
    request: Request, machine: Machine, labels: tuple[str, str], states: tuple[State, State]
) -> DifferencesExport:
    """Differences of two states, for their page and files."""
    heading = ExportTitle(machine.title or "", machine.reference or "", machine.author or "")
    link, moment = absolute(request, comparison(machine, labels)), datetime.now(UTC)
    return DifferencesExport(labels, documents_of(*states), catalogues_of(*states), link, heading, moment=moment)

"""Pages of revisions of a machine or selection: their list, two states compared cell by cell, and saving the next."""

from collections.abc import Mapping
from typing import Any

from fastapi import APIRouter
from pydantic import ValidationError
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from hpn import ENGINE_VERSION
from hpn.documents.revision import TODAY, RevisionBlock, decode
from hpn.documents.summary import summary_of
from hpn.store import Machine, RevisionLine
from hpn.store.records import DocumentKind
from hpn.web.columns import frozen_of
from hpn.web.door.access import admit
from hpn.web.door.bodies import pairs_of, read_form
from hpn.web.door.hosts import require_same_origin
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.door.visit import current
from hpn.web.freezing import freeze
from hpn.web.machines import FEW_AXES, machine_of
from hpn.web.pages.machine_view import REASON, MachineView
from hpn.web.pages.rendering import or_reason, page
from hpn.web.pages.revisions_view import (
    BLOCK,
    MOST_LINES,
    STATES,
    Compared,
    gears_shown,
    is_working_copy,
    moments_of,
    next_label,
    next_revision,
    pair_of,
)
from hpn.web.pages.saved_list import version_of
from hpn.web.pages.saving import REASON as SELECTION_REASON
from hpn.web.states import PLACES, State, differences, frozen_states, states_of
from hpn.words.wording import Sentence

FEW_IN_ALL = 1000
"""Maximum axes in all revisions with figures in the list; older revisions are listed without figures."""


async def _machine_of(request: Request, kind: DocumentKind) -> Machine:
    return await machine_of(request, request.path_params[{"machine": "machine", "selection": "id"}[kind]], None, kind)


async def revisions_page(
    request: Request, machine: Machine, status: int = 200, block: Mapping[str, str] | None = None, messages: Any = ()
) -> Response:
    """Page of a document's revisions, with the form of the next one as filled in."""
    lines: list[RevisionLine] = await request.app.state.store.revisions(machine.id)
    pair = pair_of(machine, lines, request.query_params)
    states = await states_of(request, machine, *pair) if pair else None
    brief = await frozen_states(request, machine.id, _few(lines))
    may_change = request.app.state.gate.may_change(request, machine.owner)
    values: dict[str, Any] = {
        "saved": machine,
        "place": f"{PLACES[machine.kind]}/{machine.id}",
        "lines": lines[:MOST_LINES],
        "all_lines": lines,
        "is_new": not lines or machine.updated > lines[0].created,
        "may_change": may_change,
        **next_revision(lines),
        "messages": messages,
        "may_save_today": may_change and is_working_copy(machine, lines, pair),
        "states": STATES,
        "engine_version": ENGINE_VERSION,
        "catalogue_version": request.app.state.catalogue.version,
    }
    values["block"] |= block or {}
    few = len(machine.items) <= FEW_AXES
    return await compute(request, "pages" if few else "batches", _page, request, status, states, pair, brief, values)


def _few(lines: list[RevisionLine]) -> list[RevisionLine]:
    """Latest revisions, up to FEW_IN_ALL axes together."""
    few, axes = list[RevisionLine](), 0
    for line in lines[:MOST_LINES]:
        axes += max(line.axes, FEW_IN_ALL // MOST_LINES)
        if axes > FEW_IN_ALL:
            break
        few.append(line)
    return few


def _page(
    request: Request,
    status: int,
    states: tuple[State, State] | None,
    pair: tuple[str, str] | None,
    brief: Mapping[int, State],
    values: dict[str, Any],
) -> Response:
    machine: Machine = values["saved"]
    compared, today = None, None
    if states and pair:
        whole = request.query_params.get("show") == "all"
        compared = Compared(differences(request, machine, pair, states), current(), whole)
        today = _today(request, machine, pair, states[1], compared)
    frozen = {number: decode(state.content) for number, state in brief.items() if isinstance(state.content, bytes)}
    now = MachineView(machine, request.app.state.catalogue)
    context = {
        "compared": compared,
        "today": today,
        "pair": pair,
        "counts": {number: summary_of(document, brief[number].catalogue) for number, document in frozen.items()},
        "gears": gears_shown(frozen, current()),
        "now_gear": gears_shown({0: frozen_of(machine, machine.items)}, current())[0],
        "moments": moments_of(pair, values["all_lines"]),
        "now": now,
    }
    return page(request, "revisions.html", status, **context, **values)


def _today(
    request: Request, machine: Machine, pair: tuple[str, str], last: State, compared: Compared
) -> Compared | bool | None:
    """Comparison of the second state with today's catalogue and engine: True if both versions are the same, None if it
    is not made: for today itself and for many axes.
    """
    if pair[1] == TODAY:
        return None
    summary = compared.sides[1]
    if (*summary.engine_versions, *summary.catalogue_versions) == (ENGINE_VERSION, request.app.state.catalogue.version):
        return True
    if len(compared.export.documents[1].axes) > FEW_AXES:
        return None
    today = State(None, request.app.state.catalogue)
    return Compared(differences(request, machine, (pair[1], TODAY), (last, today)), current())


async def _save(request: Request, kind: DocumentKind) -> Response:
    """Freeze the working copy under the label of a form, and redirect to the list."""
    require_same_origin(request)
    fields = dict(pairs_of(await read_form(request)))
    machine = await _machine_of(request, kind)
    texts = {name: fields.get(name, "").strip() for name in BLOCK}
    try:
        block = RevisionBlock.model_validate({name: text for name, text in texts.items() if text})
        await freeze(request, machine.id, block, None, version=version_of(fields))
    except ValidationError as error:
        problem = Problem.of(error)
        return await revisions_page(
            request, machine, 422, texts, [Sentence("{text}", {"text": each.text}) for each in problem.errors]
        )
    except Problem as error:
        if error.status_code != 409:
            raise
        lines = await request.app.state.store.revisions(machine.id)
        return await revisions_page(request, machine, 409, {**texts, "label": next_label(lines)}, error.sentences)
    return RedirectResponse(f"{PLACES[kind]}/{machine.id}/revisions", 303)


@or_reason(REASON)
async def show_of_machine(request: Request) -> Response:
    """Page of a machine's revisions, with a comparison of two states."""
    return await revisions_page(request, await _machine_of(request, "machine"))


@or_reason(REASON)
async def save_of_machine(request: Request) -> Response:
    """Save the working copy of a machine as a revision."""
    return await _save(request, "machine")


@or_reason(SELECTION_REASON)
async def show_of_selection(request: Request) -> Response:
    """Page of a selection's revisions, with a comparison of two states."""
    return await revisions_page(request, await _machine_of(request, "selection"))


@or_reason(SELECTION_REASON)
async def save_of_selection(request: Request) -> Response:
    """Save the working copy of a selection as a revision."""
    return await _save(request, "selection")


router = APIRouter(include_in_schema=False)
OF_MACHINE, OF_SELECTION = "/machines/{machine}/revisions", "/selections/{id}/revisions"
router.add_api_route(OF_MACHINE, show_of_machine, dependencies=[admit("reading")])
router.add_api_route(OF_MACHINE, save_of_machine, methods=["POST"], dependencies=[admit("deleting")])
router.add_api_route(OF_SELECTION, show_of_selection, dependencies=[admit("reading")])
router.add_api_route(OF_SELECTION, save_of_selection, methods=["POST"], dependencies=[admit("deleting")])

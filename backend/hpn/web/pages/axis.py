"""Page of an axis: the workbench with its machine above it, saving of the axis, and conflicts between two editors."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from hpn.catalogue import Catalogue
from hpn.documents.axis import MOST_NUMBER
from hpn.store import AxesOfGear, Machine, RevisionLine, SavedAxis, StoreUnavailableError
from hpn.web.door.access import admit
from hpn.web.door.bodies import pairs_of, read_form
from hpn.web.door.conditions import other_state
from hpn.web.door.hosts import require_same_origin
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.edits import replace_axis
from hpn.web.form.form import Form
from hpn.web.form.linked import query_part
from hpn.web.form.query import Pairs
from hpn.web.machines import axis_of, machine_of
from hpn.web.pages import calculator
from hpn.web.pages.axis_conflict import conflict_of
from hpn.web.pages.axis_view import AxisView, Neighbours, stored_pairs, values_of, view_of
from hpn.web.pages.rendering import or_reason, page, reason

REASON = "axis_refused.html"
"""Page with the reason why an axis can't be shown or saved."""


@or_reason(REASON)
async def show_axis(request: Request) -> Response:
    """Page of an axis in the workbench with the inputs of the query; without a query as stored."""
    return await _axis_page(request, pairs_of(request.url.query))


@or_reason(REASON)
async def show_posted_axis(request: Request) -> Response:
    """Page of an axis with the inputs of a posted form, which may be too long for an address; saves nothing."""
    return await _axis_page(request, pairs_of(await read_form(request)))


async def _axis_page(request: Request, pairs: Pairs) -> Response:
    machine, axis = await axis_of(request, request.path_params["id"], number_of(request))
    request.app.state.gate.require_key_to_edit(request, machine.owner)
    around = await neighbours(request, machine, axis)
    is_machine = machine.kind == "machine"
    gears = await request.app.state.store.gears(machine.id, axis.number) if is_machine else {}
    lines = await request.app.state.store.revisions(machine.id) if "hx-request" not in request.headers else []
    return await compute(request, "pages", _responded, request, machine, axis, around, pairs, gears, lines)


def _responded(
    request: Request,
    machine: Machine,
    axis: SavedAxis,
    neighbours: Neighbours,
    pairs: Pairs,
    gears: Mapping[str, AxesOfGear],
    lines: Sequence[RevisionLine],
) -> Response:
    form, view = view_of(machine, axis, neighbours, pairs, request.app.state.catalogue)
    may_change = request.app.state.gate.may_change(request, machine.owner)
    return calculator.respond(request, form, axis=replace(view, may_change=may_change, gears=gears, revisions=lines))


def number_of(request: Request) -> int:
    """Number of the axis in the address; Problem 404 for an impossible number."""
    text = request.path_params["number"]
    if not (text.isascii() and text.isdigit() and len(text) < 11 and 1 <= int(text) <= MOST_NUMBER):
        raise Problem(404, f"there is no axis {text[:20]!r}")
    return int(text)


async def neighbours(request: Request, machine: Machine, axis: SavedAxis) -> Neighbours:
    """Axes before and after an axis."""
    order = (None, *machine.order, None)
    at = machine.order.index(axis.number) + 1
    beside = [order[at - 1], order[at + 1]]
    there = await machine_of(request, machine.id, [number for number in beside if number is not None])
    named = {each.number: each for each in there.items}
    return Neighbours(*(None if number is None else named.get(number) for number in beside))


# --- Saving -----------------------------------------------------------------------------------------------------------


async def save_axis(request: Request) -> Response:
    """Save an axis from a form, and redirect to it; 412 shows the changes of others since it was opened."""
    require_same_origin(request)
    body = await read_form(request)
    try:
        pairs = _pairs_of_form(body)
        response = await _save_form(request, pairs)
        return response or await _save_form(request, pairs) or await _axis_page(request, pairs)
    except (Problem, StoreUnavailableError) as error:
        return reason(request, REASON, error)


async def _save_form(request: Request, pairs: Pairs) -> Response | None:
    """Answer to a form that saves; None if somebody else saved the axis at the same moment."""
    machine, axis = await axis_of(request, request.path_params["id"], number_of(request))
    around = await neighbours(request, machine, axis)
    form, view, own = await compute(request, "pages", _own, request, machine, axis, around, pairs)
    if form.problems:
        return await _axis_page(request, pairs)
    if view.overtaken and view.typed != stored_pairs(axis, request.app.state.catalogue):
        catalogue = request.app.state.catalogue
        return await compute(
            request,
            "pages",
            lambda: page(request, "axis_conflict.html", 412, axis=view, conflict=conflict_of(view, catalogue)),
        )
    try:
        if not view.overtaken:  # otherwise the form was sent twice, and is saved already
            await _save(request, view, own)
    except Problem as error:
        if error.status_code != 412:
            raise
        return None
    return RedirectResponse(view.place, 303)


def _pairs_of_form(body: bytes) -> Pairs:
    """Fields of the form; `link` adds those of an address that the form itself lacks."""
    fields = pairs_of(body)
    own = [(name, text) for name, text in fields if name not in ("link", "once")]
    names = {name for name, _ in own}
    linked = pairs_of(query_part(dict(fields).get("link", "")))
    return [*own, *(pair for pair in linked if pair[0] not in names)]


def _own(
    request: Request, machine: Machine, axis: SavedAxis, neighbours: Neighbours, pairs: Pairs
) -> tuple[Form, AxisView, dict[str, Any]]:
    """Form, axis, and the axis's own values to save; no values for a form with problems."""
    catalogue: Catalogue = request.app.state.catalogue
    form, view = view_of(machine, axis, neighbours, pairs, catalogue)
    form, answer = calculator.form_and_answer(form, catalogue, view)
    if form.problems:
        return form, view, {}
    code = None
    if answer and (form.gear or any(answer.order.labels.values())):
        code = answer.order.text
    labels = values_of(view.labels)
    return (
        form,
        view,
        {
            "name": labels.name,
            "quantity": labels.quantity,
            "note": labels.note,
            "ordering_code": code,
            "without": tuple(view.paths),
            "application": view.own,
        },
    )


async def _save(request: Request, view: AxisView, own: dict[str, Any]) -> None:
    def require(machine: Machine, axis: SavedAxis) -> None:
        if axis.version != view.version:
            raise other_state()

    await replace_axis(request, view.machine.id, view.axis.number, lambda axis: own, require)


router = APIRouter(include_in_schema=False)
ADDRESS = "/machines/{id}/axes/{number}"
router.add_api_route(ADDRESS, show_axis, dependencies=[admit("reading")])
router.add_api_route(ADDRESS, show_posted_axis, methods=["POST"], dependencies=[admit("reading")])
router.add_api_route(f"{ADDRESS}/save", save_axis, methods=["POST"], dependencies=[admit("deleting")])

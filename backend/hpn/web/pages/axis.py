"""The page of an axis: the workbench with its machine above it, saving it back, and what two people meant by it."""

from dataclasses import replace
from typing import Any

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from hpn.catalogue import Catalogue
from hpn.documents.axis import MOST_NUMBER
from hpn.store import Machine, SavedAxis, StoreUnavailableError
from hpn.web.door.access import admit
from hpn.web.door.bodies import pairs_of, read_form
from hpn.web.door.conditions import other_state
from hpn.web.door.hosts import require_same_origin
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.edits import replace_axis
from hpn.web.form.form import Form
from hpn.web.form.given import Pairs
from hpn.web.form.linked import query_part
from hpn.web.machines import axis_of, found
from hpn.web.pages import calculator
from hpn.web.pages.axis_conflict import conflict_of
from hpn.web.pages.axis_view import AxisView, Neighbours, stored_pairs, values_of, view_of
from hpn.web.pages.machine import may_change, require_key_to_edit
from hpn.web.pages.rendering import or_reason, page, reason

REASON = "axis_refused.html"
"""Page that says why an axis can't be shown or saved."""


@or_reason(REASON)
async def show_axis(request: Request) -> Response:
    """An axis in the workbench, with what the query says of it; without one as it is stored."""
    return await _shown(request, pairs_of(request.url.query))


@or_reason(REASON)
async def show_posted_axis(request: Request) -> Response:
    """The same of a form that is posted, since it may be too long for an address; nothing is kept."""
    return await _shown(request, pairs_of(await read_form(request)))


async def _shown(request: Request, pairs: Pairs) -> Response:
    machine, axis = await axis_of(request, request.path_params["id"], number_of(request))
    require_key_to_edit(request, machine)
    around = await neighbours(request, machine, axis)
    return await compute(request, "pages", _responded, request, machine, axis, around, pairs)


def _responded(request: Request, machine: Machine, axis: SavedAxis, neighbours: Neighbours, pairs: Pairs) -> Response:
    form, view = view_of(machine, axis, neighbours, pairs, request.app.state.catalogue)
    return calculator.respond(request, form, axis=replace(view, may_change=may_change(request, machine)))


def number_of(request: Request) -> int:
    """Number of the axis in the address; Problem 404 for what can't be one."""
    text = request.path_params["number"]
    if not (text.isascii() and text.isdigit() and len(text) < 11 and 1 <= int(text) <= MOST_NUMBER):
        raise Problem(404, f"there is no axis {text[:20]!r}")
    return int(text)


async def neighbours(request: Request, machine: Machine, axis: SavedAxis) -> Neighbours:
    """Axes before and after one."""
    order = (None, *machine.order, None)
    at = machine.order.index(axis.number) + 1
    beside = [order[at - 1], order[at + 1]]
    there = await found(request, machine.id, [number for number in beside if number is not None])
    named = {each.number: each for each in there.items}
    return Neighbours(*(None if number is None else named.get(number) for number in beside))


# --- Saving -----------------------------------------------------------------------------------------------------------


async def save_axis(request: Request) -> Response:
    """Saves what a form says of an axis, and leads back to it; 412 shows what others made of it since it was opened."""
    require_same_origin(request)
    body = await read_form(request)
    try:
        pairs = _posted(body)
        saved = await _saved(request, pairs)
        return saved or await _saved(request, pairs) or await _shown(request, pairs)
    except (Problem, StoreUnavailableError) as error:
        return reason(request, REASON, error)


async def _saved(request: Request, pairs: Pairs) -> Response | None:
    """Answer to a form that saves; None where somebody else was faster at that very moment."""
    machine, axis = await axis_of(request, request.path_params["id"], number_of(request))
    around = await neighbours(request, machine, axis)
    form, view, own = await compute(request, "pages", _own, request, machine, axis, around, pairs)
    if form.problems:
        return await compute(request, "pages", _responded, request, machine, axis, around, pairs)
    if view.overtaken and view.typed != stored_pairs(axis, request.app.state.catalogue):
        return await compute(request, "pages", _conflict, request, view)
    try:
        if not view.overtaken:  # else it has been saved before, as a form that is sent again
            await _save(request, view, own)
    except Problem as error:
        if error.status_code != 412:
            raise
        return None
    return RedirectResponse(view.place, 303)


def _posted(body: bytes) -> Pairs:
    """Fields of the form; `link` stands for those of an address, and what is given beside it goes first."""
    fields = pairs_of(body)
    own = [(name, text) for name, text in fields if name not in ("link", "once")]
    given = {name for name, _ in own}
    linked = pairs_of(query_part(dict(fields).get("link", "")))
    return [*own, *(pair for pair in linked if pair[0] not in given)]


def _own(
    request: Request, machine: Machine, axis: SavedAxis, neighbours: Neighbours, pairs: Pairs
) -> tuple[Form, AxisView, dict[str, Any]]:
    """Form, axis and its own values as they are to be kept."""
    catalogue: Catalogue = request.app.state.catalogue
    form, view = view_of(machine, axis, neighbours, pairs, catalogue)
    form, answer = calculator.answered(form, catalogue, view)
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


def _conflict(request: Request, view: AxisView) -> Response:
    return page(request, "axis_conflict.html", 412, axis=view, conflict=conflict_of(view, request.app.state.catalogue))


router = APIRouter(include_in_schema=False)
ADDRESS = "/machines/{id}/axes/{number}"
router.add_api_route(ADDRESS, show_axis, dependencies=[admit("calculator")])
router.add_api_route(ADDRESS, show_posted_axis, methods=["POST"], dependencies=[admit("calculator")])
router.add_api_route(f"{ADDRESS}/save", save_axis, methods=["POST"], dependencies=[admit("deleting")])

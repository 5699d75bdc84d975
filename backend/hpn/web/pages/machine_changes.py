"""Changes of a machine from its page: common values, marked axes, copies, removal and undo. Values can be tried before,
which shows the effect alone. The changes themselves are in `hpn.web.edits`, which REST uses, too.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import msgspec
from fastapi import APIRouter
from pydantic import ValidationError
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from hpn.catalogue import Catalogue
from hpn.documents.common import Common, flat
from hpn.store import Change, Machine, SavedAxis
from hpn.tables.files import packed, unpacked
from hpn.web.columns import common_of, json_of
from hpn.web.door.access import admit
from hpn.web.door.bodies import pairs_of, read_form
from hpn.web.door.hosts import require_same_origin
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem, needs
from hpn.web.door.visit import current
from hpn.web.edits import (
    OvertakenError,
    Plan,
    Undo,
    axes_by_number,
    plan_addition,
    plan_common,
    plan_copies,
    plan_kinds,
    plan_patches,
    plan_removal,
    plan_undo,
)
from hpn.web.form import common as fields
from hpn.web.form.query import FieldProblem
from hpn.web.long_work import EVENTS, CountedAnswer, given_up_at_end
from hpn.web.machines import FEW_AXES, apply, author_of, editable, machine_of
from hpn.web.pages.machine import EMPTY, machine_page
from hpn.web.pages.machine_editing import (
    MOST_UNDONE,
    QUANTITY,
    Command,
    Editing,
    inherited,
    is_number,
    patch_in,
    values_in,
)
from hpn.web.pages.machine_view import ADDRESS, REASON, RowChoice
from hpn.web.pages.rendering import or_reason
from hpn.words.wording import N_, Sentence

MARK_SOME = N_("Mark the axes first.")
NOTHING_OTHER = N_("Nothing is changed yet.")
CHANGED = N_("Changed.")
ADDED = N_("Added.")
UNDONE = N_("Undone.")
OVERTAKEN = N_(
    "Somebody else has changed this since you opened the page. The table shows theirs; yours is still in the fields, "
    "and nothing of it is saved. Apply again to set yours."
)
NOT_UNDONE = N_("Not undone: somebody else has changed the same since. The table shows theirs.")


# --- Changing ---------------------------------------------------------------------------------------------------------


@or_reason(REASON)
async def change(request: Request) -> Response:
    """Make a change, or show only its effect; page of the machine afterwards. A client that accepts events gets the
    count of answered axes meanwhile.
    """
    require_same_origin(request)
    command = Command.of(pairs_of(await read_form(request)))
    await editable(request, request.path_params["machine"], [])
    if EVENTS in request.headers.get("accept", ""):
        return CountedAnswer(request, lambda: or_reason(REASON)(partial(_answer, command=command))(request))
    with given_up_at_end():
        return await _answer(request, command)


async def _answer(request: Request, command: Command) -> Response:
    id = request.path_params["machine"]
    await machine_of(request, id, [], "machine")
    try:
        editing = await _editing_after(request, id, command)
    except OvertakenError as error:
        editing = await _overtaken(request, id, command, error)
    except ValidationError as error:
        reason = Sentence("{text}", {"text": Problem.of(error).errors[0].text})
        editing = Editing(command, message=reason, is_refused=True, past=command.past)
    machine = await machine_of(request, id, None, "machine")
    status = 409 if editing.overtaken else 422 if editing.is_refused else 200
    return await machine_page(request, machine, status, EMPTY, editing)


async def _editing_after(request: Request, id: str, command: Command) -> Editing:
    if command.do == "undo" and command.past:
        return await _undo(request, id, command)
    if command.do == "kinds":
        return await _kinds_taken(request, id, command)
    if command.target == "common":
        return await _common_changed(request, id, command)
    if command.do == "add":
        return await _axis_added(request, id, command)
    if not command.seen and not command.everything:
        return Editing(command, message=Sentence(MARK_SOME), is_refused=True, past=command.past)
    if command.do in ("copy", "remove"):
        return await _set_changed(request, id, command)
    return await _axes_changed(request, id, command)


async def _apply(
    request: Request, id: str, make: Callable[[Machine], Plan], *, dry: bool, editing: Editing, past: tuple[str, ...]
) -> Editing:
    """Content of the page after a change, or with its effect only if `dry`."""
    plans: list[Plan] = []

    def plan(machine: Machine) -> Change:
        plans.append(make(machine))
        return plans[-1].change

    if dry:
        machine = await editable(request, id)
        await compute(request, "pages" if len(machine.items) <= FEW_AXES else "batches", plan, machine)
        return replace(editing, plan=plans[-1], past=past)
    await apply(request, id, plan)
    return Editing(plan=plans[-1], message=Sentence(CHANGED), past=_with(past, plans[-1].undo))


def _with(past: tuple[str, ...], undo: Undo) -> tuple[str, ...]:
    return (*past, packed(msgspec.json.encode(undo)))[-MOST_UNDONE:]


async def _axes_changed(request: Request, id: str, command: Command) -> Editing:
    catalogue: Catalogue = request.app.state.catalogue
    inherits = command.do == "inherit" and command.symbol != QUANTITY
    editing, patch = (Editing(command), {}) if inherits else patch_in(command)
    if patch is None:
        return replace(editing, past=command.past)

    def make(machine: Machine) -> Plan:
        axes = _marked_axes(machine, command)
        patches = [(axis, inherited(axis, command.symbol) if inherits else patch) for axis in axes]
        return plan_patches(machine, [(a, p) for a, p in patches if p], catalogue, author_of(request, machine))

    return await _apply(request, id, make, dry=command.do == "dry", editing=editing, past=command.past)


async def _common_changed(request: Request, id: str, command: Command) -> Editing:
    catalogue: Catalogue = request.app.state.catalogue
    form, values = await compute(request, "pages", fields.read, command.pairs, list(fields.PATHS), current())
    editing = Editing(command, common=form, before=command.before)
    if form.problems:
        return replace(editing, past=command.past, message=form.problems[0].message, is_refused=True)
    before = values_in(command.before)
    yours = fields.changes(before, values)
    if not yours:
        return replace(editing, past=command.past, message=Sentence(NOTHING_OTHER))

    def make(machine: Machine) -> Plan:
        now = dict(flat(common_of(machine)))
        if any(now.get(path) not in (before.get(path), value) for path, value in yours.items()):
            raise OvertakenError
        then = {path: value for path, value in {**now, **yours}.items() if value is not None}
        common = Common.model_validate(fields.nested(then)).as_json
        return plan_common(machine, common, catalogue, author_of(request, machine))

    return await _apply(request, id, make, dry=command.do != "apply", editing=editing, past=command.past)


async def _kinds_taken(request: Request, id: str, command: Command) -> Editing:
    """Content of the page after a step of fewest kinds."""
    count, catalogue = dict(command.pairs).get("count", ""), request.app.state.catalogue

    def make(machine: Machine) -> Plan:
        return plan_kinds(machine, int(count) if is_number(count) else 0, catalogue, author_of(request, machine))

    return await _apply(request, id, make, dry=False, editing=Editing(command), past=command.past)


async def _set_changed(request: Request, id: str, command: Command) -> Editing:
    """Content of the page after marked axes were copied or removed."""
    undone: list[Undo] = []

    def make(machine: Machine) -> Change:
        axes, by = _marked_axes(machine, command), author_of(request, machine)
        if command.do == "copy":
            return plan_copies(machine, axes, by)
        plan, undo = plan_removal(machine, axes, by)
        undone.append(undo)
        return plan

    numbers = await apply(request, id, make)
    if undone:
        return Editing(message=Sentence(CHANGED), past=_with(command.past, undone[-1]))
    return _more(numbers, command)


def _more(numbers: Sequence[int], command: Command) -> Editing:
    """Content of the page after axes were added."""
    return Editing(message=Sentence(ADDED), added=tuple(numbers), past=_with(command.past, Undo(added=tuple(numbers))))


async def _axis_added(request: Request, id: str, command: Command) -> Editing:
    """Content of the page after an axis was added: without own values, or with those of another axis."""
    fields, catalogue = dict(command.pairs), request.app.state.catalogue
    name, number = fields.get("name", "").strip() or None, fields.get("like", "")

    def make(machine: Machine) -> Change:
        like = axes_by_number(machine, [int(number)])[0] if is_number(number) else None
        return plan_addition(machine, name, like, catalogue, author_of(request, machine))

    return _more(await apply(request, id, make, [int(number)] if is_number(number) else []), command)


def _marked_axes(machine: Machine, command: Command) -> list[SavedAxis]:
    """Marked axes; raises OvertakenError if one was changed or removed since the page showed it."""
    if command.everything:
        return list(machine.items)
    there = {axis.number: axis.version for axis in machine.items}
    if overtaken := [number for number, version in command.seen.items() if there.get(number) != version]:
        raise OvertakenError(overtaken)
    return axes_by_number(machine, list(command.seen))


async def _undo(request: Request, id: str, command: Command) -> Editing:
    """Content of the page after the last change was undone."""
    catalogue: Catalogue = request.app.state.catalogue
    try:
        undo = msgspec.json.decode(unpacked(command.past[-1].encode()), type=Undo)
    except (msgspec.DecodeError, msgspec.ValidationError):
        raise Problem(422, "past is not what this page has given") from None
    await editable(request, id, [])
    store = request.app.state.store
    removed_axes = [axis for n in undo.removed if (axis := await store.removed_axis(id, n)) is not None]

    def make(machine: Machine) -> Change:
        return plan_undo(machine, undo, removed_axes, catalogue, author_of(request, machine))[0]

    await apply(request, id, make)
    if undo.order:
        await apply(request, id, lambda machine: _in_order(machine, undo.order), [])
    return Editing(message=Sentence(UNDONE), past=command.past[:-1])


def _in_order(machine: Machine, order: Sequence[int]) -> Change:
    """Change that restores the order of axes that still exist; new axes stay at the end."""
    there = set(machine.order)
    again = [number for number in order if number in there]
    return Change(machine.version, None, order=[*again, *(number for number in machine.order if number not in again)])


async def _overtaken(request: Request, id: str, command: Command, error: OvertakenError) -> Editing:
    """Content of the page after somebody else was faster: their values in the table, yours in the fields."""
    if command.do == "undo":
        return Editing(
            message=Sentence(NOT_UNDONE), is_refused=True, overtaken=error.numbers or (0,), past=command.past[:-1]
        )
    editing = Editing(
        command, message=Sentence(OVERTAKEN), is_refused=True, overtaken=error.numbers or (0,), past=command.past
    )
    if command.target != "common":
        return replace(
            patch_in(command)[0],
            message=editing.message,
            is_refused=True,
            overtaken=editing.overtaken,
            past=command.past,
        )
    machine = await machine_of(request, id, [], "machine")
    before, now = values_in(command.before), dict(flat(common_of(machine)))
    form, values = fields.read(command.pairs, list(fields.PATHS), current())
    yours = fields.changes(before, values)
    theirs = tuple(
        FieldProblem(name, None, Sentence(THEIRS, {"value": _value(name, now)}))
        for name, path in fields.PATHS.items()
        if path in yours and now.get(path) not in (before.get(path), yours[path])
    )
    mixed = {path: value for path, value in {**now, **yours}.items() if value is not None}
    form = replace(fields.form_of(mixed, current(), has_tolerances=True), problems=theirs)
    return replace(editing, common=form, before=packed(json_of(now)))


THEIRS = N_("somebody else has set {value} since")


def _value(name: str, values: Mapping[str, Any]) -> str:
    """Text of a common value in a field; a dash if it is not set."""
    path = fields.PATHS[name]
    if path not in values:
        return "–"
    form = fields.form_of({path: values[path]}, current(), has_tolerances=True)
    return ", ".join(form.lists.get(name, ())) or form.texts.get(name, "")


async def lead_back(request: Request) -> Response:
    """Redirect to the machine with the same axes: the address of changes has no page."""
    path = f"{ADDRESS}/{request.path_params['machine']}"
    return RedirectResponse(RowChoice.of(request.query_params).address(path), 303)


router = APIRouter(include_in_schema=False, dependencies=[needs("fleet")])
router.add_api_route(f"{ADDRESS}/{{machine}}/change", change, methods=["POST"], dependencies=[admit("deleting")])
router.add_api_route(f"{ADDRESS}/{{machine}}/change", lead_back, dependencies=[admit("reading")])

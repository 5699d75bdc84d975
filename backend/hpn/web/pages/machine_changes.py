"""Changes of a machine from its page: common values, marked axes, copies, removal and undo, each with its effect said
before. What is changed, and what for, is `hpn.web.edits`, which REST uses, too.
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
    named,
    plan_addition,
    plan_common,
    plan_copies,
    plan_kinds,
    plan_patches,
    plan_removal,
    plan_undo,
)
from hpn.web.form import common as fields
from hpn.web.form.given import FieldProblem
from hpn.web.long_work import EVENTS, CountedAnswer, given_up_at_end
from hpn.web.machines import FEW_AXES, apply, author_of, editable, found
from hpn.web.pages.machine import EMPTY, shown
from hpn.web.pages.machine_editing import (
    MOST_UNDONE,
    QUANTITY,
    Editing,
    Sent,
    inherited,
    is_number,
    patch_in,
    values_in,
)
from hpn.web.pages.machine_view import ADDRESS, REASON
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
    """Says the effect of a change, or makes it, and shows the machine as it then is; with the count of its axes on the
    way for who takes events.
    """
    require_same_origin(request)
    sent = Sent.of(pairs_of(await read_form(request)))
    await editable(request, request.path_params["machine"], [])
    if EVENTS in request.headers.get("accept", ""):
        return CountedAnswer(request, lambda: or_reason(REASON)(partial(_answered, sent=sent))(request))
    with given_up_at_end():
        return await _answered(request, sent)


async def _answered(request: Request, sent: Sent) -> Response:
    id = request.path_params["machine"]
    await found(request, id, [], "machine")
    try:
        editing = await _changed(request, id, sent)
    except OvertakenError as error:
        editing = await _overtaken(request, id, sent, error)
    except ValidationError as error:
        told = Sentence("{text}", {"text": Problem.of(error).errors[0].text})
        editing = Editing(sent, said=told, is_refused=True, past=sent.past)
    machine = await found(request, id, None, "machine")
    status = 409 if editing.overtaken else 422 if editing.is_refused else 200
    return await shown(request, machine, status, EMPTY, editing)


async def _changed(request: Request, id: str, sent: Sent) -> Editing:
    if sent.do == "undo" and sent.past:
        return await _undone(request, id, sent)
    if sent.do == "kinds":
        return await _kinds_taken(request, id, sent)
    if sent.target == "common":
        return await _common_changed(request, id, sent)
    if sent.do == "add":
        return await _axis_added(request, id, sent)
    if not sent.seen and not sent.everything:
        return Editing(sent, said=Sentence(MARK_SOME), is_refused=True, past=sent.past)
    if sent.do in ("copy", "remove"):
        return await _set_changed(request, id, sent)
    return await _axes_changed(request, id, sent)


async def _planned(
    request: Request, id: str, make: Callable[[Machine], Plan], *, dry: bool, editing: Editing, past: tuple[str, ...]
) -> Editing:
    """The page after a change, or with its effect alone."""
    plans: list[Plan] = []

    def made(machine: Machine) -> Change:
        plans.append(make(machine))
        return plans[-1].change

    if dry:
        machine = await editable(request, id)
        await compute(request, "pages" if len(machine.items) <= FEW_AXES else "batches", made, machine)
        return replace(editing, plan=plans[-1], past=past)
    await apply(request, id, made)
    return Editing(plan=plans[-1], said=Sentence(CHANGED), past=_with(past, plans[-1].undo))


def _with(past: tuple[str, ...], undo: Undo) -> tuple[str, ...]:
    return (*past, packed(msgspec.json.encode(undo)))[-MOST_UNDONE:]


async def _axes_changed(request: Request, id: str, sent: Sent) -> Editing:
    catalogue: Catalogue = request.app.state.catalogue
    inherits = sent.do == "inherit" and sent.symbol != QUANTITY
    editing, patch = (Editing(sent), {}) if inherits else patch_in(sent)
    if patch is None:
        return replace(editing, past=sent.past)

    def make(machine: Machine) -> Plan:
        axes = _marked(machine, sent)
        patches = [(axis, inherited(axis, sent.symbol) if inherits else patch) for axis in axes]
        return plan_patches(machine, [(a, p) for a, p in patches if p], catalogue, author_of(request, machine))

    return await _planned(request, id, make, dry=sent.do == "dry", editing=editing, past=sent.past)


async def _common_changed(request: Request, id: str, sent: Sent) -> Editing:
    catalogue: Catalogue = request.app.state.catalogue
    form, values = await compute(request, "pages", fields.read, sent.pairs, list(fields.PATHS), current())
    editing = Editing(sent, common=form, before=sent.before)
    if form.problems:
        return replace(editing, past=sent.past, said=form.problems[0].message, is_refused=True)
    before = values_in(sent.before)
    yours = fields.changed(before, values)
    if not yours:
        return replace(editing, past=sent.past, said=Sentence(NOTHING_OTHER))

    def make(machine: Machine) -> Plan:
        now = dict(flat(common_of(machine)))
        if any(now.get(path) not in (before.get(path), value) for path, value in yours.items()):
            raise OvertakenError
        then = {path: value for path, value in {**now, **yours}.items() if value is not None}
        common = Common.model_validate(fields.nested(then)).sent
        return plan_common(machine, common, catalogue, author_of(request, machine))

    return await _planned(request, id, make, dry=sent.do != "apply", editing=editing, past=sent.past)


async def _kinds_taken(request: Request, id: str, sent: Sent) -> Editing:
    """The page after a step of fewest kinds was taken."""
    count, catalogue = dict(sent.pairs).get("count", ""), request.app.state.catalogue

    def make(machine: Machine) -> Plan:
        return plan_kinds(machine, int(count) if is_number(count) else 0, catalogue, author_of(request, machine))

    return await _planned(request, id, make, dry=False, editing=Editing(sent), past=sent.past)


async def _set_changed(request: Request, id: str, sent: Sent) -> Editing:
    """Copies of axes, or axes removed."""
    undone: list[Undo] = []

    def make(machine: Machine) -> Change:
        axes, by = _marked(machine, sent), author_of(request, machine)
        if sent.do == "copy":
            return plan_copies(machine, axes, by)
        made, undo = plan_removal(machine, axes, by)
        undone.append(undo)
        return made

    numbers = await apply(request, id, make)
    if undone:
        return Editing(said=Sentence(CHANGED), past=_with(sent.past, undone[-1]))
    return _more(numbers, sent)


def _more(numbers: Sequence[int], sent: Sent) -> Editing:
    """The page after axes were added."""
    return Editing(said=Sentence(ADDED), added=tuple(numbers), past=_with(sent.past, Undo(added=tuple(numbers))))


async def _axis_added(request: Request, id: str, sent: Sent) -> Editing:
    """The page after one more axis: without values of its own, or with those of another."""
    fields, catalogue = dict(sent.pairs), request.app.state.catalogue
    name, number = fields.get("name", "").strip() or None, fields.get("like", "")

    def make(machine: Machine) -> Change:
        like = named(machine, [int(number)])[0] if is_number(number) else None
        return plan_addition(machine, name, like, catalogue, author_of(request, machine))

    return _more(await apply(request, id, make, [int(number)] if is_number(number) else []), sent)


def _marked(machine: Machine, sent: Sent) -> list[SavedAxis]:
    """Axes that are marked, as they were seen; raises OvertakenError where one was changed or removed since."""
    if sent.everything:
        return list(machine.items)
    there = {axis.number: axis.version for axis in machine.items}
    if lost := [number for number, version in sent.seen.items() if there.get(number) != version]:
        raise OvertakenError(lost)
    return named(machine, list(sent.seen))


async def _undone(request: Request, id: str, sent: Sent) -> Editing:
    """The page after the last change was undone."""
    catalogue: Catalogue = request.app.state.catalogue
    try:
        undo = msgspec.json.decode(unpacked(sent.past[-1].encode()), type=Undo)
    except (msgspec.DecodeError, msgspec.ValidationError):
        raise Problem(422, "past is not what this page has given") from None
    await editable(request, id, [])
    store = request.app.state.store
    gone = [axis for n in undo.removed if (axis := await store.removed_axis(id, n)) is not None]

    def make(machine: Machine) -> Change:
        return plan_undo(machine, undo, gone, catalogue, author_of(request, machine))[0]

    await apply(request, id, make)
    if undo.order:
        await apply(request, id, lambda machine: _in_order(machine, undo.order), [])
    return Editing(said=Sentence(UNDONE), past=sent.past[:-1])


def _in_order(machine: Machine, order: Sequence[int]) -> Change:
    """Axes in the order that they had, as far as they are there; those that are new stay behind."""
    there = set(machine.order)
    again = [number for number in order if number in there]
    return Change(machine.version, None, order=[*again, *(number for number in machine.order if number not in again)])


async def _overtaken(request: Request, id: str, sent: Sent, error: OvertakenError) -> Editing:
    """The page where somebody else was faster: theirs in the table, yours in the fields."""
    if sent.do == "undo":
        return Editing(said=Sentence(NOT_UNDONE), is_refused=True, overtaken=error.numbers or (0,), past=sent.past[:-1])
    told = Editing(sent, said=Sentence(OVERTAKEN), is_refused=True, overtaken=error.numbers or (0,), past=sent.past)
    if sent.target != "common":
        return replace(patch_in(sent)[0], said=told.said, is_refused=True, overtaken=told.overtaken, past=sent.past)
    machine = await found(request, id, [], "machine")
    before, now = values_in(sent.before), dict(flat(common_of(machine)))
    form, values = fields.read(sent.pairs, list(fields.PATHS), current())
    yours = fields.changed(before, values)
    theirs = tuple(
        FieldProblem(name, None, Sentence(THEIRS, {"value": _told(name, now)}))
        for name, path in fields.PATHS.items()
        if path in yours and now.get(path) not in (before.get(path), yours[path])
    )
    mixed = {path: value for path, value in {**now, **yours}.items() if value is not None}
    form = replace(fields.form_of(mixed, current(), has_tolerances=True), problems=theirs)
    return replace(told, common=form, before=packed(json_of(now)))


THEIRS = N_("somebody else has set {value} since")


def _told(name: str, values: Mapping[str, Any]) -> str:
    """A common value as a field shows it."""
    path = fields.PATHS[name]
    if path not in values:
        return "–"
    form = fields.form_of({path: values[path]}, current(), has_tolerances=True)
    return ", ".join(form.lists.get(name, ())) or form.texts.get(name, "")


async def lead_back(request: Request) -> Response:
    """Leads to the machine: a change is sent, not opened."""
    return RedirectResponse(f"{ADDRESS}/{request.path_params['machine']}", 303)


router = APIRouter(include_in_schema=False, dependencies=[needs("fleet")])
router.add_api_route(f"{ADDRESS}/{{machine}}/change", change, methods=["POST"], dependencies=[admit("deleting")])
router.add_api_route(f"{ADDRESS}/{{machine}}/change", lead_back, dependencies=[admit("reading")])

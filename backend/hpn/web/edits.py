"""Changes of a machine's axes and common values, by REST and pages, and their effect on its gears."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal, NamedTuple

import msgspec
from starlette.requests import Request

from hpn.catalogue import Catalogue
from hpn.documents.answers import AxisQuestion
from hpn.documents.axis import Axis
from hpn.documents.gears import OrderAxis, gears_of, motor_of
from hpn.documents.kinds import MachineKinds, Sought, kinds_of
from hpn.documents.merge import resolve
from hpn.store import AxisDraft, Change, Machine, SavedAxis
from hpn.web.columns import columns_of, common_of, draft_of, drafts_of, json_of, own_of, resolved, without_of
from hpn.web.door.problems import Problem
from hpn.web.long_work import answers_in_steps
from hpn.web.machines import answers_under, apply, author_of, no_axis, patched

Json = dict[str, Any]


class Effect(NamedTuple):
    """Effect of a change: number of its axes, axes with another gear, axes without one, gear mass before and after."""

    axes: int
    other_gear: tuple[int, ...]
    without_gear: tuple[int, ...]
    weight_before_kg: float | None
    weight_kg: float | None


def axes_by_number(machine: Machine, numbers: Sequence[int] | Literal["all"]) -> list[SavedAxis]:
    """Axes by their numbers; Problem 422 for an unknown number."""
    by_number = {axis.number: axis for axis in machine.items}
    chosen_numbers = list(by_number) if numbers == "all" else list(dict.fromkeys(numbers))
    if missing := [number for number in chosen_numbers if number not in by_number]:
        detail = f"names {missing[0]}, which is no axis of this machine"
        raise Problem(422, f"numbers {detail}", [(("numbers",), detail)])
    return [by_number[number] for number in chosen_numbers]


FIELDS = ("name", "quantity", "note", "ordering_code", "without", "application")
"""Own values of an axis."""


def own_values(axis: SavedAxis) -> dict[str, Any]:
    """Present own values of an axis."""
    same = {name: getattr(axis, name) for name in ("name", "quantity", "note", "ordering_code")}
    return same | {"without": without_of(axis), "application": own_of(axis)}


def after(axis: SavedAxis, patch: Mapping[str, Any]) -> dict[str, Any]:
    """Own values of an axis after a merge patch; ValidationError for an invalid new value."""
    now = own_values(axis)
    changed = {name: patched(now[name], value) for name, value in patch.items() if name in FIELDS}
    checked = Axis.model_validate({name: value for name, value in changed.items() if value is not None})
    return now | {name: getattr(checked, name) for name in changed}


def drafted(
    axes: list[tuple[SavedAxis, dict[str, Any]]], common: Mapping[str, Any], catalogue: Catalogue
) -> list[AxisDraft]:
    """Drafts of axes with other own values, all answered together."""
    questions = (AxisQuestion(resolve(v["application"], common, v["without"]), v["ordering_code"]) for _, v in axes)
    replies = answers_in_steps(questions, len(axes), catalogue)
    return [draft_of(Axis.model_construct(**v), answer) for (_, v), answer in zip(axes, replies, strict=True)]


async def replace_axis(
    request: Request,
    id: str,
    number: int,
    values: Callable[[SavedAxis], dict[str, Any]],
    require: Callable[[Machine, SavedAxis], None],
) -> None:
    """Give an axis other own values; `require` raises Problem 412 if the axis has changed since its editor saw it.

    Raises Problem as `apply` does, and 404 for an unknown axis.
    """
    catalogue: Catalogue = request.app.state.catalogue

    def make(machine: Machine) -> Change:
        if not machine.items:
            raise no_axis(number)
        (axis,) = machine.items
        require(machine, axis)
        draft = drafted([(axis, values(axis))], common_of(machine), catalogue)[0]
        return Change(machine.version, author_of(request, machine), changed=[(number, axis.version, draft)])

    await apply(request, id, make, [number])


def effect_of(machine: Machine, drafts: Mapping[int, AxisDraft], catalogue: Catalogue) -> Effect:
    """Effect of a change on the gears of a machine."""
    now = {axis.number: axis for axis in machine.items}
    other = [n for n, draft in drafts.items() if draft.answer["designation"] != now[n].answer["designation"]]
    without = [n for n, draft in drafts.items() if draft.answer["selected"] is None and draft.ordering_code is None]
    before, then = (
        gears_of((order_axis(number, axis) for number, axis in axes.items()), catalogue).weight_kg
        for axes in (now, {**now, **drafts})
    )
    return Effect(len(drafts), tuple(other), tuple(without), before, then)


def order_axis(number: int, axis: AxisDraft) -> OrderAxis:
    """Data of an axis that count for the order of gears."""
    return OrderAxis(number, axis.quantity, axis.ordering_code, axis.answer["selected"], motor_of(axis.application))


# --- Fewest kinds -----------------------------------------------------------------------------------------------------


def kinds_in(machine: Machine, catalogue: Catalogue, most: int | None = None) -> MachineKinds:
    """Fewest kinds of gears for the answered axes of a machine."""
    common = common_of(machine)
    pairs = ((axis, resolved(axis, common).application) for axis in machine.items)
    sought = [
        Sought(axis.number, axis.quantity, application, axis.answer["designation"])
        for axis, application in pairs
        if application is not None and axis.answer["status"] != "open"
    ]
    return kinds_of(sought, catalogue, most=most)


# --- Changes that can be undone ---------------------------------------------------------------------------------------


class AxesPatch(msgspec.Struct, frozen=True):
    """Merge patch of some axes; applies only while they still have the values of the merge patch `left`."""

    numbers: tuple[int, ...]
    patch: Json
    left: Json


class Undo(msgspec.Struct, frozen=True, omit_defaults=True):
    """Inverse of a change: patches, common values after and before it, axes to remove, and axes to restore."""

    patches: tuple[AxesPatch, ...] = ()
    common: tuple[Json, Json] | None = None
    added: tuple[int, ...] = ()
    removed: tuple[int, ...] = ()
    order: tuple[int, ...] = ()


class Plan(NamedTuple):
    """Planned change, its inverse, its effect, and the gears of its axes by their numbers."""

    change: Change
    undo: Undo
    effect: Effect
    gears: Mapping[int, str | None]


class OvertakenError(Exception):
    """Others have changed the same since: axes by their numbers, or, without any, common values of the machine."""

    def __init__(self, numbers: Sequence[int] = ()) -> None:
        super().__init__("others have changed this since")
        self.numbers = tuple(numbers)


def plan_patches(
    machine: Machine, patches: Sequence[tuple[SavedAxis, Json]], catalogue: Catalogue, by: str | None
) -> Plan:
    """Plan of merge patches, one for each axis."""
    drafts = drafted([(axis, after(axis, patch)) for axis, patch in patches], common_of(machine), catalogue)
    changed = [(axis.number, axis.version, draft) for (axis, _), draft in zip(patches, drafts, strict=True)]
    back: dict[bytes, tuple[list[int], Json, Json]] = {}
    for axis, patch in patches:
        other = inverse(own_values(axis), patch)
        back.setdefault(json_of({"back": other, "patch": patch}), ([], other, patch))[0].append(axis.number)
    undo = Undo(tuple(AxesPatch(tuple(numbers), other, patch) for numbers, other, patch in back.values()))
    by_number = {number: draft for number, _, draft in changed}
    return Plan(
        Change(machine.version, by, changed=changed), undo, effect_of(machine, by_number, catalogue), _gears(by_number)
    )


def plan_common(machine: Machine, common: Json, catalogue: Catalogue, by: str | None) -> Plan:
    """Plan of other common values."""
    replies = answers_under(machine, common, catalogue)
    values = {"common": msgspec.json.encode(common).decode()}
    axes = {
        axis.number: replace(axis, answer=answer) for axis, (_, _, answer) in zip(machine.items, replies, strict=True)
    }
    undo = Undo(common=(common, common_of(machine)))
    change = Change(machine.version, by, values, answered=replies)
    return Plan(change, undo, effect_of(machine, axes, catalogue), _gears(axes))


def plan_kinds(machine: Machine, count: int, catalogue: Catalogue, by: str | None) -> Plan:
    """Plan of the step with `count` kinds: a changed axis takes size and ratio of its new gear as own values.

    Raises Problem 422 if no step has this number of kinds.
    """
    step = next((each for each in kinds_in(machine, catalogue).kinds if each.count == count), None)
    if step is None:
        raise Problem(422, f"{count} is no number of kinds that serves every axis")
    there = {axis.number: axis for axis in machine.items}
    patches = []
    for change in step.changes:
        gear, axis = catalogue.by_designation[change.gear_to], there[change.axis]
        patch: Json = {"application": {"requirements": {"sizes": [gear.size], "ratios": [gear.ratio]}}}
        patches.append((axis, patch if axis.ordering_code is None else patch | {"ordering_code": None}))
    return plan_patches(machine, patches, catalogue, by)


def plan_copies(machine: Machine, axes: Sequence[SavedAxis], by: str | None) -> Change:
    """Change that appends copies of axes."""
    same = AxisDraft.__dataclass_fields__
    return Change(machine.version, by, new=[AxisDraft(**{n: getattr(axis, n) for n in same}) for axis in axes])


def plan_addition(
    machine: Machine, name: str | None, like: SavedAxis | None, catalogue: Catalogue, by: str | None
) -> Change:
    """Change that appends an axis: without own values, or with those of the axis `like`.

    Raises ValidationError for an invalid name.
    """
    if like is None:
        new = drafts_of([Axis(name=name)], common_of(machine), catalogue)
    else:
        copy = plan_copies(machine, [like], by).new[0]
        new = [replace(copy, name=Axis(name=name).name or like.name)]
    return Change(machine.version, by, new=new)


def plan_removal(machine: Machine, axes: Sequence[SavedAxis], by: str | None) -> tuple[Change, Undo]:
    """Change that removes axes, and its inverse, which restores them by their numbers."""
    rows = [(axis.number, axis.version) for axis in axes]
    return Change(machine.version, by, removed=rows), Undo(removed=tuple(n for n, _ in rows), order=machine.order)


def plan_undo(
    machine: Machine, undo: Undo, gone: Sequence[SavedAxis], catalogue: Catalogue, by: str | None
) -> tuple[Change, Undo]:
    """Change that undoes another, and its own inverse; raises OvertakenError if others have changed the same since.

    `gone` are the axes to be restored.
    """
    there = {axis.number: axis for axis in machine.items}
    if undo.common is not None:
        if common_of(machine) != undo.common[0]:
            raise OvertakenError
        return plan_common(machine, undo.common[1], catalogue, by)[:2]
    if undo.patches:
        patches = [(number, each) for each in undo.patches for number in each.numbers]
        overtaken = [n for n, each in patches if n not in there or not _is_left(own_values(there[n]), each.left)]
        if overtaken:
            raise OvertakenError(overtaken)
        return plan_patches(machine, [(there[n], each.patch) for n, each in patches], catalogue, by)[:2]
    if undo.added:
        return plan_removal(machine, [there[number] for number in undo.added if number in there], by)
    common = common_of(machine)
    questions = (AxisQuestion(resolved(axis, common), axis.ordering_code) for axis in gone)
    replies = answers_in_steps(questions, len(gone), catalogue)
    back = [(axis.number, columns_of(answer)) for axis, answer in zip(gone, replies, strict=True)]
    return Change(machine.version, by, restored=back), Undo(added=tuple(number for number, _ in back))


def inverse(target: Any, patch: Mapping[str, Any]) -> Json:
    """Merge patch that undoes another one on a value; `target` is the value before both."""
    back: Json = {}
    for name, value in patch.items():
        before = target.get(name) if isinstance(target, Mapping) else None
        is_part = isinstance(value, Mapping) and isinstance(before, Mapping)
        back[name] = inverse(before, value) if is_part else before
    return back


def _is_left(own: Json, patch: Json) -> bool:
    """True if an axis still has the values of a patch."""
    return all(_same(own.get(name), patched(own.get(name), value)) for name, value in patch.items())


def _same(one: Any, other: Any) -> bool:
    return list(one or ()) == list(other or ()) if isinstance(one, list | tuple) else one == other


def _gears(axes: Mapping[int, AxisDraft]) -> dict[int, str | None]:
    return {number: axis.answer["selected"] and axis.answer["designation"] for number, axis in axes.items()}

"""Notes on a result, grouped by their use to the reader: decisions, assumptions, missing ratings, information."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from hpn.catalogue import Catalogue
from hpn.engine.notice import Notice
from hpn.words.wording import N_

Group = Literal["decide", "assumed", "unrated", "known"]

GROUPS: Mapping[Group, str] = {
    "decide": N_("Decide"),
    "assumed": N_("Assumed"),
    "unrated": N_("Not rated"),
    "known": N_("Good to know"),
}
"""Groups in their order, with their headings."""


@dataclass(frozen=True, slots=True)
class Action:
    """Action on a note: type an input there, press a button of the form, go to an input, or see a page.

    `what` is the name of the input, the button's value, or the address.
    """

    kind: Literal["type", "press", "go", "see"]
    what: str
    label: str = ""


@dataclass(frozen=True, slots=True)
class Note:
    """Notice with the subject that it touches (a msgid), and the actions on it."""

    notice: Notice
    touches: str
    actions: tuple[Action, ...]


@dataclass(frozen=True, slots=True)
class NoteGroup:
    """Notes of one group; `title` is a msgid."""

    code: Group
    title: str
    notes: tuple[Note, ...]


_BEARING, _MOTOR, _STOP = N_("output bearing"), N_("motor torques"), N_("emergency stop")
_POSITION, _MOTION, _LIMIT = N_("position error"), N_("motion"), N_("torque limit of the drive")
_LIFE, _SPEED, _CATALOGUE, _USE = N_("gear life"), N_("average input speed"), N_("catalogue"), N_("place of use")

_CHECK = N_("Check it")
_EFFICIENCY = Action("type", "eta", N_("Calculate"))
_GO = {
    "Tk": N_("Change T_k"),
    "xR": N_("Give positions"),
    "TL": N_("Give the load’s torque"),
    "TB": N_("Change the brake"),
    "Jm": N_("Give the inertias"),
    "FR": N_("Change the loads"),
    "FA": N_("Change the loads"),
}


def _go(name: str) -> Action:
    return Action("go", name, _GO[name])


_NOTES: Mapping[str, tuple[Group, str, tuple[Action, ...]]] = {
    "motion_triangle": ("assumed", _MOTION, ()),
    "motion_left_off": ("decide", _MOTION, ()),
    "friction_without_effect": ("known", _MOTION, (Action("go", "Ff", N_("Give the friction force")),)),
    "shaft_load_of_motion": ("decide", _BEARING, (Action("press", "from_motion", N_("Count it")),)),
    "shaft_load_counted": ("assumed", _BEARING, ()),
    "stop_radial_above_limit": ("decide", _BEARING, ()),
    "tolerances_of_motion_sampled": ("known", _MOTION, ()),
    "application_area": ("decide", _USE, ()),
    "emergency_stop_below_maximum": ("decide", _STOP, (_go("Tk"),)),
    "momentary_peak_count_unlimited": ("known", _STOP, ()),
    "stops_not_counted": ("decide", _STOP, (Action("type", "Nk", _CHECK),)),
    "bearing_life_at_default": ("decide", _BEARING, (Action("type", "Lb", _CHECK),)),
    "radial_load_not_used": ("decide", _BEARING, (_go("FR"),)),
    "axial_load_not_used": ("decide", _BEARING, (_go("FA"),)),
    "life_unlimited": ("known", _LIFE, ()),
    "bearing_envelope_supplied": ("known", _BEARING, ()),
    "speed_above_average": ("decide", _SPEED, ()),
    "bearing_envelope_computed": ("assumed", _BEARING, (Action("press", "iso281", N_("Use ISO 281")),)),
    "bearing_iso281": ("assumed", _BEARING, (Action("press", "linear", N_("Use the straight line")),)),
    "bearing_load_position": ("assumed", _BEARING, (_go("xR"),)),
    "bearing_lever": ("assumed", _BEARING, ()),
    "bearing_centre_unknown": ("decide", _BEARING, (Action("type", "xc", _CHECK),)),
    "bearing_life_basis": ("assumed", _BEARING, (Action("press", "by_L10", N_("Judge by L10")),)),
    "bearing_life_unlimited": ("known", _BEARING, ()),
    "efficiency_assumed": ("assumed", _MOTOR, ()),
    "efficiency_supplied": ("assumed", _MOTOR, ()),
    "efficiency_beyond_curve": ("assumed", _MOTOR, ()),
    "efficiency_unknown": ("decide", _MOTOR, (_EFFICIENCY,)),
    "motor_torque_partial": ("assumed", _MOTOR, ()),
    "rotor_not_included": ("assumed", _MOTOR, ()),
    "motor_losses_included": ("known", _MOTOR, ()),
    "motor_inertia_included": ("assumed", _MOTOR, ()),
    "motor_all_included": ("known", _MOTOR, ()),
    "limit_without_efficiency": ("assumed", _LIMIT, ()),
    "limit_below_need": ("decide", _LIMIT, ()),
    "gear_below_motor": ("decide", _LIMIT, ()),
    "pairs_not_mated": ("assumed", _MOTOR, ()),
    "no_ratio_for_motor": ("decide", _MOTOR, ()),
    "motor_figures_unknown": ("decide", _MOTOR, ()),
    "motor_inertia_unknown": ("decide", _MOTOR, ()),
    "torque_signs_not_given": ("decide", _POSITION, (Action("press", "one_way", N_("No torque reverses")),)),
    "torque_range_not_given": ("decide", _POSITION, ()),
    "ramp_shorter_than_period": ("decide", _MOTION, ()),
    "brake_does_not_hold": ("decide", _STOP, (_go("TB"),)),
    "brake_bound": ("assumed", _STOP, ()),
    "brake_factor_typed": ("assumed", _STOP, ()),
    "brake_efficiency_unknown": ("decide", _STOP, (_EFFICIENCY,)),
    "brake_without_load": ("decide", _STOP, (_go("TL"),)),
    "brake_while_accelerating": ("assumed", _STOP, ()),
    "counterweight_slack": ("decide", _STOP, (_go("TB"),)),
    "brake_inertia_unknown": ("decide", _STOP, (_go("Jm"),)),
    "size_unrated": ("unrated", _CATALOGUE, (Action("see", "", N_("Enter its figures")),)),
    "catalogue_supplement": ("known", _CATALOGUE, ()),
}
"""Group, subject and actions of each notice by its code."""

_OTHER: tuple[Group, str, tuple[Action, ...]] = ("known", "", ())
"""Group, subject and actions of a notice of another version."""


def note_groups(notices: Iterable[Notice], catalogue: Catalogue | None) -> list[NoteGroup]:
    """Notes by group; an input is typed beside the first note that asks for it."""
    groups: dict[Group, list[Note]] = {group: [] for group in GROUPS}
    typed = set[str]()
    for notice in notices:
        group, touches, actions = _NOTES.get(notice.code, _OTHER)
        offered = [_addressed(one, notice, catalogue) for one in actions if one.kind != "type" or one.what not in typed]
        typed.update(one.what for one in offered if one.kind == "type")
        complete = tuple(one for one in offered if one.what)
        groups[group].append(Note(notice, touches, complete))
    return [NoteGroup(group, GROUPS[group], tuple(notes)) for group, notes in groups.items() if notes]


def _addressed(action: Action, notice: Notice, catalogue: Catalogue | None) -> Action:
    """Action with the page of the gear that the notice names; without an address if the catalogue lacks the gear."""
    if action.kind != "see":
        return action
    first = str(notice.values.get("name") or notice.values.get("names") or "").split(",")[0]
    gears: Sequence[str] = [] if catalogue is None else list(catalogue.by_designation)
    named = next((gear for gear in gears if first and (gear == first or gear.startswith(f"{first}-"))), None)
    return Action("see", f"/catalogue/{named}" if named else "", action.label)


_END = re.compile(r"(?<=[\w)\]%’])(?:[:;]|(?<!\b\w)\.(?=\s+[A-ZÄÖÜ]))\s+")
"""End of the first part of a notice; not the full stops of "eq. 17.9" and "z. B."."""


_WORD = re.compile(r"[a-zäöüß]+(?![_\w])")
"""Word that gets a capital at the beginning of a sentence; not a symbol with an index."""


def head_and_reason(text: str) -> tuple[str, str]:
    """Claim of a notice, up to the first colon, semicolon or full stop of its text and without it, and the rest as a
    sentence."""
    end = _END.search(text)
    if end is None:
        return text.removesuffix("."), ""
    reason = text[end.end() :]
    begins = _WORD.match(reason)
    return text[: end.end()].rstrip(" :;."), reason[:1].upper() + reason[1:] if begins else reason

"""Texts by code for a refused motion or body, with the bound that would be accepted."""

from collections.abc import Mapping

from pydantic_core import PydanticCustomError

from hpn.words.wording import N_, Quantity

REFUSALS: Mapping[str, str] = {
    "way_zero": N_("must not be 0: use a dwell for a standstill"),
    "way_vanishing": N_("must be at least 1e-12 in magnitude"),
    "move_needs": N_("a move with the profile {profile} needs {field}"),
    "move_has_no": N_("a move with the profile {profile} has no {field}: leave it out"),
    "move_takes_two": N_(
        "a move with the profile {profile} needs a time with or without ramps, a speed with one or two ramps, or both "
        "with at most one ramp (given: {given})"
    ),
    "move_takes_one": N_("a move with the profile {profile} needs one of {fields} (given: {given})"),
    "move_too_slow": N_("must be above {bound} (distance over time); from {triangle} on the move is triangular"),
    "move_too_gentle": N_("must be at least {bound} to cover the distance in this time"),
    "move_too_fast": N_("must be at most {bound}, where the ramps leave no time at constant speed"),
    "ramp_too_long": N_("must be at most {bound} to cover the distance in this time"),
    "ramp_leaves_none": N_("must be below {bound}, so that time is left for the other ramp"),
    "ramp_too_gentle": N_("must be above {bound}, so that time is left for the other ramp"),
    "ramp_twice": N_("replaces {field}: give only one of them"),
    "jerk_too_low": N_("must be at least {bound} for the ramps of this move"),
    "gravity_needs": N_("gravity needs {field} as well"),
    "gravity_inertia": N_("includes the gravity mass and must be at least {bound}, its mass times its radius squared"),
    "counterweight_level": N_("acts along an incline alone: give the incline, or leave the counterweight out"),
    "no_move": N_("nothing moves: give at least one move a profile other than dwell"),
    "motion_torque": N_("the torque at the gear reaches {found} in this move; it may be {bound} at most"),
    "motion_speed": N_("the speed of the gear reaches {found} in this move; it may be {bound} at most"),
    "motion_time": N_("this move takes {found}; a phase may take {bound} at most"),
    "motion_phases": N_("the moves come to {found} phases; a cycle may have {bound} at most"),
    "body_needs": N_("this shape needs {field}"),
    "body_has_no": N_("this shape has no {field}: leave it out"),
    "body_mass": N_("give either the mass or the density"),
    "body_bore": N_("must be below the outer diameter"),
    "motion_turns": N_("with gravity the angles of all moves may add up to {bound} at most; they add up to {found}"),
}
"""English msgids; the values are quantities and texts."""


def refusal(code: str, **values: Quantity | str) -> PydanticCustomError:
    """Error of a code, for a validator to raise."""
    return PydanticCustomError(code, REFUSALS[code], values)

"""Words for values: the choices of an input, the bases of a figure, rankings and verdicts."""

from collections.abc import Mapping
from dataclasses import dataclass

from hpn.words.wording import N_

MECHANISMS: Mapping[str, str] = {
    "rotary": N_("Rotary"),
    "rack_and_pinion": N_("Rack and pinion"),
    "belt": N_("Belt"),
    "ball_screw": N_("Ball screw"),
}
"""Kinds of mechanisms."""

PROFILES: Mapping[str, str] = {
    "trapezoidal": N_("Trapezoidal"),
    "triangular": N_("Triangular"),
    "s_curve": N_("S-curve"),
    "modified_sine": N_("Modified sine"),
    "dwell": N_("Dwell"),
}
"""Profiles of a move."""

SHAPES: Mapping[str, str] = {
    "disc": N_("Disc"),
    "ring": N_("Ring"),
    "bar": N_("Bar"),
    "block": N_("Block"),
    "point_mass": N_("Point mass"),
}
"""Shapes of bodies."""

BEARING_MODELS: Mapping[str, str] = {
    "linear": N_("straight line (safe)"),
    "iso281": N_("ISO 281"),
    "digitised": N_("digitised graph"),
}
"""Models of the bearing envelope."""

ENVELOPE_BASIS: Mapping[str, str] = {
    "linear": N_("Basis: interpolated between the two published limits; printed curve not available."),
    "iso281": N_(
        "Basis: equivalent load of ISO 281 with a constant Y, set by the published axial limit; printed curve not "
        "available."
    ),
    "digitised": N_("Basis: curve points that you supplied; printed curve not available."),
}
"""Basis of the envelope by model."""

LIFE_BASES: Mapping[str, str] = {"L50": N_("L50 (50 % survive)"), "L10": N_("L10 (90 % survive)")}
"""Bases of a bearing life."""

FOR_OTHERS = N_("others")
"""All sizes without their own figure, beside those with one."""

POSITION_ERROR_AT: Mapping[str, str] = {"cycle": N_("over the whole cycle"), "rest": N_("at rest alone")}
"""Parts of the cycle over which the position error counts."""


@dataclass(frozen=True, slots=True)
class Ranking:
    """An order of the suitable gears: its name, its option in the form, and its sentences on the first gear."""

    name: str
    choice: str
    first: str
    first_of: str


JUDGED: Mapping[bool, str] = {False: N_("by the values as given"), True: N_("by the worst case")}
"""Basis of the judgement, by `over_tolerance`."""


RANKINGS: Mapping[str, Ranking] = {
    "weight": Ranking(
        N_("weight"),
        N_("lowest weight"),
        N_("The lightest gear that passes every check."),
        N_("It is the lightest of {count} suitable gears."),
    ),
    "utilisation": Ranking(
        N_("utilisation"),
        N_("largest reserve"),
        N_("The gear with the largest reserve among those that pass every check."),
        N_("It has the largest reserve of {count} suitable gears."),
    ),
    "length": Ranking(
        N_("length"),
        N_("shortest length"),
        N_("The shortest gear that passes every check."),
        N_("It is the shortest of {count} suitable gears."),
    ),
    "motor_torque": Ranking(
        N_("motor torque"),
        N_("lowest motor torque"),
        N_("The gear that needs the least motor torque among those that pass every check."),
        N_("It needs the least motor torque of {count} suitable gears."),
    ),
    "life": Ranking(
        N_("life"),
        N_("longest life"),
        N_("The gear with the longest life among those that pass every check."),
        N_("It has the longest life of {count} suitable gears."),
    ),
    "stiffness": Ranking(
        N_("stiffness"),
        N_("highest stiffness"),
        N_("The stiffest gear that passes every check."),
        N_("It is the stiffest of {count} suitable gears."),
    ),
    "natural_frequency": Ranking(
        N_("natural frequency"),
        N_("highest natural frequency"),
        N_("The gear with the highest natural frequency among those that pass every check."),
        N_("It has the highest natural frequency of {count} suitable gears."),
    ),
    "position_error": Ranking(
        N_("position error"),
        N_("smallest position error"),
        N_("The gear with the smallest position error among those that pass every check."),
        N_("It has the smallest position error of {count} suitable gears."),
    ),
}
"""Rankings by their codes."""

VERDICTS: Mapping[str, str] = {
    "suitable": N_("suitable"),
    "unsuitable": N_("not suitable"),
    "unrated": N_("not rated"),
    "pass": N_("passes"),
    "fail": N_("fails"),
    "not_rated": N_("not rated"),
}
"""Verdicts on candidates and on their checks, in words."""

"""Words for values: the choices of an input, the bases of a figure, and verdicts."""

from collections.abc import Mapping

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

VERDICTS: Mapping[str, str] = {
    "suitable": N_("suitable"),
    "unsuitable": N_("not suitable"),
    "unrated": N_("not rated"),
    "pass": N_("passes"),
    "fail": N_("fails"),
    "not_rated": N_("not rated"),
}
"""Verdicts on candidates and on their checks, in words."""

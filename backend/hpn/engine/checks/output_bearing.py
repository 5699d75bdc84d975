"""Checks of the output bearing: its largest load and its life (ISO 281 between the published limits)."""

import numpy as np

from hpn.engine.check import Case, Check
from hpn.engine.checks.dependence import AVERAGE_SPEED, BEARING, bearing_damages, has_rising_curves
from hpn.physics.equations import ROUNDING, FloatArray
from hpn.words.wording import N_

BEARING_LIMITS = N_("F_R,dyn(max) and F_A,dyn(max), rating tables 10.1 to 12.2")


def _known_or_failing(known: FloatArray, at_least: FloatArray, case: Case, limit: FloatArray) -> FloatArray:
    """A load where it is known, else its lower bound if that already fails, else NaN."""
    fails = at_least > limit * case.inputs["requirements.utilisation"] * (1 + ROUNDING)
    return np.where(np.isnan(known) & fails, at_least, known)


OUTPUT_BEARING: tuple[Check, ...] = (
    Check(
        code="output_bearing_load",
        name=N_("largest load on the output bearing"),
        title=N_("Output bearing: largest load"),
        unit="",
        kind="maximum",
        group="load",
        limit_name=N_("1"),
        source=BEARING_LIMITS,
        tests=N_("In every phase the load times f_w stays inside the envelope of the published maxima."),
        consequence=N_(
            "Balls and raceways are indented, or the shaft deflects so far that the teeth mesh out of alignment."
        ),
        basis=N_(
            "Interpolated between the two published limits; printed curve not available. That the limits belong to "
            "f_w = 1 is our reading. Slower running never enlarges this envelope."
        ),
        remedy=N_("Support the load outside the gear, move it, or choose a larger size."),
        trigger="output_load.load_coefficient",
        demand=lambda c: _known_or_failing(
            c.figures.bearing_load, c.figures.bearing_loads_at_least[0], c, np.ones((1, 1))
        ),
        limit=lambda c: np.ones((1, 1)),
        at_least=lambda c: c.figures.bearing_loads_at_least[0],
        limited_by="dynamic_radial_load_N",
        relation="max f_w · P_i ≤ 1",
        moves={"load": 1.0},
        over=BEARING,
        proven=has_rising_curves,
    ),
    Check(
        code="output_bearing_life",
        name=N_("life of the output bearing"),
        title=N_("Output bearing: life"),
        unit="",
        kind="maximum",
        group="load",
        limit_name=N_("k"),
        source=BEARING_LIMITS,
        tests=N_(
            "The equivalent load f_w P_m of the cycle stays within the load k at which the bearing reaches the "
            "required life at the average output speed."
        ),
        consequence=N_("Pitting of the output bearing: play, noise and leakage at the shaft seal."),
        basis=N_(
            "Life by ISO 281 with exponent 3 from the published condition of 100 rpm and 20000 h as L50. L10 = L50 / "
            "5 is taken from the manufacturer’s other handbooks, not printed in this one. The hours include the pause."
        ),
        remedy=N_("Lower load, speed or required life, choose f_w with more care, or choose a larger size."),
        trigger="output_load.load_coefficient",
        demand=lambda c: _known_or_failing(
            c.figures.bearing_mean_load, c.figures.bearing_loads_at_least[1], c, c.figures.bearing_life_factor
        ),
        limit=lambda c: c.figures.bearing_life_factor,
        at_least=lambda c: c.figures.bearing_loads_at_least[1] / c.figures.bearing_life_factor,
        limited_by="dynamic_radial_load_N",
        relation="f_w · P_m ≤ k",
        moves={"speed": 1 / 3, "load": 1.0},
        over={**BEARING, **AVERAGE_SPEED, "output_load.life_h": "rising"},
        weighted=bearing_damages,
        proven=has_rising_curves,
    ),
)

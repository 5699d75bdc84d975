"""Stiffness and position error, as equations with their numbers."""

import math
from collections.abc import Iterable

from hpn.explain.calculation.formula import Constant, Formula, Root, Sum, Term, Variable
from hpn.explain.calculation.sheet import CalculationSheet, EquationLine, Step, known, step_of_check
from hpn.words.quantities import CANDIDATE
from hpn.words.wording import N_, Quantity, Sentence

PI = Term(Variable("π"), math.pi)
ARCMIN = Constant(10800, "arcmin") / PI


def frequency_steps(sheet: CalculationSheet) -> Iterable[Step]:
    """Natural frequency and resonance, as far as the gear's figures are published."""
    K_3, J = sheet.rating("torsional_stiffness_Nm_per_rad"), sheet.load_inertia
    if K_3 is None:
        return
    braked, free = sheet.figure("natural_frequency_Hz"), sheet.figure("drive_resonance_Hz")
    if braked is not None and J is not None:
        lines = [EquationLine(braked, _frequency(K_3 / J))]
        if free is not None:
            lines.append(EquationLine(free, _frequency(K_3 * (1 / J + 1 / at_output(sheet)))))
        note = Sentence(CANDIDATE["natural_frequency_Hz"].caveat)
        yield step_of_check("natural_frequency", tuple(lines), sheet.compared("natural_frequency", braked), (note,))


def _frequency(square: Formula) -> Formula:
    return Root(square) / (2 * PI)


def at_output(sheet: CalculationSheet) -> Formula:
    """Inertia of the motor at the output, plus the gear's own if known."""
    J_m, J_g = known(sheet.input_of("requirements.motor.inertia_kgm2")), sheet.rating("inertia_kgm2")
    return sheet.i**2 * (J_m if J_g is None else J_m + J_g)


def position_steps(sheet: CalculationSheet) -> Iterable[Step]:
    """Wind-up under T_max, and the position error with its parts."""
    K_3 = sheet.rating("torsional_stiffness_Nm_per_rad")
    if K_3 is None:
        return
    wind_up, error = known(sheet.figure("wind_up_arcmin")), known(sheet.figure("position_error_arcmin"))
    lowest, highest = (torque.item() for torque in sheet.duty.torque_range_Nm)
    T_lo, T_hi = Term(Variable("T", "lo"), lowest, "Nm"), Term(Variable("T", "hi"), highest, "Nm")
    span = (T_hi - T_lo) / K_3 * ARCMIN
    parts: list[Formula] = [known(sheet.rating("transmission_accuracy_arcmin")), span]
    if lowest <= 0 <= highest:
        parts.append(known(sheet.rating("backlash_arcmin")))
    lines = [EquationLine(wind_up, sheet.T_max / K_3 * ARCMIN), EquationLine(error, Sum(tuple(parts)))]
    length, radius = sheet.figure("position_error_mm"), sheet.input_of("requirements.position_radius_mm")
    if length is not None and radius is not None:
        lines.append(EquationLine(length, error / ARCMIN * radius))
    notes = (*_on_the_range(sheet), Sentence(CANDIDATE["position_error_arcmin"].caveat))
    yield step_of_check("position_error", tuple(lines), sheet.compared("position_error", error), notes)


def _on_the_range(sheet: CalculationSheet) -> Iterable[Sentence]:
    """Notes on the origin of T_lo and T_hi."""
    duty, motion = sheet.duty, sheet.application.duty_cycle.motion
    both = duty.torque_both_ways.item()
    yield Sentence(BOTH_WAYS if both else BY_SIGN if motion is None else BY_COURSE)
    if sheet.application.requirements.position_error_at == "rest":
        yield Sentence(AT_REST)
    friction = max(part.max() for part in duty.rest_friction_Nm)
    if friction and sheet.application.duty_cycle.rests:
        yield Sentence(FRICTION if motion is None else R_OF_MOTION, {"friction": Quantity(float(friction), "Nm", 6)})


BOTH_WAYS = N_("The torque is assumed to act both ways: T_hi is its largest magnitude, and T_lo is −T_hi.")
BY_SIGN = N_(
    "T_lo and T_hi are the smallest and the largest torque: of each phase from its least torque to its peak with the "
    "sign of its torque, of the pause 0."
)
BY_COURSE = N_(
    "T_lo and T_hi are the smallest and the largest torque along the motion, with their signs; a pause counts as 0."
)
AT_REST = N_("Rest alone counts: phases at speed 0, dwells and the pause.")
FRICTION = N_("At rest dry friction may raise or lower the torque by {friction}.")
R_OF_MOTION = N_(
    "At rest dry friction may raise or lower the torque by R = ((|T_load| + T_s) / η − |T_load|) / ratio, with the dry "
    "friction T_s and the η of the mechanism: by at most {friction}."
)

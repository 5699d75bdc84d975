"""Load of a pinion or pulley on the shaft, from the torque or the force at rack or belt."""

import math
from collections.abc import Iterable

from hpn.explain.calculation.formula import Constant, Formula, Root, Term, Variable
from hpn.explain.calculation.sheet import CalculationSheet, EquationLine, known
from hpn.physics.equations import ROUNDING
from hpn.physics.shaft_load import PRESSURE_ANGLE_DEG
from hpn.words.wording import N_, Sentence

RACK = N_(
    "F_t is the tangential force at the pinion: 2 T / d, or the force F at the rack where that is larger; q is "
    "tan 20° over the cosine of the helix angle."
)
BELT = N_(
    "F_t is the largest tangential force at the pulley: 2 T / d, or the force F at the belt where that is larger. The "
    "pretension k_t · F_t acts at all times."
)
TYPED = N_("Typed loads F_typ are added, since their directions are not known: an upper bound.")


def notes_on_shaft(sheet: CalculationSheet) -> list[Sentence]:
    """Notes on the load of pinion or pulley; none without one."""
    drive, typed = sheet.application.shaft_drive, sheet.duty.typed
    notes = {"rack_and_pinion": [RACK], "belt": [BELT]}.get(drive, [])
    added = [TYPED] if notes and (typed.radial_N.any() or typed.axial_N.any()) else []
    return [Sentence(note) for note in (*notes, *added)]


def of_shaft(sheet: CalculationSheet, index: str, place: int) -> Iterable[EquationLine]:
    """Tangential force in a phase, and the radial and axial load of pinion or pulley plus typed loads."""
    drive = sheet.application.shaft_drive
    if not drive:
        return
    forces, typed = sheet.duty.shaft_force_N[0, 0], sheet.duty.typed
    if drive == "belt":
        index, place, own = "", int(forces.argmax()), (index, place)
    else:
        own = index, place
    F_t = Term(Variable("F", "t").of_phase(index), forces.item(place), "N")
    yield EquationLine(F_t, _force(sheet, F_t, index, place))
    radial, axial = (values.term(*own) for values in (sheet.radial, sheet.axial))
    typed_radial, typed_axial = (values[0, 0].item(own[1]) for values in (typed.radial_N, typed.axial_N))
    if drive == "belt":
        yield EquationLine(radial, _added(known(sheet.input_of("output_load.belt_tension_factor")) * F_t, typed_radial))
        return
    beta = math.radians(known(sheet.input_of("output_load.rack_helix_deg")).value)
    q = Term(Variable("q"), math.tan(math.radians(PRESSURE_ANGLE_DEG)) / math.cos(beta))
    yield EquationLine(radial, _added(F_t * Root(Constant(1) + q**2, Constant(2)), typed_radial))
    if beta:
        yield EquationLine(axial, _added(F_t * Term(Variable("tan β"), math.tan(beta)), typed_axial))


def _force(sheet: CalculationSheet, F_t: Term, index: str, place: int) -> Formula:
    """Torque over half the diameter, or the force itself where it is larger."""
    d = Term(Variable("d"), sheet.duty.shaft_diameter_mm.item(), "mm")
    by_torque = Constant(2000) * abs(sheet.peak_torque.term(index, place)) / d
    if F_t.value > 2000 * abs(sheet.peak_torque.values.item(place)) / d.value * (1 + ROUNDING):
        return Term(Variable("F").of_phase(index), F_t.value, "N")
    return by_torque


def _added(load: Formula, typed_N: float) -> Formula:
    return load + Term(Variable("F", "typ"), typed_N, "N") if typed_N else load

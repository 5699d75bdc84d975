"""Torques at the motor: peak without the emergency stop, and RMS over the cycle with its pause. Not in the handbook."""

from collections.abc import Iterable
from dataclasses import replace

from hpn.calculation.formula import (
    Constant,
    Formula,
    PhaseValues,
    Power,
    Product,
    Quotient,
    Root,
    Term,
    Variable,
    over_phases,
    values_of,
)
from hpn.calculation.sheet import Line, Sheet, Step, known, step_of_check
from hpn.figures import efficiency_along
from hpn.quantities import INPUTS
from hpn.wording import N_, Sentence

SQUARED = Constant(2)
EFFICIENCY = Variable.of(INPUTS["requirements.efficiency"].symbol)


def motor_steps(sheet: Sheet) -> Iterable[Step]:
    """Peak and RMS torque, loss-free where no efficiency is known."""
    if sheet.duty.courses and sheet.given("requirements.motor.inertia_kgm2") is not None:
        return _along_the_motion(sheet)
    stated = sheet.given("requirements.efficiency")
    if stated is None and sheet.gear.designation in sheet.catalogue.efficiency:
        return _by_curve(sheet)
    eta = stated or Term(EFFICIENCY, 1.0)
    note = N_("η as you state it.") if stated else N_("η = 1, since no efficiency is known: loss-free, a lower bound.")
    shaft = Product((sheet.i, eta))
    squares = over_phases(lambda T, t: Product((Power(T, SQUARED), t)), sheet.rms_torque, sheet.time)
    peak = Quotient(sheet.T_max, shaft)
    rated = Quotient(Root(Quotient(squares, sheet.cycle_time)), shaft)
    return _steps(sheet, peak, rated, Sentence(note))


def _along_the_motion(sheet: Sheet) -> Iterable[Step]:
    """Torques with the motor's own inertia, which no single formula of the phases gives."""
    text = N_("From T / (i · η) + J_m · i · α at every instant of the motion; T · η / i where the load drives.")
    note = Sentence(text)
    for code in ("motor_peak_torque", "motor_rated_torque"):
        limit = sheet.compared(code, known(sheet.figure(f"{code}_Nm")))
        yield step_of_check(code, (), limit, (note,), trivial=True)


def _by_curve(sheet: Sheet) -> Iterable[Step]:
    """Motor torques phase by phase, the efficiency read at the peak for the peak and at the RMS for the RMS."""
    eta, eta_rms = (
        PhaseValues(EFFICIENCY, efficiency_along(sheet.catalogue, sheet.gear, torque.values))
        for torque in (sheet.peak_torque, sheet.rms_torque)
    )

    def at_motor(T: Formula, eta: Formula) -> Formula:
        return Quotient(T, Product((sheet.i, eta)))

    def of_phase(index: str, place: int) -> Formula:
        return at_motor(sheet.peak_torque.term(index, place), eta.term(index, place))

    every = {quantity.symbol.of_phase("n"): quantity.values for quantity in (sheet.peak_torque, eta)}
    largest = int(values_of(of_phase("n", 0), every).argmax())
    squares = over_phases(
        lambda T, eta, t: Product((Power(at_motor(T, eta), SQUARED), t)), sheet.rms_torque, eta_rms, sheet.time
    )
    note = N_("η of every phase from the efficiency curve that you supplied; beyond its ends that of the nearer end.")
    rated = Root(Quotient(squares, sheet.cycle_time))
    return _steps(sheet, of_phase(str(largest + 1), largest), rated, Sentence(note))


def _steps(sheet: Sheet, peak: Formula, rated: Formula, note: Sentence) -> Iterable[Step]:
    formulas = {
        "motor_peak_torque": (Variable("T", "in,max"), peak),
        "motor_rated_torque": (Variable("T", "in,rms"), rated),
    }
    for code, (symbol, formula) in formulas.items():
        torque = replace(known(sheet.figure(f"{code}_Nm")), symbol=symbol)
        limit, trivial = sheet.compared(code, torque), code == "motor_peak_torque"
        yield step_of_check(code, (Line(torque, formula),), limit, (note,), trivial=trivial)

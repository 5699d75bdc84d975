"""The motor: peak torque without the emergency stop, RMS over the cycle with its pause, inertia ratio. Not printed."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from hpn.account.readings import thermal_of_candidate
from hpn.engine.motor_torques import efficiency_at
from hpn.explain.calculation.formula import Formula, PhaseValues, Root, Sum, Term, Variable, over_phases, values_of
from hpn.explain.calculation.sheet import (
    CalculationSheet,
    Comparison,
    EquationLine,
    Step,
    known,
    step_of_check,
)
from hpn.physics.equations import FloatArray
from hpn.physics.motion import Course, peak_instant, square_torque
from hpn.words.quantities import CANDIDATE, INPUTS
from hpn.words.titles import numbered
from hpn.words.wording import N_, Quantity, Sentence, Value

EFFICIENCY = Variable.of(INPUTS["requirements.efficiency"].symbol)
MOTOR_PEAK, MOTOR_RMS = Variable("T", "in,max"), Variable("T", "in,rms")
STATED = N_("η as given.")
OWN = N_("The gear’s own inertia and no-load torque count as you supplied them; at rest the latter is 0.")
LOSS_FREE = N_("η = 1, since no efficiency is known: loss-free, a lower bound.")
BY_CURVE = N_(
    "η of every phase from the efficiency curve that you supplied; beyond its ends the value at the nearer end."
)


def _torques(sheet: CalculationSheet) -> Iterable[Step]:
    course, inertia = sheet.duty.courses.get(0), sheet.input_of("requirements.motor.inertia_kgm2")
    if course is not None and inertia is not None:
        return _along_the_motion(sheet, course, inertia)
    stated = sheet.input_of("requirements.efficiency")
    if (stated is None and sheet.gear.designation in sheet.catalogue.efficiency) or sheet.gear.no_load_torque_Nm:
        return _by_phase(sheet)
    eta = stated or Term(EFFICIENCY, 1.0)
    shaft = sheet.i * eta
    squares = over_phases(lambda T, t: T**2 * t, sheet.rms_torque, sheet.time)
    return _steps(sheet, sheet.T_max / shaft, Root(squares / sheet.cycle_time) / shaft)


# --- With the motor's own inertia -------------------------------------------------------------------------------------


def _along_the_motion(sheet: CalculationSheet, course: Course, inertia: Term) -> Iterable[Step]:
    """Steps of torques with the motor's own inertia: the peak at its instant, the RMS from that of each phase."""
    inertia, T_0 = _own_inertia(sheet, inertia), _without_load(sheet)
    text = N_("From T / (i · η) + J_m · i · α at every instant of the motion; T · η / i where the load drives.")
    own = [Sentence(OWN)] if sheet.gear.inertia_kgm2 or T_0 else []
    common = (Sentence(text), *own)
    at_peak, at_rms = (_efficiencies(sheet, torque) for torque in (course.peak_torque_Nm, course.rms_torque_Nm))
    squares = square_torque(
        course,
        ratio=np.array([sheet.i.value]),
        efficiency=at_rms[None],
        motor_inertia_kgm2=inertia.value,
        no_load_torque_Nm=T_0,
    )[0]
    of_phases = PhaseValues(MOTOR_RMS, np.sqrt(np.maximum(squares, 0.0) / course.duration_s), "Nm")
    series = over_phases(lambda T, t: T**2 * t, of_phases, sheet.time)
    peak, notes = _at_its_instant(sheet, course, inertia, at_peak)
    yield from _step(sheet, "motor_peak_torque", MOTOR_PEAK, peak, *common, *notes)
    rated = Root(series / sheet.cycle_time)
    of_each = Sentence(N_("T_in,rms of a phase is the RMS of the motor’s torque over the course of that phase."))
    yield from _step(sheet, "motor_rated_torque", MOTOR_RMS, rated, *common, of_each)


def _own_inertia(sheet: CalculationSheet, motor: Term) -> Term:
    """Inertia at the input: the motor's, plus the gear's own if known."""
    own = sheet.gear.inertia_kgm2
    return replace(motor, value=motor.value + own) if own else motor


def _without_load(sheet: CalculationSheet) -> float:
    """No-load torque of the gear in Nm; 0 if unknown."""
    return sheet.gear.no_load_torque_Nm or 0.0


def _at_its_instant(
    sheet: CalculationSheet, course: Course, inertia: Term, efficiency: FloatArray
) -> tuple[Formula, tuple[Sentence, ...]]:
    """Largest torque as a sum of the load's part and the motor inertia's part, with notes on both."""
    i = sheet.i.value
    T_0 = _without_load(sheet)
    instant = peak_instant(
        course, ratio=i, efficiency=efficiency, motor_inertia_kgm2=inertia.value, no_load_torque_Nm=T_0
    )
    eta = Term(EFFICIENCY, efficiency.item(instant.phase))
    T, own = instant.torque_Nm, inertia.value * i * instant.acceleration_rad_per_s2
    at_motor = T / (i * eta.value) if instant.is_driven else T * eta.value / i
    load = Term(Variable("T"), abs(T), "Nm")
    borne = load / (sheet.i * eta) if instant.is_driven else load * eta / sheet.i
    accelerated = Term(Variable("T", "J"), abs(own), "Nm")
    parts: list[tuple[float, Formula]] = [(at_motor, borne), (own, accelerated)]
    if T_0:
        without_load = T_0 * np.sign(course.speed_rpm.item(instant.phase))
        parts.append((without_load, Term(Variable("T", "0"), T_0, "Nm")))
    formula = _magnitude_of(parts)
    values: dict[str, Value] = {
        "phase": numbered(instant.phase, sheet.application.duty_cycle.load_phases[instant.phase].name),
        "inertia": Quantity(inertia.value, "kgm2", 6),
        "acceleration": Quantity(abs(instant.acceleration_rad_per_s2), "rad_per_s2", 6),
        "torque": Quantity(abs(own), "Nm", 6),
    }
    text = N_(
        "The largest is in phase {phase}: there J_m of {inertia} and α of {acceleration} at the output give T_J = J_m "
        "· i · α = {torque}."
    )
    return formula, (Sentence(text, values), *_on_efficiency(sheet))


def _magnitude_of(parts: Sequence[tuple[float, Formula]]) -> Formula:
    """Magnitude of a sum of signed values, each with the formula of its magnitude."""
    sense = math.fsum(value for value, _ in parts) >= 0
    formula: Formula = Sum(tuple(part for value, part in parts if (value >= 0) == sense))
    for value, part in parts:
        if (value >= 0) != sense:
            formula = formula - part
    return formula


def _efficiencies(sheet: CalculationSheet, torque_Nm: FloatArray) -> FloatArray:
    """Efficiency of the gear at the torque of every phase."""
    return efficiency_at(torque_Nm, sheet.gear, sheet.catalogue, sheet.duty.inputs["requirements.efficiency"].item())


def _on_efficiency(sheet: CalculationSheet) -> tuple[Sentence]:
    """Source of the efficiency."""
    if sheet.input_of("requirements.efficiency") is not None:
        return (Sentence(STATED),)
    return (Sentence(BY_CURVE if sheet.gear.designation in sheet.catalogue.efficiency else LOSS_FREE),)


# --- Phase by phase ---------------------------------------------------------------------------------------------------


def _by_phase(sheet: CalculationSheet) -> Iterable[Step]:
    """Motor torques phase by phase, the efficiency read at the peak for the peak and at the RMS for the RMS."""
    eta, eta_rms = (
        PhaseValues(EFFICIENCY, _efficiencies(sheet, torque.values)) for torque in (sheet.peak_torque, sheet.rms_torque)
    )
    T_0 = PhaseValues(Variable("T", "0"), np.where(sheet.speed.values > 0, _without_load(sheet), 0.0), "Nm")

    def at_motor(T: Formula, eta: Formula, T_0: Formula) -> Formula:
        driven = T / (sheet.i * eta)
        return driven + T_0 if _without_load(sheet) else driven

    def of_phase(index: str, place: int) -> Formula:
        return at_motor(*(quantity.term(index, place) for quantity in (sheet.peak_torque, eta, T_0)))

    every = {quantity.symbol.of_phase("n"): quantity.values for quantity in (sheet.peak_torque, eta, T_0)}
    largest = int(values_of(of_phase("n", 0), every).argmax())
    squares = over_phases(
        lambda T, eta, T_0, t: at_motor(T, eta, T_0) ** 2 * t, sheet.rms_torque, eta_rms, T_0, sheet.time
    )
    return _steps(sheet, of_phase(str(largest + 1), largest), Root(squares / sheet.cycle_time))


def _steps(sheet: CalculationSheet, peak: Formula, rated: Formula) -> Iterable[Step]:
    notes = (*_on_efficiency(sheet), *([Sentence(OWN)] if _without_load(sheet) else []))
    yield from _step(sheet, "motor_peak_torque", MOTOR_PEAK, peak, *notes)
    yield from _step(sheet, "motor_rated_torque", MOTOR_RMS, rated, *notes)


def _step(sheet: CalculationSheet, code: str, symbol: Variable, formula: Formula, *notes: Sentence) -> Iterable[Step]:
    if not sheet.candidate.says(f"{code}_Nm"):
        return
    torque = replace(known(sheet.figure(f"{code}_Nm")), symbol=symbol)
    compared, motor = sheet.compared(code, torque), sheet.application.requirements.motor
    if motor is not None and motor.curve:
        compared, on_curve = _along_curve(sheet, code, compared)
        notes += on_curve
    yield step_of_check(code, (EquationLine(torque, formula),), compared, notes)


def _along_curve(
    sheet: CalculationSheet, code: str, compared: tuple[Comparison, ...]
) -> tuple[tuple[Comparison, ...], tuple[Sentence, ...]]:
    """Comparisons with the curve, the peak at its nearest point and the RMS by both rules, and notes on them."""
    if code == "motor_rated_torque":
        both = thermal_of_candidate(sheet.candidate)
        return tuple(replace(one, limit_names=(Variable("M", "c"),)) for one in compared), (both,) if both else ()
    at_point, limit = Variable("T", "in"), (Variable("M", "p"),)
    note = Sentence(N_("T_in and M_p are those of the point nearest to the motor’s peak curve."))
    return tuple(replace(one, tested=Term(at_point, one.value, "Nm"), limit_names=limit) for one in compared), (note,)


# --- Torque limit of the drive ---------------------------------------------------------------------------------------


def _torque_limit(sheet: CalculationSheet) -> Iterable[Step]:
    """Step of the motor torque that keeps the gear at or below T_R."""
    limit, T_R = sheet.figure("motor_torque_limit_Nm"), sheet.rating("repeated_peak_torque_Nm")
    if limit is None or T_R is None:
        return
    source = N_("η = 1, since no efficiency is known: in braking up to T_R / η.")
    if sheet.input_of("requirements.efficiency") is not None:
        source = STATED
    elif sheet.gear.designation in sheet.catalogue.efficiency:
        source = N_("η at T_R from the efficiency curve that you supplied.")
    eta = Term(EFFICIENCY, _efficiencies(sheet, np.array(T_R.value)).item())
    title, line = CANDIDATE["motor_torque_limit_Nm"].name, EquationLine(limit, eta * T_R / sheet.i)
    yield Step("torque_limit", title, None, (line,), (), (Sentence(source),))


# --- Inertia ----------------------------------------------------------------------------------------------------------


def _inertia_ratio(sheet: CalculationSheet) -> Iterable[Step]:
    """Step of the load's inertia at the motor over the motor's own."""
    load, motor = sheet.load_inertia, sheet.input_of("requirements.motor.inertia_kgm2")
    if load is None or motor is None or sheet.input_of("requirements.motor.inertia_ratio") is None:
        return
    formula: Formula = load / (sheet.i**2 * motor)
    if (own := sheet.rating("inertia_kgm2")) is not None:
        formula = formula + own / motor
    note = N_("J_L as given for the load.")
    if sheet.duty.courses:
        note = N_("J_L is the inertia of the motion’s load at the gear’s output.")
    limit = sheet.compared("inertia_ratio", formula)
    yield step_of_check("inertia_ratio", (), limit, (Sentence(note),))


MOTOR = (_torques, _torque_limit, _inertia_ratio)
"""Steps of peak and RMS torque (loss-free if no efficiency is known), of the drive's limit, and of a requested
ratio.
"""

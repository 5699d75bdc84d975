"""Stiffness, position error and the emergency stop by the brake, as equations with their numbers."""

import math
from collections.abc import Iterable

import numpy as np

from hpn.engine.figures import Figures
from hpn.engine.stops import Stops
from hpn.explain.calculation.formula import Constant, Formula, Root, Sum, Term, Variable, value_of
from hpn.explain.calculation.sheet import Line, Sheet, Step, known, step_of_check
from hpn.physics import stop
from hpn.words.quantities import CANDIDATE
from hpn.words.wording import N_, Sentence

PI = Term(Variable("π"), math.pi)
ARCMIN, DEGREES = Constant(10800, "arcmin") / PI, Constant(180, "deg") / PI
UNIFORM = Sentence(N_("The stop starts at constant speed; the rising brake torque takes over from the motor’s."))


def frequency_steps(sheet: Sheet) -> Iterable[Step]:
    """Natural frequency and resonance, as far as the gear's figures are published."""
    K_3, J = sheet.rating("torsional_stiffness_Nm_per_rad"), sheet.load_inertia
    if K_3 is None:
        return
    held, free = sheet.figure("natural_frequency_Hz"), sheet.figure("drive_resonance_Hz")
    if held is not None and J is not None:
        lines = [Line(held, _frequency(K_3 / J))]
        if free is not None:
            lines.append(Line(free, _frequency(K_3 * (1 / J + 1 / at_output(sheet)))))
        note = Sentence(CANDIDATE["natural_frequency_Hz"].caveat)
        yield step_of_check("natural_frequency", tuple(lines), sheet.compared("natural_frequency", held), (note,))


def _frequency(square: Formula) -> Formula:
    return Root(square) / (2 * PI)


def at_output(sheet: Sheet) -> Formula:
    """Inertia of the motor at the output, with the gear's own where it is known."""
    J_m, J_g = known(sheet.given("requirements.motor.inertia_kgm2")), sheet.rating("inertia_kgm2")
    return sheet.i**2 * (J_m if J_g is None else J_m + J_g)


def position_steps(sheet: Sheet) -> Iterable[Step]:
    """Wind-up under T_max, and what adds up to the position error."""
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
    lines = [Line(wind_up, sheet.T_max / K_3 * ARCMIN), Line(error, Sum(tuple(parts)))]
    length, radius = sheet.figure("position_error_mm"), sheet.given("requirements.position_radius_mm")
    if length is not None and radius is not None:
        lines.append(Line(length, error / ARCMIN * radius))
    torques = Sentence(BOTH_WAYS if sheet.duty.torque_both_ways.item() else BY_SIGN)
    notes = (torques, Sentence(CANDIDATE["position_error_arcmin"].caveat))
    yield step_of_check("position_error", tuple(lines), sheet.compared("position_error", error), notes)


BOTH_WAYS = N_("The torque is assumed to act both ways: T_lo is −T_max and T_hi is T_max.")
BY_SIGN = N_(
    "T_lo and T_hi are the smallest and the largest peak of the phases, each with the sign of its torque; a pause "
    "counts as 0."
)


# --- Emergency stop by the brake --------------------------------------------------------------------------------------


def stop_steps(sheet: Sheet) -> Iterable[Step]:
    """The torque of a stop by the brake on the gear, and its course."""
    T_B, T_k = sheet.given("emergency_stop.brake.torque_Nm"), sheet.figure("stop_torque_Nm")
    if T_B is None or T_k is None:
        return
    stops = Figures(sheet.duty, sheet.gears, sheet.catalogue).stops
    f = Term(Variable("f"), stops.dynamic_factor.item())
    torques = [torque.item() for torque in stops.opposing_torques_Nm]
    hardest = max(torques, key=lambda T: _torque(stops.brake, T, f.value))
    T_opp, eta = (
        Term(Variable("T", "opp"), hardest, "Nm"),
        Term(Variable("η"), np.asarray(stops.brake.efficiency).item()),
    )
    T_r = Term(Variable("T", "r"), _at_rest(stops.brake, hardest), "Nm")
    formula: Formula = f * abs(T_r)
    if hardest > 0:
        formula = formula + (f - 1) * T_opp
    J, lines = sheet.load_inertia, list[Line]()
    at_motor = sheet.i * T_B
    if J is None or math.isnan(stops.course.time_s.item()):
        lines.append(Line(T_r, at_motor / eta))
    else:
        loss: Formula = eta if T_r.value >= 0 else 1 / eta
        a = Term(Variable("a"), _deceleration(stops.brake, hardest), "rad_per_s2")
        lines.append(Line(a, (at_motor + loss * T_opp) / (at_output(sheet) + loss * J)))
        lines.append(Line(T_r, J * a - T_opp))
    lines.append(Line(T_k, formula))
    yield Step("stop", BRAKE, None, tuple(lines), (), (UNIFORM, Sentence(HARDEST), *_on_the_factor(sheet, f)))
    if J is not None and sheet.figure("stopping_time_s") is not None:
        yield _course(sheet, stops, J, at_motor, eta)


BRAKE = N_("Emergency stop by the brake")
HARDEST = N_("T_opp is the load’s torque against the motion at which T_k is the largest; 0 without a motion.")


def _torque(brake: stop.Brake, T_opp: float, f: float) -> float:
    return stop.stop_torque(brake=brake, opposing_torque_Nm=T_opp, dynamic_factor=f).item()


def _at_rest(brake: stop.Brake, T_opp: float) -> float:
    return stop.stop_torque_at_rest(brake=brake, opposing_torque_Nm=T_opp).item()


def _deceleration(brake: stop.Brake, T_opp: float) -> float:
    return stop.deceleration(brake=brake, opposing_torque_Nm=T_opp).item()


def _on_the_factor(sheet: Sheet, f: Term) -> tuple[Sentence, ...]:
    if sheet.given("emergency_stop.brake.dynamic_factor") is not None:
        return (Sentence(N_("f as given.")),)
    if f.value == stop.STEP_FACTOR:
        return (Sentence(N_("f = 2: the brake closes at once, or its rise time or an inertia is not known.")),)
    return (
        Sentence(N_("f = 1 + |sin(π · f_2 · t_b)| / (π · f_2 · t_b), from the rise time and the drive resonance.")),
    )


def _course(sheet: Sheet, stops: Stops, J: Term, at_motor: Formula, eta: Term) -> Step:
    """Time, angle and energy of the stop at the smallest opposing torque."""
    lowest, given = sheet.duty.opposing_torque_Nm[0].item(), sheet.given
    t_r, t_b = known(given("emergency_stop.brake.reaction_time_s")), known(given("emergency_stop.brake.rise_time_s"))
    T_opp = Term(Variable("T", "opp"), lowest, "Nm")
    omega = Term(Variable("ω"), sheet.duty.stop_speed_rpm.item() * math.pi / 30, "rad_per_s")
    inertia = J + at_output(sheet)
    c = Term(Variable("c"), lowest / value_of(inertia), "rad_per_s2")
    t_d = Term(Variable("t", "d"), t_r.value + t_b.value / 2, "s")
    slower = Term(Variable("ω", "1"), omega.value - c.value * t_d.value, "rad_per_s")
    lines = [Line(t_d, t_r + t_b / 2), Line(c, T_opp / inertia), Line(slower, omega - c * t_d)]
    time, angle = known(sheet.figure("stopping_time_s")), known(sheet.figure("stopping_angle_deg"))
    energy = known(sheet.figure("stop_energy_J"))
    if slower.value <= 0:
        lines = [Line(c, T_opp / inertia), Line(time, omega / c)]
        lines.append(Line(angle, omega**2 / (2 * c) * DEGREES))
        return Step("stop_course", STOPPING, None, tuple(lines), (), (Sentence(BY_ITSELF),))
    a = Term(Variable("a"), _deceleration(stops.brake, lowest), "rad_per_s2")
    turned = omega * t_d - c * t_d**2 / 2 + slower**2 / (2 * a)
    lines += [
        Line(a, (at_motor + eta * T_opp) / (at_output(sheet) + eta * J)),
        Line(time, t_d + slower / a),
        Line(angle, turned * DEGREES),
        Line(energy, inertia * slower**2 / 2),
    ]
    return Step("stop_course", STOPPING, None, tuple(lines), (), (Sentence(SMALLEST),))


STOPPING = N_("Time, angle and energy of the stop")
SMALLEST = N_("At the smallest torque that opposes the motion, in its worst position.")
BY_ITSELF = N_("The load stops by itself before the brake takes hold.")

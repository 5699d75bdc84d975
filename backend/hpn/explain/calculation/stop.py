"""The emergency stop by the brake, as equations with their numbers."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from hpn.engine.figures import Figures
from hpn.engine.stops import Stops
from hpn.explain.calculation.formula import Constant, Formula, Largest, Root, Term, Variable
from hpn.explain.calculation.sheet import CalculationSheet, EquationLine, Step, known
from hpn.explain.calculation.stiffness import ARCMIN, PI, at_output
from hpn.physics.stop import flank_share, settled_torque
from hpn.words.quantities import INPUTS, QUANTITIES
from hpn.words.wording import N_, Sentence

ONE, DEGREES = Constant(1), Constant(180, "deg") / PI

BRAKE = N_("Emergency stop by the brake")
STOPPING = N_("Time, angle and energy of the stop")
BOUND = N_(
    "Upper bound: under T_o the load lets go of one flank, crosses the backlash j under the brake’s whole torque and "
    "swings about T_r on the other."
)
TYPED_FACTOR = N_("With your dynamic factor f, no bound.")
LOAD_TORQUES = N_(
    "T_d may pull the load, T_v drives it along the stop, T_o opposes the motion, all at the gear: T_W is the weight’s "
    "torque, T_E the largest external torque of a move, T_Ev the largest that drives in its own move, T_fr friction at "
    "the speed of the stop, T_α the largest J · α, at the mechanism."
)
COURSE_BOUNDS = N_("Upper bounds: the load drives all along and losses are left out.")


def stop_steps(sheet: CalculationSheet) -> Iterable[Step]:
    """The torque of a stop by the brake on the gear, and its course."""
    T_B, T_k = sheet.input_of("emergency_stop.brake.torque_Nm"), sheet.figure("stop_torque_Nm")
    if T_B is None or T_k is None:
        return
    stops = Figures(sheet.duty, sheet.gears, sheet.catalogue).stops
    load = _Load.of(sheet)
    yield _torque(sheet, stops, load, sheet.i * T_B, T_k)
    if sheet.load_inertia is not None and sheet.figure("stopping_time_s") is not None:
        yield _course(sheet, stops, sheet.load_inertia, load, T_B, T_k)


@dataclass(frozen=True, slots=True)
class _Load:
    """Torques of the load at the gear, and the lines that derive them from a motion."""

    T_d: Term
    T_v: Term
    T_o: Term
    lines: tuple[EquationLine, ...] = ()

    @classmethod
    def of(cls, sheet: CalculationSheet) -> "_Load":
        """Load of the motion, else as given: T_d and T_v are then T_L."""
        whole = sheet.duty.stop_load
        T_d, T_v, T_o = (np.asarray(x).item() for x in (whole.pulling_Nm, whole.driving_Nm, whole.opposing_Nm))
        opposing = Term(Variable("T", "o"), T_o, "Nm")
        motion = sheet.application.duty_cycle.motion
        if motion is None:
            T_L = Term(Variable.of(INPUTS["emergency_stop.brake.load_torque_Nm"].symbol), T_d, "Nm")
            return cls(T_L, T_L, opposing)
        pulling, driving = Term(Variable("T", "d"), T_d, "Nm"), Term(Variable("T", "v"), T_v, "Nm")
        load, shaft = motion.stopped_load, motion.stopped_load.shaft
        figures = {
            "W": shaft.weight_Nm,
            "E": load.external_Nm,
            "Ev": load.driving_Nm,
            "fr": load.friction_at_Nm(sheet.duty.stop_speed_rpm.item()),
            "α": load.accelerating_Nm,
        }
        T = {index: Term(Variable("T", index), torque, "Nm") for index, torque in figures.items()}
        i_m, eta_m = (
            Term(Variable.of(QUANTITIES[f"motion.mechanism.{name}"].symbol), value)
            for name, value in (("ratio", shaft.ratio), ("efficiency", shaft.efficiency))
        )
        lines = (
            EquationLine(pulling, (T["W"] + T["E"]) / i_m),
            EquationLine(driving, (T["W"] + T["Ev"]) / i_m),
            EquationLine(opposing, (T["W"] + T["E"] + T["fr"] + T["α"]) / (eta_m * i_m)),
        )
        return cls(pulling, driving, opposing, lines)


def _torque(sheet: CalculationSheet, stops: Stops, load: _Load, at_gear: Formula, T_k: Term) -> Step:
    """Step of the torque T_k, with the torque about which the gear swings."""
    J, eta = sheet.load_inertia, Term(Variable("η"), np.asarray(stops.brake.efficiency).item())
    T_r = Term(Variable("T", "r"), settled_torque(brake=stops.brake, load=stops.load).item(), "Nm")
    B = Term(Variable("B"), flank_share(brake=stops.brake).item())
    if J is None or math.isnan(stops.brake.motor_at_output_kgm2.item()):
        lines = [EquationLine(T_r, Largest((at_gear / eta, load.T_d)))]
        flank: Formula = 1 / eta**2
    else:
        ratio = J.value / stops.brake.motor_at_output_kgm2.item()
        lam = Term(Variable("λ"), ratio)
        lines = [
            EquationLine(lam, J / at_output(sheet)),
            EquationLine(T_r, (lam * at_gear + load.T_d) / (ONE + eta * lam)),
        ]
        flank = (ONE + lam / eta) / (ONE + eta * lam)
    f, notes = sheet.input_of("emergency_stop.brake.dynamic_factor"), [Sentence(BOUND)]
    if f is not None:
        lines.append(EquationLine(T_k, f * T_r + (f - 1) * load.T_o))
        notes = [Sentence(TYPED_FACTOR)]
    else:
        K_3, j = known(sheet.rating("torsional_stiffness_Nm_per_rad")), known(sheet.rating("backlash_arcmin"))
        swing = T_r**2 + 2 * T_r * (load.T_o + K_3 * (j / ARCMIN)) + B * load.T_o**2
        lines += [EquationLine(B, flank), EquationLine(T_k, T_r + Root(swing))]
    if load.lines:
        notes.append(Sentence(LOAD_TORQUES))
    return Step("stop", BRAKE, None, (*load.lines, *lines), (), tuple(notes))


def _course(sheet: CalculationSheet, stops: Stops, J: Term, load: _Load, T_B: Term, T_k: Term) -> Step:
    """Step of the upper bounds of a stop's time, angle and energy."""
    figure = sheet.figure
    t_r = known(sheet.input_of("emergency_stop.brake.reaction_time_s"))
    t_b = known(sheet.input_of("emergency_stop.brake.rise_time_s"))
    K_3, j = known(sheet.rating("torsional_stiffness_Nm_per_rad")), known(sheet.rating("backlash_arcmin"))
    omega = Term(Variable("ω"), sheet.duty.stop_speed_rpm.item() * math.pi / 30, "rad_per_s")
    inertia = J + at_output(sheet)
    whole = J.value + stops.brake.motor_at_output_kgm2.item()
    t_d = Term(Variable("t", "d"), t_r.value + t_b.value / 2, "s")
    faster = Term(Variable("ω", "1"), omega.value + load.T_v.value * t_d.value / whole, "rad_per_s")
    a = Term(Variable("a"), (sheet.i.value * T_B.value - load.T_v.value) / whole, "rad_per_s2")
    time, angle = known(figure("stopping_time_s")), known(figure("stopping_angle_deg"))
    drawn = load.T_v * t_d**2 / (2 * inertia)
    turned = omega * t_d + drawn + faster**2 / (2 * a) + j / ARCMIN + (T_k + load.T_o) / K_3
    lines = (
        EquationLine(t_d, t_r + t_b / 2),
        EquationLine(faster, omega + load.T_v * t_d / inertia),
        EquationLine(a, (sheet.i * T_B - load.T_v) / inertia),
        EquationLine(time, t_d + faster / a + 1 / (4 * known(figure("drive_resonance_Hz")))),
        EquationLine(angle, turned * DEGREES),
        EquationLine(known(figure("stop_energy_J")), inertia * omega**2 / 2 + load.T_v * (angle / DEGREES)),
    )
    return Step("stop_course", STOPPING, None, lines, (), (Sentence(COURSE_BOUNDS),))

"""Checks of the motor against the user's limits: speeds, torques and the inertia ratio."""

import numpy as np

from hpn.engine.check import Case, Check
from hpn.engine.checks.dependence import AVERAGE_SPEED, follows_rms, follows_torque, square_torques
from hpn.engine.input_arrays import CURVE
from hpn.engine.motor_torques import inertia_ratio
from hpn.physics.equations import FloatArray
from hpn.words.wording import N_


def _speed_limit(case: Case) -> FloatArray:
    """Maximum speed of the motor, or the last speed of its curve if smaller."""
    return np.fmin(case.inputs["requirements.motor.maximum_speed_rpm"], case.inputs[CURVE])


def _peak(case: Case) -> FloatArray:
    """Largest torque at the motor; with a curve the torque nearest to it."""
    figures, has_curve = case.figures, ~np.isnan(case.inputs[CURVE])
    return np.where(has_curve, figures.by_curve.demand_Nm, figures.motor_peak_torque_Nm)


def _peak_limit(case: Case) -> FloatArray:
    """Peak torque of the motor; with a curve its value where the torque is nearest to it."""
    stated = case.inputs["requirements.motor.peak_torque_Nm"]
    return np.where(np.isnan(case.inputs[CURVE]), stated, case.figures.by_curve.peak_Nm)


def _continuous_limit(case: Case) -> FloatArray:
    """Rated torque of the motor; with a curve the smaller of the limits by losses and by the makers' rule."""
    stated = case.inputs["requirements.motor.rated_torque_Nm"]
    return np.where(np.isnan(case.inputs[CURVE]), stated, case.figures.by_curve.continuous_Nm)


MOTOR: tuple[Check, ...] = (
    Check(
        code="motor_speed",
        name=N_("motor speed"),
        title=N_("Motor speed"),
        equation="17.6",
        unit="rpm",
        kind="maximum",
        group="load",
        limit_name=N_("motor’s maximum"),
        source=N_("your input"),
        tests=N_("The largest output speed times the ratio stays within the motor’s maximum speed."),
        consequence=N_("The motor can’t reach the speed that the cycle requires."),
        basis=N_("Limit as given, or the last speed of the motor’s torque curve where that is smaller."),
        remedy=N_("Choose a smaller ratio, a faster motor, or a lower top speed."),
        trigger="requirements.motor.maximum_speed_rpm",
        instead=CURVE,
        limit=_speed_limit,
        demand=lambda c: c.figures.maximum_input_speed_rpm,
        relation="n_in,max ≤ n_mot",
        moves={"speed": 1.0},
        accepted=N_("the motor’s maximum speed rises to {value}"),
        over={"peak_speed_rpm": "rising", "requirements.motor.maximum_speed_rpm": "falling", "motion": "ends"},
    ),
    Check(
        code="motor_peak_torque",
        name=N_("motor peak torque"),
        title=N_("Motor peak torque"),
        unit="Nm",
        kind="maximum",
        group="load",
        limit_name=N_("motor’s peak torque"),
        source=N_("your input"),
        tests=N_(
            "The largest torque of the cycle, divided by ratio and efficiency, stays within the motor’s peak torque. "
            "The emergency stop does not count."
        ),
        consequence=N_("The motor can’t accelerate the load as the cycle requires."),
        basis=N_(
            "T_max / (i · η), with the efficiency given or that of a supplement; without one loss-free, a lower "
            "bound. With a motion and the motor’s inertia J_m it is the largest T / (i · η) + J_m · i · α, or T · η / "
            "i where the load drives. The gear’s inertia is added to J_m, and its no-load torque in any case, where a "
            "supplement gives them; else they are left out. Along a torque curve of the motor demand and limit are "
            "those of the point nearest to it: of a motion along its course, of typed phases each phase’s peak against "
            "the least limit up to its peak speed. Without a motion or J_m the rotor is left out."
        ),
        remedy=N_("Choose a larger ratio or a stronger motor, or accelerate more gently."),
        trigger="requirements.motor.peak_torque_Nm",
        instead=CURVE,
        limit=_peak_limit,
        sampled_beside=CURVE,
        demand=_peak,
        relation="T_max / (i · η) ≤ T_mot",
        moves={"torque": 1.0},
        accepted=N_("the motor’s peak torque rises to {value}"),
        over={
            "peak_torque_Nm": "rising",
            "requirements.efficiency": "falling",
            "requirements.motor.peak_torque_Nm": "falling",
            "requirements.motor.inertia_kgm2": "ends",
            "motion": "ends",
        },
        proven=follows_torque,
    ),
    Check(
        code="motor_rated_torque",
        name=N_("motor rated torque"),
        title=N_("Motor rated torque"),
        unit="Nm",
        kind="maximum",
        group="load",
        limit_name=N_("motor’s rated torque"),
        source=N_("your input"),
        tests=N_(
            "The RMS of the torque over the cycle, pause included, divided by ratio and efficiency, stays within the "
            "motor’s rated torque."
        ),
        consequence=N_("The motor overheats."),
        basis=N_(
            "RMS of T / (i · η), with the efficiency given or that of a supplement; without one loss-free, a lower "
            "bound. With a motion and the motor’s inertia J_m it is the RMS of T / (i · η) + J_m · i · α, or T · η / "
            "i where the load drives. The gear’s inertia is added to J_m, and its no-load torque in any case, where a "
            "supplement gives them; else they are left out. With a torque curve M_c(n) of the motor the limit is the "
            "smaller of two: the root of the mean of M_c(n)² over the cycle, with which the motor’s losses balance, "
            "the pause at speed 0, and the makers’ rule, M_c at the mean speed."
        ),
        remedy=N_("Choose a larger ratio or a stronger motor, or lengthen the pause."),
        trigger="requirements.motor.rated_torque_Nm",
        instead=CURVE,
        limit=_continuous_limit,
        sampled_beside=CURVE,
        demand=lambda c: c.figures.motor_rated_torque_Nm,
        relation="T_rms / (i · η) ≤ T_mot,N",
        moves={"torque": 1.0},
        accepted=N_("the motor’s rated torque rises to {value}"),
        over={
            "rms_torque_Nm": "rising",
            "duration_s": "weight",
            "duty_cycle.pause_s": "falling",
            "requirements.efficiency": "falling",
            "requirements.motor.rated_torque_Nm": "falling",
            "requirements.motor.inertia_kgm2": "ends",
            "motion": "ends",
        },
        weighted=square_torques,
        proven=follows_rms,
    ),
    Check(
        code="motor_rated_speed",
        name=N_("motor rated speed"),
        title=N_("Motor rated speed"),
        equation="17.5",
        unit="rpm",
        kind="maximum",
        group="load",
        limit_name=N_("motor’s rated speed"),
        source=N_("your input"),
        tests=N_("The average output speed times the ratio, pause included, stays within the motor’s rated speed."),
        consequence=N_("The motor overheats: its rated torque is available only up to its rated speed."),
        basis=N_("Limit as given."),
        remedy=N_("Choose a smaller ratio or a faster motor, or lengthen the pause."),
        trigger="requirements.motor.rated_speed_rpm",
        unless=CURVE,
        demand=lambda c: c.figures.average_input_speed_rpm,
        relation="n_in,av ≤ n_mot,N",
        moves={"speed": 1.0},
        accepted=N_("the motor’s rated speed rises to {value}"),
        over={**AVERAGE_SPEED, "requirements.motor.rated_speed_rpm": "falling"},
        weighted=lambda c: c.duty.phases.speed_rpm,
    ),
)

INERTIA_RATIO = Check(
    code="inertia_ratio",
    name=N_("inertia ratio"),
    title=N_("Inertia ratio"),
    unit="",
    kind="maximum",
    group="property",
    limit_name=N_("your limit"),
    source=N_("your input"),
    tests=N_("The load’s inertia reflected to the motor, divided by the motor’s own, stays within your limit."),
    consequence=N_("The axis is hard to control: it oscillates or responds slowly."),
    basis=N_(
        "(J_L / i² + J_g) / J_m. The inertia J_g of the gear at its input is not published in this handbook; it "
        "is included where a supplement gives it."
    ),
    remedy=N_("Choose a larger ratio, a motor with more inertia, or a lighter load."),
    trigger="requirements.motor.inertia_ratio",
    demand=lambda c: inertia_ratio(c.duty, c.gears, c.inputs["requirements.motor.inertia_kgm2"]),
    relation="(J_L / i² + J_g) / J_m ≤ r_J",
    accepted=N_("the permitted inertia ratio rises to {value}"),
    over={
        "requirements.load_inertia_kgm2": "rising",
        "requirements.motor.inertia_kgm2": "falling",
        "requirements.motor.inertia_ratio": "falling",
        "motion": "ends",
    },
)

OF_MOTOR = (*MOTOR, INERTIA_RATIO)
"""All checks of the motor: the load checks, and the inertia ratio, a property check and the last of all."""

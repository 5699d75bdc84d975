"""Checks of the motor, against the limits that the user states: speeds, torques and the inertia ratio."""

from hpn.engine.check import Check
from hpn.engine.checks.dependence import AVERAGE_SPEED, follows_rms, follows_torque, square_torques
from hpn.engine.motor_torques import inertia_ratio
from hpn.words.wording import N_

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
        basis=N_("Limit as given."),
        remedy=N_("Choose a smaller ratio, a faster motor, or a lower top speed."),
        asked="requirements.motor.maximum_speed_rpm",
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
            "supplement gives them; else they are left out."
        ),
        remedy=N_("Choose a larger ratio or a stronger motor, or accelerate more gently."),
        asked="requirements.motor.peak_torque_Nm",
        demand=lambda c: c.figures.motor_peak_torque_Nm,
        relation="T_max / (i · η) ≤ T_mot",
        moves={"torque": 1.0},
        accepted=N_("the motor’s peak torque rises to {value}"),
        over={
            "peak_torque_Nm": "rising",
            "requirements.efficiency": "falling",
            "requirements.motor.peak_torque_Nm": "falling",
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
            "supplement gives them; else they are left out."
        ),
        remedy=N_("Choose a larger ratio or a stronger motor, or lengthen the pause."),
        asked="requirements.motor.rated_torque_Nm",
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
        asked="requirements.motor.rated_speed_rpm",
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
    asked="requirements.motor.inertia_ratio",
    demand=lambda c: inertia_ratio(c.duty, c.gears, c.asked["requirements.motor.inertia_kgm2"]),
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
"""All checks of the motor: of its loads, and of its inertia, which is a property and the last of all checks."""

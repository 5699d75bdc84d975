"""Checks of the motor, against the limits that the user states: its speed and its torques."""

from hpn.check import Check
from hpn.wording import N_

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
        consequence=N_("The motor can’t reach the speed that the cycle asks for."),
        basis=N_("Limit as you stated it."),
        remedy=N_("Take a smaller ratio, a faster motor, or a lower top speed."),
        asked="requirements.motor.maximum_speed_rpm",
        demand=lambda c: c.figures.maximum_input_speed_rpm,
        limit=lambda c: c.asked["requirements.motor.maximum_speed_rpm"],
        relation="n_in,max ≤ n_mot",
        moves={"speed": 1.0},
    ),
    Check(
        code="motor_peak_torque",
        name=N_("motor peak torque"),
        title=N_("Motor peak torque"),
        equation=None,
        unit="Nm",
        kind="maximum",
        group="load",
        limit_name=N_("motor’s peak torque"),
        source=N_("your input"),
        tests=N_(
            "The largest torque of the cycle over ratio and efficiency stays within the motor’s peak torque. The "
            "emergency stop does not count."
        ),
        consequence=N_("The motor can’t accelerate the load as the cycle asks."),
        basis=N_(
            "T_max / (i · η) with the efficiency that you state or a supplement gives; without one loss-free, a "
            "lower bound. The inertia of motor and gear and losses without load are left out."
        ),
        remedy=N_("Take a larger ratio, a stronger motor, or accelerate more gently."),
        asked="requirements.motor.peak_torque_Nm",
        demand=lambda c: c.figures.motor_peak_torque_Nm,
        limit=lambda c: c.asked["requirements.motor.peak_torque_Nm"],
        relation="T_max / (i · η) ≤ T_mot",
        moves={"torque": 1.0},
        accepted=N_("the motor’s peak torque rises to {value}"),
    ),
    Check(
        code="motor_rated_torque",
        name=N_("motor rated torque"),
        title=N_("Motor rated torque"),
        equation=None,
        unit="Nm",
        kind="maximum",
        group="load",
        limit_name=N_("motor’s rated torque"),
        source=N_("your input"),
        tests=N_(
            "The RMS of the torque over the cycle, pause included, over ratio and efficiency stays within the "
            "motor’s rated torque."
        ),
        consequence=N_("The motor overheats."),
        basis=N_(
            "RMS of T / (i · η) with the efficiency that you state or a supplement gives; without one loss-free, a "
            "lower bound. The inertia of motor and gear and losses without load are left out."
        ),
        remedy=N_("Take a larger ratio, a stronger motor, or add pause."),
        asked="requirements.motor.rated_torque_Nm",
        demand=lambda c: c.figures.motor_rated_torque_Nm,
        limit=lambda c: c.asked["requirements.motor.rated_torque_Nm"],
        relation="T_rms / (i · η) ≤ T_mot,N",
        moves={"torque": 1.0},
        accepted=N_("the motor’s rated torque rises to {value}"),
    ),
)

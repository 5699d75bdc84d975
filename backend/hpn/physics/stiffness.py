"""Torsional stiffness: natural frequencies, wind-up and position error of an axis on a gear.

The gear is a spring of its published stiffness K3 between the motor and the load, both rigid. K3 holds above 15 % of
the rated torque; below it the gear is softer (glossary). Arguments broadcast; NaN stands for unknown figures.
"""

import numpy as np

from hpn.physics.equations import FloatArray, equation

Figure = FloatArray | float

ARCMIN_PER_RAD = 10_800 / np.pi


@equation
def natural_frequency(*, torsional_stiffness_Nm_per_rad: Figure, load_inertia_kgm2: Figure) -> FloatArray:
    """Natural frequency √(K3 / J) / 2π in Hz of the load on the gear while the motor is held.

    An upper bound: couplings and the gear's own inertia lower it. One mass on a torsion spring (any text on vibration).
    """
    return np.sqrt(np.divide(torsional_stiffness_Nm_per_rad, load_inertia_kgm2)) / (2 * np.pi)


@equation
def drive_resonance(
    *,
    torsional_stiffness_Nm_per_rad: Figure,
    load_inertia_kgm2: Figure,
    ratio: Figure,
    motor_inertia_kgm2: Figure,
) -> FloatArray:
    """Resonance √(K3 (1 / J + 1 / (i² J_m))) / 2π in Hz of load and motor against each other, both free to turn."""
    motor_at_output = np.square(ratio) * motor_inertia_kgm2
    return np.sqrt(torsional_stiffness_Nm_per_rad * (np.divide(1, load_inertia_kgm2) + 1 / motor_at_output)) / (
        2 * np.pi
    )


@equation
def wind_up(*, torque_Nm: Figure, torsional_stiffness_Nm_per_rad: Figure) -> FloatArray:
    """Wind-up T / K3 of the output in arcmin; a lower bound, since the gear is softer below 15 % of T_N (glossary)."""
    return np.divide(torque_Nm, torsional_stiffness_Nm_per_rad) * ARCMIN_PER_RAD


@equation
def position_error(
    *,
    smallest_torque_Nm: Figure,
    largest_torque_Nm: Figure,
    torsional_stiffness_Nm_per_rad: Figure,
    transmission_accuracy_arcmin: Figure,
    backlash_arcmin: Figure,
) -> FloatArray:
    """Position error of the output over a cycle in arcmin: accuracy, wind-up from one torque to the other, backlash.

    Added arithmetically. The torques are signed; backlash counts where the torque is 0 or passes it.
    """
    T_lo, T_hi = np.asarray(smallest_torque_Nm), np.asarray(largest_torque_Nm)
    span = wind_up(torque_Nm=T_hi - T_lo, torsional_stiffness_Nm_per_rad=torsional_stiffness_Nm_per_rad)
    reverses = (T_lo <= 0) & (T_hi >= 0)
    return transmission_accuracy_arcmin + span + np.where(reverses, backlash_arcmin, 0.0)


@equation
def arc_length(*, angle_arcmin: Figure, radius_mm: Figure) -> FloatArray:
    """Length in mm of an angle at a radius."""
    return np.multiply(angle_arcmin, radius_mm) / ARCMIN_PER_RAD

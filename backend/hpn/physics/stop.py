"""An emergency stop by the brake on the motor: its torque at the gear, its time, angle and energy.

Motor and load turn uniformly when the brake closes. A torque that opposes the motion acts at the gear's output: gravity
and friction of the load, negative where the load drives. Arguments broadcast; NaN stands for what is not known.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hpn.physics.equations import ROUNDING, FloatArray, equation

Figure = FloatArray | float

STEP_FACTOR = 2.0
"""Peak over final torque of an undamped spring on which a torque acts at once."""


@equation
def dynamic_factor(*, rise_time_s: Figure, drive_resonance_Hz: Figure) -> FloatArray:
    """Dynamic factor 1 + |sin(π f t)| / (π f t) of a torque that rises linearly in t [-]; 2 where either is not known.

    Response of an undamped mass on a spring to a ramp; C. M. Harris, A. G. Piersol, Shock and Vibration Handbook,
    chapter on transient response.
    """
    turn = np.multiply(rise_time_s, drive_resonance_Hz)
    return np.where(np.isnan(turn), STEP_FACTOR, 1 + np.abs(np.sinc(turn)))


@dataclass(frozen=True, eq=False)
class Brake:
    """A brake that stops an axis through a gear; every figure broadcasts.

    Inertias are those of the motor, with the gear's at the input, and of the load at the output; where either is NaN
    the brake's whole torque counts. `efficiency` is the gear's.
    """

    torque_Nm: Figure
    ratio: Figure
    motor_inertia_kgm2: Figure
    load_inertia_kgm2: Figure
    efficiency: Figure = 1.0


@equation
def deceleration(*, brake: Brake, opposing_torque_Nm: Figure) -> FloatArray:
    """Deceleration a = (i T_B + η T_opp) / (i² J_m + η J) of the output in rad/s².

    η loses on the way from the load to the brake. Where the load lags behind and the motor drives it, 1/η stands for η.
    """
    a = _deceleration(brake, opposing_torque_Nm, brake.efficiency)
    lags = np.multiply(brake.load_inertia_kgm2, a) - opposing_torque_Nm < 0
    return np.where(lags, _deceleration(brake, opposing_torque_Nm, np.divide(1, brake.efficiency)), a)


def _deceleration(brake: Brake, T_opp: Figure, eta: Figure) -> FloatArray:
    inertia = np.square(brake.ratio) * brake.motor_inertia_kgm2 + np.multiply(eta, brake.load_inertia_kgm2)
    return np.asarray((np.multiply(brake.ratio, brake.torque_Nm) + np.multiply(eta, T_opp)) / inertia)


def is_stopped(*, brake: Brake, opposing_torque_Nm: Figure) -> NDArray[np.bool_]:
    """True where the brake decelerates the load, i T_B + η T_opp > 0, whatever the inertias are."""
    driving = -np.multiply(brake.efficiency, opposing_torque_Nm)
    stopped: NDArray[np.bool_] = np.multiply(brake.ratio, brake.torque_Nm) > driving * (1 + ROUNDING)
    return stopped


@equation
def stop_torque_at_rest(*, brake: Brake, opposing_torque_Nm: Figure) -> FloatArray:
    """Torque T_r = J a - T_opp in Nm that the gear bears while both ends slow down as one body.

    Where an inertia is not known i T_B / η, an upper bound.
    """
    rigid = brake.load_inertia_kgm2 * deceleration(brake=brake, opposing_torque_Nm=opposing_torque_Nm)
    bound = np.multiply(brake.ratio, brake.torque_Nm) / brake.efficiency
    return np.where(np.isnan(rigid), bound, rigid - opposing_torque_Nm)


@equation
def stop_torque(*, brake: Brake, opposing_torque_Nm: Figure, dynamic_factor: Figure) -> FloatArray:
    """Torque T_k = f |T_r| + (f - 1) max(T_opp, 0) of the gear in a stop in Nm.

    The gear starts from the torque that keeps a uniform speed, -T_opp, and swings about T_r. Exact for a step of the
    brake and T_opp ≥ 0, else an upper bound.
    """
    T_r = stop_torque_at_rest(brake=brake, opposing_torque_Nm=opposing_torque_Nm)
    f = np.asarray(dynamic_factor, dtype=np.float64)
    T_k: FloatArray = f * np.abs(T_r) + (f - 1) * np.maximum(opposing_torque_Nm, 0.0)
    return T_k


@equation
def largest_brake_torque(
    *, brake: Brake, opposing_torque_Nm: Figure, dynamic_factor: Figure, permissible_torque_Nm: Figure
) -> FloatArray:
    """Largest torque of the brake in Nm, its own not counted, at which T_k stays permissible; 0 where none does.

    `stop_torque` solved for T_B: T_r = (T - (f - 1) max(T_opp, 0)) / f, a = (T_r + T_opp) / J.
    """
    f, eta, T_opp = np.asarray(dynamic_factor), np.asarray(brake.efficiency), np.asarray(opposing_torque_Nm)
    T_r = (np.asarray(permissible_torque_Nm) - (f - 1) * np.maximum(T_opp, 0.0)) / f
    a = (T_r + T_opp) / brake.load_inertia_kgm2
    inertia = np.square(brake.ratio) * brake.motor_inertia_kgm2 + eta * brake.load_inertia_kgm2
    rigid = (a * inertia - eta * T_opp) / brake.ratio
    largest = np.where(np.isnan(rigid), T_r * eta / brake.ratio, rigid)
    return np.where(T_r < 0, 0.0, np.maximum(largest, 0.0))


@dataclass(frozen=True, eq=False)
class Stop:
    """Course of a stop: time in s and angle in rad from the command to rest, energy in J that the brake takes.

    NaN where an inertia is not known; infinite where the brake does not stop the load.
    """

    time_s: FloatArray
    angle_rad: FloatArray
    energy_J: FloatArray


def course_of_stop(
    *,
    brake: Brake,
    opposing_torque_Nm: Figure,
    speed_rad_per_s: Figure,
    reaction_time_s: Figure,
    rise_time_s: Figure,
) -> Stop:
    """Stop from a speed of the output: uniform change of speed for the dead time, then uniform deceleration.

    Half of the linear rise counts as dead time, which holds the angle's first-order part. Where the opposing torque
    alone stops the load before that, the brake takes no energy.
    """
    with np.errstate(all="ignore"):
        omega, T_opp = np.asarray(speed_rad_per_s, dtype=float), np.asarray(opposing_torque_Nm, dtype=float)
        dead = np.asarray(reaction_time_s) + np.asarray(rise_time_s) / 2
        inertia = brake.load_inertia_kgm2 + np.square(brake.ratio) * brake.motor_inertia_kgm2
        c = T_opp / inertia
        a = deceleration(brake=brake, opposing_torque_Nm=T_opp)
        slower = omega - c * dead
        alone, stops = slower <= 0, is_stopped(brake=brake, opposing_torque_Nm=T_opp)
        time = np.where(alone, omega / c, np.where(stops, dead + slower / a, np.inf))
        angle = omega * dead - c * dead**2 / 2 + slower**2 / (2 * a)
        angle = np.where(alone, omega**2 / (2 * c), np.where(stops, angle, np.inf))
        known = ~np.isnan(inertia)
        energy = np.where(alone, 0.0, inertia * slower**2 / 2)
    return Stop(*(np.where(known, figure, np.nan) for figure in (time, angle, energy)))


@equation
def impact_speed(
    *, momentary_peak_torque_Nm: Figure, torsional_stiffness_Nm_per_rad: Figure, inertia_kgm2: Figure
) -> FloatArray:
    """Speed T_M / √(K3 J) of the output in rpm from which an inertia that is caught by the gear alone reaches T_M.

    The inertia is the motor's at the output, i² J_m, where the load meets an end stop, and the load's where the motor
    locks. Energy of the inertia into the spring: J ω² / 2 = T² / (2 K3).
    """
    omega = np.asarray(momentary_peak_torque_Nm) / np.sqrt(np.multiply(torsional_stiffness_Nm_per_rad, inertia_kgm2))
    return omega * 30 / np.pi

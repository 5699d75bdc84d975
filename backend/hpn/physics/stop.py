"""An emergency stop by the brake on the motor: upper bounds of its torque at the gear, its time, angle and energy.

Motor and load are rigid, the gear between them is a spring of stiffness K3 with backlash γ. The bounds hold at any
instant of the motion, whether the motor switches off before, at, or through the rise of the brake's torque, and until
the load has come to rest. Arguments broadcast; NaN stands for unknown figures.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hpn.physics.equations import ROUNDING, FloatArray, equation

Figure = FloatArray | float


@dataclass(frozen=True, eq=False)
class BrakeFigures:
    """A brake that stops an axis through a gear; every figure broadcasts.

    The inertias are the motor's, including the gear's at the input, and the load's at the output; if either is NaN the
    brake's whole torque counts. `efficiency` is the gear's.
    """

    torque_Nm: Figure
    ratio: Figure
    motor_inertia_kgm2: Figure
    load_inertia_kgm2: Figure
    efficiency: Figure = 1.0

    @property
    def at_output_Nm(self) -> FloatArray:
        """Torque i T_B of the brake at the output in Nm."""
        return np.asarray(np.multiply(self.ratio, self.torque_Nm))

    @property
    def motor_at_output_kgm2(self) -> FloatArray:
        """Inertia i² J_m of the motor at the output in kg m²."""
        return np.asarray(np.square(self.ratio) * self.motor_inertia_kgm2)


@dataclass(frozen=True, eq=False)
class LoadTorques:
    """Torques of the load at the gear in Nm, none negative; every figure broadcasts.

    `pulling_Nm` T_d is the largest torque that may drive the load against the brake, at rest too, `driving_Nm` T_v ≤
    T_d the largest one during a stop, and `opposing_Nm` T_o ≥ T_d the largest torque that the gear may bear before the
    stop.
    """

    pulling_Nm: Figure = 0.0
    driving_Nm: Figure = 0.0
    opposing_Nm: Figure = 0.0


@dataclass(frozen=True, eq=False)
class Play:
    """A gear as a spring with backlash; every figure broadcasts."""

    torsional_stiffness_Nm_per_rad: Figure
    backlash_rad: Figure

    @property
    def crossed_Nm(self) -> FloatArray:
        """Torque K3 γ in Nm that would wind the gear up by its backlash."""
        return np.asarray(np.multiply(self.torsional_stiffness_Nm_per_rad, self.backlash_rad))


def is_stopped(*, brake: BrakeFigures, load: LoadTorques) -> NDArray[np.bool_]:
    """True where the brake decelerates the load, i T_B > T_v, for any inertias."""
    stopped: NDArray[np.bool_] = brake.at_output_Nm > np.multiply(load.driving_Nm, 1 + ROUNDING)
    return stopped


def is_held(*, brake: BrakeFigures, load: LoadTorques) -> NDArray[np.bool_]:
    """True where the brake holds the load at rest, i T_B > T_d."""
    holds: NDArray[np.bool_] = brake.at_output_Nm > np.multiply(load.pulling_Nm, 1 + ROUNDING)
    return holds


@equation
def settled_torque(*, brake: BrakeFigures, load: LoadTorques) -> FloatArray:
    """Torque T_r = (λ i T_B + T_d) / (1 + η λ) in Nm, λ = J / (i² J_m), about which the gear swings in a stop.

    Motor and load slow down as one body, the load driving the motor with losses; without an inertia
    max(i T_B / η, T_d).
    """
    J, m, at_output = brake.load_inertia_kgm2, brake.motor_at_output_kgm2, brake.at_output_Nm
    T_r = (J * at_output + m * load.pulling_Nm) / (m + np.multiply(brake.efficiency, J))
    return np.where(np.isnan(m + J), np.maximum(at_output / brake.efficiency, load.pulling_Nm), T_r)


@equation
def flank_share(*, brake: BrakeFigures) -> FloatArray:
    """Share B = (1 + λ/η) / (1 + η λ) of T_o² that stays after the losses [-]; without an inertia 1/η²."""
    J, m, eta = brake.load_inertia_kgm2, brake.motor_at_output_kgm2, np.asarray(brake.efficiency)
    return np.where(np.isnan(m + J), 1 / eta**2, (m + J / eta) / (m + eta * J))


@equation
def stop_torque(*, brake: BrakeFigures, load: LoadTorques, gear: Play, dynamic_factor: Figure) -> FloatArray:
    """Torque T_k = T_r + √(T_r² + 2 T_r (T_o + K3 γ) + B T_o²) in Nm, the gear's upper bound in a stop.

    The load leaves one flank under T_o, crosses the backlash under the brake's whole torque and swings about T_r on the
    other flank; the rise time of the brake doesn't lower the bound. With the user's own dynamic factor f T_k = f T_r +
    (f - 1) T_o; f is NaN without one.
    """
    T_o, f = np.asarray(load.opposing_Nm), np.asarray(dynamic_factor)
    T_r = settled_torque(brake=brake, load=load)
    swing = np.sqrt(T_r**2 + 2 * T_r * (T_o + gear.crossed_Nm) + flank_share(brake=brake) * T_o**2)
    T_k: FloatArray = np.where(np.isnan(f), T_r + swing, f * T_r + (f - 1) * T_o)
    return T_k


# --- Inverses ---------------------------------------------------------------------------------------------------------


@equation
def largest_brake_torque(
    *, brake: BrakeFigures, load: LoadTorques, gear: Play, dynamic_factor: Figure, permissible_torque_Nm: Figure
) -> FloatArray:
    """Largest torque T_B in Nm at which T_k stays within a limit L; the brake's own torque is ignored.

    `stop_torque` solved for T_B: T_r = (L² - B T_o²) / (2 (L + T_o + K3 γ)), or (L - (f - 1) T_o) / f with a factor, i
    T_B = (T_r (1 + η λ) - T_d) / λ; without inertias η T_r. 0 if no torque both keeps to the limit and stops the load;
    NaN if L is NaN.
    """
    J, m, eta = brake.load_inertia_kgm2, brake.motor_at_output_kgm2, np.asarray(brake.efficiency)
    L, T_o, f = np.asarray(permissible_torque_Nm), np.asarray(load.opposing_Nm), np.asarray(dynamic_factor)
    swung = (L**2 - flank_share(brake=brake) * T_o**2) / (2 * (L + T_o + gear.crossed_Nm))
    T_r = np.where(np.isnan(f), swung, (L - (f - 1) * T_o) / f)
    rigid = (T_r * (m + eta * J) - m * load.pulling_Nm) / J
    at_output = np.where(np.isnan(m + J), np.where(T_r < load.pulling_Nm, 0.0, eta * T_r), rigid)
    stopping = at_output > np.multiply(load.driving_Nm, 1 + ROUNDING)
    return np.where(np.isnan(at_output), np.nan, np.where(stopping, at_output / brake.ratio, 0.0))


@equation
def largest_load_inertia(
    *, brake: BrakeFigures, load: LoadTorques, gear: Play, dynamic_factor: Figure, permissible_torque_Nm: Figure
) -> FloatArray:
    """Largest inertia J of the load in kg m² at which T_k stays within a limit L; the load's own inertia is ignored.

    `stop_torque` is L where λ (2 i T_B (L + T_o + K3 γ) + T_o²/η - η L²) = L² - T_o² - 2 T_d (L + T_o + K3 γ); with a
    factor where λ (i T_B - η T_r) = T_r - T_d. Infinite if no inertia reaches the limit, 0 if every one exceeds it, NaN
    if the brake does not hold the load (T_k then falls with J) and without the motor's inertia.
    """
    m, eta, at_output = brake.motor_at_output_kgm2, np.asarray(brake.efficiency), brake.at_output_Nm
    L, T_d, T_o = (np.asarray(value) for value in (permissible_torque_Nm, load.pulling_Nm, load.opposing_Nm))
    f, reach = np.asarray(dynamic_factor), L + T_o + gear.crossed_Nm
    typed = (L - (f - 1) * T_o) / f
    room = np.where(np.isnan(f), L**2 - T_o**2 - 2 * T_d * reach, typed - T_d)
    slope = np.where(np.isnan(f), 2 * at_output * reach + T_o**2 / eta - eta * L**2, at_output - eta * typed)
    J = np.where(room <= 0, 0.0, np.where(slope <= 0, np.inf, m * room / slope))
    known = is_held(brake=brake, load=load) & ~np.isnan(m + room + slope)
    return np.where(known, J, np.nan)


# --- Course -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Stop:
    """Upper bounds of a stop: time in s and angle in rad from the command to rest, energy in J that the brake absorbs.

    NaN if an inertia is unknown; infinite if the brake does not stop the load.
    """

    time_s: FloatArray
    angle_rad: FloatArray
    energy_J: FloatArray


def course_of_stop(
    *,
    brake: BrakeFigures,
    load: LoadTorques,
    gear: Play,
    stop_torque_Nm: Figure,
    speed_rad_per_s: Figure,
    reaction_time_s: Figure,
    rise_time_s: Figure,
) -> Stop:
    """Stop from a speed ω of the output with T_v driving all along, losses left out.

    t_d = t_r + t_b/2 counts as dead time, ω₁ = ω + T_v t_d / (J + i² J_m), a = (i T_B - T_v) / (J + i² J_m). The time
    is t_d + ω₁/a + 1/(4 f₂), with f₂ the resonance of the drive; the angle
    φ = ω t_d + T_v t_d² / (2 (J + i² J_m)) + ω₁²/(2a) + γ + (T_k + T_o)/K3; the energy (J + i² J_m) ω²/2 + T_v φ.
    """
    with np.errstate(all="ignore"):
        omega, T_v, K3 = (
            np.asarray(x) for x in (speed_rad_per_s, load.driving_Nm, gear.torsional_stiffness_Nm_per_rad)
        )
        J, m = np.asarray(brake.load_inertia_kgm2), brake.motor_at_output_kgm2
        dead, inertia = np.asarray(reaction_time_s) + np.asarray(rise_time_s) / 2, J + m
        drawn, a = T_v / inertia, (brake.at_output_Nm - T_v) / inertia
        faster = omega + drawn * dead
        quarter = np.pi / 2 / np.sqrt(K3 * (1 / J + 1 / m))
        time = dead + faster / a + quarter
        wound = gear.backlash_rad + (np.asarray(stop_torque_Nm) + load.opposing_Nm) / K3
        angle = omega * dead + drawn * dead**2 / 2 + faster**2 / (2 * a) + wound
        energy = inertia * omega**2 / 2 + T_v * angle
        stops, known = is_stopped(brake=brake, load=load), ~np.isnan(inertia)
    figures = (np.where(stops, figure, np.inf) for figure in (time, angle, energy))
    return Stop(*(np.where(known, figure, np.nan) for figure in figures))


@equation
def impact_speed(
    *, momentary_peak_torque_Nm: Figure, torsional_stiffness_Nm_per_rad: Figure, inertia_kgm2: Figure
) -> FloatArray:
    """Speed T_M / √(K3 J) of the output in rpm from which an inertia that the gear alone catches reaches T_M.

    The inertia is the motor's at the output, i² J_m, if the load meets an end stop, and the load's if the motor locks.
    Energy of the inertia into the spring: J ω² / 2 = T² / (2 K3).
    """
    omega = np.asarray(momentary_peak_torque_Nm) / np.sqrt(np.multiply(torsional_stiffness_Nm_per_rad, inertia_kgm2))
    return omega * 30 / np.pi

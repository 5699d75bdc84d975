"""The handbook's selection equations (chapter 4.1, page 17), one function each.

Arguments are floats or arrays that broadcast; phases lie along the last axis. Symbols in the bodies are the
handbook's. Torque and speed enter by magnitude. Every function returns float64 arrays (0-d for scalars in).
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]

ROUNDING = 1e-12
"""Relative room for floating point, so that a limit met exactly passes (see the contract of checks)."""

TORSION_REFERENCE = 0.15
"""Share of the rated torque from which on the torsional stiffness K3 holds (glossary)."""


def average_output_torque(*, torque_Nm: ArrayLike, speed_rpm: ArrayLike, duration_s: ArrayLike) -> FloatArray:
    """Average output torque T_av in Nm, equation 17.2; shape (..., phases) in, (...) out.

    T_av = (sum |n| t |T|^(10/3) / sum |n| t)^(3/10). A holding phase (n = 0) has no weight. Torque is scaled by its
    largest, so that no power of it overflows or vanishes. NaN where nothing moves: the application forbids that.
    """
    w = np.abs(speed_rpm) * np.asarray(duration_s, dtype=float)
    r, T_max = _scaled(np.asarray(torque_Nm) * (w > 0))  # what is held must not set the scale
    return np.asarray(T_max * (np.vecdot(w, r * r * r * np.cbrt(r)) / np.add.reduce(w, axis=-1)) ** 0.3)


def average_output_speed(*, speed_rpm: ArrayLike, duration_s: ArrayLike, pause_s: ArrayLike) -> FloatArray:
    """Average output speed n_out_av in rpm, equation 17.4; shape (..., phases) in, (...) out.

    n_out_av = sum |n| t / (sum t + t_p). The pause counts here, and so does the time of a holding phase.
    """
    t = np.asarray(duration_s, dtype=float)
    return np.asarray(np.vecdot(np.abs(speed_rpm), t) / (np.add.reduce(t, axis=-1) + pause_s))


def average_input_speed(*, ratio: ArrayLike, average_output_speed_rpm: ArrayLike) -> FloatArray:
    """Average input speed n_in_av = i n_out_av in rpm, equation 17.5."""
    return np.asarray(np.multiply(ratio, average_output_speed_rpm), dtype=float)


def maximum_input_speed(*, ratio: ArrayLike, maximum_output_speed_rpm: ArrayLike) -> FloatArray:
    """Maximum input speed n_in_max = i n_out_max in rpm, equation 17.6."""
    return np.asarray(np.multiply(ratio, maximum_output_speed_rpm), dtype=float)


def repeated_peak_torque_utilisation(*, maximum_torque_Nm: ArrayLike, repeated_peak_torque_Nm: ArrayLike) -> FloatArray:
    """Load limit 2 as T_max / T_R [-]; equation 17.7 asks T_max <= T_R."""
    return np.asarray(np.divide(maximum_torque_Nm, repeated_peak_torque_Nm), dtype=float)


def momentary_peak_torque_utilisation(
    *, emergency_stop_torque_Nm: ArrayLike, momentary_peak_torque_Nm: ArrayLike
) -> FloatArray:
    """Load limit 3 as T_k / T_M [-]; equation 17.8 asks T_k <= T_M."""
    return np.asarray(np.divide(emergency_stop_torque_Nm, momentary_peak_torque_Nm), dtype=float)


def allowed_momentary_peaks(*, emergency_stop_torque_Nm: ArrayLike, repeated_peak_torque_Nm: ArrayLike) -> FloatArray:
    """Allowable number of momentary peak torques N_k max = 10^(8.5 - 1.5 T_k / T_R), equation 17.9 [-].

    A count, so it is rounded down. Holds for T_k > T_R; at or below T_R this equation sets no limit: infinite.
    NaN where T_R is not published.
    """
    T_k, T_R = np.asarray(emergency_stop_torque_Nm, dtype=float), np.asarray(repeated_peak_torque_Nm, dtype=float)
    N = np.floor(10.0 ** (8.5 - 1.5 * (T_k / T_R)) * (1 + ROUNDING))
    return np.asarray(np.where(T_k <= T_R, np.inf, N))


def life(
    *,
    average_torque_Nm: ArrayLike,
    average_input_speed_rpm: ArrayLike,
    rated_torque_Nm: ArrayLike,
    rated_input_speed_rpm: ArrayLike,
    life_at_rated_torque_h: float = 20_000.0,
) -> FloatArray:
    """Life L10 in hours, equation 17.10: 20000 h (n_rated / n_in_av) (T_N / T_av)^(10/3).

    Infinite where T_av is 0 or so small that the result exceeds floating point. NaN where T_N is not published.
    """
    T_av = np.asarray(average_torque_Nm, dtype=float)
    with np.errstate(divide="ignore", over="ignore"):
        r = np.asarray(rated_torque_Nm, dtype=float) / T_av
        return np.asarray(
            life_at_rated_torque_h
            * (np.divide(rated_input_speed_rpm, average_input_speed_rpm) * (r * r * r * np.cbrt(r)))
        )


def motor_torque(*, output_torque_Nm: ArrayLike, ratio: ArrayLike, efficiency: ArrayLike = 1.0) -> FloatArray:
    """Torque at the motor shaft T / (i eta) in Nm; loss-free, a lower bound, at the default efficiency of 1."""
    return np.asarray(np.asarray(output_torque_Nm, dtype=float) / (np.asarray(ratio) * np.asarray(efficiency)))


def torsion(
    *, maximum_torque_Nm: ArrayLike, rated_torque_Nm: ArrayLike, torsional_stiffness_Nm_per_rad: ArrayLike
) -> FloatArray:
    """Torsion of the output (T_max - 0.15 T_N) / K3 in arcmin, from 15 % of the rated torque up to T_max (glossary).

    K3 holds above that reference torque alone, so up to it there is nothing to work out: 0. NaN where a figure is not
    published. Backlash comes on top and is no part of it.
    """
    T_max, T_N = np.asarray(maximum_torque_Nm, dtype=float), np.asarray(rated_torque_Nm, dtype=float)
    above = np.maximum(T_max - TORSION_REFERENCE * T_N, 0.0)
    return np.asarray(np.degrees(above / np.asarray(torsional_stiffness_Nm_per_rad, dtype=float)) * 60)


def rms_torque(*, torque_Nm: ArrayLike, duration_s: ArrayLike, pause_s: ArrayLike) -> FloatArray:
    """Root mean square of the torque over the cycle, pause included, in Nm; shape (..., phases) in, (...) out."""
    t = np.asarray(duration_s, dtype=float)
    r, T_max = _scaled(torque_Nm)
    return np.asarray(T_max * np.sqrt(np.vecdot(r * r, t) / (np.add.reduce(t, axis=-1) + pause_s)))


def _scaled(values: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Magnitudes along the last axis relative to their largest, and that largest; relative to 1 where all are 0."""
    magnitude = np.abs(np.asarray(values, dtype=float))
    largest = np.maximum.reduce(magnitude, axis=-1)
    return magnitude / (largest + (largest == 0))[..., None], largest

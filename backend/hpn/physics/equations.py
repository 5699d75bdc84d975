"""The handbook's selection equations (chapter 4.1, page 17), one function each, in the handbook's symbols.

Arguments broadcast, so that one case and thousands go through the same code; a series over the phases lies along the
last axis. NaN stands for an unpublished figure, infinity for an unlimited one: neither raises nor warns. Torque and
speed enter by magnitude.
"""

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]

ROUNDING = 1e-12
"""Relative tolerance for floating point: a figure exactly at its limit passes."""

P = ParamSpec("P")


def equation(function: Callable[P, FloatArray]) -> Callable[P, FloatArray]:
    """Return float64 arrays, 0-d for scalars, without warnings: NaN and infinity are answers here."""

    @wraps(function)
    def computed(*arguments: P.args, **named: P.kwargs) -> FloatArray:
        with np.errstate(all="ignore"):
            return np.asarray(function(*arguments, **named), dtype=np.float64)

    return computed


def over_phases(*series: ArrayLike) -> tuple[FloatArray, ...]:
    """Series of one length along the last axis, as float64 arrays."""
    return np.broadcast_arrays(*(np.asarray(values, dtype=np.float64) for values in series))


def total(values: FloatArray) -> FloatArray:
    """Sum over the last axis, in the order of the phases.

    Padding of shorter cycles has no duration and thus changes no bit of the sum: numpy's own sum adds in an order that
    depends on the length.
    """
    result: FloatArray = np.add.accumulate(values, axis=-1)[..., -1]
    return result


def tied(values: FloatArray) -> FloatArray:
    """Places of values in their ascending order along the last axis; neighbours closer than ROUNDING share one.

    Values that tie in real numbers tie on every processor, whatever its last bits. NaN has the last place.
    """
    order = values.argsort(axis=-1)
    ascending = np.take_along_axis(values, order, -1)
    before, after = ascending[..., :-1], ascending[..., 1:]
    with np.errstate(invalid="ignore"):  # infinity less infinity
        close = (after - before < ROUNDING * np.abs(after)) & np.isfinite(after)
    steps = np.zeros(values.shape)
    np.cumsum(~(close | (before == after) | np.isnan(before)), axis=-1, out=steps[..., 1:])
    places = np.empty(values.shape)
    np.put_along_axis(places, order, steps, -1)
    return places


def power_ten_thirds(ratio: FloatArray) -> FloatArray:
    """Ratio ≥ 0 to the power 10/3, as a cube times a cube root: a fifth of the time of `**`. [-]"""
    power: FloatArray = ratio * ratio * ratio * np.cbrt(ratio)
    return power


@equation
def average_output_torque(*, torque_Nm: ArrayLike, speed_rpm: ArrayLike, duration_s: ArrayLike) -> FloatArray:
    """Average output torque T_av in Nm, equation 17.2; shape (..., phases) in, (...) out.

    T_av = (sum |n| t |T|^(10/3) / sum |n| t)^(3/10). A holding phase (n = 0) has no weight. Torque is scaled by its
    largest, so that no power of it overflows or vanishes. NaN where nothing moves: the application forbids that.
    """
    T, n, t = over_phases(torque_Nm, speed_rpm, duration_s)
    weight = np.abs(n) * t
    T = np.where(weight > 0, np.abs(T), 0.0)  # holding phases must not set the scale
    T_max = T.max(axis=-1)
    damage = weight * power_ten_thirds(T / np.where(T_max == 0, 1.0, T_max)[..., None])
    T_av: FloatArray = T_max * np.power(total(damage) / total(weight), 0.3)
    return T_av


@equation
def average_output_speed(*, speed_rpm: ArrayLike, duration_s: ArrayLike, pause_s: ArrayLike) -> FloatArray:
    """Average output speed n_out_av in rpm, equation 17.4; shape (..., phases) in, (...) out.

    n_out_av = sum |n| t / (sum t + t_p). The pause counts here, and so does the time of a holding phase.
    """
    n, t = over_phases(speed_rpm, duration_s)
    n_out_av: FloatArray = total(np.abs(n) * t) / (total(t) + np.asarray(pause_s))
    return n_out_av


@equation
def average_input_speed(*, ratio: ArrayLike, average_output_speed_rpm: ArrayLike) -> FloatArray:
    """Average input speed n_in_av = i n_out_av in rpm, equation 17.5."""
    return np.multiply(ratio, average_output_speed_rpm)


@equation
def maximum_input_speed(*, ratio: ArrayLike, maximum_output_speed_rpm: ArrayLike) -> FloatArray:
    """Maximum input speed n_in_max = i n_out_max in rpm, equation 17.6."""
    return np.multiply(ratio, maximum_output_speed_rpm)


@equation
def repeated_peak_torque_utilisation(*, maximum_torque_Nm: ArrayLike, repeated_peak_torque_Nm: ArrayLike) -> FloatArray:
    """Load limit 2 as T_max / T_R [-]; equation 17.7 asks T_max <= T_R."""
    return np.divide(maximum_torque_Nm, repeated_peak_torque_Nm)


@equation
def momentary_peak_torque_utilisation(
    *, emergency_stop_torque_Nm: ArrayLike, momentary_peak_torque_Nm: ArrayLike
) -> FloatArray:
    """Load limit 3 as T_k / T_M [-]; equation 17.8 asks T_k <= T_M."""
    return np.divide(emergency_stop_torque_Nm, momentary_peak_torque_Nm)


@equation
def momentary_peaks_at(*, emergency_stop_torque_Nm: ArrayLike, repeated_peak_torque_Nm: ArrayLike) -> FloatArray:
    """Number of emergency stops 10^(8.5 - 1.5 T_k / T_R) of equation 17.9, not rounded to a count [-]."""
    return np.power(10.0, 8.5 - 1.5 * np.divide(emergency_stop_torque_Nm, repeated_peak_torque_Nm))


@equation
def allowed_momentary_peaks(*, emergency_stop_torque_Nm: ArrayLike, repeated_peak_torque_Nm: ArrayLike) -> FloatArray:
    """Allowable number of emergency stops N_k max = 10^(8.5 - 1.5 T_k / T_R), equation 17.9 [-].

    A count, so it is rounded down. Holds for T_k > T_R; at or below T_R this equation sets no limit: infinite.
    NaN where T_R is not published.
    """
    T_k, T_R = np.asarray(emergency_stop_torque_Nm), np.asarray(repeated_peak_torque_Nm)
    N = momentary_peaks_at(emergency_stop_torque_Nm=T_k, repeated_peak_torque_Nm=T_R)
    return np.where(T_k <= T_R, np.inf, np.floor(N * (1 + ROUNDING)))


@equation
def emergency_stop_torque_for(*, momentary_peak_count: ArrayLike, repeated_peak_torque_Nm: ArrayLike) -> FloatArray:
    """Largest torque in Nm for N peaks by equation 17.9: T_R (8.5 - log10 N) / 1.5, but never less than T_R."""
    T_R = np.asarray(repeated_peak_torque_Nm)
    T_k: FloatArray = np.maximum(T_R, T_R * (8.5 - np.log10(momentary_peak_count)) / 1.5)
    return T_k


@equation
def life(
    *,
    average_torque_Nm: ArrayLike,
    average_input_speed_rpm: ArrayLike,
    rated_torque_Nm: ArrayLike,
    rated_input_speed_rpm: ArrayLike,
    life_at_rated_torque_h: ArrayLike = 20_000.0,
) -> FloatArray:
    """Life L10 in hours, equation 17.10: 20000 h (n_rated / n_in_av) (T_N / T_av)^(10/3).

    Infinite where T_av is 0 or so small that the result exceeds floating point. NaN where T_N is not published.
    """
    # A quotient of powers instead of a power of the quotient: one root per gear and per axis, none per pair.
    rated, average = (power_ten_thirds(np.asarray(torque)) for torque in (rated_torque_Nm, average_torque_Nm))
    reference = np.asarray(life_at_rated_torque_h) * np.asarray(rated_input_speed_rpm)
    L_10: FloatArray = reference * rated / (np.asarray(average_input_speed_rpm) * average)
    return L_10


@equation
def motor_torque(*, output_torque_Nm: ArrayLike, ratio: ArrayLike, efficiency: ArrayLike = 1.0) -> FloatArray:
    """Torque at the motor shaft T / (i eta) in Nm; loss-free, a lower bound, at the default efficiency of 1."""
    return np.divide(output_torque_Nm, np.multiply(ratio, efficiency))


@equation
def rms_torque(*, torque_Nm: ArrayLike, duration_s: ArrayLike, pause_s: ArrayLike) -> FloatArray:
    """Root mean square of the torque over the cycle, pause included, in Nm; shape (..., phases) in, (...) out."""
    T, t = over_phases(torque_Nm, duration_s)
    T_max = np.abs(T).max(axis=-1)
    r = T / np.where(T_max == 0, 1.0, T_max)[..., None]
    T_rms: FloatArray = T_max * np.sqrt(total(r * r * t) / (total(t) + np.asarray(pause_s)))
    return T_rms


@equation
def inertia_ratio(
    *,
    load_inertia_kgm2: ArrayLike,
    ratio: ArrayLike,
    motor_inertia_kgm2: ArrayLike,
    gear_inertia_kgm2: ArrayLike = 0.0,
) -> FloatArray:
    """Inertia of the load at the motor, with the gear's at its input, over the motor's: (J_L / i² + J_g) / J_m [-]."""
    gear = np.divide(gear_inertia_kgm2, motor_inertia_kgm2)
    return np.divide(load_inertia_kgm2, np.multiply(np.square(ratio), motor_inertia_kgm2)) + gear

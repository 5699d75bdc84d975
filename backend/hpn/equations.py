"""The handbook's selection equations (chapter 4.1, page 17), one function each.

Each body is one case in floats, in the handbook's symbols, and runs compiled (`hpn.compiled`): over all gears and
applications in `hpn.checks`, on arrays where it is called by name. Torque and speed enter by magnitude.
"""

import math
from typing import Any

import numpy as np

from hpn.compiled import equation, over_phases

ROUNDING = 1e-12
"""Relative room for floating point, so that a limit met exactly passes (see the contract of checks)."""

TORSION_REFERENCE = 0.15
"""Share of the rated torque from which on the torsional stiffness K3 holds (glossary)."""


@over_phases("(p),(p),(p)->()")
def average_output_torque(torque_Nm: Any, speed_rpm: Any, duration_s: Any) -> Any:
    """Average output torque T_av in Nm, equation 17.2; shape (..., phases) in, (...) out.

    T_av = (sum |n| t |T|^(10/3) / sum |n| t)^(3/10). A holding phase (n = 0) has no weight. Torque is scaled by its
    largest, so that no power of it overflows or vanishes. NaN where nothing moves: the application forbids that.
    """
    T_max = 0.0
    for k in range(torque_Nm.size):
        if abs(speed_rpm[k]) * duration_s[k] > 0:  # what is held must not set the scale
            T_max = max(T_max, abs(torque_Nm[k]))
    scale, damage, weight = T_max + (T_max == 0), 0.0, 0.0
    for k in range(torque_Nm.size):
        w, r = abs(speed_rpm[k]) * duration_s[k], abs(torque_Nm[k]) / scale
        damage += w * (r * r * r * np.cbrt(r)) if w > 0 else 0.0
        weight += w
    return T_max * (damage / weight) ** 0.3


@over_phases("(p),(p),()->()")
def average_output_speed(speed_rpm: Any, duration_s: Any, pause_s: Any) -> Any:
    """Average output speed n_out_av in rpm, equation 17.4; shape (..., phases) in, (...) out.

    n_out_av = sum |n| t / (sum t + t_p). The pause counts here, and so does the time of a holding phase.
    """
    way, time = 0.0, 0.0
    for k in range(speed_rpm.size):
        way += abs(speed_rpm[k]) * duration_s[k]
        time += duration_s[k]
    return way / (time + pause_s)


@equation
def average_input_speed(ratio: Any, average_output_speed_rpm: Any) -> Any:
    """Average input speed n_in_av = i n_out_av in rpm, equation 17.5."""
    return ratio * average_output_speed_rpm


@equation
def maximum_input_speed(ratio: Any, maximum_output_speed_rpm: Any) -> Any:
    """Maximum input speed n_in_max = i n_out_max in rpm, equation 17.6."""
    return ratio * maximum_output_speed_rpm


@equation
def repeated_peak_torque_utilisation(maximum_torque_Nm: Any, repeated_peak_torque_Nm: Any) -> Any:
    """Load limit 2 as T_max / T_R [-]; equation 17.7 asks T_max <= T_R."""
    return maximum_torque_Nm / repeated_peak_torque_Nm


@equation
def momentary_peak_torque_utilisation(emergency_stop_torque_Nm: Any, momentary_peak_torque_Nm: Any) -> Any:
    """Load limit 3 as T_k / T_M [-]; equation 17.8 asks T_k <= T_M."""
    return emergency_stop_torque_Nm / momentary_peak_torque_Nm


@equation
def allowed_momentary_peaks(emergency_stop_torque_Nm: Any, repeated_peak_torque_Nm: Any) -> Any:
    """Allowable number of momentary peak torques N_k max = 10^(8.5 - 1.5 T_k / T_R), equation 17.9 [-].

    A count, so it is rounded down. Holds for T_k > T_R; at or below T_R this equation sets no limit: infinite.
    NaN where T_R is not published.
    """
    T_k, T_R = emergency_stop_torque_Nm, repeated_peak_torque_Nm
    if T_k <= T_R:
        return math.inf
    return np.floor(10.0 ** (8.5 - 1.5 * (T_k / T_R)) * (1 + ROUNDING))


@equation
def life(
    average_torque_Nm: Any,
    average_input_speed_rpm: Any,
    rated_torque_Nm: Any,
    rated_input_speed_rpm: Any,
    life_at_rated_torque_h: Any = 20_000.0,
) -> Any:
    """Life L10 in hours, equation 17.10: 20000 h (n_rated / n_in_av) (T_N / T_av)^(10/3).

    Infinite where T_av is 0 or so small that the result exceeds floating point. NaN where T_N is not published.
    """
    r = rated_torque_Nm / average_torque_Nm
    return life_at_rated_torque_h * ((rated_input_speed_rpm / average_input_speed_rpm) * (r * r * r * np.cbrt(r)))


@equation
def motor_torque(output_torque_Nm: Any, ratio: Any, efficiency: Any = 1.0) -> Any:
    """Torque at the motor shaft T / (i eta) in Nm; loss-free, a lower bound, at the default efficiency of 1."""
    return output_torque_Nm / (ratio * efficiency)


@equation
def torsion(maximum_torque_Nm: Any, rated_torque_Nm: Any, torsional_stiffness_Nm_per_rad: Any) -> Any:
    """Torsion of the output (T_max - 0.15 T_N) / K3 in arcmin, from 15 % of the rated torque up to T_max (glossary).

    K3 holds above that reference torque alone, so up to it there is nothing to work out: 0. NaN where a figure is not
    published. Backlash comes on top and is no part of it.
    """
    above = maximum_torque_Nm - TORSION_REFERENCE * rated_torque_Nm
    return math.degrees((0.0 if above < 0 else above) / torsional_stiffness_Nm_per_rad) * 60


@over_phases("(p),(p),()->()")
def rms_torque(torque_Nm: Any, duration_s: Any, pause_s: Any) -> Any:
    """Root mean square of the torque over the cycle, pause included, in Nm; shape (..., phases) in, (...) out."""
    T_max = 0.0
    for k in range(torque_Nm.size):
        T_max = max(T_max, abs(torque_Nm[k]))
    scale, squares, time = T_max + (T_max == 0), 0.0, 0.0
    for k in range(torque_Nm.size):
        r = torque_Nm[k] / scale
        squares += r * r * duration_s[k]
        time += duration_s[k]
    return T_max * math.sqrt(squares / (time + pause_s))

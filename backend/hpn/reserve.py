"""How far each driver of an application may grow, or must shrink, until a check that it moves meets its limit.

In closed form, because every utilisation is a power of each driver: `MOVES` names the powers. The other inputs stay
as they are. A factor below 1 is what a rejected gear needs; all factors below 1 together are the remedy.
"""

from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from hpn.checks import ABSENT, Evaluation

FloatArray = NDArray[np.float64]

MOVES: dict[str, dict[str, float]] = {
    "torque": {
        "average_torque": 1.0,
        "repeated_peak_torque": 1.0,
        "life": 10 / 3,
        "motor_peak_torque": 1.0,
        "motor_rated_torque": 1.0,
    },
    "speed": {
        "average_input_speed": 1.0,
        "maximum_input_speed": 1.0,
        "life": 1.0,
        "output_bearing_life": 1 / 3,
        "motor_speed": 1.0,
    },
    "load": {"output_bearing_load": 1.0, "output_bearing_life": 1.0},
}
"""Driver -> check -> power with which the driver moves the utilisation of the check (eq. 17.2 to 17.10, ISO 281)."""


@dataclass(frozen=True, slots=True)
class Reserve:
    """Reserves of N applications on G gears, shape (N, G) each; infinite without a limit, NaN where not rated.

    Each factor multiplies all torques of the duty cycle (not the emergency stop), all speeds, or all loads; the
    emergency-stop torque is the largest permissible one in Nm. None where the application moves no such check.
    """

    torque: FloatArray | None
    speed: FloatArray | None
    load: FloatArray | None
    emergency_stop_torque_Nm: FloatArray | None


def reserve_of(evaluation: Evaluation) -> Reserve:
    """Reserves of every application on every gear of an evaluation."""
    with np.errstate(divide="ignore", over="ignore"):  # unlimited
        room = evaluation.case.duty.reserve_utilisation / evaluation.utilisation
        if len(evaluation.case.duty.applications) > 1:
            room[evaluation.status == ABSENT] = np.inf
        rooms = {check.code: room[index] for index, check in enumerate(evaluation.checks)}
        torque = None if _follows_a_curve(evaluation) else _factor(rooms, MOVES["torque"])
        speed, load = _factor(rooms, MOVES["speed"]), _factor(rooms, MOVES["load"])
    return Reserve(torque, speed, load, _emergency_stop_torque(evaluation))


def _factor(rooms: dict[str, FloatArray], powers: dict[str, float]) -> FloatArray | None:
    """Smallest (u / utilisation)^(1 / power) over the checks that a driver moves; None where it moves none."""
    factors = [rooms[code] if p == 1.0 else rooms[code] ** (1 / p) for code, p in powers.items() if code in rooms]
    return reduce(np.minimum, factors) if factors else None


def _follows_a_curve(evaluation: Evaluation) -> bool:
    """Whether a motor torque depends on an efficiency curve, which no closed form follows."""
    if not evaluation.case.catalogue.efficiency:
        return False
    asks = any(check.code.startswith("motor_") and check.code != "motor_speed" for check in evaluation.checks)
    return asks and any(a.requirements.efficiency is None for a in evaluation.case.duty.applications)


def _emergency_stop_torque(evaluation: Evaluation) -> FloatArray | None:
    """Largest T_k = min(u T_M, max(T_R, T_R (8.5 - log10 N) / 1.5)) in Nm, equations 17.8 and 17.9 solved for T_k.

    N is the smallest allowed number that the expected count needs: count / u, rounded up, since equation 17.9 gives a
    count. Without an expected count T_M alone limits.
    """
    case = evaluation.case
    if case.momentary_peak_count is None:
        return None
    duty, g = case.duty, case.gears.columns
    u = duty.reserve_utilisation
    by_torque = u * g.momentary_peak_torque_Nm
    count = duty.column(lambda a: a.emergency_stop.count if a.emergency_stop else None)
    if np.isnan(count).all():
        return np.asarray(by_torque)
    with np.errstate(over="ignore"):  # a reserve next to 0 leaves no stop above T_R
        needed = np.maximum(np.ceil(count / u * (1 - 1e-12)), 1.0)
    by_count = np.maximum(g.repeated_peak_torque_Nm, g.repeated_peak_torque_Nm * (8.5 - np.log10(needed)) / 1.5)
    return np.asarray(np.where(np.isnan(count), by_torque, np.minimum(by_torque, by_count)))

"""How far each driver of an application may grow, or must shrink, until a check that it moves meets its limit.

In closed form, because every utilisation is a power of each driver: `MOVES` names the powers. The other inputs stay
as they are. A factor below 1 is what a rejected gear needs; all factors below 1 together are the remedy.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hpn import checks as c
from hpn import duty as d
from hpn.checks import CHECKS, LOAD_CHECKS
from hpn.compiled import compiled

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


TORQUE_FACTOR, SPEED_FACTOR, LOAD_FACTOR, STOP_TORQUE = range(4)
"""What `reserve_on` gives, in this order."""

_POWERS = np.array([[powers.get(check.code, 0.0) for check in CHECKS[:LOAD_CHECKS]] for powers in MOVES.values()])


@compiled
def reserve_on(w: FloatArray, gear: FloatArray, put: FloatArray, curved: bool, reserve: FloatArray) -> None:
    """Write the reserve of one application on one gear, shape (4,); infinite without a limit, NaN where not rated.

    Factors on all torques of the duty cycle (not the emergency stop), on all speeds and on all loads, and the largest
    permissible emergency-stop torque in Nm. NaN also where the application moves no such check, and for the torque
    factor where a motor torque follows the gear's efficiency curve (`curved`), which no closed form does.
    """
    for driver in range(3):
        reserve[driver] = _factor(put, _POWERS[driver], w[d.UTILISATION])
    asks_of_motor = not (math.isnan(w[d.MOTOR_PEAK]) and math.isnan(w[d.MOTOR_RATED]))
    if curved and asks_of_motor and math.isnan(w[d.EFFICIENCY]):
        reserve[TORQUE_FACTOR] = math.nan
    reserve[STOP_TORQUE] = _emergency_stop_torque(w, gear[c.T_M], gear[c.T_R])


@compiled
def _factor(put: FloatArray, powers: FloatArray, u: float) -> Any:
    """Smallest (u / utilisation)^(1 / power) over the checks that a driver moves."""
    smallest, moved = math.inf, False
    for check in range(powers.size):
        if powers[check] == 0 or (math.isnan(put[c.DEMAND, check]) and math.isnan(put[c.LIMIT, check])):
            continue
        room = u / put[c.USED, check]
        factor = room if powers[check] == 1 else room ** (1 / powers[check])
        moved = True
        if math.isnan(factor):
            return math.nan  # not rated
        smallest = min(smallest, factor)
    return smallest if moved else math.nan


@compiled
def _emergency_stop_torque(w: FloatArray, T_M: float, T_R: float) -> Any:
    """Largest T_k = min(u T_M, max(T_R, T_R (8.5 - log10 N) / 1.5)) in Nm, equations 17.8 and 17.9 solved for T_k.

    N is the smallest allowed number that the expected count needs: count / u, rounded up, since equation 17.9 gives a
    count. Without an expected count T_M alone limits.
    """
    if math.isnan(w[d.STOP_TORQUE]):
        return math.nan
    u, count, by_torque = w[d.UTILISATION], w[d.STOP_COUNT], w[d.UTILISATION] * T_M
    if math.isnan(count):
        return by_torque
    # a reserve next to 0 leaves no stop above T_R
    needed = max(np.ceil(count / u * (1 - 1e-12)), 1.0)
    by_count = np.maximum(T_R, T_R * (8.5 - math.log10(needed)) / 1.5)
    return np.minimum(by_torque, by_count)  # NaN, not rated, stays

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
from hpn.equations import ROUNDING

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


TORQUE, SPEED, LOAD = range(3)
"""The drivers, as rows of `_POWERS`."""

_POWERS = np.array([[powers.get(check.code, 0.0) for check in CHECKS[:LOAD_CHECKS]] for powers in MOVES.values()])


@compiled
def reserve_on(
    wishes: FloatArray, gears: FloatArray, terms: FloatArray, curved: bool, n: int, g: int
) -> tuple[Any, Any, Any, Any]:
    """Reserve of application n on gear g: infinite without a limit, NaN where not rated.

    Factors on all torques of the duty cycle (not the emergency stop), on all speeds and on all loads, and the largest
    permissible emergency-stop torque in Nm. NaN also where the application moves no such check, and for the torque
    factor where a motor torque follows the gear's efficiency curve (`curved`), which no closed form does.
    """
    asks_of_motor = not (math.isnan(wishes[n, d.MOTOR_PEAK]) and math.isnan(wishes[n, d.MOTOR_RATED]))
    follows_curve = curved and asks_of_motor and math.isnan(wishes[n, d.EFFICIENCY])
    u = wishes[n, d.UTILISATION]
    return (
        math.nan if follows_curve else _factor(terms, n, g, TORQUE, u),
        _factor(terms, n, g, SPEED, u),
        _factor(terms, n, g, LOAD, u),
        _emergency_stop_torque(wishes[n, d.STOP_TORQUE], wishes[n, d.STOP_COUNT], u, gears[g, c.T_M], gears[g, c.T_R]),
    )


@compiled
def _factor(terms: FloatArray, n: int, g: int, driver: int, u: float) -> Any:
    """Smallest (u / utilisation)^(1 / power) over the checks that a driver moves."""
    smallest, moved = math.inf, False
    for check in range(_POWERS.shape[1]):
        power = _POWERS[driver, check]
        if power == 0 or (math.isnan(terms[n, g, check, c.DEMAND]) and math.isnan(terms[n, g, check, c.LIMIT])):
            continue
        room = u / terms[n, g, check, c.USED]
        factor = room if power == 1 else room ** (1 / power)
        moved = True
        if math.isnan(factor):
            return math.nan  # not rated
        smallest = min(smallest, factor)
    return smallest if moved else math.nan


@compiled
def _emergency_stop_torque(T_k: float, count: float, u: float, T_M: float, T_R: float) -> Any:
    """Largest T_k = min(u T_M, max(T_R, T_R (8.5 - log10 N) / 1.5)) in Nm, equations 17.8 and 17.9 solved for T_k.

    N is the smallest allowed number that the expected count needs: count / u, rounded up, since equation 17.9 gives a
    count. Without an expected count T_M alone limits.
    """
    by_torque = u * T_M
    if math.isnan(T_k):
        return math.nan
    if math.isnan(count):
        return by_torque
    # a reserve next to 0 leaves no stop above T_R
    needed = max(np.ceil(count / u * (1 - ROUNDING)), 1.0)
    by_count = np.maximum(T_R, T_R * (8.5 - math.log10(needed)) / 1.5)
    return np.minimum(by_torque, by_count)  # NaN, not rated, stays

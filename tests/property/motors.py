"""Motors at random, and torque curves of them."""

import random

from hpn.application import MotorEntry
from tests.build import Json


def motors(chance: random.Random, count: int, inertia: float = 1.0, *, curved: bool = False) -> list[MotorEntry]:
    """Motors over three decades of torque and inertia; some figures of one of ten are not known.

    With `curved` half of them have a torque curve as well.
    """
    result = []
    for number in range(count):
        torque, speed = 10 ** chance.uniform(-0.5, 2), chance.uniform(1000, 8000)
        figures = {
            "maximum_speed_rpm": speed,
            "rated_speed_rpm": speed / 2,
            "rated_torque_Nm": torque,
            "peak_torque_Nm": 3 * torque,
            "inertia_kgm2": 10 ** chance.uniform(-5, -2) * inertia,
            "weight_kg": round(chance.uniform(0.5, 9), 1),
        }
        known: Json = {name: value for name, value in figures.items() if chance.random() < 0.95}
        if curved and chance.random() < 0.5:
            known["curve"] = curve_at_random(chance, speed)
        result.append(MotorEntry.model_validate({"designation": f"M {number}", **known}))
    return result


def curve_at_random(chance: random.Random, last_rpm: float) -> list[Json]:
    """A torque curve that falls, of two to seven points apart; its peak rises at times."""
    count, continuous = chance.randint(2, 7), 10 ** chance.uniform(-0.5, 2)
    points, peak = [], 3 * continuous
    for place in range(count):
        points.append({"speed_rpm": last_rpm * place / (count - 1), "continuous_Nm": continuous, "peak_Nm": peak})
        continuous *= chance.uniform(0.6, 1)
        peak = max(continuous, peak * chance.uniform(0.5, 1.05))
    return points

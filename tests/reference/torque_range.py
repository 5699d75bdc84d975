"""Torques between which a gear winds up along a motion: sampled densely, in plain floats, from the contract alone.

It shares no code with the product. The acceleration of a move is a line between its kinks, or a sine, so that speed and
place follow exactly at every sample; each stretch between kinks is sampled with both of its ends.
"""

import itertools
from typing import Any

import numpy as np

from tests.reference.motion import Json, course
from tests.reference.motion_samples import load_of_floats

G = 9.80665


def torque_range(cycle: Json, *, at_rest: bool = False, count: int = 2000) -> tuple[float, float]:
    """T_lo and T_hi in Nm at the gear, of samples of the cycle or of its rest."""
    motion = cycle["motion"]
    mechanism, theta, result = motion["mechanism"], float(motion.get("start_deg", 0)), list[Any]()
    eta, ratio, friction = mechanism.get("efficiency", 1), mechanism.get("ratio", 1), dry_friction(mechanism)
    for move in motion["moves"]:
        way = float(move.get("angle_deg") or move.get("distance_mm") or 0)
        if not way:
            value_held = float(_load(mechanism, move, np.array([theta]), np.zeros(1), np.zeros(1), 0.0)[0])
            R = ((abs(value_held) + friction) / eta - abs(value_held)) / ratio
            result += [value_held / ratio - R, value_held / ratio + R]
        elif not at_rest:
            T = np.concatenate(
                [
                    _load(mechanism, move, theta + way * x, way * v, way * a, np.sign(way))
                    for x, v, a in _stretches(move, way, mechanism["type"] == "rotary", count)
                ]
            )
            result.append(T * np.where(np.sign(way) * T > 0, 1 / eta, eta) / ratio)
        theta += move.get("angle_deg", 0)
    if cycle.get("pause_s"):
        result += [-friction / (eta * ratio), friction / (eta * ratio)]
    every = np.concatenate([np.atleast_1d(each) for each in result])
    return float(every.min()), float(every.max())


def dry_friction(m: Json) -> float:
    """T_s in Nm: all dry friction, at the mechanism's shaft."""
    if m["type"] == "rotary":
        return float(m.get("friction_torque_Nm", 0))
    pressed = m.get("friction_coefficient", 0) * m["mass_kg"] * G * np.cos(np.radians(m.get("incline_deg", 0)))
    return float(m.get("friction_torque_Nm", 0) + (pressed + m.get("friction_force_N", 0)) * _per_rad(m) / 1000)


def _per_rad(m: Json) -> float:
    """Degrees or mm of way to a radian."""
    if m["type"] == "rotary":
        return 180 / np.pi
    return float(m["lead_mm"] / (2 * np.pi) if "lead_mm" in m else m["diameter_mm"] / 2)


def _load(m: Json, move: Json, place: Any, speed: Any, acceleration: Any, sign: float) -> Any:
    per_rad = _per_rad(m)
    return load_of_floats(m, move, per_rad, place, speed / per_rad, acceleration / per_rad, sign)


def _stretches(move: Json, way: float, rotary: bool, count: int) -> Any:
    """Place, speed and acceleration per way of 1 at the samples of each stretch between kinks."""
    one = course(move, way, 6 if rotary else 1)
    T = float(one.parts[-1])
    kinks = [float(t) for t in one.kinks]
    if move["profile"] == "modified_sine":
        for low, high in itertools.pairwise(kinks):
            yield _modified_sine(np.linspace(low, high, count), T, slow=T / 8 < (low + high) / 2 < 7 * T / 8)
        return
    t1, t2 = float(one.parts[0]), T - float(one.parts[-2])
    V, share = 1 / (T - (t1 + t2) / 2), move.get("jerk_share", 0.5) if move["profile"] == "s_curve" else 0
    x = v = 0.0
    for low, high in itertools.pairwise(kinks):
        if high - low < 1e-12 * T:
            continue
        start, end = (_ramped(t, (low + high) / 2, T, (t1, t2), V, share) for t in (low, high))
        s = np.linspace(0, high - low, count)
        jerk = (end - start) / (high - low)
        a, speed = start + jerk * s, v + start * s + jerk * s**2 / 2
        place = x + v * s + start * s**2 / 2 + jerk * s**3 / 6
        yield place, speed, a
        x, v = place[-1], speed[-1]


def _ramped(t: float, inside: float, T: float, ramps: tuple[float, float], V: float, share: float) -> float:
    """Acceleration at an end of a stretch, as it is on the side of the stretch, which holds the instant `inside`."""
    for length, place, middle, sign in ((ramps[0], t, inside, 1), (ramps[1], T - t, T - inside, -1)):
        if middle < length:
            rise, a = length * share / 2, V / (length * (1 - share / 2))
            return sign * a * (min(1.0, place / rise, (length - place) / rise) if rise else 1.0)
    return 0.0


def _modified_sine(t: Any, T: float, *, slow: bool) -> Any:
    """Neklutin's curve as printed in tables of cam curves, in x = t / T."""
    x, c = t / T, 1 / (4 + np.pi)
    if slow:
        turn = (np.pi + 4 * np.pi * x) / 3
        place = c * (2 + np.pi * x - 9 * np.sin(turn) / 4)
        return place, c * np.pi * (1 - 3 * np.cos(turn)) / T, 4 * c * np.pi**2 * np.sin(turn) / T**2
    turn = 4 * np.pi * x
    place = c * ((4 if x.mean() > 0.5 else 0) + np.pi * x - np.sin(turn) / 4)
    return place, c * np.pi * (1 - np.cos(turn)) / T, 4 * c * np.pi**2 * np.sin(turn) / T**2

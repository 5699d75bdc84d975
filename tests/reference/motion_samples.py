"""Figures of a motion from samples of it, in plain floats: a second way beside the integrals of `motion.py`."""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.reference.motion import Json, Way, course


def sampled(motion: Json, pause_s: float, count: int) -> dict[str, float]:
    """Figures of a cycle from samples of its motion at the middle of equal steps, in plain floats.

    Speed and place are summed up from the acceleration alone.
    """
    mechanism, moves = motion["mechanism"], motion["moves"]
    each = count // len(moves)
    theta, weights, damage, squares, time = float(motion.get("start_deg", 0)), 0.0, 0.0, 0.0, pause_s
    peak = fastest = 0.0
    for move in moves:
        duration, n, T = _samples(mechanism, move, theta, each)
        theta += move.get("angle_deg", 0)
        step = duration / each
        weights, time = weights + n.sum() * step, time + duration
        damage, squares = damage + (n * T ** (10 / 3)).sum() * step, squares + (T**2).sum() * step
        peak, fastest = max(peak, T.max()), max(fastest, n.max())
    return {
        "average_torque_Nm": float((damage / weights) ** 0.3),
        "average_output_speed_rpm": float(weights / time),
        "maximum_torque_Nm": float(peak),
        "maximum_output_speed_rpm": float(fastest),
        "rms_torque_Nm": float((squares / time) ** 0.5),
    }


def _samples(mechanism: Json, move: Json, theta: float, count: int) -> tuple[float, Any, Any]:
    """Duration, and |n| and |T| at the gear at the middle of steps."""
    rotary = mechanism["type"] == "rotary"
    per_rad = 180 / np.pi
    if not rotary:
        per_rad = mechanism["lead_mm"] / (2 * np.pi) if "lead_mm" in mechanism else mechanism["diameter_mm"] / 2
    way = float(move.get("angle_deg") or move.get("distance_mm") or 0)
    sign, eta, ratio = np.sign(way), mechanism.get("efficiency", 1), mechanism.get("ratio", 1)
    if not way:
        load = load_of_floats(mechanism, move, per_rad, np.full(count, theta), np.zeros(count), np.zeros(count), 0)
        return move["time_s"], np.zeros(count), np.abs(load) / ratio
    one = course(move, way, 6 if rotary else 1)
    duration = float(one.parts[-1])
    step = duration / count
    a = _acceleration(move, one, duration, (np.arange(count) + 0.5) * step)
    v = np.cumsum(a) * step - a * step / 2
    v *= 1 / (v.sum() * step)
    a *= 1 / (np.abs(a).sum() * step / 2) * v.max()
    x = np.cumsum(v) * step - v * step / 2
    load = load_of_floats(mechanism, move, per_rad, theta + way * x, way * v / per_rad, way * a / per_rad, sign)
    T = np.abs(load) * np.where(load * sign > 0, 1 / eta, eta) / ratio
    return duration, np.abs(way * v) / per_rad * ratio * 30 / np.pi, T


def _acceleration(move: Json, one: Way, duration: float, t: Any) -> Any:
    """Acceleration per way of 1 at instants, but for its scale."""
    if move["profile"] == "modified_sine":
        x = t / duration
        return np.where((x > 1 / 8) & (x < 7 / 8), np.sin((np.pi + 4 * np.pi * x) / 3), np.sin(4 * np.pi * x))
    share = move.get("jerk_share", 0.5) if move["profile"] == "s_curve" else 0
    shares = one.shares or (share, share)
    first, last = float(one.parts[0]), duration - float(one.parts[-2])

    def ramp(u: Any, length: float, share: float) -> Any:
        rise = length * share / 2
        shape = np.minimum(1, np.minimum(u, length - u) / rise) if rise else np.ones_like(u)
        return np.where(u < length, shape, 0) / (length - rise)

    return ramp(t, first, float(shares[0])) - ramp(duration - t, last, float(shares[1]))


def load_of_floats(m: Json, move: Json, per_rad: float, theta: Any, omega: Any, alpha: Any, sign: float) -> Any:
    if m["type"] == "rotary":
        gravity = m.get("gravity_mass_kg", 0) * 9.80665 * m.get("gravity_radius_mm", 0) / 1000
        friction = m.get("friction_torque_Nm", 0) * sign
        viscous = m.get("viscous_friction_Nm_per_rpm", 0) * omega * 30 / np.pi
        value_held = gravity * np.cos(np.radians(theta)) + move.get("external_torque_Nm", 0)
        return m["inertia_kgm2"] * alpha + friction + viscous + value_held
    r, beta = per_rad / 1000, np.radians(m.get("incline_deg", 0))
    hanging = m.get("counterweight_kg", 0)
    weight = 9.80665 * (m["mass_kg"] * np.sin(beta) - hanging * np.sign(beta))
    rubbing = 9.80665 * m["mass_kg"] * m.get("friction_coefficient", 0) * np.cos(beta) + m.get("friction_force_N", 0)
    force = (m["mass_kg"] + hanging) * alpha * r + weight + rubbing * sign + move.get("external_force_N", 0)
    return force * r + m.get("inertia_kgm2", 0) * alpha + m.get("friction_torque_Nm", 0) * sign

"""Motions worked out slowly from the contract alone: one instant at a time, in mpmath, with 30 digits.

It shares no code with the product. A move is a function of time, its torque follows from the contract's formula, and
what a phase comes to is integrated by mpmath between the instants at which ramp, run or the torque's sign change.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

from mpmath import mp, mpf

Json = dict[str, Any]
mp.dps = 30
G = mpf("9.80665")
STEPS = 60
"""Samples of a stretch between kinks, between which a torque is taken to change its sign once at most."""


@dataclass
class Way:
    """Course of a move over its way of 1: instants of its kinks, ends of its parts, and place, speed, acceleration."""

    kinks: list[Any]
    parts: list[Any]
    place: Callable[[Any], Any]
    speed: Callable[[Any], Any]
    acceleration: Callable[[Any], Any]
    shares: tuple[Any, Any] | None = None
    """Shares of the two ramps in which jerk acts, where they follow from it."""


def course(move: Json, way: Any, speed_unit: Any) -> Way:
    """Course of a move, in its own units per second."""
    T, D = (mpf(move["time_s"]) if "time_s" in move else None), abs(mpf(way))
    V = next((mpf(move[name]) * speed_unit for name in ("speed_rpm", "speed_mm_per_s") if name in move), None)
    a, b = (
        next((mpf(move[k]) for k in (f"{which}_deg_per_s2", f"{which}_mm_per_s2") if k in move), None)
        for which in ("acceleration", "deceleration")
    )
    t1, t2 = (mpf(move[k]) if k in move else None for k in ("acceleration_time_s", "deceleration_time_s"))
    if move["profile"] == "modified_sine":
        return modified_sine(T)
    jerk = next((mpf(move[k]) for k in ("jerk_deg_per_s3", "jerk_mm_per_s3") if k in move), None)
    if jerk:
        return jerked(D, T, V, (t1, a), (t2, b), jerk)
    share = mpf(move.get("jerk_share", "0.5")) if move["profile"] == "s_curve" else mpf(0)
    if move["profile"] == "triangular":
        T = T or (2 * D / V if V else 2 * mp.sqrt(D / a))
        return ramped(T / 2, mpf(0), share)
    k = 1 - share / 2
    if t1 or t2 or b or (T and V and a):
        return unequal(D, T, V, (t1, a), (t2, b), k, share)
    if T and V:
        ramp = min(T - D / V, T / 2)
    elif T and a:
        ramp = T / 2 - mp.sqrt(max(0, T**2 / 4 - D / (k * a)))
    elif T:
        ramp = T / 3
    else:
        ramp = V / (k * a)
        if V * ramp >= D:
            ramp = mp.sqrt(D / (k * a))
            V = D / ramp
        T = D / V + ramp
    return ramped(ramp, T - 2 * ramp, share)


def unequal(D: Any, T: Any, V: Any, first: Any, last: Any, k: Any, share: Any) -> Way:
    """Course with ramps of their own, each by (time, acceleration) as they are given; searches for the speed."""
    both = [first if any(first) else last, last if any(last) else first]

    def times(speed: Any) -> list[Any]:
        return [t or speed / (k * a) for t, a in both]

    ramps, run = ramps_of(D, T, V, times, last_is_given=not any(first))
    return joined(ramps, run, [share, share])


def jerked(D: Any, T: Any, V: Any, first: Any, last: Any, jerk: Any) -> Way:
    """Course whose ramps have a jerk, each with the share of it that follows from its speed and time."""
    both = [first if any(first) else last, last if any(last) else first]
    if not any(both[0]):
        both, V = [(min(T - D / V if V else T / 3, T / 2), None)] * 2, None

    def times(speed: Any) -> list[Any]:
        return [t or speed / a + a / jerk for t, a in both]

    ramps, run = ramps_of(D, T, V, times, last_is_given=not any(first))
    V = D / (run + sum(ramps) / 2)
    # V = A t - A² / j with the smaller root; what jerk takes of the ramp is twice A / j.
    peaks = [jerk * (t - mp.sqrt(max(0, t**2 - 4 * V / jerk))) / 2 for t in ramps]
    return joined(ramps, run, [2 * A / (jerk * t) for A, t in zip(peaks, ramps, strict=True)])


def ramps_of(D: Any, T: Any, V: Any, times: Callable[[Any], list[Any]], last_is_given: bool) -> tuple[list[Any], Any]:
    """Times of two ramps, which `times` has for a speed, and of the run between them."""
    if T and V:
        own = 1 if last_is_given else 0
        ramps = times(V)
        ramps[1 - own] = 2 * (T - D / V) - ramps[own]
        return ramps, T - sum(ramps)
    if T:
        # Way of a course of this time grows with its speed up to that of the triangle.
        V = bisected(lambda speed: speed * (T - sum(times(speed)) / 2) - D, mpf(0), 2 * D / T)
        return times(V), T - sum(times(V))
    if V * sum(times(V)) / 2 > D:
        V = bisected(lambda speed: speed * sum(times(speed)) / 2 - D, mpf(0), V)
    return times(V), D / V - sum(times(V)) / 2


def joined(ramps: list[Any], run: Any, shares: list[Any]) -> Way:
    """Course over a way of 1 of two ramps, each with its share of jerk, and the run between them."""
    T, V = sum(ramps) + run, 1 / (sum(ramps) / 2 + run)
    halves = [ramped(ramp, mpf(0), share) for ramp, share in zip(ramps, shares, strict=True)]  # triangles, half of each

    def part(t: Any, of: str) -> Any:
        scale = V * ramps[0 if t <= ramps[0] else 1]
        if t <= ramps[0]:
            return scale * getattr(halves[0], of)(t)
        if t < T - ramps[1]:
            return {"place": V * (t - ramps[0] / 2), "speed": V, "acceleration": mpf(0)}[of]
        value = scale * getattr(halves[1], of)(T - t)
        return {"place": 1 - value, "speed": value, "acceleration": -value}[of]

    rises = [ramp * share / 2 for ramp, share in zip(ramps, shares, strict=True)]
    kinks = {0, rises[0], ramps[0] - rises[0], ramps[0], T - ramps[1], T - ramps[1] + rises[1], T - rises[1], T}
    ends = [ramps[0], T] if run < mpf(10) ** -25 else [ramps[0], T - ramps[1], T]
    place, speed, acceleration = (partial(part, of=of) for of in ("place", "speed", "acceleration"))
    return Way(sorted(kinks), ends, place, speed, acceleration, (shares[0], shares[1]))


def bisected(function: Callable[[Any], Any], low: Any, high: Any) -> Any:
    """Zero of a function that grows between two arguments, to 30 digits."""
    for _ in range(110):
        middle = (low + high) / 2
        low, high = (middle, high) if function(middle) < 0 else (low, middle)
    return (low + high) / 2


def ramped(ramp: Any, run: Any, share: Any) -> Way:
    """Ramp, run, ramp; jerk acts in the first and last half share of a ramp."""
    T, rise = 2 * ramp + run, ramp * share / 2
    V = 1 / (ramp + run)
    a = V / (ramp - rise)

    def acceleration(t: Any) -> Any:
        if t > T / 2:
            return -acceleration(T - t)
        if t >= ramp:
            return mpf(0)
        return a * min(mpf(1), t / rise, (ramp - t) / rise) if rise else a

    def speed(t: Any) -> Any:
        if t > T / 2:
            return speed(T - t)
        if t >= ramp:
            return V
        if t > ramp / 2 and rise:
            return V - speed(ramp - t)
        return a * t**2 / (2 * rise) if rise and t < rise else a * (t - rise / 2)

    def place(t: Any) -> Any:
        if t > T / 2:
            return 1 - place(T - t)
        if t >= ramp:
            return V * (t - ramp / 2)
        if t > ramp / 2 and rise:
            return V * (t - ramp / 2) + place(ramp - t)
        if rise and t < rise:
            return a * t**3 / (6 * rise)
        return a * (t**2 / 2 - rise * t / 2 + rise**2 / 6)

    half = [rise, ramp - rise, ramp] if rise else [ramp]
    return Way(sorted({0, T, *half, *(T - t for t in half)}), [ramp, ramp + run, T], place, speed, acceleration)


def modified_sine(T: Any) -> Way:
    """Neklutin's curve as printed in tables of cam curves, in x = t / T."""
    c = 1 / (4 + mp.pi)

    def place(t: Any) -> Any:
        x = t / T
        if x <= mpf(1) / 8:
            return c * (mp.pi * x - mp.sin(4 * mp.pi * x) / 4)
        if x >= mpf(7) / 8:
            return c * (4 + mp.pi * x - mp.sin(4 * mp.pi * x) / 4)
        return c * (2 + mp.pi * x - 9 * mp.sin((mp.pi + 4 * mp.pi * x) / 3) / 4)

    def speed(t: Any) -> Any:
        x = t / T
        slow = mpf(1) / 8 < x < mpf(7) / 8
        return c * mp.pi * (1 - (3 * mp.cos((mp.pi + 4 * mp.pi * x) / 3) if slow else mp.cos(4 * mp.pi * x))) / T

    def acceleration(t: Any) -> Any:
        x = t / T
        slow = mpf(1) / 8 < x < mpf(7) / 8
        return 4 * c * mp.pi**2 * (mp.sin((mp.pi + 4 * mp.pi * x) / 3) if slow else mp.sin(4 * mp.pi * x)) / T**2

    return Way([0, T / 8, T / 2, 7 * T / 8, T], [T / 2, T], place, speed, acceleration)


@dataclass
class Stretch:
    """A phase: its move, torque (signed at the gear), speed and acceleration (rad/s, at the gear) as functions."""

    move: int
    start: Any
    end: Any
    kinks: list[Any]
    torque: Callable[[Any], Any]
    speed: Callable[[Any], Any]
    acceleration: Callable[[Any], Any]

    def integral(self, function: Callable[[Any], Any]) -> Any:
        inner = [t for t in self.kinks if self.start < t < self.end]
        # between kinks and zeros so many nodes leave an error far below 1e-12
        return mp.quad(function, [self.start, *inner, self.end], maxdegree=5)


def stretches(motion: Json) -> list[Stretch]:
    """Every phase of a motion."""
    mechanism, found = motion["mechanism"], []
    theta = mpf(motion.get("start_deg", 0))
    for index, move in enumerate(motion["moves"]):
        found += list(_of_move(mechanism, index, move, theta))
        theta += mpf(move.get("angle_deg", 0))
    return found


def _of_move(mechanism: Json, index: int, move: Json, theta: Any) -> list[Stretch]:
    rotary = mechanism["type"] == "rotary"
    rho = mpf(180) / mp.pi  # units of way per radian
    if "lead_mm" in mechanism:
        rho = mpf(mechanism["lead_mm"]) / (2 * mp.pi)
    elif "diameter_mm" in mechanism:
        rho = mpf(mechanism["diameter_mm"]) / 2
    way = mpf(move.get("angle_deg" if rotary else "distance_mm", 0))
    sign, ratio, eta = mp.sign(way), mpf(mechanism.get("ratio", 1)), mpf(mechanism.get("efficiency", 1))
    if way == 0:
        T = mpf(move["time_s"])
        one = Way([0, T], [T], lambda t: mpf(0), lambda t: mpf(0), lambda t: mpf(0))
    else:
        one = course(move, way, 6 if rotary else 1)
    load, own_speed = _load(mechanism, move, rho, rotary), cache(one.speed)

    @cache  # two integrals meet at the same instants
    def shaft(t: Any) -> Any:
        at = (theta + way * one.place(t), way * own_speed(t) / rho, way * one.acceleration(t) / rho)
        return load(*at, sign)

    def at_gear(t: Any) -> Any:
        T = shaft(t)
        if sign == 0:
            return T / ratio
        return T / (eta * ratio) if T * sign > 0 else T * eta / ratio

    found, start = [], mpf(0)
    for end in one.parts:
        kinks = sorted({start, *(t for t in one.kinks if start < t < end), end})
        edges = [start, *_zeros(shaft, kinks), end] if sign else [start, end]
        for low, high in itertools.pairwise(edges):
            if high > low:
                speed, acceleration = (
                    _scaled(own_speed, way / rho * ratio),
                    _scaled(one.acceleration, way / rho * ratio),
                )
                found.append(Stretch(index, low, high, one.kinks, at_gear, speed, acceleration))
        start = end
    return found


def _scaled(function: Callable[[Any], Any], factor: Any) -> Callable[[Any], Any]:
    return lambda t: factor * function(t)


def _load(m: Json, move: Json, rho: Any, rotary: bool) -> Callable[[Any, Any, Any, Any], Any]:
    """Torque of the load from place (deg), speed and acceleration (rad) and direction."""
    if rotary:

        def torque(theta: Any, omega: Any, alpha: Any, sign: Any) -> Any:
            rpm = omega * 30 / mp.pi
            gravity = mpf(m.get("gravity_mass_kg", 0)) * G * mpf(m.get("gravity_radius_mm", 0)) / 1000
            return (
                mpf(m["inertia_kgm2"]) * alpha
                + mpf(m.get("friction_torque_Nm", 0)) * sign
                + mpf(m.get("viscous_friction_Nm_per_rpm", 0)) * rpm
                + gravity * mp.cos(theta * mp.pi / 180)
                + mpf(move.get("external_torque_Nm", 0))
            )

        return torque

    def linear(theta: Any, omega: Any, alpha: Any, sign: Any) -> Any:
        r, mass, beta = rho / 1000, mpf(m["mass_kg"]), mpf(m.get("incline_deg", 0)) * mp.pi / 180
        a, hanging = alpha * r, mpf(m.get("counterweight_kg", 0))
        weight = mass * G * mp.sin(beta) - hanging * G * mp.sign(beta)
        rubbing = (
            mpf(m.get("friction_coefficient", 0)) * mass * G * mp.cos(beta) + mpf(m.get("friction_force_N", 0))
        ) * sign
        force = (mass + hanging) * a + weight + rubbing + mpf(move.get("external_force_N", 0))
        return force * r + mpf(m.get("inertia_kgm2", 0)) * a / r + mpf(m.get("friction_torque_Nm", 0)) * sign

    return linear


def _zeros(function: Callable[[Any], Any], kinks: list[Any]) -> list[Any]:
    found = []
    for start, end in itertools.pairwise(kinks):
        grid = [start + (end - start) * (k + mpf("1e-9")) / (STEPS + mpf("2e-9")) for k in range(STEPS + 1)]
        values = [function(t) for t in grid]
        for a, b, fa, fb in zip(grid, grid[1:], values, values[1:], strict=False):
            if fa * fb < 0:
                found.append(mp.findroot(function, (a, b), solver="anderson", tol=1e-50, verify=False))
    return found


def phases(motion: Json) -> list[dict[str, float]]:
    """Phases of a motion as the contract defines them, with the six fields that vary."""
    return [_phase(one) for one in stretches(motion)]


def _phase(one: Stretch) -> dict[str, float]:
    duration, middle = one.end - one.start, (one.start + one.end) / 2
    angle = one.integral(lambda t: abs(one.speed(t)))
    squares = one.integral(lambda t: one.torque(t) ** 2)
    largest = peak(one)
    mean = largest
    if angle:
        damage = one.integral(lambda t: abs(one.speed(t)) * abs(one.torque(t)) ** (mpf(10) / 3))
        mean = (damage / angle) ** (mpf(3) / 10)
    return {
        "move": one.move,
        "torque_Nm": float(mp.sign(one.torque(middle)) * mean),
        "speed_rpm": float(mp.sign(one.speed(middle)) * angle / duration * 30 / mp.pi),
        "duration_s": float(duration),
        "peak_torque_Nm": float(largest),
        "peak_speed_rpm": float(max(abs(one.speed(t)) for t in (one.start, one.end)) * 30 / mp.pi),
        "rms_torque_Nm": float(mp.sqrt(squares / duration)),
    }


def peak(one: Stretch) -> Any:
    """Supremum of |T|: the largest of a fine grid, and of a golden section about it."""
    inside = (one.end - one.start) * mpf("1e-28")
    low, high = one.start + inside, one.end - inside
    grid = sorted({low, high, *(t for t in one.kinks if low < t < high), *mp.linspace(low, high, 101)})
    best = max(range(len(grid)), key=lambda k: abs(one.torque(grid[k])))
    a, b = grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)]
    share = (mp.sqrt(5) - 1) / 2
    for _ in range(75):
        c, d = b - share * (b - a), a + share * (b - a)
        a, b = (a, d) if abs(one.torque(c)) > abs(one.torque(d)) else (c, b)
    return max(abs(one.torque(t)) for t in (grid[best], (a + b) / 2))

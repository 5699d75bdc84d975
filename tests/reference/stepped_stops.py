"""Stops of two masses stepped in time, all at once: a program that shares nothing with the product.

The motor and the load are two masses on a spring with a gap. Brake and friction are dry: they slip against the motion
and stick at rest. Losses of gear and mechanism go by the sense of the power in each. Everything stands at the
gear's output, torque in Nm, inertia in kg m², angle in rad.
"""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Figures = NDArray[np.float64]

OFF_EARLY, HELD, PASSES_OVER, OFF_LATE = range(4)
"""Behaviours of the motor: off before the brake's torque rises, held until it begins to rise, fading as it rises, and,
which works against the brake, held until it has risen."""

PER_PERIOD = 200
"""Steps in a period of the drive's resonance, of which a step errs by (2π / 200)² / 24 = 4e-5."""


@dataclass(frozen=True)
class Stops:
    """Stops as they are drawn, each figure of shape (stops,).

    `weight_Nm` and `acceleration` are signed in the sense of the motion, in which a positive weight opposes it;
    `friction_Nm` is dry. `off_s` is when the motor goes off; one that PASSES_OVER begins to fade as the brake rises.
    """

    stiffness: Figures
    gap: Figures
    motor: Figures
    load: Figures
    efficiency: Figures
    mechanism: Figures
    brake_Nm: Figures
    weight_Nm: Figures
    friction_Nm: Figures
    acceleration: Figures
    speed: Figures
    reaction_s: Figures
    rise_s: Figures
    off_s: Figures
    behaviour: Figures
    direction: Figures

    @property
    def resonance(self) -> Figures:
        """Circular frequency of motor and load against each other in rad/s."""
        return np.sqrt(self.stiffness * (1 / self.motor + 1 / self.load))

    @property
    def opposing_Nm(self) -> Figures:
        """Largest torque at the gear before the stop: weight, friction and the load's inertia, by magnitude."""
        whole = np.abs(self.weight_Nm) + self.friction_Nm + self.load * np.abs(self.acceleration)
        return whole / self.mechanism


def drawn(chance: Generator, stiffness: Figures, gap: Figures, rated_Nm: Figures) -> Stops:
    """Stops on gears of which each has its stiffness, its gap and a torque that the brake's is like."""
    count = len(stiffness)

    def some(low: float, high: float, share: float = 1.0) -> Figures:
        return chance.uniform(low, high, count) * (chance.random(count) < share)

    motor = stiffness / (2 * np.pi * 10 ** some(0.5, 2.5)) ** 2
    load = motor * 10 ** some(-1, 1.5)
    brake = rated_Nm * some(0.05, 1.2)
    weight = brake * some(0, 0.9, 0.7) * chance.choice((-1, 1), count)
    period = 2 * np.pi / np.sqrt(stiffness * (1 / motor + 1 / load))
    reaction, rise = period * some(0, 3, 0.7), period * some(0, 3, 0.7)
    slowing = (brake - np.abs(weight)) / (motor + load)
    speed = slowing * period * 10 ** some(-0.5, 1.3)
    acceleration = brake / load * some(-0.7, 0.7, 0.5)
    most = 0.8 * speed / np.maximum(reaction + rise, 1e-9 * period)
    behaviour = chance.integers(0, 4, count)
    off = np.choose(behaviour, (reaction * some(0, 1), reaction, reaction + rise, reaction + rise))
    return Stops(
        stiffness=stiffness,
        gap=gap,
        motor=motor,
        load=load,
        efficiency=1 - some(0, 0.5, 0.8),
        mechanism=1 - some(0, 0.4, 0.4),
        brake_Nm=brake,
        weight_Nm=weight,
        friction_Nm=brake * some(0, 0.4, 0.5),
        acceleration=np.clip(acceleration, -most, most),
        speed=speed,
        reaction_s=reaction,
        rise_s=rise,
        off_s=off,
        behaviour=behaviour.astype(float),
        direction=chance.choice((-1.0, 1.0), count),
    )


@dataclass(frozen=True)
class Stepped:
    """Results of stops, each of shape (stops,).

    The largest torque in the gear, the time from the command until the brake has first brought the motor to rest, the
    largest angle of the load until it has swung out, and the energy that the brake took.
    """

    torque_Nm: Figures
    time_s: Figures
    angle_rad: Figures
    energy_J: Figures


def stepped(stops: Stops, until_s: Figures) -> Stepped:
    """Stops stepped from the command until an instant of each, the load's swinging at rest included.

    Leapfrog, second order; friction and losses are an impulse of each step that brings a mass to rest at most.
    """
    s, K, eta, eta_m = stops, stops.stiffness, stops.efficiency, stops.mechanism
    h = 2 * np.pi / s.resonance / PER_PERIOD
    v, w, x, y, driving = _before(s)
    peak, furthest, energy, rested = np.abs(_spring(s, x - y)), *np.zeros((2, *K.shape)), np.full_like(K, np.inf)
    for step in range(int(np.ceil((until_s / h).max()))):
        t = (step + 0.5) * h
        x, y = x + h / 2 * v, y + h / 2 * w
        torque = _spring(s, x - y)
        share = np.clip((t - s.reaction_s) / np.maximum(s.rise_s, 1e-12), 0, 1)
        on = np.where(s.behaviour == PASSES_OVER, 1 - share, t < s.off_s)
        v = v + h / s.motor * (driving * on - torque)
        lost = np.abs(torque) * np.where(torque * v > 0, 1 / eta - 1, 1 - eta)
        v = _rubbed(v, h / s.motor * (s.brake_Nm * share + lost))
        w = w + h / s.load * (torque - s.direction * s.weight_Nm)
        lost = np.abs(torque) * np.where(torque * w > 0, 1 - eta_m, 1 / eta_m - 1)
        w = _rubbed(w, h / s.load * (s.friction_Nm + lost))
        x, y = x + h / 2 * v, y + h / 2 * w
        energy += s.brake_Nm * share * np.abs(v) * h
        peak, furthest = np.maximum(peak, np.abs(torque)), np.maximum(furthest, y * s.direction)
        rested = np.where(np.isinf(rested) & (v * s.direction <= 0), t, rested)
    return Stepped(peak, rested, furthest, energy)


def _before(s: Stops) -> tuple[Figures, ...]:
    """Speeds and angles of motor and load at the command, and the torque with which the motor drives.

    Both move with the acceleration, and no faster than the speed of the stop before the brake is on.
    """
    ahead = np.maximum(s.acceleration, 0) * (s.reaction_s + s.rise_s)
    speed = s.direction * (s.speed - ahead)
    needed = s.load * s.acceleration + s.weight_Nm + s.friction_Nm
    torque = np.where(needed > 0, needed / s.mechanism, needed * s.mechanism)
    at_motor = np.where(torque > 0, torque / s.efficiency, torque * s.efficiency)
    twist = s.direction * (torque / s.stiffness + np.sign(torque) * s.gap / 2)
    return speed, speed, twist, np.zeros_like(twist), s.direction * (s.motor * s.acceleration + at_motor)


def _spring(s: Stops, twist: Figures) -> Figures:
    """Torque of the gear: none within the gap."""
    torque: Figures = s.stiffness * (np.maximum(twist - s.gap / 2, 0) + np.minimum(twist + s.gap / 2, 0))
    return torque


def _rubbed(speed: Figures, most: Figures) -> Figures:
    """Speed after a step of friction, which changes it by so much at most and not beyond rest."""
    slower: Figures = np.sign(speed) * np.maximum(np.abs(speed) - most, 0)
    return slower

"""Torque over the pieces of a motion: its zeros, its extremes, its means."""

from collections.abc import Callable

import numpy as np

from hpn.physics.equations import ROUNDING, FloatArray, total
from hpn.physics.motion.pieces import Pieces, PlaceArray

Function = Callable[[Pieces, FloatArray], FloatArray]


def torque_at(p: Pieces, t: FloatArray) -> FloatArray:
    """Torque J α + b ω + G cos θ + held in Nm; 0 where it is below ROUNDING of its largest term.

    Thus no rounding error has a sign.
    """
    turning, held = p.inertia_kgm2 * p.acceleration_at(t), p.held_Nm
    torque, largest = turning + held, np.maximum(np.abs(turning), np.abs(held))
    if p.viscous_Nms.any():
        rubbing = p.viscous_Nms * p.speed_at(t)
        torque, largest = torque + rubbing, np.maximum(largest, np.abs(rubbing))
    if p.gravity_Nm.any():
        torque, largest = torque + p.gravity_Nm * p.cosine_at(t), np.maximum(largest, p.gravity_Nm)
    return np.where(np.abs(torque) < ROUNDING * largest, 0.0, torque)


def slope_at(p: Pieces, t: FloatArray) -> FloatArray:
    """First derivative of the torque in Nm/s."""
    slope = p.inertia_kgm2 * p.jerk_at(t) + p.viscous_Nms * p.acceleration_at(t)
    return slope - p.gravity_Nm * p.sine_at(t) * p.speed_at(t) if p.gravity_Nm.any() else slope


def curvature_at(p: Pieces, t: FloatArray) -> FloatArray:
    """Second derivative of the torque in Nm/s²."""
    curvature = p.inertia_kgm2 * p.snap_at(t) + p.viscous_Nms * p.jerk_at(t)
    if not p.gravity_Nm.any():
        return curvature
    turning = p.cosine_at(t) * p.speed_at(t) ** 2 + p.sine_at(t) * p.acceleration_at(t)
    return curvature - p.gravity_Nm * turning


# --- Zeros ------------------------------------------------------------------------------------------------------------

EDGE = 1e-12
"""Share of a piece next to its ends within which a zero counts as one at the end."""


def monotone(pieces: Pieces) -> Pieces:
    """Pieces cut where the torque has an extreme, so that it is monotone in each."""
    return cut_at_zeros(slope_at, cut_at_zeros(curvature_at, pieces))


def cut_at_zeros(function: Function, pieces: Pieces) -> Pieces:
    """Pieces cut where a function changes its sign between their ends, once in each, to machine precision."""
    low, high = function(pieces, pieces.start_s), function(pieces, pieces.end_s)
    crossed = np.flatnonzero(np.sign(low) * np.sign(high) < 0)
    if not crossed.size:
        return pieces
    some = pieces.at(crossed)
    instants = zeros(lambda t: function(some, t), some.start_s, some.end_s)
    room = EDGE * (some.end_s - some.start_s)
    inside = (instants - some.start_s > room) & (some.end_s - instants > room)
    return cut(pieces, crossed[inside], instants[inside])


def cut(pieces: Pieces, places: PlaceArray, instants: FloatArray) -> Pieces:
    """Pieces, some of them cut in two, each at its own instant; the order stays."""
    twice = np.ones(len(pieces), np.intp)
    twice[places] = 2
    result = pieces.at(np.repeat(np.arange(len(pieces)), twice))
    firsts = (np.cumsum(twice) - twice)[places]
    start_s, end_s = result.start_s.copy(), result.end_s.copy()
    end_s[firsts] = start_s[firsts + 1] = instants
    return result.windows(start_s, end_s)


def zeros(function: Callable[[FloatArray], FloatArray], a: FloatArray, b: FloatArray) -> FloatArray:
    """Zeros of a function between instants at which its signs differ.

    Chandrupatla's method: inverse quadratic interpolation where it is safe, else bisection. T. R. Chandrupatla,
    Advances in Engineering Software 28 (1997), 145-149.
    """
    b, a = a, b
    fa, fb = function(a), function(b)
    c, fc, step = a, fa, np.full_like(a, 0.5)
    least = np.finfo(np.float64).eps * np.abs(a - b)
    with np.errstate(all="ignore"):
        for _ in range(100):
            t = a + step * (b - a)
            ft = function(t)
            same = np.sign(ft) == np.sign(fa)
            c, fc = np.where(same, a, b), np.where(same, fa, fb)
            b, fb = np.where(same, b, a), np.where(same, fb, fa)
            a, fa = t, ft
            best = np.where(np.abs(fa) < np.abs(fb), a, b)
            limit = (2 * np.finfo(np.float64).eps * np.abs(best) + least) / np.abs(b - c)
            is_close = (limit > 0.5) | (np.minimum(np.abs(fa), np.abs(fb)) == 0)
            if is_close.all():
                break
            x, y = (a - b) / (c - b), (fa - fb) / (fc - fb)
            safe = (y**2 < x) & ((1 - y) ** 2 < 1 - x)
            quadratic = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
            step = np.where(is_close, 0.0, np.clip(np.where(safe, quadratic, 0.5), limit, 1 - limit))
    return best


# --- Means ------------------------------------------------------------------------------------------------------------

NODES, WEIGHTS = (values / 2 for values in np.polynomial.legendre.leggauss(16))
"""Gauss-Legendre rule on an interval of length 1 about 0."""

ERROR = 1e-13
"""Largest share of the whole by which halving a piece may change its integral."""


def instants_of(pieces: Pieces) -> FloatArray:
    """Instants of the rule in each piece, shape (pieces, points)."""
    middle, length = (pieces.start_s + pieces.end_s) / 2, pieces.end_s - pieces.start_s
    return middle[:, None] + length[:, None] * NODES


def summed(pieces: Pieces, values: FloatArray) -> FloatArray:
    """Integral over each piece, shape (pieces,), of a function with these values at the instants of the rule.

    For functions without kinks: on pieces of an eighth of a turn the rule of 16 points errs by rounding alone.
    """
    return total(values * WEIGHTS) * (pieces.end_s - pieces.start_s)  # `@` adds in an order of the processor's own


def integral(function: Function, pieces: Pieces) -> FloatArray:
    """Integral of a function over each piece, shape (pieces,), by one Gauss-Legendre rule."""
    return summed(pieces, function(pieces.transposed, instants_of(pieces)))


def halved_integral(
    function: Function, pieces: Pieces, motion: PlaceArray, once: FloatArray, whole: FloatArray
) -> FloatArray:
    """Integral of a function that is not smooth at the ends of pieces, shape (pieces,); `once` is the result of one
    rule.

    They are halved until nothing changes by more than ERROR of `whole`, the sum that an integral is part of. A zero at
    an end leaves one half of two at each step; a motion with more left has a torque of rounding errors only. `motion`
    is the motion of each piece.
    """
    result, before, part = once.copy(), once, pieces
    owner = np.arange(len(pieces))
    most = 4 * np.bincount(motion)
    while owner.size:
        middle = (part.start_s + part.end_s) / 2
        halves = part.at(np.tile(np.arange(owner.size), 2)).windows(
            np.concatenate((part.start_s, middle)), np.concatenate((middle, part.end_s))
        )
        after = integral(function, halves)
        change = after.reshape(2, -1).sum(axis=0) - before
        np.add.at(result, owner, change)
        left = np.abs(change) > ERROR * whole[owner]
        few = 2 * np.bincount(motion[owner[left]], minlength=len(most)) <= most
        left = np.tile(left & few[motion[owner]], 2)
        owner, before, part = np.tile(owner, 2)[left], after[left], halves.at(left)
    return result

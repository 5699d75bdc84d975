"""A motion against torque curves of motors: mean square of the continuous torque, and the point nearest to the peak.

The course is cut where the motor's speed passes a point of its curve, and the gear's torque a point of its efficiency:
in each window torque over speed is one line, and so is efficiency over torque.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from hpn.physics.equations import FloatArray, total
from hpn.physics.motion.course import Course
from hpn.physics.motion.mechanisms import RPM
from hpn.physics.motion.motor import bow
from hpn.physics.motion.pieces import Pieces, PlaceArray
from hpn.physics.motion.torque import torque_at, zeros
from hpn.physics.torque_curve import TorqueCurves

WINDOWS_AT_ONCE = 50_000
"""Windows that are evaluated together."""

NODES = {swings: np.polynomial.legendre.leggauss(8 if swings else 3) for swings in (True, False)}
"""Gauss-Legendre rules: exact for the square of a speed that is a parabola in time, to 1e-14 for one that is a sine."""

SAMPLES, STEPS = 9, 30
"""Instants of a window at which its largest share is searched, and steps of a golden section from there."""

GOLDEN = (np.sqrt(5) - 1) / 2


@dataclass(frozen=True, eq=False)
class DriveTrains:
    """Motors on gears, shape (trains,) each: the row of the motor's curve, the ratio, and inertia and torque at the
    motor.

    `efficiency` has shape (trains, points), at the rising torques `loaded_Nm` of the gear's output and between them by
    straight lines; beyond them the value at the nearer end counts, and a shorter line ends at infinite torques.
    `inertia_kgm2` is that of motor and gear at the input; where it is NaN it is left out, and the motor is taken to
    drive throughout, as in T / (i η) + T_0 of a phase.
    """

    curve: PlaceArray
    ratio: FloatArray
    loaded_Nm: FloatArray
    efficiency: FloatArray
    inertia_kgm2: FloatArray
    no_load_torque_Nm: FloatArray
    pause_s: FloatArray

    def at(self, some: slice) -> "DriveTrains":
        """Some of the trains."""
        return DriveTrains(*(getattr(self, one.name)[some] for one in fields(self)))


@dataclass(frozen=True, eq=False)
class _Windows:
    """Windows of the pieces of a course for each train, shape (windows,).

    Places of train and piece, and the segments of the train's curve and of its line of efficiencies that speed and
    torque stay in.
    """

    train: PlaceArray
    pieces: Pieces
    piece: PlaceArray
    segment: PlaceArray
    loading: PlaceArray


def judged_along(
    course: Course, curves: TorqueCurves, trains: DriveTrains
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Torque and peak curve in Nm where the motor is nearest to the curve, and the root of the mean of M_c(n)².

    Shape (trains,) each; the pause counts at speed 0.
    """
    torque, limit, thermal = np.zeros((3, len(trains.ratio)))
    for part in _parts(course, curves, len(trains.ratio)):
        own = trains.at(part)
        windows = _windows(course, curves, own)
        torque[part], limit[part] = _nearest_to_peak(course, curves, own, windows)
        thermal[part] = np.sqrt(_mean_square_continuous(course, curves, own, windows))
    return torque, limit, thermal


def _mean_square_continuous(course: Course, curves: TorqueCurves, trains: DriveTrains, windows: _Windows) -> FloatArray:
    nodes, weights = NODES[course.pieces.swings]
    p, rows = windows.pieces, trains.curve[windows.train]
    half = (p.end_s - p.start_s) / 2
    t = (p.start_s + p.end_s)[:, None] / 2 + half[:, None] * nodes
    speed = _output_speed(course, p.transposed, t) * trains.ratio[windows.train][:, None]
    base, slope = (line[rows, windows.segment][:, None] for line in curves.continuous)
    squares = total(np.square(base + slope * speed) * weights) * half
    whole = np.bincount(windows.train, squares, minlength=len(trains.ratio))
    at_rest = curves.continuous[0][trains.curve, 0]
    mean: FloatArray = (whole + at_rest**2 * trains.pause_s) / (course.duration_s.sum() + trains.pause_s)
    return mean


def _nearest_to_peak(
    course: Course, curves: TorqueCurves, trains: DriveTrains, windows: _Windows
) -> tuple[FloatArray, FloatArray]:
    look, most = _looked_at(course, curves, trains, windows)
    p, every = windows.pieces, np.arange(len(windows.piece))
    ends = np.stack((p.start_s, p.end_s), axis=1)
    torque, limit = look.torque_and_limit(ends)
    at = (torque / limit).argmax(axis=1)
    torques, limits = torque[every, at], limit[every, at]
    starts = np.searchsorted(windows.train, np.arange(len(trains.ratio)))
    best = np.maximum.reduceat(torques / limits, starts)[windows.train]
    within = (torque.max(axis=1) + most) / limit.min(axis=1)
    bends = (most > 0) | (p.jerk != 0)  # else the largest share of a line over a line is at an end
    inside = np.flatnonzero(bends & (within > best))
    if inside.size:
        open_ = look.at(inside)
        refined = [values[:, 0] for values in open_.torque_and_limit(_between(open_, ends[inside]))]
        larger = refined[0] / refined[1] > torques[inside] / limits[inside]
        torques[inside], limits[inside] = (
            np.where(larger, own, column[inside]) for own, column in zip(refined, (torques, limits), strict=True)
        )
    order = np.lexsort((-torques / limits, windows.train))
    first = order[starts]
    return torques[first], limits[first]


def _between(look: "_Look", ends: FloatArray) -> FloatArray:
    """Instants of the largest share in windows, shape (windows, 1): sampled, and refined between two samples."""
    t = ends[:, :1] + (ends[:, 1:] - ends[:, :1]) * np.linspace(0.0, 1.0, SAMPLES)
    rows, best = np.arange(len(t)), look.share(t).argmax(axis=1)
    low, high = t[rows, np.maximum(best - 1, 0)], t[rows, np.minimum(best + 1, SAMPLES - 1)]
    return _golden(look, low, high)


def _golden(look: "_Look", low: FloatArray, high: FloatArray) -> FloatArray:
    """Instants of the largest share between two, by golden section."""
    a, b = low[:, None], high[:, None]
    left, right = b - GOLDEN * (b - a), a + GOLDEN * (b - a)
    at_left, at_right = look.share(left), look.share(right)
    for _ in range(STEPS):
        falls = at_left >= at_right
        a, b = np.where(falls, a, left), np.where(falls, right, b)
        left, right = np.where(falls, b - GOLDEN * (b - a), right), np.where(falls, left, a + GOLDEN * (b - a))
        new = look.share(np.where(falls, left, right))
        at_left, at_right = np.where(falls, new, at_right), np.where(falls, at_left, new)
    return (a + b) / 2


@dataclass(frozen=True, eq=False)
class _Look:
    """The motor's torque in windows, and the line of its peak curve over the shaft's speed; shape (windows, 1) each.

    `factor` gives the gear's torque T, and `unloaded` + `rise` |T| its efficiency; `drives` is False where the load
    drives.
    """

    pieces: Pieces
    factor: FloatArray
    ratio: FloatArray
    unloaded: FloatArray
    rise: FloatArray
    drives: NDArray[np.bool_]
    of_acceleration: FloatArray
    without_load: FloatArray
    base: FloatArray
    slope: FloatArray

    def at(self, places: PlaceArray) -> "_Look":
        """Some of the windows."""
        return _Look(self.pieces.at(places), *(getattr(self, one.name)[places] for one in fields(self)[1:]))

    def torque_and_limit(self, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Magnitude of the torque, and the peak torque at the speed, at instants (windows, n), in Nm."""
        p = self.pieces
        T = self.factor * torque_at(p, t)
        eta = self.unloaded + self.rise * np.abs(T)
        torque = np.where(self.drives, T / eta, T * eta) / self.ratio + self.of_acceleration * p.acceleration_at(t)
        return np.abs(torque + self.without_load), self.base + self.slope * np.abs(p.speed_at(t))

    def share(self, t: FloatArray) -> FloatArray:
        """Torque over the peak torque at its speed."""
        torque, limit = self.torque_and_limit(t)
        return torque / limit


def _looked_at(
    course: Course, curves: TorqueCurves, trains: DriveTrains, windows: _Windows
) -> tuple[_Look, FloatArray]:
    """Motors in all windows, and upper bounds of the torque's rise above the line between the ends of each."""
    train, piece, rows, p = windows.train, windows.piece, trains.curve[windows.train], windows.pieces
    known, phase, ratio = ~np.isnan(trains.inertia_kgm2)[train], course.phase[piece], trains.ratio[train]
    n, T = course.speed_rpm[phase], course.torque_Nm[phase]
    drives, sense = ~known | (T * n >= 0), np.where(known, np.sign(n), np.copysign(n != 0, T))
    unloaded, rise = _line_of_efficiency(trains, train, windows.loading)
    of_acceleration = np.nan_to_num(trains.inertia_kgm2)[train] * ratio * course.load.ratio
    turns = p.sign != 0
    base, slope = (line[rows, windows.segment] for line in curves.peak)
    look = _Look(
        pieces=p.transposed,
        factor=course.factor[piece][:, None],
        ratio=ratio[:, None],
        unloaded=unloaded[:, None],
        rise=rise[:, None],
        drives=drives[:, None],
        of_acceleration=(of_acceleration * turns)[:, None],
        without_load=(trains.no_load_torque_Nm[train] * sense)[:, None],
        base=base[:, None],
        slope=(slope * ratio * (course.load.ratio / RPM) * turns)[:, None],
    )
    share = np.where(drives, 1 / unloaded, unloaded) / ratio * course.factor[piece]
    return look, np.where(rise == 0, bow(p, share, of_acceleration), np.inf)


def _line_of_efficiency(trains: DriveTrains, train: PlaceArray, loading: PlaceArray) -> tuple[FloatArray, FloatArray]:
    """Efficiency at no load and its rise with the torque, by the line of each window's segment."""
    last = trains.efficiency.shape[1] - 1
    (T0, T1), (eta0, eta1) = (
        (values[train, np.maximum(loading - 1, 0)], values[train, np.minimum(loading, last)])
        for values in (trains.loaded_Nm, trains.efficiency)
    )
    with np.errstate(all="ignore"):
        rise = np.where(np.isfinite(T1) & (T1 > T0), (eta1 - eta0) / (T1 - T0), 0.0)
    return eta0 - np.where(rise == 0, 0.0, rise * T0), rise


# --- Windows ----------------------------------------------------------------------------------------------------------


def _parts(course: Course, curves: TorqueCurves, count: int) -> list[slice]:
    """Slices of trains to evaluate together."""
    most = len(course.pieces) * curves.knots_rpm.shape[1]
    step = max(1, WINDOWS_AT_ONCE // most)
    return [slice(k, k + step) for k in range(0, count, step)]


def _output_speed(course: Course, p: Pieces, t: FloatArray) -> FloatArray:
    """Speed of the gear's output in rpm, by magnitude."""
    speed: FloatArray = np.abs(p.speed_at(t)) * (p.sign != 0) * (course.load.ratio / RPM)
    return speed


def _windows(course: Course, curves: TorqueCurves, trains: DriveTrains) -> _Windows:
    """Pieces of every train, cut where the speed passes a point of its curve, or the torque one of its efficiencies."""
    p, curve, ratio = course.pieces, trains.curve, trains.ratio
    count = len(p)
    knots = (curves.knots_rpm[curve] / ratio[:, None])[:, None, 1:]  # at the gear's output
    train, piece, knot = _crossed(knots, [_output_speed(course, p, t) for t in (p.start_s, p.end_s)])
    speed = knots[train, 0, knot] * (RPM / course.load.ratio) * p.sign[piece]
    loaded, loads = trains.loaded_Nm[:, None], [course.factor * np.abs(torque_at(p, t)) for t in (p.start_s, p.end_s)]
    loaded_train, loaded_piece, knot = _crossed(loaded, loads)
    some, factor, load = p.at(loaded_piece), course.factor[loaded_piece], loaded[loaded_train, 0, knot]
    loaded_at = zeros(lambda t: factor * np.abs(torque_at(some, t)) - load, some.start_s, some.end_s)
    places = np.concatenate((np.arange(len(ratio) * count), train * count + piece, loaded_train * count + loaded_piece))
    starts = np.concatenate((np.tile(p.start_s, len(ratio)), _instants_at(p.at(piece), speed), loaded_at))
    order = np.lexsort((starts, places))
    places, starts = places[order], starts[order]
    train, piece = places // count, places % count
    ends_here = np.append(np.diff(places) != 0, True)
    stops = np.where(ends_here, p.end_s[piece], np.append(starts[1:], 0.0))
    pieces = p.at(piece).windows(starts, stops)
    middle = (starts + stops) / 2
    segment = curves.segment_at(curve[train], _output_speed(course, pieces, middle) * ratio[train])
    T = np.abs(torque_at(pieces, middle)) * course.factor[piece]
    loading = (trains.loaded_Nm[train] < T[:, None]).sum(axis=1)
    return _Windows(train, pieces, piece, segment, loading)


def _crossed(knots: FloatArray, ends: Sequence[FloatArray]) -> tuple[PlaceArray, ...]:
    """Places of train, piece and knot where a value passes a knot (trains, 1, knots) between the ends of a piece."""
    start, end = (values[:, None] for values in ends)
    return np.nonzero((knots > np.minimum(start, end)) & (knots < np.maximum(start, end)))


def _instants_at(p: Pieces, speed: FloatArray) -> FloatArray:
    """Instants at which pieces reach a speed in rad/s; in each piece the speed only rises or only falls."""
    with np.errstate(all="ignore"):
        half, b, c = p.jerk / 2, p.acceleration, p.speed - speed
        root = np.sqrt(np.maximum(b * b - 4 * half * c, 0.0))
        q = -(b + np.where(b < 0, -root, root)) / 2
        first, second = c / q, q / half
        middle = (p.start_s + p.end_s) / 2
        t = np.where(np.abs(first - middle) <= np.abs(second - middle), first, second)
        t = np.where(np.isnan(t) | np.isinf(t), np.where(np.isfinite(first), first, second), t)
        if p.swings:
            turn = np.arccos(np.clip((p.speed - speed) * p.frequency / p.swing, -1.0, 1.0))
            side = np.sign(p.frequency * middle + p.shift)
            t = np.where(p.swing != 0, (side * turn - p.shift) / p.frequency, t)
    return np.asarray(np.clip(np.nan_to_num(t), p.start_s, p.end_s))

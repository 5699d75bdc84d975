"""Torques at their speeds beside their limits, at the gear's output and at the motor; all by magnitude."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from math import inf, isinf
from xml.etree.ElementTree import Element

import numpy as np

from hpn.account.readings import figure_symbol
from hpn.application import Motor
from hpn.engine.motor_torques import efficiencies
from hpn.explain.drawings.chart import LAST, MOST_NUMBERS, PLANE, ROOM, ChartAxes, LimitCurve, Mark, Scene, chart
from hpn.explain.drawings.panels import OUT_OF_SCALE
from hpn.explain.drawings.picture import beyond_limit
from hpn.explain.drawings.subject import Subject
from hpn.explain.drawings.svg import Point
from hpn.explain.drawings.words import disc_label, phase_numbers
from hpn.physics.equations import FloatArray
from hpn.physics.motion import Trace, motor_trace, trace_of
from hpn.physics.motion.trace import starts
from hpn.words.quantities import CANDIDATE, DUTY, GEAR, INPUTS
from hpn.words.reader import DEFAULT, Reader
from hpn.words.titles import numbered
from hpn.words.wording import N_, Named, Quantity, Sentence, Value

OUTPUT = ChartAxes(N_("output speed"), "rpm", N_("output torque"), "Nm")
MOTOR = ChartAxes(N_("motor speed"), "rpm", N_("motor torque"), "Nm")

MOST_MARKS = 200
"""Phases, at most, in a drawing, those nearest to their limit."""


@dataclass(frozen=True, slots=True)
class Demand:
    """A figure of the cycle in a unit of the wire, and its limit; `relation` compares their symbols."""

    name: str
    relation: str
    value: float
    limit: float | None
    unit: str


@dataclass(frozen=True, slots=True)
class Plane:
    """A drawing, and its content as rows of a table and in words."""

    drawing: Element
    demands: list[Demand]
    words: list[Sentence]


@dataclass(frozen=True, slots=True)
class _Limit:
    """A limit by its symbol; None if unknown."""

    symbol: str
    value: float | None


@dataclass(frozen=True, slots=True)
class _Limits:
    """Limits of torque and speed that hold together, and their demands (speed, torque) with their names.

    `curve` has the corners of a torque that falls with the speed; `torque` is then its decisive value.
    """

    kind: str
    torque: _Limit
    speed: _Limit
    demand: Point
    names: tuple[Named, Named]
    curve: Sequence[Point] = ()

    def torque_at(self, speed_rpm: FloatArray) -> FloatArray:
        """Torque limit in Nm at speeds; infinite if unknown."""
        if self.curve:
            return np.asarray(np.interp(speed_rpm, *np.array(self.curve).T))
        return np.full(np.shape(speed_rpm), self.torque.value or np.inf)

    def demands(self, u: float) -> Iterable[Demand]:
        """Yield the demands of torque and speed."""
        pairs = zip(self.names, reversed(self.demand), (self.torque, self.speed), ("Nm", "rpm"), strict=True)
        for named, value, limit, unit in pairs:
            if limit.value is None:
                yield Demand(named.name, named.symbol, value, None, unit)
            else:
                yield Demand(named.name, f"{named.symbol} ≤ {_name(limit, u)}", value, u * limit.value, unit)


@dataclass(frozen=True, eq=False)
class _Cycle:
    """Points of a cycle: means and peaks of its phases, shape (phases,), and the curves and moves of a motion."""

    speed_rpm: FloatArray
    torque_Nm: FloatArray
    peak_speed_rpm: FloatArray
    peak_torque_Nm: FloatArray
    curves: dict[int, list[Point]]
    names: Sequence[str | None]
    moves: Sequence[int] | None = None

    def rows(self, places: Sequence[int]) -> list[int]:
        """Places of the rows of some phases; for a motion the rows of their moves."""
        return list(places) if self.moves is None else sorted({self.moves[place] for place in places})


def gear_plane(subject: Subject, reader: Reader = DEFAULT, governing: Sequence[int] = ()) -> Plane:
    """Output torque against output speed, with the gear's limits of averages and peaks."""
    duty, gear, phases = subject.duty, subject.gear, subject.duty.phases
    rated, peak = (
        _Limit(GEAR[name].symbol, getattr(gear, name)) for name in ("rated_torque_Nm", "repeated_peak_torque_Nm")
    )
    average, maximum = (
        _Limit(f"{GEAR[name].symbol}/i", value and value / gear.ratio)
        for name in ("average_input_speed_rpm", "maximum_input_speed_rpm")
        for value in [getattr(gear, name)]
    )
    limits = (
        _Limits(
            "limit",
            peak,
            maximum,
            (duty.maximum_output_speed_rpm.item(), duty.maximum_torque_Nm.item()),
            (DUTY["maximum_torque_Nm"], DUTY["maximum_output_speed_rpm"]),
        ),
        _Limits(
            "mean",
            rated,
            average,
            (duty.average_output_speed_rpm.item(), duty.average_torque_Nm.item()),
            (DUTY["average_torque_Nm"], DUTY["average_output_speed_rpm"]),
        ),
    )
    course = duty.courses.get(0)
    curves = {}
    if course is not None:
        trace = trace_of(course)
        curves = _curves(trace, np.abs(trace.speed_rpm), np.abs(trace.torque_Nm))
    n, T, fastest, largest = phases.speed_rpm, phases.torque_Nm, phases.peak_speed_rpm, phases.peak_torque_Nm
    cycle = _Cycle(n[0, 0], T[0, 0], fastest[0, 0], largest[0, 0], curves, _names(subject), _moves(subject))
    words = [
        _compared(N_("Largest torque {torque}, largest speed {speed}."), limits[0], subject),
        _compared(N_("Average torque {torque}, average speed {speed}."), limits[1], subject),
    ]
    mean = DUTY["average_torque_Nm"].symbol
    return _plane(_scene(cycle, limits, mean, OUTPUT, subject, reader, governing), limits, words, subject, reader)


def motor_plane(subject: Subject, reader: Reader = DEFAULT, governing: Sequence[int] = ()) -> Plane:
    """Motor torque against motor speed on a gear, with the given limits of the motor.

    If the inertia of a motion's motor is known, the curve includes it.
    """
    figures, motor = subject.of_gear, subject.equipped.requirements.motor or Motor()
    curve = motor.curve or ()
    turns = subject.duty.courses.get(0) is not None and motor.inertia_kgm2 is not None
    adds = turns or subject.gear.no_load_torque_Nm is not None
    peak, rms = (
        Named(CANDIDATE[name].name, figure_symbol(name, adds_at_motor=adds))
        for name in ("motor_peak_torque_Nm", "motor_rated_torque_Nm")
    )
    limits = (
        _Limits(
            "limit",
            _of_curve(PEAK, figures.by_curve.peak_Nm) if curve else _of_motor(motor, "peak_torque_Nm"),
            _Limit(INPUTS["requirements.motor.maximum_speed_rpm"].symbol, motor.top_speed_rpm),
            (figures.maximum_input_speed_rpm.item(), figures.motor_peak_torque_Nm.item()),
            (peak, CANDIDATE["maximum_input_speed_rpm"]),
            [(point.speed_rpm, point.peak_Nm) for point in curve],
        ),
        _Limits(
            "mean",
            _of_curve(CONTINUOUS, figures.by_curve.continuous_Nm) if curve else _of_motor(motor, "rated_torque_Nm"),
            _Limit("", None) if curve else _of_motor(motor, "rated_speed_rpm"),
            (figures.average_input_speed_rpm.item(), figures.motor_rated_torque_Nm.item()),
            (rms, CANDIDATE["average_input_speed_rpm"]),
            [(point.speed_rpm, point.continuous_Nm) for point in curve],
        ),
    )
    words = [
        _compared(N_("Largest torque {torque}, largest speed {speed}."), limits[0], subject),
        _compared(N_("RMS torque {torque}, average speed {speed}."), limits[1], subject),
    ]
    scene = _scene(_at_motor(subject, motor), limits, "T_rms", MOTOR, subject, reader, governing)
    scene = replace(scene, lines=[*scene.lines, *_limits_of_gear(subject, scene, reader)])
    return _plane(scene, limits, words, subject, reader)


def _plane(scene: Scene, limits: Sequence[_Limits], words: list[Sentence], subject: Subject, reader: Reader) -> Plane:
    demands = [demand for one in limits for demand in one.demands(subject.application.requirements.utilisation)]
    return Plane(chart(scene, reader, PLANE), demands, words)


def _limits_of_gear(subject: Subject, scene: Scene, reader: Reader) -> Iterable[LimitCurve]:
    """Yield the drive's torque limit, right across, and the gear's input speed limit, if not far beyond the rest."""
    limit = subject.of_gear.motor_torque_limit_Nm.item()
    most = max((T for line in scene.lines for _, T in line.corners if not isinf(T)), default=0.0)
    most = max(most, *(mark.place[1] for mark in scene.marks))
    if limit <= OUT_OF_SCALE * most:
        yield LimitCurve("drive", reader.text(N_("drive limit")), [(0.0, limit), (inf, limit)])
    fastest = max((n for line in scene.lines for n, _ in line.corners if not isinf(n)), default=0.0)
    fastest = max(fastest, *(mark.place[0] for mark in scene.marks))
    speed = subject.gear.maximum_input_speed_rpm
    if speed is not None and speed <= ROOM * fastest:
        yield LimitCurve("drive", reader.text(N_("gear limit")), [(speed, inf), (speed, 0.0)])


PEAK, CONTINUOUS = "M_p(n)", "M_c(n)"
"""Symbols of the peak and the continuous torque along a curve."""


def _of_curve(symbol: str, limit: FloatArray) -> _Limit:
    value = limit.item()
    return _Limit(symbol, None if np.isnan(value) else value)


def _of_motor(motor: Motor, name: str) -> _Limit:
    return _Limit(INPUTS[f"requirements.motor.{name}"].symbol, getattr(motor, name))


def _at_motor(subject: Subject, motor: Motor) -> _Cycle:
    """Phases at the motor: RMS torque at the mean speed, and peaks; for a motion the torque at every instant."""
    duty, gear, i, phases = subject.duty, subject.gear, subject.gear.ratio, subject.duty.phases
    at_peak, at_rms = efficiencies(duty, gear, subject.catalogue)
    own, T_0 = gear.inertia_kgm2 or 0.0, gear.no_load_torque_Nm or 0.0
    moving = np.where(phases.speed_rpm[0, 0] > 0, T_0, 0.0)
    peaks = phases.peak_torque_Nm[0, 0] / (i * at_peak) + moving
    course, curves = duty.courses.get(0), {}
    if course is not None and motor.inertia_kgm2 is not None:
        J = motor.inertia_kgm2 + own
        trace, torque = motor_trace(course, ratio=i, efficiency=at_peak, motor_inertia_kgm2=J, no_load_torque_Nm=T_0)
        curves = _curves(trace, np.abs(trace.speed_rpm) * i, np.abs(torque))
        peaks = np.maximum.reduceat(np.abs(torque).max(axis=1), starts(trace.phase))
    elif course is not None:
        trace = trace_of(course)
        torque = np.abs(trace.torque_Nm) / (i * at_peak[trace.phase])[:, None] + moving[trace.phase][:, None]
        curves = _curves(trace, np.abs(trace.speed_rpm) * i, torque)
    means = phases.rms_torque_Nm[0, 0] / (i * at_rms) + moving
    speeds = phases.speed_rpm[0, 0] * i, phases.peak_speed_rpm[0, 0] * i
    return _Cycle(speeds[0], means, speeds[1], peaks, curves, _names(subject), _moves(subject))


def _moves(subject: Subject) -> Sequence[int] | None:
    """Move of each phase of a motion."""
    motion = subject.application.duty_cycle.motion
    return motion.course.move.tolist() if motion else None


def _names(subject: Subject) -> Sequence[str | None]:
    return [phase.name for phase in subject.application.duty_cycle.load_phases]


def _curves(trace: Trace, speed: FloatArray, torque: FloatArray) -> dict[int, list[Point]]:
    """Curve of each phase of a motion."""
    cuts = starts(trace.phase)[1:]
    pieces = zip(np.split(speed, cuts), np.split(torque, cuts), strict=True)
    return {k: list(zip(n.ravel().tolist(), T.ravel().tolist(), strict=True)) for k, (n, T) in enumerate(pieces)}


# --- The drawing ------------------------------------------------------------------------------------------------------


def _scene(
    cycle: _Cycle,
    limits: Sequence[_Limits],
    mean: str,
    axes: ChartAxes,
    subject: Subject,
    reader: Reader,
    governing: Sequence[int],
) -> Scene:
    u = subject.application.requirements.utilisation
    most = max(cycle.peak_speed_rpm), max(cycle.peak_torque_Nm)
    lines = [line for one in limits for line in _lines(one, u, most)]
    lines += [LimitCurve("curve", "", points) for points in dict.fromkeys(map(tuple, cycle.curves.values()))]
    if not cycle.curves:
        lines += _spans(cycle)
    marks = _phases(cycle, limits[0], u, governing, reader)
    text = reader.sentence(_compared("{torque}, {speed}", limits[1], subject))
    outside = any(
        beyond_limit(demand / limit.value, u)
        for demand, limit in zip(limits[1].demand, (limits[1].speed, limits[1].torque), strict=True)
        if limit.value
    )
    marks.append(Mark("equivalent", mean, limits[1].demand, text, LAST, outside))
    return Scene(lines, marks, None, axes, list(_beyond(limits, u, most, reader)))


def _lines(limits: _Limits, u: float, most: Point) -> Iterable[LimitCurve]:
    """Yield the rectangle of a torque and a speed; if one of them is not drawn, the other goes right across."""
    n, T = (_drawn_at(limit, u, value) for limit, value in zip((limits.speed, limits.torque), most, strict=True))
    if limits.curve:
        yield from _along(limits, u, n)
        return
    if limits.kind == "limit" and not (isinf(n) and isinf(T)):
        yield LimitCurve("region", "", [(0.0, T), (n, T), (n, 0.0)], strong=True)
    if not isinf(T):
        yield LimitCurve(limits.kind, _name(limits.torque, u), [(0.0, T), (n, T)])
    if not isinf(n):
        yield LimitCurve(limits.kind, _name(limits.speed, u), [(n, T), (n, 0.0)])


def _along(limits: _Limits, u: float, fastest: float) -> Iterable[LimitCurve]:
    """Yield a torque over speed times u, as far as the motor turns."""
    (speeds, torques), end = np.array(limits.curve).T, min(fastest, limits.curve[-1][0])
    inside = [(n, u * T) for n, T in limits.curve if n < end]
    corners = [*inside, (end, u * float(np.interp(end, speeds, torques)))]
    if limits.kind == "limit":
        yield LimitCurve("region", "", [*corners, (end, 0.0)], strong=True)
    yield LimitCurve(limits.kind, _name(limits.torque, u), corners)
    if limits.kind == "limit" and not isinf(fastest):
        yield LimitCurve(limits.kind, _name(limits.speed, u), [corners[-1], (fastest, 0.0)])


def _drawn_at(limit: _Limit, u: float, most: float) -> float:
    """A limit in its unit, times u; infinity if unknown, or far beyond the cycle."""
    return u * limit.value if limit.value is not None and u * limit.value <= OUT_OF_SCALE * most else inf


def _name(limit: _Limit, u: float) -> str:
    return limit.symbol if u == 1 else f"u·{limit.symbol}"


def _beyond(limits: Sequence[_Limits], u: float, most: Point, reader: Reader) -> Iterable[str]:
    """Yield limits far beyond the cycle, each with an arrow towards it; those of one kind in a row."""
    for one in limits:
        pairs = ((one.torque, most[1], "↑", "Nm"), (one.speed, most[0], "→", "rpm"))
        names = [
            f"{arrow} {_name(limit, u)} {reader.with_unit(reader.figure(u * limit.value, unit), unit)}"
            for limit, value, arrow, unit in pairs
            if limit.value is not None and isinf(_drawn_at(limit, u, value)) and not (one.curve and unit == "Nm")
        ]
        if names:
            yield "\N{EM SPACE}".join(names)


def _spans(cycle: _Cycle) -> Iterable[LimitCurve]:
    """Lines from the mean of each varying phase to its peak."""
    means, peaks = ((cycle.speed_rpm, cycle.torque_Nm), (cycle.peak_speed_rpm, cycle.peak_torque_Nm))
    ends = zip(*(map(tuple, np.stack(points, axis=1)[:MOST_MARKS].tolist()) for points in (means, peaks)), strict=True)
    return [LimitCurve("span", "", [mean, peak]) for mean, peak in dict.fromkeys(ends) if mean != peak]


def _phases(cycle: _Cycle, limits: _Limits, u: float, governing: Sequence[int], reader: Reader) -> list[Mark]:
    """A numbered disc at the peak of each phase, one for phases at the same place; a varying phase has a dot at its
    mean.
    """
    n, T = cycle.peak_speed_rpm, cycle.peak_torque_Nm
    used = np.maximum(n / (limits.speed.value or np.inf), T / limits.torque_at(n))
    together: dict[Point, list[int]] = {}
    for k in np.argsort(-used, kind="stable").tolist():
        place = max(cycle.curves[k], key=lambda point: point[1]) if cycle.curves else (n.item(k), T.item(k))
        together.setdefault(place, []).append(k)
    marks = []
    for order, (place, unsorted) in enumerate(list(together.items())[:MOST_MARKS]):
        places = sorted(unsorted)
        most = max(places, key=lambda k: used[k])
        kind = "load governing" if set(governing) & set(places) else "load"
        label = disc_label(cycle.rows(places)) if order < MOST_NUMBERS else ""
        text = reader.sentence(_sentence_of(cycle, most, places)) if label else ""
        marks.append(Mark(kind, label, place, text, used.item(most), beyond_limit(used.item(most), u), places[:100]))
    if not cycle.curves:
        means = set(zip(cycle.speed_rpm.tolist(), cycle.torque_Nm.tolist(), strict=True)) - set(together)
        marks += [Mark("mean", "", place, "") for place in sorted(means)[:MOST_MARKS]]
    return marks


def _sentence_of(cycle: _Cycle, k: int, places: Sequence[int]) -> Sentence:
    rows, (k_row,) = cycle.rows(places), cycle.rows([k])
    values: dict[str, Value] = {
        "phases": phase_numbers(rows) if len(rows) > 1 else numbered(k_row, cycle.names[k]),
        "torque": Quantity(cycle.peak_torque_Nm.item(k), "Nm"),
        "speed": Quantity(cycle.peak_speed_rpm.item(k), "rpm"),
    }
    text = N_("Phase {phases}: up to {torque} and {speed}")
    return Sentence(text if cycle.moves is None else N_("Move {phases}: up to {torque} and {speed}"), values)


# --- In words ---------------------------------------------------------------------------------------------------------


def _compared(template: str, limits: _Limits, subject: Subject) -> Sentence:
    u = subject.application.requirements.utilisation
    n, T = limits.demand
    return Sentence(template, {"torque": _of(T, limits.torque, u, "Nm"), "speed": _of(n, limits.speed, u, "rpm")})


def _of(demand: float, limit: _Limit, u: float, unit: str) -> Value:
    """A demand, with its limit if known."""
    if limit.value is None:
        return Quantity(demand, unit)
    values: dict[str, Value] = {"demand": Quantity(demand, unit), "limit": Quantity(u * limit.value, unit)}
    return Sentence(N_("{demand} of {limit}"), values)

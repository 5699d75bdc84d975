"""Boxes of tolerances: an application with inputs between two ends each, and any of its points as rows of a duty.

The rows become arrays before the equations, so that hundreds of points go through the same code as one application.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hpn.application import Application
from hpn.application.tolerances import Interval, Place
from hpn.engine.duty import Duty, Phases, least_torque
from hpn.engine.input_arrays import InputArrays
from hpn.physics.equations import FloatArray

IntArray = NDArray[np.intp]

CYCLE_LOADS = ("output_load.radial_N", "output_load.axial_N")
"""Loads of the whole cycle, which the engine handles phase by phase."""

WITH_TORQUE = ("torque_Nm", "peak_torque_Nm", "rms_torque_Nm", "least_torque_Nm")
SERIES = (*Phases.__dataclass_fields__,)
TEXTS = tuple(name for name in InputArrays.__dataclass_fields__ if name not in ("numbers", "shaft_centres_mm"))


class Ends(NamedTuple):
    """Values of an input at both ends of some intervals, by magnitude; `of` are the intervals' places."""

    of: IntArray
    at_low: FloatArray
    at_high: FloatArray

    @property
    def rising(self) -> NDArray[np.int8]:
        """Sense of each: 1 for rising to the upper end, -1 for falling, 0 for equal values at both ends."""
        return np.sign(self.at_high - self.at_low).astype(np.int8)


class MovedInputs:
    """Inputs that a box's intervals influence, with the places and senses of these; similar boxes compare equal."""

    def __init__(self, count: int, ends: Mapping[str, Ends]) -> None:
        self.count = count
        self.places = {
            name: (tuple(own.of.tolist()), tuple(own.rising.tolist())) for name, own in ends.items() if len(own.of)
        }
        self._key = count, tuple(self.places.items())
        self._hash = hash(self._key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, MovedInputs) and other._key == self._key

    def __hash__(self) -> int:
        return self._hash


class PhaseIntervals(NamedTuple):
    """Intervals of one field of the phases, and the phases of each; an interval of the whole cycle has several."""

    of: IntArray
    phases: IntArray


@dataclass(frozen=True, eq=False)
class Box:
    """An application and the intervals of some of its inputs; points have shape (rows, intervals)."""

    application: Application
    duty: Duty
    intervals: tuple[Interval, ...]

    @cached_property
    def value(self) -> FloatArray:
        """The given point."""
        return np.array([one.value for one in self.intervals])

    @cached_property
    def low(self) -> FloatArray:
        """Lower ends."""
        return np.array([one.low for one in self.intervals])

    @cached_property
    def high(self) -> FloatArray:
        """Upper ends."""
        return np.array([one.high for one in self.intervals])

    @cached_property
    def columns(self) -> Mapping[str, PhaseIntervals]:
        """Intervals of phases by field; a phase's own interval comes before that of the whole cycle."""
        pairs_by_field: dict[str, list[tuple[int, int]]] = {}
        for place, one in enumerate(self.intervals):
            for phase in self._phases_of(one):
                pairs_by_field.setdefault(str(one.place[-1]), []).append((place, phase))
        return {name: PhaseIntervals(*np.array(pairs, np.intp).T) for name, pairs in pairs_by_field.items()}

    def _phases_of(self, one: Interval) -> Sequence[int]:
        """Phases whose field an interval influences; none for an interval of a single number."""
        if one.place[0] == "phases":
            return (int(one.place[1]),)
        if one.place[:2] == ("motion", "moves"):
            moves: list[int] = np.flatnonzero(self.duty.courses[0].move == one.place[2]).tolist()
            return moves
        if ".".join(map(str, one.place)) not in CYCLE_LOADS:
            return ()
        phases = self.application.duty_cycle.load_phases
        return [k for k, phase in enumerate(phases) if getattr(phase, str(one.place[-1])) is None]

    @cached_property
    def numbers(self) -> Mapping[str, int]:
        """Places of the intervals of single numbers, by path."""
        paths = {".".join(map(str, one.place)): place for place, one in enumerate(self.intervals)}
        return {path: place for path, place in paths.items() if path in self.duty.inputs.numbers}

    @cached_property
    def own(self) -> Mapping[str, NDArray[np.bool_]]:
        """True for phases with a value of its own of a figure that otherwise follows another, shape (phases,).

        A peak is its phase's own also beside a given RMS whose torque may reach 0: it stays above that RMS.
        """
        phases = self.application.duty_cycle.load_phases
        names = ("peak_torque_Nm", "rms_torque_Nm", "least_torque_Nm", "peak_speed_rpm")
        own = {name: np.array([getattr(phase, name) is not None for phase in phases]) for name in names}
        for one in self.intervals:
            if one.place[::2] == ("phases", "torque_Nm") and one.low <= 0 <= one.high:
                phase = int(one.place[1])
                own["peak_torque_Nm"][phase] |= own["rms_torque_Nm"][phase]
        return own

    @cached_property
    def moved(self) -> MovedInputs:
        """Inputs that the intervals influence, and their senses."""
        return MovedInputs(len(self.intervals), self.ends)

    @cached_property
    def kind(self) -> tuple[Any, ...]:
        """Number of phases, and the phases and numbers that the intervals influence: boxes of one kind are moved
        together.
        """
        columns = tuple((name, *of.tolist(), *phases.tolist()) for name, (of, phases) in self.columns.items())
        return self.duty.typed.torque_Nm.shape[-1], columns, tuple(self.numbers.items())

    def at(self, points: FloatArray) -> Duty:
        """Duty of points, one row each."""
        return duty_of([(self, points)])

    @cached_property
    def series(self) -> FloatArray:
        """Phases of the application, shape (fields, 1, 1, phases)."""
        return np.array([getattr(self.duty.typed, name) for name in SERIES])

    @cached_property
    def table(self) -> FloatArray:
        """Single numbers of the application, shape (numbers, 1, 1)."""
        return np.array(list(self.duty.inputs.numbers.values()))

    def application_at(self, point: FloatArray) -> Application:
        """The application at a point, as a user would type it."""
        typed = _Rows([(self, point[None])]).typed
        values = {one.place: float(x) for one, x in zip(self.intervals, point.tolist(), strict=True) if x != one.value}
        for place in tuple(values):
            if place[0] == "phases":
                followers = {*self._moved_by(str(place[2]))} - {place[2], "torque_sign"}
                for name in followers:
                    own = (*place[:2], name) in values or any(one.place == (*place[:2], name) for one in self.intervals)
                    if not own and self.own[name][int(place[1])]:
                        values[(*place[:2], name)] = float(getattr(typed, name)[0, 0, int(place[1])])
        return moved(self.application, values)

    @cached_property
    def extremes(self) -> Mapping[str, FloatArray]:
        """Figures of the phases with all intervals at their lower, and at their upper ends, shape (2, phases)."""
        return _extremes_of([self])[0]

    @cached_property
    def ends(self) -> Mapping[str, Ends]:
        """Inputs that the intervals influence, by their names in `Check.over`, at both ends."""
        ends_by_name: dict[str, Ends] = {}
        series = self.extremes if self.columns else {}
        for name, column in self.columns.items():
            for moved in self._moved_by(name):
                of, phases = column
                if moved != name and moved in self.columns:
                    keep = ~np.isin(phases, self.columns[moved].phases)
                    of, phases = of[keep], phases[keep]
                earlier = ends_by_name.get(moved)
                ends = Ends(of, *series[moved][:, phases])
                ends_by_name[moved] = ends if earlier is None else _both(earlier, ends)
        if self.duty.has_shaft_drive and "peak_torque_Nm" in ends_by_name:
            ends_by_name["shaft_torque_Nm"] = ends_by_name["peak_torque_Nm"]
        if "torque_sign" in ends_by_name:
            of, low, high = ends_by_name.pop("torque_sign")
            if (turning := low != high).any():
                ends_by_name["torque_sign"] = Ends(of[turning], low[turning], high[turning])
        for path, place in self.numbers.items():
            low, high = np.abs(self.low[[place]]), np.abs(self.high[[place]])
            ends_by_name[path] = Ends(np.array([place]), low, high)
        return ends_by_name

    @staticmethod
    def _moved_by(name: str) -> tuple[str, ...]:
        """Figures of a phase that follow one of its inputs."""
        if name == "torque_Nm":
            return (*WITH_TORQUE, "torque_sign")
        return ("speed_rpm", "peak_speed_rpm") if name == "speed_rpm" else (name,)


def find_extremes(boxes: Sequence[Box]) -> None:
    """Compute the extremes of boxes together and store them in each box."""
    for box, extremes in zip(boxes, _extremes_of(boxes), strict=True):
        box.__dict__["extremes"] = extremes


def _extremes_of(boxes: Sequence[Box]) -> list[dict[str, FloatArray]]:
    typed = _Rows([(box, np.stack((box.low, box.high))) for box in boxes]).typed
    rows = [slice(k, k + 2) for k in range(0, 2 * len(boxes), 2)]
    return [{name: getattr(typed, name)[own, 0] for name in SERIES} for own in rows]


def _both(first: Ends, second: Ends) -> Ends:
    return Ends(
        np.concatenate((first.of, second.of)),
        np.concatenate((first.at_low, second.at_low)),
        np.concatenate((first.at_high, second.at_high)),
    )


def duty_of(parts: Sequence[tuple[Box, FloatArray]]) -> Duty:
    """Duty of points of boxes, one row each; shorter cycles are padded."""
    rows = _Rows(parts)
    return Duty(rows.typed, rows.inputs, rows.of_each("courses"), rows.of_each("stopped_loads"))


class _Rows:
    """Points of boxes, each row with its box, grouped by the kinds of the boxes."""

    def __init__(self, parts: Sequence[tuple[Box, FloatArray]]) -> None:
        self._boxes = list({id(box): box for box, _ in parts}.values())
        place = {id(box): k for k, box in enumerate(self._boxes)}
        self._which = np.repeat([place[id(box)] for box, _ in parts], [len(points) for _, points in parts])
        kinds: dict[tuple[Any, ...], list[tuple[Box, FloatArray, IntArray]]] = {}
        start = 0
        for box, points in parts:
            rows = np.arange(start, start + len(points))
            kinds.setdefault(box.kind, []).append((box, points, rows))
            start += len(points)
        self._alike = [_Alike(own) for own in kinds.values()]

    @property
    def typed(self) -> Phases:
        """Phases with typed loads only."""
        longest = max(box.series.shape[-1] for box in self._boxes)
        table = np.zeros((len(SERIES), len(self._boxes), 1, longest))
        for k, box in enumerate(self._boxes):
            table[:, k, :, : box.series.shape[-1]] = box.series[:, 0]
        series = dict(zip(SERIES, table[:, self._which], strict=True))
        for points in self._alike:
            points.move(series)
        return Phases(**series)

    @property
    def inputs(self) -> InputArrays:
        """Inputs besides the phases."""
        inputs, which = [box.duty.inputs for box in self._boxes], self._which
        table = np.concatenate([box.table for box in self._boxes], axis=1)[:, which]
        numbers = dict(zip(inputs[0].numbers, table, strict=True))
        for points in self._alike:
            points.set_numbers(numbers)
        u, allowed = (numbers[f"requirements.{name}"] for name in ("utilisation", "worst_case_utilisation"))
        numbers["requirements.utilisation"] = np.where(np.isnan(allowed), u, allowed)
        texts = {name: np.concatenate([getattr(one, name) for one in inputs])[which] for name in TEXTS}
        unknown = np.full((1, 1), np.nan)
        by_size = {
            size: np.concatenate([one.shaft_centres_mm.get(size, unknown) for one in inputs])[which]
            for size in dict.fromkeys(size for one in inputs for size in one.shaft_centres_mm)
        }
        return InputArrays(numbers, **texts, shaft_centres_mm=by_size)

    def of_each(self, name: str) -> dict[int, Any]:
        """Course or stopped load of each row's box, for rows with one."""
        known = [getattr(box.duty, name).get(0) for box in self._boxes]
        return {row: known[k] for row, k in enumerate(self._which.tolist()) if known[k] is not None}


class _Alike:
    """Points of boxes of one kind, and their rows among others."""

    def __init__(self, parts: Sequence[tuple[Box, FloatArray, IntArray]]) -> None:
        self._boxes = [box for box, _, _ in parts]
        self._which = np.repeat(np.arange(len(parts)), [len(points) for _, points, _ in parts])
        self._points = np.concatenate([points for _, points, _ in parts])
        self._rows = np.concatenate([rows for _, _, rows in parts])

    def set_numbers(self, numbers: Mapping[str, FloatArray]) -> None:
        """Set the single numbers of the intervals."""
        for path, place in self._boxes[0].numbers.items():
            numbers[path][self._rows, 0] = self._points[:, place]

    def move(self, series: Mapping[str, FloatArray]) -> None:
        """Set the figures of phases of the intervals, and those that follow them."""
        columns = self._boxes[0].columns
        if "torque_Nm" in columns:
            self._move_torques(series, columns["torque_Nm"])
        if "speed_rpm" in columns:
            self._move_speeds(series, columns["speed_rpm"])
        for name, (of, phases) in columns.items():
            if name not in ("torque_Nm", "speed_rpm"):
                series[name][self._at(phases)] = np.abs(self._points[:, of])
        if any(name in columns for name in WITH_TORQUE):
            every = self._at(np.arange(self._boxes[0].series.shape[-1]))
            T, peak, rms, least = (series[name][every] for name in WITH_TORQUE)
            by_default = least_torque(torque_Nm=T, peak_torque_Nm=peak, rms_torque_Nm=rms)
            series["least_torque_Nm"][every] = np.where(self._is_given("least_torque_Nm"), least, by_default)

    def _at(self, phases: IntArray) -> tuple[IntArray, int, IntArray]:
        return self._rows[:, None], 0, phases

    def _of_intervals(self, name: str, of: IntArray) -> FloatArray:
        """Value or end of some intervals in each row, shape (rows, intervals)."""
        values: FloatArray = np.array([getattr(box, name) for box in self._boxes])[self._which][:, of]
        return values

    def _is_given(self, name: str) -> NDArray[np.bool_]:
        """True for phases with a given value of a figure that otherwise follows another, shape (rows, phases)."""
        is_given: NDArray[np.bool_] = np.array([box.own[name] for box in self._boxes])[self._which]
        return is_given

    def _move_torques(self, series: Mapping[str, FloatArray], column: PhaseIntervals) -> None:
        """Set torques; peaks, RMS and least torques follow by one factor, or by a sum where the interval includes 0."""
        of, phases = column
        at, x = self._at(phases), self._points[:, of]
        value, low, high = (self._of_intervals(name, of) for name in ("value", "low", "high"))
        reaches, factor = (low <= 0) & (high >= 0), np.abs(x / value)
        series["torque_Nm"][at], series["torque_sign"][at] = np.abs(x), np.sign(x)
        for name in WITH_TORQUE[1:]:
            own = series[name][at]
            grown = np.zeros(1) if name == "least_torque_Nm" else own + np.abs(x - value)
            moved = np.where(reaches, grown, own * factor)
            series[name][at] = np.where(self._is_given(name)[:, phases], moved, np.abs(x))

    def _move_speeds(self, series: Mapping[str, FloatArray], column: PhaseIntervals) -> None:
        """Set speeds; peaks follow by one factor."""
        of, phases = column
        at, x = self._at(phases), self._points[:, of]
        peak = series["peak_speed_rpm"][at] * np.abs(x / self._of_intervals("value", of))
        series["speed_rpm"][at] = np.abs(x)
        series["peak_speed_rpm"][at] = np.where(self._is_given("peak_speed_rpm")[:, phases], peak, np.abs(x))


def moved(application: Application, values: Mapping[Place, float]) -> Application:
    """The application at a point of its box, without tolerances; raises ValidationError if invalid."""
    document = application.model_dump(exclude_unset=True)
    for place, value in values.items():
        part: Any = document["duty_cycle"] if place[0] in ("phases", "motion") else document
        for step in place[:-1]:
            part = part.setdefault(step, {}) if isinstance(part, dict) else part[step]
        part[place[-1]] = value
    document.pop("tolerances", None)
    requirements = document.get("requirements")
    if requirements:
        requirements.pop("over_tolerance", None)
        allowed = requirements.pop("worst_case_utilisation", None)
        if allowed is not None:
            requirements["utilisation"] = allowed
    return type(application).model_validate(document)

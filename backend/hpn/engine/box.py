"""Boxes of tolerances: an application whose inputs lie between two ends each, and any of its points as rows of a duty.

The rows are arrays before the equations, so that hundreds of points go through the same lines as one application.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hpn.application import Application
from hpn.application.tolerances import Interval, Place
from hpn.engine.duty import Duty, InputArrays, Phases, least_torque
from hpn.physics.equations import FloatArray

IntArray = NDArray[np.intp]

CYCLE_LOADS = ("output_load.radial_N", "output_load.axial_N")
"""Loads of the whole cycle, which the engine takes phase by phase."""

WITH_TORQUE = ("torque_Nm", "peak_torque_Nm", "rms_torque_Nm", "least_torque_Nm")
SERIES = (*Phases.__dataclass_fields__,)
TEXTS = tuple(name for name in InputArrays.__dataclass_fields__ if name not in ("numbers", "shaft_centres_mm"))


class Ends(NamedTuple):
    """Values of an input at both ends of some intervals, by magnitude; `of` are their places."""

    of: IntArray
    at_low: FloatArray
    at_high: FloatArray


class PhaseIntervals(NamedTuple):
    """Intervals of one field of the phases, and the phases that each moves; one of a whole cycle moves several."""

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
        """The point as it is given."""
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
        """Intervals of phases by field; in each phase its own before that of the whole cycle."""
        pairs_by_field: dict[str, list[tuple[int, int]]] = {}
        for place, one in enumerate(self.intervals):
            for phase in self._phases_of(one):
                pairs_by_field.setdefault(str(one.place[-1]), []).append((place, phase))
        return {name: PhaseIntervals(*np.array(pairs, np.intp).T) for name, pairs in pairs_by_field.items()}

    def _phases_of(self, one: Interval) -> Sequence[int]:
        """Phases whose field an interval moves; none for another number."""
        if one.place[0] == "phases":
            return (int(one.place[1]),)
        if one.place[:2] == ("motion", "moves"):
            moves: list[int] = np.flatnonzero(self.duty.courses[0].move == one.place[2]).tolist()
            return moves
        path, phases = ".".join(map(str, one.place)), self.application.duty_cycle.load_phases
        if path not in CYCLE_LOADS:
            return ()
        return [k for k, phase in enumerate(phases) if getattr(phase, str(one.place[-1])) is None]

    @cached_property
    def numbers(self) -> Mapping[str, int]:
        """Places of the intervals of single numbers, by path."""
        paths = {".".join(map(str, one.place)): place for place, one in enumerate(self.intervals)}
        return {path: place for path, place in paths.items() if path in self.duty.asked.numbers}

    @cached_property
    def _own(self) -> Mapping[str, NDArray[np.bool_]]:
        """True for phases in which a figure that follows another by default is given, shape (phases,)."""
        phases = self.application.duty_cycle.load_phases
        names = ("peak_torque_Nm", "rms_torque_Nm", "least_torque_Nm", "peak_speed_rpm")
        return {name: np.array([getattr(phase, name) is not None for phase in phases]) for name in names}

    def at(self, points: FloatArray) -> Duty:
        """Duty of points, a row for each."""
        base, count = self.duty, len(points)
        series = {name: np.repeat(getattr(base.typed, name), count, axis=0) for name in SERIES}
        columns = self.columns
        if "torque_Nm" in columns:
            self._move_torques(series, points, columns["torque_Nm"])
        if "speed_rpm" in columns:
            self._move_speeds(series, points, columns["speed_rpm"])
        for name, column in columns.items():
            if name not in ("torque_Nm", "speed_rpm"):
                series[name][:, 0, column.phases] = np.abs(points[:, column.of])
        if any(name in columns for name in WITH_TORQUE):
            T, peak, rms = (series[name] for name in WITH_TORQUE[:3])
            by_default = least_torque(torque_Nm=T, peak_torque_Nm=peak, rms_torque_Nm=rms)
            series["least_torque_Nm"] = np.where(self._own["least_torque_Nm"], series["least_torque_Nm"], by_default)
        return Duty(Phases(**series), self._asked_at(points), *self._motions(count))

    def _move_torques(self, series: Mapping[str, FloatArray], points: FloatArray, column: PhaseIntervals) -> None:
        """Set torques, and peaks, RMS and least torques that go with them by one factor, or by what is added at 0."""
        of, phases = column
        x, value = points[:, of], self.value[of]
        reaches, factor = (self.low[of] <= 0) & (self.high[of] >= 0), np.abs(x / value)
        series["torque_Nm"][:, 0, phases], series["torque_sign"][:, 0, phases] = np.abs(x), np.sign(x)
        for name in WITH_TORQUE[1:]:
            is_given, own = self._own[name][phases], series[name][:, 0, phases]
            grown = np.zeros(1) if name == "least_torque_Nm" else own + np.abs(x - value)
            moved = np.where(reaches, grown, own * factor)
            series[name][:, 0, phases] = np.where(is_given, moved, np.abs(x))

    def _move_speeds(self, series: Mapping[str, FloatArray], points: FloatArray, column: PhaseIntervals) -> None:
        """Set speeds, and peaks that go with them by one factor."""
        of, phases = column
        x = points[:, of]
        peak = series["peak_speed_rpm"][:, 0, phases] * np.abs(x / self.value[of])
        is_given = self._own["peak_speed_rpm"][phases]
        series["speed_rpm"][:, 0, phases] = np.abs(x)
        series["peak_speed_rpm"][:, 0, phases] = np.where(is_given, peak, np.abs(x))

    def _asked_at(self, points: FloatArray) -> InputArrays:
        inputs, count = self.duty.asked, len(points)
        numbers = dict(zip(inputs.numbers, np.repeat(self._table, count, axis=1), strict=True))
        numbers |= {path: points[:, place, None] for path, place in self.numbers.items()}
        u, allowed = (numbers[f"requirements.{name}"] for name in ("utilisation", "worst_case_utilisation"))
        numbers["requirements.utilisation"] = np.where(np.isnan(allowed), u, allowed)
        by_size = {size: np.repeat(values, count, axis=0) for size, values in inputs.shaft_centres_mm.items()}
        texts = {name: np.repeat(getattr(inputs, name), count, axis=0) for name in TEXTS}
        return InputArrays(numbers, **texts, shaft_centres_mm=by_size)

    @cached_property
    def _table(self) -> FloatArray:
        """Single numbers of the application, shape (numbers, 1, 1)."""
        return np.array(list(self.duty.asked.numbers.values()))

    def _motions(self, count: int) -> tuple[Mapping[int, Any], Mapping[int, Any]]:
        courses, stopped = self.duty.courses, self.duty.stopped_loads
        rows = range(count)
        return dict.fromkeys(rows, courses[0]) if courses else {}, dict.fromkeys(rows, stopped[0]) if stopped else {}

    def application_at(self, point: FloatArray) -> Application:
        """The application at a point, as one would type it."""
        typed = self.at(point[None]).typed
        values = {one.place: float(x) for one, x in zip(self.intervals, point.tolist(), strict=True) if x != one.value}
        for place in tuple(values):
            if place[0] == "phases":
                followers = {*self._moved_by(str(place[2]))} - {place[2], "torque_sign"}
                for name in followers:
                    own = (*place[:2], name) in values or any(one.place == (*place[:2], name) for one in self.intervals)
                    if not own and self._own[name][int(place[1])]:
                        values[(*place[:2], name)] = float(getattr(typed, name)[0, 0, int(place[1])])
        return moved(self.application, values)

    @cached_property
    def ends(self) -> Mapping[str, Ends]:
        """Inputs that the intervals move, by their names in `Check.over`, at both ends."""
        ends_by_name: dict[str, Ends] = {}
        series = self.at(np.stack((self.low, self.high))).typed if self.columns else None
        for name, column in self.columns.items():
            for moved in self._moved_by(name):
                own = self.columns[moved].phases if moved != name and moved in self.columns else ()
                keep = ~np.isin(column.phases, own)
                values = getattr(series, moved)[:, 0, column.phases[keep]]
                seen = ends_by_name.get(moved)
                ends = Ends(column.of[keep], values[0], values[1])
                ends_by_name[moved] = ends if seen is None else _both(seen, ends)
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
        """Figures of a phase that one of its inputs moves."""
        if name == "torque_Nm":
            return (*WITH_TORQUE, "torque_sign")
        return ("speed_rpm", "peak_speed_rpm") if name == "speed_rpm" else (name,)


def _both(first: Ends, second: Ends) -> Ends:
    return Ends(
        np.concatenate((first.of, second.of)),
        np.concatenate((first.at_low, second.at_low)),
        np.concatenate((first.at_high, second.at_high)),
    )


def duty_of(parts: Sequence[tuple[Box, FloatArray]]) -> Duty:
    """Duty of points of boxes, a row for each; points of one box that follow each other are taken together."""
    duties = []
    for _, group in groupby(parts, key=lambda part: id(part[0])):
        own = list(group)
        duties.append(own[0][0].at(np.concatenate([points for _, points in own])))
    return _joined(duties)


def _joined(duties: Sequence[Duty]) -> Duty:
    """Duties one below the other; shorter cycles are padded."""
    if len(duties) == 1:
        return duties[0]
    longest = max(duty.typed.torque_Nm.shape[-1] for duty in duties)

    def padded(values: FloatArray) -> FloatArray:
        missing = longest - values.shape[-1]
        return np.pad(values, ((0, 0), (0, 0), (0, missing))) if missing else values

    phases = Phases(*(np.concatenate([padded(getattr(duty.typed, name)) for duty in duties]) for name in SERIES))
    paths = duties[0].asked.numbers
    numbers = {path: np.concatenate([duty.asked.numbers[path] for duty in duties]) for path in paths}
    texts = {name: np.concatenate([getattr(duty.asked, name) for duty in duties]) for name in TEXTS}
    unknown = [np.full((len(duty.asked.rank_by), 1), np.nan) for duty in duties]
    centres = [duty.asked.shaft_centres_mm for duty in duties]
    by_size = {
        size: np.concatenate([own.get(size, none) for own, none in zip(centres, unknown, strict=True)])
        for size in dict.fromkeys(size for own in centres for size in own)
    }
    counts = [len(duty.asked.rank_by) for duty in duties]
    starts = np.cumsum([0, *counts[:-1]]).tolist()
    courses = {
        start + row: one for start, duty in zip(starts, duties, strict=True) for row, one in duty.courses.items()
    }
    stopped = {
        start + row: one for start, duty in zip(starts, duties, strict=True) for row, one in duty.stopped_loads.items()
    }
    return Duty(phases, InputArrays(numbers, **texts, shaft_centres_mm=by_size), courses, stopped)


def moved(application: Application, values: Mapping[Place, float]) -> Application:
    """The application at a point of its box, without tolerances; raises ValidationError where that is none."""
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

"""Tolerances: permitted deviations of inputs from their values, and the resulting intervals of an application.

A tolerance is named by the path of its input, like the columns of a fleet; a phase's field by itself stands for this
field of every phase.
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Annotated, Any, Self

from pydantic import BaseModel, BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError, PydanticKnownError

from hpn.application.phase import ROOM, Phase
from hpn.words.fields import LEAST, Model, Number, refused
from hpn.words.wording import N_

MOST_TOLERANCES = 50
LONGEST_PATH = 100

Percent = Annotated[Number, Field(ge=0, le=1e6)]
Amount = Annotated[Number, Field(ge=0, le=1e12)]

ONE_KIND = N_("give one of percent, absolute, or minus and plus")


class Deviation(Model):
    """Deviation of an input to one side of its value."""

    percent: Percent | None = Field(None, description="Percent of the value’s magnitude.", examples=[10.0])
    absolute: Amount | None = Field(None, description="Deviation in the input’s own unit.")

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        if (self.percent is None) == (self.absolute is None):
            raise PydanticCustomError("one_deviation", "give either percent or absolute")
        return self

    def of(self, value: float) -> float:
        """Deviation from a value in its own unit."""
        return _deviation(self.percent, self.absolute, value)


def _deviation(percent: float | None, absolute: float | None, value: float) -> float:
    return absolute if absolute is not None else abs(value) * (percent or 0.0) / 100


class Tolerance(Model):
    """Deviation of an input from its value: the same to both sides, or minus and plus separately."""

    percent: Percent | None = Field(None, description="Percent of the value’s magnitude.", examples=[10.0])
    absolute: Amount | None = Field(None, description="Deviation in the input’s own unit.")
    minus: Deviation | None = Field(None, description="Deviation below the value; without it none.")
    plus: Deviation | None = Field(None, description="Deviation above the value; without it none.")

    @model_validator(mode="before")
    @classmethod
    def _has_both_sides(cls, value: Any) -> Any:
        """A tolerance to one side has no deviation to the other."""
        if not isinstance(value, dict) or (value.get("minus") is None) == (value.get("plus") is None):
            return value
        missing = "minus" if value.get("minus") is None else "plus"
        return {**value, missing: {"percent": 0.0}}

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        kinds = self.percent is not None, self.absolute is not None, bool(self.minus or self.plus)
        if sum(kinds) != 1:
            raise PydanticCustomError("one_tolerance", ONE_KIND)
        return self

    @property
    def sides(self) -> tuple[Deviation | None, Deviation | None]:
        """Deviations below and above the value."""
        if self.minus or self.plus:
            return self.minus, self.plus
        alike = Deviation(percent=self.percent, absolute=self.absolute)
        return alike, alike

    def around(self, value: float) -> tuple[float, float]:
        """Smallest and largest value."""
        minus, plus = self.minus, self.plus
        if not (minus or plus):
            alike = _deviation(self.percent, self.absolute, value)
            return value - alike, value + alike
        return value - (minus.of(value) if minus else 0.0), value + (plus.of(value) if plus else 0.0)


def _without_nulls(value: Any) -> Any:
    """Tolerances without nulls, which count as not given."""
    if not isinstance(value, dict):
        return value
    if len(value) > MOST_TOLERANCES:
        counts = {"field_type": "Dictionary", "max_length": MOST_TOLERANCES, "actual_length": len(value)}
        raise PydanticKnownError("too_long", counts)
    return {path: each for path, each in value.items() if each is not None}


Path = Annotated[str, Field(max_length=LONGEST_PATH)]
Tolerances = Annotated[
    dict[Path, Tolerance], Field(json_schema_extra={"maxProperties": MOST_TOLERANCES}), BeforeValidator(_without_nulls)
]

# --- Intervals --------------------------------------------------------------------------------------------------------

CROSSING = (
    "torque_Nm",
    "radial_N",
    "axial_N",
    "external_torque_Nm",
    "external_force_N",
    "ambient_temperature_degC",
    "radial_position_mm",
    "incline_deg",
    "start_deg",
)
"""Inputs that may cross 0. Others keep their sign, or their bound at 0."""

SIGNED = ("speed_rpm", "pause_s", "inertia_kgm2", "load_inertia_kgm2", "mass_kg", "angle_deg", "distance_mm")
"""Inputs with a bound of 0 or below that a tolerance must not reach."""

WITHOUT = (
    "requirements.utilisation",
    "requirements.worst_case_utilisation",
    "requirements.motor.stall_torque_Nm",
    "requirements.motor.weight_kg",
    "emergency_stop.count",
)
"""Numbers without a tolerance: criteria, counts, and figures that are not judged by themselves."""

PHASE_PATHS = tuple(name for name in Phase.model_fields if name != "name")
LOADS = ("radial_N", "axial_N")
NUMBERED = re.compile(r"(phases|motion\.moves)\.(0|[1-9][0-9]{0,4})\.([A-Za-z0-9_]+)")

Place = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class Interval:
    """One number of an application with its tolerance: `path` names the entry, `place` the number.

    It lies between `low` and `high`; `least` and `most` are the bounds of its field. With `is_open` the bound next to 0
    can't be reached.
    """

    path: str
    place: Place
    value: float
    low: float
    high: float
    least: float
    most: float
    is_open: bool

    def grown(self, factor: float) -> "Interval":
        """The interval with its tolerance times a factor, within the bounds of its field."""
        low, high = (self.value + factor * (end - self.value) for end in (self.low, self.high))
        return replace(self, low=max(low, self.least), high=min(high, self.most))

    @property
    def most_growth(self) -> float:
        """Factor of its tolerance at which it reaches a bound; infinite without one."""
        below, above = self.value - self.low, self.high - self.value
        rooms = [(self.value - self.least) / below] if below > 0 else []
        rooms += [(self.most - self.value) / above] if above > 0 else []
        return min(rooms, default=math.inf)

    @property
    def fault(self) -> PydanticCustomError | PydanticKnownError | None:
        """Error of an interval that leaves the bounds of its field; None for any other."""
        if self.low < self.least or (self.is_open and self.low == self.least):
            if self.least in (0, LEAST):
                return PydanticCustomError("tolerance_sign", KEEPS_SIGN)
            return PydanticCustomError("tolerance_least", BELOW, {"bound": f"{self.least:g}"})
        if self.high > self.most or (self.is_open and self.high == self.most == 0):
            if self.most == 0:
                return PydanticCustomError("tolerance_sign", KEEPS_SIGN)
            return PydanticCustomError("tolerance_most", ABOVE, {"bound": f"{self.most:g}"})
        return None


KEEPS_SIGN = N_("must leave the input on its side of 0")
BELOW = N_("must leave the input at or above its bound {bound}")
ABOVE = N_("must leave the input at or below its bound {bound}")
OVERLAP = N_("must leave {upper} at or above {lower} everywhere: the tolerances of both overlap")
WITH_VALUES = {"tolerance_least": BELOW, "tolerance_most": ABOVE, "tolerance_held": OVERLAP}
"""Texts of errors with values, by their codes."""

NOT_GIVEN = N_("the input is 0 or not given, so it takes no tolerance")
NO_INPUT = N_("is not a path of an input that takes a tolerance, such as torque_Nm, phases.1.torque_Nm or pause_s")
OF_MOTION = N_("a motion has no phases that are typed: name motion.mechanism or motion.moves, or radial_N or axial_N")


def intervals_of(application: Any, tolerances: Mapping[str, Tolerance]) -> tuple[Interval, ...]:
    """Intervals of an application by its tolerances; raises ValidationError with the place of each invalid tolerance.

    The path of one phase has precedence over that of all phases.
    """
    intervals: dict[Place, Interval] = {}
    problems: list[tuple[Place, Any]] = []
    for path in sorted(tolerances, key=lambda one: NUMBERED.fullmatch(one) is not None):
        try:
            targets = list(_targets(application, path))
        except _NoTargetError as error:
            problems.append(((path,), error.problem))
            continue
        for part, name, place in targets:
            interval = _interval(path, part, name, place, tolerances[path])
            if (fault := interval.fault) is not None:
                problems.append(((path,), fault))
                break
            intervals[place] = interval
    if not problems:
        problems += _contradictions(application, intervals)
    if problems:
        below = [(("tolerances", *place), problem) for place, problem in problems]
        raise refused(application, *below)
    return tuple(one for one in intervals.values() if one.low < one.high)


class _NoTargetError(ValueError):
    def __init__(self, code: str, text: str) -> None:
        super().__init__(text)
        self.problem = PydanticCustomError(code, text)


def _targets(application: Any, path: str) -> Iterator[tuple[BaseModel, str, Place]]:
    """Yield the numbers of a path: the part of each, its name, and its place."""
    cycle = application.duty_cycle
    if path in PHASE_PATHS:
        yield from _of_all(cycle, path)
        return
    match = NUMBERED.fullmatch(path)
    if match:
        table, number, name = match[1], int(match[2]), match[3]
        rows: Sequence[BaseModel] = (cycle.phases if table == "phases" else cycle.motion and cycle.motion.moves) or ()
        if number >= len(rows) or name not in type(rows[number]).model_fields:
            raise _NoTargetError("tolerance_path", NO_INPUT)
        part, place = rows[number], (*table.split("."), number, name)
    else:
        part, name, place = _single(application, path)
    value = getattr(part, name)
    if _bounds(type(part), name) is None or not isinstance(value, float | None):
        raise _NoTargetError("tolerance_path", NO_INPUT)
    if not value:
        raise _NoTargetError("tolerance_of_nothing", NOT_GIVEN)
    yield part, name, place


def _of_all(cycle: Any, name: str) -> Iterator[tuple[BaseModel, str, Place]]:
    if cycle.motion is not None and name not in LOADS:
        raise _NoTargetError("tolerance_of_motion", OF_MOTION)
    table: Place = ("phases",) if cycle.motion is None else ("motion", "moves")
    rows = cycle.phases if cycle.motion is None else cycle.motion.moves
    for number, row in enumerate(rows):
        if getattr(row, name):
            yield row, name, (*table, number, name)


def _single(application: Any, path: str) -> tuple[Any, str, Place]:
    """Part, name and place of the single number of a path without an index."""
    if path in WITHOUT or path.startswith("duty_cycle"):
        raise _NoTargetError("tolerance_path", NO_INPUT)
    *parts, name = path.split(".")
    part = application.duty_cycle if parts[:1] == ["motion"] or path == "pause_s" else application
    for step in parts:
        if not isinstance(part, BaseModel) or step not in type(part).model_fields:
            raise _NoTargetError("tolerance_path", NO_INPUT)
        part = getattr(part, step)
        if part is None:
            raise _NoTargetError("tolerance_of_nothing", NOT_GIVEN)
    if not isinstance(part, BaseModel) or name not in type(part).model_fields:
        raise _NoTargetError("tolerance_path", NO_INPUT)
    return part, name, ("duty_cycle", name) if path == "pause_s" else (*parts, name)


def _interval(path: str, part: BaseModel, name: str, place: Place, tolerance: Tolerance) -> Interval:
    value: float = getattr(part, name)
    low, high = tolerance.around(value)
    least, most = _bounds(type(part), name) or (-math.inf, math.inf)
    is_open = name in SIGNED or (name == "duration_s")
    if name not in CROSSING:
        least, most = (max(least, 0.0), most) if value > 0 else (least, min(most, 0.0))
    return Interval(path, place, value, low, high, least, most, is_open)


@cache
def _bounds(model: type[BaseModel], name: str) -> tuple[float, float] | None:
    """Bounds of a number of a model; None for any other field."""
    entry = model.model_json_schema()["properties"][name]
    options = [option for option in entry.get("anyOf", entry.get("oneOf", (entry,))) if option.get("type") == "number"]
    if not options:
        return None
    least = options[0].get("minimum", options[0].get("exclusiveMinimum", -math.inf))
    return least, options[0].get("maximum", math.inf)


# --- Inputs that limit each other ------------------------------------------------------------------------------------

OWN = ("peak_torque_Nm", "rms_torque_Nm", "least_torque_Nm", "peak_speed_rpm")
STOP = ("emergency_stop", "brake")


def _contradictions(application: Any, intervals: Mapping[Place, Interval]) -> Iterator[tuple[Place, Any]]:
    """Errors of intervals in which inputs that limit each other would contradict."""
    for place, interval in intervals.items():
        if place[0] == "phases" and place[2] in OWN:
            number = int(place[1])
            yield from _of_phase(application.duty_cycle.phases[number], number, interval, intervals)
    names = ("load_torque_Nm", "opposing_torque_Nm")
    load, opposing = (intervals.get((*STOP, name)) for name in names)
    stop = application.emergency_stop
    if (own := load or opposing) and stop.brake.opposing_torque_Nm is not None:
        high = load.high if load else stop.brake.load_torque_Nm or 0.0
        low = opposing.low if opposing else stop.brake.opposing_torque_Nm
        if low < high:
            yield (own.path,), _overlap(names[1], names[0])


def _of_phase(
    phase: Phase, number: int, own: Interval, intervals: Mapping[Place, Interval]
) -> Iterator[tuple[Place, Any]]:
    """Errors of a phase with a tolerance of its own on a peak, the RMS or the least torque."""

    def given(name: str) -> float | None:
        """A figure as typed; a peak that is not typed follows the torque, and limits a typed RMS."""
        value: float | None = getattr(phase, name)
        return phase.torque_Nm if name == "peak_torque_Nm" and value is None else value

    def ends(name: str) -> tuple[float, float]:
        interval = intervals.get(("phases", number, name))
        value = abs(given(name) or 0.0)
        if interval is None:
            moving = intervals.get(("phases", number, name.partition("_")[2]))
            return moved_by(moving, value, is_least=name == "least_torque_Nm") if moving else (value, value)
        magnitudes = abs(interval.low), abs(interval.high)
        return 0.0 if interval.low < 0 < interval.high else min(magnitudes), max(magnitudes)

    for lower, upper in (
        ("torque_Nm", "peak_torque_Nm"),
        ("speed_rpm", "peak_speed_rpm"),
        ("rms_torque_Nm", "peak_torque_Nm"),
        ("least_torque_Nm", "torque_Nm"),
        ("least_torque_Nm", "rms_torque_Nm"),
    ):
        known = given(lower) is not None and given(upper) is not None
        if own.place[2] in (lower, upper) and known and ends(lower)[1] > ends(upper)[0] * (1 + ROOM):
            yield (own.path,), _overlap(upper, lower)


def moved_by(interval: Interval, value: float, *, is_least: bool) -> tuple[float, float]:
    """Ends of a peak, an RMS or a least torque that follows its phase's torque or speed."""
    if interval.low <= 0 <= interval.high:
        more = max(interval.value - interval.low, interval.high - interval.value)
        return (0.0, 0.0) if is_least else (value, value + more)
    low, high = sorted((interval.low / interval.value, interval.high / interval.value))
    return value * low, value * high


def _overlap(upper: str, lower: str) -> PydanticCustomError:
    return PydanticCustomError("tolerance_held", OVERLAP, {"upper": upper, "lower": lower})

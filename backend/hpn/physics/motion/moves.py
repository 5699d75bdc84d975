"""Moves from rest to rest: the user's inputs of each, and the times of its ramps."""

import math
from collections.abc import Sequence
from functools import cached_property
from typing import Annotated, ClassVar, Literal, NoReturn, Self

from pydantic import AfterValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from hpn.physics.equations import ROUNDING
from hpn.physics.motion.ramps import (
    Ramp,
    Shape,
    Timing,
    at_speed,
    at_speed_in_time,
    at_triangle,
    equal_ramps,
    in_time,
    triangle,
)
from hpn.physics.motion.refusals import refusal
from hpn.words.fields import LEAST, Load, Model, MoveTime, Number, Positive, Share, Torque, refused
from hpn.words.titles import Name
from hpn.words.units import suffix_of
from hpn.words.wording import Quantity, Rounding

Refusal = tuple[tuple[str, ...], PydanticCustomError]

Profile = Literal["trapezoidal", "triangular", "s_curve", "modified_sine", "dwell"]

DEFAULT_JERK_SHARE = 0.5

SEARCHED = 1e-13
"""Relative accuracy of a searched bound: less than ROUNDING, so that exact bounds are given exactly."""

MODIFIED_SINE_SPEED = 4 * math.pi / (4 + math.pi)
"""Largest over mean speed of a modified sine, c_v."""


def _some_way(value: float) -> float:
    if value == 0:
        raise refusal("way_zero")
    if abs(value) < LEAST:
        raise refusal("way_vanishing")
    return value


Way = Annotated[Number, Field(ge=-1e9, le=1e9), AfterValidator(_some_way)]


class Move(Model):
    """Fields of every move. Its way, speed, acceleration and load have names of their own in each geometry."""

    WAY: ClassVar[str]
    SPEED: ClassVar[str]
    ACCELERATION: ClassVar[str]
    DECELERATION: ClassVar[str]
    JERK: ClassVar[str]
    EXTERNAL: ClassVar[str]
    SPEED_UNIT: ClassVar[float]
    """Units of way per second in one unit of speed."""

    profile: Profile = Field(description="Speed profile.", examples=["trapezoidal"])
    time_s: MoveTime | None = Field(None, description="Time of the move.", examples=[0.8])
    jerk_share: Share | None = Field(
        None,
        description="Share of a ramp of an S-curve in which jerk acts, half of it at either end; 0.5 by default. A "
        "jerk may be given in its place.",
        examples=[0.5],
    )
    acceleration_time_s: MoveTime | None = Field(
        None, description="Time of the first ramp, in place of its acceleration.", examples=[0.2]
    )
    deceleration_time_s: MoveTime | None = Field(
        None, description="Time of the last ramp; without it and its deceleration that of the first.", examples=[0.4]
    )
    radial_N: Load | None = Field(
        None, description="Radial load on the gear’s shaft in this move; by default the cycle’s.", examples=[500.0]
    )
    axial_N: Load | None = Field(
        None, description="Axial load on the gear’s shaft in this move; by default the cycle’s.", examples=[200.0]
    )
    name: Name | None = Field(None, description="Your name for the move.", examples=["lift"])

    @property
    def way(self) -> float:
        """Signed angle or distance; 0 for a dwell."""
        return getattr(self, self.WAY) or 0.0

    @property
    def peak_speed(self) -> float:
        """Largest speed in units of way per second."""
        if self.profile == "modified_sine":
            return MODIFIED_SINE_SPEED * abs(self.way) / (self.time_s or 1.0)
        return self.timing.peak_speed if self.way else 0.0

    @property
    def shortest_ramp_s(self) -> float:
        """Time of its shorter ramp in s, half of a modified sine; not for a dwell."""
        return (self.time_s or 0.0) / 2 if self.profile == "modified_sine" else min(self.timing.ramps_s)

    @property
    def followed(self) -> dict[str, float]:
        """Time, peak speed, accelerations, times of the ramps and jerk that follow from the given fields, by field."""
        if self.profile in ("dwell", "modified_sine"):
            return {}
        timing, (ramp, last) = self.timing, self._ramp_fields
        figures = {"time_s": timing.time_s, self.SPEED: timing.peak_speed / self.SPEED_UNIT}
        figures |= dict(zip((ramp[0], last[0]), timing.ramps_s, strict=True))
        figures |= dict(zip((ramp[1], last[1]), timing.peak_accelerations, strict=True))
        figures |= self._followed_jerk(timing)
        return {field: value for field, value in figures.items() if getattr(self, field) is None}

    @property
    def external(self) -> float:
        """External torque or force."""
        return float(getattr(self, self.EXTERNAL))

    @property
    def _jerk(self) -> float | None:
        jerk: float | None = getattr(self, self.JERK)
        return jerk

    @property
    def _shape(self) -> Shape:
        """Share of jerk, or jerk, of its ramps."""
        if self.profile != "s_curve":
            return Shape()
        if self._jerk is not None:
            return Shape(jerk=self._jerk)
        return Shape(DEFAULT_JERK_SHARE if self.jerk_share is None else self.jerk_share)

    def _followed_jerk(self, timing: Timing) -> dict[str, float]:
        """Jerk of an S-curve from its share, or the share from its jerk, if both ramps are alike."""
        if self.profile != "s_curve" or timing.ramps_s[0] != timing.ramps_s[1]:
            return {}
        a, t, share = timing.peak_accelerations[0], timing.ramps_s[0], timing.jerk_shares[0]
        return {"jerk_share": share} if self._jerk is not None else {self.JERK: 2 * a / (share * t)}

    @model_validator(mode="after")
    def _is_possible(self) -> Self:
        self._check_fields()
        if self.profile in ("trapezoidal", "triangular", "s_curve"):
            _ = self.timing
        return self

    def _check_fields(self) -> None:
        """Refuse fields that the profile doesn't use, and the lack of needed ones."""
        needed = {"dwell": ("time_s",), "modified_sine": (self.WAY, "time_s")}.get(self.profile, (self.WAY,))
        ramps, unequal = ("jerk_share", self.JERK), ("acceleration_time_s", "deceleration_time_s", self.DECELERATION)
        idle: Sequence[str] = {
            "dwell": (self.WAY, self.SPEED, self.ACCELERATION, *ramps, *unequal),
            "modified_sine": (self.SPEED, self.ACCELERATION, *ramps, *unequal),
            "triangular": (*ramps, *unequal),
            "trapezoidal": ramps,
        }.get(self.profile, ())
        problems = [
            ((name,), refusal("move_has_no", profile=self.profile, field=name))
            for name in idle
            if getattr(self, name) is not None
        ] + [
            ((), refusal("move_needs", profile=self.profile, field=name))
            for name in needed
            if getattr(self, name) is None
        ]
        if problems:
            raise refused(self, *problems)

    @cached_property
    def timing(self) -> Timing:
        """Ramps and run of a trapezoid, triangle or S-curve; raises ValidationError if impossible."""
        shape, jerk = self._shape, self._jerk
        if jerk is not None and self.jerk_share is not None:
            raise refused(self, ((self.JERK,), refusal("ramp_twice", field="jerk_share")))
        timing = self._timing_of(shape)
        if jerk is not None and (timing.least_jerk > jerk * (1 + ROUNDING) if timing else self._timing_of(Shape())):
            self._refuse(self.JERK, "jerk_too_low", bound=_quantity(self._least_jerk(jerk), self.JERK))
        return timing or self._refuse_ramps(shape)

    def _least_jerk(self, low: float) -> float:
        """Smallest jerk at which the move is possible, if `low` is not enough and a higher jerk is.

        With more jerk the ramps grow shorter, and the jerk they need grows more slowly.
        """

        def suffices(jerk: float) -> bool:
            timing = self._timing_of(Shape(jerk=jerk))
            return timing is not None and timing.least_jerk <= jerk * (1 + ROUNDING)

        high = low
        while not suffices(high):
            low, high = high, high * 1e3
        while high > low * (1 + SEARCHED):
            middle = math.sqrt(low * high)
            low, high = (low, middle) if suffices(middle) else (middle, high)
        return high

    def _timing_of(self, shape: Shape) -> Timing | None:
        """Ramps and run with a shape of ramps; None if these leave too little time."""
        T, speed, names = self.time_s, getattr(self, self.SPEED), self._durations
        D, V = abs(self.way), None if speed is None else speed * self.SPEED_UNIT
        if self.profile == "triangular":
            if len(names) != 1:
                self._refuse_count("move_takes_one", names)
            return triangle(D, T or (2 * D / V if V else 2 * math.sqrt(D / getattr(self, self.ACCELERATION))))
        ramps = [self._ramp(place) for place in (0, 1)]
        known = [ramp for ramp in ramps if ramp]
        if (T is None and (V is None or not known)) or (T is not None and V is not None and len(known) == 2):
            self._refuse_count("move_takes_two", names)
        if T is not None and V is not None:
            self._check_speed(D, T, V, known)
            return at_speed_in_time(D, T, V, ramps, shape)
        if not known:
            return equal_ramps(D, T or 0.0, (T or 0.0) / 3, shape)
        pair = [ramp or known[0] for ramp in ramps]
        return at_speed(D, V or 0.0, pair, shape) if T is None else in_time(D, T, pair, shape)

    @property
    def _ramp_fields(self) -> tuple[tuple[str, str], tuple[str, str]]:
        """Fields of each ramp: its time and its acceleration."""
        return ("acceleration_time_s", self.ACCELERATION), ("deceleration_time_s", self.DECELERATION)

    @property
    def _durations(self) -> list[str]:
        """Given fields that determine the time of the move."""
        names = ("time_s", self.SPEED, *(name for fields in self._ramp_fields for name in reversed(fields)))
        return [name for name in names if getattr(self, name) is not None]

    def _ramp(self, place: int) -> Ramp | None:
        time, acceleration = self._ramp_fields[place]
        t, a = getattr(self, time), getattr(self, acceleration)
        if t is not None and a is not None:
            raise refused(self, ((time,), refusal("ramp_twice", field=acceleration)))
        return None if t is None and a is None else Ramp(t, math.inf if a is None else a)

    def _check_speed(self, D: float, T: float, V: float, ramps: Sequence[Ramp]) -> None:
        """Refuse a speed that does not cover the way D in time T, or that leaves no time for a second ramp."""
        fastest = 2 * D / T
        if not D / T < V * (1 - ROUNDING):
            speeds = (_quantity(speed / self.SPEED_UNIT, self.SPEED) for speed in (D / T, fastest))
            self._refuse(self.SPEED, "move_too_slow", bound=next(speeds), triangle=next(speeds))
        if ramps and fastest * (1 + ROUNDING) < V:
            self._refuse(self.SPEED, "move_too_fast", bound=_quantity(fastest / self.SPEED_UNIT, self.SPEED, "down"))

    def _refuse_ramps(self, shape: Shape) -> NoReturn:
        """Refuse ramps that together take too long: the longer one, or both where the shorter is too long by itself."""
        D, T, ramps = abs(self.way), self.time_s or 0.0, [self._ramp(place) for place in (0, 1)]
        place = 1 if ramps[0] is None else 0
        pair = [ramp or ramps[place] or Ramp() for ramp in ramps]
        V, codes = 2 * D / T, ("ramp_too_long", "move_too_gentle")
        times = at_triangle(D, T, pair, shape)
        if (speed := getattr(self, self.SPEED)) is not None:
            V, codes = speed * self.SPEED_UNIT, ("ramp_leaves_none", "ramp_too_gentle")
            left = {place: 2 * (T - D / V)}
        elif pair[0] is pair[1]:
            left = {place: T / 2}
        elif min(times) < T:
            left = {times.index(max(times)): T - min(times)}
        else:
            left = {0: T / 2, 1: T / 2}
        bounds = {place: Ramp(time_s, shape.peak_of(V, time_s)) for place, time_s in left.items()}
        raise refused(self, *(self._too_slow(place, pair[place], bound, *codes) for place, bound in bounds.items()))

    def _too_slow(self, place: int, ramp: Ramp, bound: Ramp, by_time: str, by_acceleration: str) -> Refusal:
        """Error for a ramp, with the bound of its given field."""
        time, acceleration = self._ramp_fields[place]
        if ramp.time_s is None:
            return (acceleration,), refusal(by_acceleration, bound=_quantity(bound.acceleration, acceleration))
        return (time,), refusal(by_time, bound=_quantity(bound.time_s or 0.0, time, "down"))

    def _refuse(self, field: str, code: str, **values: Quantity | str) -> NoReturn:
        raise refused(self, ((field,), refusal(code, **values)))

    def _refuse_count(self, code: str, names: Sequence[str]) -> NoReturn:
        words = ", ".join(names) or "none"
        fields = ", ".join(("time_s", self.SPEED, self.ACCELERATION))
        raise refused(self, ((), refusal(code, profile=self.profile, fields=fields, given=words)))


def _quantity(value: float, field: str, rounding: Rounding = "up") -> Quantity:
    """A bound with its unit, rounded so that the printed figure is accepted."""
    return Quantity(value, suffix_of(field), 6, rounding)


class Turn(Move):
    """A move of a rotary mechanism."""

    WAY, SPEED, EXTERNAL = "angle_deg", "speed_rpm", "external_torque_Nm"
    ACCELERATION, DECELERATION = "acceleration_deg_per_s2", "deceleration_deg_per_s2"
    JERK = "jerk_deg_per_s3"
    SPEED_UNIT = 6.0

    angle_deg: Way | None = Field(
        None, description="Angle with its direction; every move has one but a dwell.", examples=[90.0]
    )
    speed_rpm: Positive | None = Field(None, description="Peak speed of the mechanism.", examples=[25.0])
    acceleration_deg_per_s2: Positive | None = Field(
        None, description="Acceleration of the first ramp; of an S-curve its peak.", examples=[900.0]
    )
    deceleration_deg_per_s2: Positive | None = Field(
        None, description="Deceleration of the last ramp; without it that of the first.", examples=[450.0]
    )
    jerk_deg_per_s3: Positive | None = Field(
        None,
        description="Jerk of an S-curve in place of its share: it acts at both ends of each ramp.",
        examples=[20000.0],
    )
    external_torque_Nm: Torque = Field(
        0.0, description="External torque in this move; a positive one opposes positive motion.", examples=[30.0]
    )


class Stroke(Move):
    """A move of a rack, belt or screw."""

    WAY, SPEED, EXTERNAL = "distance_mm", "speed_mm_per_s", "external_force_N"
    ACCELERATION, DECELERATION = "acceleration_mm_per_s2", "deceleration_mm_per_s2"
    JERK = "jerk_mm_per_s3"
    SPEED_UNIT = 1.0

    distance_mm: Way | None = Field(
        None, description="Distance with its direction; every move has one but a dwell.", examples=[500.0]
    )
    speed_mm_per_s: Positive | None = Field(None, description="Peak speed of the mass.", examples=[500.0])
    acceleration_mm_per_s2: Positive | None = Field(
        None, description="Acceleration of the first ramp; of an S-curve its peak.", examples=[2500.0]
    )
    deceleration_mm_per_s2: Positive | None = Field(
        None, description="Deceleration of the last ramp; without it that of the first.", examples=[1250.0]
    )
    jerk_mm_per_s3: Positive | None = Field(
        None,
        description="Jerk of an S-curve in place of its share: it acts at both ends of each ramp.",
        examples=[50000.0],
    )
    external_force_N: Load = Field(
        0.0, description="External force in this move; a positive one opposes positive motion.", examples=[200.0]
    )

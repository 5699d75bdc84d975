"""Moves from rest to rest: what a person says of each, and how long its ramps take."""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, ClassVar, Literal, NoReturn, Self

from pydantic import AfterValidator, Field, model_validator

from hpn.physics.motion.refusals import refusal
from hpn.words.fields import LEAST, Load, Model, MoveTime, Number, Positive, Share, Torque, refused
from hpn.words.units import suffix_of
from hpn.words.wording import Quantity

Profile = Literal["trapezoidal", "triangular", "s_curve", "modified_sine", "dwell"]

DEFAULT_JERK_SHARE = 0.5

MODIFIED_SINE_SPEED = 4 * math.pi / (4 + math.pi)
"""Largest over mean speed of a modified sine, c_v."""

ROUNDING = 1e-12
"""Relative room in which a bound counts as met, and below which a run counts as none."""


def _some_way(value: float) -> float:
    if value == 0:
        raise refusal("way_zero")
    if abs(value) < LEAST:
        raise refusal("way_vanishing")
    return value


Way = Annotated[Number, Field(ge=-1e9, le=1e9), AfterValidator(_some_way)]


@dataclass(frozen=True, slots=True)
class Timing:
    """A symmetric move: two ramps of `ramp_s` with a run of `run_s` between, in units of way and seconds.

    `peak_speed` is reached at the end of the ramp, `peak_acceleration` in its middle. `is_cut` says that the speed
    asked for leaves no time to run, so that a triangle comes out that nobody asked for.
    """

    ramp_s: float
    run_s: float
    peak_speed: float
    peak_acceleration: float
    is_cut: bool = False

    @property
    def time_s(self) -> float:
        """Time of the whole move."""
        return 2 * self.ramp_s + self.run_s


class Move(Model):
    """Fields of every move. Its way, speed, acceleration and load have names of their own in each geometry."""

    WAY: ClassVar[str]
    SPEED: ClassVar[str]
    ACCELERATION: ClassVar[str]
    EXTERNAL: ClassVar[str]
    SPEED_UNIT: ClassVar[float]
    """Units of way per second in one unit of speed."""

    profile: Profile = Field(description="Course of the speed.", examples=["trapezoidal"])
    time_s: MoveTime | None = Field(None, description="Time of the move.", examples=[0.8])
    jerk_share: Share | None = Field(
        None,
        description="Share of a ramp of an S-curve in which jerk acts, half of it at either end; 0.5 by default.",
        examples=[0.5],
    )
    radial_N: Load | None = Field(
        None, description="Radial load on the gear’s shaft in this move; without it the cycle’s.", examples=[500.0]
    )
    axial_N: Load | None = Field(
        None, description="Axial load on the gear’s shaft in this move; without it the cycle’s.", examples=[200.0]
    )

    @property
    def way(self) -> float:
        """Angle or distance with its sign; 0 of a dwell."""
        return getattr(self, self.WAY) or 0.0

    @property
    def peak_speed(self) -> float:
        """Largest speed in units of way per second."""
        if self.profile == "modified_sine":
            return MODIFIED_SINE_SPEED * abs(self.way) / (self.time_s or 1.0)
        return self.timing.peak_speed if self.way else 0.0

    @property
    def external(self) -> float:
        """External torque or force."""
        return float(getattr(self, self.EXTERNAL))

    @property
    def ramp_mean(self) -> float:
        """Mean over peak acceleration of a ramp: 1 - share / 2."""
        share = DEFAULT_JERK_SHARE if self.jerk_share is None else self.jerk_share
        return 1 - share / 2 if self.profile == "s_curve" else 1.0

    @model_validator(mode="after")
    def _is_possible(self) -> Self:
        self._check_fields()
        if self.profile in ("trapezoidal", "triangular", "s_curve"):
            _ = self.timing
        return self

    def _check_fields(self) -> None:
        """Refuse fields that the profile has no use for, and the lack of one that it needs."""
        needed = {"dwell": ("time_s",), "modified_sine": (self.WAY, "time_s")}.get(self.profile, (self.WAY,))
        idle = {
            "dwell": (self.WAY, self.SPEED, self.ACCELERATION, "jerk_share"),
            "modified_sine": (self.SPEED, self.ACCELERATION, "jerk_share"),
            "s_curve": (),
        }.get(self.profile, ("jerk_share",))
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
        """Ramps and run of a trapezoid, triangle or S-curve; raises ValidationError where there are none."""
        names = ("time_s", self.SPEED, self.ACCELERATION)
        T, speed, a = (getattr(self, name) for name in names)
        given = [name for name, value in zip(names, (T, speed, a), strict=True) if value is not None]
        D, k = abs(self.way), self.ramp_mean
        V = None if speed is None else speed * self.SPEED_UNIT
        if self.profile == "triangular":
            if len(given) != 1:
                self._refuse_count("move_takes_one", names, given)
            return _triangle(D, T or (2 * D / V if V else 2 * math.sqrt(D / a)))
        if len(given) == 1 and T is not None:
            return _ramped(D, T, T / 3, k)
        if len(given) != 2:
            self._refuse_count("move_takes_two", names, given)
        if V is None:
            return self._by_time_and_acceleration(D, T, a, k)
        return self._by_time_and_speed(D, T, V, k) if T else _by_speed_and_acceleration(D, V, a, k)

    def _by_time_and_speed(self, D: float, T: float, V: float, k: float) -> Timing:
        if not D / T < V * (1 - ROUNDING):
            bound, triangle = D / T, 2 * D / T
            self._refuse(self.SPEED, "move_too_slow", bound=self._speed(bound), triangle=self._speed(triangle))
        return _ramped(D, T, min(T - D / V, T / 2), k)

    def _by_time_and_acceleration(self, D: float, T: float, a: float, k: float) -> Timing:
        least = 4 * D / T**2
        if k * a < least * (1 - ROUNDING):
            self._refuse(self.ACCELERATION, "move_too_gentle", bound=_said(least / k, self.ACCELERATION))
        above = 1 - least / (k * a)  # met exactly it is 0 but for rounding
        root = math.sqrt(above) if above > 8 * sys.float_info.epsilon else 0.0
        return _ramped(D, T, 2 * D / (k * a) / (T * (1 + root)), k)

    def _speed(self, value: float) -> str:
        return _said(value / self.SPEED_UNIT, self.SPEED)

    def _refuse(self, field: str, code: str, **values: str) -> NoReturn:
        raise refused(self, ((field,), refusal(code, **values)))

    def _refuse_count(self, code: str, names: Sequence[str], given: Sequence[str]) -> NoReturn:
        said = ", ".join(given) or "none"
        raise refused(self, ((), refusal(code, profile=self.profile, fields=", ".join(names), given=said)))


def _said(value: float, field: str) -> str:
    """A least value with its unit, rounded up, so that what is printed will do."""
    return str(Quantity(value, suffix_of(field) or "", 6, "up"))


def _ramped(D: float, T: float, ramp_s: float, k: float) -> Timing:
    """Way D in time T with ramps of a length; one that leaves next to no run is half the time."""
    run_s = T - 2 * ramp_s
    is_cut = run_s <= ROUNDING * T
    if is_cut:
        ramp_s, run_s = T / 2, 0.0
    V = D / (T - ramp_s)
    return Timing(ramp_s, run_s, V, V / (k * ramp_s), is_cut)


def _triangle(D: float, T: float) -> Timing:
    return Timing(T / 2, 0.0, 2 * D / T, 4 * D / T**2)


def _by_speed_and_acceleration(D: float, V: float, a: float, k: float) -> Timing:
    ramp_s = V / (k * a)
    run_s = D / V - ramp_s
    if run_s <= ROUNDING * ramp_s:  # the speed is not reached before the brake has to act
        ramp_s = math.sqrt(D / (k * a))
        return Timing(ramp_s, 0.0, D / ramp_s, D / (k * ramp_s**2), True)
    return Timing(ramp_s, run_s, V, a)


class Turn(Move):
    """A move of a rotary mechanism."""

    WAY, SPEED, ACCELERATION, EXTERNAL = "angle_deg", "speed_rpm", "acceleration_deg_per_s2", "external_torque_Nm"
    SPEED_UNIT = 6.0

    angle_deg: Way | None = Field(
        None, description="Angle with its direction; every move has one but a dwell.", examples=[90.0]
    )
    speed_rpm: Positive | None = Field(None, description="Peak speed of the mechanism.", examples=[25.0])
    acceleration_deg_per_s2: Positive | None = Field(
        None, description="Acceleration; of an S-curve its peak.", examples=[900.0]
    )
    external_torque_Nm: Torque = Field(
        0.0, description="External torque in this move; a positive one opposes positive motion.", examples=[30.0]
    )


class Stroke(Move):
    """A move of a rack, belt or screw."""

    WAY, SPEED, ACCELERATION, EXTERNAL = "distance_mm", "speed_mm_per_s", "acceleration_mm_per_s2", "external_force_N"
    SPEED_UNIT = 1.0

    distance_mm: Way | None = Field(
        None, description="Distance with its direction; every move has one but a dwell.", examples=[500.0]
    )
    speed_mm_per_s: Positive | None = Field(None, description="Peak speed of the mass.", examples=[500.0])
    acceleration_mm_per_s2: Positive | None = Field(
        None, description="Acceleration; of an S-curve its peak.", examples=[2500.0]
    )
    external_force_N: Load = Field(
        0.0, description="External force in this move; a positive one opposes positive motion.", examples=[200.0]
    )

"""The motor behind the gear: its figures at the shaft, and its torque over speed as points of a curve."""

from collections.abc import Sequence
from typing import Annotated, Any

from pydantic import AfterValidator, Field, ValidationInfo, field_validator
from pydantic_core import InitErrorDetails, PydanticCustomError, ValidationError

from hpn.application.phase import ROOM
from hpn.words.fields import Model, Positive, SpeedMagnitude, at_most
from hpn.words.titles import Name

LISTED_FIGURES = ("maximum_speed_rpm", "peak_torque_Nm", "rated_torque_Nm", "rated_speed_rpm", "inertia_kgm2")
"""Figures of a motor that motors.csv lists."""

FURTHER_FIGURES = ("stall_torque_Nm", "weight_kg", "curve")
"""Further figures of a motor in a list."""

LEAST_POINTS, MOST_POINTS = 2, 50
"""Least and largest number of points of a torque curve."""


class CurvePoint(Model):
    """A point of a motor's torque over speed: continuous and peak torque."""

    speed_rpm: SpeedMagnitude = Field(description="Motor speed; the first point is at 0.", examples=[3000.0])
    continuous_Nm: Positive = Field(
        description="Continuous torque (S1) at this speed, no larger than the peak torque.", examples=[2.4]
    )
    peak_Nm: Positive = Field(description="Peak torque at this speed.", examples=[7.2])


def _rises(points: tuple[CurvePoint, ...]) -> tuple[CurvePoint, ...]:
    """Points by rising speed from 0, none with a continuous torque above its peak; raises ValidationError for
    others.
    """
    faults: list[tuple[tuple[int, str], PydanticCustomError]] = []
    if points[0].speed_rpm != 0:
        faults.append(((0, "speed_rpm"), PydanticCustomError("curve_start", "must be 0 in the first point")))
    for place, point in enumerate(points):
        if place and point.speed_rpm <= points[place - 1].speed_rpm:
            error = PydanticCustomError("curve_order", "must be above the speed of the point before")
            faults.append(((place, "speed_rpm"), error))
        if point.continuous_Nm > point.peak_Nm * (1 + ROOM):
            error = PydanticCustomError("curve_peak", "must not be above the peak torque of its point")
            faults.append(((place, "continuous_Nm"), error))
    return _unless(faults, points)


def _unless(
    faults: Sequence[tuple[tuple[int, str], PydanticCustomError]], points: tuple[CurvePoint, ...]
) -> tuple[CurvePoint, ...]:
    if faults:
        details = [InitErrorDetails(type=error, loc=place, input=None) for place, error in faults]
        raise ValidationError.from_exception_data("curve", details)
    return points


POINTS: Any = Field(min_length=LEAST_POINTS, max_length=MOST_POINTS)


def _within_standstill(points: tuple[CurvePoint, ...], info: ValidationInfo) -> tuple[CurvePoint, ...]:
    """Points, none with a continuous torque above the motor's at standstill; raises ValidationError for others."""
    stall_torque_Nm = info.data.get("stall_torque_Nm")
    if stall_torque_Nm is None:
        return points
    error = PydanticCustomError("curve_stall", "must not be above stall_torque_Nm")
    above = [k for k, point in enumerate(points) if point.continuous_Nm > stall_torque_Nm * (1 + ROOM)]
    return _unless([((place, "continuous_Nm"), error) for place in above], points)


Curve = Annotated[
    tuple[CurvePoint, ...], POINTS, at_most(MOST_POINTS), AfterValidator(_rises), AfterValidator(_within_standstill)
]
"""Torque over speed, a straight line between its points."""


STALL_TORQUE: Any = Field(None, description="Continuous torque at standstill, M₀.", examples=[2.8])
CURVE: Any = Field(
    None,
    description="Torque over speed, 2 to 50 points by rising speed from 0: peak torque and thermal load are judged "
    "along it, in place of rated torque and rated speed.",
    examples=[
        [
            {"speed_rpm": 0.0, "continuous_Nm": 2.8, "peak_Nm": 7.2},
            {"speed_rpm": 6000.0, "continuous_Nm": 1.9, "peak_Nm": 4.5},
        ]
    ],
)


class Motor(Model):
    """Ratings and inertia of the motor, at its shaft."""

    maximum_speed_rpm: Positive | None = Field(None, description="Maximum motor speed.", examples=[4000.0])
    peak_torque_Nm: Positive | None = Field(None, description="Peak motor torque.", examples=[20.0])
    rated_torque_Nm: Positive | None = Field(None, description="Continuous motor torque.", examples=[8.0])
    rated_speed_rpm: Positive | None = Field(
        None, description="Rated motor speed, the limit of the average speed.", examples=[3000.0]
    )
    inertia_kgm2: Positive | None = Field(
        None,
        description="Moment of inertia of the motor’s rotor; with a motion it counts in the torques.",
        examples=[0.00015],
    )
    inertia_ratio: Positive | None = Field(
        None, description="Largest permitted ratio of the load’s inertia to i² times the motor’s.", examples=[5.0]
    )
    stall_torque_Nm: Positive | None = STALL_TORQUE
    weight_kg: Positive | None = Field(None, description="Weight of the motor; not judged.", examples=[2.1])
    curve: Curve | None = CURVE
    name: Name | None = Field(None, description="Your name for the motor; without effect.", examples=["M 40"])
    designation: Annotated[str, Field(min_length=1, max_length=100)] | None = Field(
        None, description="Designation of a motor in your motors.csv, in place of its figures.", examples=["M 40"]
    )

    @property
    def largest_torque_Nm(self) -> float | None:
        """Peak torque in Nm, else the largest of the curve, else None."""
        of_curve = max(point.peak_Nm for point in self.curve) if self.curve else None
        return of_curve if self.peak_torque_Nm is None else self.peak_torque_Nm

    @property
    def top_speed_rpm(self) -> float | None:
        """Maximum speed in rpm, or the last of the curve if smaller; None without either."""
        last = self.curve[-1].speed_rpm if self.curve else None
        return min((n for n in (self.maximum_speed_rpm, last) if n is not None), default=None)

    @field_validator("designation")
    @classmethod
    def _stands_alone(cls, designation: str | None, info: ValidationInfo) -> str | None:
        figures = (*LISTED_FIGURES, *FURTHER_FIGURES)
        if designation is not None and any(info.data.get(name) is not None for name in figures):
            raise PydanticCustomError(
                "motor_twice", "selects a motor of motors.csv: give either the motor or its figures, not both"
            )
        return designation

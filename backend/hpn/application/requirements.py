"""Requirements on a gear: the load on its output bearing, the limits of the motor, and all others."""

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator, model_validator
from pydantic_core import PydanticCustomError

from hpn.application.shaft_centre import ShaftCentre
from hpn.words.designations import canonical_size
from hpn.words.fields import (
    Hours,
    Load,
    Model,
    Number,
    Positive,
    Ratio,
    Share,
    TorqueMagnitude,
    at_most,
    one_of,
    refused,
)

BearingModel = Literal["linear", "iso281", "digitised"]
LifeBasis = Literal["L50", "L10"]
PositionErrorAt = Literal["cycle", "rest"]
MOST_WISHES = 100
"""Ratios or sizes that may be asked for."""

WISHES: Any = Field(min_length=1, max_length=MOST_WISHES)
"""Bounds of the list itself: beside the field they would be taken for those of a text, since it may be null."""

Size = Annotated[str, Field(max_length=20), BeforeValidator(canonical_size)]


BEARING_LIFE_H = 20_000.0
"""Life for which an output bearing is judged where none is asked of it, as L50."""


class Drive(Model):
    """Pinion or pulley on the gear's shaft, whose load follows from the torques of typed phases."""

    type: Literal["rack_and_pinion", "belt"] = Field(
        description="Pinion of a rack, or pulley of a belt.", examples=["belt"]
    )
    diameter_mm: Positive = Field(description="Pitch diameter of the pinion or pulley.", examples=[60.0])


class OutputLoad(Model):
    """Load on the output shaft: where no position is given, at the centre of the shaft and along its axis."""

    radial_N: Load | None = Field(None, description="Radial load of the whole cycle.", examples=[500.0])
    axial_N: Load | None = Field(None, description="Axial load of the whole cycle.", examples=[200.0])
    load_coefficient: Annotated[Number, Field(ge=1, le=3)] = Field(
        1.0, description="Load coefficient f_w multiplies the load; printed curves: 1, 1.2, 1.5.", examples=[1.2]
    )
    life_h: Hours = Field(BEARING_LIFE_H, description="Required life of the output bearing.", examples=[20000.0])
    life_basis: LifeBasis = Field("L50", description="L50: 50 % of the bearings survive it. L10: 90 % do.")
    model: BearingModel = Field("linear", description="How the envelope runs between the two published limits.")
    radial_position_mm: Annotated[Number, Field(ge=-1e6, le=1e6)] | None = Field(
        None,
        description="Where the radial load acts, x from the shaft’s shoulder, outwards positive; by default at the "
        "shaft’s centre.",
        examples=[45.0],
    )
    axial_radius_mm: Annotated[Number, Field(ge=0, le=1e6)] = Field(
        0.0, description="Distance y of the axial load from the shaft’s axis.", examples=[40.0]
    )
    shaft_centre_mm: ShaftCentre | None = Field(
        None,
        description="Distance x_c from the shoulder to the shaft’s centre, at least; for sizes without one in the "
        "catalogue. One for all, or an object by size, in which others is for the rest.",
        examples=[21.0, {"20A": 21.0, "others": 18.0}],
        json_schema_extra=one_of,
    )
    from_motion: Annotated[bool, Field(strict=True)] = Field(
        False,
        description="True: the motion’s pinion or pulley sits on the gear’s shaft, and its load is added to the typed "
        "ones.",
        examples=[False],
    )
    rack_helix_deg: Annotated[Number, Field(ge=0, le=45)] = Field(
        0.0, description="Helix angle β of a rack’s teeth.", examples=[0.0]
    )
    belt_tension_factor: Annotated[Number, Field(ge=1, le=5)] = Field(
        2.0,
        description="Radial load of a belt over its largest tangential force, from its pretension: acts always.",
        examples=[2.0],
    )
    drive: Drive | None = Field(
        None,
        description="Pinion or pulley on the gear’s shaft, for typed phases.",
        examples=[{"type": "belt", "diameter_mm": 60.0}],
    )


LISTED_FIGURES = ("maximum_speed_rpm", "peak_torque_Nm", "rated_torque_Nm", "rated_speed_rpm", "inertia_kgm2")
"""Figures of a motor that motors.csv lists."""


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
        None, description="Largest permitted load inertia over i² times the motor’s.", examples=[5.0]
    )
    designation: Annotated[str, Field(min_length=1, max_length=100)] | None = Field(
        None, description="A motor of your motors.csv, in place of its figures.", examples=["M 40"]
    )

    @field_validator("designation")
    @classmethod
    def _stands_alone(cls, designation: str | None, info: ValidationInfo) -> str | None:
        if designation is not None and any(info.data.get(name) is not None for name in LISTED_FIGURES):
            raise PydanticCustomError(
                "motor_twice", "selects a motor of motors.csv: give either the motor or its figures, not both"
            )
        return designation


class Requirements(Model):
    """`ratios` and `sizes` restrict the list of candidates; every other requirement becomes a check."""

    ratios: Annotated[tuple[Ratio, ...], WISHES, at_most(MOST_WISHES)] | None = Field(
        None, description="Only these ratios.", examples=[[5]]
    )
    sizes: Annotated[tuple[Size, ...], WISHES, at_most(MOST_WISHES)] | None = Field(
        None, description="Only these sizes.", examples=[["14A", "20A"]]
    )
    life_h: Hours | None = Field(None, description="Required gear life L10 (eq. 17.10).", examples=[20000.0])
    backlash_arcmin: Positive | None = Field(None, description="Maximum backlash.", examples=[7.0])
    torsional_stiffness_Nm_per_rad: Positive | None = Field(
        None, description="Minimum torsional stiffness K_3.", examples=[5000.0]
    )
    weight_kg: Positive | None = Field(None, description="Maximum weight.", examples=[5.0])
    length_mm: Positive | None = Field(None, description="Maximum length L.", examples=[200.0])
    ambient_temperature_degC: Annotated[Number, Field(ge=-273.15, le=1000)] | None = Field(
        None, description="Ambient temperature of the gear.", examples=[25.0]
    )
    utilisation: Share = Field(
        1.0, description="Maximum utilisation u of the load checks: your own reserve.", examples=[1.0]
    )
    worst_case_utilisation: Share | None = Field(
        None,
        description="Maximum utilisation of the load checks in the worst case of the tolerances; by default u.",
        examples=[1.0],
    )
    over_tolerance: Annotated[bool, Field(strict=True)] = Field(
        False, description="True: the worst case of the tolerances judges and ranks the gears.", examples=[False]
    )
    efficiency: Share | None = Field(
        None, description="Your assumption for the gear’s efficiency; without it the motor side is loss-free."
    )
    motor: Motor | None = Field(None, description="Limits of the motor.")
    load_inertia_kgm2: Positive | None = Field(
        None, description="Moment of inertia of the load at the gear’s output; a motion has its own.", examples=[0.8]
    )
    natural_frequency_Hz: Positive | None = Field(
        None, description="Minimum natural frequency of the load on the gear, the motor held.", examples=[25.0]
    )
    position_error_arcmin: Positive | None = Field(
        None, description="Maximum position error of the output as an angle.", examples=[20.0]
    )
    position_error_mm: Positive | None = Field(
        None, description="Maximum position error as a length at the radius.", examples=[0.5]
    )
    position_radius_mm: Positive | None = Field(
        None, description="Radius at which the position error is shown as a length.", examples=[250.0]
    )
    position_error_at: PositionErrorAt = Field(
        "cycle",
        description="cycle: position error over the whole cycle. rest: only in phases with speed 0 and in the pause.",
        examples=["cycle"],
    )
    rest_friction_Nm: TorqueMagnitude = Field(
        0.0,
        description="Torque at the gear by which dry friction may hold the axis in phases with speed 0 and in the "
        "pause; a motion has its mechanism’s.",
        examples=[6.0],
    )
    load_reverses: Annotated[bool, Field(strict=True)] | None = Field(
        None,
        description="True: the torque acts both ways. False: the signs of the torques hold as given, and where none is "
        "negative no torque reverses. Without it, both ways where no torque is negative and there is no motion.",
        examples=[False],
    )

    @model_validator(mode="after")
    def _asks_for_one_error(self) -> Self:
        if self.position_error_mm is not None and self.position_error_arcmin is not None:
            problem = PydanticCustomError("error_twice", "give the position error as an angle or as a length, not both")
            raise refused(self, (("position_error_mm",), problem))
        if self.position_error_mm is not None and self.position_radius_mm is None:
            problem = PydanticCustomError("error_radius", "needs the radius, position_radius_mm")
            raise refused(self, (("position_error_mm",), problem))
        return self

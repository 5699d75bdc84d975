"""Requirements on a gear: the load on its output bearing, and all other requirements except those of the motor."""

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from hpn.application.motor import Motor
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
"""Ratios or sizes, at most, in a request."""

WISHES: Any = Field(min_length=1, max_length=MOST_WISHES)
"""Bounds of the list itself: on the nullable field they would be taken for bounds of a text."""

Size = Annotated[str, Field(max_length=20), BeforeValidator(canonical_size)]


BEARING_LIFE_H = 20_000.0
"""Life in h, as L50, for an output bearing without a required one."""


class Drive(Model):
    """Pinion or pulley on the gear's shaft, whose load follows from the torques of typed phases."""

    type: Literal["rack_and_pinion", "belt"] = Field(
        description="Pinion of a rack, or pulley of a belt.", examples=["belt"]
    )
    diameter_mm: Positive = Field(description="Pitch diameter of the pinion or pulley.", examples=[60.0])


class OutputLoad(Model):
    """Load on the output shaft; without a position, at the centre of the shaft and along its axis."""

    radial_N: Load | None = Field(None, description="Radial load of the whole cycle.", examples=[500.0])
    axial_N: Load | None = Field(None, description="Axial load of the whole cycle.", examples=[200.0])
    load_coefficient: Annotated[Number, Field(ge=1, le=3)] = Field(
        1.0, description="Load coefficient f_w multiplies the load; printed curves: 1, 1.2, 1.5.", examples=[1.2]
    )
    life_h: Hours = Field(BEARING_LIFE_H, description="Required life of the output bearing.", examples=[20000.0])
    life_basis: LifeBasis = Field("L50", description="L50: 50 % of the bearings survive it. L10: 90 % do.")
    model: BearingModel = Field("linear", description="Model of the envelope between the two published limits.")
    radial_position_mm: Annotated[Number, Field(ge=-1e6, le=1e6)] | None = Field(
        None,
        description="Position x of the radial load from the shaft’s shoulder, outwards positive; by default the "
        "shaft’s centre.",
        examples=[45.0],
    )
    axial_radius_mm: Annotated[Number, Field(ge=0, le=1e6)] = Field(
        0.0, description="Distance y of the axial load from the shaft’s axis.", examples=[40.0]
    )
    shaft_centre_mm: ShaftCentre | None = Field(
        None,
        description="Smallest distance x_c from the shoulder to the shaft’s centre, for sizes without one in the "
        "catalogue: one number for all sizes, or an object by size, with others for the rest.",
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

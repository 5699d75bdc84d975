"""Mechanisms between gear and load, and their equivalent load on a turning shaft."""

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from hpn.physics.equations import ROUNDING, FloatArray
from hpn.physics.motion.refusals import refusal
from hpn.words.fields import Load, Model, Number, Positive, Share, TorqueMagnitude, refused
from hpn.words.wording import Quantity

GRAVITY = 9.80665
"""Standard acceleration of gravity in m/s²."""

RPM = 2 * math.pi / 60
"""One rpm in rad/s."""


def cosine(angle_deg: float) -> float:
    """Cosine of an angle in degrees; exact at multiples of 90."""
    reduced = math.fmod(abs(angle_deg), 360.0)
    if reduced in (90.0, 270.0):
        return 0.0
    return math.cos(math.radians(reduced))


def sine(angle_deg: float) -> float:
    """Sine of an angle in degrees; exact at multiples of 90."""
    reduced = math.fmod(angle_deg, 360.0)
    if reduced in (0.0, 180.0, -180.0):
        return 0.0
    return math.sin(math.radians(reduced))


def balance(*terms: float) -> float:
    """Sum of forces or torques; 0 if below ROUNDING of the largest, as for a weight and its counterweight."""
    total_Nm = math.fsum(terms)
    return total_Nm if abs(total_Nm) >= ROUNDING * max(map(abs, terms)) else 0.0


@dataclass(frozen=True, slots=True)
class ShaftLoad:
    """Load on the mechanism's shaft: T_load = J α + T_f sgn ω + b ω + G cos θ + T_0, in Nm, rad and s.

    `friction_Nm` is all dry friction, `way_per_rad` the way in degrees or mm per radian, `external_Nm` the torque of an
    external torque of 1 Nm or force of 1 N, `own_inertia_kgm2` and `own_friction_Nm` inertia and friction of the
    pinion, pulley or screw itself. At the gear T = T_load / (η ratio) where the load is driven, T_load η / ratio where
    it drives.
    """

    inertia_kgm2: float
    friction_Nm: float
    viscous_Nms: float
    gravity_Nm: float
    constant_Nm: float
    way_per_rad: float
    external_Nm: float
    efficiency: float
    ratio: float
    own_inertia_kgm2: float = 0.0
    own_friction_Nm: float = 0.0

    @property
    def weight_Nm(self) -> float:
        """Largest torque of gravity in Nm, over a full turn or in both directions."""
        return max(self.gravity_Nm, abs(self.constant_Nm))

    def rest_friction_Nm(self, torque_Nm: FloatArray | float) -> FloatArray:
        """Torque R in Nm at the gear that dry friction adds to or takes from a torque at rest; takes the gear's torque.

        R = ((|T_load| + T_s) / η - |T_load|) / ratio with all dry friction T_s: the torque that sets the axis in
        motion, less the torque that holds it without friction.
        """
        at_rest = np.abs(torque_Nm)
        friction: FloatArray = at_rest * (1 / self.efficiency - 1) + self.friction_Nm / (self.efficiency * self.ratio)
        return friction

    @property
    def way_at_gear_m(self) -> float:
        """Way of a linear load in m per radian of the gear."""
        return self.way_per_rad / (1000 * self.ratio)


class Mechanism(Model):
    """Fields of every mechanism."""

    friction_torque_Nm: TorqueMagnitude = Field(
        0.0,
        description="Friction torque T_f about the mechanism’s shaft (pinion, pulley or screw), against the motion.",
        examples=[1.5],
    )
    efficiency: Share = Field(1.0, description="Efficiency of the mechanism.", examples=[0.9])
    ratio: Positive = Field(
        1.0,
        description="Stage between gear and mechanism: turns of the gear per turn of the mechanism. Its inertia is not "
        "counted.",
        examples=[1.0],
    )

    @property
    @abstractmethod
    def load(self) -> ShaftLoad:
        """The load on its shaft."""


class Rotary(Mechanism):
    """A mass that turns about the mechanism's shaft; T_load = J α + T_f sgn ω + b n + m g r cos θ + T_ext."""

    type: Literal["rotary"] = Field(description="Kind of mechanism.", examples=["rotary"])
    inertia_kgm2: Positive = Field(
        description="Moment of inertia J about the shaft; it includes m r² of the gravity mass.", examples=[0.8]
    )
    gravity_mass_kg: Positive | None = Field(
        None, description="Mass m whose centre of gravity lies off the shaft.", examples=[12.0]
    )
    gravity_radius_mm: Positive | None = Field(
        None, description="Distance r of its centre of gravity from the shaft.", examples=[250.0]
    )
    viscous_friction_Nm_per_rpm: Annotated[Number, Field(ge=0, le=1e6)] = Field(
        0.0, description="Viscous friction b per speed of the mechanism.", examples=[0.01]
    )

    @model_validator(mode="after")
    def _gravity_is_whole(self) -> Self:
        names = [name for name in ("gravity_mass_kg", "gravity_radius_mm") if getattr(self, name) is not None]
        if len(names) == 1:
            other = "gravity_radius_mm" if names == ["gravity_mass_kg"] else "gravity_mass_kg"
            raise refused(self, ((names[0],), refusal("gravity_needs", field=other)))
        least = (self.gravity_mass_kg or 0.0) * ((self.gravity_radius_mm or 0.0) / 1000) ** 2
        if self.inertia_kgm2 < least * (1 - ROUNDING):
            bound = Quantity(least, "kgm2", 6, "up")
            raise refused(self, (("inertia_kgm2",), refusal("gravity_inertia", bound=bound)))
        return self

    @property
    def load(self) -> ShaftLoad:
        """The load on its shaft."""
        mass, radius = self.gravity_mass_kg or 0.0, (self.gravity_radius_mm or 0.0) / 1000
        return ShaftLoad(
            inertia_kgm2=self.inertia_kgm2,
            friction_Nm=self.friction_torque_Nm,
            viscous_Nms=self.viscous_friction_Nm_per_rpm / RPM,
            gravity_Nm=mass * GRAVITY * radius,
            constant_Nm=0.0,
            way_per_rad=math.degrees(1.0),
            external_Nm=1.0,
            efficiency=self.efficiency,
            ratio=self.ratio,
        )


class Linear(Mechanism):
    """A mass that moves along a line, its counterweight m_c with it.

    T_load = ((m + m_c) a + m g (sin β + μ cos β sgn v) - m_c g sgn β + F_f sgn v + F_ext) ρ + J a / ρ + T_f sgn v.
    """

    mass_kg: Positive = Field(description="Moved mass m.", examples=[80.0])
    incline_deg: Annotated[Number, Field(ge=-90, le=90)] = Field(
        0.0, description="Incline β; positive motion raises the mass where it is positive.", examples=[30.0]
    )
    friction_coefficient: Annotated[Number, Field(ge=0, le=1e3)] = Field(
        0.0, description="Coefficient of friction μ of the guide.", examples=[0.05]
    )
    friction_force_N: Annotated[Load, Field(ge=0)] = Field(
        0.0,
        description="Friction force F_f that no weight causes (seals, wipers, pressed gibs), against the motion.",
        examples=[24.5],
    )
    counterweight_kg: Annotated[Number, Field(ge=0, le=1e12)] = Field(
        0.0,
        description="Counterweight m_c, which hangs vertically and moves with the mass; its weight acts against the "
        "mass’s. Only with an incline.",
        examples=[60.0],
    )
    inertia_kgm2: Annotated[Number, Field(ge=0, le=1e12)] = Field(
        0.0, description="Moment of inertia J of everything that turns with pinion, pulley or screw.", examples=[0.002]
    )

    @model_validator(mode="after")
    def _counterweight_hangs(self) -> Self:
        if self.counterweight_kg and not self.incline_deg:
            raise refused(self, (("counterweight_kg",), refusal("counterweight_level")))
        return self

    @property
    @abstractmethod
    def radius_mm(self) -> float:
        """Way per radian ρ."""

    @property
    def has_idle_coefficient(self) -> bool:
        """True where no weight rests on the guide, so that a given coefficient of friction has no effect."""
        return bool(self.friction_coefficient) and not cosine(self.incline_deg)

    @property
    def load(self) -> ShaftLoad:
        """The load on its shaft."""
        radius = self.radius_mm / 1000
        weight_Nm = self.mass_kg * GRAVITY * radius
        hanging_Nm = math.copysign(self.counterweight_kg * GRAVITY * radius, self.incline_deg)
        rubbing_Nm = weight_Nm * self.friction_coefficient * cosine(self.incline_deg)
        return ShaftLoad(
            inertia_kgm2=(self.mass_kg + self.counterweight_kg) * radius**2 + self.inertia_kgm2,
            friction_Nm=rubbing_Nm + self.friction_force_N * radius + self.friction_torque_Nm,
            viscous_Nms=0.0,
            gravity_Nm=0.0,
            constant_Nm=balance(weight_Nm * sine(self.incline_deg), -hanging_Nm),
            way_per_rad=self.radius_mm,
            external_Nm=radius,
            efficiency=self.efficiency,
            ratio=self.ratio,
            own_inertia_kgm2=self.inertia_kgm2,
            own_friction_Nm=self.friction_torque_Nm,
        )


class _Wheel(Linear):
    diameter_mm: Positive = Field(description="Pitch diameter of the pinion or pulley.", examples=[60.0])

    @property
    def radius_mm(self) -> float:
        """Half the diameter."""
        return self.diameter_mm / 2


class RackAndPinion(_Wheel):
    """A pinion on a rack."""

    type: Literal["rack_and_pinion"] = Field(description="Kind of mechanism.", examples=["rack_and_pinion"])


class Belt(_Wheel):
    """A belt over a pulley."""

    type: Literal["belt"] = Field(description="Kind of mechanism.", examples=["belt"])


class BallScrew(Linear):
    """A ball screw."""

    type: Literal["ball_screw"] = Field(description="Kind of mechanism.", examples=["ball_screw"])
    lead_mm: Positive = Field(description="Lead of the screw: travel per turn.", examples=[10.0])

    @property
    def radius_mm(self) -> float:
        """Lead over 2 π."""
        return self.lead_mm / (2 * math.pi)


LinearMechanism = RackAndPinion | Belt | BallScrew
TYPES: tuple[str, ...] = ("rotary", "rack_and_pinion", "belt", "ball_screw")
CLASSES: dict[str, type[RackAndPinion] | type[Belt] | type[BallScrew]] = {
    "rack_and_pinion": RackAndPinion,
    "belt": Belt,
    "ball_screw": BallScrew,
}

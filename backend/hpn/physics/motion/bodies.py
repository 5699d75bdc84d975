"""Moments of inertia from dimensions: bodies of uniform density about an axis, each at a distance from it.

F. P. Beer, E. R. Johnston et al., Vector Mechanics for Engineers: Dynamics, appendix on mass moments of inertia.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import fsum, pi
from typing import Annotated, Literal, Self, TypeVar

from pydantic import Field, model_validator

from hpn.physics.equations import FloatArray
from hpn.physics.motion.refusals import refusal
from hpn.words.fields import WHOLE, Model, Number, Positive, refused

Shape = Literal["disc", "ring", "bar", "block", "point_mass"]
Value = TypeVar("Value", float, FloatArray)

MOST_BODIES = 50

# --- Equations --------------------------------------------------------------------------------------------------------


def ring_inertia(*, mass_kg: Value, diameter_mm: Value, inner_diameter_mm: Value) -> Value:
    """Moment of inertia m (d² + d_i²) / 8 in kg m² of a ring about its own axis; of a disc where d_i = 0."""
    return mass_kg * (diameter_mm**2 + inner_diameter_mm**2) / 8e6


def bar_inertia(*, mass_kg: Value, length_mm: Value, diameter_mm: Value) -> Value:
    """Moment of inertia m (l² / 12 + d² / 16) in kg m² of a round bar about an axis across its middle."""
    return mass_kg * (length_mm**2 / 12e6 + diameter_mm**2 / 16e6)


def block_inertia(*, mass_kg: Value, length_mm: Value, width_mm: Value) -> Value:
    """Moment of inertia m (l² + w²) / 12 in kg m² of a block about the axis through its middle along its height."""
    return mass_kg * (length_mm**2 + width_mm**2) / 12e6


def displaced_inertia(*, inertia_kgm2: Value, mass_kg: Value, distance_mm: Value) -> Value:
    """Moment of inertia J + m e² about an axis parallel to the body's own, by the parallel axis theorem."""
    return inertia_kgm2 + mass_kg * distance_mm**2 / 1e6


def ring_mass(*, density_g_per_cm3: Value, diameter_mm: Value, inner_diameter_mm: Value, height_mm: Value) -> Value:
    """Mass ρ π (d² - d_i²) h / 4 in kg of a ring; of a disc or a round bar where d_i = 0."""
    return density_g_per_cm3 * pi / 4e6 * (diameter_mm**2 - inner_diameter_mm**2) * height_mm


def block_mass(*, density_g_per_cm3: Value, length_mm: Value, width_mm: Value, height_mm: Value) -> Value:
    """Mass ρ l w h in kg of a block."""
    return density_g_per_cm3 * length_mm * width_mm * height_mm / 1e6


# --- Bodies -----------------------------------------------------------------------------------------------------------

DIMENSIONS: Mapping[str, tuple[str, ...]] = {
    "disc": ("diameter_mm",),
    "ring": ("diameter_mm", "inner_diameter_mm"),
    "bar": ("length_mm",),
    "block": ("length_mm", "width_mm"),
    "point_mass": (),
}
"""Dimensions that the inertia of a shape needs."""

OF_MASS: Mapping[str, str] = {"disc": "height_mm", "ring": "height_mm", "bar": "diameter_mm", "block": "height_mm"}
"""Further dimension of a shape whose mass follows from its density."""

_ALL = ("diameter_mm", "inner_diameter_mm", "length_mm", "width_mm", "height_mm")


class Body(Model):
    """Equal bodies about one axis: their shape, the mass or density of each, and how far from the axis they lie."""

    shape: Shape = Field(description="Shape; the axis runs along disc, ring and height of a block, and across a bar.")
    count: Annotated[int, Field(strict=True, ge=1, le=10_000), WHOLE] = Field(1, description="How many there are.")
    mass_kg: Positive | None = Field(None, description="Mass of one.")
    density_g_per_cm3: Positive | None = Field(None, description="Density, in place of the mass.")
    diameter_mm: Positive | None = Field(None, description="Outer diameter.")
    inner_diameter_mm: Positive | None = Field(None, description="Inner diameter.")
    length_mm: Positive | None = Field(None, description="Length.")
    width_mm: Positive | None = Field(None, description="Width.")
    height_mm: Positive | None = Field(None, description="Height along the axis.")
    distance_mm: Annotated[Number, Field(ge=0, le=1e9)] = Field(
        0.0, description="Distance of its centre of gravity from the axis."
    )

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        shape, by_density = self.shape, self.density_g_per_cm3 is not None
        needed = (*DIMENSIONS[shape], *([OF_MASS[shape]] if by_density and shape in OF_MASS else []))
        had = {*DIMENSIONS[shape], OF_MASS.get(shape)}
        problems = [((name,), refusal("body_needs", field=name)) for name in needed if getattr(self, name) is None] + [
            ((name,), refusal("body_has_no", field=name))
            for name in _ALL
            if name not in had and getattr(self, name) is not None
        ]
        if shape == "point_mass" and by_density:
            problems.append((("density_g_per_cm3",), refusal("body_has_no", field="density_g_per_cm3")))
        elif by_density == (self.mass_kg is not None):
            problems.append((("mass_kg",), refusal("body_mass")))
        if self.inner_diameter_mm and self.diameter_mm and self.inner_diameter_mm >= self.diameter_mm:
            problems.append((("inner_diameter_mm",), refusal("body_bore")))
        if problems:
            raise refused(self, *problems)
        return self

    @property
    def total_mass_kg(self) -> float:
        """Mass of all of them."""
        return self.count * (self._mass_by_density if self.mass_kg is None else self.mass_kg)

    @property
    def inertia_kgm2(self) -> float:
        """Moment of inertia of all of them about the axis."""
        mass = self.total_mass_kg
        own = self._own_inertia(mass)
        return displaced_inertia(inertia_kgm2=own, mass_kg=mass, distance_mm=self.distance_mm)

    @property
    def _mass_by_density(self) -> float:
        density, height = self.density_g_per_cm3 or 0.0, self.height_mm or 0.0
        if self.shape == "block":
            sides = {"length_mm": self.length_mm or 0.0, "width_mm": self.width_mm or 0.0, "height_mm": height}
            return block_mass(density_g_per_cm3=density, **sides)
        return ring_mass(
            density_g_per_cm3=density,
            diameter_mm=self.diameter_mm or 0.0,
            inner_diameter_mm=self.inner_diameter_mm or 0.0,
            height_mm=self.length_mm or 0.0 if self.shape == "bar" else height,
        )

    def _own_inertia(self, mass_kg: float) -> float:
        """Moment of inertia in kg m² about the axis through its own middle."""
        d, d_i = self.diameter_mm or 0.0, self.inner_diameter_mm or 0.0
        if self.shape == "bar":
            return bar_inertia(mass_kg=mass_kg, length_mm=self.length_mm or 0.0, diameter_mm=d)
        if self.shape == "block":
            return block_inertia(mass_kg=mass_kg, length_mm=self.length_mm or 0.0, width_mm=self.width_mm or 0.0)
        return ring_inertia(mass_kg=mass_kg, diameter_mm=d, inner_diameter_mm=d_i)


@dataclass(frozen=True, slots=True)
class BodySum:
    """Sum of bodies: moment of inertia and mass, and the bodies off the axis as one mass at its mean distance.

    The distance is None if none lies off the axis. All count on one side, the worst case for gravity.
    """

    inertia_kgm2: float
    mass_kg: float
    gravity_mass_kg: float
    gravity_radius_mm: float | None


def sum_of(bodies: Sequence[Body]) -> BodySum:
    """Sum of bodies about one axis."""
    off = [body for body in bodies if body.distance_mm]
    mass = fsum(body.total_mass_kg for body in off)
    moment = fsum(body.total_mass_kg * body.distance_mm for body in off)
    return BodySum(
        inertia_kgm2=fsum(body.inertia_kgm2 for body in bodies),
        mass_kg=fsum(body.total_mass_kg for body in bodies),
        gravity_mass_kg=mass,
        gravity_radius_mm=moment / mass if mass else None,
    )

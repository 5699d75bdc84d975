"""A gear of the series with every published figure and its source; and columns of gears."""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from hpn.physics.equations import FloatArray
from hpn.words.quantities import BOLT, GEAR
from hpn.words.reply import described
from hpn.words.source import is_supplied


@dataclass(frozen=True, slots=True)
class ClampBolt:
    """Bolt of the motor coupling (table 26.2); its size depends on the coupling."""

    __pydantic_config__ = described(BOLT)

    bolt_size: str
    tightening_torque_Nm: float | None
    source: str


@dataclass(frozen=True, slots=True)
class HousingBolts:
    """Bolts of the housing flange (table 27.1)."""

    __pydantic_config__ = described(BOLT)

    number_of_bolts: int | None
    bolt_size: str | None
    pitch_diameter_mm: float | None
    tightening_torque_Nm: float | None
    source: str


def _published(file: str, *, signed: bool = False) -> Any:
    """Field of a figure with the catalogue's file that has a column of its name; positive unless signed."""
    return field(default=None, metadata={"file": file, "signed": signed})


def _supplied(file: str) -> Any:
    """Field of a figure that the handbook does not publish: an optional column for the user's own figures."""
    return field(default=None, metadata={"file": file, "signed": False, "optional": True})


@dataclass(frozen=True, slots=True)
class Gear:
    """A size and ratio. A figure that is not published is null, never zero."""

    __pydantic_config__ = described(GEAR) | {"json_schema_serialization_defaults_required": True}

    designation: str
    size: str
    ratio: int
    stages: int
    repeated_peak_torque_Nm: float | None = _published("ratings.csv")
    rated_torque_Nm: float | None = _published("ratings.csv")
    momentary_peak_torque_Nm: float | None = _published("ratings.csv")
    maximum_input_speed_rpm: float | None = _published("sizes.csv")
    average_input_speed_rpm: float | None = _published("sizes.csv")
    ambient_temperature_minimum_degC: float | None = _published("sizes.csv", signed=True)
    ambient_temperature_maximum_degC: float | None = _published("sizes.csv", signed=True)
    weight_kg: float | None = _published("weights.csv")
    backlash_arcmin: float | None = _published("accuracy.csv")
    transmission_accuracy_arcmin: float | None = _published("accuracy.csv")
    torsional_stiffness_Nm_per_rad: float | None = _published("stiffness.csv")
    length_min_mm: float | None = _published("lengths.csv")
    length_max_mm: float | None = _published("lengths.csv")
    dynamic_radial_load_N: float | None = _published("sizes.csv")
    dynamic_axial_load_N: float | None = _published("sizes.csv")
    shaft_centre_mm: float | None = _supplied("sizes.csv")
    inertia_kgm2: float | None = _supplied("gears.csv")
    no_load_torque_Nm: float | None = _supplied("gears.csv")
    clamp_bolts: tuple[ClampBolt, ...] = ()
    housing_bolts: HousingBolts | None = None
    note: str | None = None
    sources: dict[str, str] = field(default_factory=dict, hash=False)

    @classmethod
    def unpublished(cls) -> frozenset[str]:
        """Figures that the handbook gives for no gear, but a supplement may."""
        return frozenset(each.name for each in fields(cls) if each.metadata.get("optional"))

    @property
    def name(self) -> str:
        """Size as in the headings of the handbook's tables: `HPN-20A`."""
        return f"HPN-{self.size}"

    def is_supplied(self, figure: str) -> bool:
        """True for a figure from the user's supplement."""
        return is_supplied(self.sources.get(figure, ""))


class GearColumns:
    """Figures of some gears as arrays, shape (gears,); NaN if not published."""

    ratio: FloatArray
    repeated_peak_torque_Nm: FloatArray
    rated_torque_Nm: FloatArray
    momentary_peak_torque_Nm: FloatArray
    maximum_input_speed_rpm: FloatArray
    average_input_speed_rpm: FloatArray
    ambient_temperature_minimum_degC: FloatArray
    ambient_temperature_maximum_degC: FloatArray
    weight_kg: FloatArray
    backlash_arcmin: FloatArray
    torsional_stiffness_Nm_per_rad: FloatArray
    length_min_mm: FloatArray
    length_max_mm: FloatArray
    dynamic_radial_load_N: FloatArray
    dynamic_axial_load_N: FloatArray
    shaft_centre_mm: FloatArray
    inertia_kgm2: FloatArray
    no_load_torque_Nm: FloatArray
    transmission_accuracy_arcmin: FloatArray

    def __init__(self, gears: Sequence[Gear]) -> None:
        for name in self.__class__.__annotations__:
            column = np.array([getattr(gear, name) for gear in gears], dtype=np.float64)
            column.flags.writeable = False
            setattr(self, name, column)

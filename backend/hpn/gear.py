"""One catalogue row: a gear of the series with every figure that is published of it, and where each comes from."""

import re
from dataclasses import dataclass, field
from typing import Any

_DESIGNATION = re.compile(r"(?:HPN-?)?(\d{1,3})A?-0*(\d{1,3})(?:-.*)?", re.IGNORECASE)
_SIZE = re.compile(r"(?:HPN-?)?(\d{1,3})A?", re.IGNORECASE)


def canonical_size(text: Any) -> Any:
    """Size in the handbook's spelling: `14`, `14a` and `HPN-14A` are `14A`; anything else comes back as it is."""
    match = _SIZE.fullmatch(text.strip()) if isinstance(text, str) else None
    return f"{int(match[1])}A" if match else text


def canonical_designation(text: str) -> str | None:
    """Designation `HPN-20A-5` from any of the printed spellings, or None.

    The handbook writes `HPN-11A-4-J6-BH-AF1` (ordering code, 3.2), `HPN-20-5` (equation 18.2) and `HPN-11A-04`
    (illustration 19.1) for gears of one kind.
    """
    match = _DESIGNATION.fullmatch(text.strip())
    return f"HPN-{int(match[1])}A-{int(match[2])}" if match else None


@dataclass(frozen=True, slots=True)
class ClampBolt:
    """Bolt of the motor coupling (table 26.2); which one depends on the coupling."""

    bolt_size: str
    tightening_torque_Nm: float | None
    source: str


@dataclass(frozen=True, slots=True)
class HousingBolts:
    """Bolts of the housing flange (table 27.1)."""

    number_of_bolts: int | None
    bolt_size: str | None
    pitch_diameter_mm: float | None
    tightening_torque_Nm: float | None
    source: str


@dataclass(frozen=True, slots=True)
class Gear:
    """A size and ratio. None is a figure that is not published; it is never read as zero."""

    designation: str
    size: str
    ratio: int
    stages: int
    repeated_peak_torque_Nm: float | None = None
    rated_torque_Nm: float | None = None
    momentary_peak_torque_Nm: float | None = None
    maximum_input_speed_rpm: float | None = None
    average_input_speed_rpm: float | None = None
    ambient_temperature_minimum_degC: float | None = None
    ambient_temperature_maximum_degC: float | None = None
    weight_kg: float | None = None
    backlash_arcmin: float | None = None
    transmission_accuracy_arcmin: float | None = None
    torsional_stiffness_Nm_per_rad: float | None = None
    length_min_mm: float | None = None
    length_max_mm: float | None = None
    dynamic_radial_load_N: float | None = None
    dynamic_axial_load_N: float | None = None
    clamp_bolts: tuple[ClampBolt, ...] = ()
    housing_bolts: HousingBolts | None = None
    note: str | None = None
    sources: dict[str, str] = field(default_factory=dict, hash=False)

    @property
    def name(self) -> str:
        """Size as the handbook heads its tables: `HPN-20A`."""
        return f"HPN-{self.size}"

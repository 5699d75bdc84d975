"""The catalogue: every gear of the series, data of the whole series, and columns of figures."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from hpn.catalogue.gear import Gear, GearColumns
from hpn.physics.bearing import Curve
from hpn.physics.equations import FloatArray
from hpn.words.designations import canonical_designation, canonical_size
from hpn.words.quantities import MOTOR, SERIES
from hpn.words.reply import Mixed, described


@dataclass(frozen=True, slots=True)
class SeriesFigure:
    """A figure or text that holds for the whole series, with its unit and source."""

    __pydantic_config__ = described(SERIES)

    value: Mixed
    unit: str | None
    source: str


@dataclass(frozen=True, slots=True)
class FlangeBolt:
    """Bolt between motor and gear flange (table 26.1)."""

    bolt_size: str
    tightening_torque_Nm: float | None
    source: str


@dataclass(frozen=True, slots=True)
class OutputVersion:
    """An option of the ordering code (tables 9.2 and 9.3)."""

    position: str
    code: str
    description: str
    source: str


@dataclass(frozen=True, slots=True)
class Fact:
    """A statement of the handbook that holds for the whole series.

    `check` is the code of the check that it bears on. Without a topic it stands beside its check alone.
    """

    topic: str | None
    text: str
    check: str | None
    source: str


@dataclass(frozen=True, slots=True)
class ListedMotor:
    """A motor of the user; an unknown figure is null."""

    __pydantic_config__ = described(MOTOR)

    designation: str
    maximum_speed_rpm: float | None
    rated_speed_rpm: float | None
    rated_torque_Nm: float | None
    peak_torque_Nm: float | None
    inertia_kgm2: float | None
    source: str


class GearList:
    """Some gears of the catalogue in its order, as rows and as columns.

    Properties of a size, such as its output bearing, are computed once per size: `of_size` (gears,) is the place of
    each gear's size, `first_of_size` (sizes,) the first gear of each.
    """

    def __init__(self, gears: Sequence[Gear], curves: Sequence[Curve | None]) -> None:
        self.rows = tuple(gears)
        self.columns = GearColumns(self.rows)
        self.curves = tuple(curves)
        sizes = [gear.size for gear in self.rows]
        known = list(dict.fromkeys(sizes))
        self.first_of_size = np.array([sizes.index(size) for size in known], dtype=np.intp)
        self.of_size = np.array([known.index(size) for size in sizes], dtype=np.intp)


AVERAGING_S = 300.0
"""Longest uninterrupted time in s above the permissible average speed that averages out: our value, not the
handbook's.
"""


@dataclass(frozen=True, eq=False)
class Catalogue:
    """Every gear of the series, and the data of the whole series. Equal only to itself, so that it can be a key.

    `averaging_s` is the service's own assumption, for a notice; no check depends on it.
    """

    version: str
    gears: tuple[Gear, ...]
    series: dict[str, SeriesFigure]
    flange_bolts: tuple[FlangeBolt, ...]
    output_versions: tuple[OutputVersion, ...]
    curves: dict[str, Curve]
    efficiency: dict[str, tuple[FloatArray, FloatArray]]
    supplement: str | None
    averaging_s: float = AVERAGING_S
    facts: tuple[Fact, ...] = ()
    motors: tuple[ListedMotor, ...] = ()

    def __getstate__(self) -> dict[str, object]:
        """Its fields without cached properties, which other threads may be adding meanwhile."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @cached_property
    def by_designation(self) -> dict[str, Gear]:
        """Gears by canonical designation."""
        return {gear.designation: gear for gear in self.gears}

    @cached_property
    def motor_by_designation(self) -> dict[str, ListedMotor]:
        """The user's motors by designation."""
        return {motor.designation: motor for motor in self.motors}

    @cached_property
    def sizes(self) -> tuple[str, ...]:
        """Sizes, ascending."""
        return tuple(dict.fromkeys(gear.size for gear in self.gears))

    @cached_property
    def ratios(self) -> tuple[int, ...]:
        """Ratios of any size, ascending."""
        return tuple(sorted({gear.ratio for gear in self.gears}))

    @cached_property
    def rated_input_speed_rpm(self) -> float:
        """Rated input speed of equation 17.10."""
        return float(self.series["rated_input_speed"].value)

    @cached_property
    def life_at_rated_torque_h(self) -> float:
        """Life at rated torque and rated input speed of equation 17.10."""
        return float(self.series["life_at_rated_torque"].value)

    @cached_property
    def bearing_reference(self) -> tuple[float, float]:
        """Speed in rpm and life L50 in hours of the published bearing loads (note 1 of table 10.1)."""
        return (
            float(self.series["bearing_reference_speed"].value),
            float(self.series["bearing_reference_life_L50"].value),
        )

    def restricted(self, sizes: tuple[str, ...] | None, ratios: tuple[int, ...] | None) -> GearList:
        """Gears of the given sizes and ratios (None: of all), in catalogue order; may be empty."""
        return self.listed(
            gear
            for gear in self.gears
            if (sizes is None or gear.size in sizes) and (ratios is None or gear.ratio in ratios)
        )

    def listed(self, gears: Iterable[Gear]) -> GearList:
        """Some gears with their curves."""
        chosen = tuple(gears)
        return GearList(chosen, [self.curves.get(gear.size) for gear in chosen])

    def facts_on(self, check: str) -> tuple[Fact, ...]:
        """Statements about the check of a code."""
        return tuple(fact for fact in self.facts if fact.check == check)

    @cached_property
    def facts_by_topic(self) -> dict[str, list[Fact]]:
        """Every fact by its topic."""
        topics: dict[str, list[Fact]] = {}
        for fact in self.facts:
            if fact.topic:
                topics.setdefault(fact.topic, []).append(fact)
        return topics

    def find(self, designation: str) -> Gear | None:
        """Gear of a designation in any of the printed spellings, or None."""
        return self.by_designation.get(canonical_designation(designation) or "")

    def find_size(self, text: str) -> Gear | None:
        """First gear of a size in any spelling, or None; properties of a size are the same in all its gears."""
        return next((gear for gear in self.gears if gear.size == canonical_size(text)), None)

"""The CSV tables of the catalogue: the columns of each, and the permitted content of a cell.

A table is a pydantic model: its fields are the columns, in their units, and `key` names the columns that identify a
row. A supplement has files of the same form that are merged cell by cell; a blank cell changes nothing.
"""

import re
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any, ClassVar, TypeVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, create_model

from hpn.catalogue.gear import Gear
from hpn.words.designations import canonical_size
from hpn.words.quantities import CheckCode
from hpn.words.units import NUMBER, SYMBOLS
from hpn.words.wording import MendableError


class CatalogueError(MendableError, ValueError):
    """A catalogue or supplement file that can't be used; the text names file, line and column."""

    def __init__(self, file: Path | str, line: int | None, column: str | None, detail: str) -> None:
        where = f"{file}" + (f", line {line}" if line else "") + (f", column {column}" if column else "")
        super().__init__(f"{where}: {detail}")


@dataclass(frozen=True, slots=True)
class Cell:
    """Text of one cell, the source named in its row, and its place."""

    text: str
    source: str
    file: str
    line: int
    supplied: bool


Cells = dict[str, Cell]


def _plain_number(value: Any) -> Any:
    # float() would take "1_000", "nan" and "infinity", and make 0 of a number that is too small.
    if not isinstance(value, str):
        return value
    if not NUMBER.fullmatch(value):
        raise ValueError("must be a plain number with a decimal point, such as 9.3 or 8.5e-05")
    if float(value) == 0 and re.search("[1-9]", re.split("[eE]", value)[0]):
        raise ValueError("must be 0 or a number that is not so small")
    return value


Figure = Annotated[float, BeforeValidator(_plain_number), Field(allow_inf_nan=False)]
Positive = Annotated[Figure, Field(gt=0, le=1e12)]
Count = Annotated[int, BeforeValidator(_plain_number), Field(gt=0, le=10_000)]
Size = Annotated[str, BeforeValidator(canonical_size), Field(pattern=r"^\d{1,3}A$")]


class CatalogueRow(BaseModel):
    """One row of one CSV file. A blank cell is None: not published."""

    model_config = ConfigDict(frozen=True, extra="forbid")
    file: ClassVar[str]
    key: ClassVar[tuple[str, ...]]
    most_rows: ClassVar[int] = 1000
    may_be_empty: ClassVar[bool] = False
    optional: ClassVar[frozenset[str]] = frozenset()
    """Columns that a file may lack, as if they were blank; a supplement's file may lack all but the key."""
    source: str | None = Field(None, min_length=1)
    cells: Cells = Field(default_factory=dict, exclude=True)

    @classmethod
    def columns(cls) -> list[str]:
        """Columns of the CSV file."""
        return [name for name in cls.model_fields if name != "cells"]

    def error(self, column: str, detail: str) -> CatalogueError:
        """Error at one cell of this row, or at the row's first cell if the file lacks that column."""
        cell = self.cells.get(column) or next(iter(self.cells.values()))
        return CatalogueError(cell.file, cell.line, column, detail)


TableRow = TypeVar("TableRow", bound=CatalogueRow)


class SourceTable(CatalogueRow):
    file = "sources.csv"
    key = ("source",)
    document: str
    page: Count
    title: str


class RatioRow(CatalogueRow):
    """Row of a table of figures that differ from gear to gear."""

    key = ("size", "ratio")
    size: Size
    ratio: Count


class GearRow(RatioRow):
    """Row of the list of gears."""

    stages: Count


class SizeRow(CatalogueRow):
    """Row of a table of figures that all gears of a size share."""

    key = ("size",)
    size: Size
    note: str | None = None


class StageRow(CatalogueRow):
    """Row of a table of figures that all gears of a size and number of stages share."""

    key = ("size", "stages")
    size: Size
    stages: Count


def _with_figures(file: str, base: type[TableRow]) -> type[TableRow]:
    """Table of the figures that the fields of `Gear` assign to this file."""
    figures: dict[str, Any] = {
        field.name: (Figure | None if field.metadata["signed"] else Positive | None, None)
        for field in fields(Gear)
        if field.metadata.get("file") == file
    }
    table: type[TableRow] = create_model(file, __base__=base, **figures)
    table.file = file
    table.optional = Gear.unpublished() & figures.keys()
    return table


GearTable = _with_figures("gears.csv", GearRow)
RatingTable = _with_figures("ratings.csv", RatioRow)
SizeTable = _with_figures("sizes.csv", SizeRow)
WeightTable = _with_figures("weights.csv", StageRow)
LengthTable = _with_figures("lengths.csv", StageRow)
AccuracyTable = _with_figures("accuracy.csv", StageRow)
StiffnessTable = _with_figures("stiffness.csv", StageRow)


class FlangeBoltTable(CatalogueRow):
    file = "flange_bolts.csv"
    key = ("bolt_size",)
    bolt_size: str
    tightening_torque_Nm: Positive | None = None


class ClampBoltTable(CatalogueRow):
    file = "clamp_bolts.csv"
    key = ("size", "bolt_size")
    size: Size
    bolt_size: str
    tightening_torque_Nm: Positive | None = None


class HousingBoltTable(CatalogueRow):
    file = "housing_bolts.csv"
    key = ("size",)
    size: Size
    number_of_bolts: Count | None = None
    bolt_size: str | None = None
    pitch_diameter_mm: Positive | None = None
    tightening_torque_Nm: Positive | None = None


class VersionTable(CatalogueRow):
    file = "versions.csv"
    key = ("position", "code")
    position: str
    code: str
    description: str


class FactTable(CatalogueRow):
    file = "facts.csv"
    key = ("name",)
    name: str
    topic: str | None = None
    text: str
    check: CheckCode | None = None


class SeriesTable(CatalogueRow):
    file = "series.csv"
    key = ("name",)
    name: str
    value: str
    unit: Annotated[str, Field(pattern="^(" + "|".join(SYMBOLS) + ")$")] | None = None


class EnvelopeTable(CatalogueRow):
    """Point of a printed bearing graph (16.1 to 16.5); the handbook's text has none."""

    file = "bearing_envelopes.csv"
    key = ("size", "load_coefficient", "axial_N", "radial_N")
    most_rows = 10_000
    may_be_empty = True
    size: Size
    load_coefficient: Annotated[Figure, Field(ge=1, le=3)]
    axial_N: Annotated[Figure, Field(ge=0, le=1e12)]
    radial_N: Annotated[Figure, Field(ge=0, le=1e12)]


class EfficiencyTable(CatalogueRow):
    """Point of a printed efficiency curve (19.1 to 23.9); the handbook's text has none."""

    file = "efficiency.csv"
    key = ("size", "ratio", "torque_Nm")
    most_rows = 10_000
    may_be_empty = True
    size: Size
    ratio: Count
    torque_Nm: Positive
    efficiency: Annotated[Figure, Field(gt=0, le=1)]


class MotorTable(CatalogueRow):
    """A motor of the user; the handbook has none."""

    file = "motors.csv"
    key = ("designation",)
    most_rows = 10_000
    may_be_empty = True
    designation: Annotated[str, Field(max_length=100)]
    maximum_speed_rpm: Positive | None = None
    rated_speed_rpm: Positive | None = None
    rated_torque_Nm: Positive | None = None
    peak_torque_Nm: Positive | None = None
    inertia_kgm2: Positive | None = None


TABLES: tuple[type[CatalogueRow], ...] = (
    SourceTable,
    GearTable,
    RatingTable,
    SizeTable,
    WeightTable,
    LengthTable,
    AccuracyTable,
    StiffnessTable,
    FlangeBoltTable,
    ClampBoltTable,
    HousingBoltTable,
    VersionTable,
    FactTable,
    SeriesTable,
    EnvelopeTable,
    EfficiencyTable,
    MotorTable,
)

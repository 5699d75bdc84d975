"""The CSV tables of the catalogue: which columns each has, what a cell may hold, and reading them cell by cell.

A table is a pydantic model: its fields are the columns, in their units, and `key` names the columns that identify a
row. A supplement has files of the same form that are merged cell by cell; a blank cell keeps what was there.
"""

import csv
from collections.abc import Iterator
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any, ClassVar, TypeVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, create_model

from hpn.gear import Gear, canonical_size
from hpn.units import SYMBOLS

MAXIMUM_FILE_BYTES = 4_000_000


class CatalogueError(ValueError):
    """A catalogue or supplement file that can't be used; the text names file, line and column."""

    def __init__(self, file: Path | str, line: int | None, column: str | None, detail: str) -> None:
        where = f"{file}" + (f", line {line}" if line else "") + (f", column {column}" if column else "")
        super().__init__(f"{where}: {detail}")


@dataclass(frozen=True, slots=True)
class Cell:
    """Text of one cell, the source its row names, and where it was read."""

    text: str
    source: str
    file: str
    line: int
    supplied: bool


Cells = dict[str, Cell]


def _plain_number(value: Any) -> Any:
    # float() would take "1_000", "nan" and "infinity"; a catalogue figure is digits and a decimal point.
    if isinstance(value, str) and not set(value) <= set("0123456789.-"):
        raise ValueError("must be a plain number with a decimal point, such as 9.3")
    return value


Figure = Annotated[float, BeforeValidator(_plain_number), Field(allow_inf_nan=False)]
Positive = Annotated[Figure, Field(gt=0, le=1e12)]
Count = Annotated[int, BeforeValidator(_plain_number), Field(gt=0, le=10_000)]
Size = Annotated[str, BeforeValidator(canonical_size), Field(pattern=r"^\d{1,3}A$")]


class Table(BaseModel):
    """One row of one CSV file. A blank cell is None: not published."""

    model_config = ConfigDict(frozen=True, extra="forbid")
    file: ClassVar[str]
    key: ClassVar[tuple[str, ...]]
    source: str | None = Field(None, min_length=1)
    cells: Cells = Field(default_factory=dict, exclude=True)

    @classmethod
    def columns(cls) -> list[str]:
        """Columns of the CSV file."""
        return [name for name in cls.model_fields if name != "cells"]

    def error(self, column: str, detail: str) -> CatalogueError:
        """Error that points at one cell of this row, or at its first cell where the file leaves that one blank."""
        cell = self.cells.get(column) or next(iter(self.cells.values()))
        return CatalogueError(cell.file, cell.line, column, detail)


TableRow = TypeVar("TableRow", bound=Table)


class SourceTable(Table):
    file = "sources.csv"
    key = ("source",)
    document: str
    page: Count
    title: str


class GearTable(Table):
    file = "gears.csv"
    key = ("size", "ratio")
    size: Size
    ratio: Count
    stages: Count


class RatioRow(Table):
    """Row of a table of figures that each gear has of its own."""

    key = ("size", "ratio")
    size: Size
    ratio: Count


class SizeRow(Table):
    """Row of a table of figures that all gears of a size share."""

    key = ("size",)
    size: Size
    note: str | None = None


class StageRow(Table):
    """Row of a table of figures that all gears of a size and number of stages share."""

    key = ("size", "stages")
    size: Size
    stages: Count


def _with_figures(file: str, base: type[TableRow]) -> type[TableRow]:
    """Table of the figures that the fields of `Gear` say they have from this file."""
    figures: dict[str, Any] = {
        field.name: (Figure | None if field.metadata["signed"] else Positive | None, None)
        for field in fields(Gear)
        if field.metadata.get("file") == file
    }
    table: type[TableRow] = create_model(file, __base__=base, **figures)
    table.file = file
    return table


RatingTable = _with_figures("ratings.csv", RatioRow)
SizeTable = _with_figures("sizes.csv", SizeRow)
WeightTable = _with_figures("weights.csv", StageRow)
LengthTable = _with_figures("lengths.csv", StageRow)
AccuracyTable = _with_figures("accuracy.csv", StageRow)
StiffnessTable = _with_figures("stiffness.csv", StageRow)


class FlangeBoltTable(Table):
    file = "flange_bolts.csv"
    key = ("bolt_size",)
    bolt_size: str
    tightening_torque_Nm: Positive | None = None


class ClampBoltTable(Table):
    file = "clamp_bolts.csv"
    key = ("size", "bolt_size")
    size: Size
    bolt_size: str
    tightening_torque_Nm: Positive | None = None


class HousingBoltTable(Table):
    file = "housing_bolts.csv"
    key = ("size",)
    size: Size
    number_of_bolts: Count | None = None
    bolt_size: str | None = None
    pitch_diameter_mm: Positive | None = None
    tightening_torque_Nm: Positive | None = None


class VersionTable(Table):
    file = "versions.csv"
    key = ("position", "code")
    position: str
    code: str
    description: str


class SeriesTable(Table):
    file = "series.csv"
    key = ("name",)
    name: str
    value: str
    unit: Annotated[str, Field(pattern="^(" + "|".join(SYMBOLS) + ")$")] | None = None


class EnvelopeTable(Table):
    """Point of a printed bearing graph (16.1 to 16.5); the handbook's text has none."""

    file = "bearing_envelopes.csv"
    key = ("size", "load_coefficient", "axial_N", "radial_N")
    size: Size
    load_coefficient: Annotated[Figure, Field(ge=1, le=3)]
    axial_N: Annotated[Figure, Field(ge=0, le=1e12)]
    radial_N: Annotated[Figure, Field(ge=0, le=1e12)]


class EfficiencyTable(Table):
    """Point of a printed efficiency curve (19.1 to 23.9); the handbook's text has none."""

    file = "efficiency.csv"
    key = ("size", "ratio", "torque_Nm")
    size: Size
    ratio: Count
    torque_Nm: Positive
    efficiency: Annotated[Figure, Field(gt=0, le=1)]


TABLES: tuple[type[Table], ...] = (
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
    SeriesTable,
    EnvelopeTable,
    EfficiencyTable,
)


Key = tuple[str, ...]


def read(folder: Path, table: type[Table], *, supplied: bool) -> dict[Key, Cells]:
    """Cells of one CSV file by key; empty where a supplement lacks the file.

    Raises CatalogueError for a missing file, a wrong header, a row of the wrong length, a blank or repeated key.
    """
    path = folder / table.file
    if supplied and not path.exists():
        return {}
    rows: dict[Key, Cells] = {}
    for line, row in _lines(path, table):
        texts = dict(zip(table.columns(), (text.strip() for text in row), strict=True))
        cells = {column: Cell(text, texts["source"], str(path), line, supplied) for column, text in texts.items()}
        for column in table.key:
            if not cells[column].text:
                raise CatalogueError(path, line, column, "is blank, but it identifies the row")
        key = tuple(_key_text(column, cells[column].text) for column in table.key)
        if key in rows:
            first = next(iter(rows[key].values())).line
            raise CatalogueError(path, line, table.key[0], f"repeats the row of line {first}")
        rows[key] = cells
    return rows


def merge(rows: dict[Key, Cells], supplement: dict[Key, Cells]) -> dict[Key, Cells]:
    """Fill or correct cells of `rows` by those of a supplement; a blank cell keeps what was there."""
    merged = dict(rows)
    for key, cells in supplement.items():
        kept = merged.get(key, {})
        given = {column: cell for column, cell in cells.items() if cell.text or column not in kept}
        merged[key] = kept | given
    return merged


def validated(table: type[TableRow], rows: dict[Key, Cells]) -> list[TableRow]:
    """Typed rows; raises CatalogueError that names file, line and column of the first wrong cell."""
    result = []
    for cells in rows.values():
        values: dict[str, Any] = {column: cell.text or None for column, cell in cells.items()}
        try:
            result.append(table.model_validate({**values, "cells": cells}))
        except ValidationError as error:
            first = error.errors()[0]
            column = str(first["loc"][0])
            cell = cells[column]
            detail = f"{first['msg'].removeprefix('Value error, ')} (found {cell.text!r})"
            raise CatalogueError(cell.file, cell.line, column, detail) from None
    return result


def _lines(path: Path, table: type[Table]) -> Iterator[tuple[int, list[str]]]:
    try:
        if path.stat().st_size > MAXIMUM_FILE_BYTES:
            raise CatalogueError(path, None, None, f"is larger than {MAXIMUM_FILE_BYTES} bytes")
        content = path.read_bytes()
        text = content.decode("utf-8-sig")
    except FileNotFoundError:
        raise CatalogueError(path, None, None, "is missing") from None
    except OSError as error:
        raise CatalogueError(path, None, None, f"can't be read: {error}") from None
    except UnicodeDecodeError as error:
        lines = (content[: error.start] + b"?").decode("utf-8-sig").splitlines()
        header, broken = next(csv.reader(lines)), next(csv.reader(lines[-1:]))
        column = header[len(broken) - 1] if len(broken) <= len(header) and len(lines) > 1 else None
        detail = f"byte {content[error.start]:#04x} is not UTF-8 text; save the file as UTF-8"
        raise CatalogueError(path, len(lines), column, detail) from None
    reader = csv.reader(text.splitlines(), strict=True)
    columns = table.columns()
    try:
        header = next(reader, [])
        if sorted(header) != sorted(columns):
            wrong = sorted(set(header) ^ set(columns)) or header
            detail = f"the header must have the columns {', '.join(columns)}; see {', '.join(wrong)}"
            raise CatalogueError(path, 1, None, detail)
        order = [header.index(column) for column in columns]
        for row in reader:
            if not row:
                continue
            if len(row) != len(columns):
                place = header[min(len(row), len(header) - 1)]  # the first column without a cell, else the last of all
                detail = f"has {len(row)} cells where the header has {len(columns)} (a decimal comma splits a cell)"
                raise CatalogueError(path, reader.line_num, place, f"the row {detail}")
            yield reader.line_num, [row[index] for index in order]
    except csv.Error as error:
        raise CatalogueError(path, reader.line_num, None, str(error)) from None


def _key_text(column: str, text: str) -> str:
    if column == "size":
        return str(canonical_size(text))
    try:
        return repr(float(text))
    except ValueError:
        return text

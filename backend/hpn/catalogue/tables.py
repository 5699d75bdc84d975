"""The CSV tables of the catalogue: which columns each has, what a cell may hold, and reading them cell by cell.

A table is a pydantic model: its fields are the columns, in their units, and `key` names the columns that identify a
row. A supplement has files of the same form that are merged cell by cell; a blank cell keeps what was there.
"""

import codecs
import csv
import re
from collections.abc import Iterator
from dataclasses import dataclass, fields
from decimal import Decimal
from pathlib import Path
from typing import Annotated, Any, ClassVar, TypeVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, create_model

from hpn.catalogue.files import CatalogueError
from hpn.catalogue.gear import Gear
from hpn.tables.cells import split_unit
from hpn.tables.numbers import unit_code
from hpn.words.designations import canonical_size
from hpn.words.quantities import CheckCode
from hpn.words.units import NUMBER, SYMBOLS, entered, quantity_of, suffix_of
from hpn.words.wording import Sentence

LONGEST_CELL = 1000

UNPRINTABLE = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ufeff\ufffe\uffff]")
"""Control characters, separators of lines that editors don't count, marks that turn the text around them."""


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
    most_rows: ClassVar[int] = 1000
    may_be_empty: ClassVar[bool] = False
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


class FactTable(Table):
    file = "facts.csv"
    key = ("name",)
    name: str
    topic: str | None = None
    text: str
    check: CheckCode | None = None


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
    most_rows = 10_000
    may_be_empty = True
    size: Size
    load_coefficient: Annotated[Figure, Field(ge=1, le=3)]
    axial_N: Annotated[Figure, Field(ge=0, le=1e12)]
    radial_N: Annotated[Figure, Field(ge=0, le=1e12)]


class EfficiencyTable(Table):
    """Point of a printed efficiency curve (19.1 to 23.9); the handbook's text has none."""

    file = "efficiency.csv"
    key = ("size", "ratio", "torque_Nm")
    most_rows = 10_000
    may_be_empty = True
    size: Size
    ratio: Count
    torque_Nm: Positive
    efficiency: Annotated[Figure, Field(gt=0, le=1)]


class MotorTable(Table):
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
    FactTable,
    SeriesTable,
    EnvelopeTable,
    EfficiencyTable,
    MotorTable,
)


Key = tuple[str, ...]


def read(path: Path, content: bytes, table: type[Table], *, supplied: bool) -> dict[Key, Cells]:
    """Cells of one CSV file by key.

    Raises CatalogueError for what is no text, a wrong header, no row or too many, a row of the wrong length, a blank or
    repeated key.
    """
    rows: dict[Key, Cells] = {}
    for line, row in _lines(path, _text(path, content), table):
        texts = dict(zip(table.columns(), (text.strip() for text in row), strict=True))
        cells = {column: Cell(text, texts["source"], str(path), line, supplied) for column, text in texts.items()}
        for column in table.key:
            if not cells[column].text:
                raise CatalogueError(path, line, column, "is blank, but it identifies the row")
        key = tuple(_key_text(column, cells[column].text) for column in table.key)
        if key in rows:
            first = next(iter(rows[key].values())).line
            raise CatalogueError(path, line, table.key[0], f"repeats the row of line {first}")
        if len(rows) == table.most_rows:
            raise CatalogueError(path, line, None, f"the table has more than {table.most_rows} rows")
        rows[key] = cells
    if not rows and (supplied or not table.may_be_empty):
        raise CatalogueError(path, 1, None, "there is a header, but no row below it")
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
            message = first["msg"].removeprefix("Value error, ").replace("Input should", "must")
            detail = f"{message} (found {cell.text[:60]!r})"
            raise CatalogueError(cell.file, cell.line, column, detail) from None
    return result


def _text(path: Path, content: bytes) -> str:
    content = content.removeprefix(codecs.BOM_UTF8)
    try:
        text = content.decode()
    except UnicodeDecodeError as error:
        place = _place(content[: error.start].decode())
        detail = f"byte {content[error.start]:#04x} is not UTF-8 text; save the file as UTF-8"
        raise CatalogueError(path, *place, detail) from None
    if found := UNPRINTABLE.search(text):
        detail = f"the character U+{ord(found[0]):04X} does not belong in a table; save the file as UTF-8 text"
        raise CatalogueError(path, *_place(text[: found.start()]), detail)
    return text


def _place(before: str) -> tuple[int, str | None]:
    """Line and column of what follows a text."""
    lines = (before + "?").splitlines()
    try:
        header, broken = next(csv.reader(lines)), next(csv.reader(lines[-1:]))
    except csv.Error:  # the text is no table either
        return len(lines), None
    return len(lines), header[len(broken) - 1] if len(broken) <= len(header) and len(lines) > 1 else None


def _lines(path: Path, text: str, table: type[Table]) -> Iterator[tuple[int, list[str]]]:
    reader = csv.reader(text.splitlines(), strict=True)
    columns = table.columns()
    try:
        written = next(reader, [])
        header, codes = _header(path, written, columns)
        if sorted(header) != sorted(columns):
            wrong = [name[:40] for name in sorted(set(header) ^ set(columns)) or header]
            detail = f"the header must have the columns {', '.join(columns)}; see {', '.join(wrong[:20])}"
            raise CatalogueError(path, 1, None, detail)
        order = [header.index(column) for column in columns]
        for row in reader:
            if not row:
                continue
            if len(row) != len(columns):
                place = header[min(len(row), len(header) - 1)]  # the first column without a cell, else the last of all
                detail = f"has {len(row)} cells where the header has {len(columns)} (a decimal comma splits a cell)"
                raise CatalogueError(path, reader.line_num, place, f"the row {detail}")
            if max(map(len, row)) > LONGEST_CELL:
                place = next(column for column, cell in zip(header, row, strict=True) if len(cell) > LONGEST_CELL)
                detail = f"the cell has more than {LONGEST_CELL} characters"
                raise CatalogueError(path, reader.line_num, place, detail)
            texts = [_in_wire(row[index], columns[k], codes[index]) for k, index in enumerate(order)]
            for column, found in zip(columns, texts, strict=True):
                if isinstance(found, Sentence):
                    raise CatalogueError(path, reader.line_num, column, found.text)
            yield reader.line_num, list(map(str, texts))
    except csv.Error as error:
        detail = {"unexpected end of data": "a quote is opened and not closed"}.get(str(error), str(error))
        raise CatalogueError(path, reader.line_num, None, detail) from None


def _header(path: Path, written: list[str], columns: list[str]) -> tuple[list[str], list[str]]:
    """Columns by what a header calls them, and codes of their units: `inertia_kgcm2` is `inertia_kgm2` in kg·cm²."""
    names, codes = list(written), [""] * len(written)
    for place, name in enumerate(written):
        for column in columns if name not in columns else ():
            unit = suffix_of(column)
            stem = column.removesuffix(unit or "").rstrip("_")
            if unit and quantity_of(unit) and name.startswith((f"{stem}_", f"{stem} ")):
                code = unit_code(name.removeprefix(stem).strip("_ []()"), unit)
                if isinstance(code, Sentence):
                    raise CatalogueError(path, 1, name[:40], code.text)
                names[place], codes[place] = column, code
    return names, codes


def _in_wire(text: str, column: str, code: str) -> str | Sentence:
    """A cell in the unit of its column; the unit that it says itself counts before that of the header."""
    unit = suffix_of(column)
    if not unit or not quantity_of(unit):
        return text
    number, own = split_unit(text.strip())
    found = unit_code(own, unit) if own else code
    if isinstance(found, Sentence):
        return found
    if not found or not NUMBER.fullmatch(number) or (measure := entered(unit, found)).same:
        return number if own else text
    return f"{Decimal(repr(measure.wire(number))):f}"


def _key_text(column: str, text: str) -> str:
    if column == "size":
        return str(canonical_size(text))
    try:
        return repr(float(text))
    except ValueError:
        return text

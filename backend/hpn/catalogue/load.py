"""From CSV tables, and a supplement over them, to gears with a source for every figure."""

import hashlib
from collections import defaultdict
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np

from hpn.catalogue import files, tables
from hpn.catalogue.catalogue import AVERAGING_S, Catalogue, Fact, FlangeBolt, ListedMotor, OutputVersion, SeriesFigure
from hpn.catalogue.gear import ClampBolt, Gear, HousingBolts
from hpn.catalogue.tables import (
    AccuracyTable,
    CatalogueError,
    CatalogueRow,
    Cells,
    ClampBoltTable,
    EfficiencyTable,
    EnvelopeTable,
    FactTable,
    FlangeBoltTable,
    GearTable,
    HousingBoltTable,
    LengthTable,
    MotorTable,
    RatingTable,
    SeriesTable,
    SizeTable,
    SourceTable,
    StiffnessTable,
    TableRow,
    VersionTable,
    WeightTable,
)
from hpn.installed import data_folder
from hpn.physics.bearing import Curve, CurveError, curve_through
from hpn.physics.equations import FloatArray
from hpn.words.source import printed_source, supplied_source

FILES = tuple(table.file for table in tables.TABLES)
HANDBOOK_FOLDER = data_folder("catalogue")

SERIES_FIGURES = {
    "rated_input_speed": "rpm",
    "life_at_rated_torque": "h",
    "bearing_reference_speed": "rpm",
    "bearing_reference_life_L50": "h",
}
"""Figures of series.csv that the equations need, and their units."""

PER_STAGE = (WeightTable, LengthTable, AccuracyTable, StiffnessTable)
"""Tables whose figures depend on size and number of stages."""

ORDERINGS = (
    (RatingTable, "rated_torque_Nm", "momentary_peak_torque_Nm", False),
    (RatingTable, "rated_torque_Nm", "repeated_peak_torque_Nm", True),
    (RatingTable, "repeated_peak_torque_Nm", "momentary_peak_torque_Nm", False),
    (SizeTable, "average_input_speed_rpm", "maximum_input_speed_rpm", True),
    (SizeTable, "ambient_temperature_minimum_degC", "ambient_temperature_maximum_degC", False),
    (LengthTable, "length_min_mm", "length_max_mm", True),
    (MotorTable, "rated_speed_rpm", "maximum_speed_rpm", True),
    (MotorTable, "rated_torque_Nm", "peak_torque_Nm", True),
)
"""Table, smaller figure, larger figure, and True if they may be equal."""


def load_catalogue(
    folder: Path = HANDBOOK_FOLDER, supplement: Path | None = None, averaging_s: float = AVERAGING_S
) -> Catalogue:
    """Read, merge and validate the catalogue.

    Raises CatalogueError, which names file, line and column, for the first fault.
    """
    parts = [(part, files.read_folder(part, FILES)) for part in (folder, supplement) if part]
    for part, contents in parts:
        if not contents:
            raise CatalogueError(
                part, None, None, f"has no table of the catalogue; there are {', '.join(sorted(FILES))}"
            )
    book = _Book()
    for table in tables.TABLES:
        book[table] = files.validated(table, _rows(table, parts))
    _check(book)
    return Catalogue(
        version=_version([contents for _, contents in parts]),
        gears=_gears(book),
        series=_series(book),
        flange_bolts=tuple(
            FlangeBolt(row.bolt_size, row.tightening_torque_Nm, book.source(row, "tightening_torque_Nm"))
            for row in book.of(FlangeBoltTable)
        ),
        output_versions=tuple(
            OutputVersion(row.position, row.code, row.description, book.source(row, "description"))
            for row in book.of(VersionTable)
        ),
        facts=tuple(Fact(row.topic, row.text, row.check, book.source(row, "text")) for row in book.of(FactTable)),
        curves=_curves(book),
        efficiency=_efficiency(book),
        motors=_motors(book),
        supplement=str(supplement) if supplement else None,
        averaging_s=averaging_s,
    )


def _rows(table: type[CatalogueRow], parts: Sequence[tuple[Path, dict[str, bytes]]]) -> dict[files.Key, Cells]:
    """Rows of the catalogue's folder, merged with the supplement's rows of the same table."""
    (folder, contents), *supplements = parts
    if table.file not in contents:
        raise CatalogueError(folder / table.file, None, None, "is missing")
    rows = files.read(folder / table.file, contents[table.file], table, supplied=False)
    for supplement, supplied in supplements:
        if table.file in supplied:
            over = files.read(supplement / table.file, supplied[table.file], table, supplied=True)
            rows = files.merge(rows, over)
    return rows


def _version(parts: Iterable[dict[str, bytes]]) -> str:
    digest = hashlib.sha256()
    for contents in parts:
        for name in filter(contents.__contains__, FILES):
            content = contents[name].replace(b"\r\n", b"\n")
            digest.update(f"{name} {len(content)}\n".encode() + content)
        digest.update(b"--\n")
    return digest.hexdigest()[:16]


class _Book(dict[type[CatalogueRow], list[CatalogueRow]]):
    """Validated rows by table."""

    def __init__(self) -> None:
        self._by_key: dict[tuple[object, ...], CatalogueRow] = {}

    def __setitem__(self, table: type[CatalogueRow], rows: list[CatalogueRow]) -> None:
        super().__setitem__(table, rows)
        self._by_key |= {(table, *(getattr(row, name) for name in table.key)): row for row in rows}

    def of(self, table: type[TableRow]) -> list[TableRow]:
        """Rows of one table, typed."""
        return cast(list[TableRow], self[table])

    def find(self, table: type[TableRow], *key: object) -> TableRow | None:
        """Row with this key, or None."""
        return cast(TableRow | None, self._by_key.get((table, *key)))

    def source(self, row: CatalogueRow, column: str) -> str:
        """Source of one figure, with a mark for the user's own."""
        cell = row.cells[column]
        if cell.supplied:
            return supplied_source(cell.source or Path(cell.file).name)
        printed = self.find(SourceTable, cell.source)
        assert printed is not None  # ensured by `_check`
        return printed_source(cell.source, printed.page)


def _check(book: _Book) -> None:
    sources = {row.source for row in book.of(SourceTable)}
    sizes = {row.size for row in book.of(GearTable)}
    pairs = {
        "ratio": {(row.size, row.ratio) for row in book.of(GearTable)},
        "stages": {(row.size, row.stages) for row in book.of(GearTable)},
    }
    for table in tables.TABLES:
        for row in book[table]:
            cell = row.cells["source"]
            if not cell.supplied and cell.text not in sources:
                raise row.error("source", f"{cell.text!r} is not in sources.csv")
            values = tuple(getattr(row, name) for name in table.key)
            if "size" in table.key and values[0] not in sizes:
                raise row.error("size", f"{values[0]} is not a size of gears.csv")
            if len(table.key) > 1 and table.key[1] in pairs and values[:2] not in pairs[table.key[1]]:
                raise row.error(table.key[1], f"gears.csv has no {values[0]} with {table.key[1]} {values[1]}")
    _check_stages(book)
    _check_orderings(book)
    _check_complete(book)
    for name, unit in SERIES_FIGURES.items():
        figure = book.find(SeriesTable, name)
        if figure is None:
            raise CatalogueError("series.csv", None, "name", f"{name} is missing")
        if figure.unit != unit:
            raise figure.error("unit", f"{name} must be in {unit}")


def _check_stages(book: _Book) -> None:
    """Raise CatalogueError unless a ratio has the same stages in every size, and a larger ratio never has fewer
    stages.
    """
    kinds = {(gear.ratio, gear.stages): gear for gear in reversed(book.of(GearTable))}
    for gear in kinds.values():
        for other in kinds.values():
            if (gear.ratio <= other.ratio and gear.stages > other.stages) or (
                gear.ratio == other.ratio and gear.stages != other.stages
            ):
                later = max(gear, other, key=lambda row: (row.cells["stages"].supplied, row.cells["stages"].line))
                raise later.error(
                    "stages",
                    f"ratio {gear.ratio} with {gear.stages} stages contradicts {other.ratio} with {other.stages}",
                )


def _check_orderings(book: _Book) -> None:
    for table, smaller, larger, may_equal in ORDERINGS:
        for row in book[table]:
            low, high = getattr(row, smaller), getattr(row, larger)
            if low is not None and high is not None and (low > high or (low == high and not may_equal)):
                column = larger if row.cells[larger].supplied else smaller
                raise row.error(
                    column, f"{smaller} {low:g} must be {'at most' if may_equal else 'below'} {larger} {high:g}"
                )


def _check_complete(book: _Book) -> None:
    """Raise CatalogueError unless a size that the handbook rates is complete; a supplement may rate single gears."""
    rated = {row.size: row for row in reversed(book.of(RatingTable)) if not row.cells["size"].supplied}
    for gear in book.of(GearTable):
        if gear.size not in rated:
            continue
        rows: dict[type[CatalogueRow], CatalogueRow | None] = {
            RatingTable: book.find(RatingTable, gear.size, gear.ratio),
            SizeTable: book.find(SizeTable, gear.size),
            WeightTable: book.find(WeightTable, gear.size, gear.stages),
            LengthTable: book.find(LengthTable, gear.size, gear.stages),
            AccuracyTable: book.find(AccuracyTable, gear.size, gear.stages),
            StiffnessTable: book.find(StiffnessTable, gear.size, gear.stages),
        }
        for table, row in rows.items():
            if row is None:
                key = ", ".join(f"{name} {getattr(gear, name)}" for name in table.key)
                detail = f"{table.file} has no row of {key}, but {gear.size} is rated"
                raise rated[gear.size].error("size", detail)
            for column in table.columns():
                if column not in ("source", "note", *table.optional) and getattr(row, column) is None:
                    raise row.error(column, f"is blank, but {gear.size} is rated")


def _series(book: _Book) -> dict[str, SeriesFigure]:
    series = {}
    for row in book.of(SeriesTable):
        value: float | str = row.value
        if row.unit:
            try:
                value = float(row.value)
            except ValueError:
                raise row.error("value", f"must be a number of {row.unit} (found {row.value!r})") from None
            if not np.isfinite(value) or (row.name in SERIES_FIGURES and value <= 0):
                raise row.error("value", f"must be above 0 (found {row.value!r})")
        series[row.name] = SeriesFigure(value, row.unit, book.source(row, "value"))
    return series


def _gears(book: _Book) -> tuple[Gear, ...]:
    gears = []
    for row in sorted(book.of(GearTable), key=lambda row: (int(row.size[:-1]), row.ratio)):
        parts: list[CatalogueRow | None] = [
            row,
            book.find(RatingTable, row.size, row.ratio),
            book.find(SizeTable, row.size),
            *(book.find(table, row.size, row.stages) for table in PER_STAGE),
        ]
        values: dict[str, Any] = {}
        sources = {"ratio": book.source(row, "ratio"), "stages": book.source(row, "stages")}
        for part in filter(None, parts):
            for column in part.columns():
                if column not in (*part.key, "stages", "source"):
                    values[column] = getattr(part, column)
                    if values[column] is not None:
                        sources[column] = book.source(part, column)
        gears.append(
            Gear(
                designation=f"HPN-{row.size}-{row.ratio}",
                size=row.size,
                ratio=row.ratio,
                stages=row.stages,
                **values,
                clamp_bolts=tuple(
                    ClampBolt(bolt.bolt_size, bolt.tightening_torque_Nm, book.source(bolt, "tightening_torque_Nm"))
                    for bolt in book.of(ClampBoltTable)
                    if bolt.size == row.size
                ),
                housing_bolts=_housing_bolts(book, row.size),
                sources=sources,
            )
        )
    return tuple(gears)


def _housing_bolts(book: _Book, size: str) -> HousingBolts | None:
    row = book.find(HousingBoltTable, size)
    if row is None:
        return None
    source = book.source(row, "tightening_torque_Nm")
    return HousingBolts(row.number_of_bolts, row.bolt_size, row.pitch_diameter_mm, row.tightening_torque_Nm, source)


def _curves(book: _Book) -> dict[str, Curve]:
    """Curves by size from the points with f_w = 1; curves of other load coefficients are only validated."""
    points: dict[tuple[str, float], list[EnvelopeTable]] = defaultdict(list)
    for row in book.of(EnvelopeTable):
        points[row.size, row.load_coefficient].append(row)
    curves = {}
    for (size, load_coefficient), rows in points.items():
        try:
            curve = curve_through([(row.radial_N, row.axial_N) for row in rows])
        except CurveError as error:
            raise rows[error.index].error("axial_N", str(error)) from None
        if load_coefficient == 1:
            curves[size] = curve
    return curves


def _efficiency(book: _Book) -> dict[str, tuple[FloatArray, FloatArray]]:
    points: dict[str, list[tuple[float, float]]] = defaultdict(list)
    for row in book.of(EfficiencyTable):
        points[f"HPN-{row.size}-{row.ratio}"].append((row.torque_Nm, row.efficiency))
    return {
        designation: (np.array([t for t, _ in sorted(curve)]), np.array([eta for _, eta in sorted(curve)]))
        for designation, curve in points.items()
    }


def _motors(book: _Book) -> tuple[ListedMotor, ...]:
    names = [name for name in MotorTable.columns() if name != "source"]
    return tuple(
        ListedMotor(**{name: getattr(row, name) for name in names}, source=book.source(row, "designation"))
        for row in book.of(MotorTable)
    )

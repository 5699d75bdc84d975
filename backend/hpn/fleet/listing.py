"""The axes that are shown one by one, in a page or a report: their answers, and what they were asked with."""

import io
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as pacsv
import pyarrow.dataset as datasets
import pyarrow.parquet as pq

from hpn.account.readings import Life, life_of
from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.evaluation import Evaluation, PlaceArray, evaluate
from hpn.fleet.axes import Axes
from hpn.fleet.columns import AXIS, COLUMNS
from hpn.fleet.gathering import axes_of
from hpn.fleet.opened import open_tables
from hpn.fleet.order import Order, format_of
from hpn.fleet.outcome import answer_fields
from hpn.fleet.summary import Summary, summary_of
from hpn.fleet.uuids import is_uuid, text_of
from hpn.fleet.writing import WITHOUT_UUIDS

MOST_LISTED = 10_000
"""Axes that a page or a report shows one by one; more are in the files."""

FORMATS = {
    ".parquet": "parquet",
    ".arrow": "ipc",
    ".csv": datasets.CsvFileFormat(convert_options=pacsv.ConvertOptions(strings_can_be_null=True)),
    ".ndjson": "json",
}

State = Literal["selected", "unsuitable", "rejected"]


MOST_BYTES = 64_000_000
"""Inputs of these axes in memory: a page reads them anew each time."""


@dataclass(frozen=True)
class Listing:
    """Counts over all axes, and the first of them: `answers`, with the nearest miss where no gear suits, and `axes`
    in list form with the inputs of those that were not rejected. Their names are text.
    """

    summary: Summary
    answers: pa.Table
    axes: pa.Table


class AxisRow(NamedTuple):
    """An axis with its gear, or with the nearest miss where none suits; `place` counts the axes of the input."""

    place: int
    axis: str
    state: State
    gear: str | None
    governing_check: str | None
    utilisation: float | None
    life: Life | None
    suitable: int | None
    runner_up: str | None
    average_torque_Nm: float | None
    error: str | None
    motor_torque_limit_Nm: float | None = None


NEAREST = pa.schema([("nearest", pa.string()), ("nearest_check", pa.string()), ("nearest_utilisation", pa.float64())])
"""Columns beside those of the answers: the gear that comes nearest where none suits."""


def listing_of(order: Order, answers: Path, catalogue: Catalogue) -> Listing:
    """Listing of an order that was sized: of the axes as they were given, and of their answers."""
    first = _first(read_answers(answers))
    asked = _asked(order, first.filter(pc.is_null(first["error"]))[AXIS])
    lacking = asked.filter(pc.is_in(asked[AXIS], first.filter(pc.equal(first["suitable"], 0))[AXIS].combine_chunks()))
    misses, places = nearest_misses(lacking, catalogue), pc.index_in(first[AXIS], lacking[AXIS].combine_chunks())
    for field in NEAREST:
        first = first.append_column(field, misses[field.name].take(places))
    return Listing(summary_of(read_answers(answers)), first, asked)


class KeptListing(NamedTuple):
    """A listing to be kept: its tables are Parquet."""

    summary: Summary
    answers: bytes
    axes: bytes


def kept_listing_of(axes: Path, answers: Path, catalogue: Catalogue) -> KeptListing | None:
    """The same to be kept; None where more was asked than a page can read."""
    listing = listing_of(Order(axes, answers), answers, catalogue)
    if listing.axes.nbytes > MOST_BYTES:
        return None
    return KeptListing(listing.summary, as_parquet(listing.answers), as_parquet(listing.axes))


def as_parquet(table: pa.Table) -> bytes:
    """A table as a file."""
    sink = io.BytesIO()
    pq.write_table(table, sink, compression="zstd")
    return sink.getvalue()


def read_answers(path: Path) -> Iterator[pa.RecordBatch]:
    """Answers as a run has written them, with the names of the axes as text."""
    suffix = format_of(path)
    if suffix not in WITHOUT_UUIDS:
        axis = datasets.dataset(path, format=FORMATS[suffix]).schema.field(AXIS).type
        if is_uuid(axis):
            for batch in datasets.dataset(path, answer_fields(axis), FORMATS[suffix]).to_batches():
                yield batch.set_column(0, AXIS, text_of(batch.column(0)))
            return
    yield from datasets.dataset(path, answer_fields(pa.string()), FORMATS[suffix]).to_batches()


def _first(batches: Iterator[pa.RecordBatch]) -> pa.Table:
    pieces, count = [answer_fields(pa.string()).empty_table()], 0
    for batch in batches:
        pieces.append(pa.Table.from_batches([batch.slice(0, MOST_LISTED - count)]))
        count += pieces[-1].num_rows
        if count == MOST_LISTED:
            break
    return pa.concat_tables(pieces)


def _asked(order: Order, names: pa.ChunkedArray) -> pa.Table:
    """Axes of these names in list form, their names as text."""
    pieces, count, wanted = list[pa.Table](), 0, names.combine_chunks()
    for axes in axes_of(*open_tables(order)):
        rows = axes.rows.set_column(axes.rows.column_names.index(AXIS), AXIS, axes.rows[AXIS].cast(pa.string()))
        pieces.append(rows.filter(pc.is_in(rows[AXIS], wanted)))
        count += pieces[-1].num_rows
        if count == len(wanted):
            break
    return pa.concat_tables(pieces)


def nearest_misses(axes: pa.Table, catalogue: Catalogue) -> pa.Table:
    """The gear that `select` puts first for each of some sound axes that none suits, with what governs it."""
    read = Axes(axes, catalogue)
    found = dict[str, list[Any]]((name, [None] * axes.num_rows) for name in NEAREST.names)
    for gears, members in read.chunks():
        evaluation = evaluate(read.duty(members), gears, catalogue)
        best = _foremost(evaluation)
        used = np.take_along_axis(evaluation.utilisation, best, -1)[:, 0]
        governing = evaluation.governing_of(best[:, 0])
        for index, row in enumerate(read.places[members].tolist()):
            found["nearest"][row] = evaluation.gears.rows[best[index, 0]].designation
            if not np.isnan(used[index]):
                found["nearest_check"][row] = evaluation.checks[governing[index]].code
                found["nearest_utilisation"][row] = used.item(index) if np.isfinite(used[index]) else None
    return pa.table(found, NEAREST)


def _foremost(evaluation: Evaluation) -> PlaceArray:
    """Place of the first gear that is judged or lacks an input alone, of any if there is none, shape (N, 1)."""
    judged = evaluation.is_judged | evaluation.lacks_input
    first = np.take_along_axis(judged, evaluation.order, -1).argmax(axis=-1)[:, None]
    places: PlaceArray = np.take_along_axis(evaluation.order, first, -1)
    return places


def applications_of(axes: pa.Table) -> Iterator[tuple[str, Application]]:
    """Axes of a listing by name, as the models have them."""
    for cells in axes.to_pylist():
        yield cells[AXIS], Application.model_validate(COLUMNS.application_of(cells))


def rows_of(answers: pa.Table) -> list[AxisRow]:
    """The answers of a listing, row by row."""
    return [_row(place, **cells) for place, cells in enumerate(answers.to_pylist(), start=1)]


def _row(place: int, **cells: Any) -> AxisRow:
    nearest = [cells.pop(name) for name in NEAREST.names]
    if cells["error"] is not None:
        state: State = "rejected"
    else:
        state = "selected" if cells["selected"] else "unsuitable"
    shortest = cells.pop("shortest_life_h", None), cells.pop("shortest_life_of", "")
    cells["life"] = life_of(*shortest) if state == "selected" and shortest[1] != "" else None
    del cells["life_L10_h"]
    if state == "unsuitable":
        cells |= dict(zip(("selected", "governing_check", "utilisation"), nearest, strict=True))
    return AxisRow(place, cells.pop(AXIS) or "", state, cells.pop("selected"), **cells)

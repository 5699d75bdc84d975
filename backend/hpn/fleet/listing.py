"""Axes that a page or a report shows one by one: their answers and their inputs."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from hpn.account.readings import Life, life_of
from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.evaluation import Evaluation, PlaceArray, evaluate
from hpn.fleet.axes import Axes
from hpn.fleet.columns import AXIS, COLUMNS
from hpn.fleet.faults import Reason, reasons_of
from hpn.fleet.gathering import axes_of
from hpn.fleet.opened import open_axes
from hpn.fleet.order import Order
from hpn.fleet.outcome import FAULTS, answer_fields
from hpn.fleet.summary import AxisCounts, summary_of

MOST_LISTED = 10_000
"""Most axes that a page or a report shows one by one; the files have all."""

State = Literal["selected", "unsuitable", "rejected"]


@dataclass(frozen=True)
class Listing:
    """Counts over all axes, and the first axes. `answers` have the nearest miss where no gear suits; `axes` are the
    inputs of axes that were not rejected, in list form. Names of axes are text."""

    summary: AxisCounts
    answers: pa.Table
    axes: pa.Table


class AxisRow(NamedTuple):
    """Axis with its gear, or with the nearest miss where none suits; `place` counts the axes of the input from 1."""

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
    reasons: list[Reason]
    motor_torque_limit_Nm: float | None = None


NEAREST = pa.schema([("nearest", pa.string()), ("nearest_check", pa.string()), ("nearest_utilisation", pa.float64())])
"""Additional columns of the answers: the nearest gear where none suits."""


def listing_of(order: Order, answers: Iterator[pa.Table], catalogue: Catalogue) -> Listing:
    """Listing of a sized order, from its axes as they were given and from their answers."""
    pieces, count = [answer_fields(pa.string()).empty_table()], 0

    def noted() -> Iterator[pa.RecordBatch]:
        nonlocal count
        for table in answers:
            if count < MOST_LISTED:
                pieces.append(table.slice(0, MOST_LISTED - count))
                count += pieces[-1].num_rows
            yield from table.to_batches()

    summary = summary_of(noted())
    first = pa.concat_tables(pieces)
    open_axes = _open_axes(order, first.filter(pc.is_valid(first["suitable"]))[AXIS])
    return Listing(summary, with_nearest(first, open_axes, catalogue), open_axes)


def with_nearest(answers: pa.Table, open_axes: pa.Table, catalogue: Catalogue) -> pa.Table:
    """Answers with the nearest miss where no gear suits."""
    names = answers.filter(pc.equal(answers["suitable"], 0))[AXIS].combine_chunks()
    lacking = open_axes.filter(pc.is_in(open_axes[AXIS], names))
    misses, places = nearest_misses(lacking, catalogue), pc.index_in(answers[AXIS], lacking[AXIS].combine_chunks())
    for field in NEAREST:
        answers = answers.append_column(field, misses[field.name].take(places))
    return answers


def _open_axes(order: Order, names: pa.ChunkedArray) -> pa.Table:
    """Axes with these names in list form, their names as text."""
    pieces, count, chosen = list[pa.Table](), 0, names.combine_chunks()
    for axes in axes_of(open_axes(order.axes, order.ignored)):
        rows = axes.rows.set_column(axes.rows.column_names.index(AXIS), AXIS, axes.rows[AXIS].cast(pa.string()))
        pieces.append(rows.filter(pc.is_in(rows[AXIS], chosen)))
        count += pieces[-1].num_rows
        if count == len(chosen):
            break
    return pa.concat_tables(pieces)


def nearest_misses(axes: pa.Table, catalogue: Catalogue) -> pa.Table:
    """Gear that `select` puts first for each sound axis without a suitable gear, with its governing check."""
    batch = Axes(axes, catalogue)
    columns = dict[str, list[Any]]((name, [None] * axes.num_rows) for name in NEAREST.names)
    for gears, members in batch.chunks():
        evaluation = evaluate(batch.duty(members), gears, catalogue)
        best = _foremost(evaluation)
        used = np.take_along_axis(evaluation.utilisation, best, -1)[:, 0]
        governing = evaluation.governing_of(best[:, 0])
        for index, row in enumerate(batch.places[members].tolist()):
            columns["nearest"][row] = evaluation.gears.rows[best[index, 0]].designation
            if not np.isnan(used[index]):
                columns["nearest_check"][row] = evaluation.checks[governing[index]].code
                columns["nearest_utilisation"][row] = used.item(index) if np.isfinite(used[index]) else None
    return pa.table(columns, NEAREST)


def _foremost(evaluation: Evaluation) -> PlaceArray:
    """Place of the first gear that is judged or lacks only an input, else of the first gear, shape (N, 1)."""
    judged = evaluation.is_judged | evaluation.lacks_input
    first = np.take_along_axis(judged, evaluation.order, -1).argmax(axis=-1)[:, None]
    places: PlaceArray = np.take_along_axis(evaluation.order, first, -1)
    return places


def applications_of(axes: pa.Table) -> Iterator[tuple[str, Application]]:
    """Names and applications of the axes of a listing, in the form of the models."""
    for cells in axes.to_pylist():
        yield cells[AXIS], Application.model_validate(COLUMNS.application_of(cells))


def rows_of(answers: pa.Table) -> list[AxisRow]:
    """Answers of a listing as records, row by row."""
    return [_row(place, **cells) for place, cells in enumerate(answers.to_pylist(), start=1)]


NOT_LISTED = ("life_L10_h", "holds", "worst_utilisation", "worst_governing_check")
"""Columns of the answers that a line of the list does not show; older answers lack those of tolerances."""


def _row(place: int, **cells: Any) -> AxisRow:
    nearest = [cells.pop(name) for name in NEAREST.names]
    cells["reasons"] = reasons_of(cells.pop(FAULTS, None), cells.pop("error", None))
    if cells["reasons"]:
        state: State = "rejected"
    else:
        state = "selected" if cells["selected"] else "unsuitable"
    shortest = cells.pop("shortest_life_h", None), cells.pop("shortest_life_of", "")
    cells["life"] = life_of(*shortest) if state == "selected" and shortest[1] != "" else None
    for name in NOT_LISTED:
        cells.pop(name, None)
    if state == "unsuitable":
        cells |= dict(zip(("selected", "governing_check", "utilisation"), nearest, strict=True))
    return AxisRow(place, cells.pop(AXIS) or "", state, cells.pop("selected"), **cells)

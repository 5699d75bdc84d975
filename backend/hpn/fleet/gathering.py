"""Axes in list form from rows of tables: phases of long form are gathered."""

from bisect import bisect_left
from collections.abc import Iterator, Sequence
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from hpn.fleet.axes import BoolArray, IntArray
from hpn.fleet.columns import AXIS, COLUMNS, is_list
from hpn.fleet.faults import CellFault, of_phase
from hpn.fleet.tables import TOO_LONG, AxisTable, RowBatch, joined
from hpn.words.fields import MAXIMUM_PHASES
from hpn.words.wording import N_, Sentence

BROKEN_BEFORE = Sentence(N_("the line before can’t be read, and may belong to this axis"))
DIFFERS = Sentence(N_("must stand in the first row of an axis, or be the same in all of its rows"))


def axes_of(table: AxisTable) -> Iterator[RowBatch]:
    """Axes of a table in list form, some at a time."""
    return table.batches() if table.is_in_list_form else _gathered(_with_axes(table.batches()))


def slices(axes: RowBatch, most: int) -> Iterator[RowBatch]:
    """Axes, at most `most` at a time."""
    row_of = attrgetter("row")
    faults, begun = sorted(axes.faults, key=row_of), 0
    for start in range(0, axes.rows.num_rows, most):
        end = bisect_left(faults, start + most, begun, key=row_of)
        yield RowBatch(axes.rows.slice(start, most), [fault.moved(-start) for fault in faults[begun:end]])
        begun = end


# --- Long form --------------------------------------------------------------------------------------------------------


class _Last(NamedTuple):
    """Axis of the last row read, and whether that row is unreadable with its axis."""

    axis: Any = None
    is_broken: bool = False


def _with_axes(batches: Iterator[RowBatch]) -> Iterator[RowBatch]:
    """Rows that all have an axis. A line whose axis is unreadable counts for the axis before it; the line after it is a
    fault, since it may belong to either."""
    last = _Last()
    for batch in batches:
        if batch.rows.num_rows:
            batch, last = _with_axis(batch, last)
            yield batch


def _with_axis(batch: RowBatch, before: _Last) -> tuple[RowBatch, _Last]:
    count = batch.rows.num_rows
    axis = batch.rows[AXIS].combine_chunks()
    missing = np.asarray(pc.is_null(axis))
    broken = sorted({fault.row for fault in batch.faults if fault.column == AXIS and missing[fault.row]})
    suspected = [*([0] if before.is_broken else []), *(row + 1 for row in broken if row + 1 < count)]
    if broken:
        values = axis.to_pylist()
        for row in broken:
            values[row] = values[row - 1] if row else before.axis
        axis = pa.array(values, axis.type)
    last = _Last(axis[count - 1].as_py(), bool(broken) and broken[-1] == count - 1)
    if not broken and not suspected:
        return batch, last
    faults = [*batch.faults, *(CellFault(row, AXIS, BROKEN_BEFORE, "row_broken") for row in suspected)]
    return RowBatch(batch.rows.set_column(batch.rows.column_names.index(AXIS), AXIS, axis), faults), last


def _gathered(batches: Iterator[RowBatch]) -> Iterator[RowBatch]:
    """Axes from rows of phases: an axis ends where another begins."""
    rest: RowBatch | None = None
    for batch in batches:
        rows = batch if rest is None else joined([rest, batch])
        starts, count = run_starts(rows.rows[AXIS]), rows.rows.num_rows
        if len(starts) > 1:
            yield _as_lists(rows.between(0, int(starts[-1])), starts[:-1])
        last = int(starts[-1])
        rest = rows.between(last, min(count, last + MAXIMUM_PHASES + 1))  # the reason stays the same
    if rest is not None:
        yield _as_lists(rest, np.zeros(1, np.intp))


def run_starts(axis: pa.ChunkedArray) -> IntArray:
    """Rows where another axis begins; consecutive rows without an axis are one."""
    axis = pa.concat_arrays(axis.chunks) if isinstance(axis, pa.ChunkedArray) else axis
    one, following = axis.slice(0, len(axis) - 1), axis.slice(1)
    differs: BoolArray = np.asarray(pc.fill_null(pc.not_equal(one, following), False))
    differs = differs | (np.asarray(pc.is_null(one)) != np.asarray(pc.is_null(following)))
    return np.concatenate((np.zeros(1, np.intp), np.flatnonzero(differs) + 1))


def _shortened(batch: RowBatch, starts: IntArray) -> tuple[RowBatch, IntArray]:
    """Axes cut to one phase above the limit: their reason is the same however many of their rows were read at once."""
    counts = np.diff(np.append(starts, batch.rows.num_rows))
    if counts.max() <= MAXIMUM_PHASES + 1:
        return batch, starts
    mask = np.arange(batch.rows.num_rows) - np.repeat(starts, counts) <= MAXIMUM_PHASES
    moved = np.cumsum(mask) - 1
    faults = [fault._replace(row=int(moved[fault.row])) for fault in batch.faults if mask[fault.row]]
    return RowBatch(batch.rows.filter(pa.array(mask)), faults), moved[starts]


def _as_lists(batch: RowBatch, starts: IntArray) -> RowBatch:
    """Axes whose phases begin at given rows: columns of phases become lists, for others the first row counts."""
    batch, starts = _shortened(batch, starts)
    rows, first = batch.rows, pa.array(starts)
    ends = pa.array(np.append(starts, rows.num_rows).astype(np.int32))
    columns = [
        pa.ListArray.from_arrays(ends, rows[name].combine_chunks())
        if name in COLUMNS.phases
        else rows[name].take(first)
        for name in rows.column_names
    ]
    faults = [*_faults_of_axes(batch.faults, starts), *_differing(rows, starts)]
    return RowBatch(pa.Table.from_arrays(columns, names=rows.column_names), faults)


def _faults_of_axes(faults: Sequence[CellFault], starts: IntArray) -> Iterator[CellFault]:
    """Faults of rows as faults of axes, each once."""
    distinct = {(fault.row, fault.column, fault.reason.text): fault for fault in faults}
    for _, fault in sorted(distinct.items()):
        place = int(np.searchsorted(starts, fault.row, side="right")) - 1
        number = fault.row - int(starts[place]) + 1
        if (fault.column, fault.reason) != (AXIS, TOO_LONG):
            yield fault._replace(row=place, reason=of_phase(number, fault.reason))
        elif number == 1:  # all phases of an axis have its name
            yield fault._replace(row=place)


def _differing(rows: pa.Table, starts: IntArray) -> Iterator[CellFault]:
    """Faults of axes with two values of one input."""
    axis_of = np.repeat(np.arange(len(starts)), np.diff(np.append(starts, rows.num_rows)))
    for name in rows.column_names:
        if name == AXIS or name in COLUMNS.phases or rows[name].null_count == rows.num_rows:
            continue
        column = rows[name].combine_chunks()
        codes = _codes(column)
        other = np.asarray(pc.is_valid(column)) & (codes != codes[starts[axis_of]])
        yield from (CellFault(int(place), name, DIFFERS, "differs") for place in np.unique(axis_of[other]))


def _codes(column: pa.Array) -> IntArray:
    """Number for each cell, the same for equal cells."""
    if is_list(column.type):  # Arrow compares no lists
        numbers: dict[Any, int] = {}
        cells = (cell and tuple(cell) for cell in column.to_pylist())
        return np.array([numbers.setdefault(cell, len(numbers)) for cell in cells], np.intp)
    return np.asarray(pc.fill_null(column.dictionary_encode().indices, -1)).astype(np.intp)

"""From rows of tables to axes in list form: phases of long form are gathered, and the other table's columns joined."""

from bisect import bisect_left
from collections import deque
from collections.abc import Iterator, Sequence
from itertools import islice
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from hpn.fleet.axes import BoolArray, IntArray
from hpn.fleet.columns import AXIS, COLUMNS
from hpn.fleet.tables import TOO_LONG, Batch, Fault, Table, joined
from hpn.words.fields import MAXIMUM_PHASES
from hpn.words.wording import N_

WINDOW = 100_000
"""Axes up to which one that is missing from a table is looked for further on."""

BROKEN_BEFORE = N_("the line before can’t be read, and may belong to this axis")
NOT_BESIDE = N_("is missing from the table of --axes, or not in the order of the phases")
NO_PHASES = N_("has no phases in INPUT")


def axes_of(table: Table, others: Table | None = None) -> Iterator[Batch]:
    """Axes of a table in list form, some at a time, with their columns of the other table."""
    axes = table.batches() if table.is_in_list_form else _gathered(_with_axes(table.batches()))
    return axes if others is None else _with_others(axes, _no_axes(table), others)


def _no_axes(table: Table) -> pa.Table:
    kinds = {name: table.axis_type if name == AXIS else COLUMNS.all[name].type for name in table.names}
    return pa.schema(list(kinds.items())).empty_table()


def slices(axes: Batch, most: int) -> Iterator[Batch]:
    """Axes so many at a time."""
    row_of = attrgetter("row")
    faults, begun = sorted(axes.faults, key=row_of), 0
    for start in range(0, axes.rows.num_rows, most):
        end = bisect_left(faults, start + most, begun, key=row_of)
        yield Batch(axes.rows.slice(start, most), [fault.moved(-start) for fault in faults[begun:end]])
        begun = end


# --- Long form --------------------------------------------------------------------------------------------------------


class _Last(NamedTuple):
    """The last row that was read: its axis, and whether it can't be read, its axis included."""

    axis: Any = None
    is_broken: bool = False


def _with_axes(batches: Iterator[Batch]) -> Iterator[Batch]:
    """Rows of which each has an axis: a line that can't be read, its axis included, counts as one of the axis before
    it, and the line behind it may belong to either."""
    last = _Last()
    for batch in batches:
        if batch.rows.num_rows:
            batch, last = _filled(batch, last)
            yield batch


def _filled(batch: Batch, before: _Last) -> tuple[Batch, _Last]:
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
    faults = [*batch.faults, *(Fault(row, AXIS, BROKEN_BEFORE) for row in suspected)]
    return Batch(batch.rows.set_column(batch.rows.column_names.index(AXIS), AXIS, axis), faults), last


def _gathered(batches: Iterator[Batch]) -> Iterator[Batch]:
    """Axes of rows that are phases: an axis ends where another begins."""
    left: Batch | None = None
    for batch in batches:
        rows = batch if left is None else joined([left, batch])
        starts, count = run_starts(rows.rows[AXIS]), rows.rows.num_rows
        if len(starts) > 1:
            yield _listed(rows.between(0, int(starts[-1])), starts[:-1])
        last = int(starts[-1])
        left = rows.between(last, min(count, last + MAXIMUM_PHASES + 1))  # more would be too many all the same
    if left is not None:
        yield _listed(left, np.zeros(1, np.intp))


def run_starts(axis: pa.ChunkedArray) -> IntArray:
    """Rows where another axis begins; rows without an axis that lie together are one."""
    axis = pa.concat_arrays(axis.chunks) if isinstance(axis, pa.ChunkedArray) else axis
    one, following = axis.slice(0, len(axis) - 1), axis.slice(1)
    differs: BoolArray = np.asarray(pc.fill_null(pc.not_equal(one, following), False))
    differs = differs | (np.asarray(pc.is_null(one)) != np.asarray(pc.is_null(following)))
    return np.concatenate((np.zeros(1, np.intp), np.flatnonzero(differs) + 1))


def _shortened(batch: Batch, starts: IntArray) -> tuple[Batch, IntArray]:
    """The axes with one phase more than may be where they have more: the reason is the same, however many of their rows
    were read at once."""
    counts = np.diff(np.append(starts, batch.rows.num_rows))
    if counts.max() <= MAXIMUM_PHASES + 1:
        return batch, starts
    kept = np.arange(batch.rows.num_rows) - np.repeat(starts, counts) <= MAXIMUM_PHASES
    moved = np.cumsum(kept) - 1
    faults = [fault._replace(row=int(moved[fault.row])) for fault in batch.faults if kept[fault.row]]
    return Batch(batch.rows.filter(pa.array(kept)), faults), moved[starts]


def _listed(batch: Batch, starts: IntArray) -> Batch:
    """Axes whose phases begin at rows; the columns of the phases become lists."""
    batch, starts = _shortened(batch, starts)
    rows = batch.rows
    ends = pa.array(np.append(starts, rows.num_rows).astype(np.int32))
    columns = [
        rows[name].take(pa.array(starts))
        if name == AXIS
        else pa.ListArray.from_arrays(ends, rows[name].combine_chunks())
        for name in rows.column_names
    ]
    faults, given = [], sorted(set(batch.faults))
    places = np.searchsorted(starts, [fault.row for fault in given], side="right") - 1
    for fault, place, start in zip(given, places.tolist(), starts[places].tolist(), strict=True):
        number = fault.row - start + 1
        if (fault.column, fault.reason) != (AXIS, TOO_LONG):
            faults.append(Fault(place, fault.column, f"phase {number}: {fault.reason}"))
        elif number == 1:  # the name is that of all its phases
            faults.append(Fault(place, AXIS, TOO_LONG))
    return Batch(pa.Table.from_arrays(columns, names=rows.column_names), faults)


# --- The other columns ------------------------------------------------------------------------------------------------


def _with_others(axes: Iterator[Batch], no_axes: pa.Table, others: Table) -> Iterator[Batch]:
    """Axes with their other columns; both tables have them in one order, and one that a table lacks is a fault."""
    ahead = _Ahead(others)
    for batch in axes:
        left, right = _matched(_texts(batch.rows[AXIS]), ahead)
        taken = ahead.taken(max((place + 1 for place in right if place is not None), default=0))
        yield _beside(batch, taken, left, right)
    for batch in ahead.rest():
        count = batch.rows.num_rows
        yield _beside(Batch(no_axes), batch, [None] * count, range(count))


class _Ahead:
    """The rows of a table that have not been taken, as far as they were looked at."""

    def __init__(self, table: Table) -> None:
        self._batches = table.batches()
        self._held = Batch(table.empty)

    def _read_up_to(self, count: int) -> None:
        held = [self._held]
        while sum(batch.rows.num_rows for batch in held) < count and (more := next(self._batches, None)) is not None:
            held.append(more)
        self._held = joined(held) if len(held) > 1 else self._held

    def names(self, count: int) -> pa.Array:
        """The axes of the next rows as text, fewer at the end."""
        self._read_up_to(count)
        return _texts(self._held.rows[AXIS].slice(0, count))

    def each_name(self) -> Iterator[str | None]:
        """The axes of the rows one by one; they stay the next ones."""
        given = 0
        while given < len(self.names(given + 1)):
            more = _texts(self._held.rows[AXIS].slice(given)).to_pylist()
            given += len(more)
            yield from more

    def taken(self, count: int) -> Batch:
        """The next rows, which are gone from here."""
        held = self._held
        self._held = held.between(count, held.rows.num_rows)
        return held.between(0, count)

    def rest(self) -> Iterator[Batch]:
        """All rows that are left."""
        yield self._held
        yield from self._batches


def _texts(column: pa.ChunkedArray) -> pa.Array:
    """Axes as text, which those of any table can be compared as."""
    return pa.chunked_array([chunk.cast(pa.string()) for chunk in column.chunks], pa.string()).combine_chunks()


Places = Sequence[int | None]


def _matched(axes: pa.Array, ahead: _Ahead) -> tuple[Places, Places]:
    """Places in both tables, one beside the other; None where one lacks what the other has in this order."""
    if ahead.names(len(axes)).equals(axes):
        return range(len(axes)), range(len(axes))
    left, right, done = list[int | None](), list[int | None](), 0
    for axis, place in enumerate(_places(axes, ahead.each_name())):
        alone = range(done, done if place is None else place)
        left += [*(None for _ in alone), axis]
        right += [*alone, place]
        done = done if place is None else place + 1
    return left, right


def _places(axes: pa.Array, others: Iterator[str | None]) -> Iterator[int | None]:
    """Place of each axis in the other table behind the one before, up to WINDOW further on; None where there is none.

    One after another: the place of an axis depends on those before it alone.
    """
    where: dict[str | None, deque[int]] = {}
    read, done = 0, 0
    for axis in axes.to_pylist():
        for other in islice(others, done + WINDOW - read):
            where.setdefault(other, deque()).append(read)
            read += 1
        own = where.get(axis, deque())
        while own and own[0] < done:
            own.popleft()
        yield own[0] if own else None
        done = own[0] + 1 if own else done


def _beside(axes: Batch, others: Batch, left: Places, right: Places) -> Batch:
    """Axes with their other columns; one that a table lacks is a fault."""
    rows, beside = axes.rows.take(pa.array(left, pa.int64())), others.rows.take(pa.array(right, pa.int64()))
    faults = [Fault(row, AXIS, NOT_BESIDE) for row, place in enumerate(right) if place is None]  # the first to be read
    faults += [Fault(row, AXIS, NO_PHASES) for row, place in enumerate(left) if place is None]
    for places, given in ((left, axes.faults), (right, others.faults)):
        at = {row: place for place, row in enumerate(places)} if given else {}
        faults += [fault._replace(row=at[fault.row]) for fault in given if fault.row in at]
    if any(place is None for place in left):
        axis = pc.coalesce(rows[AXIS], _as_type(beside[AXIS], rows[AXIS].type))
        rows = rows.set_column(rows.column_names.index(AXIS), AXIS, axis)
    for name in beside.column_names:
        if name != AXIS:
            rows = rows.append_column(name, beside[name])
    return Batch(rows, faults)


def _as_type(axis: pa.ChunkedArray, wanted: pa.DataType) -> pa.ChunkedArray:
    """Axes of the other table in the type of the phases; null where one can't be of that type."""
    if axis.type.equals(wanted):
        return axis
    try:
        return axis.cast(wanted)
    except pa.ArrowException:
        return pa.chunked_array([_one_as_type(cell, wanted) for cell in axis], wanted)


def _one_as_type(axis: pa.Scalar, wanted: pa.DataType) -> pa.Array:
    try:
        return pa.array([axis.cast(wanted).as_py()], wanted)
    except pa.ArrowException:
        return pa.nulls(1, wanted)

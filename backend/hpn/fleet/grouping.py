"""From parts of tables to axes in list form: phases of long form are gathered, and their other columns joined."""

from bisect import bisect_right
from collections import deque
from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from hpn.fleet.axes import BoolArray, IntArray
from hpn.fleet.columns import AXIS, COLUMNS
from hpn.fleet.outcome import Fault
from hpn.fleet.tables import TOO_LONG, Batch, CellFault, Table
from hpn.words.fields import MAXIMUM_PHASES
from hpn.words.wording import N_

PART_PHASES, PART_AXES, PART_BYTES = 600_000, 60_000, 8_000_000
"""Size of a part, in rows of long and of list form and in bytes of lines: some tenths of a second of work."""

WINDOW = 100_000
"""Axes up to which one that is missing from a table is looked for further on."""

BROKEN_BEFORE = N_("the line before can’t be read, and may belong to this axis")


class Part(NamedTuple):
    """Units of a table of axes from `first` up to `end`.

    `others` says where the rows of the other table that belong to them begin, by unit and row, and how many they are.
    """

    first: int
    end: int
    others: tuple[int, int, int] = (0, 0, 0)


class Listed(NamedTuple):
    """Some axes in list form, and what is wrong with them already."""

    rows: pa.Table
    faults: Sequence[Fault] = ()


def parts_of(table: Table) -> list[Part]:
    """Parts that are worked on one by one: they depend on the file alone."""
    most = PART_BYTES if table.measured_in == "B" else PART_AXES if table.is_in_list_form else PART_PHASES
    parts, first, rows = [], 0, 0
    for unit, count in enumerate(table.unit_sizes):
        if rows and rows + count > most:
            parts.append(Part(first, unit))
            first, rows = unit, 0
        rows += count
    return [*parts, Part(first, len(table.unit_sizes))]


def axes_of(table: Table, part: Part, others: Table | None = None) -> Iterator[Listed]:
    """Axes that begin in a part, in list form."""
    if table.is_in_list_form:
        names = list(table.names)
        for unit in range(part.first, part.end):
            for batch in table.read(unit, names):
                yield Listed(batch.rows, [Fault(*fault) for fault in batch.faults])
        return
    pieces = list(_gathered(_own_rows(table, part, list(table.names))))
    rows = pa.concat_tables([piece.rows for piece in pieces] or [_no_axes(table)])
    starts = np.cumsum([0, *(piece.rows.num_rows for piece in pieces)])
    faults = [fault.moved(int(start)) for start, piece in zip(starts, pieces, strict=False) for fault in piece.faults]
    listed = Listed(rows, faults)
    yield listed if others is None else _joined(listed, _rows_of(others, *part.others))


def _no_axes(table: Table) -> pa.Table:
    kinds = {name: table.axis_type if name == AXIS else COLUMNS.all[name].type for name in table.names}
    return pa.schema(list(kinds.items())).empty_table()


# --- Long form --------------------------------------------------------------------------------------------------------


class _Before(NamedTuple):
    """The row before some rows: its axis, and whether it can't be read, its axis included; `is_read` once one can."""

    axis: Any = None
    is_broken: bool = False
    is_read: bool = False


def _own_rows(table: Table, part: Part, names: Sequence[str]) -> Iterator[Batch]:
    """Rows of the axes that begin in a part, also those that lie in the units behind it.

    A line that can't be read, its axis included, counts as one of the axis before it, and the line behind it may belong
    to either. What lies before a batch goes along with it, so that no end of a batch, a unit or a part changes that.
    """
    last, own = _before(table, part.first), None
    leading = last
    for unit in range(part.first, len(table.unit_sizes)):
        if unit >= part.end and own is None:
            return
        for batch in table.read(unit, names):
            given, last = _filled(batch, last)
            if own is None and leading is not None:
                given = _from(given, _leading(given.rows, leading.axis))
            count = given.rows.num_rows
            whole = count if unit < part.end or own is None else _leading(given.rows, own.axis)
            if whole:
                given, own = _until(given, whole), _Before(given.rows[AXIS][whole - 1].as_py())
                yield given
            if whole < count:
                return


def _before(table: Table, unit: int) -> _Before | None:
    """The last row before a unit, None where there is none: it has the axis of the last one before that can be read."""
    last: _Before | None = None
    for earlier in reversed(range(unit)):
        found: _Before | None = None
        for batch in table.read(earlier, [AXIS]):
            _, found = _filled(batch, found)
        if found is not None:
            last = found if last is None else last._replace(axis=found.axis, is_read=found.is_read)
            if last.is_read:
                break
    return last


def _filled(batch: Batch, before: _Before | None) -> tuple[Batch, _Before | None]:
    """The batch with the axis of the row before where a line can't be read, and its last row; the row behind such a
    line is under suspicion."""
    count = batch.rows.num_rows
    if not count:
        return batch, before
    axis = batch.rows[AXIS].combine_chunks()
    missing = np.asarray(pc.is_null(axis))
    broken = sorted({fault.row for fault in batch.faults if fault.column == AXIS and missing[fault.row]})
    suspected = [row + 1 for row in broken if row + 1 < count]
    if before is not None and before.is_broken:
        suspected.insert(0, 0)
    is_read = len(broken) < count or (before is not None and before.is_read)
    if broken:
        values = axis.to_pylist()
        for row in broken:
            values[row] = values[row - 1] if row else (None if before is None else before.axis)
        axis = pa.array(values, axis.type)
    last = _Before(axis[count - 1].as_py(), bool(broken) and broken[-1] == count - 1, is_read)
    if not broken and not suspected:
        return batch, last
    faults = [*batch.faults, *(CellFault(row, AXIS, BROKEN_BEFORE) for row in suspected)]
    return Batch(batch.rows.set_column(batch.rows.column_names.index(AXIS), AXIS, axis), faults), last


def _leading(rows: pa.Table, axis: Any) -> int:
    """How many rows at the beginning belong to an axis."""
    column = rows[AXIS]
    same = pc.is_null(column) if axis is None else pc.fill_null(pc.equal(column, pa.scalar(axis, column.type)), False)
    other = np.flatnonzero(~np.asarray(same))
    return int(other[0]) if len(other) else rows.num_rows


def _from(batch: Batch, start: int) -> Batch:
    faults = [fault._replace(row=fault.row - start) for fault in batch.faults if fault.row >= start]
    return Batch(batch.rows.slice(start), faults)


def _until(batch: Batch, end: int) -> Batch:
    return Batch(batch.rows.slice(0, end), [fault for fault in batch.faults if fault.row < end])


def _gathered(batches: Iterator[Batch]) -> Iterator[Listed]:
    """Axes of rows that are phases: an axis ends where another begins."""
    left: Batch | None = None
    for batch in batches:
        joined = batch if left is None else _appended(left, batch)
        starts = run_starts(joined.rows[AXIS])
        if len(starts) > 1:
            yield _listed(_until(joined, int(starts[-1])), starts[:-1])
        left = _until(_from(joined, int(starts[-1])), MAXIMUM_PHASES + 1)  # more would be too many all the same
    if left is not None:
        yield _listed(left, np.zeros(1, np.intp))


def _appended(left: Batch, right: Batch) -> Batch:
    count = left.rows.num_rows
    faults = [fault._replace(row=fault.row + count) for fault in right.faults]
    return Batch(pa.concat_tables([left.rows, right.rows]), [*left.faults, *faults])


def run_starts(axis: pa.ChunkedArray) -> IntArray:
    """Rows where another axis begins; rows without an axis that lie together are one."""
    axis = pa.concat_arrays(axis.chunks) if isinstance(axis, pa.ChunkedArray) else axis
    one, following = axis.slice(0, len(axis) - 1), axis.slice(1)
    differs: BoolArray = np.asarray(pc.fill_null(pc.not_equal(one, following), False))
    differs = differs | (np.asarray(pc.is_null(one)) != np.asarray(pc.is_null(following)))
    return np.concatenate((np.zeros(1, np.intp), np.flatnonzero(differs) + 1))


def _shortened(batch: Batch, starts: IntArray) -> tuple[Batch, IntArray]:
    """The axes with one phase more than may be where they have more: what is said of them is the same all the same,
    however many of their rows were read at once."""
    counts = np.diff(np.append(starts, batch.rows.num_rows))
    if not len(counts) or counts.max() <= MAXIMUM_PHASES + 1:
        return batch, starts
    kept = np.arange(batch.rows.num_rows) - np.repeat(starts, counts) <= MAXIMUM_PHASES
    moved = np.cumsum(kept) - 1
    faults = [fault._replace(row=int(moved[fault.row])) for fault in batch.faults if kept[fault.row]]
    return Batch(batch.rows.filter(pa.array(kept)), faults), moved[starts]


def _listed(batch: Batch, starts: IntArray) -> Listed:
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
    return Listed(pa.Table.from_arrays(columns, names=rows.column_names), faults)


# --- The other columns ------------------------------------------------------------------------------------------------


def with_others(table: Table, parts: Sequence[Part], others: Table) -> list[Part]:
    """The parts with the rows of the other table that belong to each: both tables have their axes in one order.

    Where axes are missing from one of them, those of a part reach as far as the last that both have.
    """
    stream, placed = _AxisStream(others), list[Part]()
    for part in parts:
        ids = _texts([piece.rows[AXIS] for piece in _gathered(_own_rows(table, part, [AXIS]))])
        count = len(ids)
        if not stream.ahead(count).equals(ids):
            places = [place for place in _places(ids, stream.following()) if place is not None]
            count = places[-1] + 1 if places else 0
        placed.append(part._replace(others=(*stream.place, count)))
        stream.drop(count)
    unit, row, count = placed[-1].others
    placed[-1] = placed[-1]._replace(others=(unit, row, count + stream.rest()))
    return placed


def _places(axes: pa.Array, others: Iterator[str | None]) -> list[int | None]:
    """Where each axis stands in the other table behind the one before, up to WINDOW further on; None where it doesn't.

    One after another: what comes of an axis depends on those before it alone, not on the part that it lies in.
    """
    where: dict[str | None, deque[int]] = {}
    places, read, done = list[int | None](), 0, 0
    for axis in axes.to_pylist():
        for other in islice(others, done + WINDOW - read):
            where.setdefault(other, deque()).append(read)
            read += 1
        own = where.get(axis, deque())
        while own and own[0] < done:
            own.popleft()
        places.append(own[0] if own else None)
        done = own[0] + 1 if own else done
    return places


def _texts(columns: Sequence[pa.ChunkedArray]) -> pa.Array:
    """Axes as text, which those of any table can be compared as."""
    return pa.chunked_array(
        [chunk.cast(pa.string()) for column in columns for chunk in column.chunks], pa.string()
    ).combine_chunks()


class _AxisStream:
    """The axes of a table one after another as text, some of them at a time."""

    def __init__(self, table: Table) -> None:
        self._starts = [0]
        self._batches = self._read(table)
        self._held = _texts([])
        self._done = 0

    def _read(self, table: Table) -> Iterator[pa.Array]:
        for unit in range(len(table.unit_sizes)):
            rows = 0
            for batch in table.read(unit, [AXIS]):
                rows += batch.rows.num_rows
                yield _texts([batch.rows[AXIS]])
            self._starts.append(self._starts[-1] + rows)

    @property
    def place(self) -> tuple[int, int]:
        """Unit and row in it of the next axis."""
        unit = bisect_right(self._starts, self._done) - 1
        return unit, self._done - self._starts[unit]

    def ahead(self, count: int) -> pa.Array:
        """The next axes, fewer at the end."""
        held = [self._held]
        while sum(map(len, held)) < count and (batch := next(self._batches, None)) is not None:
            held.append(batch)
        self._held = pa.concat_arrays(held)
        return self._held.slice(0, count)

    def following(self) -> Iterator[str | None]:
        """The next axes one by one; they stay the next ones."""
        given = 0
        while given < len(self.ahead(given + 1)):
            more = self._held.slice(given).to_pylist()
            given += len(more)
            yield from more

    def drop(self, count: int) -> None:
        """Go on behind the next axes."""
        self._held, self._done = self._held.slice(count), self._done + count

    def rest(self) -> int:
        """How many there are still."""
        return len(self._held) + sum(map(len, self._batches))


def _rows_of(table: Table, unit: int, row: int, count: int) -> Listed:
    """Some rows of a table, from a row of a unit on."""
    names, pieces, faults, held = list(table.names), list[pa.Table](), list[Fault](), 0
    for batch in (batch for place in range(unit, len(table.unit_sizes)) for batch in table.read(place, names)):
        first, last = min(row, batch.rows.num_rows), min(row + count - held, batch.rows.num_rows)
        row -= first
        if first < last:
            pieces.append(batch.rows.slice(first, last - first))
            faults += [Fault(f.row - first + held, f.column, f.reason) for f in batch.faults if first <= f.row < last]
            held += last - first
        if held >= count:
            break
    schema = pa.schema([(name, table.type_of(name)) for name in names])
    return Listed(pa.concat_tables(pieces) if pieces else schema.empty_table(), faults)


NOT_BESIDE = N_("is missing from the table of --axes, or not in the order of the phases")
NO_PHASES = N_("has no phases in INPUT")


def _joined(listed: Listed, others: Listed) -> Listed:
    """Axes with their other columns; one that a table lacks is a fault."""
    left, right = _matched(_texts([listed.rows[AXIS]]), _texts([others.rows[AXIS]]))
    rows, beside = listed.rows.take(pa.array(left, pa.int64())), others.rows.take(pa.array(right, pa.int64()))
    faults = [Fault(row, AXIS, NOT_BESIDE) for row, place in enumerate(right) if place is None]  # first: they are told
    faults += [Fault(row, AXIS, NO_PHASES) for row, place in enumerate(left) if place is None]
    for places, given in ((left, listed.faults), (right, others.faults)):
        at = {row: place for place, row in enumerate(places)}
        faults += [Fault(at[fault.row], fault.column, fault.reason) for fault in given if fault.row in at]
    if any(place is None for place in left):
        axis = pc.coalesce(rows[AXIS], _as_type(beside[AXIS], rows[AXIS].type))
        rows = rows.set_column(rows.column_names.index(AXIS), AXIS, axis)
    for name in beside.column_names:
        if name != AXIS:
            rows = rows.append_column(name, beside[name])
    return Listed(rows, faults)


def _matched(axes: pa.Array, others: pa.Array) -> tuple[list[int | None], list[int | None]]:
    """Places of both tables, one beside the other; None where one lacks what the other has in this order."""
    if axes.equals(others):
        return list(range(len(axes))), list(range(len(axes)))
    left, right, done = list[int | None](), list[int | None](), 0
    for axis, place in enumerate(_places(axes, iter(others.to_pylist()))):
        alone = range(done, done if place is None else place)
        left += [*(None for _ in alone), axis]
        right += [*alone, place]
        done = done if place is None else place + 1
    left += [None] * (len(others) - done)
    right += range(done, len(others))
    return left, right


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

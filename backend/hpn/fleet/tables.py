"""Tables of axes in files: Parquet, Arrow IPC, CSV and NDJSON, read unit by unit.

A unit can be read on its own: a row group, a record batch, a stretch of lines. What is read has the columns of
`columns.py` in their types. A cell that is none is null and a fault; the file goes on.
"""

import json
import re
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property
from operator import attrgetter
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
import pyarrow.types as kinds
from numpy.typing import NDArray

from hpn.fleet.columns import AXIS, COLUMNS, Column, is_list, is_text, plain_type
from hpn.fleet.errors import FleetError
from hpn.words.wording import N_

BATCH_ROWS = 16_384
"""Rows that are read at once."""


LONGEST_TEXT = 1000
"""Characters of a text: axes come back in every file, and what is wrong in its reason."""

TOO_LONG = f"must have at most {LONGEST_TEXT} characters"
NOT_WHOLE = N_("must be text or a whole number")
INDEX = re.compile("__index_level_[0-9]+__")
UNREADABLE = (pa.ArrowException, OSError, UnicodeDecodeError)
"""What Arrow raises for a file that it can't read."""


ARROW_MARK = b"ARROW1"
"""What an Arrow file begins with; a stream does not."""

MOST_HELD_BYTES = 500_000_000
"""Bytes of a table that has to be held as a whole: an Arrow stream, or what a gzip file unfolds to."""


class CellFault(NamedTuple):
    """A cell that can't be read: the row of its batch, its column, and what would be right."""

    row: int
    column: str
    reason: str


row_of = attrgetter("row")
"""Row of a fault, by which faults are sorted."""


class Batch(NamedTuple):
    """Some rows of a table, and what is wrong with their cells."""

    rows: pa.Table
    faults: Sequence[CellFault] = ()


def _with_short_texts(batch: Batch) -> Batch:
    rows, faults = batch.rows, list(batch.faults)
    for place, name in enumerate(batch.rows.column_names):
        column = batch.rows[name]
        long = _too_long(column.combine_chunks() if column.num_chunks != 1 else column.chunk(0))
        if long.any():
            is_axis = name == AXIS
            cut = (
                pc.utf8_slice_codeunits(column, 0, LONGEST_TEXT)
                if is_axis
                else pc.if_else(pa.array(long), None, column)
            )
            rows = rows.set_column(place, name, cut)
            faults += (CellFault(int(row), name, TOO_LONG) for row in np.flatnonzero(long))
    return Batch(rows, faults)


def _too_long(column: pa.Array) -> NDArray[np.bool_]:
    """Cells that are such a text, or a list with one."""
    found = np.zeros(len(column), np.bool_)
    if is_text(column.type):
        found |= np.asarray(pc.fill_null(pc.greater(pc.utf8_length(column), LONGEST_TEXT), False))
    elif is_list(column.type) and is_text(column.type.value_type):
        items = _too_long(pc.list_flatten(column))
        found[np.asarray(pc.list_parent_indices(column))[items]] = True
    return found


class Table(ABC):
    """A table of axes in a file. Raises FleetError, which names the file, where it can't be read."""

    def __init__(self, path: Path, ignored: Sequence[str] = ()) -> None:
        self.path = path
        self.ignored = tuple(ignored)

    @property
    def names(self) -> Sequence[str]:
        """Names of the columns that are read."""
        return [name for name in self.all_names if name not in self.ignored]

    @property
    @abstractmethod
    def all_names(self) -> Sequence[str]:
        """Names of the columns."""

    @property
    def indices(self) -> Sequence[str]:
        """Columns that pandas wrote of an index without a meaning, as far as the format tells."""
        return [name for name in self.all_names if INDEX.fullmatch(name)]

    @property
    @abstractmethod
    def is_in_list_form(self) -> bool:
        """Whether a row is an axis, with lists of phases; else a row is a phase."""

    @property
    @abstractmethod
    def axis_type(self) -> pa.DataType:
        """Type of the axes: text or integers."""

    @cached_property
    @abstractmethod
    def unit_sizes(self) -> Sequence[int]:
        """Size of each unit, in rows or bytes."""

    measured_in = "rows"
    """What sizes count."""

    def read(self, unit: int, names: Sequence[str]) -> Iterator[Batch]:
        """Some columns of a unit; a text that is too long is a fault, and of an axis its beginning stays."""
        return map(_with_short_texts, self._batches(unit, names))

    @abstractmethod
    def _batches(self, unit: int, names: Sequence[str]) -> Iterator[Batch]:
        """Some columns of a unit, as they stand."""

    def type_of(self, name: str) -> pa.DataType:
        """Type that a column is read as."""
        if name == AXIS:
            return self.axis_type
        column = COLUMNS.all[name]
        return column.type if self.is_in_list_form or name not in COLUMNS.phases else column.type.value_type

    def unreadable(self, error: Exception, where: str = "") -> FleetError:
        """What is said of a file that can't be read."""
        what = str(error).strip().partition("\n")[0]
        return FleetError(f"{self.path}: {where}can’t be read as {self.path.suffix[1:]}: {what}")


class TypedTable(Table):
    """A table whose columns have types: Parquet or Arrow IPC."""

    @property
    @abstractmethod
    def given(self) -> pa.Schema:
        """Columns with their types, as they stand."""

    @property
    def indices(self) -> Sequence[str]:
        try:
            told = json.loads((self.given.metadata or {}).get(b"pandas", b"{}"))["index_columns"]
        except (ValueError, TypeError, KeyError, RecursionError):
            told = []
        named = [name for name in told if isinstance(name, str)] if isinstance(told, list) else []
        return [name for name in self.all_names if name in named or INDEX.fullmatch(name)]

    @property
    def all_names(self) -> Sequence[str]:
        try:
            names: Sequence[str] = self.given.names
        except UnicodeDecodeError as error:
            raise self.unreadable(error) from None
        return names

    @property
    def is_in_list_form(self) -> bool:
        return "torque_Nm" in self.names and is_list(self.given.field("torque_Nm").type)

    @property
    def axis_type(self) -> pa.DataType:
        given = plain_type(self.given.field(AXIS).type)
        if _may_be_whole(given):
            return pa.int64()
        return pa.string() if kinds.is_null(given) else given

    @contextmanager
    def _told(self, where: str = "") -> Iterator[None]:
        """Raise FleetError in place of what Arrow says of a file, but for memory: that is of the machine."""
        try:
            yield
        except MemoryError:
            raise
        except UNREADABLE as error:
            raise self.unreadable(error, where) from None

    def wrong_types(self) -> Iterator[str]:
        """Columns whose type can't hold what belongs into them, in words."""
        known = (name for name in self.names if name == AXIS or name in COLUMNS.all)
        return filter(None, map(self.wrong_type, known))

    def wrong_type(self, name: str) -> str:
        """What is wrong with the type of a column, in words; nothing where it can be read."""
        given = self.given.field(name).type
        if name == AXIS:
            is_right = is_text(self.axis_type) or kinds.is_integer(self.axis_type)
            wanted = "text or integers"
        else:
            column = COLUMNS.all[name]
            is_right = column.takes(given, self.type_of(name))
            wanted = _words(column, self.type_of(name))
        return "" if is_right else f"column {name} is {given!s:.80}, where {wanted} belong"

    def _batch(self, rows: pa.RecordBatch, names: Sequence[str]) -> Batch:
        columns, faults = [], list[CellFault]()
        for name in names:
            column = _plain(rows.column(rows.schema.get_field_index(name)))
            if name == AXIS and _may_be_whole(column.type):
                column, wrong = _whole(column)
                faults += (CellFault(int(row), AXIS, NOT_WHOLE) for row in np.flatnonzero(wrong))
            columns.append(_cast(column, self.type_of(name)))
        return Batch(pa.Table.from_arrays(columns, names=list(names)), faults)


def _words(column: Column, wanted: pa.DataType) -> str:
    item = "texts" if column.kind == "string" else "numbers"
    return f"lists of {item}" if is_list(wanted) else item


def _plain(column: pa.Array) -> pa.Array:
    """The values themselves, in the type that `plain_type` says."""
    given = column.type
    if kinds.is_dictionary(given):
        return _plain(column.dictionary).take(column.indices)
    if kinds.is_run_end_encoded(given):
        return _plain(pc.run_end_decode(column))
    if is_list(given) and not given.equals(plain_type(given)):
        lengths = pc.list_value_length(column)
        ends = np.cumsum([0, *np.asarray(pc.fill_null(lengths, 0))])
        items = _plain(pc.list_flatten(column))
        return pa.ListArray.from_arrays(pa.array(ends, pa.int32()), items, mask=pc.is_null(lengths))
    return column.cast(pa.string()) if kinds.is_string_view(given) else column


def _cast(column: pa.Array, wanted: pa.DataType) -> pa.Array:
    """The column in a type; decimals by their digits, which Arrow's own cast misses by a last bit in one of eight."""
    given = column.type
    if is_list(given) and kinds.is_decimal(given.value_type):
        column = column.cast(pa.list_(pa.string()))
    elif kinds.is_decimal(given) and kinds.is_floating(wanted):
        column = column.cast(pa.string())
    return column if column.type.equals(wanted) else column.cast(wanted, safe=False)


def _may_be_whole(given: pa.DataType) -> bool:
    """Whether axes of a type can be integers though it is none: floats, as pandas makes of integers with a gap."""
    return bool(kinds.is_floating(given) or (kinds.is_decimal(given) and given.scale == 0))


def _whole(column: pa.Array) -> tuple[pa.Array, NDArray[np.bool_]]:
    """The column with null where a number is not whole, and which are not."""
    values = column.cast(pa.float64(), safe=False).to_numpy(zero_copy_only=False)
    wrong = np.asarray(column.is_valid()) & ~((values == np.floor(values)) & (np.abs(values) < 2.0**63))
    return pc.if_else(pa.array(wrong), None, column), wrong


class ParquetTable(TypedTable):
    """A Parquet file; its units are its row groups."""

    @cached_property
    def _file(self) -> pq.ParquetFile:
        with self._told():
            return pq.ParquetFile(self.path)

    @property
    def given(self) -> pa.Schema:
        return self._file.schema_arrow

    @cached_property
    def unit_sizes(self) -> Sequence[int]:
        metadata = self._file.metadata
        return [metadata.row_group(unit).num_rows for unit in range(metadata.num_row_groups)]

    def _batches(self, unit: int, names: Sequence[str]) -> Iterator[Batch]:
        with self._told(f"row group {unit + 1} "):
            for rows in self._file.iter_batches(BATCH_ROWS, [unit], list(names), use_threads=False):
                rows.validate(full=True)  # texts are taken as they stand, UTF-8 or not
                yield self._batch(rows, names)


class ArrowTable(TypedTable):
    """Arrow IPC; its units are its record batches. Those of a stream, which has no list of them, are held."""

    @cached_property
    def _file(self) -> pa.RecordBatchFileReader:
        with self._told():
            return pa.ipc.open_file(pa.OSFile(str(self.path)))

    @cached_property
    def _is_file(self) -> bool:
        with open(self.path, "rb") as file:
            return file.read(len(ARROW_MARK)) == ARROW_MARK

    @cached_property
    def _stream(self) -> tuple[pa.Schema, list[pa.RecordBatch]]:
        batches, size = list[pa.RecordBatch](), 0
        with self._told(), pa.ipc.open_stream(pa.OSFile(str(self.path))) as stream:
            for batch in stream:
                size += batch.nbytes
                if size > MOST_HELD_BYTES:
                    raise FleetError(
                        f"{self.path}: an Arrow stream may hold {MOST_HELD_BYTES:,} bytes; write Arrow’s file format "
                        "for more, or Parquet"
                    )
                batches.append(batch)
            return stream.schema, batches

    @property
    def given(self) -> pa.Schema:
        return self._file.schema if self._is_file else self._stream[0]

    @cached_property
    def unit_sizes(self) -> Sequence[int]:
        if not self._is_file:
            return [batch.num_rows for batch in self._stream[1]]
        return [self._read(unit).num_rows for unit in range(self._file.num_record_batches)]

    def _batches(self, unit: int, names: Sequence[str]) -> Iterator[Batch]:
        rows = self._read(unit)
        for start in range(0, rows.num_rows, BATCH_ROWS):
            yield self._batch(rows.slice(start, BATCH_ROWS), names)

    def _read(self, unit: int) -> pa.RecordBatch:
        with self._told(f"record batch {unit + 1} "):
            batch = self._file.get_batch(unit) if self._is_file else self._stream[1][unit]
            batch.validate(full=True)
        return batch

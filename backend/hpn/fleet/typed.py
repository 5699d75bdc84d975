"""Tables of axes with typed columns: Parquet and Arrow IPC."""

import json
from abc import abstractmethod
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
import pyarrow.types as kinds
from numpy.typing import NDArray

from hpn.fleet.columns import AXIS, INDEX, TEXTS, InputColumn, is_list, is_text, plain_type
from hpn.fleet.faults import CellFault
from hpn.fleet.tables import AxisTable, Progress, RowBatch
from hpn.fleet.uuids import is_uuid, text_of
from hpn.words.wording import N_, Sentence

NOT_WHOLE = Sentence(N_("must be text or a whole number"))
UNREADABLE = (pa.ArrowException, OSError, UnicodeDecodeError)
"""Errors of Arrow for an unreadable file."""

FILE_MARK = b"ARROW1"
"""Beginning of an Arrow file; a stream begins otherwise."""


class TypedTable(AxisTable):
    """Table with typed columns."""

    @property
    @abstractmethod
    def schema(self) -> pa.Schema:
        """Columns with their types in the file."""

    @property
    def indices(self) -> Sequence[str]:
        try:
            named = json.loads((self.schema.metadata or {}).get(b"pandas", b"{}"))["index_columns"]
        except (ValueError, TypeError, KeyError, RecursionError):
            named = []
        named = named if isinstance(named, list) else []
        return [name for name in self.all_names if name in named or INDEX.fullmatch(name)]

    @property
    def all_names(self) -> Sequence[str]:
        try:
            names: Sequence[str] = self.schema.names
        except UnicodeDecodeError as error:
            raise self.unreadable(error) from None
        return names

    @property
    def is_in_list_form(self) -> bool:
        return "torque_Nm" in self.names and is_list(self.schema.field("torque_Nm").type)

    @property
    def axis_type(self) -> pa.DataType:
        type = plain_type(self.schema.field(AXIS).type)
        if _may_be_whole(type):
            return pa.int64()
        return pa.string() if kinds.is_null(type) else type

    @property
    def written_axis_type(self) -> pa.DataType:
        type = self.schema.field(AXIS).type
        return type if is_uuid(type) else self.axis_type

    @contextmanager
    def readable(self, where: str = "") -> Iterator[None]:
        """Raise FleetError in place of Arrow's errors of a file; an error of memory is the machine's, and passes."""
        try:
            yield
        except MemoryError:
            raise
        except UNREADABLE as error:
            raise self.unreadable(error, where) from None

    def type_of(self, name: str) -> pa.DataType:
        """Arrow type of a column in the rows; a column that may be by size keeps its own kind, numbers or texts."""
        declared = super().type_of(name)
        if name == AXIS or not self.columns[name].by_size or is_text(plain_type(self.schema.field(name).type)):
            return declared
        return pa.float64()

    def wrong_type(self, name: str) -> str:
        if name != AXIS and name not in self.columns:
            return ""
        type = self.schema.field(name).type
        if name == AXIS:
            is_right = is_text(self.axis_type) or kinds.is_integer(self.axis_type)
            words = "text, integers or UUIDs"
        else:
            column = self.columns[name]
            is_right = column.takes(type, self.type_of(name))
            words = _words(column, self.type_of(name))
        return "" if is_right else f"column {name} is {type!s:.80}, where {words} belong"

    def batch(self, rows: pa.RecordBatch) -> RowBatch:
        """Rows in their Arrow types, with the faults of axes that are not whole."""
        columns, faults = [], list[CellFault]()
        for name in self.names:
            column = _plain(rows.column(rows.schema.get_field_index(name)))
            if name == AXIS and _may_be_whole(column.type):
                column, wrong = _whole(column)
                faults += (CellFault(int(row), AXIS, NOT_WHOLE, "axis_type") for row in np.flatnonzero(wrong))
            columns.append(_cast(column, self.type_of(name)))
        return RowBatch(pa.Table.from_arrays(columns, names=list(self.names)), faults)


def _words(column: InputColumn, type: pa.DataType) -> str:
    item = "texts" if column.kind in TEXTS else "numbers, or objects by size in JSON," if column.by_size else "numbers"
    return f"lists of {item}" if is_list(type) else item


def _plain(column: pa.Array) -> pa.Array:
    """Plain values of a column, in the type of `plain_type`."""
    type = column.type
    if kinds.is_dictionary(type):
        return _plain(column.dictionary).take(column.indices)
    if kinds.is_run_end_encoded(type):
        return _plain(pc.run_end_decode(column))
    if is_list(type) and not type.equals(plain_type(type)):
        lengths = pc.list_value_length(column)
        ends = np.cumsum([0, *np.asarray(pc.fill_null(lengths, 0))])
        items = _plain(pc.list_flatten(column))
        return pa.ListArray.from_arrays(pa.array(ends, pa.int32()), items, mask=pc.is_null(lengths))
    if is_uuid(type):
        return text_of(column)
    return column.cast(pa.string()) if kinds.is_string_view(type) else column


def _cast(column: pa.Array, target: pa.DataType) -> pa.Array:
    """Column in a type; decimals by their digits, since Arrow's own cast misses the last bit in one of eight."""
    type = column.type
    if is_list(type) and kinds.is_decimal(type.value_type):
        column = column.cast(pa.list_(pa.string()))
    elif kinds.is_decimal(type) and kinds.is_floating(target):
        column = column.cast(pa.string())
    return column if column.type.equals(target) else column.cast(target, safe=False)


def _may_be_whole(type: pa.DataType) -> bool:
    """True for a numeric type of axes that may hold integers: pandas makes floats of integers with a gap."""
    return bool(kinds.is_floating(type) or (kinds.is_decimal(type) and type.scale == 0))


def _whole(column: pa.Array) -> tuple[pa.Array, NDArray[np.bool_]]:
    """Column with null where a number is not whole, and True for these cells, shape (N,)."""
    values = column.cast(pa.float64(), safe=False).to_numpy(zero_copy_only=False)
    wrong = np.asarray(column.is_valid()) & ~((values == np.floor(values)) & (np.abs(values) < 2.0**63))
    return pc.if_else(pa.array(wrong), None, column), wrong


class ParquetTable(TypedTable):
    """Table in a Parquet file."""

    @cached_property
    def _file(self) -> pq.ParquetFile:
        with self.readable():
            return pq.ParquetFile(self.path if self.content is None else pa.BufferReader(self.content))

    @cached_property
    def schema(self) -> pa.Schema:
        return self._file.schema_arrow

    def _batches(self) -> Iterator[RowBatch]:
        count, total = 0, self._file.metadata.num_rows
        for group in range(self._file.num_row_groups):
            with self.readable(f"row group {group + 1} "):
                for rows in self._file.iter_batches(self.batch_rows, [group], list(self.names)):
                    count += rows.num_rows
                    self.progress = Progress(count, total, "rows")
                    rows.validate(full=True)  # Arrow takes any bytes as text, UTF-8 or not
                    yield self.batch(rows)


class ArrowTable(TypedTable):
    """Table in an Arrow file or stream."""

    def _open(self) -> Any:
        file = pa.OSFile(str(self.path)) if self.content is None else pa.BufferReader(self.content)
        is_stream = file.read(len(FILE_MARK)) != FILE_MARK
        file.seek(0)
        return pa.ipc.open_stream(file) if is_stream else pa.ipc.open_file(file)

    @cached_property
    def schema(self) -> pa.Schema:
        with self.readable(), self._open() as reader:
            return reader.schema

    def _batches(self) -> Iterator[RowBatch]:
        with self._open() as reader:
            is_stream, place = isinstance(reader, pa.RecordBatchStreamReader), 0
            total = None if is_stream else reader.num_record_batches
            while place != total:
                with self.readable(f"record batch {place + 1} "):
                    try:
                        rows = reader.read_next_batch() if is_stream else reader.get_batch(place)
                    except StopIteration:
                        return
                    rows.validate(full=True)
                place += 1
                self.progress = Progress(place, total, "batches")
                for start in range(0, rows.num_rows, self.batch_rows):
                    with self.readable(f"record batch {place} "):
                        batch = self.batch(rows.slice(start, self.batch_rows))
                    yield batch


class TableInMemory(TypedTable):
    """Table of Arrow in memory, from any library."""

    def __init__(self, table: pa.Table, ignored: Sequence[str] = ()) -> None:
        super().__init__(Path("frame"), ignored)
        self._table = table

    @property
    def schema(self) -> pa.Schema:
        return self._table.schema

    def _batches(self) -> Iterator[RowBatch]:
        for rows in self._table.to_batches(max_chunksize=self.batch_rows):
            with self.readable():
                yield self.batch(rows)

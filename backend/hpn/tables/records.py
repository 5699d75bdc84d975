"""From Parquet and Arrow to the cells of a table. This module imports Arrow.

The size of a table is checked as the file states it, and again after reading: the file may be wrong.
"""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import chain
from typing import Any

import pyarrow as pa
import pyarrow.dataset as datasets
import pyarrow.parquet as pq
import pyarrow.types as kinds

from hpn.tables.cells import Figure
from hpn.tables.sheets import MOST_CELLS, MOST_CHARACTERS, Grid, RefusedError, Takes, grid_of, too_many_cells
from hpn.words.wording import N_

LARGEST = 1e300
"""Largest number; larger ones are kept as text and don't count as numbers."""

MOST_BYTES = 16 * MOST_CHARACTERS
"""Bytes of a table's columns in memory: cells and their contents."""

UNREADABLE = N_("the file can’t be read as Parquet or Arrow: save the table as CSV or XLSX")
TOO_LONG = N_("the columns of the table take more than {most} MB: leave out those that are not needed")

SuffixAndGrid = tuple[str, Grid | None]
"""Suffix of a table that is taken unread, without cells; or blank with its cells."""


def parquet(content: bytes, takes: Takes | None) -> SuffixAndGrid:
    """A table of Parquet; raises RefusedError."""
    with _read_errors():
        file = pq.ParquetFile(pa.BufferReader(content))
        if _is_taken(file.schema_arrow, takes):
            return ".parquet", None
        claimed = file.metadata
        _require_few(claimed.num_rows, len(file.schema_arrow.names))
        _require_short(claimed.row_group(k).total_byte_size for k in range(claimed.num_row_groups))
        return "", _grid(file.read(use_threads=False))


def arrow(content: bytes, takes: Takes | None) -> SuffixAndGrid:
    """A table of Arrow; raises RefusedError."""
    with _read_errors():
        file = pa.ipc.open_file(pa.BufferReader(content))
        if _is_taken(file.schema, takes):
            return ".arrow", None
        fragment = datasets.IpcFileFormat().make_fragment(pa.py_buffer(content))
        _require_few(fragment.count_rows(use_threads=False), len(file.schema.names))
        return "", _grid(file.read_all())


def arrow_stream(content: bytes, takes: Takes | None) -> SuffixAndGrid:
    """A table of an Arrow stream; raises RefusedError."""
    with _read_errors(), pa.ipc.open_stream(pa.BufferReader(content)) as stream:
        if _is_taken(stream.schema, takes):
            return ".arrows", None
        batches, rows = list[pa.RecordBatch](), 0
        for batch in stream:
            rows += batch.num_rows
            _require_few(rows, len(stream.schema.names))
            batches.append(batch)
        return "", _grid(pa.Table.from_batches(batches, stream.schema))


@contextmanager
def _read_errors() -> Iterator[None]:
    try:
        yield
    except (RefusedError, MemoryError):
        raise
    except Exception:  # any error of the library in a broken file
        raise RefusedError(UNREADABLE) from None


def _is_taken(schema: pa.Schema, takes: Takes | None) -> bool:
    has_lists = any(
        kinds.is_list(field.type) or kinds.is_large_list(field.type) or kinds.is_fixed_size_list(field.type)
        for field in schema
    )
    return takes is not None and (has_lists or takes(schema.names, False))


def _require_few(rows: int, columns: int) -> None:
    if rows * columns > MOST_CELLS:
        raise too_many_cells()


def _require_short(sizes: Iterable[int]) -> None:
    if sum(sizes) > MOST_BYTES:
        raise RefusedError(TOO_LONG, most=MOST_BYTES // 1_000_000)


def _grid(table: pa.Table) -> Grid:
    table.validate(full=True)
    _require_few(table.num_rows, table.num_columns)
    _require_short([table.nbytes])
    rows = (row.values() for batch in table.to_batches(1000) for row in batch.to_pylist())
    return grid_of([_cell(value) for value in row] for row in chain([table.column_names], rows))


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < LARGEST:
        return Figure(repr(value).removesuffix(".0"))
    return str(value)

"""Tables of axes in files, read once from the first row to the last, some rows at a time.

The rows have the columns of `columns.py` in their types. An unreadable cell is null and a fault, and reading goes on.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from hpn.application.faults import BOUNDS
from hpn.fleet.columns import AXIS, COLUMNS, INDEX, LONG_TEXTS, InputColumn, is_list, is_text
from hpn.fleet.faults import CellFault
from hpn.fleet.order import FleetError
from hpn.words.wording import Sentence

BATCH_AXES, BATCH_PHASES = 16_384, 131_072
"""Rows read at once, in list and in long form."""

LONGEST_TEXT = 1000
"""Most characters of a text: names of axes return in every file, and faulty texts in their reason."""

TOO_LONG = Sentence(BOUNDS["string_too_long"], {"most": str(LONGEST_TEXT)})


class RowBatch(NamedTuple):
    """Some rows of a table, and the faults of their cells."""

    rows: pa.Table
    faults: Sequence[CellFault] = ()

    def between(self, start: int, end: int) -> "RowBatch":
        """Rows from `start` up to, but not with, `end`."""
        faults = [fault.moved(-start) for fault in self.faults if start <= fault.row < end]
        return RowBatch(self.rows.slice(start, end - start), faults)


def joined(batches: Sequence[RowBatch]) -> RowBatch:
    """Batches of the same columns joined in their order."""
    starts = np.cumsum([0, *(batch.rows.num_rows for batch in batches)]).tolist()
    faults = [f.moved(start) for start, batch in zip(starts, batches, strict=False) for f in batch.faults]
    return RowBatch(pa.concat_tables([batch.rows for batch in batches]), faults)


class Progress(NamedTuple):
    """Amount that has been read, the whole amount where it is known, and the unit of both."""

    done: int
    total: int | None
    counted: str


class AxisTable(ABC):
    """Table of axes in a file, or in bytes under its name; raises FleetError where it can't be read."""

    def __init__(
        self,
        path: Path,
        ignored: Sequence[str] = (),
        content: bytes | None = None,
        columns: Mapping[str, InputColumn] = COLUMNS.all,
    ) -> None:
        self.path, self.content, self.columns = path, content, columns
        self.ignored = tuple(ignored)
        self.progress = Progress(0, None, "rows")

    @property
    def names(self) -> Sequence[str]:
        """Names of the columns to read."""
        return [name for name in self.all_names if name not in self.ignored]

    @property
    @abstractmethod
    def all_names(self) -> Sequence[str]:
        """Names of all columns."""

    @property
    def indices(self) -> Sequence[str]:
        """Columns of an index without a meaning that pandas wrote, as far as the format tells them."""
        return [name for name in self.all_names if INDEX.fullmatch(name)]

    @property
    @abstractmethod
    def is_in_list_form(self) -> bool:
        """True where a row is an axis with lists of phases; False where a row is a phase."""

    @property
    @abstractmethod
    def axis_type(self) -> pa.DataType:
        """Type of the names of axes in between: text or integers."""

    @property
    def written_axis_type(self) -> pa.DataType:
        """Type of the names of axes in files that can have it."""
        return self.axis_type

    has_untyped_axes = False
    """True where names of axes are text until all of them are known to be whole numbers."""

    @property
    def batch_rows(self) -> int:
        """Rows read at once where the format leaves the choice."""
        return BATCH_AXES if self.is_in_list_form else BATCH_PHASES

    def batches(self) -> Iterator[RowBatch]:
        """Rows; a too long text is a fault and null, a too long name of an axis is cut."""
        return map(with_short_texts, self._batches())

    @abstractmethod
    def _batches(self) -> Iterator[RowBatch]:
        """Rows as they stand."""

    def type_of(self, name: str) -> pa.DataType:
        """Arrow type of a column in the rows."""
        if name == AXIS:
            return self.axis_type
        column = self.columns[name]
        return column.type if self.is_in_list_form or name not in COLUMNS.phases else column.type.value_type

    def wrong_type(self, name: str) -> str:
        """Error text for a column of an unusable type; blank for a usable one."""
        return ""

    @property
    def empty(self) -> pa.Table:
        """Table with its columns and without rows."""
        return pa.schema([(name, self.type_of(name)) for name in self.names]).empty_table()

    def unreadable(self, error: Exception, where: str = "") -> FleetError:
        """Error of an unreadable file."""
        what = str(error).strip().partition("\n")[0]
        return FleetError(f"{self.path}: {where}can’t be read as {self.path.suffix[1:]}: {what}")


def with_short_texts(batch: RowBatch) -> RowBatch:
    """Rows; a too long text is a fault and null, a too long name of an axis is cut."""
    rows, faults = batch.rows, list(batch.faults)
    for place, name in enumerate(batch.rows.column_names):
        if name in LONG_TEXTS or (name in COLUMNS.others and COLUMNS.others[name].kind == "points"):
            continue
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
            faults += (CellFault(int(row), name, TOO_LONG, "string_too_long") for row in np.flatnonzero(long))
    return RowBatch(rows, faults)


def _too_long(column: pa.Array) -> NDArray[np.bool_]:
    """True for cells with a too long text, or with a list that has one, shape (N,)."""
    mask = np.zeros(len(column), np.bool_)
    if is_text(column.type):
        mask |= np.asarray(pc.fill_null(pc.greater(pc.utf8_length(column), LONGEST_TEXT), False))
    elif is_list(column.type) and is_text(column.type.value_type):
        items = _too_long(pc.list_flatten(column))
        mask[np.asarray(pc.list_parent_indices(column))[items]] = True
    return mask

"""Files of a fleet from outcomes: all appear complete under their names at the end, or none.

Outcomes are set aside first: the type of axes in CSV, and names that occur twice, are known only when all rows have
been read.
"""

import os
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as pacsv
import pyarrow.parquet as pq
from numpy.typing import NDArray

from hpn.fleet.columns import AXIS, is_text
from hpn.fleet.faults import TWICE, CellFault, cell_of, text_of
from hpn.fleet.order import format_of
from hpn.fleet.outcome import FAULTS, FIELDS, ROW
from hpn.fleet.uuids import is_uuid, uuids_of

WHOLE = "^(0|-?[1-9][0-9]{0,17})$"


def unfinished(path: Path, suffix: str = "") -> Path:
    """Name of an unfinished file, beside its final name; the next run overwrites remains of a killed run."""
    return path.with_name(f".unfinished.{path.name}{suffix}")


WRITERS: dict[str, Callable[[str, pa.Schema], Any]] = {
    ".parquet": pq.ParquetWriter,
    ".arrow": pa.ipc.new_file,
    ".csv": pacsv.CSVWriter,
}


WITHOUT_UUIDS = (".csv",)
"""Formats in which a UUID is text."""


def _with_types(table: pa.Table, schema: pa.Schema) -> pa.Table:
    """Table with the types of a schema, with UUIDs from their texts."""
    place = schema.get_field_index(AXIS)
    if not is_uuid(schema.field(place).type):
        return table.cast(schema)
    return table.set_column(place, schema.field(place), uuids_of(table[AXIS])).cast(schema)


def columns_of(kind: str, axis: pa.DataType) -> pa.Schema:
    """Columns of the file of a kind."""
    schema = FIELDS[kind](axis)
    return pa.schema([field for field in schema if field.name not in (ROW, FAULTS)])


class Outcomes:
    """Outcomes of axes by kind, batch by batch: in files beside the answers, or in memory where `answers` is None."""

    def __init__(self, answers: Path | None, axis: pa.DataType, kinds: Sequence[str]) -> None:
        kinds = list(dict.fromkeys(("answers", *kinds)))
        self._paths = {} if answers is None else {kind: unfinished(answers, f".{kind}") for kind in kinds}
        self._memory = {} if self._paths else {kind: pa.BufferOutputStream() for kind in kinds}
        self._contents = dict[str, pa.Buffer]()
        targets = {kind: str(path) for kind, path in self._paths.items()} or self._memory
        self._files = {kind: pa.ipc.new_stream(target, FIELDS[kind](axis)) for kind, target in targets.items()}
        self._hashes = [np.empty(0, np.int64)]
        self.are_whole = True
        """True while all axes are written as whole numbers."""

    def add(self, tables: Mapping[str, pa.Table]) -> None:
        """Add the outcome of some axes."""
        axes = tables["answers"][AXIS]
        self._hashes.append(np.fromiter(map(hash, axes.drop_null().to_pylist()), np.int64))
        if self.are_whole and is_text(axes.type):
            self.are_whole = bool(pc.all(pc.match_substring_regex(axes, WHOLE), min_count=0).as_py())
        for kind, file in self._files.items():
            columns = [column.combine_chunks() for column in tables[kind].columns]
            file.write_batch(pa.RecordBatch.from_arrays(columns, schema=tables[kind].schema))

    def close(self) -> None:
        """End the files; from then on they can be read."""
        for file in self._files.values():
            file.close()
        self._contents = {kind: memory.getvalue() for kind, memory in self._memory.items()}

    def remove(self) -> None:
        """Remove the files."""
        for path in self._paths.values():
            path.unlink(missing_ok=True)

    def write(self, path: Path, kind: str, axis: pa.DataType, torn: frozenset[Any]) -> int:
        """Write the file of a kind, with axes of a type where its format has it; returns its number of rows."""
        axis, rows = pa.string() if is_uuid(axis) and format_of(path) in WITHOUT_UUIDS else axis, 0
        with closing(WRITERS[format_of(path)](str(path), columns_of(kind, axis))) as writer:
            for table in self._tables(kind, axis, torn):
                writer.write_table(table)
                rows += table.num_rows
        with path.open("rb") as file:
            os.fsync(file.fileno())
        return rows

    def table(self, kind: str, axis: pa.DataType, torn: frozenset[Any]) -> pa.Table:
        """Outcome of a kind as one table."""
        return pa.concat_tables([columns_of(kind, axis).empty_table(), *self._tables(kind, axis, torn)])

    def _tables(self, kind: str, axis: pa.DataType, torn: frozenset[Any]) -> Iterator[pa.Table]:
        """Outcome of a kind, with axes of a type and one row for each torn axis."""
        schema, seen = columns_of(kind, axis), set[Any]()
        for answers, table in zip(self._read("answers"), self._read(kind), strict=True):
            whole = _whole(kind, table, answers, torn, seen) if torn else table
            yield _with_types(whole.select(schema.names), schema)

    def answers(self, torn: frozenset[Any]) -> Iterator[pa.Table]:
        """Answers, with the reasons of rejected axes; names of axes are text."""
        seen = set[Any]()
        for table in self._read("answers"):
            whole = _whole("answers", table, table, torn, seen) if torn else table
            yield whole.set_column(0, AXIS, whole[AXIS].cast(pa.string()))

    def _read(self, kind: str) -> Iterator[pa.Table]:
        source = pa.OSFile(str(self._paths[kind])) if self._paths else pa.BufferReader(self._contents[kind])
        with source, pa.ipc.open_stream(source) as batches:
            for batch in batches:
                yield pa.Table.from_batches([batch])

    def torn(self) -> frozenset[Any]:
        """Axes that occur more than once; each is rejected as a whole."""
        ascending = np.sort(np.concatenate(self._hashes))
        repeated = set(ascending[1:][ascending[1:] == ascending[:-1]].tolist())
        counts = Counter[Any]()
        for answers in self._read("answers") if repeated else ():
            counts.update(axis for axis in answers[AXIS].to_pylist() if axis is not None and hash(axis) in repeated)
        return frozenset(axis for axis, count in counts.items() if count > 1)


# --- Axes that are not together ---------------------------------------------------------------------------------------


def _whole(kind: str, table: pa.Table, answers: pa.Table, torn: frozenset[Any], seen: set[Any]) -> pa.Table:
    """Outcome of some axes, with one row for each torn axis: `seen` are the torn axes that have had theirs."""
    axes, mask = answers[AXIS].to_pylist(), list[bool]()
    for axis in axes:
        mask.append(axis not in seen)
        seen.update([axis] if axis in torn else [])
    is_torn, stays = np.array([axis in torn for axis in axes], np.bool_), np.array(mask, np.bool_)
    if kind == "answers":
        return _with_error(table, is_torn).filter(pa.array(stays))
    table = table.filter(pa.array(~is_torn[np.asarray(table[ROW])]))
    if kind == "candidates":
        return table
    places = pa.array(np.flatnonzero(stays & is_torn))
    texts = ([text] * len(places) for text in (AXIS, "repeated", TWICE.text))
    more = pa.Table.from_arrays([places, answers[AXIS].take(places), *map(pa.array, texts)], schema=table.schema)
    return pa.concat_tables([table, more]).sort_by(ROW)


def _with_error(answers: pa.Table, is_twice: NDArray[np.bool_]) -> pa.Table:
    """Answers in which a torn axis has only an error."""
    fault = CellFault(0, AXIS, TWICE, "repeated")
    columns, fields = [answers[AXIS]], {"error": text_of([fault]), FAULTS: cell_of([fault])}
    for field in list(answers.schema)[1:]:
        instead = pa.scalar(fields.get(field.name), field.type)
        columns.append(pc.if_else(pa.array(is_twice), instead, answers[field.name]))
    return pa.Table.from_arrays(columns, schema=answers.schema)

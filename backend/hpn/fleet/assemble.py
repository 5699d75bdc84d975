"""From the parts of a job to its files, each whole under its name at the end or not at all."""

import os
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any, Literal

import msgspec
import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as pacsv
import pyarrow.parquet as pq

from hpn.fleet.columns import AXIS
from hpn.fleet.job import HashArray, Job, hashes_of
from hpn.fleet.opened import format_of
from hpn.words.wording import N_

BUCKET_HASHES = 20_000_000
"""Hashes that are compared at once; how many axes there are does not change what that takes."""

TWICE = N_("must be unique, with its rows together")


class _NdjsonWriter:
    """A JSON object in each line."""

    def __init__(self, path: str, schema: pa.Schema) -> None:
        self._file = pa.OSFile(path, "wb")

    def write_table(self, table: pa.Table) -> None:
        """Add rows."""
        for batch in table.to_batches(4096):
            self._file.write(b"".join(msgspec.json.encode(row) + b"\n" for row in batch.to_pylist()))

    def close(self) -> None:
        """End the file."""
        self._file.close()


WRITERS: dict[str, Callable[[str, pa.Schema], Any]] = {
    ".parquet": pq.ParquetWriter,
    ".arrow": pa.ipc.new_file,
    ".csv": pacsv.CSVWriter,
    ".ndjson": _NdjsonWriter,
}


Use = Callable[[Path], None]
"""Is given the answers when they are whole; what it raises keeps every file from its name."""


def assemble(job: Job, parts: int, targets: dict[str, Path], use: Use = lambda _: None) -> dict[str, int]:
    """Write the files of a job by kind; gives their numbers of rows. All are whole before the first gets its name."""
    torn, axis_type = _torn(job, parts), _axis_type(job, parts)
    schemas = job.schemas(axis_type)
    written, rows = {}, {}
    try:
        for kind, target in targets.items():
            written[kind] = target.with_name(f".unfinished.{target.name}")  # what a kill leaves is written over
            rows[kind] = _write(written[kind], format_of(target), schemas[kind], _tables(job, parts, kind, torn))
        use(written["answers"])
        for kind in sorted(targets, key="answers".__eq__):  # the answers last
            os.replace(written[kind], targets[kind])
    finally:
        for path in written.values():
            path.unlink(missing_ok=True)
    return rows


def _write(path: Path, suffix: str, schema: pa.Schema, tables: Iterator[pa.Table]) -> int:
    rows = 0
    with closing(WRITERS[suffix](str(path), schema)) as writer:
        for table in tables:
            writer.write_table(table.cast(schema))
            rows += table.num_rows
    with path.open("rb") as file:
        os.fsync(file.fileno())
    return rows


def _axis_type(job: Job, parts: int) -> pa.DataType:
    """Type of the axes; those of CSV are integers if every one is written as one."""
    are_text = job.axes.suffix != ".csv" or any(job.file(number, "text").exists() for number in range(parts))
    return job.tables()[0].axis_type if are_text else pa.int64()


# --- Axes that are not together ---------------------------------------------------------------------------------------


def _torn(job: Job, parts: int) -> pa.Array:
    """Axes that are there twice; each is rejected whole and has one row, where it came first."""
    hashes = [np.load(job.file(number, "hashes"), mmap_mode="r") for number in range(parts)]
    repeated = _repeated(hashes)
    counts: Counter[Any] = Counter()
    for number, own in enumerate(hashes if len(repeated) else ()):
        if np.isin(own, repeated).any():
            axis = _part(job, number, "answers")[AXIS]
            counts.update(axis.filter(pa.array(np.isin(hashes_of(axis), repeated))).drop_null().to_pylist())
    return pa.array([axis for axis, count in counts.items() if count > 1], job.tables()[0].axis_type)


def _repeated(hashes: Sequence[HashArray]) -> HashArray:
    """Hashes that are there twice, of sorted ones in many files, range by range."""
    ranges = sum(map(len, hashes)) // BUCKET_HASHES + 1
    found = [np.empty(0, np.uint64)]
    for place in range(ranges):
        first, last = (np.uint64(min((place + end) * 2**64 // ranges, 2**64 - 1)) for end in (0, 1))
        side: Literal["left", "right"] = "right" if place == ranges - 1 else "left"
        own = [each[np.searchsorted(each, first) : np.searchsorted(each, last, side)] for each in hashes]
        ascending = np.sort(np.concatenate(own))
        found.append(np.unique(ascending[1:][ascending[1:] == ascending[:-1]]))
    return np.concatenate(found)


def _part(job: Job, number: int, kind: str) -> pa.Table:
    with pa.memory_map(str(job.file(number, kind))) as file:
        return pa.ipc.open_file(file).read_all()


def _tables(job: Job, parts: int, kind: str, torn: pa.Array) -> Iterator[pa.Table]:
    """What the parts have come to, with one row for each torn axis."""
    torn_axes, told = frozenset(torn.to_pylist()), set[Any]()
    for number in range(parts):
        table = _part(job, number, kind)
        here = _part(job, number, "answers")[AXIS].to_pylist() if torn_axes else []
        first = [axis for axis in dict.fromkeys(here) if axis in torn_axes and axis not in told]
        told.update(first)
        if torn_axes.isdisjoint(here):
            yield table
        elif kind == "answers":
            yield _told_once(table, torn, first)
        else:
            rest = table.filter(pc.invert(pc.is_in(table[AXIS], torn)))
            faults = {AXIS: first, "column": [AXIS] * len(first), "reason": [TWICE] * len(first)}
            yield pa.concat_tables([rest, pa.table(faults, schema=table.schema)]) if kind == "rejected" else rest


def _told_once(answers: pa.Table, torn: pa.Array, first: Sequence[Any]) -> pa.Table:
    """Answers in which a torn axis has an error, in the row where it comes first, and no other row."""
    left = set(first)
    keep = []
    for axis, is_torn in zip(answers[AXIS].to_pylist(), pc.is_in(answers[AXIS], torn).to_pylist(), strict=True):
        keep.append(not is_torn or axis in left)
        left.discard(axis)
    kept = answers.filter(pa.array(keep))
    is_torn = pc.is_in(kept[AXIS], torn)
    columns = [kept[AXIS]]
    for field in list(kept.schema)[1:]:
        instead = pa.scalar(f"{AXIS}: {TWICE}" if field.name == "error" else None, field.type)
        columns.append(pc.if_else(is_torn, instead, kept[field.name]))
    return pa.Table.from_arrays(columns, schema=kept.schema)

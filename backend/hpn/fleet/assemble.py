"""From the parts of a job to its files, each whole under its name at the end or not at all."""

import os
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any, Literal, NamedTuple

import msgspec
import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as pacsv
import pyarrow.parquet as pq

from hpn.fleet.columns import AXIS
from hpn.fleet.grouping import NO_PHASES, NOT_BESIDE
from hpn.fleet.job import HashArray, Job, hashes_of
from hpn.fleet.opened import format_of, suffix_of
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
    if suffix_of(job.axes) not in (".csv", ".csv.gz") or any(job.file(part, "text").exists() for part in range(parts)):
        return job.tables()[0].axis_type
    return pa.int64()


# --- Axes that are not together ---------------------------------------------------------------------------------------


class _Torn(NamedTuple):
    """Axes with more than one row: those that are rejected whole, and those that stand elsewhere in the other table."""

    twice: Mapping[Any, bool]
    """Whether the phases have a row of each of them, or the other table alone."""
    elsewhere: frozenset[Any]

    def kept(self, answers: pa.Table, told: set[Any]) -> list[bool]:
        """Which rows of a part stay: one for each axis, where it came first; those that were told are added."""
        kept = []
        for axis, is_other in zip(answers[AXIS].to_pylist(), _are_of_others(answers), strict=True):
            if axis in self.twice:
                kept.append(axis not in told and not (is_other and self.twice[axis]))
                told.update([axis] if kept[-1] else [])
            else:
                kept.append(not (is_other and axis in self.elsewhere))
        return kept


def _are_of_others(answers: pa.Table) -> list[bool]:
    """Which rows are of the other table alone."""
    found = pc.match_substring(answers["error"], f"{AXIS}: {NO_PHASES}")
    return list(pc.fill_null(found, False).to_pylist())


def _torn(job: Job, parts: int) -> _Torn:
    """Axes that are there twice, of which each has one row in what is written."""
    hashes = [np.load(job.file(number, "hashes"), mmap_mode="r") for number in range(parts)]
    repeated = _repeated(hashes)
    rows: dict[Any, list[str]] = {}
    for number, own in enumerate(hashes if len(repeated) else ()):
        if np.isin(own, repeated).any():
            answers = _part(job, number, "answers")
            found = answers.filter(pa.array(np.isin(hashes_of(answers[AXIS]), repeated)))
            for axis, error in zip(found[AXIS].to_pylist(), found["error"].to_pylist(), strict=True):
                if axis is not None:
                    rows.setdefault(axis, []).append(error or "")
    twice, elsewhere = {}, set()
    for axis, errors in rows.items():
        own_rows = [error for error in errors if f"{AXIS}: {NO_PHASES}" not in error]
        if len(own_rows) == 1 and len(errors) == 2 and f"{AXIS}: {NOT_BESIDE}" in own_rows[0]:
            elsewhere.add(axis)
        elif len(errors) > 1:
            twice[axis] = bool(own_rows)
    return _Torn(twice, frozenset(elsewhere))


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


def _tables(job: Job, parts: int, kind: str, torn: _Torn) -> Iterator[pa.Table]:
    """What the parts have come to, with one row for each torn axis."""
    touched, told = torn.twice.keys() | torn.elsewhere, set[Any]()
    for number in range(parts):
        table = _part(job, number, kind)
        answers = _part(job, number, "answers") if touched else table
        if not touched or touched.isdisjoint(answers[AXIS].to_pylist()):
            yield table
            continue
        kept = torn.kept(answers, told)
        if kind == "answers":
            yield _told_once(table.filter(pa.array(kept)), torn)
        elif kind == "rejected":
            yield _rejected_once(table, answers[AXIS].to_pylist(), kept, torn)
        else:
            yield table.filter(pc.invert(pc.is_in(table[AXIS], pa.array(torn.twice, table[AXIS].type))))


def _told_once(answers: pa.Table, torn: _Torn) -> pa.Table:
    """Answers in which a torn axis has an error and nothing else."""
    is_torn = pc.is_in(answers[AXIS], pa.array(torn.twice, answers[AXIS].type))
    columns = [answers[AXIS]]
    for field in list(answers.schema)[1:]:
        instead = pa.scalar(f"{AXIS}: {TWICE}" if field.name == "error" else None, field.type)
        columns.append(pc.if_else(is_torn, instead, answers[field.name]))
    return pa.Table.from_arrays(columns, schema=answers.schema)


def _rejected_once(rejected: pa.Table, axes: Sequence[Any], kept: Sequence[bool], torn: _Torn) -> pa.Table:
    """Faults in the order of the axes, those of a torn one as one; a row that one table lacks has that first."""
    left = deque(rejected.to_pylist())
    rows = list[Any]()
    for axis, is_kept in zip(axes, kept, strict=True):
        own = list[dict[str, Any]]()
        while left and left[0][AXIS] == axis and not (own and left[0]["reason"] in (NO_PHASES, NOT_BESIDE)):
            own.append(left.popleft())
        if is_kept:
            rows += own if axis not in torn.twice else [{AXIS: axis, "column": AXIS, "reason": TWICE}]
    return pa.Table.from_pylist(rows, rejected.schema)

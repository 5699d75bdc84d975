"""From outcomes to the files of a fleet, each whole under its name at the end or not at all.

Outcomes are set aside first: the type of axes in CSV, and whether a name is there twice, is known when all
have been read.
"""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as pacsv
import pyarrow.parquet as pq
from numpy.typing import NDArray

from hpn.fleet.columns import AXIS, is_text
from hpn.fleet.gathering import NO_PHASES, NOT_BESIDE
from hpn.fleet.order import format_of
from hpn.fleet.outcome import FIELDS, ROW
from hpn.fleet.uuids import is_uuid, uuids_of
from hpn.words.wording import N_

TWICE = N_("must be unique, with its rows together")
WHOLE = "^(0|-?[1-9][0-9]{0,17})$"


def unfinished(path: Path, suffix: str = "") -> Path:
    """Name of a file until it is whole, beside the one that it gets then; the next run writes over what a kill left."""
    return path.with_name(f".unfinished.{path.name}{suffix}")


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


WITHOUT_UUIDS = (".csv", ".ndjson")
"""Formats in which a UUID is text."""


def _typed(table: pa.Table, schema: pa.Schema) -> pa.Table:
    """The table with the types of a schema, UUIDs out of their texts."""
    place = schema.get_field_index(AXIS)
    if not is_uuid(schema.field(place).type):
        return table.cast(schema)
    return table.set_column(place, schema.field(place), uuids_of(table[AXIS])).cast(schema)


class Outcomes:
    """Outcomes of the axes so far, by kind, in files beside the answers: a batch for each."""

    def __init__(self, answers: Path, axis: pa.DataType, kinds: Sequence[str]) -> None:
        self._paths = {kind: unfinished(answers, f".{kind}") for kind in dict.fromkeys(("answers", *kinds))}
        self._axis = axis
        self._files = {kind: pa.ipc.new_stream(str(path), FIELDS[kind](axis)) for kind, path in self._paths.items()}
        self._hashes = [np.empty(0, np.int64)]
        self.are_whole = True
        """True for axes that are all written as whole numbers."""

    def add(self, found: Mapping[str, pa.Table]) -> None:
        """Add the outcome of some axes."""
        axes = found["answers"][AXIS]
        self._hashes.append(np.fromiter(map(hash, axes.drop_null().to_pylist()), np.int64))
        if self.are_whole and is_text(axes.type):
            self.are_whole = bool(pc.all(pc.match_substring_regex(axes, WHOLE), min_count=0).as_py())
        for kind, file in self._files.items():
            columns = [column.combine_chunks() for column in found[kind].columns]
            file.write_batch(pa.RecordBatch.from_arrays(columns, schema=found[kind].schema))

    def close(self) -> None:
        """End the files; they can be read from then on."""
        for file in self._files.values():
            file.close()

    def remove(self) -> None:
        """Remove the files."""
        for path in self._paths.values():
            path.unlink(missing_ok=True)

    def write(self, path: Path, kind: str, axis: pa.DataType, torn: "Torn") -> int:
        """Write the file of a kind with axes of a type, as far as its format has it; gives its number of rows."""
        axis = pa.string() if is_uuid(axis) and format_of(path) in WITHOUT_UUIDS else axis
        schema, rows, seen = FIELDS[kind](axis), 0, set[Any]()
        schema = schema.remove(schema.get_field_index(ROW)) if ROW in schema.names else schema
        with closing(WRITERS[format_of(path)](str(path), schema)) as writer:
            for answers, table in zip(self._read("answers"), self._read(kind), strict=True):
                whole = torn.whole(kind, table, answers, seen) if torn else table
                writer.write_table(_typed(whole.select(schema.names), schema))
                rows += whole.num_rows
        with path.open("rb") as file:
            os.fsync(file.fileno())
        return rows

    def _read(self, kind: str) -> Iterator[pa.Table]:
        with pa.OSFile(str(self._paths[kind])) as file, pa.ipc.open_stream(file) as batches:
            for batch in batches:
                yield pa.Table.from_batches([batch])

    def torn(self) -> "Torn":
        """Axes that are there more than once."""
        ascending = np.sort(np.concatenate(self._hashes))
        repeated = set(ascending[1:][ascending[1:] == ascending[:-1]].tolist())
        errors: dict[Any, list[str]] = {}
        for answers in self._read("answers") if repeated else ():
            for axis, error in zip(answers[AXIS].to_pylist(), answers["error"].to_pylist(), strict=True):
                if axis is not None and hash(axis) in repeated:
                    errors.setdefault(axis, []).append(error or "")
        return Torn.of(errors)


# --- Axes that are not together ---------------------------------------------------------------------------------------

ALONE = f"{AXIS}: {NO_PHASES}"


@dataclass(frozen=True)
class Torn:
    """Axes with more than one row: those that are rejected whole, and those that stand elsewhere in the other table."""

    twice: Mapping[Any, bool]
    """True for those that have phases, False for those of the other table alone."""
    elsewhere: frozenset[Any]

    @classmethod
    def of(cls, errors: Mapping[Any, Sequence[str]]) -> "Torn":
        """Torn axes among some, by the errors of their rows."""
        twice, elsewhere = {}, set()
        for axis, found in errors.items():
            own = [error for error in found if ALONE not in error]
            if len(own) == 1 and len(found) == 2 and f"{AXIS}: {NOT_BESIDE}" in own[0]:
                elsewhere.add(axis)
            elif len(found) > 1:
                twice[axis] = bool(own)
        return cls(twice, frozenset(elsewhere))

    def __bool__(self) -> bool:
        return bool(self.twice or self.elsewhere)

    def whole(self, kind: str, table: pa.Table, answers: pa.Table, seen: set[Any]) -> pa.Table:
        """Outcome of some axes, with one row for each torn one; those that were seen have had it."""
        is_twice = np.array([axis in self.twice for axis in answers[AXIS].to_pylist()], np.bool_)
        kept = np.array(self._kept(answers, seen), np.bool_)
        if kind == "answers":
            return _with_error(table, is_twice).filter(pa.array(kept))
        rows = np.asarray(table[ROW])
        table = table.filter(pa.array((kept & ~is_twice)[rows]))
        if kind == "candidates":
            return table
        places = pa.array(np.flatnonzero(kept & is_twice))
        count = len(places)
        more = [places, answers[AXIS].take(places), pa.array([AXIS] * count), pa.array([TWICE] * count)]
        return pa.concat_tables([table, pa.Table.from_arrays(more, schema=table.schema)]).sort_by(ROW)

    def _kept(self, answers: pa.Table, seen: set[Any]) -> list[bool]:
        """True for the rows that stay: one for each axis, where it came first."""
        kept = []
        for axis, error in zip(answers[AXIS].to_pylist(), answers["error"].to_pylist(), strict=True):
            is_alone = ALONE in (error or "")
            if axis in self.twice:
                kept.append(axis not in seen and not (is_alone and self.twice[axis]))
                seen.update([axis] if kept[-1] else [])
            else:
                kept.append(not (is_alone and axis in self.elsewhere))
        return kept


def _with_error(answers: pa.Table, is_twice: NDArray[np.bool_]) -> pa.Table:
    """Answers in which a torn axis has an error and nothing else."""
    columns = [answers[AXIS]]
    for field in list(answers.schema)[1:]:
        instead = pa.scalar(f"{AXIS}: {TWICE}" if field.name == "error" else None, field.type)
        columns.append(pc.if_else(pa.array(is_twice), instead, answers[field.name]))
    return pa.Table.from_arrays(columns, schema=answers.schema)

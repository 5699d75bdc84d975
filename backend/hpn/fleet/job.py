"""A job: what is to be sized, and one part of it after another.

Every part leaves its files in one folder, under its number: answers, rejected, candidates, and the sorted hashes of its
axes. A file `text` says that axes are no whole numbers: those of CSV are text until all are known. Each is written
beside its name and renamed when it is whole, the answers last, so that a part whose answers are there is done, whoever
worked on it and however often. On a cluster the folder has to be one that every worker sees.
"""

import os
import re
from bisect import bisect_left
from contextlib import ExitStack
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from hpn.catalogue import Catalogue
from hpn.catalogue.copy import read_copy
from hpn.fleet.columns import AXIS, is_text
from hpn.fleet.grouping import Part, axes_of
from hpn.fleet.opened import open_axes, open_requirements
from hpn.fleet.outcome import answer_fields, candidate_fields, outcome, rejected_fields
from hpn.fleet.tables import Table, row_of

SLICE_AXES = 16_384
"""Axes that are evaluated in one go."""

SLICE_WITH_CANDIDATES = 1_024

WHOLE = "^(0|-?[1-9][0-9]{0,17})$"

HashArray = NDArray[np.uint64]


OWN = re.compile(r"lock|plan(\.json)?|[0-9]{8,}\.(answers|rejected|candidates|hashes|text)(\.[0-9]+)?")


def is_own(name: str) -> bool:
    """Whether a run gives a file in the folder of its parts that name."""
    return bool(OWN.fullmatch(name))


@dataclass(frozen=True)
class Job:
    """What is to be sized. The catalogue comes along as a copy, so that every worker has the same.

    Fingerprints of the tables tell a job from one of files that had the same names.
    """

    axes: Path
    requirements: Path | None
    folder: Path
    catalogue: bytes
    with_candidates: bool
    fingerprints: tuple[str, ...] = ()
    ignored: tuple[str, ...] = ()

    def tables(self) -> tuple[Table, Table | None]:
        """The table of axes, and the one beside it."""
        table = open_axes(self.axes, self.ignored)
        beside = None if self.requirements is None else open_requirements(self.requirements, table, self.ignored)
        return table, beside

    def schemas(self, axis: pa.DataType) -> dict[str, pa.Schema]:
        """Columns of what comes out, by the kind of file."""
        schemas = {
            "rejected": rejected_fields(axis),
            "candidates": candidate_fields(axis),
            "answers": answer_fields(axis),
        }
        if not self.with_candidates:
            del schemas["candidates"]
        return schemas

    def file(self, number: int, kind: str) -> Path:
        """File of a part."""
        return self.folder / f"{number:08}.{kind}"

    def is_done(self, number: int) -> bool:
        """Whether a part is whole."""
        return self.file(number, "answers").exists()


def compute(job: Job, number: int, part: Part) -> int:
    """Size the axes of a part; gives how many they are."""
    table, requirements = opened(job)
    catalogue, schemas = _catalogue(job.catalogue), job.schemas(table.axis_type)
    files = {kind: job.file(number, f"{kind}.{os.getpid()}") for kind in (*schemas, "hashes")}
    hashes = [np.empty(0, np.uint64)]
    count, are_whole = 0, True
    with ExitStack() as stack:
        writers = {kind: stack.enter_context(pa.ipc.new_file(str(files[kind]), schemas[kind])) for kind in schemas}
        for listed in axes_of(table, part, requirements):
            count += listed.rows.num_rows
            hashes.append(hashes_of(listed.rows[AXIS]))
            are_whole = are_whole and _are_whole(listed.rows[AXIS])
            step = SLICE_WITH_CANDIDATES if job.with_candidates else SLICE_AXES
            ordered, begun = sorted(listed.faults, key=row_of), 0
            for start in range(0, listed.rows.num_rows, step):
                end = bisect_left(ordered, start + step, begun, key=row_of)
                faults, begun = [fault.moved(-start) for fault in ordered[begun:end]], end
                found = outcome(listed.rows.slice(start, step), catalogue, faults, with_candidates=job.with_candidates)
                for kind, writer in writers.items():
                    writer.write_table(getattr(found, kind))
    with files["hashes"].open("wb") as file:
        np.save(file, np.sort(np.concatenate(hashes)))
    if not are_whole:
        job.file(number, "text").touch()
    for kind in ("hashes", *schemas):  # the answers last
        os.replace(files[kind], job.file(number, kind))
    return count


def _are_whole(axis: pa.ChunkedArray) -> bool:
    """Whether every axis is a whole number as it is written, such as 7 and not 07."""
    if not is_text(axis.type):
        return True
    return bool(pc.all(pc.match_substring_regex(axis, WHOLE), min_count=0).as_py())


@lru_cache(maxsize=1)
def opened(job: Job) -> tuple[Table, Table | None]:
    """Tables of a job, opened once by each process: where lines begin is found by reading all of them."""
    return job.tables()


@lru_cache(maxsize=2)
def _catalogue(copy: bytes) -> Catalogue:
    return read_copy(copy)


MIX, START = np.uint64(0x9E3779B97F4A7C15), np.uint64(0xCBF29CE484222325)
HASHED_BYTES = 64


def hashes_of(axis: pa.ChunkedArray) -> HashArray:
    """Hashes of 64 bits of axes, shape (N,): equal ones have one hash, and those of one hash are most likely equal."""
    texts = pc.binary_slice(axis.cast(pa.string()).cast(pa.binary()).fill_null(b""), 0, HASHED_BYTES)
    given = np.array(texts.to_pylist(), dtype=np.bytes_)
    if not len(given):
        return np.empty(0, np.uint64)
    words = given.astype(f"S{-(-given.dtype.itemsize // 8) * 8}").view(np.uint64).reshape(len(given), -1)
    hashes = np.full(len(given), START)
    for place in range(words.shape[1]):
        mixed = (hashes ^ words[:, place]) * MIX
        # Words behind the end are left out: the hash of an axis does not depend on its neighbours.
        hashes = np.where(words[:, place:].any(axis=1), mixed ^ (mixed >> np.uint64(32)), hashes)
    return hashes

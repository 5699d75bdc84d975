"""Run of a fleet: its table is read once, threads or a cluster work on the axes, and the answers are written."""

import ctypes
import fcntl
import os
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

import pyarrow as pa

from hpn.catalogue import Catalogue
from hpn.fleet.gathering import axes_of, slices
from hpn.fleet.opened import open_axes
from hpn.fleet.order import FleetError, Order
from hpn.fleet.outcome import outcome
from hpn.fleet.tables import AxisTable, Progress, RowBatch
from hpn.fleet.writing import Outcomes, unfinished

SLICE_AXES, SLICE_WITH_CANDIDATES = 16_384, 1_024
"""Axes evaluated at once, without and with candidates."""

Outcome = dict[str, pa.Table]
Size = Callable[[RowBatch], Outcome]
Engine = Callable[[Size, Iterator[RowBatch]], Iterator[Outcome]]
"""Function that sizes batches of axes, several at once, and yields their outcomes in order; it reads few ahead."""

Watch = Callable[[Progress], None]
"""Function that receives the progress of reading, each time some axes are done."""

Use = Callable[[Iterator[pa.Table]], None]
"""Function that receives the complete answers; an error in it keeps every file from its name."""


# --- Engines ----------------------------------------------------------------------------------------------------------


def here(size: Size, batches: Iterator[RowBatch]) -> Iterator[Outcome]:
    """Engine in the thread that reads."""
    return map(size, batches)


def threads(workers: int) -> Engine:
    """Engine of `workers` threads beside the one that reads and writes; with 1 that thread does all the work."""

    def run(size: Size, batches: Iterator[RowBatch]) -> Iterator[Outcome]:
        with ThreadPoolExecutor(workers) as pool:
            yield from in_order(pool, workers, size, batches)

    return here if workers == 1 else run


def in_order(pool: Any, workers: int, size: Size, batches: Iterator[RowBatch]) -> Iterator[Outcome]:
    """Outcomes of batches in a pool, in their order; two batches wait for each worker, so that memory is bounded."""
    submitted = (pool.submit(size, batch) for batch in batches)
    under_way = deque(islice(submitted, 2 * workers))
    try:
        while under_way:
            yield under_way.popleft().result()
            under_way.extend(islice(submitted, 1))
    finally:
        for future in under_way:
            future.cancel()


MEMORY = {"MALLOC_TRIM_THRESHOLD_": (-1, 200_000_000), "MALLOC_MMAP_THRESHOLD_": (-3, 30_000_000)}
"""Variables of glibc, each with its parameter of mallopt and the bytes from which on memory goes back to the system."""


def keep_memory() -> None:
    """Keep freed memory of arrays for the next ones: new memory from the system takes half of a chunk's time."""
    library = ctypes.CDLL(None)
    if hasattr(library, "mallopt"):  # only glibc has it
        for parameter, value in MEMORY.values():
            library.mallopt(parameter, value)


# --- A run ------------------------------------------------------------------------------------------------------------


def size_fleet(
    order: Order,
    catalogue: Catalogue,
    engine: Engine = here,
    watch: Watch = lambda _: None,
    use: Use = lambda _: None,
    note_ignored: Callable[[Path, str], None] = lambda path, name: None,
) -> dict[str, int]:
    """Size all axes; returns the number of rows of each file by kind. All files appear complete at the end, or none.

    `use` receives the answers before their file has its name, for files written with them; `note_ignored` receives the
    ignored columns that the order does not name. Raises FleetError for unusable input.
    """
    order.require_usable()
    table = open_axes(order.axes, order.ignored)
    for name in table.ignored[len(order.ignored) :]:
        note_ignored(table.path, name)
    with _alone(order.answers), ExitStack() as stack:
        outcomes = Outcomes(order.answers, table.axis_type, list(order.targets))
        stack.callback(outcomes.remove)
        _size(table, catalogue, engine, outcomes, watch, with_candidates=order.candidates is not None)
        axis = pa.int64() if table.has_untyped_axes and outcomes.are_whole else table.written_axis_type
        rows, torn = {}, outcomes.torn()
        for kind, target in order.targets.items():
            stack.callback(unfinished(target).unlink, missing_ok=True)
            rows[kind] = outcomes.write(unfinished(target), kind, axis, torn)
        use(outcomes.answers(torn))
        for target in order.targets.values():
            os.replace(unfinished(target), target)
    return rows


def size_table(table: AxisTable, catalogue: Catalogue, kind: str = "answers", engine: Engine = here) -> pa.Table:
    """Size all axes of a table; returns the table of a kind in memory, by default the answers."""
    outcomes = Outcomes(None, table.axis_type, [kind])
    _size(table, catalogue, engine, outcomes, with_candidates=kind == "candidates")
    return outcomes.table(kind, table.written_axis_type, outcomes.torn())


def _size(
    table: AxisTable,
    catalogue: Catalogue,
    engine: Engine,
    outcomes: Outcomes,
    watch: Watch = lambda _: None,
    *,
    with_candidates: bool,
) -> None:
    """Add the outcomes of all axes."""
    most = SLICE_WITH_CANDIDATES if with_candidates else SLICE_AXES
    batches = (batch for axes in axes_of(table) for batch in slices(axes, most))
    for result in engine(partial(outcome, catalogue=catalogue, with_candidates=with_candidates), batches):
        outcomes.add(result)
        watch(table.progress)
    outcomes.close()


@contextmanager
def _alone(answers: Path) -> Iterator[None]:
    """Hold the unfinished answers for this run; raises FleetError where another run holds them."""
    with unfinished(answers).open("ab") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise FleetError(f"{answers}: another run is writing it") from None
        try:
            yield
        finally:
            unfinished(answers).unlink(missing_ok=True)

"""Sizing a fleet: its table is read once, their axes worked on by threads or a cluster, and the answers written."""

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
"""Axes that are evaluated in one go."""

Outcome = dict[str, pa.Table]
Size = Callable[[RowBatch], Outcome]
Engine = Callable[[Size, Iterator[RowBatch]], Iterator[Outcome]]
"""Sizes batches of axes, several at once, and gives what comes of them in their order; few are read ahead."""

Watch = Callable[[Progress], None]
"""Takes how much has been read, whenever some axes are done."""

Use = Callable[[Iterator[pa.Table]], None]
"""Takes the answers when they are whole; an error of it keeps every file from its name."""


# --- Engines ----------------------------------------------------------------------------------------------------------


def here(size: Size, batches: Iterator[RowBatch]) -> Iterator[Outcome]:
    """Engine of the thread that reads."""
    return map(size, batches)


def threads(workers: int) -> Engine:
    """Engine of so many threads, beside the one that reads and writes; a single one does all."""

    def run(size: Size, batches: Iterator[RowBatch]) -> Iterator[Outcome]:
        with ThreadPoolExecutor(workers) as pool:
            yield from in_order(pool, workers, size, batches)

    return here if workers == 1 else run


def in_order(pool: Any, workers: int, size: Size, batches: Iterator[RowBatch]) -> Iterator[Outcome]:
    """Outcomes of batches that a pool works on, in their order; two wait for each worker, so that memory is bounded."""
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
"""Variables of glibc, and its parameters, with bytes from which on memory goes back to the system."""


def keep_memory() -> None:
    """Keep the memory that arrays give back for the next ones: asking the system anew takes half of a chunk's time."""
    library = ctypes.CDLL(None)
    if hasattr(library, "mallopt"):  # of glibc; another C library does as it likes
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
    """Size all axes; gives the numbers of rows of the files by kind, which appear whole at the end or not at all.

    `use` takes the answers before they have their name, for files that are written along with them; `note_ignored`
    takes the columns that are ignored though nobody asked for that. Raises FleetError for input that can't be used.
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
    """Size all axes of a table; gives the answers, or what else is wanted of them, in memory."""
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
    """Hold the unfinished answers for this run; FleetError where another run has them."""
    with unfinished(answers).open("ab") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise FleetError(f"{answers}: another run is writing it") from None
        try:
            yield
        finally:
            unfinished(answers).unlink(missing_ok=True)

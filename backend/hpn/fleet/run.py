"""Sizing a fleet: tables are read once, their axes worked on by threads or a cluster, and the answers written."""

import ctypes
import fcntl
import os
import stat
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

import pyarrow as pa

from hpn.catalogue import Catalogue
from hpn.fleet.errors import FleetError
from hpn.fleet.gathering import axes_of, slices
from hpn.fleet.opened import UNREADABLE, format_of, open_axes, open_requirements, status_of
from hpn.fleet.outcome import outcome
from hpn.fleet.tables import Batch, Progress, Table
from hpn.fleet.writing import Outcomes, unfinished

SLICE_AXES, SLICE_WITH_CANDIDATES = 16_384, 1_024
"""Axes that are evaluated in one go."""

Outcome = dict[str, pa.Table]
Size = Callable[[Batch], Outcome]
Engine = Callable[[Size, Iterator[Batch]], Iterator[Outcome]]
"""Sizes batches of axes, several at once, and gives what comes of them in their order; few are read ahead."""

Watch = Callable[[Progress], None]
"""Takes how much has been read, whenever some axes are done."""

Use = Callable[[Path], None]
"""Takes the answers when they are whole; an error of it keeps every file from its name."""


@dataclass(frozen=True)
class Order:
    """The tables to read, and the files to write."""

    axes: Path
    answers: Path
    requirements: Path | None = None
    candidates: Path | None = None
    rejected: Path | None = None
    ignored: tuple[str, ...] = ()
    """Columns that are left out, whatever is in them."""

    @property
    def targets(self) -> dict[str, Path]:
        """Files to write, by kind; the answers are the last to get their name."""
        named = {"candidates": self.candidates, "rejected": self.rejected, "answers": self.answers}
        return {kind: path for kind, path in named.items() if path is not None}

    @property
    def tables(self) -> list[Path]:
        """Files to read."""
        return [path for path in (self.axes, self.requirements) if path is not None]

    def opened(self) -> tuple[Table, Table | None]:
        """The table of axes, and the one beside it; raises FleetError."""
        table = open_axes(self.axes, self.ignored)
        beside = None if self.requirements is None else open_requirements(self.requirements, table, self.ignored)
        return table, beside


# --- Engines ----------------------------------------------------------------------------------------------------------


def here(size: Size, batches: Iterator[Batch]) -> Iterator[Outcome]:
    """Engine of the thread that reads."""
    return map(size, batches)


def threads(workers: int) -> Engine:
    """Engine of so many threads, beside the one that reads and writes; a single one does all."""

    def run(size: Size, batches: Iterator[Batch]) -> Iterator[Outcome]:
        with ThreadPoolExecutor(workers) as pool:
            yield from in_order(pool, workers, size, batches)

    return here if workers == 1 else run


def in_order(pool: Any, workers: int, size: Size, batches: Iterator[Batch]) -> Iterator[Outcome]:
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
    _require_usable(order)
    table, beside = order.opened()
    for each in filter(None, (table, beside)):
        for name in each.ignored[len(order.ignored) :]:
            note_ignored(each.path, name)
    most = SLICE_AXES if order.candidates is None else SLICE_WITH_CANDIDATES
    batches = (batch for axes in axes_of(table, beside) for batch in slices(axes, most))
    size = partial(outcome, catalogue=catalogue, with_candidates=order.candidates is not None)
    with _alone(order.answers), ExitStack() as stack:
        outcomes = Outcomes(order.answers, table.axis_type, list(order.targets))
        stack.callback(outcomes.remove)
        for found in engine(size, batches):
            outcomes.add(found)
            watch(table.progress)
        outcomes.close()
        axis = pa.int64() if table.has_untyped_axes and outcomes.are_whole else table.axis_type
        rows, torn = {}, outcomes.torn()
        for kind, target in order.targets.items():
            stack.callback(unfinished(target).unlink, missing_ok=True)
            rows[kind] = outcomes.write(unfinished(target), kind, axis, torn)
        use(unfinished(order.answers))
        for target in order.targets.values():
            os.replace(unfinished(target), target)
    return rows


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


def _require_usable(order: Order) -> None:
    """Raise FleetError where a file would be written over, or could not be read or written."""
    for path in order.tables:
        if status_of(path) is not None and not os.access(path, os.R_OK, effective_ids=True):
            raise FleetError(f"{path}: {UNREADABLE}")
    written = list(order.targets.values())
    for place, path in enumerate(written):
        format_of(path)
        require_writable(path)
        if path.resolve() in [other.resolve() for other in (*order.tables, *written[:place])]:
            raise FleetError(f"{path}: is named twice")


def require_writable(path: Path) -> None:
    """Raise FleetError where no file can be written."""
    folder = status_of(path.parent)
    if folder is None or not stat.S_ISDIR(folder.st_mode):
        raise FleetError(f"{path}: there is no folder {path.parent}")
    if not os.access(path.parent, os.W_OK | os.X_OK, effective_ids=True):
        raise FleetError(f"{path}: this user may not write into {path.parent}")
    found = status_of(path)
    if found is not None and stat.S_ISDIR(found.st_mode):
        raise FleetError(f"{path}: is a folder, where a file belongs")

"""Sizing a fleet: parts are worked on by processes of this machine or by a cluster; a stopped run can be resumed."""

import fcntl
import hashlib
import os
import shutil
import signal
import stat
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context, parent_process
from multiprocessing.resource_tracker import ensure_running
from pathlib import Path

import msgspec

from hpn import ENGINE_VERSION
from hpn.catalogue import Catalogue
from hpn.catalogue.copy import copy_of
from hpn.fleet.assemble import Use, assemble
from hpn.fleet.errors import FleetError
from hpn.fleet.grouping import Part, parts_of, with_others
from hpn.fleet.job import Job, compute, is_own
from hpn.fleet.opened import UNREADABLE, format_of, status_of
from hpn.fleet.tables import Table

Engine = Callable[[Job, Mapping[int, Part]], Iterator[int]]
"""Computes parts of a job, and gives the number of each when it is done."""

Watch = Callable[[int, int, str], None]
"""Is told what is done and what there is, and what that counts, whenever a part is done."""


@dataclass(frozen=True)
class Order:
    """What is wanted: the tables to read, and the files to write."""

    axes: Path
    answers: Path
    requirements: Path | None = None
    candidates: Path | None = None
    rejected: Path | None = None
    resume: bool = False
    ignored: tuple[str, ...] = ()
    """Columns that are left out, whatever is in them."""

    @property
    def targets(self) -> dict[str, Path]:
        """Files to write, by kind."""
        named = {"answers": self.answers, "candidates": self.candidates, "rejected": self.rejected}
        return {kind: path for kind, path in named.items() if path is not None}

    @property
    def folder(self) -> Path:
        """Where the parts are kept until they are all done."""
        return self.answers.with_name(f"{self.answers.name}.parts")

    @property
    def is_begun(self) -> bool:
        """Whether there is something to resume."""
        return (self.folder / PLAN).exists()


PLAN = "plan.json"


class Plan(msgspec.Struct, frozen=True):
    """What parts belong to: they can be gone on with where nothing of it has changed."""

    engine_version: str
    catalogue_version: str
    fingerprints: tuple[str, ...]
    with_candidates: bool
    ignored: tuple[str, ...]
    parts: tuple[Part, ...]


def size_fleet(
    order: Order,
    catalogue: Catalogue,
    engine: Engine,
    watch: Watch,
    use: Use = lambda _: None,
    tell: Callable[[Path, str], None] = lambda path, name: None,
) -> dict[str, int]:
    """Size all axes; gives the numbers of rows of the files by kind.

    `use` is given the answers before they have their name, for what has to be written along with them; `tell` is told
    of columns that are ignored though nobody asked for that.
    Raises FleetError for input that can't be used, and for parts that belong to another one.
    """
    _require_usable(order)
    read = [path for path in (order.axes, order.requirements) if path is not None]
    job = Job(
        order.axes,
        order.requirements,
        order.folder,
        copy_of(catalogue),
        order.candidates is not None,
        tuple(_fingerprint(path) for path in read if path.is_file()),
        order.ignored,
    )
    table, requirements = job.tables()
    for each in filter(None, (table, requirements)):
        for name in each.ignored[len(order.ignored) :]:
            tell(each.path, name)
    parts = parts_of(table)
    if requirements is not None:
        parts = with_others(table, parts, requirements)
    plan = Plan(ENGINE_VERSION, catalogue.version, job.fingerprints, job.with_candidates, job.ignored, tuple(parts))
    with _folder(order, plan):
        _work(job, parts, table, engine, watch)
        return assemble(job, len(parts), order.targets, use)


def _work(job: Job, parts: Sequence[Part], table: Table, engine: Engine, watch: Watch) -> None:
    sizes = [sum(table.unit_sizes[part.first : part.end]) for part in parts]
    left = {number: part for number, part in enumerate(parts) if not job.is_done(number)}
    done = sum(sizes) - sum(sizes[number] for number in left)
    watch(done, sum(sizes), table.measured_in)
    for number in engine(job, left):
        done += sizes[number]
        watch(done, sum(sizes), table.measured_in)


def _require_usable(order: Order) -> None:
    """Raise FleetError where a file would be written over, or could not be read or written."""
    read = [path for path in (order.axes, order.requirements) if path is not None]
    for path in read:
        if status_of(path) is not None and not os.access(path, os.R_OK, effective_ids=True):
            raise FleetError(f"{path}: {UNREADABLE}")
    written = list(order.targets.values())
    for place, path in enumerate(written):
        format_of(path)
        require_writable(path)
        if path.resolve() in [other.resolve() for other in (*read, *written[:place])]:
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


def _fingerprint(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "blake2b").hexdigest()


@contextmanager
def _folder(order: Order, plan: Plan) -> Iterator[None]:
    """The folder of the parts, for this run alone; gone when all went well."""
    folder, wanted = order.folder, msgspec.json.encode(plan)
    try:
        folder.mkdir(exist_ok=True)
    except FileExistsError:
        raise FleetError(f"{folder}: is no folder, where the parts of the run belong; move it away") from None
    _require_own(folder)
    with (folder / "lock").open("wb") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise FleetError(f"{order.answers}: another run is writing it") from None
        known = folder / PLAN
        if order.resume and known.exists() and known.read_bytes() != wanted:
            raise FleetError(f"{folder}: its parts are {_difference(known.read_bytes(), plan)}; run without --resume")
        if not (order.resume and known.exists()):
            for file in folder.iterdir():
                if file.name != "lock":
                    file.unlink()
            whole = folder / "plan"
            whole.write_bytes(wanted)
            whole.replace(known)
        try:
            yield
        except FleetError:
            if not any(folder.glob("*.answers")):  # nothing to go on with
                shutil.rmtree(folder, ignore_errors=True)
            raise
        shutil.rmtree(folder)


def _require_own(folder: Path) -> None:
    """Raise FleetError where a folder holds what no run has left there: it is emptied before a run, and gone after."""
    with os.scandir(folder) as entries:
        for entry in entries:
            if not is_own(entry.name) or not entry.is_file(follow_symlinks=False):
                raise FleetError(
                    f"{entry.path}: is not of hpn fleet, which keeps its parts in that folder; move it away"
                )


def _difference(known: bytes, plan: Plan) -> str:
    try:
        before = msgspec.json.decode(known, type=Plan)
    except msgspec.MsgspecError:
        return "of another version"
    if before.engine_version != plan.engine_version:
        return f"of engine {before.engine_version}, this is {plan.engine_version}"
    if before.catalogue_version != plan.catalogue_version:
        return "of another catalogue"
    if before.fingerprints != plan.fingerprints:
        return "of another input: a table has changed"
    return "of other options"


# --- Processes of this machine ----------------------------------------------------------------------------------------

MEMORY = {"MALLOC_TRIM_THRESHOLD_": "200000000", "MALLOC_MMAP_THRESHOLD_": "100000000"}
"""Memory that arrays give back is kept for the next ones: asking the system anew takes half of the time of a chunk."""


def processes(workers: int) -> Engine:
    """Engine of so many processes of this machine."""

    def run(job: Job, parts: Mapping[int, Part]) -> Iterator[int]:
        if len(parts) == 1:  # a process takes longer to start than one part to compute
            ((number, part),) = parts.items()
            compute(job, number, part)
            yield number
            return
        for name, value in MEMORY.items():
            os.environ.setdefault(name, value)
        with ProcessPoolExecutor(workers, get_context("spawn"), _end_with_parent) as pool:
            with interrupts_held():  # the workers start with the first part submitted
                futures: dict[Future[int], int] = {
                    pool.submit(compute, job, number, part): number for number, part in parts.items()
                }
            try:
                for future in as_completed(futures):
                    future.result()
                    yield futures[future]
            finally:
                pool.shutdown(wait=True, cancel_futures=True)

    return run


@contextmanager
def interrupts_held() -> Iterator[None]:
    """Block interrupts: a process started here has them blocked from its first moment, this one gets them after.

    The mask is that of the main thread; one that another thread takes is noted until then.
    """
    ensure_running()  # multiprocessing's own first process unblocks interrupts when it has started
    noted: list[int] = []
    handler = signal.signal(signal.SIGINT, lambda number, _: noted.append(number))
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        signal.signal(signal.SIGINT, handler)
        if noted:
            signal.raise_signal(signal.SIGINT)


def _end_with_parent() -> None:
    """End this process when the one that started it is gone."""
    parent = parent_process()
    assert parent is not None

    def wait() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=wait, daemon=True).start()

"""Fleets of axes, sized by `hpn fleet` in processes that end with the service: what one takes, and where it fails, is
its own.

Its files stand in a folder that is locked as long as the service holds it, so that what a killed one left can be told.
"""

import asyncio
import fcntl
import logging
import os
import resource
import shutil
import signal
import sys
import tempfile
from asyncio.subprocess import PIPE, STDOUT, Process
from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import asynccontextmanager, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from starlette.datastructures import State
from starlette.requests import Request

from hpn.fleet.errors import wrong_encoding
from hpn.web import spool
from hpn.web.door.pools import Pool, pool_of, while_present
from hpn.web.door.problems import Problem
from hpn.web.settings import Settings

Kind = Literal["answers", "rejected", "candidates"]

MARKS = {".parquet": (b"PAR1", b"PAR1"), ".csv.gz": (b"\x1f\x8b", b"")} | dict.fromkeys(
    (".arrow", ".arrows", ".feather"), (b"ARROW1", b"ARROW1")
)
"""What files of a format begin and end with."""

STREAM = b"\xff\xff\xff\xff"
"""What an Arrow stream begins with; it may end in any way."""

ANSWERED_IN = {".arrows": ".arrow", ".feather": ".arrow", ".jsonl": ".ndjson", ".csv.gz": ".csv"}
"""Formats that are read and not written."""

HEAD_BYTES = 2_000_000
"""Beginning of a text, in which its first axis has to stand."""

PREFIX = "hpn-fleet-"
NICENESS = 10
END_SECONDS = 5
WATCH_SECONDS = 0.5
CALLERS = 2
"""Exit code of the command for what the caller can mend."""

MESSAGE_BYTES, DETAIL_LENGTH = 1_000_000, 2000
RETRY_SECONDS = 30

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Tables:
    """Tables of a fleet in its folder, under names of the service, and what the caller calls them."""

    input: Path
    axes: Path | None = None
    input_name: str = "input"
    axes_name: str = "axes"
    ignored: tuple[str, ...] = ()
    """Columns that are left out."""


@asynccontextmanager
async def workplace(request: Request) -> AsyncIterator[Path]:
    """A folder for the files of one fleet, gone at the end."""
    settings: Settings = request.app.state.settings
    with spool.usable(), _under_way(request.app.state):
        folder = Path(tempfile.mkdtemp(prefix=PREFIX, dir=settings.spool_folder))
        with locked(folder):
            try:
                yield folder
            finally:
                await asyncio.shield(pool_of(request, "fleets").run(shutil.rmtree, folder, ignore_errors=True))


@contextmanager
def _under_way(state: State) -> Iterator[None]:
    """Have the end of the service wait for the end of this task."""
    task = asyncio.current_task()
    state.fleets_under_way.add(task)
    try:
        yield
    except asyncio.CancelledError:  # nothing but the end of the service cancels a request
        text = "the service ends before the fleet is sized; send it again"
        raise Problem(503, text, headers={"Retry-After": str(RETRY_SECONDS)}) from None
    finally:
        state.fleets_under_way.discard(task)


async def ended(state: State) -> None:
    """Wait until fleets whose requests were cancelled at the end have ended, and nothing is left of their folders.

    The server ends the process right after the application, whatever its tasks do.
    """
    if state.fleets_under_way:
        await asyncio.wait(set(state.fleets_under_way), timeout=END_SECONDS)


@contextmanager
def locked(folder: Path, *, wait: bool = True) -> Iterator[None]:
    """Hold the lock of a folder, which ends with this process; OSError where there is no wait and another holds it."""
    lock = os.open(folder, os.O_RDONLY | os.O_NOFOLLOW | os.O_DIRECTORY)  # anything else could wait: a FIFO for ever
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        yield
    finally:
        os.close(lock)


def remove_leftovers(settings: Settings) -> None:
    """Remove folders of services that were killed; one that is empty may have been made a moment ago."""
    for folder in Path(settings.spool_folder or tempfile.gettempdir()).glob(f"{PREFIX}*"):
        with suppress(OSError), locked(folder, wait=False):  # else it is held, or somebody else's
            if any(folder.iterdir()):
                shutil.rmtree(folder, ignore_errors=True)


async def size_fleet(
    request: Request, tables: Tables, *, candidates: bool = False, suffix: str | None = None
) -> Mapping[Kind, Path]:
    """Size the axes of tables in a workplace; gives files by kind, in the input's format or that of a suffix.

    Raises Problem 422 for tables that can't be used, 413 for what takes too much, 503 where too many others wait or for
    what takes too long, the wait for its turn included. A client that leaves ends the work. The body of the request has
    been read: a place that was taken before would be free to take, by a body that drips.
    """
    settings: Settings = request.app.state.settings
    pool = pool_of(request, "fleets")
    await pool.run(_require_tables, tables)
    kinds: tuple[Kind, ...] = ("answers", "rejected", "candidates") if candidates else ("answers", "rejected")
    given = suffix_of(tables.input)
    files = {kind: tables.input.with_name(f"{kind}{suffix or ANSWERED_IN.get(given, given)}") for kind in kinds}
    try:
        with pool.place():
            async with asyncio.timeout(settings.fleet_seconds):
                await while_present(request, _sized(tables, files, settings, pool))
    except TimeoutError:
        text = f"the fleet was not sized within {settings.fleet_seconds:g} s; send fewer axes at once"
        raise Problem(503, text, headers={"Retry-After": str(RETRY_SECONDS)}) from None
    return files


def _require_tables(tables: Tables) -> None:
    """Raise Problem 422 for what a look shows to be no table of axes: no process is started for that."""
    names = {tables.input: tables.input_name} | ({tables.axes: tables.axes_name} if tables.axes else {})
    for path, name in names.items():
        size, mark = path.stat().st_size, MARKS.get(suffix_of(path))
        with path.open("rb") as file:
            head = file.read(HEAD_BYTES if mark is None else len(mark[0]))
            file.seek(max(size - len(mark[1] if mark else b""), 0))
            end = file.read()
        if not size:
            raise Problem(422, f"{name}: is empty, where a table belongs")
        is_stream = path.suffix.startswith(".arrow") and head.startswith(STREAM)
        if mark is not None and (head, end) != mark and not is_stream:
            text = f"can’t be read as {suffix_of(path)[1:]}: it does not begin and end as such a file"
            raise Problem(422, f"{name}: {text}")
        if mark is None and (said := wrong_encoding(head)):
            raise Problem(422, f"{name}: {said}")
        if mark is None and b"axis" not in head:
            raise Problem(422, f"{name}: column axis is missing")


def suffix_of(path: Path) -> str:
    """Suffix of a table, `.csv.gz` as one."""
    return "".join(path.suffixes[-2:]) if path.suffix == ".gz" else path.suffix


async def _sized(tables: Tables, files: Mapping[Kind, Path], settings: Settings, pool: Pool) -> None:
    command = [sys.executable, "-m", "hpn.cli.tethered", "fleet", str(tables.input), str(files["answers"])]
    command += ["--workers", str(settings.fleet_workers)]
    beside = {"axes": tables.axes, "rejected": files["rejected"], "candidates": files.get("candidates")}
    for option, path in beside.items():
        command += [f"--{option}", str(path)] if path else []
    command += [f"--ignore={name}" for name in tables.ignored]
    messages = tables.input.with_name("messages")
    async with pool.turn:
        code = await _run(command, messages, settings)
    if code:
        if code != CALLERS:  # where there is no room, the command could not write why it ended either
            await pool.run(spool.require_room, messages.parent)
        raise _refusal(code, _end_of(messages), tables, settings)


async def _run(command: list[str], messages: Path, settings: Settings) -> int:
    """Exit code of the command, of which nothing is left when this ends, however it does."""
    with messages.open("wb") as output:
        process = await asyncio.create_subprocess_exec(
            *command, stdin=PIPE, stdout=output, stderr=STDOUT, env=_environment(settings), start_new_session=True
        )
    try:
        _restrain(process.pid, settings)
        return await _ended(process, messages.parent, settings)
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        await process.wait()


def _environment(settings: Settings) -> dict[str, str]:
    """The service's environment with its catalogue, and none of its secrets."""
    given = {
        "HPN_CATALOGUE_FOLDER": str(settings.catalogue_folder),
        "HPN_CATALOGUE_SUPPLEMENT": str(settings.catalogue_supplement or ""),
        "HPN_AVERAGING_SECONDS": str(settings.averaging_seconds),
    }
    return {name: value for name, value in os.environ.items() if not name.upper().startswith("HPN_")} | given


def _restrain(pid: int, settings: Settings) -> None:
    """Have a process, and those it starts, stand back behind the service, and take no more memory than is allowed."""
    with suppress(ProcessLookupError):
        os.setpriority(os.PRIO_PROCESS, pid, max(os.getpriority(os.PRIO_PROCESS, 0), NICENESS))
        if sys.platform == "linux":
            _, hard = resource.prlimit(pid, resource.RLIMIT_DATA)
            most = settings.fleet_memory_bytes
            resource.prlimit(pid, resource.RLIMIT_DATA, (most if hard < 0 else min(most, hard), hard))
    with suppress(OSError):  # where memory runs out, the system ends these first
        Path(f"/proc/{pid}/oom_score_adj").write_text("1000", encoding="utf-8")


async def _ended(process: Process, folder: Path, settings: Settings) -> int:
    """Exit code of a process; Problem 413 where its files take too much."""
    while process.returncode is None:
        with suppress(TimeoutError):
            async with asyncio.timeout(WATCH_SECONDS):
                await process.wait()
        if _size_of(folder) > settings.maximum_spool_bytes:
            raise Problem(413, f"what comes out takes more than {settings.maximum_spool_bytes} bytes; send fewer axes")
    return process.returncode


def _size_of(folder: Path) -> int:
    size = 0
    for file in folder.rglob("*"):
        with suppress(FileNotFoundError):
            size += file.stat().st_size
    return size


def _end_of(messages: Path) -> str:
    with messages.open("rb") as file:
        file.seek(max(messages.stat().st_size - MESSAGE_BYTES, 0))
        return file.read().decode(errors="replace").strip()


def _refusal(code: int, text: str, tables: Tables, settings: Settings) -> Exception:
    """What is answered where the command has failed: names of files are the caller's, or nothing is told of it."""
    own = {str(tables.input): tables.input_name} | ({str(tables.axes): tables.axes_name} if tables.axes else {})
    last = text.rpartition("\n")[2]  # libraries may have said something before
    if code == CALLERS and last.startswith(tuple(f"{path}: " for path in own)):
        for path, name in own.items():
            last = last.replace(path, name)
        last = last.replace("--axes", tables.axes_name)
        return Problem(422, last if len(last) <= DETAIL_LENGTH else f"{last[:DETAIL_LENGTH]}…")
    if codes := [code for code in spool.FULL_CODES if os.strerror(code) in text]:
        return spool.refusal(codes[0])
    if "memory" in last:
        return Problem(413, f"the fleet takes more than {settings.fleet_memory_bytes} bytes of memory; send fewer axes")
    if code < 0 or "hpn made a mistake" not in text:
        logger.error("a fleet was not sized: it ended with %s, and said %r", code, text[-DETAIL_LENGTH:])
        return Problem(503, "fleets can’t be sized at the moment", headers={"Retry-After": str(RETRY_SECONDS)})
    return RuntimeError(f"hpn fleet ended with {code}: {text[-DETAIL_LENGTH:]}")

"""Fleets of axes, sized by `hpn fleet` in processes of its own: what one takes, and where it fails, is its own.

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
from asyncio.subprocess import DEVNULL, STDOUT, Process
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from starlette.requests import Request

from hpn.web.door.pools import Pool, pool_of, while_present
from hpn.web.door.problems import Problem
from hpn.web.settings import Settings

Kind = Literal["answers", "rejected", "candidates"]

SUFFIXES = (".parquet", ".arrow", ".csv", ".ndjson")

PREFIX = "hpn-fleet-"
NICENESS = 10
WATCH_SECONDS = 0.5
CALLERS = 2
"""Exit code of the command for what the caller can mend."""

MESSAGE_BYTES = 4000
RETRY_SECONDS = 30

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Tables:
    """Tables of a fleet in its folder, under names of the service, and what the caller calls them."""

    input: Path
    axes: Path | None = None
    input_name: str = "input"
    axes_name: str = "axes"


@asynccontextmanager
async def workplace(request: Request) -> AsyncIterator[Path]:
    """A folder for the files of one fleet, gone at the end; Problem 503 where too many others are there.

    Taken before the tables arrive, so that what they take on the disk is bounded.
    """
    settings: Settings = request.app.state.settings
    pool = pool_of(request, "fleets")
    with pool.place(request.state.caller):
        folder = Path(tempfile.mkdtemp(prefix=PREFIX, dir=settings.spool_folder))
        lock = os.open(folder, os.O_RDONLY)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX)
            yield folder
        finally:
            try:
                await asyncio.shield(pool.run(shutil.rmtree, folder, ignore_errors=True))
            finally:
                os.close(lock)


def remove_leftovers(settings: Settings) -> None:
    """Remove folders of services that were killed; one that is empty may have been made a moment ago."""
    for folder in Path(settings.spool_folder or tempfile.gettempdir()).glob(f"{PREFIX}*"):
        with suppress(OSError):  # somebody else's, or locked
            lock = os.open(folder, os.O_RDONLY | os.O_NOFOLLOW)
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                if any(folder.iterdir()):
                    shutil.rmtree(folder, ignore_errors=True)
            finally:
                os.close(lock)


async def size_fleet(
    request: Request, tables: Tables, *, candidates: bool = False, suffix: str | None = None
) -> Mapping[Kind, Path]:
    """Size the axes of tables in a workplace; gives files by kind, in the input's format or that of a suffix.

    Raises Problem 422 for tables that can't be used, 413 for what takes too much, 503 for what takes too long, the
    wait for its turn included. Who leaves ends the work. The body of the request has been read.
    """
    settings: Settings = request.app.state.settings
    kinds: tuple[Kind, ...] = ("answers", "rejected", "candidates") if candidates else ("answers", "rejected")
    files = {kind: tables.input.with_name(f"{kind}{suffix or tables.input.suffix}") for kind in kinds}
    try:
        async with asyncio.timeout(settings.fleet_seconds):
            await while_present(request, _sized(tables, files, settings, pool_of(request, "fleets")))
    except TimeoutError:
        text = f"the fleet was not sized within {settings.fleet_seconds:g} s; send fewer axes at once"
        raise Problem(503, text, headers={"Retry-After": str(RETRY_SECONDS)}) from None
    return files


async def _sized(tables: Tables, files: Mapping[Kind, Path], settings: Settings, pool: Pool) -> None:
    command = [sys.executable, "-m", "hpn.cli", "fleet", str(tables.input), str(files["answers"])]
    command += ["--workers", str(settings.fleet_workers)]
    beside = {"axes": tables.axes, "rejected": files["rejected"], "candidates": files.get("candidates")}
    for option, path in beside.items():
        command += [f"--{option}", str(path)] if path else []
    messages = tables.input.with_name("messages")
    async with pool.turn:
        code = await _run(command, messages, settings)
    if code:
        with messages.open("rb") as file:
            raise _refusal(code, file.read(MESSAGE_BYTES).decode(errors="replace").strip(), tables, settings)


async def _run(command: list[str], messages: Path, settings: Settings) -> int:
    """Exit code of the command, of which nothing is left when this ends, however it does."""
    with messages.open("wb") as output:
        process = await asyncio.create_subprocess_exec(
            *command, stdin=DEVNULL, stdout=output, stderr=STDOUT, env=_environment(settings), start_new_session=True
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
        Path(f"/proc/{pid}/oom_score_adj").write_text("1000")


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


def _refusal(code: int, text: str, tables: Tables, settings: Settings) -> Exception:
    """What is answered where the command has failed: names of files are the caller's, or nothing is told of it."""
    own = {str(tables.input): tables.input_name} | ({str(tables.axes): tables.axes_name} if tables.axes else {})
    if code == CALLERS and text.startswith(tuple(f"{path}: " for path in own)):
        for path, name in own.items():
            text = text.replace(path, name)
        return Problem(422, text.replace("--axes", tables.axes_name))
    if "memory" in text:
        return Problem(413, f"the fleet takes more than {settings.fleet_memory_bytes} bytes of memory; send fewer axes")
    if code < 0 or not text.startswith("hpn made a mistake"):
        logger.error("a fleet was not sized: it ended with %s, and said %r", code, text)
        return Problem(503, "fleets can’t be sized at the moment", headers={"Retry-After": str(RETRY_SECONDS)})
    return RuntimeError(f"hpn fleet ended with {code}: {text}")

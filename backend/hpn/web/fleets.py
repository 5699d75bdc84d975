"""Fleets of axes, sized in processes beside the service, which end with it: what one takes, and where it fails, is its
own.

Its files stand in a folder that is locked as long as the service holds it: the next service knows what a killed one
has left.
"""

import asyncio
import fcntl
import logging
import os
import shutil
import tempfile
from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from contextlib import asynccontextmanager, contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Literal, NamedTuple, TypeVar

from starlette.datastructures import State
from starlette.requests import Request

from hpn.fleet.beside import sized
from hpn.fleet.order import ANSWERED_IN, Order, suffix_of, wrong_encoding
from hpn.web import spool
from hpn.web.door.beside import Bounds, EndedError
from hpn.web.door.pools import pool_of, while_present
from hpn.web.door.problems import Problem
from hpn.web.settings import Settings

T = TypeVar("T")
Kind = Literal["answers", "rejected", "candidates"]

MARKS = {".parquet": (b"PAR1", b"PAR1"), ".csv.gz": (b"\x1f\x8b", b"")} | dict.fromkeys(
    (".arrow", ".arrows", ".feather"), (b"ARROW1", b"ARROW1")
)
"""Beginning and end of files of a format."""

STREAM = b"\xff\xff\xff\xff"
"""Beginning of an Arrow stream; it may end in any way."""

HEAD_BYTES = 2_000_000
"""Beginning of a text, in which its first axis has to stand."""

PREFIX = "hpn-fleet-"
END_SECONDS = 5
WATCH_SECONDS = 0.5
DETAIL_LENGTH = 2000
RETRY_SECONDS = 30

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Tables:
    """Table of a fleet in its folder, under a name of the service, and what the caller calls it."""

    input: Path
    input_name: str = "input"
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
        raise Problem.later("the service ends before the table is sized; send it again", RETRY_SECONDS) from None
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


class Files(NamedTuple):
    """Files of a fleet by kind, and the columns that were ignored though nobody asked for that."""

    by_kind: Mapping[Kind, Path]
    ignored: tuple[str, ...]


def bounds_of(settings: Settings) -> Bounds:
    """Bounds of the processes that size fleets; their time is measured by the service, which ends one sooner."""
    return Bounds(settings.fleet_memory_bytes, 2 * settings.fleet_seconds)


async def size_fleet(request: Request, tables: Tables, *, candidates: bool = False) -> Files:
    """Size the axes of a table in a workplace; gives files in the input's format.

    Raises Problem 422 for a table that can't be used, 413 for what takes too much, 503 where too many others wait or
    for what takes too long, the wait for its turn included. A client that leaves ends the work. The body of the request
    has been read: a place that was taken before would be free to take, by a body that drips.
    """
    settings: Settings = request.app.state.settings
    pool = pool_of(request, "fleets")
    await pool.run(_require_table, tables)
    kinds: tuple[Kind, ...] = ("answers", "rejected", "candidates") if candidates else ("answers", "rejected")
    ending = ANSWERED_IN[suffix_of(tables.input) or ""]
    files = {kind: tables.input.with_name(f"{kind}{ending}") for kind in kinds}
    written = {str(kind): path for kind, path in files.items()}
    order = Order(tables.input, ignored=tables.ignored, **written)
    work = partial(sized, order, request.app.state.catalogue, settings.fleet_workers)
    summary = await worked(request, work, tables.input.parent)
    if summary.refusal:
        raise Problem(422, _in_words_of_the_caller(summary.refusal, tables))
    if summary.code:
        raise spool.refusal(summary.code)
    return Files(files, summary.ignored)


async def worked(request: Request, work: Callable[[], T], folder: Path | None = None) -> T:
    """Result of work in a process that sizes fleets, whose files may take so much in a folder.

    Raises Problem as `size_fleet` says.
    """
    settings: Settings = request.app.state.settings
    try:
        with pool_of(request, "fleets").place():
            async with asyncio.timeout(settings.fleet_seconds):
                return await while_present(request, _in_turn(request, work, folder))
    except TimeoutError:
        text = f"the table was not sized within {settings.fleet_seconds:g} s; send fewer axes at once"
        raise Problem.later(text, RETRY_SECONDS) from None


async def _in_turn(request: Request, call: Callable[[], T], folder: Path | None) -> T:
    settings, pool = request.app.state.settings, pool_of(request, "fleets")
    async with pool.turn:
        work = asyncio.create_task(pool.call_beside(call))
        try:
            while not work.done():
                await asyncio.wait({work}, timeout=WATCH_SECONDS)
                if folder and _size_of(folder) > (most := settings.maximum_spool_bytes):
                    raise Problem(413, f"what comes out takes more than {most} bytes; send fewer axes")
            return work.result()
        except EndedError as error:
            raise _too_much(error, settings) from None
        finally:
            work.cancel()
            await asyncio.wait({work})


def _too_much(error: EndedError, settings: Settings) -> Problem:
    if error.is_excess:
        return Problem(413, f"the table takes more than {settings.fleet_memory_bytes} bytes of memory; send fewer axes")
    if error.is_killed:
        logger.warning("a fleet was killed: %s", error)
        return Problem(413, "the table takes more memory than this machine has; send fewer axes")
    logger.error("a fleet was not sized: %s", error)
    return Problem.later("tables of axes can’t be sized at the moment", RETRY_SECONDS)


def _in_words_of_the_caller(text: str, tables: Tables) -> str:
    """A refusal with the caller's names of the files."""
    text = text.replace(str(tables.input), tables.input_name)
    return text if len(text) <= DETAIL_LENGTH else f"{text[:DETAIL_LENGTH]}…"


def _size_of(folder: Path) -> int:
    size = 0
    for file in folder.rglob("*"):
        with suppress(FileNotFoundError):
            size += file.stat().st_size
    return size


def _require_table(tables: Tables) -> None:
    """Raise Problem 422 for a file that a look shows to be no table of axes: no process is started for it."""
    path, name = tables.input, tables.input_name
    suffix = suffix_of(path) or ""
    size, mark = path.stat().st_size, MARKS.get(suffix)
    with path.open("rb") as file:
        head = file.read(HEAD_BYTES if mark is None else len(mark[0]))
        file.seek(max(size - len(mark[1] if mark else b""), 0))
        end = file.read()
    if not size:
        raise Problem(422, f"{name}: is empty, where a table belongs")
    is_stream = path.suffix.startswith(".arrow") and head.startswith(STREAM)
    if mark is not None and (head, end) != mark and not is_stream:
        text = f"can’t be read as {suffix[1:]}: it does not begin and end as such a file"
        raise Problem(422, f"{name}: {text}")
    if mark is None and (said := wrong_encoding(head)):
        raise Problem(422, f"{name}: {said}")
    if mark is None and b"axis" not in head:
        raise Problem(422, f"{name}: column axis is missing")

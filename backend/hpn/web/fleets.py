"""Fleets of axes, sized in processes beside the service, which end with it: their memory and failures don't affect it.

The files of a fleet are in a folder that stays locked while the service uses it: an unlocked folder is the leftover of
a killed service.
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
"""First and last bytes of files of a format."""

STREAM = b"\xff\xff\xff\xff"
"""First bytes of an Arrow stream; its last bytes are not fixed."""

HEAD_BYTES = 2_000_000
"""Size of the beginning of a text, which must contain the column `axis`."""

PREFIX = "hpn-fleet-"
END_SECONDS = 5
WATCH_SECONDS = 0.5
DETAIL_LENGTH = 2000
RETRY_SECONDS = 30

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Tables:
    """Table of a fleet, in its folder under the service's file name, and the caller's name for it."""

    input: Path
    input_name: str = "input"
    ignored: tuple[str, ...] = ()
    """Columns to be left out."""


@asynccontextmanager
async def workplace(request: Request) -> AsyncIterator[Path]:
    """Yield a folder for the files of one fleet; it is removed at the end."""
    settings: Settings = request.app.state.settings
    with spool.usable(), _under_way(request.app.state):
        folder = Path(tempfile.mkdtemp(prefix=PREFIX, dir=settings.spool_folder))
        with folder_lock(folder):
            try:
                yield folder
            finally:
                await asyncio.shield(pool_of(request, "fleets").run(shutil.rmtree, folder, ignore_errors=True))


@contextmanager
def _under_way(state: State) -> Iterator[None]:
    """Make the shutdown of the service wait for this task; Problem 503 if the shutdown cancels it."""
    task = asyncio.current_task()
    state.fleets_under_way.add(task)
    try:
        yield
    except asyncio.CancelledError:  # only the shutdown of the service cancels a request
        raise Problem.later("the service ends before the table is sized; send it again", RETRY_SECONDS) from None
    finally:
        state.fleets_under_way.discard(task)


async def wait_for_end(state: State) -> None:
    """Wait until fleets cancelled by the shutdown have ended and removed their folders, at most END_SECONDS.

    The server ends the process right after the application, even if tasks still run.
    """
    if state.fleets_under_way:
        await asyncio.wait(set(state.fleets_under_way), timeout=END_SECONDS)


@contextmanager
def folder_lock(folder: Path, *, wait: bool = True) -> Iterator[None]:
    """Hold the lock of a folder; it ends with this process. OSError without `wait` if another process holds it."""
    lock = os.open(folder, os.O_RDONLY | os.O_NOFOLLOW | os.O_DIRECTORY)  # anything else could block, a FIFO for ever
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        yield
    finally:
        os.close(lock)


def remove_leftovers(settings: Settings) -> None:
    """Remove folders of killed services; an empty folder is kept, as it may have just been created."""
    for folder in Path(settings.spool_folder or tempfile.gettempdir()).glob(f"{PREFIX}*"):
        with suppress(OSError), folder_lock(folder, wait=False):  # raised if it is locked or another user's
            if any(folder.iterdir()):
                shutil.rmtree(folder, ignore_errors=True)


class Files(NamedTuple):
    """Files of a fleet by kind, and columns that were ignored without the caller's request."""

    by_kind: Mapping[Kind, Path]
    ignored: tuple[str, ...]


def bounds_of(settings: Settings) -> Bounds:
    """Bounds of the processes that size fleets; their time is twice the limit at which the service itself ends them."""
    return Bounds(settings.fleet_memory_bytes, 2 * settings.fleet_seconds)


async def size_fleet(request: Request, tables: Tables, *, candidates: bool = False) -> Files:
    """Size the axes of a table in a workplace; return files in the input's format.

    Raises Problem 422 for an unusable table, 413 for a table that takes too much memory or space, 503 if too many
    others wait or the work takes too long, the wait for its turn included. The work ends when the client leaves. The
    body of the request must have been read: otherwise a slow body would occupy a place.
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
    """Result of work in a process that sizes fleets; the files in `folder` may take `maximum_spool_bytes`.

    Raises Problem 413 and 503 as `size_fleet` does.
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
    """Refusal with the caller's name of the file, shortened to DETAIL_LENGTH characters."""
    text = text.replace(str(tables.input), tables.input_name)
    return text if len(text) <= DETAIL_LENGTH else f"{text[:DETAIL_LENGTH]}…"


def _size_of(folder: Path) -> int:
    size = 0
    for file in folder.rglob("*"):
        with suppress(FileNotFoundError):
            size += file.stat().st_size
    return size


def _require_table(tables: Tables) -> None:
    """Raise Problem 422 for a file that is no table of axes by its first and last bytes, before a process starts."""
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
    if mark is None and (reason := wrong_encoding(head)):
        raise Problem(422, f"{name}: {reason}")
    if mark is None and b"axis" not in head:
        raise Problem(422, f"{name}: column axis is missing")

"""Pools of few workers with short queues, for work that would block the event loop.

A worker thread shares the interpreter's lock with the loop, so more workers would make nothing faster.
"""

import asyncio
import contextvars
import logging
import sys
import threading
from collections.abc import Awaitable, Callable, Coroutine, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from typing import Any, Literal, NamedTuple, ParamSpec, TypeVar

from starlette.requests import Request
from starlette.responses import Response

from hpn.web.door.beside import Bounds, EndedError, ProcessBeside
from hpn.web.door.observation import CLIENT_CLOSED
from hpn.web.door.problems import Problem
from hpn.words.wording import N_, Sentence

P = ParamSpec("P")
T = TypeVar("T")
PoolName = Literal["pages", "exports", "files", "batches", "metrics", "fleets"]


class Places(NamedTuple):
    """Number of workers, and of callers that may wait for one."""

    workers: int
    waiting: int


PLACES: Mapping[PoolName, Places] = {
    "pages": Places(2, sys.maxsize),  # bounded by nginx's max_conns, which limits calculations on the loop, too
    "exports": Places(1, 15),  # the longest report takes 300 MB, in a process beside the service
    "files": Places(1, 7),  # a hostile one keeps the others waiting for FILE_BOUNDS.seconds
    "batches": Places(1, 15),
    "metrics": Places(1, 3),
    "fleets": Places(1, 3),
}
"""Pages and long calculations; files to make; strangers' files to read; batches; Prometheus' requests; fleets, sized
in processes beside the service, whose number is a setting.
"""

FILE_BOUNDS = Bounds(500_000_000, 30)
"""Bounds for reading a stranger's file: a workbook of 150,000 cells takes 7 s, and listing the longest fleet 400 MB."""

TOO_LARGE = N_("This file takes too much memory or time to read: save the table alone, without formats, as CSV.")

SMALL_BYTES = 16 * 1024
"""Size up to which a body is computed on the loop: a few milliseconds, about as long as a change of threads."""

LONG_WORDS = (b"motion", b"tolerances", b"\\")
"""Text in the JSON of every motion and tolerance; a backslash may hide either word as an escape. Two thousand turns
under gravity take half a second, and so do thousands of points of a tolerance box."""

RETRY_SECONDS = 2
PATIENCE_SECONDS = 0.1
"""Time after which the service begins to check that a client still waits."""

logger = logging.getLogger(__name__)


class Pool:
    """Workers for one kind of work, with a short queue; nginx bounds how many places one address takes."""

    def __init__(self, places: Places, bounds: Bounds | None = None) -> None:
        self._executor, self._callers = (ThreadPoolExecutor(places.workers) for _ in range(2))
        self._processes = [ProcessBeside(bounds) for _ in range(places.workers)]
        self.beside = self._processes[0]
        self.turn = asyncio.Semaphore(places.workers)  # of work done in the processes, one caller per worker
        self._most = places.workers + places.waiting
        self.in_use = 0

    @contextmanager
    def place(self) -> Iterator[None]:
        """Hold a place; Problem 503 if all are taken."""
        if self.in_use >= self._most:
            text = N_("too much of this kind is being computed; try again in {seconds} s")
            raise Problem.later(Sentence(text, {"seconds": str(RETRY_SECONDS)}), RETRY_SECONDS)
        self.in_use += 1
        try:
            yield
        finally:
            self.in_use -= 1

    async def run(self, work: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """Result of work on a worker. A cancelled caller leaves the queue."""
        context = contextvars.copy_context()
        return await asyncio.wrap_future(self._executor.submit(context.run, partial(work, *args, **kwargs)))

    async def call_beside(self, work: Callable[[], T]) -> T:
        """Result of work in a process beside this one, which is killed if the caller is cancelled.

        For work that a thread can't leave before its end. The caller must hold the pool's turn. Raises EndedError if
        the process ends first.
        """
        given_up = threading.Event()
        process = next((each for each in self._processes if not each.is_taken), self.beside)
        with process.at_work():
            try:
                return await asyncio.wrap_future(self._callers.submit(process.call, work, given_up))
            except asyncio.CancelledError:
                given_up.set()
                process.end()
                raise

    async def run_beside(self, work: Callable[[], T]) -> T:
        """Result of `call_beside`; Problem 413 if the work exceeds the pool's bounds, 503 for any other end."""
        try:
            return await self.call_beside(work)
        except EndedError as error:
            if error.is_excess:
                logger.warning("a file took too much to read: %s", error)
                raise Problem(413, Sentence(TOO_LARGE)) from None
            logger.error("a process beside the service ended before its work was done: %s", error)
            text = f"this can’t be made at the moment; try again in {RETRY_SECONDS} s"
            raise Problem.later(text, RETRY_SECONDS) from None

    def close(self) -> None:
        """End the processes."""
        for process in self._processes:
            process.close()


class Pools:
    """Pools of one process, at `app.state.pools`."""

    def __init__(self, fleets: int = 1, fleet_bounds: Bounds | None = None) -> None:
        places = {**PLACES, "fleets": PLACES["fleets"]._replace(workers=fleets)}
        bounds = {"files": FILE_BOUNDS, "fleets": fleet_bounds}
        self._pools = {name: Pool(places, bounds.get(name)) for name, places in places.items()}

    def __getitem__(self, name: PoolName) -> Pool:
        return self._pools[name]

    def close(self) -> None:
        """End the processes of the pools."""
        for pool in self._pools.values():
            pool.close()


def pool_of(request: Request, name: PoolName) -> Pool:
    """Pool of the request's application."""
    pool: Pool = request.app.state.pools[name]
    return pool


async def compute(request: Request, name: PoolName, work: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
    """Result of work on a worker of a pool, for a request whose body has been read."""
    pool = pool_of(request, name)
    with pool.place():
        return await while_present(request, pool.run(work, *args, **kwargs))


async def compute_beside(request: Request, name: PoolName, work: Callable[[], T]) -> T:
    """Result of work in the process of a pool, for a request whose body has been read; Problem as `run_beside` says."""
    pool = pool_of(request, name)

    async def in_turn() -> T:
        async with pool.turn:
            return await pool.run_beside(work)

    with pool.place():
        return await while_present(request, in_turn())


async def calculate(request: Request, body: bytes, work: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
    """Result of work on a JSON body: computed on the loop for a few phases, else on a worker."""
    if len(body) <= SMALL_BYTES and not any(word in body for word in LONG_WORDS):
        return work(*args, **kwargs)
    return await compute(request, "pages", work, *args, **kwargs)


def worked(work: Callable[[Request], Response]) -> Callable[[Request], Awaitable[Response]]:
    """Route that renders a page on a worker."""

    async def route(request: Request) -> Response:
        return await compute(request, "pages", work, request)

    return route


async def while_present(request: Request, work: Coroutine[Any, Any, T]) -> T:
    """Result of work, cancelled when the client leaves; the request's body must have been read."""
    working, leaving = asyncio.create_task(work), None
    try:
        await asyncio.wait({working}, timeout=PATIENCE_SECONDS)  # most work needs no watch
        if not working.done():
            leaving = asyncio.create_task(_departure(request))
            await asyncio.wait({working, leaving}, return_when=asyncio.FIRST_COMPLETED)
        if not working.done():
            raise Problem(CLIENT_CLOSED, "the client has left")
        return working.result()
    finally:
        working.cancel()
        if leaving is not None:
            leaving.cancel()
        await asyncio.wait({working})  # so that processes it has called end, too


async def _departure(request: Request) -> None:
    while (await request.receive())["type"] != "http.disconnect":
        pass

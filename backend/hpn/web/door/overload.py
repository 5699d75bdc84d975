"""What one process holds and has waiting at most; beyond it, requests are refused before they cost anything."""

import asyncio
from time import monotonic
from typing import Any

from starlette.types import ASGIApp, Message, Receive, Scope, Send
from structlog.typing import FilteringBoundLogger

from hpn.web.door.metrics import Metrics
from hpn.web.door.problems import Problem

PIECE_BYTES = 64 * 1024
"""What the server is handed of an answer at once; it takes the next piece when the client has read enough."""

QUEUE = 256
"""Requests that one turn of the event loop answers at most: what comes while others take the processor for 0.4 s."""

ANSWERED = 1
"""Requests that a turn answers in an overload: that is how long an answer then waits."""

CROWD, WINDOW_SECONDS, CROWDED_WINDOWS = 64, 1.0, 2
"""Where most requests come in turns of more than a crowd, for so many windows of time on end, that is an overload."""

SPARE_SHARE = 0.1
"""An overload ends once all that came in a window would have left the process this share of its time.

Neither a refusal nor idle time is a sign: at half of capacity a tenth of the requests and more arrive while another is
answered, and a client that is held up for a moment leaves any overload some time.
"""

RETRY_SECONDS = 1
ALWAYS = frozenset({"/healthz", "/readyz", "/metrics"})
"""A process that is busy is alive: else it would be ended, and the others get its load."""


def _busy() -> Problem:
    text = f"the service has too much to do; try again in {RETRY_SECONDS} s"
    return Problem(503, text, headers={"Retry-After": str(RETRY_SECONDS)})


class Budget:
    """Bytes that all requests of a process hold: bodies until they are answered, answers until they are sent."""

    def __init__(self, total: int) -> None:
        self.total = total
        self.held = 0


class Held:
    """Bytes that one request holds, at `request.state.held`."""

    def __init__(self, budget: Budget) -> None:
        self._budget = budget
        self._count = 0

    def take(self, count: int) -> None:
        """Hold more; raises Problem 503 where that is too much for the process."""
        if self._budget.held + count > self._budget.total:
            raise _busy()
        self.add(count)

    def add(self, count: int) -> None:
        """Hold more, which is there already; while it is too much, others are refused."""
        self._count += count
        self._budget.held += count

    def release(self) -> None:
        """Hold nothing."""
        self._budget.held -= self._count
        self._count = 0


class Pieces:
    """Counts what each request holds, and sends its answer in pieces, so that the server need not keep all of it."""

    def __init__(self, app: ASGIApp, budget: Budget) -> None:
        self.app = app
        self._budget = budget

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        held = scope.setdefault("state", {})["held"] = Held(self._budget)

        async def send_pieces(message: Message) -> None:
            body = message.get("body", b"")
            if len(body) <= PIECE_BYTES:
                await send(message)
                return
            held.add(len(body))
            for start in range(0, len(body), PIECE_BYTES):
                more = message.get("more_body", False) or start + PIECE_BYTES < len(body)
                await send({**message, "body": body[start : start + PIECE_BYTES], "more_body": more})
                await asyncio.sleep(0)  # to compress a piece takes a millisecond

        try:
            await self.app(scope, receive, send_pieces)
        finally:
            held.release()


class Overload:
    """Refuses what the process can't do in time, at the cost of an answer that is ready.

    Requests that have arrived wait for a turn of the event loop. A crowd is served; where crowds come again and again,
    each turn serves the first, and it soon, until there is time for all that come.
    """

    def __init__(self, app: ASGIApp, budget: Budget, metrics: Metrics, logger: FilteringBoundLogger) -> None:
        self.app = app
        self._budget, self._metrics, self._logger = budget, metrics, logger
        self._refusal = _busy().response()
        self._count = self._refused = 0
        self._overloaded = False
        self._crowded = self._windows = 0
        self._task: asyncio.Task[Any] | None = None
        self._arrived = self._turns = 0
        self._window_began = self._turn_began = self._busy = 0.0

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or refuse it."""
        if scope["type"] == "http" and scope["path"] not in ALWAYS and self._is_too_much():
            self._refused += 1
            self._metrics.refused()
            await self._refusal(scope, receive, send)
            return
        await self.app(scope, receive, send)

    def _is_too_much(self) -> bool:
        if not self._count:
            self._task, self._turn_began = None, monotonic()
            asyncio.get_running_loop().call_soon(self._end_turn)  # behind all that have arrived by now
        task = asyncio.current_task()
        self._count += task is not self._task  # a caller in the same process may ask several times in its turn
        self._task = task
        return self._count > (ANSWERED if self._overloaded else QUEUE) or self._budget.held >= self._budget.total

    def _end_turn(self) -> None:
        now = monotonic()
        self._busy += now - self._turn_began
        self._arrived, self._turns = self._arrived + self._count, self._turns + 1
        self._crowded += self._count if self._count > CROWD else 0
        self._count = 0
        if now - self._window_began >= WINDOW_SECONDS:
            self._end_window(now - self._window_began)
            self._window_began, self._busy = now, 0.0
            self._arrived = self._turns = self._crowded = 0

    def _end_window(self, seconds: float) -> None:
        """Begin an overload where crowds have come for long enough, or end it where there is time for all."""
        if self._overloaded:  # each turn has answered ANSWERED, and that is most of what the loop was busy with
            changes = self._busy * self._arrived / (self._turns * ANSWERED) < seconds * (1 - SPARE_SHARE)
        else:
            self._windows = self._windows + 1 if self._crowded > self._arrived / 2 else 0
            changes = self._windows == CROWDED_WINDOWS
        if changes:
            self._overloaded, self._windows = not self._overloaded, 0
            self._logger.warning("overload begins" if self._overloaded else "overload ends", refused=self._refused)
            self._refused = 0

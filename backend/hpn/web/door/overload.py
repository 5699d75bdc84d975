"""What one process holds and has waiting at most; beyond it, requests are refused before they cost anything."""

import asyncio

from starlette.types import ASGIApp, Message, Receive, Scope, Send
from structlog.typing import FilteringBoundLogger

from hpn.web.door.metrics import Metrics
from hpn.web.door.problems import Problem

PIECE_BYTES = 64 * 1024
"""What the server is handed of an answer at once; it takes the next piece when the client has read enough."""

CROWD, CROWDED_SECONDS = 32, 1.0
"""More requests than this waiting in every turn of the event loop, for as long as this, are an overload."""

ANSWERED = 2
"""Requests of each turn that are answered in an overload: that is how long an answer then waits."""

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

    Requests that have arrived wait for a turn of the event loop. A crowd is served as long as it passes; of one that
    stays, each turn serves the first few, so that these are served soon, until a second has gone by without a refusal.
    """

    def __init__(self, app: ASGIApp, budget: Budget, metrics: Metrics, logger: FilteringBoundLogger) -> None:
        self.app = app
        self._budget, self._metrics, self._logger = budget, metrics, logger
        self._refusal = _busy().response()
        self._count = self._refused = 0
        self._overloaded = False
        self._since: float | None = None

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
            asyncio.get_running_loop().call_soon(self._end_turn)  # behind all that have arrived by now
        self._count += 1
        return (self._overloaded and self._count > ANSWERED) or self._budget.held >= self._budget.total

    def _end_turn(self) -> None:
        """Change the state when, for as long as it takes, each turn has said that it should be the other."""
        now = asyncio.get_running_loop().time()
        crowded = self._count > (ANSWERED if self._overloaded else CROWD)
        self._count = 0
        if crowded == self._overloaded:
            self._since = None
            return
        self._since = now if self._since is None else self._since
        if now - self._since > CROWDED_SECONDS:
            self._overloaded, self._since = crowded, None
            self._logger.warning("overload begins" if crowded else "overload ends", refused=self._refused)
            self._refused = 0

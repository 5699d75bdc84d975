"""What every request passes first: it gets an id, headers for its response, a line in the log, a metric."""

import asyncio
import time
from collections.abc import Mapping
from typing import Any

from starlette.types import ASGIApp, Message, Receive, Scope, Send
from structlog.typing import FilteringBoundLogger

from hpn.web.door.logs import REQUEST, request_id
from hpn.web.door.metrics import Metrics
from hpn.web.door.problems import JSON, mistake

QUIET = frozenset({"/healthz", "/readyz", "/metrics"})
"""Routes that are asked every few seconds; seen at level debug."""

GONE = 499
"""Status of a request whose caller left before the answer, as proxies count it."""

DOCUMENT_HEADERS = (
    (
        b"content-security-policy",
        b"default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
        b"base-uri 'none'; form-action 'self'; frame-ancestors 'none'",
    ),
    (b"referrer-policy", b"same-origin"),
)
"""What keeps a page to its own host. A caller's program reads each header in as long as the server takes to write
three: JSON, which loads nothing and leads nowhere, goes without these, and so does what has no content."""

EMPTY = frozenset({204, 304})
"""Statuses of answers without content."""

NOT_TO_GUESS = (b"x-content-type-options", b"nosniff")
"""JSON, or any other content, is not to be taken for a page."""

RESPONSE_HEADERS = "hpn.response_headers"
"""Place in the scope for headers that layers further in add to the response, whatever it will be."""


class Observation:
    """Gives each request an id, and counts and logs it. What goes wrong is logged once, and answered as a problem."""

    def __init__(self, app: ASGIApp, logger: FilteringBoundLogger, metrics: Metrics, routes: Mapping[Any, str]) -> None:
        self.app = app
        self._logger = logger
        self._metrics = metrics
        self._routes = routes

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, and note what becomes of it."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        start, status, id = time.perf_counter(), 0, request_id(scope["headers"])
        token = REQUEST.set(id)
        added = scope[RESPONSE_HEADERS] = [NOT_TO_GUESS, (b"x-request-id", id)]

        async def observed(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                headers = message["headers"] = [*message.get("headers", ()), *added]
                if JSON not in headers and status not in EMPTY:
                    headers += DOCUMENT_HEADERS
            await send(message)

        try:
            await self.app(scope, receive, observed)
        except Exception:
            self._logger.exception("error", route=self._route(scope), method=scope["method"])
            # Of an answer that has begun only the end can be withheld.
            if status == 0:
                await mistake().response()(scope, receive, observed)
        finally:
            # The server sends what was written when its loop comes round: the caller does not wait for these notes.
            seconds = time.perf_counter() - start
            asyncio.get_running_loop().call_soon(self._note, scope, status or GONE, seconds)
            REQUEST.reset(token)

    def _note(self, scope: Scope, status: int, seconds: float) -> None:
        route, method = self._route(scope), scope["method"]
        self._metrics.request(route, method, status, seconds)
        client = scope.get("client")
        (self._logger.debug if route in QUIET else self._logger.info)(
            "request",
            method=method,
            route=route,
            status=status,
            duration_ms=round(1000 * seconds, 3),
            client=client[0] if client else None,
            key=scope.get("api_key"),
        )

    def _route(self, scope: Scope) -> str:
        """Template of the route, never the address itself: it could hold what the caller asked."""
        route = scope.get("route")
        return route.path if route is not None else self._routes.get(scope.get("endpoint"), "none")

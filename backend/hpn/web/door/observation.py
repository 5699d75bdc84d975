"""Outermost step of every request: an id, headers for its response, a line in the log, a metric."""

import time
from collections.abc import Mapping

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import Request
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from structlog.typing import FilteringBoundLogger

from hpn.web.door.logs import REQUEST, request_id
from hpn.web.door.metrics import Metrics
from hpn.web.door.problems import mistake

QUIET = frozenset({"/healthz", "/readyz", "/metrics"})
"""Routes that are asked every few seconds; seen at level debug."""

GONE = 499
"""Status of a request whose caller left before the answer, as proxies count it."""

STYLES_OF_PLOTLY = (
    "'sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU='",  # an empty element, whose rules its script adds
    "'sha256-S+l+cz1wXqs2B0FcjqqT7NvjwGmhD1UjJswXjlSkj0s='",  # font-size:70%, of an index such as that of T_R
    "'unsafe-hashes'",  # the second is of an attribute
)
"""The two inline styles there are: the plot library writes them, and has no way around either."""

UNUSED_FEATURES = (
    "accelerometer",
    "autoplay",
    "camera",
    "clipboard-read",
    "display-capture",
    "encrypted-media",
    "fullscreen",
    "geolocation",
    "gyroscope",
    "hid",
    "idle-detection",
    "local-fonts",
    "magnetometer",
    "microphone",
    "midi",
    "payment",
    "picture-in-picture",
    "publickey-credentials-create",
    "publickey-credentials-get",
    "screen-wake-lock",
    "serial",
    "usb",
    "xr-spatial-tracking",
)
"""Features of a browser, all off: a page of this service only writes to the clipboard."""

SECURITY_HEADERS = {
    "Content-Security-Policy": f"default-src 'self'; style-src 'self' {' '.join(STYLES_OF_PLOTLY)}; "
    "img-src 'self' data: blob:; base-uri 'none'; form-action 'self'; frame-ancestors 'none'",
    "Cross-Origin-Opener-Policy": "same-origin",
    # A request that CORS permits is not held to this.
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": ", ".join(f"{feature}=()" for feature in UNUSED_FEATURES),
    "Referrer-Policy": "same-origin",
    "X-Content-Type-Options": "nosniff",
}
"""Headers of every answer: a page loads from its own host alone, and no other content is taken for a page."""


def add_headers(request: Request, headers: Mapping[str, str]) -> None:
    """Have the response carry these headers, whatever it will be."""
    request.state.response_headers.update(headers)


def note(request: Request, **fields: str) -> None:
    """Have the request's line in the log say this, too."""
    request.scope["state"].setdefault("noted", {}).update(fields)


class Observation:
    """Gives each request an id, and counts and logs it. An error is logged once, and answered as a problem."""

    def __init__(self, app: ASGIApp, logger: FilteringBoundLogger, metrics: Metrics) -> None:
        self.app = app
        self._logger = logger
        self._metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, and note what becomes of it."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        start, status, id = time.perf_counter(), 0, request_id(Headers(scope=scope))
        token = REQUEST.set(id)
        added = {**SECURITY_HEADERS, "X-Request-ID": id}
        scope.setdefault("state", {})["response_headers"] = added

        async def observed(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                MutableHeaders(scope=message).update(added)
            await send(message)

        try:
            await self.app(scope, receive, observed)
        except Exception:
            self._logger.exception("error", route=_route(scope), method=scope["method"])
            # Of an answer that has begun only the end can be withheld.
            if status == 0:
                await mistake().response()(scope, receive, observed)
        finally:
            self._note(scope, status or GONE, time.perf_counter() - start)
            REQUEST.reset(token)

    def _note(self, scope: Scope, status: int, seconds: float) -> None:
        route, method = _route(scope), scope["method"]
        self._metrics.request(route, method, status, seconds)
        client = scope.get("client")
        (self._logger.debug if route in QUIET else self._logger.info)(
            "request",
            method=method,
            route=route,
            status=status,
            duration_ms=round(1000 * seconds, 3),
            client=client[0] if client else None,
            key=scope["state"].get("api_key"),
            **scope["state"].get("noted", {}),
        )


def _route(scope: Scope) -> str:
    """Template of the route, never the address itself: it could hold what the caller asked."""
    return getattr(scope.get("route"), "path", "none")

"""Outermost layer of every request: an id, headers for its response, a line in the log, a metric."""

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
"""Routes that are asked every few seconds; logged at level debug."""

CLIENT_CLOSED = 499
"""Status by which proxies, too, count a request whose caller left before the answer."""

STYLES_OF_PLOTLY = (
    "'sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU='",  # an empty element; the library's script adds its rules
    "'sha256-S+l+cz1wXqs2B0FcjqqT7NvjwGmhD1UjJswXjlSkj0s='",  # font-size:70%, of a subscript such as R in T_R
    "'unsafe-hashes'",  # needed as the second is an attribute's style
)
"""The only two inline styles: the plot library writes both, and can't be kept from it."""

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
"""Browser features, all switched off: a page of this service only writes to the clipboard."""

SECURITY_HEADERS = {
    "Content-Security-Policy": f"default-src 'self'; style-src 'self' {' '.join(STYLES_OF_PLOTLY)}; "
    "img-src 'self' data: blob:; base-uri 'none'; form-action 'self'; frame-ancestors 'none'",
    "Cross-Origin-Opener-Policy": "same-origin",
    # Requests that CORS permits are exempt.
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": ", ".join(f"{feature}=()" for feature in UNUSED_FEATURES),
    "Referrer-Policy": "same-origin",
    "X-Content-Type-Options": "nosniff",
}
"""Headers of every answer: a page loads only from its own host, and browsers don't take other content for a page."""


def add_headers(request: Request, headers: Mapping[str, str]) -> None:
    """Add headers to the response, an error's included."""
    request.state.response_headers.update(headers)


def note(request: Request, **fields: str) -> None:
    """Add fields to the request's line in the log."""
    request.scope["state"].setdefault("noted", {}).update(fields)


class Observation:
    """Gives each request an id, counts and logs it. An unexpected error is logged once, and answered as a problem."""

    def __init__(self, app: ASGIApp, logger: FilteringBoundLogger, metrics: Metrics) -> None:
        self.app = app
        self._logger = logger
        self._metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, and record its outcome."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        start, status, id = time.perf_counter(), 0, request_id(Headers(scope=scope))
        token = REQUEST.set(id)
        headers = {**SECURITY_HEADERS, "X-Request-ID": id}
        scope.setdefault("state", {})["response_headers"] = headers

        async def observed(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                MutableHeaders(scope=message).update(headers)
            await send(message)

        try:
            await self.app(scope, receive, observed)
        except Exception:
            self._logger.exception("error", route=_route(scope), method=scope["method"])
            # An answer that has begun can only be cut off.
            if status == 0:
                await mistake().response()(scope, receive, observed)
        finally:
            self._note(scope, status or CLIENT_CLOSED, time.perf_counter() - start)
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
    """Template of the route, never the address itself: the address can contain the caller's input."""
    return getattr(scope.get("route"), "path", "none")

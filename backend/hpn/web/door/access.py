"""Who may do what, how often: API keys and rate limits, in front of every route."""

from collections.abc import Callable, Mapping

from starlette.types import ASGIApp, Receive, Scope, Send

from hpn.web.door.keys import holder, presented_key
from hpn.web.door.observation import RESPONSE_HEADERS
from hpn.web.door.problems import Problem
from hpn.web.door.rates import Admission, Limiter, subject_of
from hpn.web.settings import Group, Settings

API = "/api/v1"
OPEN = ("/healthz", "/readyz", "/openapi.json", "/static/")
"""What load balancers and browsers must always reach: neither guarded nor limited."""

LIMIT_OF: Mapping[Group, str] = {
    "calculator": "calculator",
    "reading": "calculator",
    "listing": "calculator",
    "batch": "batch",
    "writing": "writing",
    "deleting": "writing",
}
"""Which rate counts a group's requests."""


def group_of(method: str, path: str) -> Group | None:
    """Group of a route by its template; None for what is open to all. Page and API of a thing are of one group."""
    place = path.removeprefix(API)
    if place == "/select/batch":
        return "batch"
    if place == "/selections" or place.startswith("/selections/"):
        if method in ("GET", "HEAD", "OPTIONS"):
            return "listing" if place in ("/selections", "/selections/") else "reading"
        return "deleting" if method == "DELETE" else "writing"
    if path == "/metrics":
        return "metrics"
    if path == "/oembed":  # it tells what a saved selection is about
        return "reading"
    return None if path.startswith(OPEN) else "calculator"


class Gate:
    """Answers 401 where a key is needed, 429 where there were too many requests, and lets the rest pass.

    `template_of` gives the template of the route that the router will take: the path's own text can be spelled in ways
    that the router takes for the same.
    """

    def __init__(self, app: ASGIApp, settings: Settings, template_of: Callable[[Scope], str]) -> None:
        self.app = app
        self._template_of = template_of
        self._keys = settings.api_keys
        self._guarded = settings.guarded if settings.api_keys else frozenset()
        self._limiter = Limiter(
            {
                "calculator": settings.calculator_rate,
                "batch": settings.batch_rate,
                "writing": settings.writing_rate,
            }
        )

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or answer it."""
        group = group_of(scope["method"], self._template_of(scope)) if scope["type"] == "http" else None
        if group is None:
            await self.app(scope, receive, send)
            return
        name = self._holder(scope)
        scope["api_key"] = name
        admission = self._limiter.admit(LIMIT_OF.get(group, ""), f"key {name}" if name else _subject(scope))
        if admission and not admission.granted:
            await too_many(admission)(scope, receive, send)
        elif name is None and group in self._guarded:
            await key_needed(scope["path"])(scope, receive, send)
        else:
            if admission:
                scope.setdefault(RESPONSE_HEADERS, []).extend(admission.headers)
            await self.app(scope, receive, send)

    def _holder(self, scope: Scope) -> str | None:
        presented = presented_key(scope["headers"]) if self._keys else None
        return None if presented is None else holder(presented, self._keys)


def _subject(scope: Scope) -> str:
    client = scope.get("client")
    return subject_of(client[0]) if client else "unknown"


def too_many(admission: Admission) -> ASGIApp:
    """429, with the time to wait."""
    headers = {name.decode(): value.decode() for name, value in admission.headers}
    text = f"{admission.rate} are allowed; try again in {admission.wait_seconds} s"
    return Problem(429, text, headers={"Retry-After": str(admission.wait_seconds), **headers}).response()


def key_needed(path: str) -> ASGIApp:
    """401; on a page the browser asks for the key itself, as a password with any user name."""
    scheme = "Bearer" if path.startswith("/api/") else "Basic"
    text = "send a valid key as `Authorization: Bearer …` or `X-API-Key: …`"
    return Problem(401, text, headers={"WWW-Authenticate": f'{scheme} realm="HPN Select"'}).response()

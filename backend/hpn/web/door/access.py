"""Access by keys and rates: every route declares its group, and a dependency of the route checks key and rate.

FastAPI runs dependencies for the route that the router has matched, so another spelling of a path changes nothing.
"""

from collections.abc import Mapping
from typing import Any

from fastapi import Depends
from fastapi.routing import RouteContext
from starlette.requests import Request

from hpn.web.door.keys import holder, presented_key
from hpn.web.door.observation import add_headers
from hpn.web.door.parameters import require_declared
from hpn.web.door.problems import Problem
from hpn.web.door.rates import Limiter, subject_of
from hpn.web.settings import RouteGroup, Settings

LIMIT_OF: Mapping[RouteGroup, str] = {
    "calculator": "calculator",
    "reading": "calculator",
    "listing": "calculator",
    "batch": "batch",
    "writing": "writing",
    "deleting": "writing",
    "metrics": "metrics",
}
"""Which rate counts a group's requests."""

MAXIMUM_QUERY_BYTES = 60_000
"""Longest query, which servers and proxies on the way let through."""

SAVED: frozenset[RouteGroup] = frozenset({"reading", "listing", "writing", "deleting"})
"""Groups whose answers tell of saved selections."""

API = ("/api/", "/mcp")
"""Where the paths that programs ask for begin."""

ADMIN = "admin"
"""Name of the key that renames and deletes what any key, or none, has saved."""


class Gate:
    """Admits requests by the keys and rates of the settings; one per application, at `app.state.gate`."""

    def __init__(self, settings: Settings) -> None:
        self._keys = settings.api_keys
        self._guarded = settings.guarded if settings.api_keys else frozenset()
        self._limiter = Limiter(
            {
                "calculator": settings.calculator_rate,
                "batch": settings.batch_rate,
                "writing": settings.writing_rate,
                "metrics": settings.calculator_rate,  # counted apart, so that a busy page leaves room to look at it
            }
        )

    def admit(self, request: Request, group: RouteGroup) -> None:
        """Count a request; raises Problem 429 where there were too many, then 401 for a key unknown or missing."""
        presented = presented_key(request.headers.raw) if self._keys else None
        name = request.state.api_key = None if presented is None else holder(presented, self._keys)
        caller = request.state.caller = f"key {name}" if name else _subject(request)
        if group in SAVED:
            add_headers(request, {"Cache-Control": "private, no-cache"})
        counted = self._limiter.admit(LIMIT_OF[group], caller)
        if counted is not None:
            add_headers(request, counted.headers)
            if not counted.granted:
                raise too_many(counted.rate, counted.wait_seconds)
        if name is None and (presented is not None or group in self._guarded):
            raise key_needed(request.scope["path"], is_unknown=bool(presented))
        if len(request.scope.get("query_string", b"")) > MAXIMUM_QUERY_BYTES:
            raise Problem(414, f"a link may have {MAXIMUM_QUERY_BYTES} bytes at most; post what is longer")

    @property
    def has_keys(self) -> bool:
        """True where what is saved belongs to keys; without any, everybody may rename and delete."""
        return bool(self._keys)

    def require_owner(self, request: Request, owner: str | None) -> None:
        """Raise Problem 403 unless the request's key owns what it is to change, or is the one that may change any.

        On a page, where no key was sent, raise 401: the browser then asks for one.
        """
        name, path = request.state.api_key, request.scope["path"]
        if name is None and not path.startswith(API):
            raise key_needed(path)
        if name is None or name not in (ADMIN, owner):
            sent = "no key was sent" if name is None else f"the key {name} did not save it"
            text = f"{sent}; only the key that saved this selection, or the one named {ADMIN}, may rename or delete it"
            raise Problem(403, text)


class _Admission:
    """The dependency by which a route belongs to a group."""

    def __init__(self, group: RouteGroup) -> None:
        self.group = group

    async def __call__(self, request: Request) -> None:
        """Pass the request, or raise Problem; a route of the API takes the parameters that it declares alone."""
        gate: Gate = request.app.state.gate
        gate.admit(request, self.group)
        if request.scope["path"].startswith(API):
            require_declared(request)


async def _pass(request: Request) -> None:
    """Neither guarded nor limited."""


def admit(group: RouteGroup) -> Any:
    """The dependency of a route of this group."""
    return Depends(_Admission(group))


OPEN: Any = Depends(_pass)
"""The dependency of a route that load balancers and browsers must always reach."""


def group_of(route: RouteContext) -> RouteGroup | None:
    """Group that a route declares, None for one that is open; LookupError for one that declares neither."""
    declared = getattr(route, "dependencies", ())  # a route of Starlette's own has none
    for dependency in declared:
        if isinstance(dependency.dependency, _Admission):
            return dependency.dependency.group
    if OPEN in declared:
        return None
    raise LookupError(f"{route.path} declares no group: give it `admit(...)` or `OPEN` as a dependency")


def _subject(request: Request) -> str:
    return subject_of(request.client.host) if request.client else "unknown"


def too_many(rate: object, wait_seconds: int) -> Problem:
    """429, with the time to wait."""
    return Problem.later(f"{rate} are allowed; try again in {wait_seconds} s", wait_seconds, 429)


def key_needed(path: str, *, is_unknown: bool = False) -> Problem:
    """401; on a page the browser asks for the key itself, as a password with any user name."""
    scheme = "Bearer" if path.startswith(API) else "Basic"
    text, kind = "a key is needed: send it as `Authorization: Bearer …` or `X-API-Key: …`", "api-key-needed"
    if is_unknown:
        text, kind = "the key that was sent is none of this service: it is mistyped, or withdrawn", "api-key-unknown"
    return Problem(401, text, headers={"WWW-Authenticate": f'{scheme} realm="HPN Select"'}, kind=kind)

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
from hpn.words.wording import N_, Sentence

LIMIT_OF: Mapping[RouteGroup, str] = {
    "calculator": "calculator",
    "reading": "calculator",
    "listing": "calculator",
    "batch": "batch",
    "writing": "writing",
    "deleting": "writing",
    "metrics": "metrics",
}
"""Name of the rate that counts the requests of a group."""

MAXIMUM_QUERY_BYTES = 60_000
"""Longest query; servers and proxies on the way let this much through."""

SAVED: frozenset[RouteGroup] = frozenset({"reading", "listing", "writing", "deleting"})
"""Groups whose answers contain saved data; they are private and asked for anew each time."""

API = ("/api/", "/mcp")
"""Beginnings of the paths for programs."""

ADMIN = "admin"
"""Name of the key that may rename and delete every selection, whichever key saved it, or none."""


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
        """Count a request. Raise Problem 429 for too many, 401 for an unknown or missing key, 414 for a long query."""
        presented = presented_key(request.headers.raw) if self._keys else None
        name = request.state.api_key = None if presented is None else holder(presented, self._keys)
        subject = subject_of(request.client.host) if request.client else "unknown"
        caller = request.state.caller = f"key {name}" if name else subject
        if group in SAVED:
            add_headers(request, {"Cache-Control": "private, no-cache"})
        counted = self._limiter.admit(LIMIT_OF[group], caller)
        if counted is not None:
            add_headers(request, counted.headers)
            if not counted.granted:
                raise too_many(counted.rate, counted.wait_seconds)
        if name is None and (presented is not None or not self.may(request, group)):
            raise key_needed(request.scope["path"], is_unknown=bool(presented))
        if len(request.scope.get("query_string", b"")) > MAXIMUM_QUERY_BYTES:
            raise Problem(414, f"a link may have {MAXIMUM_QUERY_BYTES} bytes at most; post what is longer")

    def may(self, request: Request, group: RouteGroup) -> bool:
        """True if a group needs no key, or the request has one."""
        return group not in self._guarded or request.state.api_key is not None

    def require(self, request: Request, group: RouteGroup) -> None:
        """Raise Problem 401 unless a request may do what a group does, besides the group of its route."""
        if not self.may(request, group):
            raise key_needed(request.scope["path"])

    @property
    def has_keys(self) -> bool:
        """True if the service has keys, to which saved data belong; without keys everybody may rename and delete."""
        return bool(self._keys)

    def may_change(self, request: Request, owner: str | None) -> bool:
        """True if a request's key may change data of an owner; always true on a service without keys."""
        return not self._keys or request.state.api_key in (ADMIN, owner or ADMIN)

    def require_owner(self, request: Request, owner: str | None) -> None:
        """Raise Problem 403 unless a request may change data of an owner.

        Raise 401 for a page that was asked for without a key: the browser then asks the reader for one.
        """
        if self.may_change(request, owner):
            return
        name, path = request.state.api_key, request.scope["path"]
        if name is None and not path.startswith(API):
            raise key_needed(path)
        reason = "no key was sent" if name is None else f"the key {name} did not save it"
        text = f"{reason}; only the key that saved this selection, or the one named {ADMIN}, may rename or delete it"
        raise Problem(403, text)

    def require_key_to_edit(self, request: Request, owner: str | None) -> None:
        """Raise Problem 401 or 403 as `require_owner` does, if the page's address has the parameter `edit`."""
        if "edit" in request.query_params:
            self.require_owner(request, owner)


class _Admission:
    """Dependency that puts a route into a group."""

    def __init__(self, group: RouteGroup) -> None:
        self.group = group

    async def __call__(self, request: Request) -> None:
        """Admit the request or raise Problem; a route of the API takes only parameters that it declares."""
        gate: Gate = request.app.state.gate
        gate.admit(request, self.group)
        if request.scope["path"].startswith(API):
            require_declared(request)


async def _pass(request: Request) -> None:
    """Admit every request: no key, no limit."""


def admit(group: RouteGroup) -> Any:
    """Dependency of a route of this group."""
    return Depends(_Admission(group))


OPEN: Any = Depends(_pass)
"""Dependency of a route that load balancers and browsers must always reach."""


def group_of(route: RouteContext) -> RouteGroup | None:
    """Group that a route declares, None for an open route; LookupError for a route that declares neither."""
    declared = getattr(route, "dependencies", ())  # a route of Starlette's own has none
    for dependency in declared:
        if isinstance(dependency.dependency, _Admission):
            return dependency.dependency.group
    if OPEN in declared:
        return None
    raise LookupError(f"{route.path} declares no group: give it `admit(...)` or `OPEN` as a dependency")


def too_many(rate: object, wait_seconds: int) -> Problem:
    """Problem 429 with the time to wait."""
    values = {"rate": str(rate), "seconds": str(wait_seconds)}
    return Problem.later(Sentence(N_("{rate} are allowed; try again in {seconds} s"), values), wait_seconds, 429)


def key_needed(path: str, *, is_unknown: bool = False) -> Problem:
    """Problem 401; on a page the browser asks for the key, as the password of any user name."""
    scheme = "Bearer" if path.startswith(API) else "Basic"
    text, kind = "a key is needed: send it as `Authorization: Bearer …` or `X-API-Key: …`", "api-key-needed"
    if is_unknown:
        text, kind = "the key that was sent is none of this service: it is mistyped, or withdrawn", "api-key-unknown"
    return Problem(401, text, headers={"WWW-Authenticate": f'{scheme} realm="HPN Select"'}, kind=kind)

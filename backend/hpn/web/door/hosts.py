"""Hosts for which the service answers, and origins of its forms: links lead to this service, and pages of other sites
can read and change nothing.
"""

from collections.abc import Collection
from ipaddress import IPv6Address, ip_address
from typing import Any

from starlette.requests import HTTPConnection, Request
from starlette.types import ASGIApp, Receive, Scope, Send
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

from hpn.web.door.problems import Problem
from hpn.words.wording import N_

ANY_HOST = frozenset({"/healthz", "/readyz"})
"""Paths that load balancers ask for by IP address; their answers contain no link."""

LOCAL = frozenset({"localhost", "127.0.0.1", "::1"})
"""Names of the local machine."""

LONGEST_NAMED = 100
"""Characters of a host that an error quotes."""


def is_loopback(host: str) -> bool:
    """True for a loopback address, an IPv4-mapped one too, and for `localhost`."""
    try:
        address = ip_address(host.strip("[]"))
    except ValueError:
        return host == "localhost"
    mapped = address.ipv4_mapped if isinstance(address, IPv6Address) else None
    return (mapped or address).is_loopback


class Proxies(ProxyHeadersMiddleware):
    """Takes the caller's address and scheme from a trusted proxy's headers, and marks the request as proxied."""

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """Pass the request on."""
        if client := scope.get("client"):
            scope.setdefault("state", {})["proxied"] = client[0] in self.trusted_hosts
        await super().__call__(scope, receive, send)


class Hosts:
    """Refuses requests for hosts that are not permitted; the port does not matter.

    If the settings name no host, a request over loopback and not from a trusted proxy must be for the local machine:
    otherwise a page of another site could read and save through a name of its own that resolves to 127.0.0.1.

    Starlette's own middleware would refuse in plain text. The host checked is the one that links are made with: that of
    the server's socket where the Host header is missing or invalid.
    """

    def __init__(self, app: ASGIApp, allowed: Collection[str]) -> None:
        self.app = app
        self._names = frozenset(host.strip("[]") for host in allowed)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or answer 421."""
        app = self.app
        if scope["type"] == "http" and scope["path"] not in ANY_HOST and not self._allows(scope):
            app = _refusal(HTTPConnection(scope)).response()
        await app(scope, receive, send)

    def _allows(self, scope: Scope) -> bool:
        names = self._names or (LOCAL if _for_this_machine(scope) else None)
        if names is None:
            return True
        host = HTTPConnection(scope).base_url.hostname or ""
        return host in names or any(name.startswith("*.") and host.endswith(name[1:]) for name in names)


def _for_this_machine(scope: Scope) -> bool:
    server = scope.get("server")
    return server is not None and is_loopback(server[0]) and not scope.get("state", {}).get("proxied", False)


def _refusal(connection: HTTPConnection) -> Problem:
    host = connection.headers.get("host", "")[:LONGEST_NAMED]
    return Problem(
        421, f"the service does not answer for the host {host!r}; HPN_ALLOWED_HOSTS names those it answers for"
    )


def require_same_origin(request: Request) -> None:
    """Raise Problem 403 for a form sent by a page of another site. Programs send neither header and pass."""
    site = request.headers.get("sec-fetch-site")
    origin = request.headers.get("origin")
    if site is not None:
        same = site in ("same-origin", "none")
    else:
        same = origin is None or origin.partition("://")[2] == request.headers.get("host")
    if not same:
        raise Problem(403, N_("this form was sent by a page of another site"))


def require_known_origin(request: Request) -> None:
    """Raise Problem 403 for a request from a page of another site, unless the settings permit its origin."""
    origin = request.headers.get("origin")
    if origin is None or origin in request.app.state.settings.cors_origins:
        return
    if origin.partition("://")[2] != request.headers.get("host"):
        raise Problem(403, "this request was made by a page of another site; HPN_CORS_ORIGINS names those that may")

"""Names under which the service answers, so that no link it writes leads anywhere else."""

from collections.abc import Collection

from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Receive, Scope, Send

from hpn.web.door.problems import Problem

ANY_HOST = frozenset({"/healthz", "/readyz"})
"""What load balancers ask for by an address; no link stands in the answers."""


class Hosts:
    """Refuses requests for any other host than the permitted ones, whatever the port.

    Starlette's own middleware does so in plain text. Judged is the address that links are made of: where the Host
    header is missing or is none, that of the server's socket.
    """

    def __init__(self, app: ASGIApp, allowed: Collection[str]) -> None:
        self.app = app
        self._names = frozenset(host.strip("[]") for host in allowed)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or answer 421."""
        app = self.app
        if scope["type"] == "http" and scope["path"] not in ANY_HOST and not self._allows(scope):
            app = Problem(
                421, "the service does not answer for this host: use the address it is published at"
            ).response()
        await app(scope, receive, send)

    def _allows(self, scope: Scope) -> bool:
        host = HTTPConnection(scope).base_url.hostname or ""
        return host in self._names or any(name.startswith("*.") and host.endswith(name[1:]) for name in self._names)

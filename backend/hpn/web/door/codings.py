"""Content codings that a client accepts, and compression of answers."""

from collections.abc import Iterable

from starlette.datastructures import Headers
from starlette.middleware.gzip import GZipMiddleware, IdentityResponder
from starlette.types import Receive, Scope, Send


def accepted_codings(header: str, among: Iterable[str]) -> list[str]:
    """Codings of `among` that an Accept-Encoding header accepts, in the order of `among`."""
    weights: dict[str, str] = {}
    for part in header.lower().split(","):
        coding, _, parameter = part.partition(";")
        weights[coding.strip()] = parameter.replace(" ", "").removeprefix("q=") or "1"
    return [name for name in among if weights.get(name, weights.get("*", "0")).strip("0.") != ""]


class Packing(GZipMiddleware):
    """Compresses answers for clients that accept gzip; Starlette's own middleware takes `gzip;q=0` as acceptance."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] != "http" or accepted_codings(Headers(scope=scope).get("accept-encoding", ""), ["gzip"]):
            await super().__call__(scope, receive, send)
        else:
            plain = IdentityResponder(self.app, self.minimum_size, exclude_content_types=self.exclude_content_types)
            await plain(scope, receive, send)

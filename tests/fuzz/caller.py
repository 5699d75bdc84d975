"""Calls an ASGI application without a server or a client between, so that a request costs what the service costs."""

import asyncio
from collections.abc import Iterable
from typing import NamedTuple

from fastapi import FastAPI
from starlette.types import Message

Header = tuple[bytes, bytes]

CHUNK = 65_536
"""Bytes of a body in one message, as servers cut it."""


class Reply(NamedTuple):
    """Answer of the application."""

    status: int
    media_type: str
    body: bytes


class Caller:
    """Requests to one application, one after the other."""

    def __init__(self, app: FastAPI) -> None:
        self.app = app

    async def __call__(
        self, method: str, path: str, *, query: bytes = b"", headers: Iterable[Header] = (), body: bytes = b""
    ) -> Reply:
        """Answer to one request; an error that the application lets out is raised here."""
        chunks = [body[start : start + CHUNK] for start in range(0, len(body) or 1, CHUNK)]
        incoming = iter(chunks)
        received: list[Message] = []

        async def receive() -> Message:
            chunk = next(incoming, None)
            if chunk is None:  # a client that stays until it is answered
                await asyncio.Event().wait()
            return {"type": "http.request", "body": chunk, "more_body": chunk is not chunks[-1]}

        async def send(message: Message) -> None:
            received.append(message)

        scope = {
            "type": "http",
            "asgi": {"version": "3.0"},
            "http_version": "1.1",
            "method": method,
            "scheme": "http",
            "path": path,
            "raw_path": path.encode(),
            "query_string": query,
            "root_path": "",
            "headers": [(b"host", b"127.0.0.1"), (b"content-length", str(len(body)).encode()), *headers],
            "client": ("127.0.0.1", 50_000),
            "server": ("127.0.0.1", 8000),
        }
        await self.app(scope, receive, send)
        start, *rest = received
        media_type = dict(start["headers"]).get(b"content-type", b"").decode().partition(";")[0]
        return Reply(start["status"], media_type, b"".join(message.get("body", b"") for message in rest))

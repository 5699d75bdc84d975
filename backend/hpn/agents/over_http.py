"""Exchange of the protocol over HTTP: a request whose body has been read, answered as JSON, without sessions."""

import asyncio
from collections.abc import MutableMapping
from typing import Any, NamedTuple

from mcp.server.streamable_http_manager import StreamableHTTPSessionManager

from hpn.agents.server import Call, server_of

Message = MutableMapping[str, Any]


class TransportReply(NamedTuple):
    """Reply of the protocol's library."""

    status: int
    headers: dict[str, str]
    content: bytes


async def exchange(call: Call, scope: Message, body: bytes) -> TransportReply:
    """Answer to a request by the library's own transport, which lives as long as the request."""
    manager = StreamableHTTPSessionManager(
        server_of(call), json_response=True, stateless=True, max_request_body_size=max(len(body), 1)
    )
    pieces, messages = [body], list[Message]()

    async def receive() -> Message:
        if not pieces:
            await asyncio.Event().wait()  # the client's leaving is noticed where the answer is computed
        return {"type": "http.request", "body": pieces.pop(), "more_body": False}

    async def send(message: Message) -> None:
        messages.append(message)

    async with manager.run():
        await manager.handle_request(scope, receive, send)
    start, *rest = messages
    headers = {name.decode("latin-1"): value.decode("latin-1") for name, value in start.get("headers", ())}
    return TransportReply(start["status"], headers, b"".join(message.get("body", b"") for message in rest))

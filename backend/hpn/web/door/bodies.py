"""Reading a request's body within limits of type, size and time."""

import asyncio

from starlette.requests import ClientDisconnect, Request
from starlette.types import Message

from hpn.web.door.problems import Problem
from hpn.web.door.requests import header
from hpn.web.settings import Settings


async def read_body(
    request: Request, content_type: str = "application/json", *, maximum_bytes: int, seconds: float
) -> bytes:
    """Body of a request.

    Raises Problem 415 for another content type, 413 above `maximum_bytes`, 408 when the rest of it has not arrived
    `seconds` after its first part; for that part the server waits, see `protocol.py`.
    """
    given = content_type_of(request)
    if given != content_type:
        raise Problem(415, f"send the body as {content_type} (the Content-Type header says {given or 'nothing'})")
    declared = header(request, b"content-length") or ""
    if declared.isascii() and declared.isdigit() and int(declared[:20]) > maximum_bytes:
        raise _too_large(maximum_bytes)
    try:
        part, more = _part(await request.receive())
        body = await _with_rest(part, request, maximum_bytes, seconds) if more else part
    except TimeoutError:
        raise Problem(408, f"the body did not arrive within {seconds:g} s") from None
    except ClientDisconnect:
        raise Problem(400, "the connection closed before the body was complete") from None
    if len(body) > maximum_bytes:
        raise _too_large(maximum_bytes)
    return body


def content_type_of(request: Request) -> str:
    """Content type of the request's body, without its parameters."""
    return (header(request, b"content-type") or "").partition(";")[0].strip().lower()


async def _with_rest(part: bytes, request: Request, maximum_bytes: int, seconds: float) -> bytes:
    parts, size, more = [part], len(part), True
    async with asyncio.timeout(seconds):  # a timer costs a twentieth of a reply: only where it is needed
        while more and size <= maximum_bytes:
            part, more = _part(await request.receive())
            parts.append(part)
            size += len(part)
    return b"".join(parts)


def _part(message: Message) -> tuple[bytes, bool]:
    """Part of a body, and whether there is more."""
    if message["type"] == "http.disconnect":
        raise ClientDisconnect
    return message.get("body", b""), message.get("more_body", False)


def _too_large(maximum_bytes: int) -> Problem:
    return Problem(413, f"the body may have {maximum_bytes} bytes at most")


async def read_form(request: Request) -> bytes:
    """Body of a posted form, within the limits of the settings; raises Problem as `read_body` does."""
    settings: Settings = request.app.state.settings
    return await read_body(
        request,
        "application/x-www-form-urlencoded",
        maximum_bytes=settings.maximum_body_bytes,
        seconds=settings.body_seconds,
    )

"""Reading a request's body within limits of type, size and time."""

import asyncio

from starlette.requests import ClientDisconnect, Request

from hpn.web.problems import Problem
from hpn.web.settings import Settings


async def read_json(request: Request, *, maximum_bytes: int, seconds: float) -> bytes:
    """Body of a JSON request; refuses as `read_body` does."""
    return await read_body(request, "application/json", maximum_bytes=maximum_bytes, seconds=seconds)


async def read_body(request: Request, content_type: str, *, maximum_bytes: int, seconds: float) -> bytes:
    """Body of a request.

    Raises Problem 415 for another content type, 413 above `maximum_bytes`, 408 when it has not arrived in `seconds`.
    """
    require_content_type(request, content_type)
    try:
        async with asyncio.timeout(seconds):
            return await _read(request, maximum_bytes)
    except TimeoutError:
        raise Problem(408, f"the body did not arrive within {seconds:g} s") from None
    except ClientDisconnect:
        raise Problem(400, "the connection closed before the body was complete") from None


def require_content_type(request: Request, expected: str) -> None:
    """Raise Problem 415 unless the request's content type is `expected`."""
    given = content_type_of(request)
    if given != expected:
        raise Problem(415, f"send the body as {expected} (the Content-Type header says {given or 'nothing'})")


def content_type_of(request: Request) -> str:
    """Content type of the request's body, without its parameters."""
    return request.headers.get("content-type", "").partition(";")[0].strip().lower()


async def _read(request: Request, maximum_bytes: int) -> bytes:
    declared = request.headers.get("content-length", "0")
    if declared.isascii() and declared.isdigit() and int(declared[:20]) > maximum_bytes:
        raise _too_large(maximum_bytes)
    chunks, size = [], 0
    while True:
        message = await request.receive()
        if message["type"] == "http.disconnect":
            raise ClientDisconnect
        chunks.append(message.get("body", b""))
        size += len(chunks[-1])
        if size > maximum_bytes:
            raise _too_large(maximum_bytes)
        if not message.get("more_body"):
            return b"".join(chunks)


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

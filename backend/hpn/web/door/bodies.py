"""Reading a request's body within limits of type, size and time."""

import asyncio

from starlette.requests import ClientDisconnect, Request

from hpn.web.door.problems import Problem
from hpn.web.settings import Settings


async def read_body(
    request: Request, content_type: str = "application/json", *, maximum_bytes: int, seconds: float
) -> bytes:
    """Body of a request.

    Raises Problem 415 for another content type, 413 above `maximum_bytes`, 408 when it has not arrived in `seconds`.
    """
    given = content_type_of(request)
    if given != content_type:
        raise Problem(415, f"send the body as {content_type} (the Content-Type header says {given or 'nothing'})")
    too_large = Problem(413, f"the body may have {maximum_bytes} bytes at most")
    declared = request.headers.get("content-length", "")
    if declared.isascii() and declared.isdigit() and int(declared[:20]) > maximum_bytes:
        raise too_large
    body = bytearray()
    try:
        async with asyncio.timeout(seconds):
            async for part in request.stream():
                body += part
                if len(body) > maximum_bytes:
                    raise too_large
    except TimeoutError:
        raise late(seconds) from None
    except ClientDisconnect:
        raise Problem(400, "the connection closed before the body was complete") from None
    return bytes(body)


def late(seconds: float) -> Problem:
    """408."""
    return Problem(408, f"the body did not arrive within {seconds:g} s")


def content_type_of(request: Request) -> str:
    """Content type of the request's body, without its parameters."""
    return request.headers.get("content-type", "").partition(";")[0].strip().lower()


async def read_form(request: Request) -> bytes:
    """Body of a posted form, within the limits of the settings; raises Problem as `read_body` does."""
    settings: Settings = request.app.state.settings
    return await read_body(
        request,
        "application/x-www-form-urlencoded",
        maximum_bytes=settings.maximum_body_bytes,
        seconds=settings.body_seconds,
    )

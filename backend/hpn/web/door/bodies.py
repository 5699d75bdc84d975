"""Reading a request's body within limits of type, size and time."""

import asyncio
from typing import TypeVar
from urllib.parse import parse_qsl

from pydantic import BaseModel
from starlette.requests import ClientDisconnect, Request

from hpn.phase import MAXIMUM_PHASES
from hpn.web.door.problems import Problem
from hpn.web.settings import Settings

M = TypeVar("M", bound=BaseModel)

MOST_OBJECTS, MOST_NAMES, MOST_LISTS = MAXIMUM_PHASES + 100, 8 * MAXIMUM_PHASES + 1000, 10_000
"""What the JSON of the longest application stays below."""

MOST_PARAMETERS = 100
"""Parameters of an address that is no link of an application."""

MOST_PAIRS = MOST_NAMES
"""Parameters of the longest form."""


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
                request.state.held.take(len(part))
                if len(body) > maximum_bytes:
                    raise too_large
    except TimeoutError:
        raise late(seconds) from None
    except ClientDisconnect:
        raise Problem(400, "the connection closed before the body was complete") from None
    return bytes(body)


def parsed(model: type[M], text: bytes | str) -> M:
    """Value of a model in JSON; raises ValidationError, or Problem as `require_bounded` does."""
    require_bounded(text)
    return model.model_validate_json(text)


def require_bounded(text: bytes | str) -> None:
    """Raise Problem 422 for JSON with more in it than any application has, before it is parsed.

    Of a text within the limit of bytes, values can take a hundred times as much memory, and errors seconds.
    """
    marks = ("{", ":", "[") if isinstance(text, str) else (b"{", b":", b"[")
    objects, names, lists = (text.count(mark) for mark in marks)  # type: ignore[arg-type]
    if objects > MOST_OBJECTS:  # phases are the only objects that an application has many of
        detail = f"must have at most {MAXIMUM_PHASES} phases"
        raise Problem(422, detail, [(("duty_cycle", "phases"), detail)])
    if names > MOST_NAMES or lists > MOST_LISTS:
        detail = f"has {names} fields and {lists} lists, an application at most {MOST_NAMES} and {MOST_LISTS}"
        raise Problem(422, detail, [((), detail)])


def pairs_of(text: str | bytes) -> list[tuple[str, str]]:
    """Names and values of a query or form, in their order; Problem 422 for more than any form has."""
    try:
        return parse_qsl(
            text if isinstance(text, str) else text.decode(errors="replace"), True, max_num_fields=MOST_PAIRS
        )
    except ValueError:
        raise Problem(422, f"a form may have {MOST_PAIRS} fields at most") from None


async def few_parameters(request: Request) -> None:
    """Raise Problem 414 for a query with so many parameters that to name each as unknown takes long."""
    if request.scope["query_string"].count(b"&") > MOST_PARAMETERS:
        raise Problem(414, f"the address may have {MOST_PARAMETERS} parameters at most")


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

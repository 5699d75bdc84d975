"""Reading a request's body within limits of type, size and time."""

import asyncio
import codecs
from collections.abc import Awaitable, Callable
from typing import Any, AnyStr, TypeVar
from urllib.parse import parse_qsl

import orjson
from pydantic import BaseModel, ValidationError
from pydantic_core import InitErrorDetails, from_json
from starlette.requests import ClientDisconnect, Request

from hpn.application import unique
from hpn.web.door.problems import Problem
from hpn.web.settings import Settings
from hpn.words.fields import MAXIMUM_PHASES
from hpn.words.wording import N_, Sentence

M = TypeVar("M", bound=BaseModel)

JSON, MERGE_PATCH, FORM = "application/json", "application/merge-patch+json", "application/x-www-form-urlencoded"
NDJSON = ("application/x-ndjson", "application/ndjson", "application/jsonl")
"""Content types of JSON lines, the usual one first."""

MOST_OBJECTS, MOST_NAMES, MOST_LISTS = MAXIMUM_PHASES + 100, 8 * MAXIMUM_PHASES + 1000, 10_000
"""Maximum objects, names and lists in the JSON of an application; the longest application stays below."""

PIECE_BYTES = 256_000
"""Size of the pieces in which a long body is passed on."""

MOST_PAIRS = MOST_NAMES
"""Maximum fields of a form; the longest form stays below."""


async def read_body(request: Request, *content_types: str, maximum_bytes: int = 0) -> bytes:
    """Body of a request, JSON where no content types are named; JSON loses a byte order mark (RFC 8259, 8.1).

    Raises Problem 415 for any other content type and for a compressed body, 413 above `maximum_bytes` (by default the
    limit of the settings), 408 for a body that has not arrived within the time of the settings.
    """
    settings: Settings = request.app.state.settings
    accepted_types, body = content_types or (JSON,), bytearray()
    if content_type_of(request) not in accepted_types:
        raise wrong_type(request, " or ".join(accepted_types))

    async def keep(piece: bytes) -> None:
        body.extend(piece)

    most, seconds = maximum_bytes or settings.maximum_body_bytes, settings.body_seconds
    await pass_body(request, keep, maximum_bytes=most, pause_seconds=seconds, seconds=seconds)
    return bytes(body).removeprefix(codecs.BOM_UTF8 if JSON in accepted_types else b"")


async def pass_body(
    request: Request,
    take: Callable[[bytes], Awaitable[None]],
    *,
    maximum_bytes: int,
    pause_seconds: float,
    seconds: float,
) -> None:
    """Pass a body on in pieces as it arrives, so that memory holds only one piece.

    Raises Problem 415 for a compressed body, 413 above `maximum_bytes`, 408 when nothing arrives for `pause_seconds` or
    the body is incomplete after `seconds`, 400 for a lost connection.
    """
    require_plain(request)
    too_large = _too_large(request, maximum_bytes)
    time, stream = asyncio.get_running_loop().time, request.stream()
    end, count, piece = time() + seconds, 0, bytearray()
    try:
        while True:
            async with asyncio.timeout(min(pause_seconds, end - time())):
                arrived = await anext(stream, None)
            piece += arrived or b""
            count += len(arrived or b"")
            if count > maximum_bytes:
                raise too_large
            if len(piece) >= PIECE_BYTES or arrived is None:
                await take(bytes(piece))
                piece.clear()
            if arrived is None:
                return
    except TimeoutError:
        raise late(min(pause_seconds, seconds)) from None
    except ClientDisconnect:
        raise Problem(400, "the connection closed before the body was complete") from None


def require_plain(request: Request) -> None:
    """Raise Problem 415 for a body with a compressing Content-Encoding: nothing here unpacks it."""
    encoding = ",".join(request.headers.getlist("content-encoding")).lower()
    if any(coding.strip() not in ("", "identity") for coding in encoding.split(",")):
        text = f"send the body uncompressed (the Content-Encoding header says {encoding[:40]})"
        raise Problem(415, text, headers={"Accept-Encoding": "identity"})


def _too_large(request: Request, maximum_bytes: int) -> Problem:
    """Problem 413 for a body that turns out too large; raised at once if its Content-Length is."""
    problem = Problem(413, Sentence(N_("the body may have {most} bytes at most"), {"most": str(maximum_bytes)}))
    declared = request.headers.get("content-length", "")
    if declared.isascii() and declared.isdigit() and int(declared[:20]) > maximum_bytes:
        raise problem
    return problem


def wrong_type(request: Request, accepted_types: str) -> Problem:
    """415."""
    type = content_type_of(request) or "nothing"
    return Problem(415, f"send the body as {accepted_types} (the Content-Type header says {type})")


def parsed(model: type[M], text: AnyStr, bound: Callable[[AnyStr], None] | None = None) -> M:
    """Value of a model in JSON; raises ValidationError, or Problem as `require_bounded` and `require_unique` do."""
    (bound or require_bounded)(text)
    try:
        content = from_json(text)  # pydantic validates a long list several times as fast from values as from JSON
    except ValueError as error:
        fault = InitErrorDetails(type="json_invalid", input=text, ctx={"error": str(error)})
        raise ValidationError.from_exception_data(model.__name__, [fault]) from None
    value = model.model_validate(content)
    require_unique(text, content)
    return value


def require_unique(text: str | bytes, value: Any) -> None:
    """Raise Problem 422 for JSON with a name twice in one object, of which parsing kept the last; `value` is parsed."""
    content = text.encode() if isinstance(text, str) else text
    try:  # a lost name loses its colon, too; colons in strings stay, and only an escape adds one
        if b"\\u003" not in content and content.count(b":") == orjson.dumps(value).count(b":"):
            return
    except TypeError:  # an integer beyond 64 bits
        pass
    try:
        unique.require_unique(content)
    except unique.RepeatedNameError as repeated:
        raise Problem(422, str(repeated), repeated.problems) from None


def require_bounded(text: AnyStr) -> None:
    """Raise Problem 422 for JSON with more objects, names or lists than any application has, before it is parsed.

    The values of a text within the byte limit can take a hundred times its memory, and their errors take seconds.
    """
    marks = ("{", ":", "[") if isinstance(text, str) else (b"{", b":", b"[")
    objects, names, lists = map(text.count, marks)
    if objects > MOST_OBJECTS:  # only phases can be many objects
        detail = f"must have at most {MAXIMUM_PHASES} phases"
        raise Problem(422, detail, [(("duty_cycle", "phases"), detail)])
    if names > MOST_NAMES or lists > MOST_LISTS:
        detail = f"has {names} fields and {lists} lists, an application at most {MOST_NAMES} and {MOST_LISTS}"
        raise Problem(422, detail, [((), detail)])


def pairs_of(text: str | bytes) -> list[tuple[str, str]]:
    """Names and values of a query or form, in their order; Problem 422 for more fields than any form has."""
    try:
        return parse_qsl(
            text if isinstance(text, str) else text.decode(errors="replace"), True, max_num_fields=MOST_PAIRS
        )
    except ValueError:
        raise Problem(422, f"a form may have {MOST_PAIRS} fields at most") from None


def late(seconds: float) -> Problem:
    """Problem 408, which closes its connection: the rest of the body is not waited for."""
    return Problem(408, f"the body did not arrive within {seconds:g} s", headers={"Connection": "close"})


def content_type_of(request: Request) -> str:
    """Content type of the request's body, without its parameters."""
    return request.headers.get("content-type", "").partition(";")[0].strip().lower()


async def read_form(request: Request) -> bytes:
    """Body of a posted form, within the limits of the settings; raises Problem as `read_body` does."""
    return await read_body(request, FORM)

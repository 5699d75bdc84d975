"""Posted forms of browsers, with or without files, within limits of size and time."""

import logging
from contextlib import suppress
from typing import TYPE_CHECKING

from python_multipart.exceptions import FormParserError
from python_multipart.multipart import MultipartParser, parse_options_header
from starlette.requests import Request

from hpn.tables.files import text_of
from hpn.tables.sheets import RefusedError
from hpn.web.door.bodies import FORM, content_type_of, pairs_of, read_body
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem

if TYPE_CHECKING:
    from python_multipart.multipart import MultipartCallbacks

MULTIPART = "multipart/form-data"
MOST_PARTS, LONGEST_HEAD, LONGEST_NAME = 200, 2000, 100
"""Maximum parts of a form, bytes of a header line of a part, and bytes of a part's name. Parsing stops at the first
two limits; a part with a longer name is ignored."""

logging.getLogger("python_multipart").setLevel(logging.CRITICAL)  # it quotes strangers' forms


async def read_fields(request: Request) -> dict[str, str]:
    """Fields of a posted form, the last of each name; files as text. Raises Problem as `read_body` does, 422 for a file
    that is not text.
    """
    return {name: decoded(content) for name, content in (await read_parts(request)).items()}


async def read_parts(request: Request, maximum_bytes: int = 0) -> dict[str, bytes]:
    """Fields and files of a posted form in bytes, the last of each name. Raises Problem as `read_body` does."""
    return dict(await read_all_parts(request, maximum_bytes))


async def read_all_parts(request: Request, maximum_bytes: int = 0) -> list[tuple[str, bytes]]:
    """Every field and file of a posted form in their order. Raises Problem as `read_body` does."""
    content_type = MULTIPART if content_type_of(request) == MULTIPART else FORM
    body = await read_body(request, content_type, maximum_bytes=maximum_bytes)
    if content_type == FORM:
        return [(name, text.encode(errors="replace")) for name, text in await compute(request, "pages", pairs_of, body)]
    return await compute(request, "pages", form_parts, request.headers["content-type"], body)


def form_parts(content_type: str, body: bytes) -> list[tuple[str, bytes]]:
    """Name and content of each part of a form (RFC 7578), up to its first error."""
    parts = _Parts()
    _, options = parse_options_header(content_type[:LONGEST_HEAD])
    if boundary := options.get(b"boundary"):
        with suppress(FormParserError):
            MultipartParser(boundary, parts.callbacks, max_header_size=LONGEST_HEAD).write(body)
    return [(name, bytes(content)) for name, content in parts.parts if name]


class _Parts:
    """Parts of a form, collected by callbacks of its parser."""

    def __init__(self) -> None:
        self.parts: list[tuple[str, bytearray]] = []
        self._key, self._value = b"", b""
        self.callbacks: MultipartCallbacks = {
            "on_part_begin": self._begin,
            "on_header_field": self._read_key,
            "on_header_value": self._read_value,
            "on_header_end": self._end_header,
            "on_part_data": lambda data, start, end: self.parts[-1][1].extend(data[start:end]),
        }

    def _begin(self) -> None:
        if len(self.parts) == MOST_PARTS:
            raise FormParserError("too many parts")
        self.parts.append(("", bytearray()))

    def _read_key(self, data: bytes, start: int, end: int) -> None:
        self._key += data[start:end]

    def _read_value(self, data: bytes, start: int, end: int) -> None:
        self._value += data[start:end]

    def _end_header(self) -> None:
        if self._key.lower() == b"content-disposition":
            name = parse_options_header(self._value)[1].get(b"name", b"")
            if len(name) <= LONGEST_NAME:
                self.parts[-1] = (name.decode(errors="replace"), self.parts[-1][1])
        self._key, self._value = b"", b""


def decoded(content: bytes) -> str:
    """Text of a field or file; Problem 422 where `text_of` refuses it."""
    try:
        return text_of(content)
    except RefusedError as refused:
        raise Problem(422, refused.sentence) from None

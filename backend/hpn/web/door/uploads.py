"""Forms that a browser posts, with or without files, within limits of size and time."""

import re
from collections.abc import Callable
from typing import NamedTuple

from starlette.requests import Request

from hpn.tables.files import text_of
from hpn.tables.sheets import RefusedError
from hpn.web.door.bodies import FORM, content_type_of, pairs_of, read_body
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem

MULTIPART = "multipart/form-data"


async def read_fields(request: Request) -> dict[str, str]:
    """Fields of a posted form, the last of a name; files as text. Raises Problem as `read_body` does, 422 for a file
    that is no text.
    """
    return {name: decoded(content) for name, content in (await read_parts(request)).items()}


async def read_parts(request: Request, maximum_bytes: int = 0) -> dict[str, bytes]:
    """Fields and files of a posted form as they were sent, the last of a name. Raises Problem as `read_body` does."""
    content_type = MULTIPART if content_type_of(request) == MULTIPART else FORM
    body = await read_body(request, content_type, maximum_bytes=maximum_bytes)
    if content_type == FORM:
        return {name: text.encode(errors="replace") for name, text in await compute(request, "pages", pairs_of, body)}
    return dict(await compute(request, "pages", form_parts, request.headers["content-type"], body))


_BOUNDARY = re.compile(r"""boundary="?([A-Za-z0-9'()+_,./:=? -]{1,70})""", re.IGNORECASE)
_NAME = re.compile(rb';\s*name="([^"\r\n]{1,100})"', re.IGNORECASE)
_FILE_NAME = re.compile(rb';\s*filename="([^"\r\n]{1,300})"', re.IGNORECASE)
_TYPE = re.compile(rb"^content-type:\s*([^;\s]{1,100})", re.IGNORECASE | re.MULTILINE)
MOST_PARTS = 200
LONGEST_HEAD = 2000
END_OF_HEAD = b"\r\n\r\n"


class PartHead(NamedTuple):
    """Name and file name of a part of a form, read from the lines before its content."""

    name: str
    file_name: str
    content_type: str


Write = Callable[[bytes], object]


def _discard(content: bytes) -> None:
    """Takes what belongs to no part."""


class FormSplitter:
    """Cuts a form as browsers write it (RFC 7578) into its parts while it arrives.

    `begin` gets the head of each part that has a name, and gives what takes its content. Not with a library: those at
    hand take seconds for a header or a nesting that no browser sends.
    """

    def __init__(self, content_type: str, begin: Callable[[PartHead], Write]) -> None:
        boundary = _BOUNDARY.search(content_type[:LONGEST_HEAD])
        self._delimiter = b"\r\n--" + boundary[1].strip().encode() if boundary else b""
        self._begin = begin
        self._rest = bytearray(b"\r\n")
        self._write: Write | None = _discard  # None within a head
        self._sections = 0
        self.ended = False

    def feed(self, piece: bytes) -> None:
        """Take the next piece of the form."""
        self._rest += piece
        while self._delimiter and not self.ended and (self._content() if self._write else self._head()):
            pass
        if self.ended or not self._delimiter:
            self._rest.clear()

    def finish(self) -> None:
        """Take what is left of a form whose end is missing."""
        if self._write and not self.ended:
            self._write(bytes(self._rest))

    def _content(self) -> bool:
        """Pass on content up to the next delimiter; whether there is one."""
        assert self._write is not None
        place = self._rest.find(self._delimiter)
        if place < 0:
            sure = max(len(self._rest) - len(self._delimiter) + 1, 0)
            self._write(bytes(self._rest[:sure]))
            del self._rest[:sure]
            return False
        self._write(bytes(self._rest[:place]))
        self._next_section(place)
        return True

    def _next_section(self, place: int) -> None:
        del self._rest[: place + len(self._delimiter)]
        self._write = None
        self._sections += 1
        self.ended = self._sections > MOST_PARTS

    def _head(self) -> bool:
        """Read the head of a part; whether there is a whole one."""
        end, place = self._rest.find(END_OF_HEAD), self._rest.find(self._delimiter)
        self.ended = self._rest.startswith(b"--")
        if self.ended or (end < 0 and place < 0 and len(self._rest) <= LONGEST_HEAD):
            return False
        if place >= 0 and (end < 0 or place < end):
            self._next_section(place)
            return True
        head = _head_of(bytes(self._rest[: max(end, 0)]))
        self._write = self._begin(head) if head else _discard
        del self._rest[: end + len(END_OF_HEAD) if end >= 0 else 0]
        return True


def _head_of(text: bytes) -> PartHead | None:
    name, *others = (pattern.search(text[:LONGEST_HEAD]) for pattern in (_NAME, _FILE_NAME, _TYPE))
    if name is None:
        return None
    file_name, content_type = (found[1].decode(errors="replace") if found else "" for found in others)
    return PartHead(name[1].decode(errors="replace"), file_name, content_type.lower())


def form_parts(content_type: str, body: bytes) -> list[tuple[str, bytes]]:
    """Name and content of each part of a form; none where it isn't one."""
    parts: list[tuple[str, bytearray]] = []

    def begin(head: PartHead) -> Write:
        parts.append((head.name, bytearray()))
        return parts[-1][1].extend

    splitter = FormSplitter(content_type, begin)
    splitter.feed(body)
    splitter.finish()
    return [(name, bytes(content)) for name, content in parts]


def decoded(content: bytes) -> str:
    """Text of a field or a file; raises Problem 422 as `text_of` refuses it."""
    try:
        return text_of(content)
    except RefusedError as refused:
        raise Problem(422, refused.sentence) from None

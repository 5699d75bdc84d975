"""Forms that a browser posts, with or without files, within limits of size and time."""

import codecs
import re
from contextlib import suppress

from starlette.requests import Request

from hpn.web.door.bodies import content_type_of, pairs_of, read_body
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.settings import Settings
from hpn.wording import N_, Sentence

NO_TEXT = N_("the file is no text: save the sheet as CSV, or copy its cells")
WRONG_BYTE = N_(
    "the file is marked as {encoding}, but in line {line} the byte {byte}, number {place} of the file, does not belong "
    "to it: save the sheet as CSV again"
)
MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),  # before UTF-16, whose mark is the beginning of this one
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
"""Byte order marks, and what each promises of the bytes behind it."""

FORM, MULTIPART = "application/x-www-form-urlencoded", "multipart/form-data"


async def read_fields(request: Request) -> dict[str, str]:
    """Fields of a posted form, the last of a name; files as text. Raises Problem as `read_body` does, 422 for a file
    that is no text.
    """
    return {name: decoded(content) for name, content in (await read_parts(request)).items()}


async def read_parts(request: Request) -> dict[str, bytes]:
    """Fields and files of a posted form as they were sent, the last of a name. Raises Problem as `read_body` does."""
    settings: Settings = request.app.state.settings
    content_type = MULTIPART if content_type_of(request) == MULTIPART else FORM
    body = await read_body(
        request, content_type, maximum_bytes=settings.maximum_body_bytes, seconds=settings.body_seconds
    )
    if content_type == FORM:
        return {name: text.encode(errors="replace") for name, text in await compute(request, "pages", pairs_of, body)}
    return dict(await compute(request, "pages", parts_of, request.headers["content-type"], body))


_BOUNDARY = re.compile(r"""boundary="?([A-Za-z0-9'()+_,./:=? -]{1,70})""", re.IGNORECASE)
_NAME = re.compile(rb';\s*name="([^"\r\n]{1,100})"', re.IGNORECASE)
MOST_PARTS = 20
LONGEST_HEAD = 2000


def parts_of(content_type: str, body: bytes) -> list[tuple[str, bytes]]:
    """Name and content of each part of a form as browsers write it (RFC 7578); none where it isn't one.

    Not with a library: those at hand take seconds for a header or a nesting that no browser sends.
    """
    boundary = _BOUNDARY.search(content_type[:LONGEST_HEAD])
    if boundary is None:
        return []
    parts: list[tuple[str, bytes]] = []
    delimiter = b"\r\n--" + boundary[1].strip().encode()
    for section in (b"\r\n" + body).split(delimiter, MOST_PARTS + 1)[1:]:
        head, blank, content = section.partition(b"\r\n\r\n")
        name = _NAME.search(head[:LONGEST_HEAD])
        if name and blank and len(parts) < MOST_PARTS:
            parts.append((name[1].decode(errors="replace"), content))
    return parts


def decoded(content: bytes) -> str:
    """Text of a file: in the encoding that its byte order mark promises, else UTF-8, else Windows-1252 as spreadsheets
    write CSV. Raises Problem 422, which names the place of a byte that breaks the promise.
    """
    for mark, encoding in MARKS:
        if content.startswith(mark):
            return _marked(content.removeprefix(mark), encoding, len(mark))
    if b"\x00" not in content:  # a workbook or a picture
        for encoding in ("utf-8", "cp1252"):
            with suppress(UnicodeDecodeError):
                return content.decode(encoding)
    raise _refused(NO_TEXT)


def _marked(content: bytes, encoding: str, mark: int) -> str:
    try:
        return content.decode(encoding)
    except UnicodeDecodeError as error:
        line = 1 + content[: error.start].decode(encoding).count("\n")
        raise _refused(
            WRONG_BYTE,
            encoding=encoding.upper(),
            line=line,
            byte=f"0x{content[error.start]:02x}",
            place=mark + error.start + 1,
        ) from None


def _refused(template: str, **values: str | int) -> Problem:
    sentence = Sentence(template, dict(values))
    problem = Problem(422, sentence.text)
    problem.sentences = (sentence,)
    return problem

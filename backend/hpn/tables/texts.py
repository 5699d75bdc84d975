"""Text of a file, in the encoding that it is written in."""

import codecs
from contextlib import suppress

from hpn.tables.sheets import RefusedError
from hpn.words.wording import N_

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


def text_of(content: bytes) -> str:
    """Text in the encoding that its byte order mark promises, else UTF-8, else Windows-1252 as spreadsheets write CSV.

    Raises RefusedError, which names the place of a byte that breaks the promise.
    """
    for mark, encoding in MARKS:
        if content.startswith(mark):
            return _marked(content.removeprefix(mark), encoding, len(mark))
    if b"\x00" not in content:  # a picture, or another file of numbers
        for encoding in ("utf-8", "cp1252"):
            with suppress(UnicodeDecodeError):
                return content.decode(encoding)
    raise RefusedError(NO_TEXT)


def _marked(content: bytes, encoding: str, mark: int) -> str:
    try:
        return content.decode(encoding)
    except UnicodeDecodeError as error:
        line = 1 + content[: error.start].decode(encoding).count("\n")
        raise RefusedError(
            WRONG_BYTE,
            encoding=encoding.upper(),
            line=line,
            byte=f"0x{content[error.start]:02x}",
            place=mark + error.start + 1,
        ) from None


def tidied(text: str) -> str:
    """A text without the mark that may stand at its beginning, its lines ended as elsewhere."""
    return text.removeprefix("\ufeff").replace("\r\n", "\n")

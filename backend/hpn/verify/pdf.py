"""PDF: its lines of text, its attached parts, its links, and the drawings on its pages."""

import logging
import re
from collections.abc import Callable, Iterator, Mapping
from hashlib import sha256
from io import BytesIO
from typing import Any, TypeVar

from pypdf import PdfReader
from pypdf.generic import ArrayObject, DictionaryObject, IndirectObject, StreamObject

from hpn.verify.shown import FileLine, UnreadableFileError
from hpn.words.reader import GROUP

T = TypeVar("T")

logging.getLogger("pypdf").setLevel(logging.CRITICAL)

_BREAKS = re.compile("[\u200b\u00ad]")
"""Invisible places where a word may break."""

_BEFORE_UNIT = re.compile(f"\xa0|{GROUP}(?![0-9])")

NOT_DRAWN = frozenset(("/Parent", "/P", "/Dest", "/StructParents", "/StructParent", "/A", "/Metadata", "/Popup"))
"""Entries of a page that lead to other objects."""

PACKING = frozenset(("/Length", "/Filter", "/DecodeParms"))
"""Entries on the packing of a stream."""


def _read(content: bytes, work: Callable[[PdfReader], T]) -> T:
    """Outcome of reading a PDF; any error of the library is raised as UnreadableFileError."""
    try:
        return work(PdfReader(BytesIO(content)))
    except Exception as error:  # damaged files raise errors of every kind
        raise UnreadableFileError.of("PDF", error) from None


def parts_of(content: bytes) -> Mapping[str, bytes]:
    """Parts attached to a PDF, by their names."""
    return _read(content, lambda pdf: {name: b"".join(parts[:1]) for name, parts in pdf.attachments.items()})


def lines_of(content: bytes) -> list[FileLine]:
    """Lines of text, page by page."""
    return _read(content, lambda pdf: list(_lines(pdf)))


def _lines(pdf: PdfReader) -> Iterator[FileLine]:
    for number, page in enumerate(pdf.pages, 1):
        for line in page.extract_text().splitlines():
            text = _BEFORE_UNIT.sub(" ", _BREAKS.sub("", line)).strip()
            if text:
                yield FileLine(f"page {number}", text)


def links_of(content: bytes) -> list[str]:
    """Addresses of links on its pages."""
    return _read(content, lambda pdf: list(dict.fromkeys(_links(pdf))))


def _links(pdf: PdfReader) -> Iterator[str]:
    for page in pdf.pages:
        for note in page.get("/Annots") or ():
            action = note.get_object().get("/A")
            if action and (address := action.get_object().get("/URI")):
                yield str(address)


def language_of(content: bytes) -> str:
    """Language of a PDF; blank without one."""
    return _read(content, lambda pdf: str(pdf.root_object.get("/Lang", "")))


def maker_of(content: bytes) -> str:
    """Program that set the pages."""
    return _read(content, lambda pdf: str(pdf.metadata.creator) if pdf.metadata else "")


def drawn_on(content: bytes) -> list[str]:
    """Hash of each page's strokes, letters, pictures and notes above them."""
    return _read(content, lambda pdf: [_digest(page, {}).hex() for page in pdf.pages])


def _digest(value: Any, known: dict[int, bytes]) -> bytes:
    """Digest of an object of a PDF, independent of its number; each is read once, and an object inside itself is
    blank."""
    if isinstance(value, IndirectObject):
        if value.idnum not in known:
            known[value.idnum] = b""
            known[value.idnum] = _digest(value.get_object(), known)
        return known[value.idnum]
    digest = sha256()
    if isinstance(value, StreamObject):
        digest.update(value.get_data())
    if isinstance(value, DictionaryObject):
        for name in sorted(value.keys() - NOT_DRAWN - (PACKING if isinstance(value, StreamObject) else set())):
            digest.update(name.encode() + _digest(value.raw_get(name), known))
    elif isinstance(value, ArrayObject):
        for item in value:
            digest.update(_digest(item, known))
    else:
        digest.update(repr(value).encode())
    return digest.digest()

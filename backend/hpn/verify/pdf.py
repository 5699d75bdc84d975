"""A PDF: its lines of text, the parts attached to it, its links, and what is drawn on its pages."""

import logging
import re
from collections.abc import Callable, Iterator, Mapping
from hashlib import sha256
from io import BytesIO
from typing import Any, TypeVar

from pypdf import PdfReader
from pypdf.generic import ArrayObject, DictionaryObject, IndirectObject, StreamObject

from hpn.verify.shown import Shown, UnreadableFileError
from hpn.words.reader import GROUP

T = TypeVar("T")

logging.getLogger("pypdf").setLevel(logging.CRITICAL)

_BREAKS = re.compile("[\u200b\u00ad]")
"""Places where a word may break, which no reader sees."""

_BEFORE_UNIT = re.compile(f"\xa0|{GROUP}(?![0-9])")

NOT_DRAWN = frozenset(("/Parent", "/P", "/Dest", "/StructParents", "/StructParent", "/A", "/Metadata", "/Popup"))
"""Entries of a page that lead elsewhere."""

PACKING = frozenset(("/Length", "/Filter", "/DecodeParms"))
"""Entries that say how a stream is packed."""


def _read(content: bytes, work: Callable[[PdfReader], T]) -> T:
    """Outcome of reading a PDF; any error of the library is one of the file."""
    try:
        return work(PdfReader(BytesIO(content)))
    except Exception as error:  # damaged files make it raise errors of every kind
        raise UnreadableFileError(f"the PDF can’t be read: {error}") from None


def parts_of(content: bytes) -> Mapping[str, bytes]:
    """Parts attached to a PDF, by their names."""
    return _read(content, lambda pdf: {name: b"".join(parts[:1]) for name, parts in pdf.attachments.items()})


def lines_of(content: bytes) -> list[Shown]:
    """Lines of its text, page by page."""
    return _read(content, lambda pdf: list(_lines(pdf)))


def _lines(pdf: PdfReader) -> Iterator[Shown]:
    for number, page in enumerate(pdf.pages, 1):
        for line in page.extract_text().splitlines():
            text = _BEFORE_UNIT.sub(" ", _BREAKS.sub("", line)).strip()
            if text:
                yield Shown(f"page {number}", text)


def links_of(content: bytes) -> list[str]:
    """Addresses that its pages lead to."""
    return _read(content, lambda pdf: list(dict.fromkeys(_links(pdf))))


def _links(pdf: PdfReader) -> Iterator[str]:
    for page in pdf.pages:
        for note in page.get("/Annots") or ():
            action = note.get_object().get("/A")
            if action and (address := action.get_object().get("/URI")):
                yield str(address)


def language_of(content: bytes) -> str:
    """Language of a PDF, blank where it says none."""
    return _read(content, lambda pdf: str(pdf.root_object.get("/Lang", "")))


def maker_of(content: bytes) -> str:
    """Program that set its pages."""
    return _read(content, lambda pdf: str(pdf.metadata.creator) if pdf.metadata else "")


def drawn_on(content: bytes) -> list[str]:
    """A hash of what is drawn on each page: strokes, letters and pictures, notes that lie above it included."""
    return _read(content, lambda pdf: [_hash(page) for page in pdf.pages])


def _hash(page: DictionaryObject) -> str:
    return _digest(page, {}).hex()


def _digest(value: Any, known: dict[int, bytes]) -> bytes:
    """Digest of an object of a PDF, whatever number it has there; each is read once, and one inside itself is blank."""
    if isinstance(value, IndirectObject):
        if value.idnum not in known:
            known[value.idnum] = b""
            known[value.idnum] = _digest(value.get_object(), known)
        return known[value.idnum]
    found = sha256()
    if isinstance(value, StreamObject):
        found.update(value.get_data())
    if isinstance(value, DictionaryObject):
        for name in sorted(value.keys() - NOT_DRAWN - (PACKING if isinstance(value, StreamObject) else set())):
            found.update(name.encode() + _digest(value.raw_get(name), known))
    elif isinstance(value, ArrayObject):
        for item in value:
            found.update(_digest(item, known))
    else:
        found.update(repr(value).encode())
    return found.digest()

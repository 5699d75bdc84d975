"""A package of the Asset Administration Shell: its elements by their paths, and the parts that it carries."""

import re
from collections.abc import Iterator, Mapping
from io import BytesIO
from xml.etree import ElementTree
from zipfile import BadZipFile, ZipFile

from hpn.verify.shown import Shown, UnreadableFileError

PARTS, DATA = "aasx/", "aasx/data.xml"
MOST_BYTES = 200_000_000
"""Size of what a package holds, unpacked."""

_NAMESPACE = re.compile(r"^\{[^}]*\}")


def _unpacked(content: bytes) -> Mapping[str, bytes]:
    try:
        with ZipFile(BytesIO(content)) as package:
            if sum(entry.file_size for entry in package.infolist()) > MOST_BYTES:
                raise UnreadableFileError("the package holds more than it can")
            return {name: package.read(name) for name in package.namelist() if name.startswith(PARTS)}
    except (BadZipFile, OSError, ValueError, NotImplementedError, RuntimeError, EOFError) as error:
        raise UnreadableFileError(f"the package can’t be read: {error}") from None


def parts_of(content: bytes) -> Mapping[str, bytes]:
    """JSON that a package carries, by its names."""
    return {name.removeprefix(PARTS): part for name, part in _unpacked(content).items() if name.endswith(".json")}


def lines_of(content: bytes) -> list[Shown]:
    """Texts of its elements, each at the path of its short names."""
    try:
        root = ElementTree.fromstring(_unpacked(content).get(DATA, b""))
    except ElementTree.ParseError as error:
        raise UnreadableFileError(f"{DATA} of the package can’t be read: {error}") from None
    return list(_texts(root, ""))


def _texts(element: ElementTree.Element, path: str) -> Iterator[Shown]:
    short = next((child.text or "" for child in element if _name(child) == "idShort"), "")
    path = "/".join(filter(None, (path, short)))
    name = _name(element)
    if name != "idShort" and element.text and element.text.strip():
        yield Shown(path, f"{name} {element.text.strip()}", key=path)
    for child in element:
        yield from _texts(child, path)


def _name(element: ElementTree.Element) -> str:
    return _NAMESPACE.sub("", element.tag)


def links_of(content: bytes) -> list[str]:
    """None: a package carries its application."""
    return []

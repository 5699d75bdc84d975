"""A package of the Asset Administration Shell: its elements by their paths, and the parts that it carries."""

import re
from collections.abc import Iterator, Mapping
from xml.etree import ElementTree

from hpn.verify.archive import unpacked
from hpn.verify.shown import Shown, UnreadableFileError

PARTS, DATA = "aasx/", "aasx/data.xml"
NO_FIGURES = ("administration", "semanticId", "semanticIdListElement")
"""Elements that name the template, which another version may follow in another edition."""

_NAMESPACE = re.compile(r"^\{[^}]*\}")


def parts_of(content: bytes) -> Mapping[str, bytes]:
    """JSON that a package carries, by its names."""
    return {
        name.removeprefix(PARTS): part
        for name, part in unpacked(content, form="package", below=PARTS).items()
        if name.endswith(".json")
    }


def lines_of(content: bytes) -> list[Shown]:
    """Texts of its elements, each at the path of its short names, and the rows of its courses of motion."""
    parts = unpacked(content, form="package", below=PARTS)
    try:
        root = ElementTree.fromstring(parts.get(DATA, b""))
    except ElementTree.ParseError as error:
        raise UnreadableFileError(f"{DATA} of the package can’t be read: {error}") from None
    return [*_texts(root, ""), *_rows(parts)]


def _rows(parts: Mapping[str, bytes]) -> Iterator[Shown]:
    for name, part in parts.items():
        if name.endswith(".csv"):
            for number, line in enumerate(part.decode(errors="replace").splitlines(), 1):
                place = f"{name.removeprefix(PARTS)}/row {number}"
                yield Shown(place, line.replace(",", " "), key=place)


def _texts(element: ElementTree.Element, path: str) -> Iterator[Shown]:
    short = next((child.text or "" for child in element if _name(child) == "idShort"), "")
    path = "/".join(filter(None, (path, short)))
    name = _name(element)
    if name != "idShort" and element.text and element.text.strip():
        yield Shown(path, f"{name} {element.text.strip()}", key=_key(path))
    for child in element:
        if _name(child) not in NO_FIGURES:
            yield from _texts(child, path)


def _key(path: str) -> str:
    """Name of an element among all: of technical data without its section, which earlier packages do not have."""
    first, _, rest = path.partition("/")
    return f"{first}/{rest.rpartition('/')[2]}" if first == "TechnicalData" and rest else path


def _name(element: ElementTree.Element) -> str:
    return _NAMESPACE.sub("", element.tag)


def links_of(content: bytes) -> list[str]:
    """None: a package carries its application."""
    return []

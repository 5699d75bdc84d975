"""Package of the Asset Administration Shell: its elements by their paths, and the parts that it carries."""

import re
from collections.abc import Iterable, Iterator, Mapping
from xml.etree import ElementTree

from hpn.verify.archive import unpacked
from hpn.verify.shown import FileLine, UnreadableFileError

PARTS, DATA, REPORT = "aasx/", "aasx/data.xml", "aasx/report.pdf"
GEAR = "SelectionResult/Candidate"
"""Element that names the gear of a package: earlier packages name it nowhere else."""

REPORT_ELEMENT = "SelectionResult/Report"
"""Element that names the report, which a package has where its maker could set one; the report is compared by
itself."""

NO_FIGURES = ("administration", "semanticId", "semanticIdListElement")
"""Elements that name the template; other versions may follow another edition of it."""

_NAMESPACE = re.compile(r"^\{[^}]*\}")


def parts_of(content: bytes) -> Mapping[str, bytes]:
    """JSON parts of a package, by their names."""
    return {
        name.removeprefix(PARTS): part
        for name, part in unpacked(content, form="package", below=PARTS).items()
        if name.endswith(".json")
    }


def lines_of(content: bytes) -> list[FileLine]:
    """Texts of its elements, each at the path of its short ids, and rows of its motion courses."""
    parts = unpacked(content, form="package", below=PARTS)
    try:
        root = ElementTree.fromstring(parts.get(DATA, b""))
    except ElementTree.ParseError as error:
        raise UnreadableFileError(f"{DATA} of the package can’t be read: {error}") from None
    try:
        return [*_texts(root, ""), *_rows(parts)]
    except RecursionError:
        raise UnreadableFileError(f"{DATA} of the package is nested too deeply") from None


def report_of(content: bytes) -> bytes:
    """Report in a package; empty without one."""
    return unpacked(content, form="package", below=REPORT).get(REPORT, b"")


def _rows(parts: Mapping[str, bytes]) -> Iterator[FileLine]:
    for name, part in parts.items():
        if name.endswith(".csv"):
            for number, line in enumerate(part.decode(errors="replace").splitlines(), 1):
                place = f"{name.removeprefix(PARTS)}/row {number}"
                yield FileLine(place, line.replace(",", " "), key=place)


def _texts(element: ElementTree.Element, path: str) -> Iterator[FileLine]:
    short = next((child.text or "" for child in element if _name(child) == "idShort"), "")
    path = "/".join(filter(None, (path, short)))
    name = _name(element)
    if path == REPORT_ELEMENT:
        return
    if name != "idShort" and element.text and element.text.strip():
        yield FileLine(path, f"{name} {element.text.strip()}", key=_key(path))
    for child in element:
        if _name(child) not in NO_FIGURES:
            yield from _texts(child, path)


def _key(path: str) -> str:
    """Key of an element; for technical data without its section, which earlier packages lack."""
    first, _, rest = path.partition("/")
    return f"{first}/{rest.rpartition('/')[2]}" if first == "TechnicalData" and rest else path


def _name(element: ElementTree.Element) -> str:
    return _NAMESPACE.sub("", element.tag)


def gear_in(lines: Iterable[FileLine]) -> str:
    """Gear in the lines of a package; blank without one."""
    values = (line.text.partition(" ") for line in lines if line.key == GEAR)
    return next((value for name, _, value in values if name == "value"), "")


def links_of(content: bytes) -> list[str]:
    """Empty list: a package carries its application."""
    return []

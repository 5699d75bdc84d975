"""Elements of an SVG drawing, with the handbook's symbols in italics; a style sheet gives colours and letter sizes."""

from collections.abc import Iterable
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, tostring

from hpn.words.symbols import sentence

Point = tuple[float, float]

NAMESPACE = "http://www.w3.org/2000/svg"
"""Namespace of a drawing outside a page; in a page the element's name is enough."""

LETTER = 14.0
"""Letter size, in units of a drawing, that texts have room for; a style sheet may only set smaller ones."""

STYLE = Path(__file__).with_name("drawings.css")
"""Style sheet of all drawings, in the colours of the page's tokens."""

WIDE = 0.64
"""Width of a character in letter sizes: of a digit in DejaVu Sans, the widest of the usual fonts."""


def canvas(kind: str, width: float, height: float) -> Element:
    """An empty drawing of a kind in the style sheet."""
    box = f"0 0 {written(width)} {written(height)}"
    return Element("svg", {"class": f"drawing {kind}", "viewBox": box})


def add(parent: Element, name: str, kind: str, **attributes: float | str) -> Element:
    """Add an element of a kind in the style sheet; `_` in the name of an attribute stands for a hyphen."""
    texts = {key.replace("_", "-"): written(value) for key, value in attributes.items()}
    return SubElement(parent, name, {"class": kind, **texts})


def text(parent: Element, kind: str, at: Point, content: str, anchor: str = "start") -> Element:
    """Add a text, its symbols in italics with subscripts."""
    return runs(parent, kind, at, [("", content)], anchor)


def runs(parent: Element, kind: str, at: Point, parts: Iterable[tuple[str, str]], anchor: str = "start") -> Element:
    """Add a text of several parts, each of its own kind, separated by a space."""
    element = add(parent, "text", kind, x=at[0], y=at[1], **({} if anchor == "start" else {"text_anchor": anchor}))
    lowered = False
    for place, (own, content) in enumerate(parts):
        for part in sentence("\N{EN SPACE}" * (place > 0) + content):
            back = -3 if lowered else 0
            letter, index = ("", "") if isinstance(part, str) else part
            lowered = index != ""
            _run(element, f"{own} letter" if letter else own, letter or str(part), back)
            if lowered:
                _run(element, f"{own} index", index, 3)
    return element


def _run(element: Element, kind: str, content: str, shift: float) -> None:
    attributes = ({"class": kind.strip()} if kind else {}) | ({"dy": written(shift)} if shift else {})
    if attributes or len(element):
        SubElement(element, "tspan", attributes).text = content
    else:
        element.text = content


def width_of(content: str) -> float:
    """Upper bound of a text's width, in units of a drawing."""
    return WIDE * LETTER * (len(content) - content.count("_") / 2)


def path(points: Iterable[Point], *, closed: bool = False) -> str:
    """Path through some points."""
    steps = "L".join(f"{written(x)} {written(y)}" for x, y in points)
    return f"M{steps}{'Z' if closed else ''}"


def written(value: float | str) -> str:
    """Text of an attribute: a number to a thousandth of a unit."""
    return value if isinstance(value, str) else f"{value:.3f}".rstrip("0").rstrip(".")


def markup(drawing: Element, style: str = "") -> str:
    """A drawing as text; with a namespace and a style sheet if it stands outside a page."""
    if not style:
        return tostring(drawing, encoding="unicode")
    alone = Element(drawing.tag, {"xmlns": NAMESPACE, **drawing.attrib})
    SubElement(alone, "style").text = style
    alone.extend(drawing)
    return tostring(alone, encoding="unicode")

"""Elements of a submodel from an untrusted file, in XML or JSON, with bounds on number and depth."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any
from xml.parsers import expat

from hpn.tables.sheets import RefusedError
from hpn.words.wording import N_

MOST_ELEMENTS, MOST_DEPTH = 200_000, 100
DECLARED = N_("the package declares entities in its XML, which none needs: export it anew")
TOO_MUCH = N_("the package has more elements than a sizing has")
UNREADABLE = N_("the Asset Administration Shell can’t be read: export it as AASX or JSON of metamodel 3")


@dataclass(slots=True, eq=False)
class Element:
    """Element: short id, meanings without blanks around them, value or range, and the elements inside."""

    name: str = ""
    meanings: tuple[str, ...] = ()
    value: str | None = None
    largest: str | None = None
    parts: list["Element"] = field(default_factory=list)

    def of(self, meaning: str) -> Iterator["Element"]:
        """Parts with a meaning."""
        meaning_id = meaning.strip()
        return (part for part in self.parts if meaning_id in part.meanings)


def submodels_of(content: bytes) -> list[Element]:
    """Submodels of an environment in XML or JSON; raises RefusedError."""
    if content.lstrip()[:1] == b"{":
        return list(_in_json(content))
    return [_of_node(node) for node in _nodes(content).all_of("submodel")]


# --- XML --------------------------------------------------------------------------------------------------------------


@dataclass(slots=True, eq=False)
class _Node:
    """XML tag without its namespace, its text and the nodes inside."""

    tag: str
    text: list[str] = field(default_factory=list)
    nodes: list["_Node"] = field(default_factory=list)

    def all_of(self, tag: str) -> Iterator["_Node"]:
        """Nodes with a tag, at any depth."""
        for node in self.nodes:
            if node.tag == tag:
                yield node
            yield from node.all_of(tag)

    def first(self, tag: str) -> "_Node | None":
        return next((node for node in self.nodes if node.tag == tag), None)

    def text_of(self, tag: str) -> str | None:
        node = self.first(tag)
        return None if node is None else "".join(node.text).strip()


def _nodes(content: bytes) -> _Node:
    parser = expat.ParserCreate(namespace_separator="}")
    root = _Node("")
    path, count = [root], 0

    def start(tag: str, _: Mapping[str, str]) -> None:
        nonlocal count
        count += 1
        if count > 10 * MOST_ELEMENTS or len(path) > 3 * MOST_DEPTH:
            raise RefusedError(TOO_MUCH)
        node = _Node(tag.rpartition("}")[2])
        path[-1].nodes.append(node)
        path.append(node)

    def refuse(*_: object) -> None:
        raise RefusedError(DECLARED)

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: path.pop()
    parser.CharacterDataHandler = lambda text: path[-1].text.append(text)
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(content, True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        raise error if isinstance(error, RefusedError) else RefusedError(UNREADABLE) from None
    return root


def _of_node(node: _Node) -> Element:
    semantic = node.first("semanticId")
    meanings = tuple("".join(each.text).strip() for each in semantic.all_of("value")) if semantic else ()
    inside = [part for tag in ("submodelElements", "value", "statements") if (part := node.first(tag))]
    return Element(
        node.text_of("idShort") or "",
        meanings,
        node.text_of("min") or node.text_of("value"),
        node.text_of("max"),
        [_of_node(part) for parts in inside for part in parts.nodes],
    )


# --- JSON -------------------------------------------------------------------------------------------------------------


def _in_json(content: bytes) -> Iterator[Element]:
    try:
        value = json.loads(content)
    except (ValueError, RecursionError):
        raise RefusedError(UNREADABLE) from None
    submodels = value.get("submodels", [value]) if isinstance(value, dict) else []
    for submodel in submodels if isinstance(submodels, list) else []:
        if isinstance(submodel, dict):
            yield _of_object(submodel, [0], 0)


def _of_object(submodel: Mapping[str, Any], count: list[int], depth: int) -> Element:
    count[0] += 1
    if count[0] > MOST_ELEMENTS or depth > MOST_DEPTH:
        raise RefusedError(TOO_MUCH)
    semantic = submodel.get("semanticId")
    keys = semantic.get("keys") if isinstance(semantic, dict) else None
    meanings = [key.get("value") for key in keys if isinstance(key, dict)] if isinstance(keys, list) else []
    inside = [
        submodel[name] for name in ("submodelElements", "value", "statements") if isinstance(submodel.get(name), list)
    ]
    value = submodel.get("min", submodel.get("value"))
    return Element(
        _text(submodel.get("idShort")) or "",
        tuple(text.strip() for text in map(_text, meanings) if text),
        _text(value),
        _text(submodel.get("max")),
        [_of_object(part, count, depth + 1) for parts in inside for part in parts if isinstance(part, dict)],
    )


def _text(value: object) -> str | None:
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        return None
    return str(value)

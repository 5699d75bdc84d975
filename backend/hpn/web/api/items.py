"""Items of a JSON batch, cut from its text without parsing it: as Python objects, 32 MB of JSON can be a gigabyte."""

import re
from typing import NamedTuple, NoReturn

from pydantic_core import from_json

from hpn.application.faults import unknown_field
from hpn.web.door.problems import MAXIMUM_ERRORS, Problem

DEPTH = 16
"""How deep lists and objects may lie in each other; an application takes four."""

STRING = rb'"[^"\\]*+(?:\\.[^"\\]*+)*+"'
BETWEEN = rb'[^][{}"]*+'


def _value() -> bytes:
    """Pattern of a value; possessive, so that it takes time in proportion to its length."""
    nested = STRING
    for _ in range(DEPTH):
        nested = rb"%s|[\[{]%s(?:(?:%s)%s)*+[\]}]" % (STRING, BETWEEN, nested, BETWEEN)
    return rb"%s|[^][{},:\"\s]++" % nested


VALUE = re.compile(_value(), re.DOTALL)
BLANK = re.compile(rb"[ \t\n\r]*+")
SHAPE = 'the body must be {"applications": [ … ]}'


class Span(NamedTuple):
    """Where an item begins and ends."""

    start: int
    end: int


def items_of(body: bytes, most: int, most_bytes: int) -> list[Span]:
    """Places of the items; Problem 413 or 422 for what is no batch, ValueError for what is no JSON outside of them."""
    items, unknown = _Cutter(body, most, most_bytes).batch()
    if items is None:
        raise Problem(422, SHAPE, [(("applications",), "must be a list")])
    if unknown:
        known = [("applications",) if place < MAXIMUM_ERRORS else () for place in range(len(unknown))]
        errors = [((name,), unknown_field(name, each).text) for name, each in zip(unknown, known, strict=True)]
        raise Problem(422, f"{SHAPE} alone", errors)
    return items


class _Cutter:
    """Walks through the text of a batch."""

    def __init__(self, body: bytes, most: int, most_bytes: int) -> None:
        self._body, self._at = body, 0
        self._most, self._most_bytes = most, most_bytes

    def batch(self) -> tuple[list[Span] | None, list[str]]:
        """Items, None where they are no list; and names of other fields."""
        items: list[Span] | None = None
        unknown: list[str] = []
        given = False
        if not self._takes(b"{"):
            self._other_shape()
        more = not self._takes(b"}")
        while more:
            name = self._name()
            if name == "applications" and given:
                raise Problem(422, SHAPE, [((name,), "is there twice")])
            given = given or name == "applications"
            if name == "applications" and self._takes(b"["):
                items = self._list()
            else:
                self._skip()
                unknown += [name] if name != "applications" and len(unknown) < self._most else []
            more = self._continues(b"}")
        if self._next():
            self._fail()
        return items, unknown

    def _list(self) -> list[Span]:
        items: list[Span] = []
        more = not self._takes(b"]")
        while more:
            if len(items) == self._most:
                text = f"at most {self._most} applications at once"
                raise Problem(413, text, [(("applications",), f"has more than {self._most} items")])
            items.append(self._skip(len(items)))
            more = self._continues(b"]")
        return items

    def _name(self) -> str:
        span = self._skip()
        name = from_json(self._body[span.start : span.end]) if self._body[span.start] == ord('"') else None
        if not isinstance(name, str) or not self._takes(b":"):
            self._fail()
        return name

    def _skip(self, number: int | None = None) -> Span:
        """Pass a value."""
        self._next()
        found = VALUE.match(self._body, self._at, self._at + self._most_bytes + 1)
        if found is None or found.end() - self._at > self._most_bytes:
            if len(self._body) - self._at > self._most_bytes:
                place = ("applications",) if number is None else ("applications", number)
                text = f"an application may have {self._most_bytes} bytes at most"
                raise Problem(413, text, [(place, text)])
            self._fail()
        self._at = found.end()
        return Span(found.start(), found.end())

    def _continues(self, end: bytes) -> bool:
        if self._takes(b","):
            return True
        if not self._takes(end):
            self._fail()
        return False

    def _takes(self, mark: bytes) -> bool:
        taken = self._next() == mark
        self._at += taken
        return taken

    def _next(self) -> bytes:
        """Next byte after the blanks, none at the end; moves the position there."""
        found = BLANK.match(self._body, self._at)
        self._at = found.end() if found else self._at
        return self._body[self._at : self._at + 1]

    def _other_shape(self) -> NoReturn:
        self._skip()
        if not self._next():
            from_json(self._body)
            raise Problem(422, SHAPE, [(("applications",), "must be a list")])
        self._fail()

    def _fail(self) -> NoReturn:
        raise ValueError(f"unexpected byte at {self._at}" if self._at < len(self._body) else "it ends too early")

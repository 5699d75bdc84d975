"""Reading of texts and files given to a page: short texts on a worker, all else in a process with bounds."""

import dataclasses
from collections.abc import Callable, Collection, Mapping
from functools import partial
from typing import TypeVar

from starlette.requests import Request

from hpn.tables.columns import Choices
from hpn.tables.files import TableBounds
from hpn.tables.reading import Reading, reading_of
from hpn.web.door.pools import compute, compute_beside
from hpn.web.door.visit import current
from hpn.words.patterns import Pattern

T = TypeVar("T")

SHORT_CHARACTERS = 2_000
"""Length up to which a text is read on a worker; any such text takes only some milliseconds."""

_PLACE = Pattern(r"([ru])([0-9]{1,6})", 7)


async def read(request: Request, content: bytes | str, bounds: TableBounds, fields: Mapping[str, str]) -> Reading:
    """Reading of a file or text with the answers in a form's fields; raises Problem 413 or 503."""
    work = await compute(request, "pages", work_of, reading_of, content, bounds, fields)
    if isinstance(content, str) and len(content) <= SHORT_CHARACTERS:
        return await compute(request, "pages", work)
    return await compute_beside(request, "files", work)


def work_of(
    how: Callable[[bytes | str, TableBounds, Choices, Collection[str]], T],
    content: bytes | str,
    bounds: TableBounds,
    fields: Mapping[str, str],
) -> Callable[[], T]:
    """Call that reads. A column without a unit is in the wire's unit if the reader uses the same unit."""
    reader = current()
    assumed = tuple(unit for unit in bounds.inputs.units if reader.measure(unit).same)
    return partial(how, content, bounds, choices_of(fields), assumed)


def choices_of(fields: Mapping[str, str]) -> Choices:
    """Answers to the reading's questions in the fields of a form."""
    choices: dict[str, dict[int, str]] = {"r": {}, "u": {}}
    for name, value in fields.items():
        if place := _PLACE.fullmatch(name):
            choices[place[1]][int(place[2])] = value
    named = {part.name: fields.get(part.name, "") for part in dataclasses.fields(Choices) if part.type is str}
    return Choices(**named, roles=choices["r"], units=choices["u"])

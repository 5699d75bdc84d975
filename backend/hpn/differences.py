"""What two replies to the same application say differently, field by field, verdicts first."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

NAMED_BY = {"candidates": "designation", "checks": "code", "notices": "code"}
"""Lists whose items are matched by a field of theirs: their order follows from what the items say."""

BRIEFLY = {"candidates": "status", "checks": "status", "notices": "text", "check_definitions": "title"}
"""The one field that stands for an item which only one reply has."""

VERDICTS = ("selected", "status", "governing_check", "rank")
TEXTS = ("reason", "link", "notices", "check_definitions")
VERSIONS = ("engine_version", "catalogue_version")
TOLERANCE = 1e-12
"""Relative; the same calculation on another processor may differ by less."""

Name = tuple[str, ...]
Change = Literal["changed", "added", "removed"]
Kind = Literal["verdict", "figure", "text"]


@dataclass(frozen=True, slots=True)
class Difference:
    """One field that two replies give differently.

    `pointer` is its JSON pointer in the saved reply, or in today's where the saved one lacks it. Of a candidate, check
    or notice that only one of them has, its status or text stands for the whole.
    """

    pointer: str
    kind: Kind
    change: Change
    candidate: str | None
    check: str | None
    field: str
    saved: Any
    today: Any


@dataclass(slots=True)
class _Fields:
    """The fields of a reply by a name that does not depend on any order, and the items they belong to."""

    values: dict[Name, tuple[str, Any]] = field(default_factory=dict)
    items: set[Name] = field(default_factory=set)

    def add(self, value: Any, name: Name = (), pointer: str = "") -> None:
        """Take in a value with all that is in it."""
        for key, part, item in _parts(value, name[-1] if name else ""):
            inner = (*name, key)
            if name and name[-1] in BRIEFLY:
                self.items.add(inner)
            if isinstance(item, Mapping | list):
                self.add(item, inner, f"{pointer}/{part}")
            else:
                self.values[inner] = f"{pointer}/{part}", item


def _parts(value: Mapping[str, Any] | list[Any], holder: str) -> Iterator[tuple[str, str, Any]]:
    """Name, JSON pointer and value of each part of an object or a list."""
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield key, key.replace("~", "~0").replace("/", "~1"), item
        return
    seen: Counter[str] = Counter()
    for index, item in enumerate(value):
        name = str(item[NAMED_BY[holder]]) if holder in NAMED_BY else str(index)
        seen[name] += 1
        yield name if seen[name] == 1 else f"{name} {seen[name]}", str(index), item


def differences(saved: Mapping[str, Any], today: Mapping[str, Any]) -> list[Difference]:
    """Differences of two replies: verdicts, then figures, then texts; the versions themselves are left out."""
    before, after = _Fields(), _Fields()
    before.add({key: value for key, value in saved.items() if key not in VERSIONS})
    after.add({key: value for key, value in today.items() if key not in VERSIONS})
    found = [
        _difference(name, before.values.get(name), after.values.get(name))
        for name in before.values | after.values
        if _differs(name, before, after)
    ]
    return sorted(found, key=_weight)


def _differs(name: Name, before: _Fields, after: _Fields) -> bool:
    old, new = before.values.get(name), after.values.get(name)
    if old is not None and new is not None:
        return not _same(old[1], new[1])
    lacking = before.items if old is None else after.items
    items = (name[:length] for length in range(2, len(name)) if name[length - 2] in BRIEFLY)
    alone = next((item for item in items if item not in lacking), None)
    return alone is None or name == (*alone, BRIEFLY[alone[-2]])


def _same(saved: Any, today: Any) -> bool:
    numbers = all(isinstance(value, int | float) and not isinstance(value, bool) for value in (saved, today))
    return bool(saved == today or (numbers and math.isclose(saved, today, rel_tol=TOLERANCE)))


def _difference(name: Name, old: tuple[str, Any] | None, new: tuple[str, Any] | None) -> Difference:
    pointer, _ = old or new or ("", None)
    return Difference(
        pointer=pointer,
        kind="text" if any(part in TEXTS for part in name) else "verdict" if name[-1] in VERDICTS else "figure",
        change="added" if old is None else "removed" if new is None else "changed",
        candidate=name[1] if name[0] == "candidates" else None,
        check=name[3] if len(name) > 3 and (name[0], name[2]) == ("candidates", "checks") else None,
        field=name[-1],
        saved=old and old[1],
        today=new and new[1],
    )


def _weight(difference: Difference) -> int:
    if difference.kind == "verdict":
        return 2 * VERDICTS.index(difference.field) + (difference.check is not None)
    return 100 if difference.kind == "figure" else 200

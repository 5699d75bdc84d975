"""Differences between two replies to the same application, field by field, verdicts first."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields
from itertools import chain
from typing import Annotated, Any, Literal

from msgspec import Struct, structs
from pydantic import Field

from hpn.catalogue import Catalogue
from hpn.engine.selection import Selection
from hpn.explain.comparison import TOLERANCE, aligned, is_number, is_same
from hpn.words.reply import Reply

NAMED_BY = {"candidates": "designation", "checks": "code", "notices": "code"}
"""Lists whose items are matched by one of their fields: their order follows from their content."""

BRIEFLY = {"candidates": "status", "checks": "status", "notices": "text", "check_definitions": "title"}
"""Field that represents an item of only one reply."""

VERDICTS = ("selected", "status", "governing_check", "rank")
TEXTS = ("reason", "link", "notices", "check_definitions")
NOT_COMPARED = ("engine_version", "catalogue_version", "values")
"""Fields without a difference of their own: versions, and the values of a notice, which its text shows."""

Name = tuple[str, ...]
Change = Literal["changed", "added", "removed"]
Kind = Literal["verdict", "figure", "text"]


class Difference(Reply, frozen=True):
    """One field that differs between two replies.

    `pointer` is its JSON pointer in the saved reply, or in today's if the saved one lacks it. A candidate, check or
    notice in only one reply is one difference: its status or text.
    """

    pointer: Annotated[
        str,
        Field(description="JSON pointer into the saved result; into today’s if change is added."),
    ]
    kind: Annotated[Kind, Field(description="Kind of the field; verdicts come first, then figures, then texts.")]
    change: Annotated[Change, Field(description="Field in both replies, or in one only.")]
    candidate: Annotated[str | None, Field(description="Designation of the candidate of this field.")]
    check: Annotated[str | None, Field(description="Code of the check of this field.")]
    field: Annotated[str, Field(description="Name of the field.")]
    saved: Annotated[Any, Field(description="Value as saved.")]
    today: Annotated[Any, Field(description="Value today.")]
    cause: Annotated[
        Literal["tie_rule"] | None,
        Field(
            description="Reason for another verdict with the same figures: gears or checks tie, and in an earlier "
            "version the last bit of a number decided."
        ),
    ] = None


@dataclass(slots=True)
class _Fields:
    """The fields of a reply by names that don't depend on any order, and the items they belong to."""

    values: dict[Name, tuple[str, Any]] = field(default_factory=dict)
    items: set[Name] = field(default_factory=set)

    def add(self, value: Any, name: Name = (), pointer: str = "") -> None:
        """Add a value with everything inside it."""
        for key, part, item in _parts(value, name[-1] if name else ""):
            inner = (*name, key)
            if name and name[-1] in BRIEFLY:
                self.items.add(inner)
            if isinstance(item, Struct | Mapping | list | tuple):
                self.add(item, inner, f"{pointer}/{part}")
            else:
                self.values[inner] = f"{pointer}/{part}", item


def _parts(value: Any, holder: str) -> Iterator[tuple[str, str, Any]]:
    """Name, JSON pointer and value of each part of an object or a list."""
    if isinstance(value, Struct | Mapping):
        for key, item in _fields_of(value).items():
            if key not in NOT_COMPARED:
                yield key, key.replace("~", "~0").replace("/", "~1"), item
        return
    seen: Counter[str] = Counter()
    for index, item in enumerate(value):
        name = str(_fields_of(item)[NAMED_BY[holder]]) if holder in NAMED_BY else str(index)
        seen[name] += 1
        yield name if seen[name] == 1 else f"{name} {seen[name]}", str(index), item


def _fields_of(value: Struct | Mapping[str, Any]) -> Mapping[str, Any]:
    return structs.asdict(value) if isinstance(value, Struct) else value


def differences(saved: Selection | Mapping[str, Any], today: Selection | Mapping[str, Any]) -> list[Difference]:
    """Differences of two replies: verdicts, then figures, then texts; the versions themselves are left out."""
    before, after = _Fields(), _Fields()
    before.add(saved)
    after.add(today)
    largest = _largest_of_lists(before, after)
    known = {_of_any(name) for name in before.values}
    kinds = {name[:-1] for name in known}
    different = [
        _difference(name, old, new)
        for name, (old, new) in aligned(before.values, after.values)
        if (one := _of_any(name)) in known or one[:-1] not in kinds
        if _differs(name, before, after, largest)
    ]
    if not any(one.kind == "figure" or one.field == "status" for one in different):
        different = [structs.replace(one, cause="tie_rule") if one.kind == "verdict" else one for one in different]
    return sorted(different, key=_weight)


def _of_any(name: Name) -> Name:
    """Name of a field of any item. If none of these items has the field, its version did not know it."""
    named = enumerate(name)
    return tuple("" if place and (name[place - 1] in BRIEFLY or part.isdecimal()) else part for place, part in named)


def _list_of(name: Name) -> Name:
    """Name of a field of a numbered item without its number: the same for all items."""
    return tuple("" if part.isdecimal() else part for part in name)


def _largest_of_lists(*replies: _Fields) -> dict[Name, float]:
    """Largest magnitude of each field of numbered items, such as the torque of phases."""
    largest: dict[Name, float] = {}
    for name, (_, value) in chain.from_iterable(reply.values.items() for reply in replies):
        if is_number(value) and (one := _list_of(name)) != name:
            largest[one] = max(largest.get(one, 0.0), abs(value))
    return largest


def _differs(name: Name, before: _Fields, after: _Fields, largest: Mapping[Name, float]) -> bool:
    old, new = before.values.get(name), after.values.get(name)
    if (old is None or old[1] is None) and (new is None or new[1] is None):
        return False  # an omitted field is null
    if old is not None and new is not None:
        return not is_same(old[1], new[1], TOLERANCE * largest.get(_list_of(name), 0.0))
    lacking = before.items if old is None else after.items
    items = (name[:length] for length in range(2, len(name)) if name[length - 2] in BRIEFLY)
    alone = next((item for item in items if item not in lacking), None)
    return alone is None or name == (*alone, BRIEFLY[alone[-2]])


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


# --- Published figures ------------------------------------------------------------------------------------------------

DESIGNATION = "designation"
NOT_FIGURES = (DESIGNATION, "size", "ratio", "sources", "source")


class FigureDifference(Reply, frozen=True):
    """A published figure of a gear, or a figure of a listed motor, that differs between two catalogues; null where a
    catalogue lacks it.

    A gear or motor in only one catalogue is one difference: its designation. A supplied curve is a list of points,
    bolts are objects.
    """

    candidate: Annotated[str | None, Field(description="Designation of the gear; null for a figure of a motor.")]
    motor: Annotated[str | None, Field(description="Designation of the motor; null for a figure of a gear.")]
    field: Annotated[
        str,
        Field(
            description="Name of the figure in the catalogue; designation if only one catalogue has the gear or motor."
        ),
    ]
    saved: Annotated[Any, Field(description="Figure in the catalogue of that time; null where it was not published.")]
    today: Annotated[Any, Field(description="Figure in today’s catalogue; null where it is not published.")]


def figure_differences(
    saved: Catalogue, today: Catalogue, designations: Iterable[str], motor: str | None = None
) -> list[FigureDifference]:
    """Differences of two catalogues in the published figures of some gears, gear by gear, and of a listed motor."""
    of_gears = [
        FigureDifference(designation, None, *difference)
        for designation in designations
        for difference in _pairs(_of_gear(saved, designation), _of_gear(today, designation))
    ]
    of_motor = [] if motor is None else _pairs(_of_motor(saved, motor), _of_motor(today, motor))
    return of_gears + [FigureDifference(None, motor, *difference) for difference in of_motor]


def _pairs(before: dict[str, Any], after: dict[str, Any]) -> list[tuple[str, Any, Any]]:
    """Names and both values of the figures that differ; for an item of one catalogue only, its designation."""
    both = bool(before and after)
    pairs = (pair for pair in aligned(before, after) if both or pair[0] == DESIGNATION)
    return [(name, old, new) for name, (old, new) in pairs if not is_same(old, new)]


def _of_gear(catalogue: Catalogue, designation: str) -> dict[str, Any]:
    """Figures of a gear by name; empty if the catalogue lacks it."""
    gear = catalogue.by_designation.get(designation)
    if gear is None:
        return {}
    curve, efficiency = catalogue.curves.get(gear.size), catalogue.efficiency.get(designation)
    return {
        "designation": designation,
        **_figures(gear),
        "clamp_bolts": [_figures(bolt) for bolt in gear.clamp_bolts],
        "housing_bolts": gear.housing_bolts and _figures(gear.housing_bolts),
        "bearing_curve": None if curve is None else _points(curve.axial_N, curve.radial_N),
        "efficiency_curve": None if efficiency is None else _points(*efficiency),
    }


def _of_motor(catalogue: Catalogue, designation: str) -> dict[str, Any]:
    """Figures of a listed motor by name; empty if the catalogue lacks it."""
    motor = catalogue.motor_by_designation.get(designation)
    return {"designation": designation, **_figures(motor)} if motor else {}


def _figures(row: Any) -> dict[str, Any]:
    return {f.name: getattr(row, f.name) for f in fields(row) if f.name not in NOT_FIGURES}


def _points(*columns: Any) -> list[list[float]]:
    return [list(point) for point in zip(*(column.tolist() for column in columns), strict=True)]

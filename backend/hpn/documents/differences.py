"""Differences of two frozen documents, axis by axis: inputs, verdicts and figures.

Axes are matched by their numbers, inputs by their places, and numbers are equal within the tolerance of the comparison.
An input that both axes inherit appears only among the common values.
"""

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Raw, structs
from pydantic import Field

from hpn.application.faults import pointer
from hpn.catalogue import Catalogue
from hpn.documents.answers import AxisAnswer, AxisQuestion, AxisStatus, answers
from hpn.documents.merge import resolve
from hpn.documents.revision import Frozen, FrozenAxis
from hpn.documents.summary import Summary, gear_of, summary_of
from hpn.explain.comparison import aligned, is_same
from hpn.words.reply import Reply

VERDICTS = ("status", "selected", "designation", "governing_check")
NOT_COMPARED = (*("engine_version", "catalogue_version"), *("faults", "not_asked", "unknown"))
"""Fields of an answer without a difference of their own: versions, and consequences of the inputs."""

FIGURES = tuple(name for name in AxisAnswer.__struct_fields__ if name not in (*VERDICTS, *NOT_COMPARED))

OWN = ("name", "quantity", "note", "ordering_code")
TITLE_BLOCK = ("title", "reference", "author", "note")

DEEPEST = 6
"""Depth of an application; deeper values are compared as a whole."""

FROM_TO = {"value_from": "from", "value_to": "to"}
SIDES = {"side_from": "from", "side_to": "to"}

Change = Literal["changed", "added", "removed"]


class DifferentInput(Reply, frozen=True, rename=FROM_TO):
    """One input that differs between two documents; null where a document lacks it."""

    pointer: Annotated[str, Field(description="JSON pointer into the axis; for a common value, into the document.")]
    value_from: Annotated[Any, Field(description="Value in the first document.")]
    value_to: Annotated[Any, Field(description="Value in the second document.")]
    inherited_from: Annotated[bool, Field(description="True: the first value is inherited from the machine.")] = False
    inherited_to: Annotated[bool, Field(description="True: the second value is inherited from the machine.")] = False


class DifferentAnswer(Reply, frozen=True, rename=FROM_TO):
    """One verdict or figure that differs."""

    field: Annotated[str, Field(description="Name of the field of the answer.")]
    value_from: Annotated[Any, Field(description="Value in the first document.")]
    value_to: Annotated[Any, Field(description="Value in the second document.")]


class AxisSide(Reply, frozen=True):
    """An axis of one document in brief."""

    gear: Annotated[str | None, Field(description="Designation of its gear; null without one.")]
    designation: Annotated[
        str | None, Field(description="Gear of the figures: the axis’s own gear, or the nearest miss.")
    ]
    status: Annotated[AxisStatus, Field(description="Verdict on that gear.")]
    governing_check: Annotated[str | None, Field(description="Code of the check closest to its limit.")]
    utilisation: Annotated[float | None, Field(description="Utilisation of that gear.")]

    @classmethod
    def of(cls, axis: FrozenAxis) -> "AxisSide":
        """Axis in brief."""
        answer = axis.answer
        return cls(gear_of(axis), answer.designation, answer.status, answer.governing_check, answer.utilisation)


class DifferentAxis(Reply, frozen=True, rename=SIDES):
    """An axis that differs, or exists in one document only."""

    number: Annotated[int, Field(description="Number of the axis.")]
    name: Annotated[str | None, Field(description="Name of the axis, from the second document if it has the axis.")]
    change: Annotated[Change, Field(description="Axis in both documents, in the second only, or in the first only.")]
    side_from: Annotated[AxisSide | None, Field(description="The axis in the first document.")]
    side_to: Annotated[AxisSide | None, Field(description="The axis in the second document.")]
    effect: Annotated[
        float | None, Field(description="Increase of the utilisation; null where a document has no utilisation.")
    ]
    inputs: Annotated[tuple[DifferentInput, ...], Field(description="Inputs that differ.")]
    verdicts: Annotated[tuple[DifferentAnswer, ...], Field(description="Verdicts that differ.")]
    figures: Annotated[tuple[DifferentAnswer, ...], Field(description="Figures that differ.")]

    @property
    def lost_its_gear(self) -> bool:
        """True for an axis without a suitable gear that had one before, or is new."""
        was = self.side_from is None or self.side_from.status == "suitable"
        return self.side_to is not None and self.side_to.status != "suitable" and was

    @property
    def has_another_gear(self) -> bool:
        """True where both documents have the axis, and its gears differ."""
        return bool(self.side_from and self.side_to and self.side_from.gear != self.side_to.gear)


class DocumentDifferences(Reply, frozen=True, rename=SIDES):
    """Differences of two documents: axes without a suitable gear first, then axes with another gear, then by effect."""

    side_from: Annotated[Summary, Field(description="The first document in brief.")]
    side_to: Annotated[Summary, Field(description="The second document in brief.")]
    common: Annotated[tuple[DifferentInput, ...], Field(description="Title block and common values that differ.")]
    order: Annotated[bool, Field(description="True: the order of the axes differs.")]
    axes: Annotated[tuple[DifferentAxis, ...], Field(description="Axes that differ.")]
    same: Annotated[int, Field(description="Number of axes in both documents without a difference.")]


def differences(
    one: Frozen, other: Frozen, catalogues: tuple[Catalogue | None, Catalogue | None] = (None, None)
) -> DocumentDifferences:
    """Differences of two documents; gears are counted and weighed where the catalogue of a document's answers is
    kept."""
    before, after = ({axis.number: axis for axis in side.axes} for side in (one, other))
    pairs = [(number, old, new) for number, (old, new) in aligned(before, after)]
    different = [axis for number, old, new in pairs if (axis := _axis(number, old, new))]
    both = [number for number in before if number in after]
    return DocumentDifferences(
        side_from=summary_of(one, catalogues[0]),
        side_to=summary_of(other, catalogues[1]),
        common=tuple(_common(one, other)),
        order=both != [number for number in after if number in before],
        axes=tuple(sorted(different, key=_weight)),
        same=len(pairs) - len(different),
    )


def today(document: Frozen, catalogue: Catalogue) -> Frozen:
    """Document answered again by this engine and a catalogue; its inputs stay as they were resolved."""
    questions = [AxisQuestion(resolve(_json(axis.resolved), {}), axis.ordering_code) for axis in document.axes]
    axes = [
        structs.replace(axis, answer=structs.replace(answer, not_asked=axis.answer.not_asked))
        for axis, answer in zip(document.axes, answers(questions, catalogue), strict=True)
    ]
    return structs.replace(document, axes=tuple(axes))


def _weight(axis: DifferentAxis) -> tuple[int, float, int]:
    kind = 0 if axis.lost_its_gear else 1 if axis.has_another_gear else 2 if axis.change != "changed" else 3
    unknown = any(each.field == "utilisation" for each in axis.figures)
    effect = (math.inf if unknown else 0.0) if axis.effect is None else abs(axis.effect)
    return kind, -effect, axis.number


# --- Axes -------------------------------------------------------------------------------------------------------------


def _axis(number: int, old: FrozenAxis | None, new: FrozenAxis | None) -> DifferentAxis | None:
    """Differences of an axis; None where there are none."""
    inputs, answers = list[DifferentInput](), list[DifferentAnswer]()
    if old is not None and new is not None:
        inputs, answers = list(_inputs(old, new)), list(_answer_differences(old.answer, new.answer))
        if not inputs and not answers:
            return None
    sides = [None if axis is None else AxisSide.of(axis) for axis in (old, new)]
    used = [side.utilisation if side else None for side in sides]
    known = new or old
    return DifferentAxis(
        number=number,
        name=known.name if known else None,
        change="added" if old is None else "removed" if new is None else "changed",
        side_from=sides[0],
        side_to=sides[1],
        effect=None if used[0] is None or used[1] is None else used[1] - used[0],
        inputs=tuple(inputs),
        verdicts=tuple(each for each in answers if each.field in VERDICTS),
        figures=tuple(each for each in answers if each.field in FIGURES),
    )


def _answer_differences(old: AxisAnswer, new: AxisAnswer) -> Iterator[DifferentAnswer]:
    """Verdicts and figures that differ, without those that the version of one answer did not know."""
    unknown = {*old.unknown, *new.unknown}
    for name in (*VERDICTS, *FIGURES):
        one, other = getattr(old, name), getattr(new, name)
        if name not in unknown and not is_same(one, other):
            yield DifferentAnswer(name, one, other)


def _inputs(old: FrozenAxis, new: FrozenAxis) -> Iterator[DifferentInput]:
    """Inputs of an axis that differ, by value or by being its own."""
    for name in OWN:
        if getattr(old, name) != getattr(new, name):
            yield DifferentInput(f"/{name}", getattr(old, name), getattr(new, name))
    if {*old.without} != {*new.without}:
        yield DifferentInput("/without", list(old.without), list(new.without))
    if bytes(old.application) == bytes(new.application) and bytes(old.resolved) == bytes(new.resolved):
        return
    own = [{place for place, _ in _values(_json(axis.application))} for axis in (old, new)]
    sides = (dict(_values(_json(axis.resolved))) for axis in (old, new))
    for place, (one, other) in aligned(*sides):
        inherited = [value is not None and place not in mine for value, mine in zip((one, other), own, strict=True)]
        alike = is_same(one, other)
        if (
            (alike and inherited[0] == inherited[1])
            or all(inherited)
            or (not alike and any(inherited) and (one is None or other is None))
        ):
            continue
        yield DifferentInput(pointer(("resolved", *place)), one, other, *inherited)


def _common(old: Frozen, new: Frozen) -> Iterator[DifferentInput]:
    for name in TITLE_BLOCK:
        if getattr(old, name) != getattr(new, name):
            yield DifferentInput(f"/{name}", getattr(old, name), getattr(new, name))
    for place, (one, other) in aligned(dict(_values(old.common)), dict(_values(new.common))):
        if not is_same(one, other):
            yield DifferentInput(pointer(("common", *place)), one, other)


# --- Values -----------------------------------------------------------------------------------------------------------


def _json(raw: Raw) -> Mapping[str, Any]:
    value = msgspec.json.decode(raw)
    return value if isinstance(value, Mapping) else {}


Place = tuple[str | int, ...]


def _values(value: Any, place: Place = ()) -> Iterator[tuple[Place, Any]]:
    """Places and values in a part of an application; a list of plain values, such as ratios, is one value."""
    if isinstance(value, Mapping) and len(place) < DEEPEST:
        for name, part in value.items():
            yield from _values(part, (*place, name))
    elif isinstance(value, list) and len(place) < DEEPEST and any(isinstance(item, Mapping) for item in value):
        for index, item in enumerate(value):
            yield from _values(item, (*place, index))
    elif value is not None:
        yield place, value

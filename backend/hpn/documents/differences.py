"""Differences between two states of a document, axis by axis: what was asked, and what came of it."""

import json
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Annotated, Any, Literal

from msgspec import structs
from pydantic import Field

from hpn.catalogue import Catalogue
from hpn.documents.answers import Asked, answers
from hpn.documents.merge import resolve
from hpn.documents.revision import Frozen, FrozenAxis
from hpn.explain.comparison import is_same
from hpn.words.reply import Reply

BLOCK = ("title", "reference", "author", "note")
LABELS = ("name", "quantity", "note", "ordering_code", "without")
VERDICTS = ("status", "selected", "designation", "governing_check")
FIGURES = (
    *("utilisation", "life_L10_h", "shortest_life_h", "shortest_life_of", "natural_frequency_Hz"),
    *("motor_torque_limit_Nm", "weight_kg", "suitable", "runner_up", "average_torque_Nm", "not_asked"),
)


class Cell(Reply, frozen=True, rename={"before": "from", "after": "to"}):
    """One value that differs."""

    path: Annotated[str, Field(description="Path of the value.")]
    before: Annotated[Any, Field(description="Value of the first state; null where it has none.")]
    after: Annotated[Any, Field(description="Value of the second state; null where it has none.")]


Cells = tuple[Cell, ...]


class AxisDifference(Reply, frozen=True):
    """One axis that differs."""

    number: Annotated[int, Field(description="Number of the axis.")]
    name: Annotated[str | None, Field(description="Its name, in the second state where it is there.")]
    change: Annotated[Literal["added", "removed", "changed"], Field(description="In both states, or in one.")]
    inputs: Annotated[Cells, Field(description="Inputs that differ, resolved ones by their paths.")]
    verdicts: Annotated[Cells, Field(description="Verdict, gear and governing check, where they differ.")]
    figures: Annotated[Cells, Field(description="Figures that differ by more than 1e-12 of themselves.")]


class DocumentDifferences(Reply, frozen=True):
    """Everything that differs, axes with another verdict first; what is the same is left out."""

    title_block: Annotated[Cells, Field(description="Title block.")]
    common: Annotated[Cells, Field(description="Common values by their paths.")]
    axes: Annotated[tuple[AxisDifference, ...], Field(description="Axes that differ.")]
    same: Annotated[int, Field(description="Number of axes that are the same.")]


def differences(one: Frozen, other: Frozen) -> DocumentDifferences:
    """Differences from one state of a document to another."""
    before, after = ({axis.number: axis for axis in state.axes} for state in (one, other))
    pairs = [(before.get(number), after.get(number)) for number in dict.fromkeys([*after, *before])]
    found = [each for each in (_axis(*pair) for pair in pairs) if each is not None]
    return DocumentDifferences(
        title_block=_cells(
            {name: getattr(one, name) for name in BLOCK}, {name: getattr(other, name) for name in BLOCK}
        ),
        common=_cells(dict(_leaves(one.common)), dict(_leaves(other.common))),
        axes=tuple(sorted(found, key=lambda axis: (not axis.verdicts, axis.change == "changed"))),
        same=len(pairs) - len(found),
    )


def _block(state: Frozen) -> dict[str, Any]:
    return {name: getattr(state, name) for name in BLOCK}


def today(state: Frozen, catalogue: Catalogue) -> Frozen:
    """A state whose axes have the answers of today's engine and catalogue."""
    asked = [Asked(resolve(json.loads(bytes(axis.resolved)), {}), axis.ordering_code) for axis in state.axes]
    found = answers(asked, catalogue)
    axes = (
        structs.replace(axis, answer=structs.replace(now, not_asked=axis.answer.not_asked))
        for axis, now in zip(state.axes, found, strict=True)
    )
    return structs.replace(state, axes=tuple(axes))


def _axis(before: FrozenAxis | None, after: FrozenAxis | None) -> AxisDifference | None:
    there = after or before
    assert there is not None
    inputs = _cells(_inputs(before), _inputs(after))
    unknown = {name for axis in (before, after) if axis for name in axis.answer.unknown}
    verdicts, figures = (
        _cells(_answer(before, names, unknown), _answer(after, names, unknown)) for names in (VERDICTS, FIGURES)
    )
    if before is not None and after is not None and not (inputs or verdicts or figures):
        return None
    change: Literal["added", "removed", "changed"] = "changed"
    if before is None or after is None:
        change = "added" if before is None else "removed"
    return AxisDifference(there.number, there.name, change, inputs, verdicts, figures)


def _inputs(axis: FrozenAxis | None) -> dict[str, Any]:
    if axis is None:
        return {}
    labels = {name: getattr(axis, name) for name in LABELS}
    return labels | dict(_leaves(json.loads(bytes(axis.resolved)), "application"))


def _answer(axis: FrozenAxis | None, names: Sequence[str], unknown: Collection[str]) -> dict[str, Any]:
    """Part of an answer, without the figures of which the version of one side knew nothing."""
    return {name: getattr(axis.answer, name) for name in names if axis and name not in unknown}


def _leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Values inside a value by their paths with dots."""
    if isinstance(value, Mapping) and value:
        for name, each in value.items():
            yield from _leaves(each, f"{path}.{name}" if path else str(name))
    elif isinstance(value, list) and any(isinstance(each, Mapping) for each in value):
        for place, each in enumerate(value):
            yield from _leaves(each, f"{path}.{place}")
    elif path:
        yield path, value


def _cells(before: Mapping[str, Any], after: Mapping[str, Any]) -> Cells:
    """Values that differ."""
    names = dict.fromkeys([*after, *before])
    pairs = ((name, before.get(name), after.get(name)) for name in names)
    return tuple(Cell(*pair) for pair in pairs if not _same(pair[1], pair[2]))


def _same(one: Any, other: Any) -> bool:
    try:
        return is_same(one, other)
    except OverflowError:  # a whole number that no float holds, of an axis that is open for it
        return False

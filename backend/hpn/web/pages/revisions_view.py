"""Revisions of a document and the comparison of two of its states, for their page."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from string import ascii_uppercase
from typing import Any, NamedTuple

from hpn.documents.differences import DifferentAxis, DocumentDifferences
from hpn.documents.revision import NOW, TODAY, Frozen, FrozenAxis, label_key
from hpn.documents.summary import Summary, gear_of
from hpn.files.machine.changes import (
    Cell,
    DifferencesExport,
    answer_cells,
    cells_of,
    effect,
    has_results,
    head_of,
    input_cells,
)
from hpn.files.machine.words import bound_of, utilisation_text
from hpn.store import Machine, RevisionLine
from hpn.words.reader import Reader
from hpn.words.wording import N_

MOST_LINES, MOST_AXES, MOST_CELLS = 100, 500, 12
"""Maximum revisions in the list, axes in a comparison and inputs per axis on the page; the workbook has all."""

MOST_REVISIONS = 20
"""Most revisions that the page of a selection or an axis names; their own page has more."""

STATES = {NOW: N_("Working copy"), TODAY: N_("Today")}
"""States beside revisions."""


BLOCK = {
    "label": N_("Label"),
    "author": N_("Author"),
    "checked": N_("Checked"),
    "approved": N_("Approved"),
    "note": N_("Note"),
}
"""Fields of the form that saves a revision."""


class SideShown(NamedTuple):
    """Gear of an axis in one state, with utilisation, its limit, status, and utilisation as text."""

    gear: str | None
    utilisation: float | None
    bound: float
    status: str
    text: str

    @classmethod
    def of(cls, axis: FrozenAxis | None, reader: Reader) -> "SideShown | None":
        """Side of an axis; None if the state lacks it."""
        if axis is None:
            return None
        answer = axis.answer
        return cls(gear_of(axis), answer.utilisation, bound_of(axis), answer.status, utilisation_text(axis, reader))


class ComparedAxis(NamedTuple):
    """Axis in both states: differing cells, inputs or else results, number of further ones, and their effect on its
    gear.
    """

    number: int
    name: str
    before: SideShown | None
    after: SideShown | None
    cells: Sequence[Cell] = ()
    more: int = 0
    effect: str = ""
    has_results: bool = False


@dataclass(frozen=True)
class Compared:
    """Two states of a document side by side; `whole` includes axes that do not differ."""

    export: DifferencesExport
    reader: Reader
    whole: bool = False

    @property
    def labels(self) -> tuple[str, str]:
        """Labels of both states."""
        return self.export.labels

    @cached_property
    def differences(self) -> DocumentDifferences:
        """Differences of the two states."""
        return self.export.differences

    @property
    def sides(self) -> tuple[Summary, Summary]:
        """Summaries of both states."""
        return self.differences.side_from, self.differences.side_to

    @property
    def cells(self) -> int:
        """Number of differing inputs; a common value counts once."""
        return sum(len(axis.inputs) for axis in self.differences.axes) + self.common_cells

    @property
    def common_cells(self) -> int:
        """Number of differing common values."""
        return sum(one.pointer.startswith("/common/") for one in self.differences.common)

    @property
    def count_of_changed(self) -> int:
        """Number of axes with a differing input, or in only one of the states."""
        return sum(bool(axis.inputs) or axis.change != "changed" for axis in self.differences.axes)

    @property
    def axes(self) -> int:
        """Number of axes in either state."""
        return len(self.differences.axes) + self.differences.same

    @cached_property
    def without_gear(self) -> list[DifferentAxis]:
        """Axes that lost their gear."""
        return [axis for axis in self.differences.axes if axis.lost_its_gear]

    @cached_property
    def other(self) -> list[DifferentAxis]:
        """Axes with another gear."""
        return [axis for axis in self.differences.axes if axis.has_another_gear and not axis.lost_its_gear]

    @cached_property
    def names(self) -> Mapping[int, str]:
        """Names of the axes of both states by their numbers."""
        both = (axis for document in self.export.documents for axis in document.axes)
        return {axis.number: axis.name or str(axis.number) for axis in both}

    @property
    def common(self) -> list[Cell]:
        """Differing fields of the title block and common values."""
        return input_cells(self.differences.common, self.reader)

    @property
    def inputs(self) -> list[Cell]:
        """Differing inputs, for a document with one axis."""
        return [cell for axis in self.differences.axes for cell in input_cells(axis.inputs, self.reader)]

    @property
    def results(self) -> list[Cell]:
        """Differing verdicts and figures, for a document with one axis."""
        answered = [each for axis in self.differences.axes for each in (*axis.verdicts, *axis.figures)]
        gear = next(((each.value_from, each.value_to) for each in answered if each.field == "designation"), None)
        # Without an ordering code the selected gear is the gear; it is shown once.
        once = [each for each in answered if each.field != "selected" or (each.value_from, each.value_to) != gear]
        return answer_cells(once, self.reader)

    @property
    def gears(self) -> tuple[str | None, str | None]:
        """Gears of a document with one axis."""
        one, other = (gear_of(document.axes[0]) if document.axes else None for document in self.export.documents)
        return one, other

    @cached_property
    def largest(self) -> tuple[str | None, str | None]:
        """Largest utilisation of a suitable gear in each state, as its axis shows it; None without such a gear."""
        one, other = (
            next(
                (utilisation_text(axis, self.reader) for axis in document.axes if axis.number == side.utilisation_axis),
                None,
            )
            for document, side in zip(self.export.documents, self.sides, strict=True)
        )
        return one, other

    @cached_property
    def rows(self) -> list[ComparedAxis]:
        """Axes to show."""
        rows = [self._row(axis) for axis in self.differences.axes[:MOST_AXES]]
        return rows + self._same(MOST_AXES - len(rows)) if self.whole else rows

    @property
    def cells_head(self) -> str:
        """Head of the column with their cells."""
        return head_of(self.differences.axes)

    @property
    def left_out(self) -> int:
        """Number of further axes that are not shown."""
        return (self.axes if self.whole else len(self.differences.axes)) - len(self.rows)

    def _row(self, axis: DifferentAxis) -> ComparedAxis:
        before, after = sides = self.export.sides(axis.number)
        cells = cells_of(axis, self.reader)
        return ComparedAxis(
            axis.number,
            self.names[axis.number],
            SideShown.of(before, self.reader),
            SideShown.of(after, self.reader),
            cells[:MOST_CELLS],
            max(0, len(cells) - MOST_CELLS),
            effect(axis, sides, self.reader),
            has_results(axis),
        )

    def _same(self, most: int) -> list[ComparedAxis]:
        differ = {axis.number for axis in self.differences.axes}
        same = [axis for axis in self.export.documents[1].axes if axis.number not in differ]
        return [
            ComparedAxis(axis.number, self.names[axis.number], side, side)
            for axis in same[:most]
            for side in [SideShown.of(axis, self.reader)]
        ]


def pair_of(machine: Machine, lines: Sequence[RevisionLine], labels: Mapping[str, str]) -> tuple[str, str] | None:
    """Labels of the states that an address compares; by default the latest revision and newer changes, or the latest
    two revisions. None without a revision.
    """
    if not lines:
        return None
    is_new = machine.updated > lines[0].created
    older, newer = (lines[0].label, NOW) if is_new or len(lines) == 1 else (lines[1].label, lines[0].label)
    before, after = (labels.get(name, "")[:20] or label for name, label in (("from", older), ("to", newer)))
    return label_as_saved(before, lines), label_as_saved(after, lines)


def is_working_copy(machine: Machine, lines: Sequence[RevisionLine], pair: tuple[str, str] | None) -> bool:
    """True if the state compared with today is the working copy, so that the next revision freezes it."""
    if pair is None or machine.saved is None:
        return False
    state = pair[0] if pair[1] == TODAY else pair[1]
    return state == NOW or (state == lines[0].label and not machine.updated > lines[0].created)


def moments_of(pair: tuple[str, str] | None, lines: Sequence[RevisionLine]) -> str:
    """Text with dates and authors of the compared revisions."""
    by_label = {line.label: line for line in lines}
    pair_lines = [by_label[label] for label in pair or () if label in by_label]
    days = dict.fromkeys(line.created.strftime("%Y-%m-%d") for line in pair_lines)
    authors = dict.fromkeys(line.author for line in pair_lines if line.author)
    return ", ".join([" – ".join(days), *authors])


def gears_shown(documents: Mapping[int, Frozen], reader: Reader) -> dict[int, SideShown | None]:
    """Gear of the first axis of each document; a selection has only this axis."""
    firsts = {number: next(iter(document.axes), None) for number, document in documents.items()}
    return {number: SideShown.of(axis, reader) for number, axis in firsts.items()}


def label_as_saved(label: str, lines: Iterable[RevisionLine]) -> str:
    """Label in the case of its revision or state, so that lists mark it; an unknown label is unchanged."""
    key = label_key(label)
    return key if key in STATES else next((line.label for line in lines if label_key(line.label) == key), label)


def next_label(lines: Sequence[RevisionLine]) -> str:
    """Label after the latest if that is a letter or ends in a number, and it is free; else the first free letter."""
    labels = {label_key(line.label) for line in lines}
    latest = lines[0].label if lines else ""
    head = latest.rstrip("0123456789")
    following = []
    if head != latest and len(latest) < 20:
        following = [f"{head}{int(latest[len(head) :]) + 1}"]
    elif len(latest) == 1 and latest.upper() in ascii_uppercase[:-1]:
        following = [chr(ord(latest) + 1)]
    return next((label for label in (*following, *ascii_uppercase) if label_key(label) not in labels), "")


def next_revision(lines: Sequence[RevisionLine]) -> dict[str, Any]:
    """Blank form that saves the next revision."""
    label = next_label(lines)
    return {"next": label, "block": {**dict.fromkeys(BLOCK, ""), "label": label}, "fields": BLOCK, "messages": ()}

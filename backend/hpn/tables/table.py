"""Table as it is read: what a page shows of it and asks about it, and what comes of it, as plain data."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import isfinite
from typing import Any, Literal, NamedTuple

from hpn.tables.columns import Column
from hpn.tables.heads import SKIPPED
from hpn.tables.inputs import PHASE_ROLES
from hpn.words.wording import Sentence

MOST_SKIPPED = 5
"""Rows that are skipped which stand among the others."""


class Interpretation(NamedTuple):
    """Result of reading a table in one way: speeds and time in words, and the course of the speed as a path in SVG."""

    sentence: Sentence
    course: str


@dataclass(frozen=True, slots=True)
class Choice:
    """A choice of how a table is read: its question, its options, and the chosen one, blank while it is asked.

    `numbers` shows beside an option what a number of the table is by it, `outcomes` what comes of the table.
    """

    name: str
    options: Mapping[str, str]
    question: Sentence | None = None
    chosen: str = ""
    numbers: Mapping[str, str] = field(default_factory=dict)
    outcomes: Mapping[str, Interpretation] = field(default_factory=dict)


class PreviewCell(NamedTuple):
    """A cell of a preview: a number in plain notation with its unit, one with two readings or none, or a text.

    A number that is `written` in some way is in the unit of the wire, given as suffix; any other in the unit behind it.
    """

    text: str
    unit: str = ""
    kind: Literal["number", "asked", "text", "unread"] = "unread"
    written: str = ""


class ShownRow(NamedTuple):
    """A row of a preview by its number: its cells, or its text if it is skipped; and how many are hidden above it."""

    number: int
    cells: tuple[PreviewCell, ...] = ()
    skipped: str = ""
    hidden: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """Reading of a table. It can be taken when there is no problem and no question.

    `phases` of one cycle are plain numbers in units of the wire, in the order of PHASE_ROLES, blank where a phase has
    no load; `names` are theirs, none where no column is read as that. `stop_Nm` is T_k by rows that are no phases but
    the emergency stop, blank for none. `axes` are rows in list form by the names of `hpn fleet`, where a cell that is
    no number stands as it is written; `origins` are the numbers of the rows that the phases of an axis stand in.
    `motors` are rows of figures by the names of a motor's fields; their origins are by their designations.
    """

    problem: Sentence | None = None
    questions: tuple[Sentence, ...] = ()
    choices: tuple[Choice, ...] = ()
    notes: tuple[Sentence, ...] = ()
    columns: tuple[Column, ...] = ()
    rows: int = 0
    headed: bool = False
    shown: tuple[ShownRow, ...] = ()
    separator: str = ""
    turned: bool = False
    phases: tuple[tuple[str, ...], ...] = ()
    names: tuple[str, ...] = ()
    stop_Nm: str = ""
    axes: tuple[dict[str, Any], ...] = ()
    origins: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    motors: tuple[dict[str, Any], ...] = ()

    @property
    def whole(self) -> bool:
        """True where it can be taken as it is."""
        return self.problem is None and not self.questions

    @property
    def unknown(self) -> int:
        """Number of columns below a header of which nothing is known: they can be skipped at once."""
        return sum(column.is_unknown for column in self.columns) if self.headed else 0

    def choice(self, name: str) -> Choice | None:
        """A choice by its name; None where the table leaves none."""
        return next((choice for choice in self.choices if choice.name == name), None)

    @property
    def remarks(self) -> list[Sentence]:
        """Notes but for those that stand as skipped rows among the others."""
        skipped = skipped_among(self.notes)
        return [note for note in self.notes if note not in skipped]

    @property
    def lasting_s(self) -> float | None:
        """Seconds that all phases take; None where that is not known, or too long for a number."""
        total = sum(float(phase[PHASE_ROLES.index("t")] or 0) for phase in self.phases)
        return total if self.phases and isfinite(total) else None


def skipped_among(notes: Sequence[Sentence]) -> list[Sentence]:
    """Notes that stand as skipped rows among the others."""
    return [note for note in notes if note.template == SKIPPED][:MOST_SKIPPED]

"""Table as read: the preview and questions of a page, and the phases, axes or motors, as plain data."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import isfinite
from typing import Any, Literal, NamedTuple

from hpn.tables.columns import Column
from hpn.tables.heads import SKIPPED
from hpn.tables.inputs import PHASE_ROLES
from hpn.words.wording import Sentence

MOST_SKIPPED = 5
"""Skipped rows that the preview shows among the others."""


class Interpretation(NamedTuple):
    """Result of reading a table in one way: speeds and time in words, and the course of the speed as an SVG path."""

    sentence: Sentence
    course: str


@dataclass(frozen=True, slots=True)
class Choice:
    """A choice of how a table is read: its question, its options, and the chosen option, blank while the question is
    open.

    `numbers` shows beside each option how it reads one number of the table; `outcomes` shows the resulting cycle.
    """

    name: str
    options: Mapping[str, str]
    question: Sentence | None = None
    chosen: str = ""
    numbers: Mapping[str, str] = field(default_factory=dict)
    outcomes: Mapping[str, Interpretation] = field(default_factory=dict)


class PreviewCell(NamedTuple):
    """A cell of a preview: a number in plain notation with its unit, a number with two readings or none, or a text.

    A number with its cell as `written` is in the unit of the wire, given as suffix; any other is in the unit behind it.
    """

    text: str
    unit: str = ""
    kind: Literal["number", "asked", "text", "unread"] = "unread"
    written: str = ""


class ShownRow(NamedTuple):
    """A row of a preview by its number: its cells, or its text if skipped; and the count of rows hidden above it."""

    number: int
    cells: tuple[PreviewCell, ...] = ()
    skipped: str = ""
    hidden: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """Reading of a table, which can be taken when there is no problem and no question.

    `phases` of one cycle are plain numbers in units of the wire, in the order of PHASE_ROLES, blank where a phase has
    no load; `names` are their names, empty without a column of names. `stop_Nm` is T_k from rows that are the emergency
    stop instead of phases, blank without any. `axes` are rows in list form by the names of `hpn fleet`, where a cell
    that is not a number stays as written; `origins` are the numbers of the rows of an axis's phases. `motors` are rows
    of figures by the names of a motor's fields; their origins are by designation.
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
        """Number of columns with unknown content below a header: they can be skipped at once."""
        return sum(column.is_unknown for column in self.columns) if self.headed else 0

    def choice(self, name: str) -> Choice | None:
        """A choice by its name; None where the table has no such choice."""
        return next((choice for choice in self.choices if choice.name == name), None)

    @property
    def remarks(self) -> list[Sentence]:
        """Notes except those that the preview shows as skipped rows."""
        skipped = skipped_among(self.notes)
        return [note for note in self.notes if note not in skipped]

    @property
    def lasting_s(self) -> float | None:
        """Duration of all phases in s; None if unknown, or too long for a float."""
        total = sum(float(phase[PHASE_ROLES.index("t")] or 0) for phase in self.phases)
        return total if self.phases and isfinite(total) else None


def skipped_among(notes: Sequence[Sentence]) -> list[Sentence]:
    """Notes that the preview shows as skipped rows."""
    return [note for note in notes if note.template == SKIPPED][:MOST_SKIPPED]

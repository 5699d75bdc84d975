"""A table of axes that somebody uploads, in whichever way it is written: a row is a phase, those of an axis together.

As with pasted duty cycles a number is never silently another number: what has two readings is asked. A cell that is no
number spoils its axis alone, which is then rejected with its reason.
"""

import decimal as decimals
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import groupby, pairwise
from math import isfinite
from typing import Any

from hpn.tables.bodies import Body, body_of
from hpn.tables.cells import DECIMALS, LONGEST_CELL, Decimal, Entry, Figure, Merged, entry, is_blank, is_number, plain
from hpn.tables.columns import NO_CHOICES, SKIP, Choices
from hpn.tables.heads import REQUIRED, skipped
from hpn.tables.numbers import known_units, split_unit
from hpn.tables.questions import MISSING, require_moments, scale_question, scaled_in, unit_behind, unit_question
from hpn.tables.sheets import Grid, RefusedError
from hpn.web.form.axis_columns import AXIS, BY_ROLE, PHASES, AxisColumn, columns_of, foreign_unit
from hpn.web.form.pasted import TIMES
from hpn.words import units
from hpn.words.wording import N_, Sentence, Value

SHARES = ("u", "eta", "fw")
"""Inputs that may be written as percentages."""

MOSTLY = 0.75
"""Share of the axes from which on all times count as going on: a bad cell in one changes nothing for the others."""

_APART = re.compile(r"[;/|\s]+")
_OF_RATIO = re.compile(r"\bi\s*=\s*|\s*:\s*1(?![0-9.,])")
"""What is written beside the number of a ratio: `i = 5`, `5:1`."""


@dataclass(frozen=True, slots=True)
class AxisTable:
    """What a table is read as. It can be taken when there is no problem and no question.

    `axes` are rows in list form by the names of `hpn fleet`; a cell that is no number stands there as it is written.
    """

    problem: Sentence | None = None
    questions: tuple[Sentence, ...] = ()
    notes: tuple[Sentence, ...] = ()
    columns: tuple[AxisColumn, ...] = ()
    body: Body | None = None
    decimal: Decimal | None = None
    marks: tuple[tuple[str, str], ...] = ()
    times: str = ""
    asks_times: bool = False
    scales: str = ""
    scaled: tuple[str, str] | None = None
    axes: tuple[dict[str, Any], ...] = ()

    @property
    def whole(self) -> bool:
        """Whether it can be taken as it is."""
        return bool(self.axes) and not self.questions

    @property
    def unknown(self) -> int:
        """How many columns below a header nothing is known of: they can be skipped at once."""
        return sum(column.is_unknown for column in self.columns) if self.body and self.body.headed else 0


def read_axes(grid: Grid, choices: Choices = NO_CHOICES, assumed: Collection[str] = ()) -> AxisTable:
    """What a table of cells is read as; raises nothing, `problem` says why it can't be."""
    try:
        body = body_of(grid, choices.scales)
        body = _with_axes(body, columns_of(body, choices, assumed))
        columns = columns_of(body, choices, assumed)
        return _Reading(_unmerged(body, columns), columns, choices).table()
    except RefusedError as refused:
        return AxisTable(refused.sentence)


def _unmerged(body: Body, columns: Sequence[AxisColumn]) -> Body:
    """A table in which an axis has its name, and each input that is merged, in its first row alone."""
    axis = next((column.place for column in columns if column.role == AXIS), None)
    once = {column.place for column in columns if column.role not in PHASES}
    rows: list[tuple[str, ...]] = []
    known = ""
    for row in body.rows:
        name = "" if axis is None or isinstance(row[axis], Merged) else row[axis]
        goes_on = bool(rows) and (is_blank(name) or name == known)
        known = known if goes_on else name
        rows.append(
            tuple(
                "" if isinstance(cell, Merged) and (place == axis or (goes_on and place in once)) else cell
                for place, cell in enumerate(row)
            )
        )
    return replace(body, rows=tuple(rows))


def _with_axes(body: Body, columns: Sequence[AxisColumn]) -> Body:
    """A table with those of its totals and titles among the rows that name an axis or have numbers of a phase."""
    places = {column.role: column.place for column in columns}
    named = [row for row in (*body.totals, *body.titles) if AXIS in places and not is_blank(row.cells[places[AXIS]])]
    moving = [places[role] for role in ("T", "n") if role in places]
    numbered = [row for row in body.totals if any(is_number(row.cells[place]) for place in moving)]
    kept = {row.number for row in (*named, *numbered)}
    notes = tuple(note for note in body.notes if note.values.get("row") not in kept)
    left = [row for row in body.totals if row.number not in kept and row.number not in body.numbers]
    return replace(body.including([*named, *numbered]), notes=(*notes, *(skipped(*row[::2]) for row in left)))


class _Reading:
    """One table on its way from cells to axes."""

    def __init__(self, body: Body, columns: tuple[AxisColumn, ...], choices: Choices) -> None:
        self.body, self.columns, self.choices = body, columns, choices
        self.by_role = {column.role: column for column in columns}
        self.questions: list[Sentence] = []
        self.notes = list(body.notes)

    def table(self) -> AxisTable:
        """The table with what is to be asked, or with its axes."""
        self._ask_columns()
        decimal, marks = self._decimal()
        groups = self._groups()
        times, asks_times = self._times(groups, decimal or ".")
        scaled = scaled_in(self.body, (column for column in self.columns if column.is_number))
        self.questions += scale_question(scaled, self.choices)
        open_ = bool(self.questions)
        return AxisTable(
            questions=tuple(self.questions),
            columns=self.columns,
            body=self.body,
            decimal=decimal,
            marks=marks,
            times=times,
            asks_times=asks_times,
            scales=self.choices.scales,
            scaled=scaled,
            axes=() if open_ else tuple(self._axes(groups, decimal or ".", times)),
            notes=(*self.notes, *self.body.grid.notes),
        )

    # --- Questions ----------------------------------------------------------------------------------------------------

    def _ask(self, template: str, **values: Value) -> None:
        self.questions.append(Sentence(template, dict(values)))

    def _ask_columns(self) -> None:
        roles = [column.role for column in self.columns]
        for column in self.columns:
            if not column.role:
                self._ask(N_("What is column {name}?"), name=column.called)
            elif column.quantity and not column.unit:
                self.questions.append(unit_question(self.body, column))
            elif column.role != SKIP and (unit := foreign_unit(self.body, column)):
                template = N_("Column {name}: {unit} is not read there. Convert it to {wire}, or let it be not read.")
                wire = units.SYMBOLS.get(column.unit, "1")
                self._ask(template, name=column.called, unit=unit, wire=wire)
        if AXIS not in roles:
            self._ask(N_("Which column names the axis?"))
        for role in REQUIRED:
            if role not in roles:
                self._ask(MISSING[role])
        for role in dict.fromkeys(roles):
            if role not in ("", SKIP) and roles.count(role) > 1:
                names = [column.called for column in self.columns if column.role == role]
                self._ask(N_("Columns {one} and {other} are read as the same."), one=names[0], other=names[1])

    def _decimal(self) -> tuple[Decimal | None, tuple[tuple[str, str], ...]]:
        """Decimal mark of the numbers, None where it is asked for, and what one with two readings is under each."""
        columns = [column for column in self.columns if column.is_number]
        held = [
            (cell, column) for row in self.body.rows for column in columns if not is_blank(cell := row[column.place])
        ]
        cells = [cell for cell, _ in held]
        read = {mark: [number_in(cell, mark) for cell in cells] for mark in DECIMALS}
        mark, marks = self._mark(cells, read)
        found = read[mark] if mark else [one or other for one, other in zip(*read.values(), strict=True)]
        self._note_unread(held, found, (mark,) if mark else DECIMALS)
        return mark, marks

    def _note_unread(
        self, held: Sequence[tuple[str, AxisColumn]], found: Sequence[Entry | None], marks: Collection[Decimal]
    ) -> None:
        """Say which cells are rejected with their axes: no numbers, and those in a unit that is not their column's."""
        wrong, strange, unknown = list[str](), list[str](), list[tuple[str, AxisColumn]]()
        for (cell, column), number in zip(held, found, strict=True):
            if number is None and column.quantity and _has_unknown_unit(cell):
                unknown.append((cell, column))
            elif number is None:
                wrong.append(cell)
            elif number.unit and all(_read(cell, column, mark) is None for mark in marks):
                strange.append(cell)
        for template, cells in (
            (N_("Cells that are no numbers, such as {cell}: {count}. Their axes are rejected."), wrong),
            (
                N_("Cells in a unit that is not of their column, such as {cell}: {count}. Their axes are rejected."),
                strange,
            ),
        ):
            if cells:
                self.notes.append(Sentence(template, {"count": len(cells), "cell": cells[0][:40]}))
        if unknown:
            cell, column = unknown[0]
            template = N_(
                "Cells in an unknown unit, such as {cell}: {count}. Known are {units}. Their axes are rejected."
            )
            said: dict[str, Value] = {"count": len(unknown), "cell": cell[:40], "units": known_units(column.quantity)}
            self.notes.append(Sentence(template, said))

    def _mark(
        self, cells: Sequence[str], read: Mapping[Decimal, Sequence[Entry | None]]
    ) -> tuple[Decimal | None, tuple[tuple[str, str], ...]]:
        """The mark by which most cells are numbers; asked where two would give different ones, or both are written."""
        counts = {mark: sum(cell is not None for cell in found) for mark, found in read.items()}
        left = [mark for mark in DECIMALS if counts[mark] == max(counts.values())]
        pairs = list(zip(*read.values(), strict=True))
        alone = [
            next((c for c, pair in zip(cells, pairs, strict=True) if pair[k] and not pair[1 - k]), "") for k in (0, 1)
        ]
        differing = next((pair for pair in pairs if pair[0] != pair[1] and all(pair)), None)
        if differing is None or (len(left) == 1 and not all(alone)):
            return left[0], ()
        marks = tuple((mark, cell.number) for mark, cell in zip(DECIMALS, differing, strict=True) if cell)
        if self.choices.decimal in DECIMALS:
            return next(mark for mark in DECIMALS if mark == self.choices.decimal), marks
        if all(alone):
            template = N_("Both decimal marks are written, as in {one} and {other}: which one counts?")
            self._ask(template, one=alone[0][:40], other=alone[1][:40])
        else:
            self._ask(N_("Which is the decimal mark?"))
        return None, marks

    def _times(self, groups: Sequence["Group"], decimal: Decimal) -> tuple[str, bool]:
        """What the times are; asked where they go on in most axes, or are named as points in time."""
        column = self.by_role.get("t")
        if column is None or column.lasting or not column.unit:
            return "durations", False
        series = [[_seconds(row[column.place], column, decimal) for row in group.rows] for group in groups]
        going_on = [_goes_on(times) for times in series if len(times) > 1 and None not in times]
        if not going_on and not column.instant:
            return "durations", False
        if self.choices.times in TIMES:
            require_moments(self.body, [column.place], self.choices.times)
            return self.choices.times, True
        if not column.instant and sum(going_on) < MOSTLY * len(going_on):
            return "durations", True
        self._ask(N_("Do the times say how long a phase lasts, or when it is?"))
        return "", True

    # --- Axes ---------------------------------------------------------------------------------------------------------

    def _groups(self) -> list["Group"]:
        """Rows of each axis; one without a name belongs to the axis above."""
        column = self.by_role.get(AXIS)
        if column is None:
            return [Group("", self.body.rows, self.body.numbers)]
        names, continued = list[str](), 0
        for row in self.body.rows:
            name = row[column.place]
            continued += is_blank(name) and bool(names)
            names.append(names[-1] if is_blank(name) and names else name)
        self._ask_unnamed(column)
        if continued:
            template = N_("Rows that name no axis and belong to the one above: {count}.")
            self.notes.append(Sentence(template, {"count": continued}))
        rows = zip(names, self.body.rows, self.body.numbers, strict=True)
        groups = []
        for name, members in groupby(rows, key=lambda row: row[0]):
            found = list(members)
            groups.append(Group(name, tuple(row for _, row, _ in found), tuple(number for _, _, number in found)))
        return groups

    def _ask_unnamed(self, axis: AxisColumn) -> None:
        """Ask for a row without an axis that most likely is none of the axis above it.

        That is one with no axis above it; and one without a number, most likely a sum, where other rows without an axis
        have one, or where rows repeat the name of their axis.
        """
        indices = [column.place for column in self.columns if column.numbers_phases]
        names = [row[axis.place] for row in self.body.rows]
        counted = [any(not is_blank(row[place]) for place in indices) for row in self.body.rows]
        unnamed = [place for place, name in enumerate(names) if is_blank(name)]
        repeated = any(one == other and not is_blank(one) for one, other in pairwise(names))
        if unnamed[:1] == [0]:
            self._ask(N_("Row {row} names no axis, and none stands above it."), row=self.body.numbers[0])
        else:
            strange = repeated or any(counted[place] for place in unnamed)
            totals = {total.number for total in self.body.totals}
            sums = [
                place for place in unnamed if (strange and not counted[place]) or self.body.numbers[place] in totals
            ]
            for place in sums[:1]:
                template = N_(
                    "Row {row} has no axis, which other rows have: leave it out if it is a sum, or write its axis into "
                    "it."
                )
                self._ask(template, row=self.body.numbers[place])

    def _axes(self, groups: Sequence["Group"], decimal: Decimal, times: str) -> Iterator[dict[str, Any]]:
        for group in groups:
            axis: dict[str, Any] = {AXIS: str(group.name)}
            for column in self.columns:
                symbol = column.symbol
                if symbol is None:
                    continue
                cells = [row[column.place] for row in group.rows]
                if column.role in PHASES:
                    values = [_number(cell, column, decimal) for cell in cells]
                    if column.role in REQUIRED or any(value is not None for value in values):
                        axis[symbol.path[0]] = values
                elif (value := self._one(cells, column, decimal)) is not None:
                    axis[_column_name(column)] = value
            yield _lasting(axis, times)

    def _one(self, cells: Sequence[str], column: AxisColumn, decimal: Decimal) -> Any:
        """What the rows of an axis say in common; where that are two things both, as they are written: no input."""
        given = list(dict.fromkeys(cell for cell in cells if not is_blank(cell)))
        if not given:
            return None
        values = [_value(cell, column, decimal) for cell in given]
        if all(value == values[0] for value in values):
            return values[0]
        written = " / ".join(given[:3])
        return [written] if column.symbol and column.symbol.many else written


def _value(cell: str, column: AxisColumn, decimal: Decimal) -> Any:
    if column.symbol and column.symbol.many:
        return _listed(cell, column, decimal)
    return _number(cell, column, decimal) if column.is_number else str(cell)


@dataclass(frozen=True, slots=True)
class Group:
    """The rows of an axis, with their numbers for the user."""

    name: str
    rows: tuple[tuple[str, ...], ...]
    numbers: tuple[int, ...]


def _lasting(axis: dict[str, Any], times: str) -> dict[str, Any]:
    """An axis whose points in time became durations. Of starts the last one ends the cycle, and is no phase."""
    at = axis.get("duration_s", [])
    if times not in ("starts", "ends") or not all(isinstance(time, float) for time in at):
        return axis
    moments = [Fraction(repr(time)) for time in (at if times == "starts" else [0.0, *at])]
    axis["duration_s"] = [float(end - start) for start, end in pairwise(moments)]
    count = len(axis["duration_s"])
    return {name: value[:count] if name in _PHASE_FIELDS else value for name, value in axis.items()}


_PHASE_FIELDS = frozenset(BY_ROLE[role].path[0] for role in PHASES)


def _column_name(column: AxisColumn) -> str:
    assert column.symbol is not None
    path = column.symbol.path
    return path[-1] if path[0] == "duty_cycle" else ".".join(path)


def number_in(cell: str, decimal: Decimal) -> Entry | None:
    """A cell as a number, with whichever unit: not only phases have columns here."""
    if (found := entry(cell, decimal)) or len(cell) > LONGEST_CELL:
        return found
    written, unit = (cell[:-1].rstrip(), "%") if cell.endswith("%") else split_unit(cell)
    if isinstance(cell, Figure):
        return Entry(written, unit)
    number = plain(written, decimal) if unit == "%" or units.codes_for(unit) else None
    return Entry(number, unit) if number else None


def _has_unknown_unit(cell: str) -> bool:
    return bool(unit := unit_behind(cell)) and not units.codes_for(unit)


def _read(cell: str, column: AxisColumn, decimal: Decimal) -> Entry | None:
    """A cell as a number in the unit of its column, or in one of its own that measures the same; None otherwise."""
    found = None if is_blank(cell) else number_in(cell, decimal)
    if found is None or not found.unit:
        return found
    if found.unit == "%":
        return Entry(str(decimals.Decimal(found.number).scaleb(-2)), "") if column.role in SHARES else None
    codes = units.codes_for(found.unit, column.quantity)
    return Entry(found.number, codes[0]) if column.quantity and len(codes) == 1 else None


def _number(cell: str, column: AxisColumn, decimal: Decimal) -> float | str | None:
    """A number in the unit of the wire; the cell as it is written where it is none, None where it is blank."""
    found = _read(cell, column, decimal)
    if found is None:
        return None if is_blank(cell) else str(cell)
    if not column.quantity or column.symbol is None:
        value = float(found.number)
    else:
        value = units.entered(column.symbol.unit, found.unit or column.unit).wire(found.number)
    return value if isfinite(value) else str(cell)


def _listed(cell: str, column: AxisColumn, decimal: Decimal) -> list[float | str]:
    """Several ratios or sizes in a cell. A comma between digits is a decimal mark, and no ratio has one."""
    texts = [text for part in _APART.split(_OF_RATIO.sub("", cell).strip("[]")) if (text := part.strip(","))]
    if column.symbol and column.symbol.kind == "text":
        return [part.strip() for text in texts for part in text.split(",") if part.strip()]
    found = [entry(text, decimal) for text in texts]
    return [text if read is None or read.unit else float(read.number) for text, read in zip(texts, found, strict=True)]


def _seconds(cell: str, column: AxisColumn, decimal: Decimal) -> float | None:
    value = _number(cell, column, decimal)
    return value if isinstance(value, float) else None


def _goes_on(times: Sequence[float | None]) -> bool:
    known = [time for time in times if time is not None]
    return known == sorted(known) and known[-1] > known[0]

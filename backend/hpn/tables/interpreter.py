"""From the columns of a table to numbers, with the questions and notes on the way.

A number never silently becomes another number. A table with one possible reading is read and shown. Where it has two
(`1.234` is 1.234 or 1234; 0.1, 0.2, 0.3 are durations or points in time), the user is asked.
"""

import decimal as decimals
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import chain
from math import inf, isfinite
from typing import Any, NamedTuple

from hpn.tables.bodies import TableBody
from hpn.tables.cells import (
    DECIMALS,
    LONGEST_CELL,
    PERCENT,
    CellNumber,
    Decimal,
    entry,
    is_blank,
    is_number,
    split_unit,
    written,
)
from hpn.tables.columns import MOTOR, SIDES, SKIP, Column
from hpn.tables.headings import heading_over
from hpn.tables.heads import MOST_NAMED, REQUIRED
from hpn.tables.inputs import AXIS
from hpn.tables.numbers import either, known_units
from hpn.tables.questions import Questions
from hpn.tables.sheets import RefusedError
from hpn.tables.table import Choice, PreviewCell, ShownRow, skipped_among
from hpn.tables.times import (
    DAY,
    FIRST,
    MIDNIGHT,
    OF_COUNTER,
    OF_FALLS,
    SORTED,
    falls_now_and_then,
    falls_of,
    go_on,
    in_plain,
    laps_of,
)
from hpn.words import spellings, units
from hpn.words.wording import N_, Sentence, Value, first_of

MISSING = {
    AXIS: N_("Which column names the axis?"),
    "T": N_("Which column is the torque?"),
    "n": N_("Which column is the speed?"),
    "t": N_("Which column is the duration?"),
    "mot": N_("Which column names the motor?"),
}

SHARES = ("u", "eta", "fw")
"""Inputs that may be percentages."""

MOSTLY = 0.75
"""Share of axes with rising times from which on all times count as rising: one bad cell changes nothing for other axes.
"""

Row = tuple[CellNumber | None, ...]


class Series(NamedTuple):
    """Rows whose times belong together, and their numbers."""

    numbers: Sequence[int]
    rows: Sequence[Row]


DECIMAL = Choice("decimal", {".": N_("a point"), ",": N_("a comma")})
SCALES = Choice(
    "scales",
    {"shown": N_("as the workbook shows them"), "held": N_("as the cells hold them")},
)
TIMES = Choice(
    "times",
    {
        "durations": N_("how long each phase lasts"),
        "ends": N_("when each phase ends"),
        "starts": N_("when each phase starts; the last row ends the cycle"),
    },
)
FALLS = Choice("falls", OF_FALLS)
SIDE = Choice("side", SIDES)
STOP = Choice("stop", {"phase": N_("a phase"), "stop": N_("the emergency stop: its torque is T_k")})
OF_SHAFT = ("T", "n", "FRi", "FAi", "Tpk", "npk", "Trms")
"""Roles of values at the output."""


FIRST_ROWS, LAST_ROWS = 6, 2
"""Rows of a long table in its preview."""


class Interpreter:
    """Interpreter of a table, from cells to numbers.

    `rows` are the numbers of the used columns: None for a blank cell, and for a cell that is not a number.
    """

    required: Sequence[str] = REQUIRED
    any_unit = False
    ways_back: Sequence[str] = (SORTED, FIRST)

    def __init__(self, body: TableBody, columns: tuple[Column, ...], questions: Questions) -> None:
        self.body, self.columns, self.questions = body, columns, questions
        self.ask, self.choose = questions.ask, questions.choose
        self.used = [column for column in columns if column.is_number]
        self.notes = list(body.notes)
        self.decimal: Decimal | None = None
        self.rows: list[Row] = []
        self.lap = Fraction(0)

    @property
    def facts(self) -> dict[str, Any]:
        """Fields of every table."""
        return {
            "questions": tuple(self.questions.open),
            "choices": tuple(self.questions.choices),
            "notes": (*self.body.grid.notes, *self.notes),
            "columns": self.columns,
            "rows": len(self.body.rows),
            "headed": self.body.headed,
            "shown": self._shown_rows(),
        }

    def _shown_rows(self) -> tuple[ShownRow, ...]:
        """The first and the last rows, each cell as it is read, with some skipped rows among them."""
        rows = list(zip(self.body.numbers, self.body.rows, strict=True))
        hidden = len(rows) - FIRST_ROWS - LAST_ROWS
        if hidden > 1:
            rows = rows[:FIRST_ROWS] + rows[-LAST_ROWS:]
        preview = [
            ShownRow(number, tuple(self._preview(row[c.place], c) for c in self.columns)) for number, row in rows
        ]
        if hidden > 1:
            preview[FIRST_ROWS] = preview[FIRST_ROWS]._replace(hidden=hidden)
        for note in skipped_among((*self.body.grid.notes, *self.notes)):
            preview.append(ShownRow(int(str(note.values["row"])), skipped=str(note.values["text"])))
        return tuple(sorted(preview, key=lambda row: row.number))

    def _preview(self, cell: str, column: Column) -> PreviewCell:
        text = str(cell[:LONGEST_CELL])
        if not column.is_number or is_blank(cell):
            return PreviewCell(text, kind="text" if column.input else "unread")
        marks = (self.decimal,) if self.decimal else DECIMALS
        numbers = {entry(cell, mark, any_unit=True) for mark in marks} - {None}
        number = numbers.pop() if len(numbers) == 1 else None
        if number is None:
            return PreviewCell(text, kind="asked")
        if column.input and (wire := in_wire(number, column)):
            return PreviewCell(wire, column.input.unit, "number", text)
        return PreviewCell(*number, "number")

    # --- Columns ------------------------------------------------------------------------------------------------------

    def ask_columns(self) -> None:
        """Ask about columns without a role or a unit, and about inputs without a column or with two."""
        of_side = self.ask_side()
        for column in self.columns:
            if not column.role and column not in of_side:
                self.ask(N_("What is column {name}?"), name=column.called)
            elif column.quantity and not column.unit:
                self.questions.open.append(self._unit_question(column))
            elif column.foreign:
                template = N_("Column {name}: {unit} is not supported. Convert it to {wire}, or choose “not read”.")
                wire = units.SYMBOLS.get(column.unit, "1")
                self.ask(template, name=column.called, unit=column.foreign, wire=wire)
        roles = [column.role for column in self.columns]
        for role in self.required:
            if role not in (*roles, *(column.likely for column in of_side)) and self.is_missed(role, roles):
                self.ask(MISSING[role])
        for role in dict.fromkeys(roles):
            if role not in ("", SKIP) and roles.count(role) > 1:
                names = [column.called for column in self.columns if column.role == role]
                self.ask(N_("Columns {one} and {other} are read as the same quantity."), one=names[0], other=names[1])

    def ask_side(self) -> list[Column]:
        """Ask about the shaft of columns named after the motor; the columns that this question leaves open.

        Values at the motor never equal those at the output: the gear's ratio and losses lie between them.
        """
        roles = [column.role for column in self.columns if not column.of_motor]
        named = [column for column in self.columns if column.of_motor and column.role in OF_SHAFT]
        open_ = [column for column in self.columns if column.likely and not column.role and column.likely not in roles]
        skipped = [column for column in self.columns if column.skipped is MOTOR]
        if not (named or open_ or skipped):
            return []
        listed = ", ".join(column.heading[:40] for column in (*named, *open_, *skipped)[:MOST_NAMED])
        template = N_("{names}: named after the motor or the gear’s input. Which shaft are the values of?")
        chosen = self.choose(SIDE, Sentence(template, {"names": listed}))
        if chosen == "motor" and (named or not {"T", "n"}.issubset(roles)):
            raise RefusedError(
                N_("torque and speed are needed at the gear’s output; those of the motor are other values")
            )
        return open_ if not chosen else []

    def is_missed(self, role: str, roles: Collection[str]) -> bool:
        """True where the user is asked about a required role that no column has."""
        return True

    def _unit_question(self, column: Column) -> Sentence:
        """Question about an open unit: which of two, or which of the known units where the written one is unknown."""
        units = heading_over(self.body.headings[column.place]).units
        codes = {spellings.codes_for(unit, column.quantity): unit for unit in sorted(units)}
        readings, spelled = next(iter(codes.items())) if len(codes) == 1 else ((), "")
        if len(readings) > 1:
            template = N_("Which unit is column {name} in? It can be {first} or {second}.")
            return Sentence(template, {"name": column.called, **either(readings, spelled)})
        unknown = next((unit for unit in sorted(units) if not spellings.codes_for(unit, column.quantity)), "")
        if unknown:
            template = N_("Which unit is column {name} in? {unit} is not known; known units: {units}.")
            listed = known_units(column.quantity)
            return Sentence(template, {"name": column.called, "unit": unknown[:20], "units": listed})
        return Sentence(N_("Which unit is column {name} in?"), {"name": column.called})

    # --- Numbers ------------------------------------------------------------------------------------------------------

    def ask_scale(self) -> None:
        """Ask which number counts where a workbook shows a cell's number divided by thousands."""
        scaled = [self.body.scaled[column.place] for column in self.used if column.place in self.body.scaled]
        for text, held in scaled[:1]:
            template = N_("The workbook shows {shown} where the cell holds {held}. Which number counts?")
            numbers = {"shown": text, "held": held}
            self.choose(SCALES, Sentence(template, {**numbers}), numbers=numbers)

    def read_numbers(self) -> None:
        """Read the numbers of the used columns by their decimal mark; ask if both marks are possible."""
        rows_by_mark = {mark: [self._row(row, mark) for row in self.body.rows] for mark in DECIMALS}
        self.require_numbers(rows_by_mark)
        self.decimal = self._mark(rows_by_mark)
        if self.decimal:
            self.rows = rows_by_mark[self.decimal]
        else:
            pairs = zip(*rows_by_mark.values(), strict=True)
            self.rows = [tuple(one or other for one, other in zip(*pair, strict=True)) for pair in pairs]

    def _row(self, row: Sequence[str], mark: Decimal) -> Row:
        cells = (row[column.place] for column in self.used)
        return tuple(None if is_blank(cell) else entry(cell, mark, any_unit=self.any_unit) for cell in cells)

    def require_numbers(self, rows_by_mark: Mapping[Decimal, Sequence[Row]]) -> None:
        """Raise RefusedError where a cell that is not a number spoils the table."""

    def _mark(self, rows_by_mark: Mapping[Decimal, Sequence[Row]]) -> Decimal | None:
        """The mark by which most cells are numbers; ask if both give different numbers, or if both are written."""
        pairs = list(zip(*(chain.from_iterable(rows) for rows in rows_by_mark.values()), strict=True))
        counts = [sum(pair[k] is not None for pair in pairs) for k in (0, 1)]
        alone = [next((k for k, pair in enumerate(pairs) if pair[j] and not pair[1 - j]), None) for j in (0, 1)]
        differing = next((pair for pair in pairs if pair[0] != pair[1] and all(pair)), None)
        if differing is None or (counts[0] != counts[1] and None in alone):
            return DECIMALS[counts[1] > counts[0]]
        question = Sentence(N_("Which is the decimal mark?"))
        if None not in alone:
            one, other = (self._cell(place or 0)[:40] for place in alone)
            template = N_("Both decimal marks are written, as in {one} and {other}: which one counts?")
            question = Sentence(template, {"one": one, "other": other})
        numbers = {mark: cell.number for mark, cell in zip(DECIMALS, differing, strict=True) if cell}
        chosen = self.choose(DECIMAL, question, numbers=numbers)
        return next((mark for mark in DECIMALS if mark == chosen), None)

    def _cell(self, place: int) -> str:
        """Cell of the used columns by its number, row after row."""
        row, column = divmod(place, len(self.used))
        return self.body.rows[row][self.used[column].place]

    def code(self, number: CellNumber, column: Column) -> str:
        """Code of a number's unit; subclasses may raise RefusedError."""
        return code_of(number, column)

    def in_wire(self, number: CellNumber, column: Column) -> str:
        """A number in the unit of the wire, in plain notation; blank if its unit does not fit the column."""
        return in_wire(number, column, self.code)

    def torque_of(self, row: Row) -> str:
        """Torque of a row in the unit of the wire; blank without one."""
        cells = zip(self.used, row, strict=True)
        return next((self.in_wire(cell, column) for column, cell in cells if column.role == "T" and cell), "")

    def ask_stop(self, numbers: Sequence[int]) -> str:
        """Ask about rows named like an emergency stop; blank without such rows, and while the question is open."""
        if not numbers:
            return ""
        listed = ", ".join(f"{number} ({self.body.stops[number][:40]})" for number in numbers[:MOST_NAMED])
        template = N_("Named like an emergency stop: row {rows}. What is it?")
        return self.choose(STOP, Sentence(template, {"rows": listed}))

    # --- Times --------------------------------------------------------------------------------------------------------

    def seconds(self, row: Row) -> Fraction | None:
        """Time of a row in seconds; None if it is blank or its unit is still open."""
        for column, cell in zip(self.used, row, strict=True):
            if column.role == "t" and cell is not None and column.unit and (code := self.code(cell, column)):
                return Fraction(cell.number) / units.entered("s", code).factor
        return None

    def read_times(self, groups: Sequence[Series]) -> str:
        """Meaning of the times, blank while the question is open, which is asked for times that rise or have a heading
        of instants.
        """
        columns = [column for column in self.columns if column.role == "t"]
        instant = any(column.instant for column in columns)
        timed = [(group, times) for group in groups if (times := self._times(group.rows))]
        on_clock = any(":" in row[column.place] for column in columns for row in self.body.rows)
        going_on = [go_on(times, on_clock=on_clock) for _, times in timed]
        if any(column.lasting for column in columns) or not (instant or self.may_go_on(going_on)):
            return "durations"
        few = not instant and sum(going_on) < MOSTLY * len(going_on)
        falling = [each for each in timed if falls_now_and_then(each[1])]
        going_back = [each for each, goes in zip(timed, going_on, strict=True) if goes and each in falling]
        chosen = self.choose(TIMES, self._times_question(going_back), chosen="durations" if few else "")
        dated = not self.body.dated.isdisjoint(column.place for column in columns)
        if dated and chosen == "durations":
            raise RefusedError(N_("dates give the start or end of a phase, not its duration"))
        if dated and chosen == "ends":
            raise RefusedError(N_("end dates don’t give the start of the first phase: give start dates"))
        if falling and chosen in ("starts", "ends"):
            self._ask_falls(falling, dated=dated)
        return chosen

    def _times(self, rows: Sequence[Row]) -> list[Fraction]:
        """Seconds of several rows; empty if one is unknown."""
        times = [self.seconds(row) for row in rows]
        known = [time for time in times if time is not None]
        return known if len(known) == len(times) > 1 else []

    def _times_question(self, falling: Sequence[tuple[Series, Sequence[Fraction]]]) -> Sentence:
        if not falling:
            return Sentence(N_("Are the times durations, starts or ends of the phases?"))
        template = N_(
            "Are the times durations, starts or ends of the phases? In row {row} they fall, from {before} to {after}."
        )
        return Sentence(template, self._fall(*falling[0]))

    def _fall(self, series: Series, times: Sequence[Fraction]) -> dict[str, Value]:
        """The first row with an earlier time than the row above, and both times as written."""
        cells = dict(zip(self.body.numbers, self.body.rows, strict=True))
        place = next(column.place for column in self.columns if column.role == "t")
        before, after = (series.numbers[falls_of(times)[0] - step] for step in (1, 0))
        return {"row": after, "before": cells[before][place][:40], "after": cells[after][place][:40]}

    def _ask_falls(self, falling: Sequence[tuple[Series, Sequence[Fraction]]], *, dated: bool) -> None:
        """Ask why times fall; a clock past midnight or a counter that begins anew adds a lap."""
        rows = [series.numbers[k] for series, times in falling for k in falls_of(times)]
        listed = first_of(rows, MOST_NAMED)
        template = N_("The times go back in row {rows}, first from {before} to {after}. What is it?")
        question = Sentence(template, {**self._fall(*falling[0]), "rows": listed})
        unit_s = self._seconds_of_unit()
        rounds = [] if dated else laps_of([times for _, times in falling], unit_s)
        laps = {MIDNIGHT if lap == DAY else str(lap): lap for lap in rounds}
        options = {code: OF_FALLS.get(code, OF_COUNTER) for code in (*laps, *self.ways_back)}
        numbers = {code: in_plain(lap / unit_s) for code, lap in laps.items() if code != MIDNIGHT}
        chosen = self.choose(replace(FALLS, options=options), question, numbers=numbers)
        self.lap = laps.get(chosen, Fraction(0))
        self.mend(chosen)

    def _seconds_of_unit(self) -> Fraction:
        """Seconds per unit of the times as written."""
        place = next(k for k, column in enumerate(self.used) if column.role == "t")
        pairs = [(self.seconds(row), Fraction(cell.number)) for row in self.rows if (cell := row[place])]
        return next((seconds / number for seconds, number in pairs if seconds and number), Fraction(1))

    def mend(self, fall: str) -> None:
        """Change the rows as the answer about falling times demands."""

    def may_go_on(self, going_on: Sequence[bool]) -> bool:
        """True where the times of axes leave their meaning open."""
        return bool(going_on)


def code_of(number: CellNumber, column: Column) -> str:
    """Code of a number's unit: its own, else its column's; blank if it does not fit the column."""
    if not number.unit:
        return column.unit
    codes = spellings.codes_for(number.unit, column.quantity) if column.quantity else ()
    return codes[0] if len(codes) == 1 else ""


def in_wire(number: CellNumber, column: Column, code_of: Callable[[CellNumber, Column], str] = code_of) -> str:
    """A number in the unit of the wire, in plain notation; blank if its unit does not fit the column."""
    if number.unit == PERCENT:
        return str(decimals.Decimal(number.number).scaleb(-2)) if column.role in SHARES else ""
    if column.input is None or not column.quantity:
        return "" if number.unit else number.number
    if not (code := code_of(number, column)):
        return ""
    measure = units.entered(column.input.unit, code)
    value = inf if measure.same else measure.wire(number.number)
    return written(value) if isfinite(value) else number.number


def unit_behind(cell: str) -> str:
    """Unit behind a number, beginning with a letter; blank for any other cell."""
    number, unit = split_unit(cell) if len(cell) <= LONGEST_CELL else ("", "")
    return unit if unit[:1].isalpha() and is_number(number) else ""

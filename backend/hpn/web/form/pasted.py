"""A duty table pasted from a spreadsheet or read from a file, in whichever way it is written there.

A number is never silently another number: what a table says in one way alone is read so and shown; where it can be
read in two ways (`1.234` is 1.234 or 1234; 0.1, 0.2, 0.3 last so long or are points in time), none is chosen: the
user is asked.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import chain, pairwise
from math import isfinite

from hpn.application import DutyCycle
from hpn.tables.bodies import DIVIDED, Body, Labelled, body_of
from hpn.tables.cells import DECIMALS, Decimal, Entry, entry, is_blank, is_number
from hpn.tables.columns import (
    CELLS,
    NO_CHOICES,
    SKIP,
    WIRE,
    Choices,
    Column,
    columns_of,
    has_two_ways,
)
from hpn.tables.headings import QUANTITIES, heading_over
from hpn.tables.heads import REQUIRED, skipped
from hpn.tables.numbers import either, known_units
from hpn.tables.questions import MISSING, no_number_of, require_moments, scale_question, scaled_in, unit_question
from hpn.tables.sheets import Grid, RefusedError, grids_of
from hpn.tables.totals import totals_of
from hpn.web.form.symbols import columns_used
from hpn.words import units
from hpn.words.fields import MAXIMUM_PHASES
from hpn.words.wording import N_, Sentence, Value

COLUMNS = tuple(QUANTITIES)
"""Columns of the duty table by their link symbols."""

TIMES = {
    "durations": N_("how long each phase lasts"),
    "ends": N_("when each phase ends"),
    "starts": N_("when each phase starts; the last row ends the cycle"),
}
LAST = {"phase": N_("a phase"), "sum": N_("a sum: skip it")}
TOTALS = {"phase": N_("phases"), "sum": N_("sums or other figures of the table: skip them")}
PARTS = {"one": N_("one cycle"), "first": N_("several: take the first alone")}
PHASE = {"row": N_("a row"), "column": N_("a column")}
"""What the times of a table, its last row, rows named like sums, rows apart by a title, and a phase can be."""

MOST_NAMED = 5
"""Rows named like totals that a question names."""

Row = tuple[Entry | None, ...]


@dataclass(frozen=True, slots=True)
class Table:
    """What a table is read as. It can be taken when there is no problem and no question.

    `phases` are plain numbers in units of the wire, in the order of COLUMNS, blank where a phase has no load.
    """

    problem: Sentence | None = None
    questions: tuple[Sentence, ...] = ()
    notes: tuple[Sentence, ...] = ()
    separator: str = ""
    separators: tuple[str, ...] = ()
    turned: bool = False
    phase: str = ""
    asks_phase: bool = False
    decimal: Decimal | None = None
    marks: tuple[tuple[str, str], ...] = ()
    times: str = ""
    asks_times: bool = False
    last: str = ""
    asks_last: bool = False
    totals: str = ""
    asks_totals: bool = False
    named: tuple[Labelled, ...] = ()
    scales: str = ""
    scaled: tuple[str, str] | None = None
    parts: str = ""
    asks_parts: bool = False
    columns: tuple[Column, ...] = ()
    body: Body | None = None
    phases: tuple[tuple[str, ...], ...] = ()

    @property
    def whole(self) -> bool:
        """Whether it can be taken as it is."""
        return bool(self.phases) and not self.questions

    @property
    def unknown(self) -> int:
        """How many columns below a header nothing is known of: they can be skipped at once."""
        return sum(column.is_unknown for column in self.columns) if self.body and self.body.headed else 0


def read_text(text: str, choices: Choices = NO_CHOICES, assumed: Collection[str] = tuple(WIRE.values())) -> Table:
    """What a pasted text is read as; raises nothing, `problem` says why it can't be."""
    try:
        return read_grids(grids_of(text), choices, assumed)
    except RefusedError as refused:
        return Table(refused.sentence)


def read_grids(
    grids: Sequence[Grid], choices: Choices = NO_CHOICES, assumed: Collection[str] = tuple(WIRE.values())
) -> Table:
    """What the cells of a table are read as, out of those by each separator; raises nothing."""
    tables = [read_grid(grid, choices, assumed) for grid in grids]
    divided = next((table for table in tables if table.problem and table.problem.template == DIVIDED), None)
    if divided:
        return divided
    readable = [table for table in tables if table.problem is None]
    distinct = list({_said(table): table for table in reversed(readable)}.values())[::-1]
    if not distinct:
        return tables[0]
    names = tuple(table.separator for table in distinct)
    if len(distinct) == 1:
        return distinct[0]
    chosen = next((table for table in distinct if table.separator == choices.separator), None)
    if chosen:
        return replace(chosen, separators=names)
    question = Sentence(N_("Which mark stands between the columns?"))
    return replace(distinct[0], separators=names, separator="", questions=(question,), phases=())


def _said(table: Table) -> tuple[object, ...]:
    """What tells two readings of one text apart."""
    return table.phases if table.whole or not table.body else table.body.rows


def read_grid(grid: Grid, choices: Choices = NO_CHOICES, assumed: Collection[str] = tuple(WIRE.values())) -> Table:
    """What a table of cells is read as; raises nothing, `problem` says why it can't be."""
    try:
        body = body_of(grid, choices.scales)
        asks = has_two_ways(body)
        if asks and choices.phase == "column":
            body = body_of(grid.transposed(), choices.scales)
        parting = body.parting
        if parting and choices.parts == "first":
            body = body.above(parting[0].number)
        if len(body.rows) > MAXIMUM_PHASES:
            raise RefusedError(N_("there are more than {most} rows"), most=MAXIMUM_PHASES)
        columns = columns_of(body, choices, assumed)
        if asks and choices.phase not in PHASE:
            question = Sentence(N_("Is a phase a row or a column?"))
            return Table(questions=(question,), separator=grid.separator, asks_phase=True, columns=columns, body=body)
        table = _Reading(body, columns, choices).table()
        named = table.named
        if named and choices.totals == "phase":
            body = replace(body.including(named), totals=(), notes=table.notes)
            table = _Reading(body, columns_of(body, choices, assumed), choices).table()
        return replace(
            table,
            phase=choices.phase,
            asks_phase=asks,
            totals=choices.totals,
            asks_totals=bool(named),
            parts=choices.parts,
            asks_parts=bool(parting),
        )
    except RefusedError as refused:
        return Table(refused.sentence, separator=grid.separator)


class _Reading:
    """One table on its way from cells to phases."""

    def __init__(self, body: Body, columns: tuple[Column, ...], choices: Choices) -> None:
        self.body, self.columns, self.choices = body, columns, choices
        self.used = [column for column in columns if column.role in QUANTITIES]
        self.questions: list[Sentence] = []
        self.notes = list(body.notes)

    def table(self) -> Table:
        """The table with what is to be asked, or with its phases; raises RefusedError."""
        self._ask_columns()
        readings = self._readings()
        decimal, marks = self._decimal(readings)
        mark = decimal if decimal else next(iter(readings))
        scaled = scaled_in(self.body, self.used)
        self.questions += scale_question(scaled, self.choices)
        rows = readings[mark]
        self._ask_parts()
        named = self._totals(mark)
        times, asks_times = self._times(rows)
        rows, last, asks_last = self._last(rows, times)
        open_ = bool(self.questions)
        return Table(
            questions=tuple(self.questions),
            notes=(*self.body.grid.notes, *self.notes),
            separator=self.body.grid.separator,
            turned=self.body.grid.turned,
            decimal=decimal,
            marks=marks,
            times=times,
            asks_times=asks_times,
            last=last,
            asks_last=asks_last,
            named=named,
            scales=self.choices.scales,
            scaled=scaled,
            columns=self.columns,
            body=self.body,
            phases=() if open_ else self._phases(rows, times),
        )

    # --- Columns ------------------------------------------------------------------------------------------------------

    def _ask_columns(self) -> None:
        roles = [column.role for column in self.columns]
        for column in self.columns:
            if not column.role:
                self._ask(N_("What is column {name}?"), name=column.called)
            elif column.role != SKIP and not column.unit:
                self.questions.append(unit_question(self.body, column))
        for role in QUANTITIES:
            if role in REQUIRED and role not in roles and "" not in roles:
                self._ask(MISSING[role])
            if roles.count(role) > 1:
                self._ask(TWICE[role])

    def _ask(self, template: str, **values: Value) -> None:
        self.questions.append(Sentence(template, dict(values)))

    # --- Numbers ------------------------------------------------------------------------------------------------------

    def _readings(self) -> dict[Decimal, list[Row]]:
        """Rows of the used columns by each decimal mark that makes numbers of all of them."""
        readings: dict[Decimal, list[Row]] = {}
        for decimal in DECIMALS:
            rows = [tuple(self._entry(row, column, decimal) for column in self.used) for row in self.body.rows]
            wanted = sum(not is_blank(row[column.place]) for row in self.body.rows for column in self.used)
            if sum(cell is not None for row in rows for cell in row) == wanted:
                readings[decimal] = rows
        if not readings:
            raise self._unreadable()
        return readings

    def _entry(self, row: Sequence[str], column: Column, decimal: Decimal) -> Entry | None:
        return None if is_blank(row[column.place]) else entry(row[column.place], decimal)

    def _unreadable(self) -> RefusedError:
        for number, row in zip(self.body.numbers, self.body.rows, strict=True):
            for column in self.used:
                cell = row[column.place]
                if not is_blank(cell) and not any(entry(cell, decimal) for decimal in DECIMALS):
                    return no_number_of(number, cell, column)
        return RefusedError(N_("the rows write their decimals in different ways: use a point or a comma throughout"))

    def _decimal(self, readings: dict[Decimal, list[Row]]) -> tuple[Decimal | None, tuple[tuple[str, str], ...]]:
        """Decimal mark, or None where two would give different numbers; and a number that they differ in, by mark."""
        if len(readings) == 1:
            return next(iter(readings)), ()
        pairs = zip(*(chain.from_iterable(rows) for rows in readings.values()), strict=True)
        differing = next(((a, b) for a, b in pairs if a != b), None)
        if differing is None:
            return DECIMALS[0], ()
        marks = tuple((mark, cell.number) for mark, cell in zip(readings, differing, strict=True) if cell)
        if self.choices.decimal in readings:
            return next(mark for mark in readings if mark == self.choices.decimal), marks
        self._ask(N_("Which is the decimal mark?"))
        return None, marks

    # --- Rows that may be no phases -----------------------------------------------------------------------------------

    def _ask_parts(self) -> None:
        """Ask whether rows below a title belong to the cycle of those above."""
        if (parting := self.body.parting) and self.choices.parts not in PARTS:
            template = N_("Row {row}, “{text}”, stands between the phases. Are they one cycle?")
            self._ask(template, row=parting[0].number, text=parting[0].text[:40])

    def _totals(self, mark: Decimal) -> tuple[Labelled, ...]:
        """Rows that are named like totals without being any, and asked for; those that are totals are skipped."""
        totals, sure = self.body.totals, totals_of(self.body, self.used, mark)
        open_ = tuple(total for total in totals if total not in sure)
        if open_ and self.choices.totals not in TOTALS:
            listed = ", ".join(f"{total.number} ({total.text[:40]})" for total in open_[:MOST_NAMED])
            self._ask(N_("Rows that may be phases, sums or other figures of the table: {rows}."), rows=listed)
        if self.choices.totals == "sum" and {total.number for total in totals}.issuperset(self.body.numbers):
            raise RefusedError(N_("there is a header, but no row of numbers below it"))
        self.notes += [skipped(*each[::2]) for each in (totals if self.choices.totals == "sum" else sure)]
        return open_

    # --- Times and sums -----------------------------------------------------------------------------------------------

    def _seconds(self, row: Row) -> Fraction | None:
        """Time of a row in seconds, None where it is blank or its unit is to be asked."""
        for column, cell in zip(self.used, row, strict=True):
            if column.role == "t" and cell is not None and column.unit:
                return Fraction(cell.number) / units.entered("s", self._code(cell, column)).factor
        return None

    def _times(self, rows: Sequence[Row]) -> tuple[str, bool]:
        """What the times are, and whether that is asked: instants, by their name or as they never go back."""
        seconds = [self._seconds(row) for row in rows]
        known = [each for each in seconds if each is not None]
        lasting = any(column.lasting for column in self.used if column.role == "t")
        rising = len(known) == len(rows) > 1 and known == sorted(known) and known[-1] > known[0]
        instant = any(column.instant for column in self.used if column.role == "t")
        if lasting or not (rising or instant):
            return "durations", False
        if self.choices.times in TIMES:
            require_moments(self.body, (column.place for column in self.used if column.role == "t"), self.choices.times)
            return self.choices.times, True
        self._ask(N_("Do the times say how long a phase lasts, or when it is?"))
        return "", True

    def _last(self, rows: list[Row], times: str) -> tuple[list[Row], str, bool]:
        """Rows of phases; what the last one is, and whether that is asked: it may be the sum of the others."""
        if times == "starts":
            self._require_filled(rows[:-1])
            return rows, "", False
        bare = len(rows) > 1 and self._time_alone(rows[-1])
        sums = times == "durations" and self._sums(rows)
        self._require_filled(rows[:-1] if sums or (bare and not times) else rows)
        if bare and sums:
            self.notes.append(skipped(self.body.numbers[-1], " ".join(filter(None, self.body.rows[-1]))))
            return rows[:-1], "sum", False
        if not sums:
            return rows, "", False
        if len(rows) == 2 and rows[0] != rows[1]:  # two phases that take equally long are no sign of a sum
            self._require_filled(rows)
            return rows, "", False
        if self.choices.last in LAST:
            rows = rows[:-1] if self.choices.last == "sum" else rows
            self._require_filled(rows)
            return rows, self.choices.last, True
        self._ask(N_("The last row takes as long as all others together. What is it?"))
        return rows, "", True

    def _time_alone(self, row: Row) -> bool:
        """Whether the last row has a time and nothing else."""
        given = {column.role for column, cell in zip(self.used, row, strict=True) if cell is not None}
        return given == {"t"} and all(is_blank(cell) or is_number(cell) for cell in self.body.rows[-1])

    def _sums(self, rows: Sequence[Row]) -> bool:
        """Whether the last row takes as long as all others together, to three digits."""
        *before, last = [self._seconds(row) or Fraction(0) for row in rows]
        return bool(before) and last > 0 and abs(last - sum(before)) <= last / 1000

    def _require_filled(self, rows: Sequence[Row]) -> None:
        """Raise RefusedError where torque, speed or duration of a phase is blank."""
        for number, row in zip(self.body.numbers, rows, strict=False):
            for column, cell in zip(self.used, row, strict=True):
                if cell is None and column.role in REQUIRED:
                    raise RefusedError(BLANK[column.role], row=number)

    # --- Phases -------------------------------------------------------------------------------------------------------

    def _code(self, cell: Entry, column: Column) -> str:
        """Code of the unit that a number is in: its own, else its column's. Raises RefusedError where they differ."""
        if not cell.unit:
            return column.unit
        codes = units.codes_for(cell.unit, column.quantity)
        written = f"{cell.number[:30]} {cell.unit[:30]}"
        headed = column.unit != CELLS and bool(heading_over(self.body.headings[column.place]).units)
        if len(codes) > 1 and not headed:
            template = N_("{cell} in column {name} can be {first} or {second}; write one of them")
            raise RefusedError(template, cell=written, name=column.called, **either(codes, cell.unit))
        if len(codes) != 1 or (headed and codes[0] != column.unit):
            template = N_("{cell}: this unit does not belong to column {name}, which takes {units}")
            taken = units.symbol_of_code(column.unit) if headed and column.unit else known_units(column.quantity)
            raise RefusedError(template, cell=written, name=column.called, units=taken)
        return codes[0]

    def _phases(self, rows: Sequence[Row], times: str) -> tuple[tuple[str, ...], ...]:
        """Numbers in units of the wire; points in time become how long each phase lasts."""
        phases = [
            {column.role: self._wire(cell, column) for column, cell in zip(self.used, row, strict=True) if cell}
            for row in rows
        ]
        if times in ("starts", "ends"):
            at = [self._seconds(row) or Fraction(0) for row in rows]
            at = at if times == "starts" else [Fraction(0), *at]
            if len(at) < 2:
                raise RefusedError(N_("the last row ends the cycle, and there is no other"))
            numbers = self.body.numbers[times == "starts" :]
            for number, (before, after) in zip(numbers, pairwise(at), strict=False):
                if after < before:
                    raise RefusedError(N_("row {row}: the time goes back"), row=number)
            lasting = [_text(float(end - start)) for start, end in pairwise(at)]
            phases = [{**phase, "t": t} for phase, t in zip(phases, lasting, strict=False)]
        return tuple(tuple(phase.get(role, "") for role in COLUMNS) for phase in phases)

    def _wire(self, cell: Entry, column: Column) -> str:
        measure = units.entered(WIRE[column.role], self._code(cell, column))
        if measure.same:
            return cell.number
        value = measure.wire(cell.number)
        return _text(value) if isfinite(value) else cell.number


TWICE = {
    "T": N_("Two columns are the torque."),
    "n": N_("Two columns are the speed."),
    "t": N_("Two columns are the duration."),
    "FRi": N_("Two columns are the radial load."),
    "FAi": N_("Two columns are the axial load."),
    "Tpk": N_("Two columns are the peak torque."),
    "npk": N_("Two columns are the peak speed."),
    "Trms": N_("Two columns are the RMS torque."),
}
BLANK = {
    "T": N_("row {row}: the torque is blank"),
    "n": N_("row {row}: the speed is blank"),
    "t": N_("row {row}: the duration is blank"),
}


def _text(value: float) -> str:
    return repr(value).removesuffix(".0")


def write_table(cycle: DutyCycle, decimal: Decimal = ".") -> str:
    """Phases as CSV that `read_text` and a spreadsheet of that language read back exactly; also those of a motion."""
    separator = ";" if decimal == "," else ","
    fields = [symbol.path[0] for symbol in columns_used(cycle.load_phases)]
    lines = [separator.join(fields)]
    for phase in cycle.load_phases:
        values = [getattr(phase, name) for name in fields]
        written = ["" if v is None else repr(v).removesuffix(".0").replace(".", decimal) for v in values]
        lines.append(separator.join(written))
    return "\n".join(lines) + "\n"

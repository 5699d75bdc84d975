"""A table with one duty cycle, in any layout: its columns, its phases, and its other rows."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from math import isclose, nan
from typing import Any, NamedTuple

from hpn.tables.bodies import DIVIDED, Labelled, TableBody, body_of
from hpn.tables.cells import DECIMALS, TIME_PARTED, CellNumber, Decimal, entry, is_blank, is_number
from hpn.tables.columns import CELLS, NO_CHOICES, Choices, Column
from hpn.tables.cycle_columns import columns_of, has_two_ways
from hpn.tables.headings import heading_over, is_pause
from hpn.tables.heads import REQUIRED, left_out, skipped
from hpn.tables.inputs import CYCLE, NAME, PHASE_ROLES
from hpn.tables.interpreter import Interpreter, Row, Series, unit_behind
from hpn.tables.numbers import either, known_units
from hpn.tables.questions import Questions
from hpn.tables.sheets import SEPARATORS, Grid, RefusedError, grids_of, no_number
from hpn.tables.table import Choice, Table
from hpn.tables.times import FIRST, SORTED, durations_of, falls_of, in_plain, unrolled
from hpn.words import spellings, units
from hpn.words.fields import MAXIMUM_PHASES
from hpn.words.wording import N_, Quantity, Sentence, Value

SEPARATOR = Choice("separator", SEPARATORS)
PHASE = Choice("phase", {"row": N_("a row"), "column": N_("a column")})
PARTS = Choice("parts", {"one": N_("one cycle"), "first": N_("several: use the first one")})
TOTALS = Choice("totals", {"phase": N_("phases"), "sum": N_("sums or other figures of the table: skip them")})
LAST = Choice("last", {"phase": N_("a phase"), "sum": N_("a sum: skip it")})

BLANK = {
    "T": N_("row {row}: the torque is blank"),
    "n": N_("row {row}: the speed is blank"),
    "t": N_("row {row}: the duration is blank"),
}

MOST_NAMED = 5
"""Rows named like totals that a question lists."""

MOST_TOTALS = 20
"""Rows named like totals, at most, that are compared with the others; if there are more, none counts as a total."""

THREE_DIGITS = 0.005
"""Relative error of a number rounded to three digits."""


class _CycleTable(NamedTuple):
    """Reading of the cells by one separator, and its rows."""

    table: Table
    rows: tuple[tuple[str, ...], ...] = ()

    @property
    def difference(self) -> tuple[object, ...]:
        """The phases, or else the rows, by which two readings of one text are told apart."""
        return (*self.table.phases, self.table.names) if self.table.whole or not self.rows else self.rows


def read_text(text: str, choices: Choices = NO_CHOICES, assumed: Collection[str] = tuple(CYCLE.units)) -> Table:
    """Reading of a pasted text; raises nothing, `problem` tells why it can't be read."""
    try:
        return read_grids(grids_of(text), choices, assumed)
    except RefusedError as refused:
        return Table(problem=refused.sentence)


def read_grids(
    grids: Sequence[Grid], choices: Choices = NO_CHOICES, assumed: Collection[str] = tuple(CYCLE.units)
) -> Table:
    """Reading of a table from its cells by each separator; raises nothing."""
    readings = [_read_grid(grid, choices, assumed) for grid in grids]
    divided = next((table for table, _ in readings if table.problem and table.problem.template == DIVIDED), None)
    if divided:
        return divided
    readable = [each for each in readings if each.table.problem is None]
    distinct = list({each.difference: each.table for each in reversed(readable)}.values())[::-1]
    if not distinct:
        return readings[0].table
    if len(distinct) == 1:
        return distinct[0]
    names = {table.separator: SEPARATORS[table.separator] for table in distinct}
    questions = Questions(choices)
    question = Sentence(N_("Which character separates the columns?"))
    chosen = questions.choose(replace(SEPARATOR, options=names), question)
    for table in distinct:
        if table.separator == chosen:
            return replace(table, choices=(*questions.choices, *table.choices))
    return replace(
        distinct[0],
        choices=(*questions.choices, *distinct[0].choices),
        separator="",
        questions=(question,),
        phases=(),
        names=(),
    )


def _read_grid(grid: Grid, choices: Choices, assumed: Collection[str]) -> _CycleTable:
    questions = Questions(choices)
    try:
        body = body_of(grid, choices.scales)
        if has_two_ways(body):
            way = questions.choose(PHASE, Sentence(N_("Is a phase a row or a column?")))
            body = body_of(grid.transposed(), choices.scales) if way == "column" else body
            if not way:
                facts = _CycleInterpreter(body, columns_of(body, choices, assumed), questions).facts
                return _CycleTable(Table(**facts, separator=grid.separator), body.rows)
        body = _one_cycle(body, questions)
        if len(body.rows) > MAXIMUM_PHASES:
            raise RefusedError(N_("there are more than {most} rows"), most=MAXIMUM_PHASES)
        columns = columns_of(body, choices, assumed)
        if body.totals:
            body = _without_totals(body, columns, questions)
            columns = columns_of(body, choices, assumed)
        return _CycleTable(_CycleInterpreter(body, columns, questions).table(), body.rows)
    except RefusedError as refused:
        return _CycleTable(Table(problem=refused.sentence, separator=grid.separator))


def _one_cycle(body: TableBody, questions: Questions) -> TableBody:
    """A table down to the end of its first cycle: rows below a title may belong to another."""
    for title in body.parting[:1]:
        template = N_("Row {row}, “{text}”, stands between the phases. Are they one cycle?")
        question = Sentence(template, {"row": title.number, "text": title.text[:40]})
        if questions.choose(PARTS, question) == "first":
            return body.above(title.number)
    return body


def _without_totals(body: TableBody, columns: tuple[Column, ...], questions: Questions) -> TableBody:
    """A table without its totals; the user is asked about rows that only have the name of a total."""
    reading = _CycleInterpreter(body, columns, Questions(questions.answers))
    reading.read_numbers()
    sure = _totals_of(body, reading.used, reading.decimal or DECIMALS[0])
    open_ = [total for total in body.totals if total not in sure]
    chosen = ""
    if open_:
        listed = ", ".join(f"{total.number} ({total.text[:40]})" for total in open_[:MOST_NAMED])
        template = N_("Rows that may be phases, sums or other figures of the table: {rows}.")
        chosen = questions.choose(TOTALS, Sentence(template, {"rows": listed}))
    if chosen == "sum" and {total.number for total in body.totals}.issuperset(body.numbers):
        raise RefusedError(N_("there is a header, but no row of numbers below it"))
    left_out = body.totals if chosen == "sum" else sure
    notes = (*body.notes, *(skipped(*total[::2]) for total in left_out))
    return replace(body.including(open_ if chosen == "phase" else ()), totals=(), notes=notes)


# --- Rows -------------------------------------------------------------------------------------------------------------


class _CycleInterpreter(Interpreter):
    """Interpreter of a table with one cycle: a cell that is not a number spoils it."""

    def table(self) -> Table:
        """The table with its open questions, or with its phases; raises RefusedError."""
        self.ask_columns()
        self.read_numbers()
        self._stand_still()
        self.ask_scale()
        stop = self._take_stops()
        times = self.read_times([Series(self.body.numbers, self.rows)])
        rows = self._phase_rows(times)
        phases = () if self.questions.open else self._lasting(self._phases(rows, times))
        names = next((column.place for column in self.columns if column.role == NAME.role), None)
        texts = () if names is None else tuple(row[names].strip() for row in self.body.rows[: len(phases)])
        grid = self.body.grid
        facts: dict[str, Any] = {**self.facts, "separator": grid.separator, "turned": grid.turned}
        return Table(**facts, phases=phases, names=texts, stop_Nm=stop)

    def _stand_still(self) -> None:
        """Fill in zero torque and speed for a pause with only a time."""
        for k, (cells, row) in enumerate(zip(self.body.rows, self.rows, strict=True)):
            roles = {column.role for column, cell in zip(self.used, row, strict=True) if cell is not None}
            if roles == {"t"} and any(map(is_pause, cells)):
                self.rows[k] = tuple(
                    CellNumber("0", column.input.unit if column.input and column.unit == CELLS else "")
                    if column.role in ("T", "n")
                    else cell
                    for column, cell in zip(self.used, row, strict=True)
                )

    def _take_stops(self) -> str:
        """T_k from the rows of the emergency stop, the largest by magnitude; these rows are no phases."""
        stops = [k for k, number in enumerate(self.body.numbers) if number in self.body.stops]
        chosen = self.ask_stop([self.body.numbers[k] for k in stops])
        if not stops or chosen == "phase":
            return ""
        is_read = chosen and any(column.role == "T" for column in self.used)
        torques = [self.torque_of(self.rows[k]) for k in stops] if is_read else []
        for number, torque in zip((self.body.numbers[k] for k in stops), torques, strict=False):
            if not torque:
                raise RefusedError(BLANK["T"], row=number)
            values: dict[str, Value] = {"row": number, "torque": Quantity(float(torque), "Nm")}
            self.notes.append(Sentence(N_("Row {row} is the emergency stop: {torque}."), values))
        phases = sorted({*range(len(self.rows))}.difference(stops))
        if chosen and not phases:
            raise RefusedError(N_("there is no phase beside the emergency stop"))
        self._keep(phases or stops)
        return max(torques, key=lambda torque: abs(float(torque)), default="")

    def is_missed(self, role: str, roles: Collection[str]) -> bool:
        """True unless a column without a role may hold it."""
        return "" not in roles

    def may_go_on(self, going_on: Sequence[bool]) -> bool:
        """True where the times of the cycle go on."""
        return any(going_on)

    def mend(self, fall: str) -> None:
        """Sort the rows by time, or end them where the times first fall."""
        times = [self.seconds(row) or Fraction(0) for row in self.rows]
        places = range(len(times))
        if fall == SORTED:
            self._keep(sorted(places, key=times.__getitem__))
            self.notes.append(Sentence(N_("The rows are sorted by time.")))
        elif fall == FIRST:
            end = falls_of(times)[0]
            values: dict[str, Value] = {"first": self.body.numbers[end], "last": self.body.numbers[-1]}
            self.notes.append(Sentence(N_("Rows {first} to {last} are left out: they are of another run."), values))
            self._keep(places[:end])

    def _keep(self, places: Sequence[int]) -> None:
        """Keep some of the rows, in this order."""
        self.rows = [self.rows[k] for k in places]
        self.body = self.body.of(places)

    def require_numbers(self, rows_by_mark: Mapping[Decimal, Sequence[Row]]) -> None:
        """Raise RefusedError unless all used cells are numbers by one decimal mark."""
        count = sum(not is_blank(row[column.place]) for row in self.body.rows for column in self.used)
        if any(sum(cell is not None for row in rows for cell in row) == count for rows in rows_by_mark.values()):
            return
        for number, row in zip(self.body.numbers, self.body.rows, strict=True):
            for column in self.used:
                cell = row[column.place]
                if not is_blank(cell) and not is_number(cell):
                    raise _no_number_of(number, cell, column)
        raise RefusedError(N_("the rows use different decimal marks: use a point or a comma throughout"))

    def code(self, number: CellNumber, column: Column) -> str:
        """Code of a number's unit; raises RefusedError where the column has another unit, or the unit is ambiguous."""
        code = super().code(number, column)
        if not number.unit:
            return code
        codes = spellings.codes_for(number.unit, column.quantity)
        cell = f"{number.number[:30]} {number.unit[:30]}"
        headed = column.unit != CELLS and bool(heading_over(self.body.headings[column.place]).units)
        if len(codes) > 1 and not headed:
            template = N_("{cell} in column {name} can be {first} or {second}; write one of them")
            raise RefusedError(template, cell=cell, name=column.called, **either(codes, number.unit))
        if not code or (headed and code != column.unit):
            template = N_("{cell}: this unit does not fit column {name}; possible: {units}")
            possible = units.symbol_of_code(column.unit) if headed and column.unit else known_units(column.quantity)
            raise RefusedError(template, cell=cell, name=column.called, units=possible)
        return code

    def _phase_rows(self, times: str) -> list[Row]:
        """Rows of phases, each filled; the last row may be the sum of the others, or end the cycle."""
        rows = self.rows
        bare = len(rows) > 1 and self._time_alone(rows[-1])
        sums = times == "durations" and self._sums()
        is_open = times == "starts" or (bare and not times)
        if bare and sums:
            self.notes.append(skipped(self.body.numbers[-1], " ".join(filter(None, self.body.rows[-1]))))
            rows = rows[:-1]
        elif sums and not (len(rows) == 2 and rows[0] != rows[1]):  # two equal durations are no sign of a sum
            question = Sentence(N_("The last row takes as long as all others together. What is it?"))
            chosen = self.choose(LAST, question)
            rows, is_open = rows[:-1] if chosen == "sum" else rows, not chosen
        self._require_filled(rows[:-1] if is_open else rows)
        return rows

    def _time_alone(self, row: Row) -> bool:
        """True where a row has only a time."""
        roles = {column.role for column, cell in zip(self.used, row, strict=True) if cell is not None}
        return roles == {"t"} and all(is_blank(cell) or is_number(cell) for cell in self.body.rows[-1])

    def _sums(self) -> bool:
        """True where the last row takes as long as all others together, to three digits."""
        *before, last = [self.seconds(row) or Fraction(0) for row in self.rows]
        return bool(before) and last > 0 and abs(last - sum(before)) <= last / 1000

    def _require_filled(self, rows: Sequence[Row]) -> None:
        """Raise RefusedError where torque, speed or duration of a phase is blank."""
        for number, row in zip(self.body.numbers, rows, strict=False):
            for column, cell in zip(self.used, row, strict=True):
                if cell is None and column.role in REQUIRED:
                    raise RefusedError(BLANK[column.role], row=number)

    def _phases(self, rows: Sequence[Row], times: str) -> tuple[tuple[str, ...], ...]:
        """Numbers in units of the wire; points in time become how long each phase lasts."""
        phases = [
            {column.role: self.in_wire(cell, column) for column, cell in zip(self.used, row, strict=True) if cell}
            for row in rows
        ]
        if times in ("starts", "ends"):
            moments = unrolled([self.seconds(row) or Fraction(0) for row in rows], self.lap)
            durations = durations_of(moments, times)
            if not durations:
                raise RefusedError(N_("the last row ends the cycle, and there is no other"))
            for number, duration in zip(self.body.numbers[times == "starts" :], durations, strict=False):
                if duration < 0:
                    raise RefusedError(N_("row {row}: the time goes back"), row=number)
            phases = [{**phase, "t": in_plain(t)} for phase, t in zip(phases, durations, strict=False)]
        return tuple(tuple(phase.get(role, "") for role in PHASE_ROLES) for phase in phases)

    def _lasting(self, phases: Sequence[tuple[str, ...]]) -> tuple[tuple[str, ...], ...]:
        """Phases without those of 0 s, as from two rows with one time stamp, which are left out with a note."""
        lasting = [float(phase[PHASE_ROLES.index("t")]) for phase in phases]
        standing = [k for k, seconds in enumerate(lasting) if seconds == 0]
        if len(standing) == len(phases):
            raise RefusedError(N_("no row lasts longer than 0 s"))
        if standing:
            self.notes.append(left_out([self.body.numbers[k] for k in standing]))
            self._keep([k for k in range(len(self.rows)) if k not in set(standing)])
        return tuple(phase for phase, seconds in zip(phases, lasting, strict=True) if seconds != 0)


def _no_number_of(row: int, cell: str, column: Column) -> RefusedError:
    """Error for a cell that is not a number of its column, with the accepted forms of a time, or the known units."""
    if column.role == "t" and TIME_PARTED.fullmatch(cell):
        template = N_("row {row}: {cell} may be hours or minutes; write {first} or {second}")
        return RefusedError(template, row=row, cell=cell, first=f"{cell}:00", second=f"0:{cell:0>5}")
    if unit_behind(cell):
        template = N_("row {row}: {cell} is not a number with a unit that is known here: {units}")
        return RefusedError(template, row=row, cell=cell[:40], units=known_units(column.quantity))
    return no_number(row, cell)


# --- Totals -----------------------------------------------------------------------------------------------------------


def _totals_of(body: TableBody, used: Sequence[Column], mark: Decimal) -> list[Labelled]:
    """Rows that are totals of the others in the used columns, read with a decimal mark."""
    named = {total.number for total in body.totals}
    phases = [row for number, row in zip(body.numbers, body.rows, strict=True) if number not in named]
    totals = []
    for total in body.totals if phases and len(body.totals) <= MOST_TOTALS else ():
        others = [other.cells for other in body.totals if other is not total]
        if any(_sums_up(total, rows, used, mark) for rows in (phases, [*phases, *others])):
            totals.append(total)
    return totals


def _sums_up(total: Labelled, rows: Sequence[Sequence[str]], used: Sequence[Column], mark: Decimal) -> bool:
    """True where all numbers of a row are the sums, the means, the largest or the smallest of other rows.

    A number that can't be read with this decimal mark is read with the other: a formula without a format appears as
    3.75 below 0,25.
    """
    columns = []
    for column in used:
        cells = [row[column.place] for row in (total.cells, *rows) if not is_blank(row[column.place])]
        if cells and cells[0] is total.cells[column.place] and cells[0] != total.text:
            columns.append([_entry(cells[0], mark), *(entry(cell, mark) for cell in cells[1:])])
    numbers = [[float(cell.number) if cell else nan for cell in column] for column in columns]
    of_one_unit = all(len({cell and cell.unit for cell in column}) == 1 for column in columns)
    figures = (sum, _mean, max, min)
    return (
        len(rows) > 1
        and of_one_unit
        and any(
            all(isclose(first, figure(others or [nan]), rel_tol=THREE_DIGITS) for first, *others in numbers)
            for figure in figures
        )
    )


def _entry(cell: str, mark: Decimal) -> CellNumber | None:
    return next(filter(None, (entry(cell, each) for each in (mark, *DECIMALS))), None)


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)

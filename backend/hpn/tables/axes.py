"""An uploaded table of axes, in any layout: a row is a phase, and the rows of an axis stand together.

A cell that is not a number spoils only its axis, which is rejected with the reason.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby, pairwise, product
from math import isfinite
from typing import Any

from hpn.tables.bodies import TableBody, body_of
from hpn.tables.by_size import numbers_by_size
from hpn.tables.cells import DECIMALS, LONGEST_CELL, CellNumber, Decimal, Merged, entry, is_blank, is_number
from hpn.tables.columns import NO_CHOICES, Choices, Column, proposed, settled
from hpn.tables.headings import is_of_phase, is_stop
from hpn.tables.heads import REQUIRED, left_out, skipped
from hpn.tables.inputs import AXIS, NAME, PHASE, PHASE_ROLES, Inputs
from hpn.tables.interpreter import Interpreter, Row, Series, unit_behind
from hpn.tables.numbers import known_units
from hpn.tables.questions import Questions
from hpn.tables.sheets import Grid, RefusedError
from hpn.tables.table import Choice, Table
from hpn.tables.times import ERROR, durations_of, in_plain, unrolled
from hpn.words import spellings
from hpn.words.patterns import Pattern
from hpn.words.titles import LONGEST_NAME, is_title
from hpn.words.wording import N_, Sentence, Value

_BETWEEN = Pattern(r"[;/|\s]+", LONGEST_CELL)
_OF_RATIO = Pattern(r"\bi\s*=\s*|:\s*1(?![0-9.,])", LONGEST_CELL)
"""Signs beside the number of a ratio: `i = 5`, `5:1`."""

LOADS = Choice("loads", {"axis": N_("in all phases of the axis"), "phase": N_("in its own phase alone")})
_OF_AXIS = {"FRi": ("FR", "output_load.radial_N"), "FAi": ("FA", "output_load.axial_N")}
"""Loads of a phase -> role and place of the same load for a whole axis."""


def read_axes(grid: Grid, inputs: Inputs, choices: Choices = NO_CHOICES, assumed: Collection[str] = ()) -> Table:
    """Reading of a table of axes; raises nothing, `problem` tells why it can't be read."""

    def columns_of(body: TableBody) -> tuple[Column, ...]:
        return settled(_with_names(proposed(body, inputs), body), body, inputs, choices, assumed)

    try:
        body = body_of(grid, choices.scales)
        body = _with_axes(body, columns_of(body))
        columns = columns_of(body)
        return _AxesInterpreter(_unmerged(body, columns), columns, Questions(choices)).table()
    except RefusedError as refused:
        return Table(problem=refused.sentence)


def _with_names(columns: list[Column], body: TableBody) -> list[Column]:
    """Columns, one of them marked as names of the phases: headed `name` beside that of the axis, or texts below
    `Phase`.
    """
    names = [column for column in columns if column.role == AXIS]
    own = [column for column in names if column.heading.casefold() == NAME.place] if len(names) == 2 else []
    if not own and not any(column.role == NAME.role for column in columns):
        own = [column for column in columns if is_of_phase(column.heading) and _has_names(body, column.place)]
    if len(own) != 1:
        return columns
    return [replace(column, role=NAME.role, skipped=None) if column in own else column for column in columns]


def _has_names(body: TableBody, place: int) -> bool:
    """True for a column of texts that may name phases."""
    cells = [row[place] for row in body.rows if not is_blank(row[place])]
    return not all(map(is_number, cells)) and all(is_title(cell, LONGEST_NAME) for cell in cells)


def _unmerged(body: TableBody, columns: Sequence[Column]) -> TableBody:
    """A table with the name of an axis, and each merged input, in the first row of the axis only."""
    axis = next((column.place for column in columns if column.role == AXIS), None)
    once = {column.place for column in columns if column.role not in (*PHASE_ROLES, NAME.role)}
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


def _with_axes(body: TableBody, columns: Sequence[Column]) -> TableBody:
    """A table including those totals and titles that name an axis or have numbers of a phase."""
    places = {column.role: column.place for column in columns}
    named = [row for row in (*body.totals, *body.titles) if AXIS in places and not is_blank(row.cells[places[AXIS]])]
    moving = [places[role] for role in ("T", "n") if role in places]
    numbered = [row for row in body.totals if any(is_number(row.cells[place]) for place in moving)]
    numbers = {row.number for row in (*named, *numbered)}
    notes = tuple(note for note in body.notes if note.values.get("row") not in numbers)
    other_totals = [row for row in body.totals if row.number not in numbers and row.number not in body.numbers]
    return replace(body.including([*named, *numbered]), notes=(*notes, *(skipped(*row[::2]) for row in other_totals)))


_Place = tuple[int, str]
"""Number of a row, and a cell of it."""


@dataclass(frozen=True, slots=True)
class _Group:
    """Rows of an axis: their cells, and the numbers in the used columns."""

    name: str
    cells: tuple[tuple[str, ...], ...]
    rows: tuple[Row, ...]
    numbers: tuple[int, ...]


class _AxesInterpreter(Interpreter):
    """Interpreter of a table of axes."""

    required = (AXIS, *REQUIRED)
    any_unit = True
    ways_back = (ERROR,)

    def __init__(self, body: TableBody, columns: tuple[Column, ...], questions: Questions) -> None:
        super().__init__(body, columns, questions)
        self.standing: list[int] = []
        self.stops: dict[str, str] = {}

    def table(self) -> Table:
        """The table with its open questions, or with its axes."""
        self.ask_columns()
        self.read_numbers()
        self._note_unread()
        groups = self._without_stops(self._groups())
        times = self.read_times([Series(group.numbers, group.rows) for group in groups])
        self.ask_scale()
        loads = self._read_loads(groups)
        axes = () if self.questions.open else tuple(self._axis(group, times, loads) for group in groups)
        lasting = [self._without_standing(axis, group) for axis, group in zip(axes, groups, strict=False)]
        origins = {str(group.name): group.numbers for group in groups}
        origins |= {str(axis[AXIS]): numbers for axis, numbers in lasting}
        if self.standing:
            self.notes.append(left_out(self.standing))
        return Table(**self.facts, axes=tuple(axis for axis, _ in lasting), origins=origins)

    def _note_unread(self) -> None:
        """Note cells that are rejected with their axes: no numbers, unknown units, and units that don't fit their
        column.
        """
        wrong, unknown, strange = list[_Place](), list[_Place](), list[_Place]()
        known = ""
        for number, cells, row in zip(self.body.numbers, self.body.rows, self.rows, strict=True):
            for column, part in zip(self.used, row, strict=True):
                cell = cells[column.place]
                if part is not None:
                    strange += [(number, cell)] if part.unit and not self.in_wire(part, column) else []
                elif column.quantity and (unit := unit_behind(cell)) and not spellings.codes_for(unit):
                    unknown.append((number, cell))
                    known = known or known_units(column.quantity)
                elif not is_blank(cell) and self._by_size(cell, column) is None:
                    wrong.append((number, cell))
        self._note(N_("Cells that are not numbers, such as {cell} in row {row}: {count}. Their axes stay open."), wrong)
        template = N_(
            "Cells with a unit that does not fit their column, such as {cell} in row {row}: {count}. Their axes stay "
            "open."
        )
        self._note(template, strange)
        template = N_(
            "Cells with an unknown unit, such as {cell} in row {row}: {count}. Known units: {units}. Their axes stay "
            "open."
        )
        self._note(template, unknown, units=known)

    def _note(self, template: str, places: Sequence[_Place], **values: str) -> None:
        for row, cell in places[:1]:
            named: dict[str, Value] = {"count": len(places), "row": row, "cell": cell[:40], **values}
            self.notes.append(Sentence(template, named))

    # --- Rows of an axis ----------------------------------------------------------------------------------------------

    def _groups(self) -> list[_Group]:
        """Rows of each axis; a row without a name belongs to the axis above."""
        axis = next((column for column in reversed(self.columns) if column.role == AXIS), None)
        rows = list(zip(self.body.rows, self.rows, self.body.numbers, strict=True))
        if axis is None:
            return [_Group("", self.body.rows, tuple(self.rows), self.body.numbers)]
        names, continued = list[str](), 0
        for cells, *_ in rows:
            goes_on = is_blank(cells[axis.place]) and bool(names)
            continued += goes_on
            names.append(names[-1] if goes_on else cells[axis.place])
        self._ask_unnamed(axis)
        if continued:
            template = N_("Rows that name no axis and belong to the one above: {count}.")
            self.notes.append(Sentence(template, {"count": continued}))
        groups = []
        for name, members in groupby(zip(names, rows, strict=True), key=lambda row: row[0]):
            groups.append(_Group(name, *zip(*(row for _, row in members), strict=True)))
        return groups

    def _ask_unnamed(self, axis: Column) -> None:
        """Ask about a row without an axis that most likely doesn't belong to the axis above it.

        That is a first row; or a row named like a total; or a row without a number that is most likely a sum, because
        other rows without an axis have a number, or because rows repeat the name of their axis.
        """
        indices = [column.place for column in self.columns if column.numbers_phases]
        names = [row[axis.place] for row in self.body.rows]
        counted = [any(not is_blank(row[place]) for place in indices) for row in self.body.rows]
        unnamed = [place for place, name in enumerate(names) if is_blank(name)]
        repeated = any(one == other and not is_blank(one) for one, other in pairwise(names))
        if unnamed[:1] == [0]:
            self.ask(N_("Row {row} names no axis, and none stands above it."), row=self.body.numbers[0])
            return
        strange = repeated or any(counted[place] for place in unnamed)
        totals = {total.number for total in self.body.totals}
        sums = [place for place in unnamed if (strange and not counted[place]) or self.body.numbers[place] in totals]
        for place in sums[:1]:
            template = N_(
                "Row {row} has no axis, while other rows have one: leave it out if it is a sum, or enter its axis."
            )
            self.ask(template, row=self.body.numbers[place])

    def _read_loads(self, groups: Sequence[_Group]) -> str:
        """Phases of a load that stands in the first row of an axis only, as its pause does; blank while the question is
        open.

        Where other axes have loads in several rows, it counts for its own phase unless an answer says otherwise.
        """
        roles = {column.role for column in self.columns}
        columns = [
            column for column in self.columns if column.role in _OF_AXIS and _OF_AXIS[column.role][0] not in roles
        ]
        series = [(column, [row[column.place] for row in group.cells]) for group, column in product(groups, columns)]
        first = [column for column, cells in series if _stands_first(cells)]
        if not first:
            return "phase"
        several = any(not is_blank(cell) for _, cells in series for cell in cells[1:])
        template = N_("Column {name} has a number in the first row of an axis alone: where does the load act?")
        question = Sentence(template, {"name": first[0].called})
        return self.choose(LOADS, question, chosen="phase" if several else "")

    def _without_stops(self, groups: list[_Group]) -> list[_Group]:
        """Axes without the rows of their emergency stop; the largest torque of these rows is T_k."""
        axis = {column.place for column in self.columns if column.role == AXIS}
        cells = dict(zip(self.body.numbers, self.body.rows, strict=True))
        named = [
            number
            for number in self.body.stops
            if any(is_stop(cell) for place, cell in enumerate(cells[number]) if place not in axis)
        ]
        if not named or self.ask_stop(named) == "phase":
            return groups
        kept_groups = []
        for group in groups:
            rows = list(zip(group.cells, group.rows, group.numbers, strict=True))
            torques = [torque for _, row, number in rows if number in named and (torque := self.torque_of(row))]
            if torques:
                self.stops[group.name] = max(torques, key=lambda torque: abs(float(torque)))
            if others := [row for row in rows if row[2] not in named]:
                kept_groups.append(_Group(group.name, *zip(*others, strict=True)))
        return kept_groups

    # --- Values of an axis --------------------------------------------------------------------------------------------

    def _axis(self, group: _Group, times: str, loads: str) -> dict[str, Any]:
        values: dict[str, Any] = {AXIS: str(group.name)}
        if stop := self.stops.get(group.name):
            values[_STOP] = float(stop)
        numbers = dict(zip((column.place for column in self.used), zip(*group.rows, strict=True), strict=True))
        for column in self.columns:
            if column.input is None or column.role == AXIS:
                continue
            cells = [row[column.place] for row in group.cells]
            values_read = numbers.get(column.place, (None,) * len(cells))
            if column.role == NAME.role:
                values[NAME.place] = [None if is_blank(cell) else str(cell) for cell in cells]
            elif column.role in PHASE_ROLES:
                listed = [self._number(*each, column) for each in zip(cells, values_read, strict=True)]
                if loads == "axis" and column.role in _OF_AXIS and _stands_first(cells):
                    values[_OF_AXIS[column.role][1]] = listed[0]
                elif column.role in REQUIRED or any(value is not None for value in listed):
                    values[column.input.place] = listed
            elif (value := self._one(dict(zip(cells, values_read, strict=True)), column)) is not None:
                values[column.input.place] = value
        return self._lasting(values, group, times)

    def _number(self, cell: str, number: CellNumber | None, column: Column) -> float | str | None:
        """A number in the unit of the wire; None for a blank cell, and the cell as written for any other."""
        value = self._value(number, column)
        return value if value is not None or is_blank(cell) else str(cell)

    def _value(self, entry: CellNumber | None, column: Column) -> float | None:
        number = self.in_wire(entry, column) if entry else ""
        return value if number and isfinite(value := float(number)) else None

    def _by_size(self, cell: str, column: Column) -> dict[str, float] | None:
        """Numbers by size of a cell in the unit of the wire; None if it has none, or if its column takes none."""
        if column.input is None or column.input.kind != "by_size":
            return None
        marks: Sequence[Decimal] = DECIMALS if not cell.lstrip().startswith("{") else (".",)
        readings = [reading for mark in marks if (reading := numbers_by_size(cell, partial(self._float, column, mark)))]
        return readings[0] if readings and readings[0] == readings[-1] else None  # a decimal mark is never guessed

    def _float(self, column: Column, decimal: Decimal, number: str) -> float | None:
        return self._value(entry(number, decimal, any_unit=True), column)

    def _one(self, numbers: dict[str, CellNumber | None], column: Column) -> Any:
        """Common value of the rows of an axis; if they differ, their cells as written, which is no valid input."""
        cells = [cell for cell in numbers if not is_blank(cell)]
        if not cells or column.input is None:
            return None
        many = column.input.many
        if many:
            values: list[Any] = [_values_of(cell, column.input.kind == "text", self.decimal or ".") for cell in cells]
        else:
            values = [self._by_size(cell, column) or self._number(cell, numbers[cell], column) for cell in cells]
        if all(value == values[0] for value in values):
            return values[0]
        written = " / ".join(cells[:3])
        return [written] if many else written

    def _lasting(self, values: dict[str, Any], group: _Group, times: str) -> dict[str, Any]:
        """An axis with durations instead of points in time. The last of the starts ends the cycle, and is no phase."""
        moments = [moment for row in group.rows if (moment := self.seconds(row)) is not None]
        if times not in ("starts", "ends") or len(moments) < len(group.rows):
            return values
        texts = [in_plain(duration) for duration in durations_of(unrolled(moments, self.lap), times)]
        durations = [float(text) if isfinite(float(text)) else text for text in texts]
        values |= {_DURATION: durations}
        return {name: value[: len(durations)] if name in _OF_PHASE else value for name, value in values.items()}

    def _without_standing(self, axis: dict[str, Any], group: _Group) -> tuple[dict[str, Any], tuple[int, ...]]:
        """An axis without its phases of 0 s, as from two rows with one time stamp, and the numbers of its rows."""
        durations = axis.get(_DURATION, ())
        places = [k for k, duration in enumerate(durations) if duration != 0]
        if not places or len(places) == len(durations):
            return axis, group.numbers
        self.standing += [number for number, duration in zip(group.numbers, durations, strict=False) if duration == 0]
        moving = {name: [value[k] for k in places] if name in _OF_PHASE else value for name, value in axis.items()}
        return moving, tuple(group.numbers[k] for k in places) + group.numbers[len(durations) :]


_OF_PHASE = frozenset(each.place for each in (*PHASE, NAME))
_DURATION = "duration_s"
_STOP = "emergency_stop.torque_Nm"


def _stands_first(cells: Sequence[str]) -> bool:
    """True where only the first of several cells is filled."""
    return len(cells) > 1 and not is_blank(cells[0]) and all(map(is_blank, cells[1:]))


def _values_of(cell: str, texts: bool, decimal: Decimal) -> list[float | str]:
    """Several ratios or sizes in a cell. A comma between digits is a decimal mark, although no ratio has decimals."""
    if len(cell) > LONGEST_CELL:
        return [str(cell)]
    parts = [text for part in _BETWEEN.split(_OF_RATIO.sub("", cell).strip("[]")) if (text := part.strip(","))]
    if texts:
        return [text.strip() for part in parts for text in part.split(",") if text.strip()]
    numbers = [entry(part, decimal) for part in parts]
    return [
        part if number is None or number.unit else float(number.number)
        for part, number in zip(parts, numbers, strict=True)
    ]

"""A table of motors as in data sheets: a row is a motor; the user is asked about ambiguous cells."""

from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from math import isfinite, pi
from typing import Any

from hpn.tables import motor_points
from hpn.tables.bodies import TableBody, body_of
from hpn.tables.cells import is_blank
from hpn.tables.columns import NO_CHOICES, Choices, Column, proposed, settled
from hpn.tables.factors import is_factor
from hpn.tables.headings import LONGEST
from hpn.tables.heads import MOST_NAMED, MOST_TURNED, numbers_in
from hpn.tables.inputs import Inputs
from hpn.tables.interpreter import Interpreter, Row
from hpn.tables.motor_inputs import MOTORS, NAME, POWER, folded
from hpn.tables.motor_points import PARTIAL, POINT, POINTS, SPEED, is_part, with_curves, with_rows_of_points
from hpn.tables.questions import Questions
from hpn.tables.sheets import Grid, RefusedError
from hpn.tables.table import Choice, Table
from hpn.words.patterns import Pattern
from hpn.words.wording import N_, Sentence, first_of

TWINS = Choice(
    "twins",
    {
        "first": N_("the first counts"),
        "last": N_("the last counts"),
        "both": N_("both are kept, the later with a number"),
    },
)
ZEROS = Choice("zeros", {"unknown": N_("not known"), "skip": N_("these motors are left out")})
PARTS = Choice("points", {"skip": N_("these points are left out"), "motors": N_("motors with such a row are left out")})
BLANKS = Choice("blanks", {"unknown": N_("not known: not checked"), "above": N_("as in the row above")})


SELDOM = frozenset(("kgm2", "kW"))
"""Units of the wire that are rare in data sheets: a column without a unit may be in kg·cm², or in W."""


def read_motors(grid: Grid, inputs: Inputs, choices: Choices = NO_CHOICES, assumed: Collection[str] = ()) -> Table:
    """Reading of a table of motors; raises nothing, `problem` tells why it can't be read."""
    try:
        body = body_of(with_rows_of_points(_upright(grid)), choices.scales, named_in=MOTORS.named_in)
        body = body.including(body.totals)  # a motor's name may be Max
        _require_one_header(body)
        columns = settled(proposed(body, inputs), body, inputs, choices, [*{*assumed} - SELDOM])
        _require_no_factors(body, columns)
        return _MotorsInterpreter(body, columns, Questions(choices)).table()
    except RefusedError as refused:
        return Table(problem=refused.sentence)


def _upright(grid: Grid) -> Grid:
    """The table with a row per motor: turned where its first column names figures, and no row does."""
    if len(grid.rows) > MOST_TURNED or max(map(MOTORS.named_in, grid.rows)) > 1:
        return grid
    turned = grid.transposed()
    return turned if MOTORS.named_in(turned.rows[0]) > 1 else grid


def _require_one_header(body: TableBody) -> None:
    """Raise RefusedError where a row among the motors names figures again: its columns or units may be others."""
    for number, row in zip(body.numbers, body.rows, strict=True):
        if not numbers_in(row) and MOTORS.named_in(row) > 1:
            raise RefusedError(N_("row {row} is another header: paste one table at a time"), row=number)


def _require_no_factors(body: TableBody, columns: Sequence[Column]) -> None:
    """Raise RefusedError where the first row has a factor for each column instead of a motor."""
    cells = [cell for cell in body.rows[0] if not is_blank(cell)]
    name = next((body.rows[0][column.place] for column in columns if column.role == NAME), "")
    factors = [cell for cell in cells if cell != name and cell != "1"]
    if (is_blank(name) or folded(name) in _OF_FACTORS) and factors and all(map(is_factor, factors)):
        template = N_("row {row} may have factors: {cell}. Multiply its columns by them, and take it out")
        raise RefusedError(template, row=body.numbers[0], cell=factors[0])


_OF_FACTORS = {"factor", "faktor", "facteur", "fattore", "multiplier", "multiplikator", "scale", "skala", "x", "×", "*"}
"""Names of a row of factors."""

_FLYWHEEL = Pattern(r"(?<![^\W_])[GP]D\^?[²2](?! ?/ ?4)", LONGEST)

_Row = tuple[int, dict[str, Any]]
"""Number of a row, and the figures of its motor by their places."""


class _MotorsInterpreter(Interpreter):
    """Interpreter of a table of motors."""

    required = (NAME,)
    any_unit = True

    def table(self) -> Table:
        """The table with its open questions, or with its motors."""
        self.ask_columns()
        self._ask_flywheel()
        self.read_numbers()
        self.ask_scale()
        rows = self._named_once(self._with_figures(self._with_power(with_curves(self._figures()))))
        motors = () if self.questions.open else tuple(values for _, values in rows)
        origins = {values["designation"]: (number,) for number, values in rows}
        return Table(**self.facts, motors=motors, origins=origins)

    def _ask_flywheel(self) -> None:
        """Ask about a column with GD², which is four times the inertia."""
        for column in self.columns:
            if column.role == "Jm" and _FLYWHEEL.search(column.heading):
                template = N_("Column {name}: GD² is four times the inertia. Divide it by 4, or choose “not read”.")
                self.ask(template, name=column.called)

    def ask_side(self) -> list[Column]:
        """No column: every figure belongs to the motor."""
        return []

    def _figures(self) -> list[_Row]:
        """Motors by their rows, with blank cells and zeros as answered.

        Where rows are points of a motor, one row that can't be read leaves all its rows out.
        """
        zeros = self._ask_cells(ZEROS, N_("Cells that are 0, first in row {row} of {name}. What do they mean?"), 0.0)
        blanks = self._ask_cells(BLANKS, N_("Blank cells, first in row {row} of {name}. What do they mean?"), None)
        name = next((column.place for column in self.columns if column.role == NAME), None)
        rows, above = list[_Row](), dict[str, Any]()
        left_out: dict[str, list[_Row]] = {NO_FIGURE: [], NO_NAME: [], _ZERO: []}
        for number, cells, read in zip(self.body.numbers, self.body.rows, self.rows, strict=True):
            designation = "" if name is None else " ".join(str(cells[name]).split())[:100]
            if self._has_points and not designation:  # a further point of the motor above
                designation = above.get("designation", "")
            values, is_wrong = self._values(cells, read, above, zeros, blanks)
            values["designation"] = designation
            above |= values
            fault = NO_FIGURE if is_wrong else _ZERO if _has_zero(values) else NO_NAME if not designation else ""
            (left_out[fault] if fault else rows).append((number, values))
        for template, group in left_out.items():
            self._note(template, group)
        if self._has_points:
            designations = {values["designation"] for group in left_out.values() for _, values in group}
            rows = [row for row in rows if row[1]["designation"] not in designations]
        return self._with_points(rows)

    def _values(
        self, cells: Sequence[str], read: Row, above: dict[str, Any], zeros: str, blanks: str
    ) -> tuple[dict[str, Any], bool]:
        """Figures of a row by their places, and True where a cell is none; unknown ones leave those `above`, too."""
        values, is_wrong = dict[str, Any](), False
        for column, figure in zip(self.used, read, strict=True):
            cell, place = cells[column.place], column.input.place if column.input else ""
            if is_blank(cell):
                if blanks == "above" and place in above and column.role not in POINTS:
                    values[place] = above[place]
                    is_wrong |= not isfinite(above[place])
                continue
            text = self.in_wire(figure, column) if figure else ""
            value = float(text) if text else float("nan")
            if value == 0 and zeros != "skip" and column.role != SPEED:
                above.pop(place, None)
                continue
            is_wrong |= not (isfinite(value) and value >= 0)
            values[place] = value
        return values, is_wrong

    def _with_points(self, rows: list[_Row]) -> list[_Row]:
        """Rows, those with a part of a point of a curve as answered."""
        parts = [row for row in rows if is_part(row[1])]
        if not parts or self._ask_points(parts) != "motors":
            self._note(PARTIAL, parts)
            return rows
        self._note(_WITH_PARTIAL, parts)
        designations = {values["designation"] for _, values in parts}
        return [row for row in rows if row[1]["designation"] not in designations]

    def _with_figures(self, rows: list[_Row]) -> list[_Row]:
        """Motors with any figure."""
        self._note(NO_FIGURES, [row for row in rows if len(row[1]) == 1])
        return [row for row in rows if len(row[1]) > 1]

    def _ask_points(self, parts: Sequence[_Row]) -> str:
        """Answer about parts of points, blank while the question is open."""
        number, values = parts[0]
        lacking = next(place for place in POINT if place not in values)
        column = next((column for column in self.columns if column.input and column.input.place == lacking), None)
        named = next(each.named for each in motor_points.COLUMNS if each.place == lacking)
        template = N_("Incomplete points of a torque curve, first in row {row}: {name} is missing. What counts?")
        name = column.called if column else Sentence(named.name)
        return self.choose(PARTS, Sentence(template, {"row": number, "name": name}))

    def _note(self, template: str, rows: Sequence[_Row]) -> None:
        """Note that names some rows, if there are any; none while a question about their cells is open."""
        if rows and not self.questions.open:
            numbers = first_of([*dict.fromkeys(number for number, _ in rows)], MOST_NAMED)
            self.notes.append(Sentence(template, {"rows": numbers, "count": len(rows)}))

    def _ask_cells(self, choice: Choice, template: str, speed: float | None) -> str:
        """Answer about cells that are 0 or blank in a column with other cells, too; blank without such cells."""
        for place, column in enumerate(self.used):
            cells = [row[column.place] for row in self.body.rows]
            if all(map(is_blank, cells)) or column.role in (POINTS if speed is None else (SPEED,)):
                continue
            for number, cell, row, first in zip(self.body.numbers, cells, self.rows, self._begins, strict=True):
                figure = row[place]
                is_zero = figure is not None and float(figure.number) == 0
                if (first and is_blank(cell)) if speed is None else is_zero:
                    return self.choose(choice, Sentence(template, {"row": number, "name": column.called}))
        return ""

    @property
    def _has_points(self) -> bool:
        """True for a table with points of torque curves."""
        return any(column.role in POINTS for column in self.columns)

    @cached_property
    def _begins(self) -> list[bool]:
        """True for each row that begins a motor, False for further points of one."""
        place = next((column.place for column in self.columns if column.role == NAME), None)
        if place is None or not self._has_points:
            return [True] * len(self.body.rows)
        names = [" ".join(str(row[place]).split()) for row in self.body.rows]
        seen = set[str]()
        begins = []
        for name in names:
            begins.append(bool(name) and name not in seen)
            seen.add(name)
        return begins

    def _with_power(self, rows: list[_Row]) -> list[_Row]:
        """Motors with the torque P / ω of rated power and speed where no column has the rated torque."""
        roles = {column.role for column in self.columns}
        if POWER not in roles:
            return rows
        derived = "Tmn" not in roles
        if derived:
            self.notes.append(Sentence(N_("Rated torque is rated power over rated speed, where both are given.")))
        else:
            self.notes.append(Sentence(N_("Rated power is not read: the rated torque is given.")))
        motors = []
        for number, values in rows:
            power_kW, speed_rpm = values.pop(_POWER_PLACE, None), values.get("rated_speed_rpm")
            if derived and power_kW and speed_rpm:
                values["rated_torque_Nm"] = float(f"{power_kW * 1000 * 60 / (2 * pi * speed_rpm):.12g}")
            motors.append((number, values))
        return motors

    def _named_once(self, rows: list[_Row]) -> list[_Row]:
        """Motors with unique names: exact duplicates count once, others as answered."""
        motors: dict[str, _Row] = {}
        first, counts = dict[str, dict[str, Any]](), dict[str, int]()
        twins = [
            values["designation"] for _, values in rows if first.setdefault(values["designation"], values) != values
        ]
        answer = ""
        if twins:
            names = ", ".join([*dict.fromkeys(twins)][:MOST_NAMED])
            template = N_("Motors that stand there twice with other figures: {names}. Which one counts?")
            answer = self.choose(TWINS, Sentence(template, {"names": names}))
        for number, values in rows:
            name = values["designation"]
            if name in motors and values == motors[name][1]:
                continue
            if name in motors and answer == "both":
                counts[name] = counts.get(name, 1) + 1
                name = f"{name} ({counts[name]})"
            if name not in motors or answer == "last":
                motors[name] = number, values | {"designation": name}
        return list(motors.values())


_POWER_PLACE = "rated_power_kW"
NO_FIGURE = N_("Motors with a cell that is no number above 0 are left out ({count}): row {rows}.")
NO_NAME = N_("Rows without a name are left out ({count}): row {rows}.")
NO_FIGURES = N_("Motors without any figure are left out ({count}): row {rows}.")
_WITH_PARTIAL = N_("Motors with a part of a point of a torque curve are left out ({count}): row {rows}.")
_ZERO = N_("Motors with a figure of 0 are left out ({count}): row {rows}.")


def _has_zero(values: Mapping[str, Any]) -> bool:
    """True for a row with a figure of 0 other than the speed of a point."""
    return any(value == 0 for place, value in values.items() if place != "curve_speed_rpm")

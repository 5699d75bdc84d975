"""Lines and tables of an account: named quantities with value, unit and source, as number or text for any reader."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

from hpn.engine.notice import AREAS
from hpn.words.designations import OTHERS
from hpn.words.reader import Reader
from hpn.words.terms import BEARING_MODELS, FOR_OTHERS, LIFE_BASES, MECHANISMS, POSITION_ERROR_AT, PROFILES, RANKINGS
from hpn.words.units import suffix_of
from hpn.words.wording import N_, Named, Quantity, Sentence

Value = float | str | Sentence | Mapping[str, float]
"""A number in the unit of its line, a number for each size, or a text: a code, a msgid, the user's own, or a
sentence.
"""

LIMIT = "candidate.motor_torque_limit_Nm"
Kind = Literal["entered", "computed", "published"]


WORDS: Mapping[str, str] = {
    **BEARING_MODELS,
    **LIFE_BASES,
    **POSITION_ERROR_AT,
    **MECHANISMS,
    **PROFILES,
    **{code: ranking.choice for code, ranking in RANKINGS.items()},
    "True": N_("yes"),
    "False": N_("no"),
    "gear_L10": N_("gear L10"),
    "bearing_L10": N_("bearing L10"),
    "bearing_L50": N_("bearing L50"),
    **{str(area): text for area, text in AREAS.items()},
}
"""Codes -> words."""

TYPED = ("requirements.motor.designation", "requirements.motor.name", "phase.name", "motion.move.name")
"""Inputs with a text of the user's own."""

SHARES = ("requirements.utilisation", "requirements.worst_case_utilisation")
"""Inputs that are a share of 1, and shown in percent."""


@dataclass(frozen=True, slots=True)
class Line:
    """A quantity by its place in `QUANTITIES`. Its value is None if it is asked for but has none.

    `unit` is a suffix. `until` ends a range that begins with the value, and `sign` marks a bound. Inputs are written as
    entered, published figures as printed in their own unit; any other number is rounded.
    """

    code: str
    named: Named
    value: Value | None = None
    unit: str = ""
    kind: Kind = "entered"
    source: Sentence | None = None
    until: float | None = None
    sign: str = ""
    is_lower_bound: bool = False
    is_supplied: bool = False

    @classmethod
    def entered(cls, code: str, named: Named, value: Value | None, kind: Kind = "entered") -> "Line":
        """Line of an input with its unit, a utilisation in percent."""
        if code in SHARES and isinstance(value, float | int):
            return cls(code, named, float(f"{100 * value:.15g}"), "percent", kind)
        return cls(code, named, value, suffix_of(code), kind)

    @property
    def field(self) -> str:
        """Name of its field: the last part of its place."""
        return self.code.rpartition(".")[2]

    @property
    def end(self) -> Value | None:
        """Largest value: the end of a range, else the value."""
        return self.value if self.until is None else self.until

    def of(self, value: Value | None) -> "Line":
        """The same quantity with another value."""
        return replace(self, value=value)

    def value_for(self, reader: Reader) -> float | str | None:
        """The value for a cell: a number with every digit in the reader's unit, or a text in their language."""
        if isinstance(self.value, Mapping):
            return "; ".join(f"{_size(size, reader)}: {self.of(x).text(reader)}" for size, x in self.value.items())
        if isinstance(self.value, Sentence):
            return reader.sentence(self.value)
        if isinstance(self.value, str):
            return self.value if self.code in TYPED else reader.text(WORDS.get(self.value, self.value))
        return reader.value(self.value, self.unit)

    def number(self, reader: Reader, beside: Value | None = None) -> str:
        """The value without its unit: a number, a range or words; blank without a value.

        A rounded number has enough digits to differ from the one `beside` it.
        """
        if not isinstance(self.value, float | int):
            return str(self.value_for(reader) or "")
        if self.code == LIMIT:
            return reader.number(drive_limit(self.value))
        printed = self.kind == "published" and reader.measure(self.unit).same
        other = beside if isinstance(beside, float | int) else None
        exact = printed or self.kind == "entered"
        write = reader.exact if exact else partial(reader.figure, beside=other)
        between = " … " if self.value < 0 else "–"
        until = "" if self.until is None else f"{between}{write(self.until, self.unit)}"
        return f"{self.sign}{' ' if self.sign else ''}{write(self.value, self.unit)}{until}"

    def text(self, reader: Reader) -> str:
        """The value with its unit."""
        number = self.number(reader)
        return reader.with_unit(number, self.unit) if isinstance(self.value, float | int) else number

    def label(self, reader: Reader) -> str:
        """Name of the quantity."""
        return reader.text(self.named.name)

    def where(self, reader: Reader) -> str:
        """Source of the value; blank for an input."""
        return reader.sentence(self.source) if self.source else ""


def _size(size: str, reader: Reader) -> str:
    return reader.text(FOR_OTHERS) if size == OTHERS else size


def drive_limit(limit_Nm: float) -> Quantity:
    """Torque limit of the drive as it is shown everywhere: never above what keeps the gear at T_R."""
    return Quantity(limit_Nm, "Nm", 4, "down")


def with_values(lines: Iterable[Line]) -> list[Line]:
    """Lines with a value."""
    return [line for line in lines if line.value is not None]


@dataclass(frozen=True, slots=True)
class QuantityColumn:
    """One quantity of a table's rows; None for a row without it."""

    head: Line
    values: Sequence[Value | None]

    def numbers(self, reader: Reader) -> list[str]:
        """Its values without their unit."""
        return [self.head.of(value).number(reader) for value in self.values]


@dataclass(frozen=True, slots=True)
class LineTable:
    """Rows of one kind, such as phases: columns of labels by their heads (msgids), and columns of values."""

    labels: Mapping[str, Sequence[str]]
    columns: tuple[QuantityColumn, ...]
    names: QuantityColumn

    def __len__(self) -> int:
        return len(self.names.values)

    def first(self, count: int) -> "LineTable":
        """The first rows."""
        columns = tuple(replace(column, values=column.values[:count]) for column in self.columns)
        labels = {head: texts[:count] for head, texts in self.labels.items()}
        return LineTable(labels, columns, replace(self.names, values=self.names.values[:count]))

    def row(self, place: int) -> list[Line]:
        """Texts of one row, its name first."""
        return with_values(column.head.of(column.values[place]) for column in (self.names, *self.columns))

    def values(self) -> Iterator[Mapping[str, Value]]:
        """Values of each row by the places of their quantities."""
        columns = (self.names, *self.columns)
        codes = [column.head.code for column in columns]
        for row in zip(*(column.values for column in columns), strict=True):
            yield {code: value for code, value in zip(codes, row, strict=True) if value is not None}

    def text(self, place: int, reader: Reader) -> str:
        """One row in one line, figures with their units."""
        return " · ".join(line.text(reader) for line in self.row(place))

"""Columns of a table of axes: one for every field of an application, with the bounds of the models.

A column is named by its path with dots, such as `requirements.life_h`; a field of a phase by its name alone, and it
holds a list with an item per phase. `pause_s` stands for `duty_cycle.pause_s`. A column of numbers that may be given by
size holds numbers, or texts that are each a number or a JSON object. Names, kinds and bounds come from the models' JSON
Schema, so that a new input needs no line here.
"""

import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import pyarrow as pa
import pyarrow.types as kinds

from hpn.application.faults import OF_PHASE, Location
from hpn.application.input_fields import FIELDS, PHASE_FIELDS, PHASE_FIGURES, InputField, Kind
from hpn.application.unique import require_unique
from hpn.fleet.faults import OF_ITEM, OF_SIZE
from hpn.fleet.uuids import is_uuid

Json = dict[str, Any]

AXIS = "axis"
SIZE_SHOWN = 40
NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?|[+-]?(nan|inf|infinity)", re.IGNORECASE)
"""Number in a cell of text."""

TEXTS = ("string", "points")
"""Kinds whose cells are texts; a cell of points is JSON."""

PAUSE = ("duty_cycle", "pause_s")
Place = tuple[str, str, str]
"""Template for a reason inside a cell, and the name and value of the place in that cell."""


@dataclass(frozen=True, kw_only=True)
class InputColumn(InputField):
    """Column: its name, and the field of its cells or of the items of their lists."""

    name: str

    @property
    def type(self) -> pa.DataType:
        """Arrow type of its cells."""
        kind = "string" if self.by_size or self.kind == "points" else self.kind
        item = {"string": pa.string(), "boolean": pa.bool_()}.get(kind, pa.float64())
        return pa.list_(item) if self.is_list else item

    def takes(self, type: pa.DataType, target: pa.DataType) -> bool:
        """True where a column of an Arrow type can be read as a wanted type."""
        type = plain_type(type)
        if kinds.is_null(type):
            return not self.required
        if is_list(target):
            return is_list(type) and self._takes_item(type.value_type)
        return self._takes_item(type)

    def _takes_item(self, type: pa.DataType) -> bool:
        if kinds.is_null(type):
            return True
        if self.by_size and is_text(type):
            return True
        if self.kind in (*TEXTS, "boolean"):
            return is_text(type) if self.kind in TEXTS else bool(kinds.is_boolean(type))
        return bool(kinds.is_integer(type) or kinds.is_floating(type) or kinds.is_decimal(type))


def is_list(type: pa.DataType) -> bool:
    """True for an Arrow type of lists, of any kind."""
    return any(test(type) for test in LISTS)


LISTS = (kinds.is_list, kinds.is_large_list, kinds.is_fixed_size_list, kinds.is_list_view, kinds.is_large_list_view)


def plain_type(type: pa.DataType) -> pa.DataType:
    """Arrow type of the plain values, for any encoding: dictionary, runs or views."""
    if kinds.is_dictionary(type) or kinds.is_run_end_encoded(type):
        return plain_type(type.value_type)
    if is_list(type):
        return pa.list_(plain_type(type.value_type))
    return pa.string() if kinds.is_string_view(type) or is_uuid(type) else type


def is_text(type: pa.DataType) -> bool:
    """True for an Arrow type of texts."""
    return bool(kinds.is_string(type) or kinds.is_large_string(type) or kinds.is_string_view(type))


TOLERANCES = "tolerances"
OF_TOLERANCE = re.compile(r"tolerances\.([A-Za-z0-9_.]{1,100}?)\.((?:minus\.|plus\.)?(?:percent|absolute))")
ONE_PHASE = re.compile(r"phases\.(?:0|[1-9][0-9]{0,4})\.([A-Za-z_]+)")


@lru_cache(maxsize=4096)
def tolerance_column(name: str) -> InputColumn | None:
    """Column of a tolerance, such as `tolerances.torque_Nm.percent`; None for any other name.

    Every input has such columns, and every figure of each phase.
    """
    match = OF_TOLERANCE.fullmatch(name)
    if match is None:
        return None
    path, field = match[1], ONE_PHASE.fullmatch(match[1])
    if (field[1] not in PHASE_FIGURES) if field else (path not in PHASE_FIGURES and path not in _NUMBERS):
        return None
    return InputColumn(
        name=name,
        path=(TOLERANCES, path, *match[2].split(".")),
        kind="number",
        is_list=False,
        required=False,
        default=None,
        least=0.0,
        most=math.inf,
        above=-math.inf,
        choices=None,
    )


_NUMBERS = {"pause_s", *(name for name, field in FIELDS.items() if field.kind == "number" and not field.is_list)}


class ColumnsByName(dict[str, InputColumn]):
    """Columns by name; columns of tolerances are made at first use."""

    def __missing__(self, name: str) -> InputColumn:
        column = tolerance_column(name)
        if column is None:
            raise KeyError(name)
        return column

    def __contains__(self, name: object) -> bool:
        return super().__contains__(name) or (isinstance(name, str) and tolerance_column(name) is not None)

    def get(self, name: str, default: Any = None) -> Any:
        try:
            return self[name]
        except KeyError:
            return default


@dataclass(frozen=True)
class Columns:
    """All columns that a table of axes may have."""

    phases: Mapping[str, InputColumn]
    others: Mapping[str, InputColumn]

    @cached_property
    def at(self) -> Mapping[tuple[str, ...], InputColumn]:
        """Columns without phases, by their place in the application."""
        return {column.path: column for column in self.others.values()}

    @cached_property
    def all(self) -> Mapping[str, InputColumn]:
        """Columns by name."""
        return ColumnsByName({**self.phases, **self.others})

    def application_of(self, row: Mapping[str, Any]) -> Json:
        """Application of a row, as JSON for the models; a null is an input not given.

        The number of phases is the length of the longest list.
        """
        application: Json = {"duty_cycle": {"phases": _phases(row, self.phases)}}
        for name, column in self.others.items():
            value = row.get(name)
            if value is not None:
                place = application
                for part in column.path[:-1]:
                    place = place.setdefault(part, {})
                is_list = isinstance(value, list)
                place[column.path[-1]] = [_plain(item, column) for item in value] if is_list else _plain(value, column)
        for name, value in row.items():
            if value is not None and (tolerance := tolerance_column(name)) is not None:
                _put(application, tolerance.path, float(value))
        return application

    def column_at(self, location: Location) -> tuple[str, Place | None]:
        """Column of a place in the application, and the place inside its cell."""
        if location[:2] == ("duty_cycle", "phases"):
            if len(location) == 2 or not isinstance(location[2], int):
                return "torque_Nm", None
            return (str(location[3]) if len(location) > 3 else "speed_rpm"), (OF_PHASE, "number", str(location[2] + 1))
        names = tuple(part for part in location if isinstance(part, str))
        if (column := self.at.get(names[:-1])) is not None and column.by_size:
            return column.name, (OF_SIZE, "size", names[-1][:SIZE_SHOWN])
        items = [(OF_ITEM, "number", str(part + 1)) for part in location if isinstance(part, int)]
        owner = self.at.get(names) or self.at.get(names[:-1])
        return (owner.name if owner else ".".join(names)), (items[0] if items else None)


def _put(document: Json, path: Sequence[str], value: float) -> None:
    for part in path[:-1]:
        document = document.setdefault(part, {})
    document[path[-1]] = value


def _phases(row: Mapping[str, Any], columns: Mapping[str, InputColumn]) -> list[Json]:
    lists = {name: row.get(name) or [] for name in columns}
    count = max(map(len, lists.values()))
    return [
        {
            name: _plain(values[index], columns[name])
            for name, values in lists.items()
            if index < len(values) and values[index] is not None
        }
        for index in range(count)
    ]


def _plain(value: Any, column: InputColumn) -> Any:
    """Cell in the form of the models: any number as a float, a text by size or of points as its JSON value.

    A cell read by a page may be a text in place of a number; the models refuse it.
    """
    if column.by_size and isinstance(value, str):
        return float(value) if NUMBER.fullmatch(value.strip()) else _in_json(value, dict)
    if column.kind == "points" and isinstance(value, str):
        return _in_json(value, list)
    is_number = isinstance(value, float | int) and not isinstance(value, bool)
    return float(value) if is_number and column.kind not in (*TEXTS, "boolean") else value


def _in_json(text: str, kind: type) -> Any:
    """Value of a JSON text, its whole numbers as floats; the text itself where it is invalid or of another type, which
    the models refuse."""
    try:
        require_unique(text.encode())
        value = json.loads(text, parse_int=float)
    except (ValueError, RecursionError):
        return text
    return value if isinstance(value, kind) else text


def _column(name: str, field: InputField, *, is_list: bool) -> InputColumn:
    return InputColumn(**{**vars(field), "name": name, "is_list": is_list})


COLUMNS = Columns(
    {name: _column(name, field, is_list=True) for name, field in PHASE_FIELDS.items()},
    ColumnsByName(
        {
            name: _column(name, field, is_list=field.is_list)
            for name, field in (("pause_s" if field.path == PAUSE else path, field) for path, field in FIELDS.items())
        }
    ),
)
"""Columns of the models."""


def _of_machine(name: str, kind: Kind, *, is_list: bool = False) -> InputColumn:
    bounds: Json = {"default": None, "least": -math.inf, "most": math.inf, "above": -math.inf, "choices": None}
    return InputColumn(name=name, path=(name,), kind=kind, is_list=is_list, required=False, **bounds)


OF_MACHINE: Mapping[str, InputColumn] = {
    "axis_name": _of_machine("axis_name", "string"),
    "quantity": _of_machine("quantity", "integer"),
    "note": _of_machine("note", "string"),
    "ordering_code": _of_machine("ordering_code", "string"),
    "without": _of_machine("without", "string", is_list=True),
    "rest": _of_machine("rest", "string"),
}
"""Columns that a machine's table has beside those of `hpn fleet`: fields that only a machine's axes have."""

LONG_TEXTS = ("note", "rest")
"""Columns whose texts are bounded by the model of an axis."""

MACHINE = ColumnsByName({**COLUMNS.all, **OF_MACHINE})
"""Columns of the table of a machine."""


INDEX = re.compile("__index_level_[0-9]+__")
"""Name that pandas gives an unnamed index."""


def are_taken(names: Sequence[str], is_in_list_form: bool) -> bool:
    """True for columns that the reader of fleets knows, those of a machine and an index of pandas among them. Long form
    with other columns is read as a table of cells, where `20A` and `4/5` are lists."""
    is_in_list_form = is_in_list_form or "axis_name" in names  # a machine whose first axis has no phases
    known = {AXIS, *COLUMNS.phases, *((*COLUMNS.others, *OF_MACHINE) if is_in_list_form else ())}
    known |= {name for name in names if is_in_list_form and tolerance_column(name)}
    texts = {name for place, name in enumerate(names) if not INDEX.fullmatch(name) and (place or name)}
    return {AXIS, "torque_Nm"} <= texts <= known

"""Axes of a machine as a table in list form: own values by their paths, and the fields that only a machine's axes have.

A row is an axis by its number. A value that no column can hold, such as a motion or a value that leaves the axis open,
stands as JSON in `rest`, so that the table has everything that the axis has.
"""

import json
from collections.abc import Mapping
from io import BytesIO
from typing import Any

import pyarrow as pa
import pyarrow.csv as pacsv
import pyarrow.parquet as pq
from pydantic import ValidationError
from pydantic_core import InitErrorDetails, PydanticCustomError, from_json

from hpn.application.unique import require_unique
from hpn.documents.axis import Axis
from hpn.documents.revision import Frozen, FrozenAxis
from hpn.fleet.columns import AXIS, COLUMNS, MACHINE, OF_MACHINE, InputColumn, is_list
from hpn.fleet.tables import LONGEST_TEXT
from hpn.words.fields import whole
from hpn.words.wording import N_

Json = dict[str, Any]

LARGEST = 1e300
NO_OBJECT = N_("must be a JSON object")


def table_of(document: Frozen) -> pa.Table:
    """Table of the axes of a document in their order; columns that no axis fills are left out."""
    rows = [_row(axis) for axis in document.axes]
    used = {name for row in rows for name, value in row.items() if value is not None}
    required = [name for name, column in COLUMNS.phases.items() if column.required]
    kinds = {AXIS: pa.int64(), **{name: MACHINE[name].type for name in (*OF_MACHINE, *COLUMNS.all)}}
    kinds["quantity"] = pa.int64()
    columns = [(name, kind) for name, kind in kinds.items() if name in used or name in (AXIS, "axis_name", *required)]
    return pa.Table.from_pylist(rows, pa.schema(columns))


def parquet(document: Frozen) -> bytes:
    """Table of a document's axes as Parquet."""
    content = BytesIO()
    pq.write_table(table_of(document), content)
    return content.getvalue()


def csv(document: Frozen) -> bytes:
    """Table of a document's axes as CSV, lists as JSON in their cells."""
    table, content = table_of(document), BytesIO()
    for place, field in enumerate(table.schema):
        if is_list(field.type):
            texts = [None if cell is None else json.dumps(cell) for cell in table[field.name].to_pylist()]
            table = table.set_column(place, field.name, pa.array(texts, pa.string()))
    pacsv.write_csv(table, content)
    return content.getvalue()


def axis_of(row: Mapping[str, Any]) -> Axis:
    """Axis of a row; raises ValidationError as the model."""
    application = COLUMNS.application_of(row)
    if not application["duty_cycle"]["phases"]:
        del application["duty_cycle"]["phases"]
    if not application["duty_cycle"]:
        del application["duty_cycle"]
    own = {name: row.get(name) for name in ("note", "ordering_code")}
    quantity = row.get("quantity")
    return Axis(
        name=row.get("axis_name"),
        quantity=1 if quantity is None else whole(quantity),
        without=tuple(row.get("without") or ()),
        application=_joined(application, _rest(row["rest"])) if row.get("rest") else application,
        **own,
    )


def _rest(text: str) -> Json:
    """Object of the column `rest`; raises ValidationError for any other text."""
    try:
        require_unique(text.encode(errors="replace"))
        value = from_json(text, allow_inf_nan=False)
    except (ValueError, RecursionError):
        value = None
    if not isinstance(value, dict):
        entry = InitErrorDetails(type=PydanticCustomError("rest", NO_OBJECT), loc=("rest",), input=text)
        raise ValidationError.from_exception_data(Axis.__name__, [entry])
    return value


def _joined(one: Json, other: Json) -> Json:
    """First object with all members of the second, joined at every depth."""
    joined = dict(one)
    for name, value in other.items():
        both = isinstance(value, dict) and isinstance(joined.get(name), dict)
        joined[name] = _joined(joined[name], value) if both else value
    return joined


# --- Cells ------------------------------------------------------------------------------------------------------------


def _row(axis: FrozenAxis) -> Json:
    rest: Json = json.loads(bytes(axis.application))
    row: Json = {AXIS: axis.number, "axis_name": axis.name, "quantity": axis.quantity, "note": axis.note}
    row |= {"ordering_code": axis.ordering_code, "without": list(axis.without) or None}
    row |= _phases(rest) | {column.name: _move_out(rest, column) for column in COLUMNS.others.values()}
    return row | {"rest": json.dumps(rest) if rest else None}


def _phases(rest: Json) -> Json:
    """Lists of an application's phases, moved out of it; empty where a list can't hold a phase."""
    cycle = rest.get("duty_cycle")
    phases = cycle.get("phases") if isinstance(cycle, dict) else None
    if not isinstance(phases, list) or not phases or not all(map(_is_plain, phases)):
        return {}
    assert isinstance(cycle, dict)
    del cycle["phases"]
    _drop_empty(rest, "duty_cycle")
    lists = {name: [phase.get(name) for phase in phases] for name in COLUMNS.phases}
    return {name: values for name, values in lists.items() if any(value is not None for value in values)}


def _is_plain(phase: Any) -> bool:
    """True for a phase whose every field fits in a list."""
    if not isinstance(phase, dict) or not phase:
        return False
    return all(name in COLUMNS.phases and _fits(COLUMNS.phases[name], value) for name, value in phase.items())


def _move_out(rest: Json, column: InputColumn) -> Any:
    """Cell of a column, moved out of the application; None where it has no value that fits."""
    *parts, last = column.path
    owners = [rest]
    for part in parts:
        owner = owners[-1].get(part)
        if not isinstance(owner, dict):
            return None
        owners.append(owner)
    value = owners[-1].get(last)
    fits = isinstance(value, list) and value and all(_fits(column, item) for item in value)
    if value is None or not (fits if column.is_list else _fits(column, value)):
        return None
    del owners[-1][last]
    for owner, part in zip(reversed(owners[:-1]), reversed(parts), strict=True):
        _drop_empty(owner, part)
    return json.dumps(value) if column.by_size or column.kind == "points" else value


def _fits(column: InputColumn, value: Any) -> bool:
    """True for a value that fits in the column, or in its lists."""
    if value is None:
        return column.is_list
    if isinstance(value, bool):
        return column.kind == "boolean"
    if column.kind == "points":
        return isinstance(value, list) and all(map(_is_of_numbers, value))
    if isinstance(value, str):
        return column.kind == "string" and 0 < len(value) <= LONGEST_TEXT
    if column.by_size and isinstance(value, dict):
        return _is_of_numbers(value)
    is_number = isinstance(value, float | int) and column.kind in ("number", "integer")
    return is_number and abs(value) < LARGEST and (isinstance(value, float) or int(float(value)) == value)


def _is_of_numbers(value: Any) -> bool:
    """True for an object of numbers."""
    return isinstance(value, dict) and all(
        isinstance(each, float | int) and not isinstance(each, bool) for each in value.values()
    )


def _drop_empty(owner: Json, name: str) -> None:
    if not owner[name]:
        del owner[name]

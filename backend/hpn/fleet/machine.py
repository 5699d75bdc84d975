"""Axes of a machine from a table: rows of a table of `hpn fleet` as plain data, and axes from such rows."""

import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from pydantic import ValidationError

from hpn.application.faults import OF_PHASE, OF_ROW, REQUIRED, sentences_of
from hpn.documents.axis import MOST_OF_A_KIND, Axis
from hpn.fleet.columns import AXIS, COLUMNS, MACHINE, InputColumn
from hpn.fleet.csv_tables import cut, no_list
from hpn.fleet.faults import OF_ITEM, TWICE, CellFault, of_phase
from hpn.fleet.gathering import axes_of
from hpn.fleet.machine_axes import axis_of
from hpn.fleet.opened import open_axes
from hpn.fleet.order import MOST_AXES, MOST_PHASES
from hpn.fleet.outcome import faults_of_lists
from hpn.words.titles import LONGEST_NAME
from hpn.words.wording import N_, Quantity, Sentence

Cells = Mapping[str, Any]
"""Axis in list form, by the names of columns."""

NO_QUANTITY = N_("must be a whole number from 1 to {most}")
RIGHT: Mapping[str, tuple[Any, str, str]] = {
    "string": (str, N_("must be text, not {found}"), "string_type"),
    "boolean": (bool, N_("must be true or false, not {found}"), "bool_type"),
}
NUMBER: tuple[Any, str, str] = (float, N_("must be a number, such as 9.3, not {found}"), "float_type")


# --- Out of a table ---------------------------------------------------------------------------------------------------


class MachineRows(NamedTuple):
    """Axes of a table with the faults of their cells, at most as many as a machine may have; and the numbers of all
    axes and phases."""

    rows: list[dict[str, Any]]
    faults: list[CellFault]
    axes: int
    phases: int


def given_of(content: bytes, name: str) -> MachineRows:
    """Axes of a table under a name with its suffix; raises FleetError."""
    rows, faults, axes, phases = list[dict[str, Any]](), list[CellFault](), 0, 0
    for batch in axes_of(open_axes(Path(name), (), content, MACHINE)):
        phases += sum(pc.list_value_length(batch.rows["torque_Nm"]).fill_null(0).to_pylist())
        if axes + batch.rows.num_rows <= MOST_AXES and phases <= MOST_PHASES:
            names = batch.rows[AXIS].cast(pa.string())
            table = batch.rows.set_column(batch.rows.column_names.index(AXIS), AXIS, names)
            for row in table.to_pylist():
                rows.append({name: cell for name, cell in row.items() if cell is not None or name == "axis_name"})
            faults += (fault.moved(axes) for fault in batch.faults)
        axes += batch.rows.num_rows
    return MachineRows(rows, faults, axes, phases)


# --- Axes of a machine ------------------------------------------------------------------------------------------------


class TableAxis(NamedTuple):
    """Axis of a table with its name there, and the faults of its cells."""

    axis: Axis
    name: str | None
    faults: Sequence[CellFault] = ()


def axes_in(rows: Sequence[Cells], faults: Sequence[CellFault] = ()) -> list[TableAxis]:
    """Axes of the rows of a table, each once; an axis with a lost cell has only its name.

    A wrong quantity stays in the application, which is refused with it: the axis is open until it is edited.
    """
    faults_by_axis = dict[int, list[CellFault]]()
    for fault in faults:
        faults_by_axis.setdefault(fault.row, []).append(fault)
    places = dict[str, list[int]]()
    for place, row in enumerate(rows):
        places.setdefault(row.get(AXIS) or f" {place}", []).append(place)
    return [_once(rows, numbers, faults_by_axis) for numbers in places.values()]


def _once(rows: Sequence[Cells], places: Sequence[int], lost: Mapping[int, Sequence[CellFault]]) -> TableAxis:
    """Axis of a name; a fault where its rows are not together."""
    place = places[0]
    row, faults = rows[place], lost.get(place, ())
    if len(places) > 1:
        faults = (CellFault(place, AXIS, TWICE, "repeated"),)
    return _axis(row, place, list(faults))


def _axis(row: Cells, place: int, faults: list[CellFault]) -> TableAxis:
    is_of_machine = "axis_name" in row  # axes of a machine are numbered, and need no name
    name = row["axis_name"] if is_of_machine else row.get(AXIS) or None
    if not faults and not is_of_machine:
        missing = [] if name is not None else [CellFault(place, AXIS, Sentence(REQUIRED), "missing")]
        faults = missing + [CellFault(place, *fault) for fault in faults_of_lists(row)]
    quantity, wrong = row.get("quantity", 1.0), list[CellFault]()
    if not isinstance(quantity, float | int) or quantity not in range(1, MOST_OF_A_KIND + 1):
        reason = Sentence(NO_QUANTITY, {"most": Quantity(MOST_OF_A_KIND, "", 7)})
        row, wrong = {**row, "quantity": None}, [CellFault(place, "quantity", reason, "quantity")]
    if not faults:
        try:
            axis = axis_of(row)
            if wrong:
                axis = axis.model_copy(update={"application": {**axis.application, "quantity": quantity}})
            return TableAxis(axis, name, [*wrong, *wrong_cells(row, place)])
        except ValidationError as error:
            faults = [
                CellFault(place, "axis_name" if at[0] == "name" else str(at[0]), sentence, code)
                for at, sentence, code in sentences_of(error)
            ]
    return TableAxis(Axis(), name[:LONGEST_NAME] if is_of_machine and name else name, [*faults, *wrong])


def wrong_cells(row: Cells, place: int) -> list[CellFault]:
    """Faults of cells that do not fit their column."""
    reasons = ((name, _wrong(cell, MACHINE[name])) for name, cell in row.items() if name in MACHINE)
    return [CellFault(place, name, *wrong) for name, wrong in reasons if wrong]


def in_row(fault: CellFault, numbers: Sequence[int]) -> CellFault:
    """Fault with the row of the table in place of its phase, where the axis's phases are rows of that table."""
    reason = fault.reason
    phase = int(str(reason.values["number"])) - 1 if reason.template == OF_PHASE else len(numbers)
    if phase >= len(numbers):
        return fault
    return fault._replace(reason=Sentence(OF_ROW, {**reason.values, "number": str(numbers[phase])}))


# --- Tables that are kept ---------------------------------------------------------------------------------------------


def as_parquet(table: pa.Table) -> bytes:
    """Table as Parquet, to be kept."""
    sink = io.BytesIO()
    pq.write_table(table, sink, compression="zstd")
    return sink.getvalue()


# --- Cells ------------------------------------------------------------------------------------------------------------


def _wrong(cell: Any, column: InputColumn) -> tuple[Sentence, str] | None:
    """Reason and code for a cell that does not fit its column; None for one that does, and for an empty one."""
    if (column.by_size and not column.is_list) or column.kind == "points":  # the models judge these values
        return None
    kind, template, code = RIGHT.get(column.kind, NUMBER)
    type_: Any = list[kind | None] if column.is_list else kind  # type: ignore[valid-type]
    if cell is None or _is(cell, type_):
        return None
    if not column.is_list:
        return _sentence_of(template, cell), code
    if not isinstance(cell, list | tuple):
        return no_list(column)
    place, item = next(each for each in enumerate(cell, 1) if each[1] is not None and not _is(each[1], kind))
    sentence = _sentence_of(template, item)
    of_item = Sentence(OF_ITEM, {"number": str(place), "reason": sentence})
    return (of_phase(place, sentence) if column.name in COLUMNS.phases else of_item), code


def _sentence_of(template: str, cell: Any) -> Sentence:
    return Sentence(template, {"found": cut(msgspec.json.encode(cell).decode(errors="replace"))})


def _is(value: Any, kind: Any) -> bool:
    try:
        msgspec.convert(value, kind)
    except msgspec.ValidationError:
        return False
    return True

"""Axes of a machine out of a table: of one that `hpn fleet` takes as plain data, and of such rows as axes."""

import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from pydantic import ValidationError

from hpn.application.faults import REQUIRED, Location, sentences_of
from hpn.documents.axis import MOST_OF_A_KIND, Axis
from hpn.fleet.columns import AXIS, COLUMNS, MACHINE, InputColumn
from hpn.fleet.csv_tables import cut, no_list
from hpn.fleet.faults import OF_ITEM, OF_PHASE, TWICE, CellFault, of_phase
from hpn.fleet.gathering import axes_of
from hpn.fleet.machine_axes import axis_of
from hpn.fleet.opened import open_axes
from hpn.fleet.order import MOST_AXES, MOST_PHASES
from hpn.fleet.outcome import faults_of_lists
from hpn.words.titles import LONGEST_NAME
from hpn.words.wording import N_, Sentence

Cells = Mapping[str, Any]
"""An axis in list form, by the names of columns."""

NO_QUANTITY = N_("must be a whole number from 1 to {most}")
OF_ROW = N_("row {number}: {reason}")
RIGHT: Mapping[str, tuple[Any, str, str]] = {
    "string": (str, N_("must be text, not {found}"), "string_type"),
    "boolean": (bool, N_("must be true or false, not {found}"), "bool_type"),
}
NUMBER: tuple[Any, str, str] = (float, N_("must be a number, such as 9.3, not {found}"), "float_type")


# --- Out of a table ---------------------------------------------------------------------------------------------------


class MachineRows(NamedTuple):
    """Axes of a table, no more of them than a machine may have, and what is wrong with their cells; and how many there
    are."""

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
    """An axis of a table under its name there, and what is wrong with its cells."""

    axis: Axis
    name: str | None
    faults: Sequence[CellFault] = ()


def axes_in(rows: Sequence[Cells], faults: Sequence[CellFault] = ()) -> list[TableAxis]:
    """Axes of the rows of a table, each once; one of which a cell is lost has nothing but its name."""
    lost = dict[int, list[CellFault]]()
    for fault in faults:
        lost.setdefault(fault.row, []).append(fault)
    places = dict[str, list[int]]()
    for place, row in enumerate(rows):
        places.setdefault(row.get(AXIS) or f" {place}", []).append(place)
    return [_once(rows, numbers, lost) for numbers in places.values()]


def _once(rows: Sequence[Cells], places: Sequence[int], lost: Mapping[int, Sequence[CellFault]]) -> TableAxis:
    """The axis of a name, which rows that are not together are torn into."""
    place = places[0]
    row, faults = rows[place], lost.get(place, ())
    if len(places) > 1:
        faults = (CellFault(place, AXIS, TWICE, "repeated"),)
    return _axis(row, place, list(faults))


def _axis(row: Cells, place: int, faults: list[CellFault]) -> TableAxis:
    is_of_machine = "axis_name" in row  # its axes are numbered, and need no name
    name = row["axis_name"] if is_of_machine else row.get(AXIS) or None
    if not faults and not is_of_machine:
        missing = [] if name is not None else [CellFault(place, AXIS, Sentence(REQUIRED), "missing")]
        faults = missing + [CellFault(place, *fault) for fault in faults_of_lists(row)]
    if not _is_quantity(row.get("quantity", 1.0)):
        faults = [
            *faults,
            CellFault(place, "quantity", Sentence(NO_QUANTITY, {"most": f"{MOST_OF_A_KIND}"}), "quantity"),
        ]
    if not faults:
        try:
            return TableAxis(axis_of(row), name, wrong_cells(row, place))
        except ValidationError as error:
            faults = [CellFault(place, _column(at), sentence, code) for at, sentence, code in sentences_of(error)]
    return TableAxis(Axis(), name[:LONGEST_NAME] if is_of_machine and name else name, faults)


def _is_quantity(cell: Any) -> bool:
    return isinstance(cell, float | int) and cell in range(1, MOST_OF_A_KIND + 1)


def _column(location: Location) -> str:
    """Column of a field of an axis."""
    return "axis_name" if location[0] == "name" else str(location[0])


def wrong_cells(row: Cells, place: int) -> list[CellFault]:
    """Faults of cells that their column does not take."""
    reasons = ((name, _wrong(cell, MACHINE[name])) for name, cell in row.items() if name in MACHINE)
    return [CellFault(place, name, *wrong) for name, wrong in reasons if wrong]


def in_row(fault: CellFault, numbers: Sequence[int]) -> CellFault:
    """A fault by the row of the table in place of its phase, where the phases of its axis stand in such rows."""
    reason = fault.reason
    phase = int(str(reason.values["number"])) - 1 if reason.template == OF_PHASE else len(numbers)
    if phase >= len(numbers):
        return fault
    return fault._replace(reason=Sentence(OF_ROW, {**reason.values, "number": str(numbers[phase])}))


# --- Tables that are kept ---------------------------------------------------------------------------------------------


def as_parquet(table: pa.Table) -> bytes:
    """A table to be kept."""
    sink = io.BytesIO()
    pq.write_table(table, sink, compression="zstd")
    return sink.getvalue()


# --- Cells ------------------------------------------------------------------------------------------------------------


def _wrong(cell: Any, column: InputColumn) -> tuple[Sentence, str] | None:
    """Reason and code for a cell that its column does not take; None for one that it takes, and for none."""
    if column.by_size and not column.is_list:  # a number or an object; the models say what is neither
        return None
    kind, template, code = RIGHT.get(column.kind, NUMBER)
    wanted: Any = list[kind | None] if column.is_list else kind  # type: ignore[valid-type]
    if cell is None or _is(cell, wanted):
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

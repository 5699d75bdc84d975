"""Axes as plain data, as a page has them: out of a table that `hpn fleet` takes, and their answers to be kept."""

import io
import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from hpn.catalogue import Catalogue
from hpn.fleet.columns import AXIS, COLUMNS, InputColumn
from hpn.fleet.csv_tables import cut, no_list
from hpn.fleet.faults import OF_ITEM, OF_PHASE, TWICE, CellFault, of_phase
from hpn.fleet.gathering import axes_of
from hpn.fleet.listing import with_nearest
from hpn.fleet.opened import open_axes
from hpn.fleet.order import MOST_AXES, MOST_PHASES
from hpn.fleet.outcome import outcome
from hpn.fleet.summary import AxisCounts, summary_of
from hpn.fleet.tables import RowBatch, with_short_texts
from hpn.words.wording import N_, Sentence

Axis = Mapping[str, Any]
"""An axis in list form, by the names of columns."""

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
    for batch in axes_of(open_axes(Path(name), (), content)):
        phases += sum(pc.list_value_length(batch.rows["torque_Nm"]).fill_null(0).to_pylist())
        if axes + batch.rows.num_rows <= MOST_AXES and phases <= MOST_PHASES:
            names = batch.rows[AXIS].cast(pa.string())
            table = batch.rows.set_column(batch.rows.column_names.index(AXIS), AXIS, names)
            rows += ({name: cell for name, cell in row.items() if cell is not None} for row in table.to_pylist())
            faults += (fault.moved(axes) for fault in batch.faults)
        axes += batch.rows.num_rows
    return MachineRows(rows, faults, axes, phases)


# --- Answers ----------------------------------------------------------------------------------------------------------


class Kept(NamedTuple):
    """A machine to be kept: counts of its axes, and tables of answers and inputs as Parquet."""

    summary: AxisCounts
    answers: bytes
    axes: bytes


def kept_of(
    axes: Sequence[Axis], faults: Sequence[CellFault], origins: Mapping[str, Sequence[int]], catalogue: Catalogue
) -> Kept:
    """Answers to axes; `origins` are the rows of a table of cells that the phases of an axis stand in."""
    batch = _once(batch_of(axes, faults))
    names = batch.rows[AXIS].to_pylist()

    def placed(fault: CellFault) -> CellFault:
        """A fault by the row of the table in place of its phase."""
        numbers, reason = origins.get(names[fault.row] or "", ()), fault.reason
        place = int(str(reason.values["number"])) - 1 if reason.template == OF_PHASE else len(numbers)
        if place >= len(numbers):
            return fault
        values = {**reason.values, "number": str(numbers[place])}
        return fault._replace(reason=Sentence(OF_ROW, values))

    answers = outcome(batch, catalogue, placed=placed)["answers"]
    asked = batch.rows.filter(pc.is_valid(answers["suitable"]))
    shown = with_nearest(answers, asked, catalogue).drop_columns("error")  # which is what is shown of the reasons
    return Kept(summary_of(answers.to_batches()), as_parquet(shown), as_parquet(asked))


def answers_today(asked: bytes, catalogue: Catalogue) -> list[dict[str, Any]]:
    """Answers to the inputs that were kept."""
    rows: list[dict[str, Any]] = outcome(RowBatch(table_of(asked)), catalogue)["answers"].to_pylist()
    return rows


def as_parquet(table: pa.Table) -> bytes:
    """A table to be kept."""
    sink = io.BytesIO()
    pq.write_table(table, sink, compression="zstd")
    return sink.getvalue()


def table_of(content: bytes) -> pa.Table:
    """A table that was kept."""
    return pq.read_table(io.BytesIO(content))


# --- From plain data to columns ---------------------------------------------------------------------------------------


def batch_of(axes: Sequence[Axis], faults: Sequence[CellFault] = ()) -> RowBatch:
    """Axes as columns; a cell that its column does not take is a fault."""
    columns, found = {AXIS: pa.array([axis[AXIS] or None for axis in axes], pa.string())}, list(faults)
    for name, column in COLUMNS.all.items():
        if column.required or any(name in axis for axis in axes):
            cells = [axis.get(name) for axis in axes]
            if column.by_size:  # texts, of which each is a number or an object; the models say what is neither
                cells = [cell if cell is None or isinstance(cell, str) else json.dumps(cell) for cell in cells]
            for row, wrong in _wrong(cells, column):
                found.append(CellFault(row, name, *wrong))
                cells[row] = None
            columns[name] = pa.array(cells, column.type)
    return with_short_texts(RowBatch(pa.table(columns), found))


def _wrong(cells: Sequence[Any], column: InputColumn) -> Iterator[tuple[int, tuple[Sentence, str]]]:
    """Rows of cells that a column does not take, with what would be right and a code."""
    kind, template, code = RIGHT.get("string" if column.by_size else column.kind, NUMBER)
    for row, cell in enumerate(cells):
        wanted: Any = list[kind | None] if column.is_list else kind  # type: ignore[valid-type]
        if cell is None or _is(cell, wanted):
            continue
        if not column.is_list:
            yield row, (_told(template, cell), code)
        elif not isinstance(cell, list | tuple):
            yield row, no_list(column)
        else:
            place, item = next(each for each in enumerate(cell, 1) if each[1] is not None and not _is(each[1], kind))
            told = _told(template, item)
            of_item = Sentence(OF_ITEM, {"number": str(place), "reason": told})
            yield row, (of_phase(place, told) if column.name in COLUMNS.phases else of_item, code)


def _told(template: str, cell: Any) -> Sentence:
    return Sentence(template, {"found": cut(msgspec.json.encode(cell).decode(errors="replace"))})


def _is(value: Any, kind: Any) -> bool:
    try:
        msgspec.convert(value, kind)
    except msgspec.ValidationError:
        return False
    return True


def _once(batch: RowBatch) -> RowBatch:
    """Axes of which each is there once, where it comes first; one that was there again is a fault."""
    names = batch.rows[AXIS].to_pylist()
    counts = Counter(name for name in names if name is not None)
    if len(names) == len(counts):
        return batch
    first = {name: place for place, name in reversed(list(enumerate(names)))}
    places = [place for place, name in enumerate(names) if name is None or first[name] == place]
    moved = {place: row for row, place in enumerate(places)}
    torn = {row for place, row in moved.items() if counts[names[place]] > 1}
    own = [fault for fault in batch.faults if fault.row in moved and moved[fault.row] not in torn]
    faults = [fault._replace(row=moved[fault.row]) for fault in own]
    faults += (CellFault(row, AXIS, TWICE, "repeated") for row in sorted(torn))
    return RowBatch(batch.rows.take(pa.array(places, pa.int64())), faults)

"""A fleet that was sized, on its way into the store and out of it. Arrow is imported by this module."""

import io
from collections.abc import Callable, Mapping
from datetime import datetime
from pathlib import Path
from typing import Any, NamedTuple

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as pacsv
import pyarrow.parquet as pq
import xlsxwriter

from hpn import ENGINE_VERSION
from hpn.catalogue import Catalogue
from hpn.fleet.columns import AXIS
from hpn.fleet.listing import MOST_LISTED, NEAREST, AxisRow, listing_of, read_answers, rows_of
from hpn.fleet.summary import Summary, summary_of
from hpn.store import FleetDraft, SavedFleet
from hpn.web.door.problems import Problem
from hpn.web.pages.fleet_reasons import reasons_of
from hpn.words.reader import Reader
from hpn.words.wording import N_, Quantity, Sentence

COMPARED = ("selected", "governing_check", "utilisation", "suitable")
TOO_MANY = N_(
    "The table has {axes} axes, and a page takes {most} at most: size it with the command hpn fleet or POST "
    "/api/v1/fleet, which have no such limit."
)


def draft_of(axes: Path, answers: Path, catalogue: Catalogue) -> FleetDraft:
    """What is kept of tables that were sized; Problem 413 for more axes than a page shows."""
    listing = listing_of(axes, None, answers, catalogue)
    summary = listing.summary
    if summary.axes > MOST_LISTED:
        sentence = Sentence(TOO_MANY, {"axes": Quantity(summary.axes, "", 12), "most": Quantity(MOST_LISTED, "", 12)})
        problem = Problem(413, sentence.text)
        problem.sentences = (sentence,)
        raise problem
    return FleetDraft(
        axes=summary.axes,
        selected=summary.selected,
        unsuitable=summary.unsuitable,
        rejected=summary.rejected,
        engine_version=ENGINE_VERSION,
        catalogue_version=catalogue.version,
        asked=_packed(listing.axes),
        answers=_packed(listing.answers),
    )


def _packed(table: pa.Table) -> bytes:
    sink = io.BytesIO()
    pq.write_table(table, sink, compression="zstd")
    return sink.getvalue()


def table_of(content: bytes) -> pa.Table:
    """A table that was kept."""
    return pq.read_table(io.BytesIO(content))


class Kept(NamedTuple):
    """A fleet that was kept, ready to be shown."""

    summary: Summary
    rows: list[AxisRow]


def kept_of(saved: SavedFleet) -> Kept:
    """What came of the axes of a fleet."""
    answers = table_of(saved.answers)
    return Kept(summary_of(answers.to_batches()), rows_of(answers))


def asked_of(saved: SavedFleet, names: list[str]) -> pa.Table:
    """What some axes were asked with."""
    asked = table_of(saved.asked)
    return asked.filter(pc.is_in(asked[AXIS], pa.array(names, pa.string())))


# --- Today ------------------------------------------------------------------------------------------------------------


class Changed(NamedTuple):
    """An axis whose answer is another one today."""

    axis: str
    saved: dict[str, Any]
    today: dict[str, Any]


def changes(saved: SavedFleet, answers: Path) -> list[Changed]:
    """Axes that are answered otherwise today, out of those that had an answer."""
    before = table_of(saved.answers)
    then = {row[AXIS]: row for row in before.filter(pc.is_null(before["error"])).to_pylist()}
    today = [row for batch in read_answers(answers) for row in batch.to_pylist()]
    return [Changed(row[AXIS], then[row[AXIS]], row) for row in today if _differs(then[row[AXIS]], row)]


def _differs(saved: Mapping[str, Any], today: Mapping[str, Any]) -> bool:
    return today["error"] is not None or any(saved[name] != today[name] for name in COMPARED)


# --- Files ------------------------------------------------------------------------------------------------------------


def _csv(table: pa.Table) -> bytes:
    sink = io.BytesIO()
    pacsv.write_csv(table, sink)
    return sink.getvalue()


def _workbook(table: pa.Table, moment: datetime) -> bytes:
    sink = io.BytesIO()
    with xlsxwriter.Workbook(sink, {"in_memory": True, "strings_to_formulas": False, "strings_to_urls": False}) as book:
        book.set_properties({"created": moment.replace(tzinfo=None)})  # the same bytes each time
        sheet = book.add_worksheet("axes")
        sheet.freeze_panes(1, 1)
        sheet.write_row(0, 0, table.column_names, book.add_format({"bold": True}))
        for number, row in enumerate(table.to_pylist(), start=1):
            for place, value in enumerate(row.values()):
                if isinstance(value, str):
                    sheet.write_string(number, place, value)
                elif value is not None:
                    sheet.write_number(number, place, value)
        sheet.autofilter(0, 0, max(table.num_rows, 1), table.num_columns - 1)
        sheet.set_column(0, table.num_columns - 1, 20)
    return sink.getvalue()


FILES: Mapping[str, tuple[str, Callable[[pa.Table, datetime], bytes]]] = {
    "parquet": ("application/vnd.apache.parquet", lambda table, moment: _packed(table)),
    "csv": ("text/csv; charset=utf-8", lambda table, moment: _csv(table)),
    "xlsx": ("application/vnd.openxmlformats-officedocument.spreadsheetml.sheet", _workbook),
}
"""Formats of the answers: their media types, and what writes them."""


FOR_PEOPLE = ("csv", "xlsx")
"""Formats whose reasons are in the reader's language."""


def file_of(saved: SavedFleet, suffix: str, reader: Reader) -> bytes:
    """The answers of a fleet in the format of a suffix, with the columns that `hpn fleet` gives them."""
    table = table_of(saved.answers).drop_columns(NEAREST.names)
    return FILES[suffix][1](_told(table, reader) if suffix in FOR_PEOPLE else table, saved.created)


def _told(table: pa.Table, reader: Reader) -> pa.Table:
    errors = [error and _reasons_in(error, reader) for error in table["error"].to_pylist()]
    return table.set_column(table.column_names.index("error"), "error", pa.array(errors, pa.string()))


def _reasons_in(error: str, reader: Reader) -> str:
    return "; ".join(f"{column}: {reader.told(reason)}" for column, reason in reasons_of(error))

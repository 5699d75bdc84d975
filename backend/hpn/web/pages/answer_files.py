"""Answers of a machine as files for a spreadsheet or a program.

They are made in a process beside the service; it imports this module and no libraries of the web.
"""

import io
from collections.abc import Sequence
from datetime import datetime
from typing import Any

import pyarrow as pa
import pyarrow.csv as pacsv
import pyarrow.types as kinds
import xlsxwriter

from hpn.files.workbook import EveryDigit
from hpn.fleet.faults import Reason, reasons_of
from hpn.fleet.listing import NEAREST
from hpn.fleet.machine import as_parquet
from hpn.fleet.outcome import FAULTS
from hpn.tables.cells import harmless
from hpn.words.reader import Reader

LONGEST_CELL = 32_767
"""Maximum characters in a cell of XLSX."""


def file_of(answers: pa.Table, created: datetime, suffix: str, reader: Reader) -> bytes:
    """Answers of a machine in the format of a suffix, with the columns of `hpn fleet`.

    Reasons are in the reader's language, in Parquet in English.
    """
    table = answers.drop_columns(NEAREST.names)
    if suffix == "parquet":
        return as_parquet(_in_words(table, Reader("en")))
    texts = _in_words(table, reader)
    return _csv(texts) if suffix == "csv" else _workbook(texts, created)


def _in_words(table: pa.Table, reader: Reader) -> pa.Table:
    """Answers with the reasons of rejected axes as texts."""
    errors = [_reasons_in(reasons_of(cell), reader) for cell in table[FAULTS].to_pylist()]
    return table.drop_columns(FAULTS).append_column("error", pa.array(errors, pa.string()))


def _reasons_in(reasons: Sequence[Reason], reader: Reader) -> str | None:
    texts = [(reason.column, reader.sentence(reason.sentence)) for reason in reasons]
    return "; ".join(": ".join(filter(None, each)) for each in texts) or None


def _csv(table: pa.Table) -> bytes:
    """CSV for a spreadsheet, which reads no cell of it as a formula, quoted or not."""
    columns = [
        pa.array(map(harmless, column.to_pylist()), pa.string()) if kinds.is_string(column.type) else column
        for column in table.columns
    ]
    sink = io.BytesIO()
    pacsv.write_csv(pa.Table.from_arrays(columns, names=table.column_names), sink)
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
                _write(sheet, number, place, value)
        sheet.autofilter(0, 0, max(table.num_rows, 1), table.num_columns - 1)
        sheet.set_column(0, table.num_columns - 1, 20)
    return sink.getvalue()


def _write(sheet: Any, row: int, place: int, value: Any) -> None:
    """Write a value; a text is never a formula, and one too long for a cell is cut and ends in `…`."""
    if isinstance(value, str):
        whole = len(value) <= LONGEST_CELL
        sheet.write_string(row, place, value if whole else f"{value[: LONGEST_CELL - 1]}…")
    elif value is not None:
        sheet.write_number(row, place, EveryDigit(value))

"""From an XLSX file to the cells of its sheets: what each cell shows, and of a number every digit.

A workbook is a zip archive of XML: how much it unpacks to is bounded before anything is read.
"""

import zipfile
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, replace
from datetime import time, timedelta
from decimal import Decimal
from fractions import Fraction
from io import BytesIO
from math import inf
from typing import TYPE_CHECKING, Any

from hpn.tables.cells import Figure, Merged, is_number, tidy
from hpn.tables.number_formats import section_of
from hpn.tables.sheets import MOST_CELLS, Grid, RefusedError, grid_of
from hpn.words.wording import N_, Sentence

if TYPE_CHECKING:
    from hpn.tables.worksheets import Span, Worksheet

MAGIC = b"PK\x03\x04"
OLD_MAGIC = b"\xd0\xcf\x11\xe0"
"""First bytes of workbooks before XLSX."""

MAXIMUM_BYTES = 8_000_000
"""Of all its parts, unpacked: several times what the longest cycle takes."""

MOST_PARTS = 300
MOST_SHEETS = 20
MOST_ROWS = 1_048_576
"""Of a sheet, by the format."""


@dataclass(frozen=True, slots=True)
class Sheet:
    """Rows of a sheet, and which of its rows and columns are hidden in the workbook: they are read as well."""

    rows: list[list[str]]
    hidden_rows: str = ""
    hidden_columns: str = ""

    def grid(self) -> Grid:
        """Its cells as a table; raises RefusedError where there are none."""
        notes = [
            Sentence(template, {"hidden": hidden})
            for template, hidden in ((HIDDEN_ROWS, self.hidden_rows), (HIDDEN_COLUMNS, self.hidden_columns))
            if hidden
        ]
        return replace(grid_of(self.rows), notes=tuple(notes))


Sheets = dict[str, Sheet]
HIDDEN_ROWS = N_("Rows that are hidden in the workbook are read, too: {hidden}.")
HIDDEN_COLUMNS = N_("Columns that are hidden in the workbook are read, too: {hidden}.")
MOST_NAMED = 5
"""Stretches of hidden rows or columns that are named."""


def sheets_of(content: bytes) -> Sheets:
    """Cells of each sheet that has any, by its name; raises RefusedError where the file is no workbook."""
    unreadable = RefusedError(N_("the workbook can’t be read: save it as XLSX or CSV"))
    try:
        _require_bounded(content)
        sheets = _read(content)
    except RefusedError:
        raise
    except Exception:  # whatever the library meets in a broken file
        raise unreadable from None
    if not sheets:
        raise RefusedError(N_("there is nothing in the workbook"))
    return sheets


def _require_bounded(content: bytes) -> None:
    with zipfile.ZipFile(BytesIO(content)) as archive:
        parts = archive.infolist()
    # The zip module unpacks no more of a part than is declared here.
    if len(parts) > MOST_PARTS or sum(part.file_size for part in parts) > MAXIMUM_BYTES:
        template = N_("the workbook unpacks to more than {most} MB: save the sheet of the duty cycle alone")
        raise RefusedError(template, most=MAXIMUM_BYTES // 1_000_000)


def _read(content: bytes) -> Sheets:
    import openpyxl  # takes a tenth of a second, which only workbooks need

    from hpn.tables.worksheets import Worksheet

    book = openpyxl.load_workbook(BytesIO(content), read_only=True, data_only=True, keep_links=False)
    sheets: Sheets = {}
    with suppress(AttributeError):  # sheets of charts have no cells
        for sheet in book.worksheets[:MOST_SHEETS]:
            if sheet.sheet_state == "visible" and (read := _sheet(Worksheet(sheet))).rows:
                sheets[sheet.title] = read
    return sheets


def _sheet(sheet: "Worksheet") -> Sheet:
    rows: list[list[str]] = []
    cells = 0
    for number, row in sheet.rows():
        said = _placed(row)
        cells += len(said)
        if cells > MOST_CELLS or number > MOST_ROWS:
            raise _too_many()
        rows += [[] for _ in range(number - 1 - len(rows))]
        rows.append(said)
    while rows and not any(rows[-1]):
        rows.pop()
    _mark_merged(rows, sheet.merged)
    filled = {place for row in rows for place, cell in enumerate(row, start=1) if cell}
    return Sheet(
        rows,
        _stretches((k for k, row in enumerate(rows, start=1) if k in sheet.hidden_rows and any(row)), str),
        _stretches(sheet.hidden_columns(filled), sheet.letters),
    )


def _too_many() -> RefusedError:
    template = N_("there are more than {most} cells: leave out the columns that are not needed")
    return RefusedError(template, most=MOST_CELLS)


def _placed(row: list[Any]) -> list[str]:
    """What the cells of a row say, each in its column, up to the last that says something."""
    said = {cell.column: text for cell in row if (text := _text(cell))}
    return [said.get(place, "") for place in range(1, max(said, default=0) + 1)]


def _mark_merged(rows: list[list[str]], spans: Iterable["Span"]) -> None:
    """Let cells that a merged one with a number covers say so: it may be the number of each of them, or of all.

    A row that is covered altogether says nothing: there a row of the table is several rows high.
    """
    widest = max(map(len, rows), default=0)
    cells = 0
    for span in spans:
        if span.top > len(rows) or span.first > len(rows[span.top - 1]):
            continue
        number = rows[span.top - 1][span.first - 1]
        if not is_number(number):
            continue
        last, bottom = min(span.last, widest), min(span.bottom, len(rows))
        cells += (last - span.first + 1) * (bottom - span.top + 1)
        if cells > MOST_CELLS:
            raise _too_many()
        for row in rows[span.top - 1 : bottom]:
            row += [""] * (last - len(row))
            row[span.first - 1 : last] = [Merged(span.name)] * (last - span.first + 1)
        rows[span.top - 1][span.first - 1] = number
    for row in rows if cells else ():
        if all(isinstance(cell, Merged) for cell in row if cell):
            row.clear()


def _stretches(places: Iterable[int], named: Callable[[int], str]) -> str:
    """Names of rows or columns, those that follow one another as one: `3–5, 9`."""
    found: list[list[int]] = []
    for place in places:
        if found and place == found[-1][1] + 1:
            found[-1][1] = place
        else:
            found.append([place, place])
    texts = [named(a) if a == b else f"{named(a)}–{named(b)}" for a, b in found[:MOST_NAMED]]
    return ", ".join([*texts, *(["…"] if len(found) > MOST_NAMED else [])])


def _text(cell: Any) -> str:
    """What a cell says. A number keeps all its digits, and the unit that its format shows with it."""
    value = cell.value
    if value is None:
        return ""
    if isinstance(value, time | timedelta) and "s" in str(cell.number_format).lower():
        return Figure(f"{_seconds(value)} s")
    if isinstance(value, bool) or not isinstance(value, int | float) or abs(value) == inf:
        return tidy(str(value))  # an infinite one, such as 1e999, is no number
    written = str(cell.number_format)
    section = section_of(written, value)
    if section is None:
        return Figure(f"{_plain(value)} {written}")
    if section.percent:
        return Figure(f"{Decimal(repr(value)).scaleb(2):f} %")
    scaled = float(Fraction(value) / 1000**section.thousands) if section.thousands else value
    return Figure(f"{_plain(scaled)} {section.unit}".strip())


def _seconds(value: time | timedelta) -> str:
    if isinstance(value, time):
        value = timedelta(hours=value.hour, minutes=value.minute, seconds=value.second, microseconds=value.microsecond)
    return _plain(value.total_seconds())


def _plain(number: float) -> str:
    return repr(float(number)).removesuffix(".0")

"""From an XLSX file to the cells of its sheets: the text of each cell, and every digit of a number.

A workbook is a zip archive of XML: its unpacked size is checked before it is read.
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
from warnings import catch_warnings

from hpn.tables.cells import THOUSANDS, Figure, Merged, Spanning, is_number, tidy, written
from hpn.tables.number_formats import LONGEST_FORMAT, section_of
from hpn.tables.sheets import LONGEST_TEXT, MOST_CELLS, CellBudget, Grid, RefusedError, grid_of, too_many_cells
from hpn.words.wording import N_, Sentence, first_of

if TYPE_CHECKING:
    from hpn.tables.worksheets import Span, Worksheet

MAGIC = b"PK\x03\x04"
OLD_MAGIC = b"\xd0\xcf\x11\xe0"
"""First bytes of workbooks before XLSX."""

MAXIMUM_BYTES = 8_000_000
"""Bytes of all its parts, unpacked: several times the longest cycle."""

MOST_PARTS = 300
MOST_SHEETS = 20
LONGEST_NAME = 100
"""Characters of a sheet's name; spreadsheet programs write 31."""

MOST_ROWS = 1_048_576
"""Rows of a sheet, the limit of the format."""

MOST_CELLS_OF_BOOK = 2 * MOST_CELLS
MOST_WRITTEN_CELLS = 500_000
"""Cells of a workbook; and cells of a sheet in the file, including blank cells with a format."""

COUNTED = (
    ("styles.xml", b"<", 250_000, N_("styles")),  # 64,000 formats of cells are the most that Excel writes
    ("sharedStrings.xml", b"<si", MOST_CELLS_OF_BOOK, N_("texts")),
    ("sharedStrings.xml", b"<", 4 * MOST_CELLS_OF_BOOK, N_("texts")),
    ("worksheets/", b"<c", MOST_WRITTEN_CELLS, N_("cells")),
    ("worksheets/", b"<row", MOST_WRITTEN_CELLS, N_("rows")),
    ("worksheets/", b"<mergeCell", 20_000, N_("merged cells")),
    ("worksheets/", b"<conditionalFormatting", 20_000, N_("conditional formats")),
    ("worksheets/", b"<", 4 * MOST_WRITTEN_CELLS, N_("cells")),
    ("workbook.xml", b"<", 50_000, N_("names")),
    (".rels", b"<", 10_000, N_("parts")),
    ("[Content_Types].xml", b"<", 10_000, N_("parts")),
    ("docProps/", b"<", 10_000, N_("properties")),
    ("theme/", b"<", 50_000, N_("styles")),
)
"""Limits on marks in the parts of a file, by a piece of the part's name: a reader needs far more time and memory for
these than their bytes suggest. A file may hide them under other names; then the limits of the process stop it.
"""


@dataclass(frozen=True, slots=True)
class Sheet:
    """Rows of a sheet and their numbers; rows and columns that are hidden in the workbook are read as well."""

    rows: list[list[str]]
    numbers: list[int]
    hidden_rows: str = ""
    hidden_columns: str = ""

    def grid(self) -> Grid:
        """Its cells as a table; raises RefusedError without any."""
        notes = [
            Sentence(template, {"hidden": hidden})
            for template, hidden in ((HIDDEN_ROWS, self.hidden_rows), (HIDDEN_COLUMNS, self.hidden_columns))
            if hidden
        ]
        return replace(grid_of(self.rows, numbers=self.numbers), notes=tuple(notes))


Sheets = dict[str, Sheet]
HIDDEN_ROWS = N_("Rows that are hidden in the workbook are read, too: {hidden}.")
HIDDEN_COLUMNS = N_("Columns that are hidden in the workbook are read, too: {hidden}.")
MOST_NAMED = 5
"""Ranges of hidden rows or columns that a note names."""


def sheets_of(content: bytes) -> Sheets:
    """Cells of each sheet that is not empty, by its name; raises RefusedError for an unreadable or empty workbook."""
    unreadable = RefusedError(N_("the workbook can’t be read: save it as XLSX or CSV"))
    try:
        _require_bounded(content)
        sheets = _sheets_in(content)
    except (RefusedError, MemoryError):
        raise
    except Exception:  # any error of the library in a broken file
        raise unreadable from None
    if not sheets:
        raise RefusedError(N_("the workbook is empty"))
    return sheets


def _require_bounded(content: bytes) -> None:
    with zipfile.ZipFile(BytesIO(content)) as archive:
        parts = archive.infolist()
        if len(parts) > MOST_PARTS:
            raise _too_many(N_("parts"))
        # The zip module never unpacks more of a part than its declared size.
        if sum(part.file_size for part in parts) > MAXIMUM_BYTES:
            template = N_("the workbook unpacks to more than {most} MB: save the sheet of the duty cycle alone")
            raise RefusedError(template, most=MAXIMUM_BYTES // 1_000_000)
        for part in parts:
            _require_few(part.filename, archive.read(part))


def _require_few(name: str, part: bytes) -> None:
    for place, mark, most, what in COUNTED:
        if place in name and part.count(mark) > most:
            raise _too_many(what)


def _too_many(what: str) -> RefusedError:
    template = N_("the workbook has too many {what}: copy the cells into a new one, or save the sheet as CSV")
    return RefusedError(template, what=Sentence(what))


def _sheets_in(content: bytes) -> Sheets:
    import openpyxl  # takes a tenth of a second: only for workbooks

    from hpn.tables.worksheets import Worksheet

    with catch_warnings(action="ignore"):  # of missing styles and other parts without effect on cells
        book = openpyxl.load_workbook(BytesIO(content), read_only=True, data_only=True, keep_links=False)
    sheets: Sheets = {}
    room = CellBudget(MOST_CELLS_OF_BOOK)
    with suppress(AttributeError):  # sheets of charts have no cells
        for sheet in book.worksheets[:MOST_SHEETS]:
            if sheet.sheet_state == "visible" and (grid := _sheet(Worksheet(sheet), room)).rows:
                sheets[sheet.title[:LONGEST_NAME]] = grid
    return sheets


def _sheet(sheet: "Worksheet", room: CellBudget) -> Sheet:
    rows, own, last = dict[int, list[str]](), CellBudget(), 0
    for number, row in sheet.rows():
        last = max(number, last + 1)  # a repeated number continues below
        if last > MOST_ROWS:
            raise too_many_cells()
        if cells := _texts_of(row):
            own.take(cells)
            room.take(cells)
            rows[last] = cells
    rows = _with_merged(rows, sheet.merged)
    filled = {place for row in rows.values() for place, cell in enumerate(row, start=1) if cell}
    return Sheet(
        list(rows.values()),
        list(rows),
        _stretches((k for k, row in rows.items() if k in sheet.hidden_rows and any(row)), str),
        _stretches(sheet.hidden_columns(filled), sheet.letters),
    )


def _texts_of(row: list[Any]) -> list[str]:
    """Texts of the cells of a row, each in its column, up to the last filled one."""
    cells = {cell.column: text for cell in row if (text := _text(cell))}
    return [cells.get(place, "") for place in range(1, max(cells, default=0) + 1)]


def _with_merged(rows: dict[int, list[str]], spans: Iterable["Span"]) -> dict[int, list[str]]:
    """Rows in which the cells below a merged number are marked as Merged: the number may belong to each cell or to all.

    A row with no other cells becomes empty: there a row of the table is several rows high. A merged text keeps its
    width in columns.
    """
    widest, lowest = max(map(len, rows.values()), default=0), max(rows, default=0)
    cells = 0
    for span in spans:
        if len(rows.get(span.top, ())) < span.first:
            continue
        if not is_number(number := rows[span.top][span.first - 1]):
            if span.top == span.bottom and number:
                rows[span.top][span.first - 1] = text = Spanning(number)
                text.columns = span.last - span.first + 1
            continue
        last, bottom = min(span.last, widest), min(span.bottom, lowest)
        cells += (last - span.first + 1) * (bottom - span.top + 1)
        if cells > MOST_CELLS:
            raise too_many_cells()
        for place in range(span.top, bottom + 1):
            row = rows.setdefault(place, [])
            row += [""] * (last - len(row))
            row[span.first - 1 : last] = [Merged(span.name)] * (last - span.first + 1)
        rows[span.top][span.first - 1] = number
    for row in rows.values() if cells else ():
        if all(isinstance(cell, Merged) for cell in row if cell):
            row.clear()
    return dict(sorted(rows.items()))


def _stretches(places: Iterable[int], named: Callable[[int], str]) -> str:
    """Names of rows or columns, consecutive ones as a range: `3–5, 9`."""
    stretches: list[list[int]] = []
    for place in places:
        if stretches and place == stretches[-1][1] + 1:
            stretches[-1][1] = place
        else:
            stretches.append([place, place])
    texts = [named(a) if a == b else f"{named(a)}–{named(b)}" for a, b in stretches]
    return first_of(texts, MOST_NAMED)


def _text(cell: Any) -> str:
    """Text of a cell. A number keeps all its digits, and has the unit of its format."""
    value = cell.value
    if value is None:
        return ""
    if isinstance(value, time | timedelta):
        seconds = _seconds(value)
        # Without seconds it may mean minutes and seconds, and stays as shown.
        return Figure(f"{written(seconds)} s") if "s" in str(cell.number_format).lower() else _without_seconds(seconds)
    if isinstance(value, bool) or not isinstance(value, int | float) or abs(value) == inf:
        text = str(value)
        return tidy(text) if len(text) <= LONGEST_TEXT else text  # 1e999 is infinite and no number
    shown_as = str(cell.number_format)
    section = section_of(shown_as, value)
    if section is None:
        return Figure(f"{written(value)} {shown_as[:LONGEST_FORMAT]}")
    if section.percent:
        return Figure(f"{Decimal(repr(value)).scaleb(2):f} %")
    if section.thousands and not section.unit:
        return Figure(f"{written(value)} {THOUSANDS}{1000**section.thousands}")
    scaled = float(Fraction(value) / 1000**section.thousands) if section.thousands else value
    return Figure(f"{written(scaled)} {section.unit}".strip())


def _seconds(value: time | timedelta) -> float:
    if isinstance(value, time):
        value = timedelta(hours=value.hour, minutes=value.minute, seconds=value.second, microseconds=value.microsecond)
    return value.total_seconds()


def _without_seconds(seconds: float) -> str:
    hours, minutes = divmod(int(abs(seconds) // 60), 60)
    return f"{'-' if seconds < 0 else ''}{hours}:{minutes:02d}"

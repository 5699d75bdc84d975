"""From an XLSX file to the cells of its sheets: what each cell shows, and of a number every digit.

A workbook is a zip archive of XML: how much it unpacks to is bounded before anything is read.
"""

import re
import zipfile
from contextlib import suppress
from decimal import Decimal
from fractions import Fraction
from io import BytesIO
from math import inf
from typing import Any

from hpn.web.form.cells import Figure, tidy
from hpn.web.form.sheets import MOST_CELLS, RefusedError
from hpn.wording import N_

MAGIC = b"PK\x03\x04"
OLD_MAGIC = b"\xd0\xcf\x11\xe0"
"""First bytes of workbooks before XLSX."""

MAXIMUM_BYTES = 8_000_000
"""Of all its parts, unpacked: several times what the longest cycle takes."""

MOST_PARTS = 300
MOST_SHEETS = 20

Sheets = dict[str, list[list[str]]]
_LITERAL = re.compile(r'"([^"]*)"|\\(.)')
_SCALED = re.compile(r"[0#?](,+)(?![0#?,])")


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

    book = openpyxl.load_workbook(BytesIO(content), read_only=True, data_only=True, keep_links=False)
    sheets: Sheets = {}
    with suppress(AttributeError):  # sheets of charts have no cells
        for sheet in book.worksheets[:MOST_SHEETS]:
            if sheet.sheet_state == "visible" and (rows := _rows(sheet)):
                sheets[sheet.title] = rows
    return sheets


def _rows(sheet: Any) -> list[list[str]]:
    sheet.reset_dimensions()  # what the file says of its size need not be so
    rows: list[list[str]] = []
    cells = 0
    for row in sheet.iter_rows():
        said = [_text(cell) for cell in row]
        while said and not said[-1]:
            said.pop()
        rows.append(said)
        cells += len(said)
        if cells > MOST_CELLS:
            raise RefusedError(
                N_("there are more than {most} cells: leave out the columns that are not needed"), most=MOST_CELLS
            )
    while rows and not any(rows[-1]):
        rows.pop()
    return rows


def _text(cell: Any) -> str:
    """What a cell says. A number keeps all its digits, and the unit that its format shows behind it."""
    value = cell.value
    if value is None:
        return ""
    if isinstance(value, bool) or not isinstance(value, int | float) or abs(value) == inf:
        return tidy(str(value))  # an infinite one, such as 1e999, is no number
    section = str(cell.number_format).split(";")[0]
    unit = "".join(a or b for a, b in _LITERAL.findall(section)).strip()
    bare = re.sub(r"\[[^\]]*\]", "", _LITERAL.sub("", section))
    if "%" in bare:
        return Figure(f"{Decimal(repr(value)).scaleb(2):f} %")
    scaled = _SCALED.search(bare)
    number = float(Fraction(value) / 1000 ** len(scaled[1])) if scaled else float(value)
    return Figure(f"{repr(number).removesuffix('.0')} {unit}".strip())

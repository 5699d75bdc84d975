"""Workbook: its rows, the parts on its hidden sheet, and its link."""

from collections.abc import Iterator, Mapping
from io import BytesIO
from typing import Any

import openpyxl
from openpyxl.utils import get_column_letter
from openpyxl.worksheet.worksheet import Worksheet

from hpn.files.workbook.workbook import CARRIED
from hpn.verify.archive import unpacked
from hpn.verify.shown import FileLine, UnreadableFileError

MOST_CELLS = 2_000_000
"""Most cells of all sheets, with blank ones inside their frames."""


def _sheets(content: bytes, *, values: bool) -> list[Worksheet]:
    unpacked(content, form="workbook")
    try:
        book = openpyxl.load_workbook(BytesIO(content), data_only=values)
        sheets: list[Worksheet] = list(book.worksheets)
    except Exception as error:  # damaged files raise errors of every kind
        raise UnreadableFileError.of("workbook", error) from None
    if sum(sheet.max_row * sheet.max_column for sheet in sheets) > MOST_CELLS:
        raise UnreadableFileError(f"the workbook has more than {MOST_CELLS} cells")
    return sheets


def parts_of(content: bytes) -> Mapping[str, bytes]:
    """Parts that a workbook carries, by their names."""
    rows = (sheet.iter_rows(values_only=True) for sheet in _sheets(content, values=True) if sheet.title == CARRIED)
    return {str(name): "".join(map(str, filter(None, cells))).encode() for sheet in rows for name, *cells in sheet}


def lines_of(content: bytes) -> Iterator[FileLine]:
    """Rows of its sheets: values with every digit, and `behind` their columns and formulas."""
    for values, formulas in zip(_sheets(content, values=True), _sheets(content, values=False), strict=True):
        if values.title == CARRIED:
            continue
        for row, behind in zip(values.iter_rows(), formulas.iter_rows(), strict=True):
            texts = [_written(cell.value) for cell in row]
            live = [cell.value for cell in behind if isinstance(cell.value, str) and cell.value.startswith("=")]
            if any(texts):
                columns = [get_column_letter(number) for number, text in enumerate(texts, 1) if text]
                place, text = f"{values.title}, row {row[0].row}", " | ".join(filter(None, texts))
                yield FileLine(place, text, " ".join([*columns, *live]))


def _written(value: Any) -> str:
    if value is None:
        return ""
    return repr(float(value)) if isinstance(value, int | float) and not isinstance(value, bool) else str(value).strip()


def links_of(content: bytes) -> list[str]:
    """Addresses that fill a cell of their own."""
    cells = (cell.value for sheet in _sheets(content, values=True) for row in sheet.iter_rows() for cell in row)
    return [value for value in cells if isinstance(value, str) and value.startswith(("http://", "https://"))]

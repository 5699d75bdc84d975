"""Worksheets as openpyxl parses them, plus formulas without a result, merged cells and hidden rows and columns.

Only requests with a workbook import this module, and with it openpyxl.
"""

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Any

from openpyxl.cell.read_only import ReadOnlyCell
from openpyxl.utils import get_column_letter
from openpyxl.worksheet._reader import FORMULA_TAG, VALUE_TAG, WorkSheetParser


@dataclass(frozen=True, slots=True)
class Span:
    """Merged cells: their name such as `D2:D4`, and the first and last of their columns and rows, from 1."""

    name: str
    first: int
    top: int
    last: int
    bottom: int


class Worksheet:
    """A sheet of a workbook opened read-only, parsed once.

    Merged cells, hidden rows and hidden columns are known after the last row.
    """

    def __init__(self, sheet: Any) -> None:
        self._sheet = sheet
        self.merged: list[Span] = []
        self.hidden_rows: set[int] = set()
        self._hidden: list[tuple[int, int]] = []

    def rows(self) -> Iterator[tuple[int, list[ReadOnlyCell]]]:
        """Number and cells of each row in the file."""
        book = self._sheet.parent
        with self._sheet._get_source() as source:
            parser = _Parser(
                source,
                self._sheet._shared_strings,
                data_only=True,
                epoch=book.epoch,
                date_formats=book._date_formats,
                timedelta_formats=book._timedelta_formats,
            )
            for number, cells in parser.parse():
                yield number, [ReadOnlyCell(self._sheet, **cell) for cell in cells]
        merged = parser.merged_cells.mergeCell if parser.merged_cells else ()
        self.merged = [Span(each.coord, *each.bounds) for each in merged]
        self.hidden_rows = {int(row) for row, style in parser.row_dimensions.items() if _is_hidden(style)}
        columns = filter(_is_hidden, parser.column_dimensions.values())
        self._hidden = sorted((int(style["min"]), int(style["max"])) for style in columns)

    def hidden_columns(self, places: Collection[int]) -> Iterator[int]:
        """Hidden columns among some places."""
        spans = iter(self._hidden)
        first, last = 0, 0
        for place in sorted(places):
            while last < place and (span := next(spans, None)):
                first, last = span
            if first <= place <= last:
                yield place

    @staticmethod
    def letters(place: int) -> str:
        """Letters of a column."""
        return str(get_column_letter(place))


class _Parser(WorkSheetParser):
    """Parser of openpyxl, except that a formula without a result is a text rather than a blank."""

    def parse_cell(self, element: Any) -> dict[str, Any]:
        """A cell with its value, or with the text of a formula that has no result."""
        cell: dict[str, Any] = super().parse_cell(element)
        formula = element.find(FORMULA_TAG)
        # An empty text is a result, too.
        if formula is not None and not element.findtext(VALUE_TAG) and element.get("t") != "str":
            cell |= {"value": f"={formula.text or ''}", "data_type": "s"}
        return cell


def _is_hidden(attributes: dict[str, str]) -> bool:
    return attributes.get("hidden") in ("1", "true")

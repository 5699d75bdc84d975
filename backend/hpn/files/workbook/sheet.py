"""Sheet of the workbook, written from the top: its styles, its tables and its page."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from io import BytesIO
from typing import Any, Protocol

import xlsxwriter

from hpn.account.lines import Line, LineTable, with_values
from hpn.files.export import LOWER_BOUND, Export, ExportTitle
from hpn.files.words import Paper, paper
from hpn.files.workbook import EveryDigit
from hpn.words.reader import Reader
from hpn.words.units import symbol_of
from hpn.words.wording import N_

FONT = {"font_name": "Arial", "font_size": 10}
"""Font with the same widths in every office program, so that pages break alike."""

ACCENT, QUIET = "#0B5394", "#5B6875"
FIGURE = "[>=10000000]0.00E+00;[>=10000]#,##0;#,##0.00##"
"""Number format that fits the column (a longer number would show as hashes); above 10,000 no decimals matter."""

_HEAD = {"bold": True, "font_color": "#FFFFFF", "bg_color": ACCENT, "text_wrap": True, "valign": "top"}

STYLES: Mapping[str, Mapping[str, Any]] = {
    "title": {"bold": True, "font_size": 14},
    "section": {"bold": True, "font_color": ACCENT, "font_size": 11},
    "head": _HEAD,
    "head of numbers": {**_HEAD, "align": "right"},
    "label": {"valign": "top"},
    "quiet": {"font_color": QUIET, "valign": "top"},
    "unit": {"font_color": QUIET, "valign": "top", "indent": 1},
    "wrap": {"text_wrap": True, "valign": "top"},
    "figure": {"num_format": FIGURE, "align": "right", "valign": "top"},
    "share": {"num_format": "0.00%", "align": "right", "valign": "top"},
    "input": {"bg_color": "#FFF8DC", "border": 1, "border_color": "#D5DBE1", "locked": False, "num_format": FIGURE},
    "pass": {"font_color": "#1B7F3B", "bg_color": "#E6F4EA", "valign": "top", "indent": 1},
    "fail": {"font_color": "#B3261E", "bg_color": "#FCE8E6", "valign": "top", "indent": 1},
    "open": {"font_color": "#8A6100", "bg_color": "#FFF4D6", "valign": "top", "indent": 1},
}

VERDICT_STYLES: Mapping[str, str] = {
    **dict.fromkeys(("pass", "suitable"), "pass"),
    **dict.fromkeys(("fail", "unsuitable"), "fail"),
    **dict.fromkeys(("not_rated", "unrated"), "open"),
}
"""Style of a verdict on a check or candidate."""

PAPERS: Mapping[Paper, int] = {"a4": 9, "us-letter": 1}
"""Numbers of paper sizes in the file format."""

LONGEST_HEADER_TEXT, LONGEST_FOOTER_LINK = 100, 100
HEAD_AND_FOOT = {"margin": 0.25}
"""Distance from the edge of the paper, in inches."""

LONGEST_TEXT = 32_000
"""Most characters of a cell; the file format has room for 32,767."""

ROW_POINTS = 12.75

Cell = float | str | None


class Titled(Protocol):
    """Contents of head and foot of a workbook's pages: title block, time of saving and link."""

    @property
    def heading(self) -> ExportTitle:
        """Title block."""

    @property
    def created(self) -> datetime | None:
        """Moment of saving; None for an unsaved document."""

    @property
    def link(self) -> str:
        """Absolute address."""


@dataclass
class Leaf:
    """Sheet that is written from the top, in its reader's language and units; `row` is the next row."""

    sheet: Any
    styles: Mapping[str, Any]
    export: Titled
    reader: Reader
    row: int = 0

    def put(self, column: int, value: Cell, style: str = "label") -> None:
        """Write a cell: a number with all of its digits, or a text; an empty text writes a blank, None writes
        nothing."""
        if value == "":
            self.sheet.write_blank(self.row, column, None, self.styles[style])
        elif isinstance(value, str):
            self.sheet.write_string(self.row, column, value[:LONGEST_TEXT], self.styles[style])
        elif value is not None:
            self.sheet.write_number(self.row, column, EveryDigit(value), self.styles[style])

    def heads(self, title: str, *heads: str, numbers: Sequence[int] = ()) -> None:
        """Begin a table; headings of numbers are aligned right."""
        self.row += 1
        self.put(0, self.reader.text(title), "section")
        self.row += 1
        for column, head in enumerate(heads):
            self.put(column, head, "head of numbers" if column in numbers else "head")
        self.row += bool(heads)

    def note(self, text: str, widths: Sequence[float]) -> None:
        """Write a text across columns, with its row's height: no office program fits a merged row to its text."""
        self.sheet.merge_range(self.row, 0, self.row, len(widths) - 1, text, self.styles["wrap"])
        self.sheet.set_row(self.row, ROW_POINTS * (1 + len(text) // int(sum(widths))))
        self.row += 1

    def head(self, text: str, field: str) -> str:
        """Heading of a column of numbers: a text or symbol, with the unit that the reader sees."""
        unit = self.reader.unit(symbol_of(field))
        return f"{text} [{unit}]" if unit else text

    def page(self, widths: Sequence[float], *, across: bool = False, pages: int = 1, columns: int = 0) -> None:
        """Set up columns and page: print the first `columns` columns, or all, on `pages` pages beside each other."""
        for column, width in enumerate(widths):
            self.sheet.set_column(column, column, width)
        if across:
            self.sheet.set_landscape()
        self.sheet.set_paper(PAPERS[paper(self.reader)])
        self.sheet.set_margins(left=0.5, right=0.4, top=0.6, bottom=0.6)
        self.sheet.print_area(0, 0, self.sheet.dim_rowmax, columns - 1 if columns else self.sheet.dim_colmax)
        self.sheet.fit_to_pages(pages, 0)
        heading, text = self.export.heading, self.reader.text
        revision = f"{text(N_('Revision'))} {heading.revision}" if heading.revision else ""
        title = ", ".join(filter(None, (heading.title, heading.reference, revision)))
        saved = self.reader.date(self.export.created) if self.export.created else ""
        link = self.export.link if len(self.export.link) <= LONGEST_FOOTER_LINK else ""
        numbers = text(N_("Page {page} of {pages}")).format(page="&P", pages="&N")
        self.sheet.set_header(
            f"&L{_plain(' '.join(title.split())[:LONGEST_HEADER_TEXT])}&R{_plain(saved)}", HEAD_AND_FOOT
        )
        self.sheet.set_footer(f"&LHPN Select {_plain(link)}&R{numbers}", HEAD_AND_FOOT)


@dataclass
class SelectionSheet(Leaf):
    """Sheet of a selection."""

    export: Export

    def lines(self, title: str, lines: Iterable[Line]) -> None:
        """Write a table of the quantities that have a value; nothing where there is none."""
        with_value, reader = with_values(lines), self.reader
        if not with_value:
            return
        self.heads(title)
        for line in with_value:
            self.put(0, line.label(reader))
            self.put(1, line.named.symbol, "quiet")
            self.put(2, line.value_for(reader), "figure")
            self.put(3, reader.unit(line.unit) if isinstance(line.value, float | int) else "", "unit")
            self.put(4, reader.text(LOWER_BOUND) if line.is_lower_bound else line.where(reader), "quiet")
            self.row += 1

    def table(self, title: str, table: LineTable) -> None:
        """Write a table of columns by their headings, each with the unit of its numbers."""
        text, columns = self.reader.text, table.columns
        heads = [self.head(c.head.named.symbol or c.head.label(self.reader), c.head.code) for c in columns]
        first = len(table.labels)
        self.heads(title, *map(text, table.labels), *heads, numbers=range(1, first + len(heads)))
        for place, labels in enumerate(zip(*table.labels.values(), strict=True)):
            for column, label in enumerate(labels):
                self.put(column, label, "figure" if column else "quiet")
            for column, each in enumerate(columns, first):
                self.put(column, each.head.of(each.values[place]).value_for(self.reader), "figure")
            self.row += 1


def _plain(text: str) -> str:
    """Text for a header or footer, where & begins a command: each & is doubled."""
    return text.replace("&", "&&")


# --- The book ---------------------------------------------------------------------------------------------------------

UNDATED = datetime(1980, 1, 1)
"""Creation time of a workbook of an unsaved document: the earliest that its container can hold."""


def new_book(content: BytesIO, export: Titled) -> tuple[Any, Mapping[str, Any]]:
    """Workbook and its styles; the same bytes for the same content."""
    options = {"in_memory": True, "strings_to_formulas": False, "strings_to_urls": False, "nan_inf_to_errors": False}
    book = xlsxwriter.Workbook(content, options | {"default_format_properties": dict(FONT)})
    created = export.created.astimezone(UTC).replace(tzinfo=None) if export.created else UNDATED
    author = export.heading.author or "HPN Select"
    book.set_properties({"title": export.heading.title, "author": author, "created": created})
    book.set_calc_mode("auto")
    return book, {name: book.add_format({**FONT, **style}) for name, style in STYLES.items()}

"""Styles and ways of writing that all sheets of the workbook use, and the table of the duty cycle."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from xlsxwriter.utility import xl_range_abs, xl_rowcol_to_cell

from hpn.application.input_fields import PHASE_FIELDS, PHASE_FIGURES
from hpn.files.export import Export
from hpn.files.words import Paper, paper
from hpn.files.workbook import EveryDigit
from hpn.files.workbook.formulas import NONE, cell_name
from hpn.files.workbook.wrong import BENEATH, advice, is_wrong_in_phase, validation
from hpn.words.quantities import INPUTS
from hpn.words.reader import Reader
from hpn.words.titles import row_label
from hpn.words.units import symbol_of
from hpn.words.wording import N_

ACCENT = "#0B5394"
FIGURE = "[>=10000000]0.00E+00;[>=10000]#,##0;#,##0.00##"
"""Number format that fits the column, which would show hashes otherwise; above 10,000 no decimals matter."""

COUNTS = {"N_k_max", "momentary_peak_count"}
"""Figures and checks whose numbers are whole."""

_HEAD = {"bold": True, "font_color": "#FFFFFF", "bg_color": ACCENT, "text_wrap": True}

STYLES: dict[str, dict[str, Any]] = {
    "title": {"bold": True, "font_size": 14},
    "section": {"bold": True, "font_color": ACCENT, "font_size": 11},
    "head": {**_HEAD, "valign": "top"},
    "head of numbers": {**_HEAD, "valign": "top", "align": "right"},
    "head of words": {**_HEAD, "valign": "top", "indent": 1},
    "turned": {**_HEAD, "rotation": 90},
    "label": {"valign": "top"},
    "number": {"font_color": "#5B6875", "align": "left"},
    "quiet": {"font_color": "#5B6875", "valign": "top"},
    "source": {"font_color": "#5B6875", "valign": "top", "indent": 1},
    "unit": {"font_color": "#5B6875", "valign": "top", "indent": 1},
    "wrap": {"text_wrap": True, "valign": "top"},
    "input": {"bg_color": "#FFF8DC", "border": 1, "border_color": "#D5DBE1", "locked": False},
    "figure": {"bg_color": "#F3F6F9"},
    "result": {"num_format": FIGURE, "valign": "top"},
    "shown": {"num_format": FIGURE, "font_color": "#5B6875"},
    "count": {"num_format": "[>=10000000]0.00E+00;#,##0", "valign": "top"},
    "share": {"num_format": "0.00%", "valign": "top", "shrink": True},
    "fixed": {"num_format": FIGURE, "italic": True, "font_color": "#8A6100", "valign": "top"},
    "wrong": {"font_color": "#B3261E", "valign": "top"},
    "verdict": {"bold": True, "valign": "top", "shrink": True},
    "word": {"bold": True, "valign": "top", "indent": 1},
}
"""Yellow cells are inputs; amber italics are values that a formula can't give."""

PASSED, FAILED, OPEN = (
    {"font_color": "#1B7F3B", "bg_color": "#E6F4EA"},
    {"font_color": "#B3261E", "bg_color": "#FCE8E6"},
    {"font_color": "#8A6100", "bg_color": "#FFF4D6"},
)
COLOURS: Mapping[str, Mapping[str, str]] = {
    "passes": PASSED,
    "suitable": PASSED,
    "fails": FAILED,
    "unsuitable": FAILED,
    "not rated": OPEN,
    "unrated": OPEN,
}
"""Colours of verdicts, which follow the formulas."""

PAPERS: Mapping[Paper, int] = {"a4": 9, "us-letter": 1}
"""Numbers of the sizes of paper in the file format."""

FONT = {"font_name": "Arial", "font_size": 10}
"""A font that has the same widths in every office program, so that pages break alike."""

ROW_POINTS, ROWS_ON_PAGE, ROWS_ACROSS = 12.75, 83, 48
"""Height of a row, and how many of them a page holds at 7 points: upright, and below a high head across."""

LEAST_SCALE = 70
"""Scale in per cent at which letters of 10 points have 7."""

LONGEST_HEADER_TEXT = 100
LONGEST_FOOTER_LINK = 100
HEAD_AND_FOOT = {"margin": 0.25}
"""Distance from the edge of the paper, in inches."""

WIDTH = 11.5
"""Width of a column of the duty cycle, in characters."""

SPARE_PHASES = 20

MOST_BENEATH = 10_000
"""Rows beneath the last spare one in which no phase may stand."""

VARYING = ("peak_torque_Nm", "peak_speed_rpm", "rms_torque_Nm")
"""Columns that are folded unless a phase has a value in one of them."""

FOLDED = {"level": 1, "hidden": True}
USED = {"radial_used": "radial_N", "axial_used": "axial_N"}
"""Columns of the loads that apply in a phase: name and field."""


@dataclass
class Book:
    """A workbook while it is written. Its formulas compute in the units of the wire, those of `reader`; a value that
    `shown` reads in another unit is converted by a formula in a cell beside it.
    """

    file: Any
    export: Export
    reader: Reader
    shown: Reader
    words: Mapping[str, str]
    styles: dict[str, Any] = field(default_factory=dict)

    def style(self, name: str) -> Any:
        """One of STYLES."""
        if name not in self.styles:
            self.styles[name] = self.file.add_format(STYLES[name])
        return self.styles[name]

    def put(self, sheet: Any, row: int, column: int, value: float | str | None, style: str) -> None:
        """Write a value into a cell: a number with every digit, a text as it stands; None leaves the cell blank."""
        if value is None or value == "":
            sheet.write_blank(row, column, None, self.style(style))
        elif isinstance(value, str):
            sheet.write_string(row, column, value, self.style(style))
        else:
            sheet.write_number(row, column, EveryDigit(value), self.style(style))

    def number(self, sheet: Any, row: int, place: int, name: str | None) -> None:
        """Write the number of a phase or a move into the first cell of its row, with its name where it has one."""
        self.put(sheet, row, 0, row_label(place, name) if name else float(place + 1), "number")

    def head(self, text: str, unit: str) -> str:
        """Head of a column: a text or symbol, with a unit if there is one."""
        return f"{text} [{self.reader.unit(unit)}]" if unit else text

    def converted(self, sheet: Any, row: int, column: int, source: str, unit: str, value: float | str | None) -> bool:
        """Write the value of a cell in the reader's unit; nothing, and False, where that is the wire's."""
        measure = self.shown.measure(unit)
        if measure.same:
            return False
        formula = f'=IF(ISNUMBER({source}),{source}*{float(measure.factor)!r}+{float(measure.offset)!r},"")'
        saved = measure.shown(value) if isinstance(value, int | float) else ""
        sheet.write_formula(row, column, formula, self.style("shown"), saved)
        return True

    def colour(self, sheet: Any, *block: int) -> None:
        """Colour the verdicts of a block of cells by their present text."""
        for word, look in COLOURS.items():
            rule = {"type": "cell", "criteria": "==", "value": f'"{self.words[word]}"'}
            sheet.conditional_format(*block, rule | {"format": self.file.add_format(look)})

    def colour_failures(self, sheet: Any, *block: int, bound: str) -> None:
        """Colour the utilisations of a block that are beyond a bound, fail without a number or are an error."""
        first = xl_rowcol_to_cell(*block[:2])
        failed = f'=IF(ISERROR({first}),TRUE,OR(AND(ISNUMBER({first}),{first}>{bound}*(1+1E-12)),{first}="{NONE}"))'
        look = self.file.add_format(FAILED)
        sheet.conditional_format(*block, {"type": "formula", "criteria": failed, "format": look})

    def refuse(self, sheet: Any, *block: int, wrong: str, validation: Mapping[str, Any]) -> None:
        """Colour the cells of a block that a formula on its first cell finds wrong, and refuse wrong entries."""
        rule = {"type": "formula", "criteria": f"=IFERROR({wrong},1)>0", "format": self.file.add_format(FAILED)}
        sheet.conditional_format(*block, rule)
        sheet.data_validation(*block, validation)

    def page(self, sheet: Any, *, columns: int = 0, landscape: bool = False, second: int = 0) -> None:
        """Set up a sheet for printing: its first columns, or all, with a head and a foot.

        They stand on one page across, or those from `second` on beside the first column on another.
        """
        if landscape:
            sheet.set_landscape()
        sheet.set_paper(PAPERS[paper(self.shown)])
        sheet.set_margins(left=0.5, right=0.4, top=0.6, bottom=0.6)
        sheet.print_area(0, 0, sheet.dim_rowmax, columns - 1 if columns else sheet.dim_colmax)
        sheet.set_default_row(ROW_POINTS)
        sheet.fit_to_pages(1, -(-sheet.dim_rowmax // (ROWS_ACROSS if landscape else ROWS_ON_PAGE)))
        if second:
            sheet.set_print_scale(LEAST_SCALE)
            sheet.set_v_pagebreaks([second])
            sheet.repeat_columns(0)
        heading, text = self.export.heading, self.reader.text
        revision = f"{text(N_('Revision'))} {heading.revision}" if heading.revision else ""
        title = ", ".join(filter(None, (heading.title, heading.reference, revision)))
        saved = self.reader.date(self.export.created) if self.export.created else ""
        link = self.export.link if len(self.export.link) <= LONGEST_FOOTER_LINK else ""
        numbers = text(N_("Page {page} of {pages}")).format(page="&P", pages="&N")
        sheet.set_header(f"&L{_plain(' '.join(title.split())[:LONGEST_HEADER_TEXT])}&R{_plain(saved)}", HEAD_AND_FOOT)
        sheet.set_footer(f"&LHPN Select {_plain(link)}&R{numbers}", HEAD_AND_FOOT)

    def name(self, name: str, sheet: Any, reference: str) -> None:
        """Define a name for a cell or a block of a sheet."""
        title = sheet.get_name().replace("'", "''")
        self.file.define_name(name, f"='{title}'!{reference}")

    def name_cell(self, name: str, sheet: Any, row: int, column: int) -> None:
        """Define a name for one cell."""
        self.name(name, sheet, xl_rowcol_to_cell(row, column, row_abs=True, col_abs=True))


def _plain(text: str) -> str:
    """Text of a header without commands, which begin with &."""
    return text.replace("&", "&&")


class Lines:
    """A sheet written line by line: label, symbol, value, unit, source, and the value in the reader's unit at `own`."""

    own = 5

    def __init__(self, book: Book, sheet: Any) -> None:
        self.book, self.sheet = book, sheet
        self.text = book.reader.text
        self.row = 0

    def section(self, title: str, *heads: str, numbers: Collection[int] = ()) -> None:
        """Write the title of a section, and the heads of its columns, those of `numbers` at the right."""
        self.sheet.write_string(self.row, 0, self.text(title), self.book.style("section"))
        if self.book.shown.units and not heads:
            self.sheet.write_string(self.row, self.own, self.text(N_("In your units")), self.book.style("quiet"))
        self.row += 1
        for column, head in enumerate(heads):
            if head:
                style = "head of numbers" if column in numbers else "head of words" if column - 1 in numbers else "head"
                self.sheet.write_string(self.row, column, self.text(head), self.book.style(style))
        self.row += bool(heads)

    def line(self, label: str, symbol: str, unit: str, source: str = "") -> None:
        """Write what stands around a value."""
        self.sheet.write_string(self.row, 0, self.text(label), self.book.style("label"))
        self.sheet.write_string(self.row, 1, symbol, self.book.style("quiet"))
        self.sheet.write_string(self.row, 3, self.book.reader.unit(unit), self.book.style("unit"))
        if source:
            self.sheet.write_string(self.row, 4, source, self.book.style("quiet"))

    def converted(self, unit: str, value: float | str | None) -> None:
        """Write the value of a line in the reader's own unit too, where that is another."""
        if self.book.converted(self.sheet, self.row, self.own, xl_rowcol_to_cell(self.row, 2), unit, value):
            self.sheet.write_string(self.row, self.own + 1, self.book.shown.unit(unit), self.book.style("unit"))


class CycleTable:
    """Phases as inputs with spare rows, from row `top` on, and the loads that apply in each phase."""

    def __init__(self, book: Book, sheet: Any, top: int) -> None:
        self.book, self.sheet, self.top = book, sheet, top
        self.phases = book.export.application.duty_cycle.load_phases
        self.last = top + len(self.phases) + SPARE_PHASES
        self.converted = [name for name in PHASE_FIGURES if not book.shown.measure(symbol_of(name)).same]
        self.loads = {name: getattr(book.export.duty.phases, name)[0, 0] for name in USED.values()}

    def write(self) -> None:
        """Write the table and name its columns."""
        heads = [(N_("Phase"), ""), *((INPUTS[f"phase.{name}"].name, symbol_of(name)) for name in PHASE_FIGURES)]
        heads += [(N_("Radial load used"), "N"), (N_("Axial load used"), "N")]
        for column, (head, unit) in enumerate(heads):
            style = self.book.style("head of numbers" if column else "head")
            self.sheet.write_string(self.top, column, self.book.head(self.book.reader.text(head), unit), style)
        self.sheet.set_row(self.top, 45)
        self.sheet.set_column(1, len(heads) - 1, WIDTH)
        self._heads_converted(len(heads))
        for column, name in enumerate((*PHASE_FIGURES, *USED), 1):
            self.book.name(name, self.sheet, xl_range_abs(self.top + 1, column, self.last, column))
        for row in range(self.top + 1, self.last + 1):
            self._phase(row)
        self._refuse()
        if not self.varies:
            self._fold(len(heads))
        self.sheet.repeat_rows(self.top)

    @property
    def varies(self) -> bool:
        """True where a phase has a peak or an RMS of its own."""
        return any(getattr(phase, name) is not None for phase in self.phases for name in VARYING)

    def _fold(self, start: int) -> None:
        """Fold the columns of phases that vary; the mark above the next column opens them."""
        first, last = (1 + PHASE_FIGURES.index(VARYING[k]) for k in (0, -1))
        self.sheet.set_column(first, last, WIDTH, None, FOLDED)
        self.sheet.set_column(last + 1, last + 1, WIDTH, None, {"collapsed": True})
        for column, name in enumerate(self.converted, start):
            if name in VARYING:
                self.sheet.set_column(column, column, WIDTH, None, {"hidden": True})

    def _heads_converted(self, start: int) -> None:
        """Write the heads of the columns in other units, behind all others."""
        for column, name in enumerate(self.converted, start):
            symbol = self.book.shown.unit(symbol_of(name))
            head = f"{self.book.reader.text(INPUTS[f'phase.{name}'].name)} [{symbol}]"
            self.sheet.write_string(self.top, column, head, self.book.style("head of numbers"))
            self.sheet.set_column(column, column, WIDTH)

    def _refuse(self) -> None:
        """Mark values that the service would refuse, and name the rows beneath the last, which do not count."""
        first = self.top + 1
        cells = {name: xl_rowcol_to_cell(first, column, col_abs=True) for column, name in enumerate(PHASE_FIGURES, 1)}
        for column, name in enumerate(PHASE_FIGURES, 1):
            field, reader = PHASE_FIELDS[name], self.book.reader
            rule = validation(field, advice(field, reader, name))
            wrong = is_wrong_in_phase(name, cells)
            self.book.refuse(self.sheet, first, column, self.last, column, wrong=wrong, validation=rule)
        beneath = (self.last + 1, 1, self.last + MOST_BENEATH, len(PHASE_FIGURES))
        self.book.name(BENEATH, self.sheet, xl_range_abs(*beneath))

    def _phase(self, row: int) -> None:
        place = row - self.top - 1
        phase = self.phases[place] if place < len(self.phases) else None
        self.book.number(self.sheet, row, place, phase.name if phase else None)
        for column, name in enumerate(PHASE_FIGURES, 1):
            self.book.put(self.sheet, row, column, getattr(phase, name, None), "input")
        for column, name in enumerate(self.converted, 1 + len(PHASE_FIGURES) + len(USED)):
            source = xl_rowcol_to_cell(row, 1 + PHASE_FIGURES.index(name))
            self.book.converted(self.sheet, row, column, source, symbol_of(name), getattr(phase, name, None))
        duration = xl_rowcol_to_cell(row, 1 + PHASE_FIGURES.index("duration_s"))
        for column, (name, loads) in enumerate(self.loads.items(), 1 + len(PHASE_FIGURES)):
            own, whole = (
                xl_rowcol_to_cell(row, 1 + PHASE_FIGURES.index(name)),
                cell_name(INPUTS[f"output_load.{name}"].symbol),
            )
            formula = f'=IF({duration}="",0,ABS(IF({own}="",IF({whole}="",0,{whole}),{own})))'
            self.sheet.write_formula(row, column, formula, None, loads[place].item() if phase else 0.0)

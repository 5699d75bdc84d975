"""The sheet of all candidates: utilisations, then published figures as numbers and calculated ones as formulas."""

import json
from typing import Any

from xlsxwriter.utility import xl_range, xl_range_abs, xl_rowcol_to_cell

from hpn.engine.candidates import Candidate
from hpn.engine.checks import CHECKS
from hpn.files.export import LOWER_BOUND
from hpn.files.words import catalogue_version
from hpn.files.workbook.formulas import CHECK_FORMULAS, GEAR_TERMS, NONE, RATINGS, written
from hpn.files.workbook.known import Known
from hpn.files.workbook.sheets import FOLDED, ROW_POINTS, Book
from hpn.files.workbook.unchanged import as_saved
from hpn.files.workbook.wrong import WRONG
from hpn.words.quantities import GEAR
from hpn.words.units import symbol_of
from hpn.words.wording import N_

FIRST_ROW = 1
WIDTH, CHECK_WIDTH, MOST_UPRIGHT, MOST_ACROSS = 10.0, 8.7, 9, 17
"""Widths of columns of figures and of checks in characters, and the number of checks that an upright page and one
across have room for.
"""

IDENTITY_WIDTHS = (13.0, 12.5, 10.0, 8.0)

IDENTITY = ("designation", "status", "utilisation", "rank")
USED = len(IDENTITY)
FIGURES = USED + len(CHECKS)
TERMS = FIGURES + len(RATINGS)
CONVERTED = TERMS + len(GEAR_TERMS)
"""First columns: of checks, which are printed, of published and of calculated figures, and of those in other units."""

COLUMNS = (
    {check.code: USED + k for k, check in enumerate(CHECKS)}
    | {name: FIGURES + k for k, name in enumerate(RATINGS)}
    | {term.name: TERMS + k for k, term in enumerate(GEAR_TERMS)}
)
"""Column by the name of a figure or the code of a check."""

LOAD = [check.code for check in CHECKS if check.group == "load"]
"""Load checks stand first; the property checks count only where they fail."""


class CandidatesSheet:
    """One row per candidate, best first as saved; columns of checks that nobody asks for are folded."""

    def __init__(self, book: Book, sheet: Any) -> None:
        self.book, self.sheet = book, sheet
        self.asked = book.export.selection.check_definitions.keys()
        self.symbols = {name: GEAR[field].symbol for name, field in RATINGS.items()}
        known = Known(book.export, book.export.candidate, book.words)
        self.symbols |= {term.name: known.symbol(term) for term in GEAR_TERMS}
        self.unknown = known.unknown()
        units = {name: symbol_of(field) for name, field in RATINGS.items()}
        units |= {term.name: term.unit for term in GEAR_TERMS}
        self.converted = {name: unit for name, unit in units.items() if not book.shown.measure(unit).same}

    def write(self) -> range:
        """Rows of the candidates, once the sheet is written."""
        rows = range(FIRST_ROW, FIRST_ROW + len(self.book.export.selection.candidates))
        self._heads()
        for row, candidate in zip(rows, self.book.export.selection.candidates, strict=True):
            self._row(row, candidate)
        blocks = {"candidates": 0, **{f"{name}_all": COLUMNS[name] for name in RATINGS}}
        for name, column in blocks.items():
            self.book.name(name, self.sheet, xl_range_abs(rows[0], column, rows[-1], column))
        self._colours(rows)
        self._notes(rows[-1] + 2)
        self.sheet.repeat_rows(0)
        self.book.page(self.sheet, columns=FIGURES, landscape=len(self.asked) > MOST_UPRIGHT, second=self.second)
        self.sheet.autofilter(0, 0, rows[-1], CONVERTED - 1)
        return rows

    @property
    def shown(self) -> list[int]:
        """Columns of the checks that are asked."""
        return [column for column, check in enumerate(CHECKS, USED) if check.code in self.asked]

    @property
    def second(self) -> int:
        """Column with which a second page begins, after half of the checks; 0 where one page has room for all."""
        return self.shown[len(self.shown) // 2] if len(self.shown) > MOST_ACROSS else 0

    def _notes(self, row: int) -> None:
        """Write the notices and versions of the selection below the list, across the columns of the first page.

        No reader of the file fits a row to its text by itself.
        """
        text, selection = self.book.reader.text, self.book.export.selection
        first = 1 if self.second else 0  # a second page repeats the first column
        self.sheet.write_string(row, first, text(N_("Assumptions and notes")), self.book.style("section"))
        notes = [self.book.shown.told(notice.sentence) for notice in selection.notices]
        notes.append(f"{text(N_('Engine'))} {selection.engine_version}")
        notes.append(f"{text(N_('Catalogue'))} {catalogue_version(self.book.export, self.book.reader)}")
        last = (self.second or FIGURES) - 1
        line = int(sum(IDENTITY_WIDTHS) + CHECK_WIDTH * sum(column <= last for column in self.shown))
        for own, note in enumerate(notes, row + 1):
            self.sheet.merge_range(own, first, own, last, note, self.book.style("wrap"))
            self.sheet.set_row(own, ROW_POINTS * (1 + len(note) // line))

    def _colours(self, rows: range) -> None:
        self.book.colour(self.sheet, rows[0], 1, rows[-1], 1)
        properties = USED + len(LOAD)
        self.book.colour_failures(self.sheet, rows[0], USED, rows[-1], properties - 1, bound="u")
        self.book.colour_failures(self.sheet, rows[0], properties, rows[-1], USED + len(CHECKS) - 1, bound="1")

    def _heads(self) -> None:
        text, head = self.book.reader.text, self.book.head
        heads = [text(title) for title in (N_("Gear"), N_("Verdict"), N_("Utilisation"), N_("Rank as saved"))]
        heads += [text(check.title) for check in CHECKS]
        heads += [head(GEAR[field].symbol, symbol_of(field)) for field in RATINGS.values()]
        bound = f", {text(LOWER_BOUND)}"
        heads += [head(self.symbols[term.name], term.unit) + bound * term.by_efficiency for term in GEAR_TERMS]
        unit_of = self.book.shown.unit
        heads += [f"{self.symbols[name]} [{unit_of(unit)}]" for name, unit in self.converted.items()]
        for column, shown in enumerate(heads):
            self.sheet.write_string(0, column, shown, self.book.style(_look_of(column)))
        self.sheet.set_row(0, 106)
        for column, width in enumerate(IDENTITY_WIDTHS):
            self.sheet.set_column(column, column, width)
        self.sheet.set_column(USED, len(heads) - 1, WIDTH)
        for column, check in enumerate(CHECKS, USED):
            self.sheet.set_column(column, column, CHECK_WIDTH, None, {} if check.code in self.asked else FOLDED)
        for name in self.unknown:
            self.sheet.set_column(COLUMNS[name], COLUMNS[name], WIDTH, None, {"hidden": True})
        self.sheet.freeze_panes(1, 1)

    def _row(self, row: int, candidate: Candidate) -> None:
        known = Known(self.book.export, candidate, self.book.words)
        names = {name: xl_rowcol_to_cell(row, column, col_abs=True) for name, column in COLUMNS.items()}
        self.sheet.write_string(row, 0, candidate.designation, self.book.style("verdict"))
        if candidate.rank is not None:
            self.sheet.write_number(row, 3, candidate.rank)
        for name, value in known.ratings().items():
            if value is not None:
                self.book.put(self.sheet, row, COLUMNS[name], value, "figure")
        fixed, terms = known.fixed(), known.terms()
        for term in GEAR_TERMS:
            saved, is_fixed = terms[term.name], term.name in fixed
            live = written(known.formula(term), names, self.book.words)
            formula = _while_unchanged(term.name, saved) if is_fixed else live
            self._cell(row, COLUMNS[term.name], formula, saved, "fixed" if is_fixed else "result")
        for column, check in enumerate(CHECKS, USED):
            used, formulas = known.utilisation(check.code), CHECK_FORMULAS.get(check.code)
            formula = written(formulas.ratio, names, self.book.words) if formulas else None
            if formulas and check.code in fixed:
                unasked = written(f'IF({formulas.asked},"[not rated]","")', names, self.book.words)
                formula = _while_unchanged(check.code, used, self.book.words["not rated"]) or unasked
            self._cell(row, column, formula, used, "share")
        self._verdict(row, known)
        figures = known.ratings() | terms
        for column, (name, unit) in enumerate(self.converted.items(), CONVERTED):
            source = xl_rowcol_to_cell(row, COLUMNS[name])
            self.book.converted(self.sheet, row, column, source, unit, figures[name])

    def _cell(self, row: int, column: int, formula: str | None, value: float | str, style: str) -> None:
        """Write a formula with its value, or the saved value alone."""
        if formula is None:
            self.book.put(self.sheet, row, column, value, style)
        else:
            self.sheet.write_formula(row, column, formula, self.book.style(style), value)

    def _verdict(self, row: int, known: Known) -> None:
        words = {name: f'"{word}"' for name, word in self.book.words.items()}
        load = xl_range(row, USED, row, USED + len(LOAD) - 1)
        rest = xl_range(row, USED + len(LOAD), row, USED + len(CHECKS) - 1)
        every = xl_range(row, USED, row, USED + len(CHECKS) - 1)
        over = 'COUNTIF({0},">"&{1}*(1+1E-12))'
        failing = f'{over.format(load, "u")}+{over.format(rest, 1)}+COUNTIF({every},"{NONE}")'
        unknown = f"COUNTIF({every},{words['not rated']})+SUMPRODUCT(--ISERROR({every}))"
        rated = f"IF({failing}>0,{words['unsuitable']},IF({unknown}>0,{words['unrated']},{words['suitable']}))"
        status = f"=IF({WRONG}>0,{words['unrated']},{rated})"
        self.sheet.write_formula(row, 1, status, self.book.style("verdict"), self.book.words[known.candidate.status])
        cell = xl_rowcol_to_cell(row, 1)
        used = (
            f'=IF({cell}={words["unrated"]},"",IF(COUNTIF({every},"{NONE}")>0,"{NONE}",'
            f"MAX({load},IF({over.format(rest, 1)}>0,MAX({rest}),0))))"
        )
        self.sheet.write_formula(row, 2, used, self.book.style("share"), known.overall())


def _look_of(column: int) -> str:
    """Style of the head of a column: names of checks are turned, what stands above numbers is at the right."""
    return "turned" if USED <= column < FIGURES else "head" if column < 2 else "head of numbers"


def _while_unchanged(name: str, saved: float | str, otherwise: str = "") -> str | None:
    """Formula that gives a saved value while the inputs behind it are unchanged, else `otherwise`; None if blank."""
    return None if saved == "" else f'=IF({as_saved(name)},{json.dumps(saved, ensure_ascii=False)},"{otherwise}")'

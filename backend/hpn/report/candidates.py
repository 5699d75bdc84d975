"""The sheet of all candidates: their published figures as cells, everything calculated from them as formulas."""

from collections.abc import Mapping
from typing import Any

from xlsxwriter.utility import xl_range, xl_rowcol_to_cell

from hpn.candidates import Candidate
from hpn.explanations import EXPLANATIONS
from hpn.report.export import LOWER_BOUND
from hpn.report.formulas import CHECKS, GEAR_TERMS, NONE, RATINGS, written
from hpn.report.sheets import Book, Known
from hpn.units import symbol_of
from hpn.wording import N_

FIRST_ROW = 1
IDENTITY = ("designation", "status", "utilisation", "rank")
FIGURES = len(IDENTITY)
TERMS = FIGURES + len(RATINGS)
USED = TERMS + len(GEAR_TERMS)

LOAD = [code for code in CHECKS if EXPLANATIONS[code].group == "load"]
"""Load checks stand first; the property checks count only where they fail."""


class CandidatesSheet:
    """One row per candidate, best first as saved."""

    def __init__(self, book: Book, sheet: Any) -> None:
        self.book, self.sheet = book, sheet
        self.columns = {name: FIGURES + k for k, name in enumerate(RATINGS)}
        self.columns |= {term.name: TERMS + k for k, term in enumerate(GEAR_TERMS)}

    def write(self) -> range:
        """Write the sheet; the rows of the candidates."""
        rows = range(FIRST_ROW, FIRST_ROW + len(self.book.export.candidates))
        self._heads()
        for row, candidate in zip(rows, self.book.export.candidates, strict=True):
            self._row(row, candidate)
        for name, column in {
            "candidates": 0,
            **{f"{n}_all": c for n, c in self.columns.items() if n in RATINGS},
        }.items():
            block = (
                f"{xl_rowcol_to_cell(rows[0], column, True, True)}:{xl_rowcol_to_cell(rows[-1], column, True, True)}"
            )
            self.book.name(name, self.sheet, block)
        self.sheet.autofilter(0, 0, rows[-1], USED + len(CHECKS) - 1)
        return rows

    def _heads(self) -> None:
        text, unit = self.book.language.text, self.book.language.unit
        heads = [text(head) for head in (N_("Gear"), N_("Verdict"), N_("Utilisation"), N_("Rank as saved"))]
        heads += [_head(name, unit(symbol_of(field))) for name, field in RATINGS.items()]
        bound = f", {text(LOWER_BOUND)}"
        heads += [_head(term.symbol, unit(term.unit)) + bound * term.by_efficiency for term in GEAR_TERMS]
        heads += [text(EXPLANATIONS[code].title) for code in CHECKS]
        for column, head in enumerate(heads):
            self.sheet.write_string(0, column, head, self.book.style("head"))
        self.sheet.set_row(0, 48)
        self.sheet.set_column(0, 0, 14)
        self.sheet.set_column(1, len(heads) - 1, 12)
        self.sheet.freeze_panes(1, 1)

    def _row(self, row: int, candidate: Candidate) -> None:
        known = Known(self.book.export, candidate, self.book.words)
        names = {name: xl_rowcol_to_cell(row, column, col_abs=True) for name, column in self.columns.items()}
        self.sheet.write_string(row, 0, candidate["designation"], self.book.style("verdict"))
        if candidate["rank"] is not None:
            self.sheet.write_number(row, 3, candidate["rank"])
        for name, value in known.ratings().items():
            if value is not None:
                self.sheet.write_number(row, self.columns[name], value, self.book.style("figure"))
        fixed, terms = known.fixed(), known.terms()
        for term in GEAR_TERMS:
            self._cell(
                row, self.columns[term.name], term.formula, names, terms[term.name], term.name in fixed, "result"
            )
        for column, (code, check) in enumerate(CHECKS.items(), USED):
            self._cell(row, column, check.ratio, names, known.utilisation(code), code in fixed, "share")
        self._verdict(row, candidate)

    def _cell(
        self, row: int, column: int, formula: str, names: Mapping[str, str], value: Any, fixed: bool, style: str
    ) -> None:
        if fixed:
            self.sheet.write(row, column, value, self.book.style("share" if style == "share" else "fixed"))
        else:
            text = written(formula, names, self.book.words)
            self.sheet.write_formula(row, column, text, self.book.style(style), value)

    def _verdict(self, row: int, candidate: Candidate) -> None:
        words = {name: f'"{word}"' for name, word in self.book.words.items()}
        load = xl_range(row, USED, row, USED + len(LOAD) - 1)
        rest = xl_range(row, USED + len(LOAD), row, USED + len(CHECKS) - 1)
        every = xl_range(row, USED, row, USED + len(CHECKS) - 1)
        over = 'COUNTIF({0},">"&{1}*(1+1E-12))'
        failing = f'{over.format(load, "u")}+{over.format(rest, 1)}+COUNTIF({every},"{NONE}")'
        unknown = f"COUNTIF({every},{words['not rated']})"
        status = f"=IF({failing}>0,{words['unsuitable']},IF({unknown}>0,{words['unrated']},{words['suitable']}))"
        self.sheet.write_formula(row, 1, status, self.book.style("verdict"), self.book.words[candidate["status"]])
        cell = xl_rowcol_to_cell(row, 1)
        used = (
            f'=IF(COUNTIF({every},"{NONE}")>0,"{NONE}",IF({cell}={words["unrated"]},"",'
            f"MAX({load},IF({over.format(rest, 1)}>0,MAX({rest}),0))))"
        )
        saved: float | str = candidate["utilisation"] if candidate["utilisation"] is not None else ""
        if candidate["status"] == "unsuitable" and candidate["utilisation"] is None:
            saved = NONE
        self.sheet.write_formula(row, 2, used, self.book.style("share"), saved)


def _head(symbol: str, unit: str) -> str:
    return f"{symbol} [{unit}]" if unit else symbol

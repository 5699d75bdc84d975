"""The first sheet: what was asked as inputs, the chosen gear, and every check of it as a formula."""

from typing import Any

from xlsxwriter.utility import xl_rowcol_to_cell

from hpn import bearing
from hpn.application import OutputLoad
from hpn.explanations import EXPLANATIONS
from hpn.report import inputs, standings
from hpn.report.candidates import LOAD
from hpn.report.content import RATINGS as PUBLISHED
from hpn.report.export import LOSS_FREE
from hpn.report.formulas import CHECKS, CYCLE_TERMS, GEAR_TERMS, NONE, RATINGS, Term, written
from hpn.report.sheets import Book, Known
from hpn.units import symbol_of
from hpn.wording import N_

NAMES = {
    "L_10,req": "L_10_req",
    "η": "eta",
    "T_mot,N": "T_mot_N",
    "K_3,req": "K_3_req",
    "t_p": "pause_s",
}
"""Symbols that are no defined name as they stand."""

NAMES_BY_FIELD = {"life_basis": "life_basis", "model": "model"}

DEFAULTS = {"f_w": 1.0, "L_b": 20_000.0, "life_basis": "L50", "model": "linear"}
"""Inputs that a load needs, should the reader add one."""

REFERENCES = (
    ("rated_speed", N_("Rated input speed"), "rpm", 3000.0),
    ("rated_life", N_("Life at rated torque and speed"), "h", 20_000.0),
    ("bearing_speed", N_("Speed that the published bearing loads hold for"), "rpm", 100.0),
    ("bearing_life", N_("Bearing life L50 that the published loads hold for"), "h", 20_000.0),
)
"""Series figures of the equations: name, what it is, unit, the handbook's value."""


class Overview:
    """Rows from top to bottom: label, symbol, value, unit, source."""

    def __init__(self, book: Book, sheet: Any, candidates: range) -> None:
        self.book, self.sheet, self.candidates = book, sheet, candidates
        self.known = Known(book.export, book.export.candidate, book.words)
        self.text = book.language.text
        self.row = 0

    def write(self) -> None:
        """Write the sheet."""
        for column, width in enumerate((44, 14, 18, 16, 14, 14, 14, 46)):
            self.sheet.set_column(column, column, width)
        self._head()
        self._gear()
        self._checks()
        self._terms(N_("What the cycle comes to"), CYCLE_TERMS, self._cycle_values())
        self._terms(N_("What the gear comes to"), GEAR_TERMS, self.known.terms())
        self._inputs()
        self._references()

    def _head(self) -> None:
        export = self.book.export
        self.sheet.write_string(0, 0, export.title or self.text(N_("Untitled selection")), self.book.style("title"))
        self.sheet.freeze_panes(1, 0)
        lines = [
            (N_("Reference"), export.reference),
            (N_("Saved"), self.book.language.date(export.created) if export.created else ""),
            (N_("Link"), export.link if len(export.link) < 32_000 else ""),
        ]
        self.row = 1
        for label, value in lines:
            if value:
                self.sheet.write_string(self.row, 0, self.text(label), self.book.style("quiet"))
                self.sheet.write_string(self.row, 1, value, self.book.style("label"))
                self.row += 1
        hint = N_("Yellow cells are inputs: change them, and everything else follows. Amber figures stay as saved.")
        self.sheet.write_string(self.row, 0, self.text(hint), self.book.style("quiet"))
        self.row += 2

    def _section(self, title: str, *heads: str) -> None:
        self.sheet.write_string(self.row, 0, self.text(title), self.book.style("section"))
        self.row += 1
        for column, head in enumerate(heads):
            self.sheet.write_string(self.row, column, self.text(head), self.book.style("head"))
        self.row += bool(heads)

    def _line(self, label: str, symbol: str, unit: str, source: str = "") -> None:
        self.sheet.write_string(self.row, 0, self.text(label), self.book.style("label"))
        self.sheet.write_string(self.row, 1, symbol, self.book.style("quiet"))
        self.sheet.write_string(self.row, 3, self.book.language.unit(unit), self.book.style("quiet"))
        self.sheet.write_string(self.row, 4, source, self.book.style("quiet"))

    def _gear(self) -> None:
        self._section(N_("Gear"))
        self._line(N_("Chosen gear (any candidate)"), "", "")
        cell, designation = (self.row, 2), self.book.export.candidate["designation"]
        self.sheet.write_string(*cell, designation, self.book.style("input"))
        self.sheet.data_validation(*cell, *cell, {"validate": "list", "source": "=candidates"})
        self.book.name_cell("gear", self.sheet, *cell)
        self.row += 1
        verdicts = (self.known.candidate["status"], self.known.candidate["utilisation"])
        for label, column, saved in zip((N_("Verdict"), N_("Utilisation")), (1, 2), verdicts, strict=True):
            self._line(label, "", "")
            first, last = (
                xl_rowcol_to_cell(row, column, True, True) for row in (self.candidates[0], self.candidates[-1])
            )
            block = f"'{self.text(N_('Candidates'))}'!{first}:{last}"
            value = self.book.words[saved] if column == 1 else self._overall(saved)
            style = self.book.style("verdict" if column == 1 else "share")
            self.sheet.write_formula(self.row, 2, f"=INDEX({block},MATCH(gear,candidates,0))", style, value)
            self.row += 1
        for name, rating in self.known.ratings().items():
            self._rating(name, rating)
        self.row += 1

    def _overall(self, saved: float | None) -> float | str:
        unlimited = NONE if self.known.candidate["status"] == "unsuitable" else ""
        return unlimited if saved is None else saved

    def _rating(self, name: str, value: float | None) -> None:
        labels = {field: (symbol, label) for field, symbol, label in PUBLISHED}
        field = RATINGS[name]
        symbol, label = labels.get(field, ("i", N_("Ratio")))
        gear = self.book.export.gear(self.book.export.candidate["designation"])
        source = self.book.language.filled(gear.sources.get(field, "")) if gear else ""
        self._line(label, symbol, symbol_of(field), source)
        block = f"INDEX({name}_all,MATCH(gear,candidates,0))"
        saved = "" if value is None else value
        self.sheet.write_formula(self.row, 2, f'=IF({block}="","",{block})', self.book.style("figure"), saved)
        self.book.name_cell(name, self.sheet, self.row, 2)
        self.row += 1

    # --- Calculated ---------------------------------------------------------------------------------------------------

    def _names(self) -> dict[str, str]:
        return {name: name for name in (*RATINGS, *(term.name for term in GEAR_TERMS))}

    def _terms(self, title: str, terms: tuple[Term, ...], values: dict[str, float | str]) -> None:
        self._section(title)
        fixed = self.known.fixed()
        for term in terms:
            equation = self.text(N_("eq. {number}")).format(number=term.equation) if term.equation else ""
            self._line(term.label, term.symbol, term.unit, equation)
            if term.name in fixed:
                self.sheet.write(self.row, 2, values[term.name], self.book.style("fixed"))
            else:
                formula = written(term.formula, self._names(), self.book.words)
                self.sheet.write_formula(self.row, 2, formula, self.book.style("result"), values[term.name])
            if term.by_efficiency:
                self._bound(term.name in fixed)
            self.book.name_cell(term.name, self.sheet, self.row, 2)
            self.row += 1
        self.row += 1

    def _bound(self, fixed: bool) -> None:
        """That a motor torque is a lower bound, for as long as the reader states no efficiency."""
        saved = self.text(LOSS_FREE) if self.book.export.is_lower_bound(self.known.candidate) else ""
        if fixed:
            self.sheet.write_string(self.row, 4, saved, self.book.style("quiet"))
        else:
            formula = f'=IF(eta="","{self.text(LOSS_FREE)}","")'
            self.sheet.write_formula(self.row, 4, formula, self.book.style("quiet"), saved)

    def _cycle_values(self) -> dict[str, float | str]:
        duty, loads = self.book.export.reply["duty"], self.book.export.application.loads or OutputLoad()
        speed, life = self._series()[2:]
        factor = bearing.life_factor(
            average_output_speed_rpm=duty["average_output_speed_rpm"],
            required_life_L50_h=bearing.required_L50(loads.life_h, loads.life_basis),
            reference_speed_rpm=speed,
            reference_life_h=life,
        )
        return {
            "T_max": duty["maximum_torque_Nm"],
            "T_av": duty["average_torque_Nm"],
            "T_rms": self.book.export.rms_torque_Nm,
            "n_out_max": duty["maximum_output_speed_rpm"],
            "n_out_av": duty["average_output_speed_rpm"],
            "k_b": float(factor),
        }

    def _checks(self) -> None:
        heads = (N_("Check"), N_("Relation"), N_("Value"), N_("Limit"), N_("Utilisation"), N_("Verdict"))
        self._section(N_("Checks"), *heads, N_("As saved"), N_("Source"))
        for code in CHECKS:
            self._check(code)
        self.row += 1

    def _check(self, code: str) -> None:
        check, style, saved = CHECKS[code], self.book.style, self.book.export.check(code)
        title, unit = self.text(EXPLANATIONS[code].title), self.book.language.unit(EXPLANATIONS[code].unit)
        self.sheet.write_string(self.row, 0, f"{title} [{unit}]" if unit else title, style("label"))
        self.sheet.write_string(self.row, 1, standings.STANDINGS[code].relation, style("quiet"))
        used = self.known.utilisation(code)
        fixed = code in self.known.fixed()
        formulas = (check.shown_demand, check.shown_limit, check.ratio)
        values = (_value(saved, "demand"), _value(saved, "limit"), used)
        for column, (formula, value) in enumerate(zip(formulas, values, strict=True), 2):
            look = style("share" if column == 4 else "result")
            if fixed:
                self.sheet.write(self.row, column, value, look)
            else:
                self.sheet.write_formula(self.row, column, self._written(formula), look, value)
        self._status(code, saved)
        self.sheet.write(self.row, 6, used, style("share"))
        self.sheet.write_string(self.row, 7, self._source(code) if saved else "", style("quiet"))
        self.row += 1

    def _written(self, formula: str) -> str:
        return written(formula, self._names(), self.book.words)

    def _status(self, code: str, saved: Any) -> None:
        words = self.book.words
        used = xl_rowcol_to_cell(self.row, 4)
        bound = ("u" if code in LOAD else "1") + "*(1+1E-12)"
        formula = (
            f'=IF({used}="","",IF({used}="{NONE}","{words["fails"]}",IF(ISTEXT({used}),{used},'
            f'IF({used}<={bound},"{words["passes"]}","{words["fails"]}"))))'
        )
        word = {"pass": words["passes"], "fail": words["fails"], "not_rated": words["not rated"]}
        self.sheet.write_formula(
            self.row, 5, formula, self.book.style("verdict"), word[saved["status"]] if saved else ""
        )

    def _source(self, code: str) -> str:
        equation = self.book.export.definitions[code]["equation"]
        where = [self.text(N_("eq. {number}")).format(number=equation)] if equation else []
        return " · ".join([*where, standings.source(self.book.export, code, self.book.language)])

    # --- Inputs -------------------------------------------------------------------------------------------------------

    def _inputs(self) -> None:
        self._section(N_("Inputs"))
        for entry in (*inputs.LOADS, *inputs.REQUIREMENTS):
            value = entry.value(self.book.export.application)
            name = NAMES_BY_FIELD.get(entry.path[-1]) or NAMES.get(entry.symbol, entry.symbol)
            live = bool(name) and name != "i"
            value = DEFAULTS.get(name) if value is None else value
            self._line(entry.label, entry.symbol, entry.unit)
            if isinstance(value, tuple):
                value = ", ".join(map(str, value))
            style = self.book.style("input" if live else "label")
            self.sheet.write(self.row, 2, value, style)
            if live:
                self.book.name_cell(name, self.sheet, self.row, 2)
            self.row += 1
        self.row += 1

    def _references(self) -> None:
        self._section(N_("Figures of the series"))
        for (name, label, unit, _), value in zip(REFERENCES, self._series(), strict=True):
            self._line(label, "", unit)
            self.sheet.write_number(self.row, 2, value, self.book.style("figure"))
            self.book.name_cell(name, self.sheet, self.row, 2)
            self.row += 1

    def _series(self) -> list[float]:
        figures = self.book.export.figures
        if figures is None:
            return [figure for *_, figure in REFERENCES]
        return [figures.rated_input_speed_rpm, figures.life_at_rated_torque_h, *figures.bearing_reference]


def _value(check: Any, name: str) -> float | str:
    value = check[name] if check else None
    return "" if value is None else float(value)

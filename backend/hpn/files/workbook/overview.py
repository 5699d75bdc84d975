"""The first sheet: the chosen gear, every check of it and the figures behind them as formulas."""

import json
from typing import Any

from xlsxwriter.utility import xl_range_abs, xl_rowcol_to_cell

from hpn.application import OutputLoad
from hpn.engine.candidates import CheckResult
from hpn.engine.check import Check
from hpn.engine.checks import CHECKS
from hpn.explain.readings import relation_of
from hpn.files.export import LOSS_FREE
from hpn.files.words import equation, origin
from hpn.files.workbook.candidates import COLUMNS, LOAD
from hpn.files.workbook.formulas import CHECK_FORMULAS, CYCLE_TERMS, GEAR_TERMS, NONE, RATINGS, CellTerm, written
from hpn.files.workbook.inputs_sheet import series_of
from hpn.files.workbook.known import Known, demand_of, limit_of
from hpn.files.workbook.sheets import COUNTS, ROW_POINTS, Book, Lines
from hpn.files.workbook.unchanged import as_saved
from hpn.files.workbook.wrong import EVERY_WRONG, WRONG, WRONG_AS_A_WHOLE
from hpn.physics import bearing
from hpn.words.quantities import GEAR
from hpn.words.terms import VERDICTS
from hpn.words.units import suffix_of
from hpn.words.wording import N_

ALONG_THE_MOTION = N_("as saved: along the motion, with the motor’s own inertia")
BASIS = 11
"""Column of the bases of checks, behind the columns that are printed, of which three have the reader's own units."""

LONGEST_TITLE = 42
"""Characters of a check's title that have room in one line."""

OUTDATED = N_("not available: inputs that it depends on were changed")

MARKED = N_("marked red on the sheet Inputs; no gear is rated while there is one")


class Overview(Lines):
    """Gear, checks and figures, with the basis of each check beside what is printed."""

    def __init__(self, book: Book, sheet: Any, candidates: range) -> None:
        super().__init__(book, sheet)
        self.candidates = candidates
        self.known = Known(book.export, book.export.candidate, book.words)
        every = (Known(book.export, candidate, book.words) for candidate in book.export.selection.candidates)
        self.fixed = set().union(*(known.fixed() for known in every))
        """Figures and checks that no formula gives for some gear."""

    def write(self) -> None:
        """Write the sheet."""
        for column, width in enumerate((36, 19, 12, 12, 10, 12, 10, 20, 12, 12, 8)):
            self.sheet.set_column(column, column, width)
        self._head()
        self._gear()
        self._checks()
        self._terms(N_("Figures of the cycle"), CYCLE_TERMS, self._cycle_values())
        self._terms(N_("Figures of the gear"), GEAR_TERMS, self.known.terms())
        self.book.page(self.sheet, columns=BASIS if self.book.shown.units else BASIS - 3)

    def _head(self) -> None:
        export = self.book.export
        self.sheet.write_string(
            0, 0, export.heading.title or self.text(N_("Untitled selection")), self.book.style("title")
        )
        self.sheet.set_row(0, 20)
        self.sheet.freeze_panes(1, 0)
        heading, made = export.heading, export.made
        lines = [
            (N_("Reference"), heading.reference),
            (N_("Revision"), heading.revision),
            (N_("Author"), heading.author),
            (N_("Ordering code"), heading.ordering_code),
            (N_("Saved"), self.book.reader.date(export.created) if export.created else ""),
            (N_("Made, not saved"), self.book.reader.day(made) if made and not export.created else ""),
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

    def _gear(self) -> None:
        self.section(N_("Gear"))
        self.line(N_("Chosen gear (any candidate)"), "", "")
        cell, designation = (self.row, 2), self.known.candidate.designation
        self.sheet.write_string(*cell, designation, self.book.style("input"))
        self.sheet.data_validation(*cell, *cell, {"validate": "list", "source": "=candidates"})
        self.book.name_cell("gear", self.sheet, *cell)
        self.row += 1
        verdict = self.book.words[self.known.candidate.status]
        self.book.colour(self.sheet, self.row, 2, self.row, 2)
        self._looked_up(N_("Verdict"), 1, "verdict", verdict)
        self._looked_up(N_("Utilisation"), 2, "share", self.known.overall())
        self._wrong()
        for name, rating in self.known.ratings().items():
            self._rating(name, rating)
        self.row += 1

    def _looked_up(self, label: str, column: int, style: str, saved: float | str) -> None:
        """Write a line with a column of the list of candidates, for the chosen gear."""
        self.line(label, "", "")
        self.sheet.write_formula(self.row, 2, f"={self._of_candidate(column)}", self.book.style(style), saved)
        self.row += 1

    def _wrong(self) -> None:
        """Write the number of inputs that the service would refuse: above 0 no gear is suitable."""
        self.line(N_("Invalid inputs"), "", "")
        count = f"=IFERROR({'+'.join(EVERY_WRONG)},1)"
        self.sheet.write_formula(self.row, 2, count, self.book.style("count"), 0)
        self.book.name_cell(WRONG, self.sheet, self.row, 2)
        remark = f'"{self.text(MARKED)}"'
        for condition, said in WRONG_AS_A_WHOLE.items():
            remark = f'IF({condition},"{self.text(said)}",{remark})'
        self.sheet.write_formula(self.row, 4, f'=IF({WRONG}>0,{remark},"")', self.book.style("wrong"), "")
        self.row += 1

    def _of_candidate(self, column: int) -> str:
        """Formula for a column of the list of candidates, in the row of the chosen gear."""
        block = xl_range_abs(self.candidates[0], column, self.candidates[-1], column)
        return f"INDEX('{self.text(N_('Candidates'))}'!{block},MATCH(gear,candidates,0))"

    def _from_list(self, name: str) -> str:
        """Formula that copies a figure or utilisation from the list of candidates; blank where it is blank there."""
        listed = self._of_candidate(COLUMNS[name])
        return f'=IF({listed}="","",{listed})'

    def _rating(self, name: str, value: float | None) -> None:
        field = RATINGS[name]
        gear = self.book.export.gear(self.known.candidate)
        source = self.book.reader.source(gear.sources.get(field, "")) if gear else ""
        self.line(GEAR[field].name, GEAR[field].symbol, suffix_of(field), source)
        block = f"INDEX({name}_all,MATCH(gear,candidates,0))"
        saved = "" if value is None else value
        self.sheet.write_formula(self.row, 2, f'=IF({block}="","",{block})', self.book.style("figure"), saved)
        self.book.name_cell(name, self.sheet, self.row, 2)
        self.converted(suffix_of(field), value)
        self.row += 1

    # --- Calculated ---------------------------------------------------------------------------------------------------

    def _names(self) -> dict[str, str]:
        return {name: name for name in (*RATINGS, *(term.name for term in GEAR_TERMS))}

    def _terms(self, title: str, terms: tuple[CellTerm, ...], values: dict[str, float | str]) -> None:
        self.section(title)
        for term in terms:
            named = term.named
            self.line(named.name, self.known.symbol(term), term.unit, equation(named.equation, self.book.reader))
            formula, look = self._written(self.known.formula(term)), "count" if term.name in COUNTS else "result"
            if term.name in self.fixed:
                formula, look = self._from_list(term.name), "fixed"
            self.sheet.write_formula(self.row, 2, formula, self.book.style(look), values[term.name])
            self._remark(term)
            self.book.name_cell(term.name, self.sheet, self.row, 2)
            self.converted(term.unit, values[term.name])
            if term.name in self.known.unknown():
                self.sheet.set_row(self.row, None, None, {"hidden": True})
            self.row += 1
        self.row += 1

    def _remark(self, term: CellTerm) -> None:
        """Write the source of a figure, or that inputs behind it were changed; that a motor torque is a lower bound
        while no efficiency is stated.
        """
        source = equation(term.named.equation, self.book.reader)
        bound = self.text(LOSS_FREE) if self.book.export.is_lower_bound(self.known.candidate) else ""
        if term.name in self.fixed:
            along = term.by_efficiency and self.book.export.selection.turns_motor
            said = [self.text(ALONG_THE_MOTION) if along else "", bound if term.by_efficiency else source]
            room = 4 if not term.by_efficiency or self.book.shown.measure("Nm").same else 7  # clear of another unit
            self._while_known(room, "; ".join(filter(None, said)), term.name, xl_rowcol_to_cell(self.row, 2))
        elif term.by_efficiency:
            formula = f'=IF(eta="","{self.text(LOSS_FREE)}","")'
            self.sheet.write_formula(self.row, 4, formula, self.book.style("quiet"), bound)

    def _while_known(self, column: int, said: str, name: str, cell: str) -> None:
        """Write a remark on a figure that keeps its saved value, or that it is unknown for the present inputs."""
        known = f'=IF(OR({as_saved(name)},{cell}<>""),"{said}","{self.text(OUTDATED)}")'
        self.sheet.write_formula(self.row, column, known, self.book.style("source"), said)

    def _cycle_values(self) -> dict[str, float | str]:
        duty, loads = self.book.export.selection.duty, self.book.export.application.loads or OutputLoad()
        (speed, life), torques = series_of(self.book.export)[2:], self.book.export.duty.torque_range_Nm
        factor = bearing.life_factor(
            average_output_speed_rpm=duty.average_output_speed_rpm,
            required_life_L50_h=bearing.required_L50(life_h=loads.life_h, basis=loads.life_basis),
            reference_speed_rpm=speed,
            reference_life_h=life,
        )
        return {
            "T_max": duty.maximum_torque_Nm,
            "T_av": duty.average_torque_Nm,
            "T_rms": self.book.export.duty.rms_torque_Nm.item(),
            "T_lo": torques[0].item(),
            "T_hi": torques[1].item(),
            "n_out_max": duty.maximum_output_speed_rpm,
            "n_out_av": duty.average_output_speed_rpm,
            "k_b": factor.item(),
        }

    def _checks(self) -> None:
        heads = (N_("Check"), N_("Relation"), N_("Demand"), N_("Limit"), N_("Utilisation"), N_("Verdict"))
        own = (N_("Demand"), N_("Limit"), N_("Your unit")) if self.book.shown.units else ("",) * 3
        self.section(N_("Checks"), *heads, N_("As saved"), N_("Source"), *own, N_("Basis"), numbers=(2, 3, 4, 6, 8, 9))
        self.book.colour(self.sheet, self.row, 5, self.row + len(CHECKS) - 1, 5)
        for check in CHECKS:
            self._check(check)
        self.row += 1

    def _check(self, check: Check) -> None:
        style, saved, used = self.book.style, self.known.candidate.check(check.code), self.known.utilisation(check.code)
        title = self.book.head(self.text(check.title), check.unit)
        self.sheet.write_string(self.row, 0, title, style("wrap"))
        self.sheet.set_row(self.row, ROW_POINTS * (1 + len(title) // LONGEST_TITLE))
        relation = relation_of(check.code, turns_motor=self.book.export.selection.turns_motor)
        self.sheet.write_string(self.row, 1, relation, style("quiet"))
        values = (demand_of(saved), limit_of(saved), used)
        for column, (formula, value) in enumerate(zip(self._formulas(check), values, strict=True), 2):
            look = style("share" if column == 4 else "count" if check.code in COUNTS else "result")
            self.sheet.write_formula(self.row, column, formula, look, value)
        self._status(check, saved)
        self.book.put(self.sheet, self.row, 6, used, "share")
        source = origin(self.book.export, check.code, self.book.reader) if saved else ""
        if check.code in self.fixed:
            self._while_known(7, source, check.code, xl_rowcol_to_cell(self.row, 2))
        else:
            self.sheet.write_string(self.row, 7, source, style("source"))
        if definition := self.book.export.selection.check_definitions.get(check.code):
            basis = f"{self.text(definition.tests)} {self.text(definition.basis)}"
            self.sheet.write_string(self.row, BASIS, basis, style("quiet"))
        for column in (2, 3):
            shown = self.book.converted(
                self.sheet, self.row, column + 6, xl_rowcol_to_cell(self.row, column), check.unit, values[column - 2]
            )
            if shown:
                self.sheet.write_string(self.row, 10, self.book.shown.unit(check.unit), style("unit"))
        self.row += 1

    def _formulas(self, check: Check) -> tuple[str, str, str]:
        """Formulas of a check's demand, limit and utilisation; saved demand and limit where no formula gives them."""
        own = CHECK_FORMULAS.get(check.code)
        if own and check.code not in self.fixed:
            return self._written(own.shown_demand), self._written(own.shown_limit), self._written(own.ratio)
        saved, designation = self.known.candidate.check(check.code), self.known.candidate.designation
        values = (json.dumps(value) for value in (demand_of(saved), limit_of(saved)))
        still = f'AND(gear="{designation}",{as_saved(check.code)})'
        demand, limit = (f'=IF({still},{value},"")' for value in values)
        return demand, limit, self._from_list(check.code)

    def _written(self, formula: str) -> str:
        return written(formula, self._names(), self.book.words)

    def _status(self, check: Check, saved: CheckResult | None) -> None:
        words, used = self.book.words, xl_rowcol_to_cell(self.row, 4)
        bound = ("u" if check.code in LOAD else "1") + "*(1+1E-12)"
        formula = (
            f'=IF(ISERROR({used}),"{words["not rated"]}",IF({used}="","",IF({WRONG}>0,"{words["not rated"]}",'
            f'IF({used}="{NONE}","{words["fails"]}",'
            f'IF(ISTEXT({used}),{used},IF({used}<={bound},"{words["passes"]}","{words["fails"]}"))))))'
        )
        word = words[VERDICTS[saved.status]] if saved else ""
        self.sheet.write_formula(self.row, 5, formula, self.book.style("word"), word)

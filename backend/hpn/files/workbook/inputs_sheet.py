"""The sheet of all inputs: loads and requirements, figures of the series, and below them the duty cycle."""

from dataclasses import replace

from xlsxwriter.utility import xl_range_abs, xl_rowcol_to_cell

from hpn.application.input_fields import FIELDS
from hpn.files.export import Export
from hpn.files.inputs import LOAD_INERTIA, LOAD_REVERSES, LOADS, REQUIREMENTS
from hpn.files.workbook.formulas import REVERSES
from hpn.files.workbook.known import DEMANDS, Known
from hpn.files.workbook.sheets import FOLDED, CycleTable, Lines
from hpn.files.workbook.unchanged import ENTERED, entered
from hpn.files.workbook.wrong import REMARKS, advice, is_wrong, validation
from hpn.words.quantities import INPUTS
from hpn.words.units import suffix_of
from hpn.words.wording import N_

EFFICIENCY, MODEL = "requirements.efficiency", "output_load.model"
NAMES = {path: name for name, path in ENTERED.items()}
NEEDED = {
    "emergency_stop.torque_Nm": 'AND(N_k<>"",T_B="")',
    "emergency_stop.brake.torque_Nm": 'OR(n_b<>"",f<>"")',
}
"""Conditions under which an optional input must be filled."""

OF_THE_MOTION = N_("of the motion")
REMARK = 9
"""Column of remarks on inputs, behind the columns that are folded and the values in other units."""

REFERENCES = (
    ("rated_speed", N_("Rated input speed"), "rpm", 3000.0),
    ("rated_life", N_("Life at rated torque and speed"), "h", 20_000.0),
    ("bearing_speed", N_("Speed of the published bearing loads"), "rpm", 100.0),
    ("bearing_life", N_("Bearing life L50 of the published loads"), "h", 20_000.0),
)
"""Series figures of the equations: name, what it is, unit, the handbook's value."""


class InputsSheet(Lines):
    """Inputs that are not given are folded, as the form folds them; phases stand last, so that any number has room."""

    own = 4

    def write(self) -> None:
        """Write the sheet."""
        self.sheet.set_column(0, 0, 44)
        self._inputs()
        self._references()
        self.section(N_("Duty cycle"))
        CycleTable(self.book, self.sheet, self.row).write()
        self.book.page(self.sheet)

    def _inputs(self) -> None:
        self.section(N_("Inputs"))
        for path in (*LOADS, *REQUIREMENTS):
            own = path == LOAD_INERTIA and self.book.export.selection.duty.load_inertia_kgm2 is not None
            source = self.text(OF_THE_MOTION) if own else ""
            self.line(INPUTS[path].name, INPUTS[path].symbol, suffix_of(path), source)
            name, value = NAMES.get(path), entered(self.book.export, path)
            shown = (value[0] if len(value) == 1 else ", ".join(map(str, value))) if isinstance(value, tuple) else value
            still = own or (path == EFFICIENCY and self.book.export.selection.turns_motor)
            self.book.put(self.sheet, self.row, 2, shown, "fixed" if still else "input" if name else "label")
            self.converted(suffix_of(path), value if isinstance(value, float) else None)
            if name or path == LOAD_REVERSES:
                self.book.name_cell(name or REVERSES, self.sheet, self.row, 2)
            if name and not still:
                self._refuse(path)
            if shown is None:
                self.sheet.set_row(self.row, None, None, FOLDED)
            self.row += 1
        self.book.name(REMARKS, self.sheet, xl_range_abs(1, REMARK, self.row - 1, REMARK))
        self.row += 1

    def _refuse(self, path: str) -> None:
        """Write the remark that appears beside an input while the service would refuse it."""
        field, cell = FIELDS[path], xl_rowcol_to_cell(self.row, 2)
        if path == MODEL:
            chosen = Known(self.book.export, self.book.export.candidate, self.book.words)
            as_saved = not chosen.fixed().isdisjoint(DEMANDS)
            field = replace(
                field, choices=(str(entered(self.book.export, path)),) if as_saved else ("linear", "iso281")
            )
        wrong, said = is_wrong(field, cell, NEEDED.get(path, "")), advice(field, self.book.reader)
        rule = validation(field, said)
        self.book.refuse(self.sheet, self.row, 2, self.row, 2, wrong=wrong, validation=rule)
        remark = f'=IF(IFERROR({wrong},1)>0,"{said}","")'
        self.sheet.write_formula(self.row, REMARK, remark, self.book.style("wrong"), "")

    def _references(self) -> None:
        self.section(N_("Figures of the series"))
        for (name, label, unit, _), value in zip(REFERENCES, series_of(self.book.export), strict=True):
            self.line(label, "", unit)
            self.book.put(self.sheet, self.row, 2, value, "figure")
            self.book.name_cell(name, self.sheet, self.row, 2)
            self.row += 1
        self.row += 1


def series_of(export: Export) -> list[float]:
    """Values of REFERENCES: those of the selection's catalogue, else of the handbook."""
    figures = export.figures
    if figures is None:
        return [figure for *_, figure in REFERENCES]
    return [figures.rated_input_speed_rpm, figures.life_at_rated_torque_h, *figures.bearing_reference]

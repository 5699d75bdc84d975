"""What the sheets of the workbook share, and the sheet of the duty cycle."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from xlsxwriter.utility import xl_range_abs, xl_rowcol_to_cell

from hpn.candidates import is_unlimited
from hpn.report.export import Export
from hpn.report.formulas import GEAR_TERMS, MOTOR_TORQUES, NONE, RATINGS
from hpn.report.language import Language
from hpn.wording import N_

ACCENT = "#0B5394"
STYLES: dict[str, dict[str, Any]] = {
    "title": {"bold": True, "font_size": 16},
    "section": {"bold": True, "font_color": ACCENT, "font_size": 12},
    "head": {"bold": True, "font_color": "#FFFFFF", "bg_color": ACCENT, "text_wrap": True, "valign": "top"},
    "label": {"valign": "top"},
    "quiet": {"font_color": "#5B6875", "valign": "top"},
    "wrap": {"text_wrap": True, "valign": "top"},
    "input": {"bg_color": "#FFF8DC", "border": 1, "border_color": "#D5DBE1", "locked": False},
    "figure": {"bg_color": "#F3F6F9"},
    "result": {"num_format": "#,##0.00##"},
    "count": {"num_format": "#,##0"},
    "share": {"num_format": "0.0##%"},
    "fixed": {"num_format": "#,##0.00##", "italic": True, "font_color": "#8A6100"},
    "verdict": {"bold": True},
}
"""Yellow cells are inputs; amber italics are values that a formula can't give."""

SPARE_PHASES = 20


@dataclass
class Book:
    """A workbook in the making."""

    file: Any
    export: Export
    language: Language
    words: Mapping[str, str]
    styles: dict[str, Any] = field(default_factory=dict)

    def style(self, name: str) -> Any:
        """One of STYLES."""
        if name not in self.styles:
            self.styles[name] = self.file.add_format(STYLES[name])
        return self.styles[name]

    def name(self, name: str, sheet: Any, reference: str) -> None:
        """Define a name for a cell or a block of a sheet."""
        title = sheet.get_name().replace("'", "''")
        self.file.define_name(name, f"='{title}'!{reference}")

    def name_cell(self, name: str, sheet: Any, row: int, column: int) -> None:
        """Define a name for one cell."""
        self.name(name, sheet, xl_rowcol_to_cell(row, column, row_abs=True, col_abs=True))


class CycleSheet:
    """Phases as inputs with room for more, and the loads that each phase has after all."""

    def __init__(self, book: Book, sheet: Any) -> None:
        self.book, self.sheet = book, sheet
        self.phases = book.export.application.duty_cycle.phases
        self.last = len(self.phases) + SPARE_PHASES

    def write(self) -> None:
        """Write the sheet and name its columns."""
        text, symbol = self.book.language.text, self.book.language.unit
        heads = [N_("Phase"), N_("Torque"), N_("Speed"), N_("Duration"), N_("Radial load"), N_("Axial load")]
        used = [N_("Radial load that counts"), N_("Axial load that counts")]
        units = ["", "Nm", "rpm", "s", "N", "N", "N", "N"]
        for column, (head, unit) in enumerate(zip([*heads, *used], units, strict=True)):
            self.sheet.write_string(
                0, column, f"{text(head)} [{symbol(unit)}]" if unit else text(head), self.book.style("head")
            )
        self.sheet.set_column(0, 7, 15)
        self.sheet.freeze_panes(1, 0)
        names = ("torque_Nm", "speed_rpm", "duration_s", "radial_N", "axial_N")
        for column, name in enumerate((*names, "radial_used", "axial_used"), 1):
            self.book.name(name, self.sheet, xl_range_abs(1, column, self.last, column))
        for row in range(1, self.last + 1):
            self._phase(row, names)

    def _phase(self, row: int, names: tuple[str, ...]) -> None:
        phase = self.phases[row - 1] if row <= len(self.phases) else None
        self.sheet.write_number(row, 0, row, self.book.style("quiet"))
        for column, name in enumerate(names, 1):
            value = getattr(phase, name, None)
            if value is None:
                self.sheet.write_blank(row, column, None, self.book.style("input"))
            else:
                self.sheet.write_number(row, column, value, self.book.style("input"))
        for column, name, whole in ((6, "radial_N", "F_R"), (7, "axial_N", "F_A")):
            own = xl_rowcol_to_cell(row, column - 2)
            duration = xl_rowcol_to_cell(row, 3)
            formula = f'=IF({duration}="",0,ABS(IF({own}="",IF({whole}="",0,{whole}),{own})))'
            self.sheet.write_formula(row, column, formula, None, self._used(phase, name))

    def _used(self, phase: Any, name: str) -> float:
        loads = self.book.export.application.loads
        if phase is None or loads is None:
            return 0.0
        own: float | None = getattr(phase, name)
        whole: float | None = getattr(loads, name)
        return abs((whole or 0.0) if own is None else own)


@dataclass(frozen=True)
class Known:
    """What a reply says of one candidate, by the names of the formulas."""

    export: Export
    candidate: Mapping[str, Any]
    words: Mapping[str, str]

    def ratings(self) -> dict[str, float | None]:
        """Published figures: from the catalogue of the reply, else as far as its checks name them as limits."""
        gear = self.export.gear(self.candidate["designation"])
        if gear:
            return {name: getattr(gear, field) for name, field in RATINGS.items()}
        limits = {
            "T_N": "average_torque",
            "T_R": "repeated_peak_torque",
            "T_M": "momentary_peak_torque",
            "n_av_limit": "average_input_speed",
            "n_in_limit": "maximum_input_speed",
        }
        known = {name: self._check(code, "limit") for name, code in limits.items()}
        return {name: known.get(name) for name in RATINGS} | {"ratio": self.candidate["ratio"]}

    def fixed(self) -> set[str]:
        """Terms and checks that no formula of this workbook can give: they stand as saved."""
        fixed: set[str] = set()
        loads = self.export.application.loads
        if self.export.figures is None:
            fixed |= {"P_max", "P_m", "output_bearing_load", "output_bearing_life"}
            fixed |= {"ambient_temperature", "backlash", "torsional_stiffness", "weight", "length"}
        elif loads and loads.model == "digitised":
            fixed |= {"P_max", "P_m"}
        if self.export.follows_efficiency_curve(self.candidate):
            fixed |= set(MOTOR_TORQUES)
        return fixed

    def terms(self) -> dict[str, float | str]:
        """Values of GEAR_TERMS as saved; words where there is no number."""
        fields = {
            "n_in_av": "average_input_speed_rpm",
            "n_in_max": "maximum_input_speed_rpm",
            "N_k_max": "momentary_peak_count",
            "L_10": "life_L10_h",
            "L_b50": "bearing_life_L50_h",
            "T_mot_peak": "motor_peak_torque_Nm",
            "T_mot_rms": "motor_rated_torque_Nm",
        }
        values = {name: self.candidate.get(field) for name, field in fields.items()}
        values["P_max"] = self._check("output_bearing_load", "demand")
        values["P_m"] = self._check("output_bearing_life", "demand")
        may_be = {name: fields[name] for name in ("N_k_max", "L_10", "L_b50")}
        endless = {name for name, field in may_be.items() if is_unlimited(self.candidate, field)}
        return {
            term.name: self.words["unlimited"] if term.name in endless else _cell(value)
            for term in GEAR_TERMS
            for value in (values[term.name],)
        }

    def utilisation(self, code: str) -> float | str:
        """Utilisation of a check as saved; blank where it was not asked for."""
        check = next((check for check in self.candidate["checks"] if check["code"] == code), None)
        if check is None:
            return ""
        if check["utilisation"] is not None:
            return float(check["utilisation"])
        return NONE if check["status"] == "fail" else self.words["not rated"]

    def _check(self, code: str, name: str) -> float | None:
        check = next((check for check in self.candidate["checks"] if check["code"] == code), None)
        return check[name] if check else None


def _cell(value: float | None) -> float | str:
    return "" if value is None else float(value)

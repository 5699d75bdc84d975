"""Printed equations 17.2 to 17.10 of the handbook, live for one gear: from the phases and T_k on the same sheet."""

from collections.abc import Mapping

from xlsxwriter.utility import xl_range_abs, xl_rowcol_to_cell

from hpn.account.lines import Line
from hpn.account.published import line_of
from hpn.files.workbook.sheet import Cell, SelectionSheet
from hpn.words.quantities import CANDIDATE, INPUTS
from hpn.words.reader import Reader
from hpn.words.titles import row_label
from hpn.words.units import suffix_of, symbol_of
from hpn.words.wording import N_, Named

WIDTHS = (40, 14, 14, 14, 14, 14, 12)
NOTE = N_(
    "Yellow cells may be changed: the phases, the pause and T_k. The equations of the handbook follow, for this gear "
    "alone and in its units; every other check, and every other gear, needs the page."
)
RATED = {
    "ratio": "i",
    "rated_torque_Nm": "T_N",
    "repeated_peak_torque_Nm": "T_R",
    "momentary_peak_torque_Nm": "T_M",
    "average_input_speed_rpm": "n_av",
    "maximum_input_speed_rpm": "n_max",
}
"""Published figures of the equations: field and name of their cell."""

BLOCKS = {"torque_Nm": "T", "speed_rpm": "n", "duration_s": "t", "peak_torque_Nm": "T_pk", "peak_speed_rpm": "n_pk"}
"""Columns of the phases; a blank peak means a steady phase."""

_WORK = "SUMPRODUCT(ABS({n})*{t})"
_LARGEST = "SUMPRODUCT(MAX(ABS({T})))"
FORMULAS: Mapping[str, str] = {
    "average_torque_Nm": f"IF({_LARGEST}=0,0,{_LARGEST}*"
    f"(SUMPRODUCT(ABS({{n}})*{{t}}*(ABS({{T}})/{_LARGEST})^(10/3))/{_WORK})^0.3)",
    "average_output_speed_rpm": f"{_WORK}/(SUM({{t}})+{{t_p}})",
    "maximum_torque_Nm": 'SUMPRODUCT(MAX(ABS({T})*({T_pk}="")+ABS({T_pk})))',
    "maximum_output_speed_rpm": 'SUMPRODUCT(MAX(ABS({n})*({n_pk}="")+ABS({n_pk})))',
    "average_input_speed_rpm": "{i}*{average_output_speed_rpm}",
    "maximum_input_speed_rpm": "{i}*{maximum_output_speed_rpm}",
    "momentary_peak_count": 'IF(OR({T_k}="",{T_R}=""),"",IF(ABS({T_k})<={T_R},"[unlimited]",'
    "IFERROR(INT(10^(8.5-1.5*ABS({T_k})/{T_R})*(1+1E-12)),0)))",
    "life_L10_h": 'IF({T_N}="","",IF({average_torque_Nm}=0,"[unlimited]",'
    "{hours}*{n_rated}/{average_input_speed_rpm}*({T_N}/{average_torque_Nm})^(10/3)))",
}
"""Equations 17.2, 17.4 to 17.6, 17.9 and 17.10, by the figure that each calculates."""

COMPARED = {
    "average_torque": ("average_torque_Nm", "T_N"),
    "repeated_peak_torque": ("maximum_torque_Nm", "T_R"),
    "momentary_peak_torque": ("T_k", "T_M"),
    "average_input_speed": ("average_input_speed_rpm", "n_av"),
    "maximum_input_speed": ("maximum_input_speed_rpm", "n_max"),
}
"""Load limits of these equations, by check: the cells of demand and limit."""


def write_equations(sheet: SelectionSheet) -> None:
    """Write the sheet of a gear with known figures; only phases, pause and T_k can be changed."""
    sheet.reader = Reader(sheet.reader.language, digits=sheet.reader.digits)  # the handbook's units
    sheet.put(0, f"{sheet.reader.text(N_('Equations'))}: {sheet.export.candidate.designation}", "title")
    sheet.row += 1
    sheet.note(sheet.reader.text(NOTE), WIDTHS)
    cells = _write_figures(sheet)
    inputs = sheet.row + len(FORMULAS) + len(COMPARED) + 7  # phases stand last, so that there is room for any number
    cells |= _cells_of_inputs(sheet, inputs)
    _write_formulas(sheet, cells)
    _write_limits(sheet, cells)
    sheet.row = inputs
    _write_inputs(sheet)
    sheet.sheet.protect("", {"select_locked_cells": True})
    sheet.page(WIDTHS)


def _write_figures(sheet: SelectionSheet) -> dict[str, str]:
    """Published figures of the gear and the series, and the names of their cells."""
    account, figures = sheet.export.account, sheet.export.figures
    assert account.gear is not None and figures is not None
    ratio = line_of(account.gear, "ratio")
    lines = {name: account.line(f"gear.{field}") or ratio for field, name in RATED.items()}
    hours, speed = Named(N_("Life at rated torque and speed")), Named(N_("Rated input speed"))
    lines["hours"] = Line("", hours, figures.life_at_rated_torque_h, "h", "published")
    lines["n_rated"] = Line("", speed, figures.rated_input_speed_rpm, "rpm", "published")
    lines["u"] = Line("requirements.utilisation", INPUTS["requirements.utilisation"], account.utilisation)
    sheet.lines(N_("Published figures"), lines.values())
    known = [name for name, line in lines.items() if line.value is not None]
    cells = {name: _cell(sheet.row - len(known) + place, 2) for place, name in enumerate(known)}
    return dict.fromkeys(lines, '""') | cells  # an unpublished figure is a blank in every formula


def _cell(row: int, column: int) -> str:
    return str(xl_rowcol_to_cell(row, column, row_abs=True, col_abs=True))


def _cells_of_inputs(sheet: SelectionSheet, row: int) -> dict[str, str]:
    """Cells of pause and T_k, and blocks of the phases, below a row."""
    first, count = row + 7, len(sheet.export.application.duty_cycle.load_phases)
    blocks = {
        name: xl_range_abs(first, column, first + count - 1, column) for column, name in enumerate(BLOCKS.values(), 1)
    }
    return blocks | {"t_p": _cell(row + 2, 2), "T_k": _cell(row + 3, 2)}


def _write_formulas(sheet: SelectionSheet, cells: dict[str, str]) -> None:
    """Write the equations, each with its saved value; add their cells to `cells`."""
    sheet.heads(N_("Equations"))
    account = sheet.export.account
    unlimited = sheet.reader.text(N_("unlimited"))
    for name, formula in FORMULAS.items():
        line = account.line(f"duty.{name}") or account.line(f"candidate.{name}")
        line = line or Line("", CANDIDATE[name])  # its version did not know the figure
        named, value = line.named, line.value_for(sheet.reader)
        cell: Cell = "" if value is None else value
        sheet.put(0, sheet.reader.text(named.name))
        sheet.put(1, named.symbol, "quiet")
        live = "=" + formula.format_map(cells).replace("[unlimited]", unlimited)
        sheet.sheet.write_formula(sheet.row, 2, live, sheet.styles["figure"], cell)
        sheet.put(3, sheet.reader.unit(suffix_of(name)), "unit")
        sheet.put(4, f"({named.equation})" if named.equation else "", "quiet")
        cells[name] = _cell(sheet.row, 2)
        sheet.row += 1


def _write_limits(sheet: SelectionSheet, cells: Mapping[str, str]) -> None:
    """Write the load limits of these equations: demand over limit, and the verdict by u."""
    text, definitions = sheet.reader.text, sheet.export.selection.check_definitions
    heads = (N_("Check"), N_("Demand"), N_("Limit"), N_("Unit"), N_("Utilisation"), N_("Verdict"), N_("Equation"))
    sheet.heads(N_("Load limits"), *map(text, heads), numbers=(1, 2, 4))
    words = [text(N_("passes")), text(N_("fails"))]
    for code, sides in COMPARED.items():
        check = sheet.export.candidate.check(code)
        if check is None:
            continue
        demand, limit = (cells[side] for side in sides)
        saved: list[Cell] = [check.demand, check.limit, check.utilisation]
        used = f'IF(OR({demand}="",{limit}=""),"",ABS({demand})/{limit})'
        live = [f'=IF({demand}="","",ABS({demand}))', f"={limit}", f"={used}"]
        sheet.put(0, text(definitions[code].title))
        for column, formula, value, style in zip((1, 2, 4), live, saved, ("figure", "figure", "share"), strict=True):
            sheet.sheet.write_formula(sheet.row, column, formula, sheet.styles[style], "" if value is None else value)
        sheet.put(3, sheet.reader.unit(symbol_of(RATED_FIELD[sides[1]])), "unit")
        own = _cell(sheet.row, 4)
        verdict = f'=IF({own}="","",IF({own}<={cells["u"]}*(1+1E-12),"{words[0]}","{words[1]}"))'
        known = {"pass": words[0], "fail": words[1], "not_rated": ""}[check.status]
        sheet.sheet.write_formula(sheet.row, 5, verdict, sheet.styles["label"], known)
        sheet.put(6, f"({definitions[code].equation})", "quiet")
        sheet.row += 1


RATED_FIELD = {name: field for field, name in RATED.items()}


def _write_inputs(sheet: SelectionSheet) -> None:
    """Write pause, T_k and the phases: the cells that may be changed."""
    application, candidate = sheet.export.application, sheet.export.candidate
    sheet.heads(N_("Inputs"))
    typed = application.emergency_stop.torque_Nm if application.emergency_stop else None
    stop = next((torque for torque in (candidate.stop_torque_Nm, typed) if torque is not None), "")
    for path, value in (("duty_cycle.pause_s", application.duty_cycle.pause_s), ("emergency_stop.torque_Nm", stop)):
        sheet.put(0, sheet.reader.text(INPUTS[path].name))
        sheet.put(1, INPUTS[path].symbol, "quiet")
        sheet.put(2, value, "input")
        sheet.put(3, sheet.reader.unit(suffix_of(path)), "unit")
        sheet.row += 1
    heads = [sheet.head(INPUTS[f"phase.{name}"].symbol, name) for name in BLOCKS]
    sheet.heads(N_("Phases"), sheet.reader.text(N_("Phase")), *heads, numbers=range(1, 1 + len(heads)))
    for place, phase in enumerate(application.duty_cycle.load_phases):
        sheet.put(0, row_label(place, phase.name), "quiet")
        for column, name in enumerate(BLOCKS, 1):
            number = getattr(phase, name)
            sheet.put(column, "" if number is None else number, "input")
        sheet.row += 1

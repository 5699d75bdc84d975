"""The hidden sheet that compares the inputs behind each saved figure with the inputs that were saved.

No formula of the workbook gives digitised bearing loads, motor torques with the motor's own inertia or by an efficiency
curve, and what takes figures of a catalogue that is not at hand.
"""

import re
from collections.abc import Iterable, Mapping
from typing import Any

from xlsxwriter.utility import xl_range_abs

from hpn.application import OutputLoad
from hpn.application.input_fields import NUMBERS, PHASE_FIGURES
from hpn.files.export import Export
from hpn.files.inputs import LOAD_INERTIA, LOAD_PATH, LOAD_REVERSES, LOADS, REQUIREMENTS, Value, value_of
from hpn.files.workbook.formulas import CHECK_FORMULAS, CYCLE_TERMS, GEAR_TERMS, MOTOR_TORQUES, cell_name
from hpn.files.workbook.known import BY_BRAKE, DEMANDS
from hpn.files.workbook.sheets import SPARE_PHASES, USED, Book
from hpn.words.quantities import INPUTS

ENTERED: Mapping[str, str] = {
    cell_name(INPUTS[path].symbol) or path.removeprefix(LOAD_PATH): path
    for path in (*LOADS, *REQUIREMENTS)
    if tuple(path.split(".")) in NUMBERS or path.startswith(LOAD_PATH)
}
"""Inputs that the formulas of the workbook take, besides the phases: name in formulas, path in the application."""

_FORMULAS = {term.name: term.formula for term in (*CYCLE_TERMS, *GEAR_TERMS)} | {
    code: check.ratio for code, check in CHECK_FORMULAS.items()
}
_BY_CURVE = {"speed_rpm", "peak_speed_rpm"}
"""Inputs behind motor torques by an efficiency curve, besides those in their formula."""

_BEHIND_BRAKE = {"T_B", "t_rise", "t_reaction", "n_b", "f", "eta", "J_m", "J_L", "peak_speed_rpm", "speed_rpm"}
"""Inputs behind the torque of a stop by the brake."""

_BEHIND_LEVER = {"x", "y", "x_c", "radial_N", "axial_N"}
"""Inputs behind a load beside the shaft's centre, besides those in the formulas of a load at it."""

_ALONG_MOTION = {"J_m", "J_L"}
"""Further inputs behind them in a motion: the inertias of motor and load."""


def entered(export: Export, path: str) -> Value | None:
    """Value in the workbook's cell of an input; of a load, its default too, should the reader add one."""
    value = value_of(export.equipped, path)
    if value is None and path == LOAD_INERTIA:
        return export.selection.duty.load_inertia_kgm2
    if value is None and path == LOAD_REVERSES and export.application.duty_cycle.motion is not None:
        return False  # a motion has its signs
    if value is None and path.startswith(LOAD_PATH):
        default: Value | None = getattr(OutputLoad(), path.removeprefix(LOAD_PATH))
        return default
    return value


def as_saved(name: str) -> str:
    """Name of the cell that is true while the inputs behind a figure or check are those that were saved."""
    return f"{name}_as_saved"


def inputs_behind(name: str) -> set[str]:
    """Inputs behind a figure or check, through all formulas, by their names in these."""
    if name in PHASE_FIGURES or name in USED or name in ENTERED:
        return {name}
    return set().union(*map(inputs_behind, re.findall(r"\w+", _FORMULAS.get(name, ""))))


def write_unchanged(book: Book, sheet: Any, fixed: Iterable[str]) -> None:
    """Write the sheet: the inputs behind `fixed` as saved, and a cell for each of `fixed` that compares them."""
    sheet.hide()
    behind = {name: inputs_behind(name) for name in fixed}
    along = book.export.application.duty_cycle.motion is not None
    turned = _BY_CURVE.union(*map(inputs_behind, MOTOR_TORQUES), _ALONG_MOTION if along else ())
    behind |= dict.fromkeys(behind.keys() & set(MOTOR_TORQUES), turned)
    for names, further in ((BY_BRAKE, _BEHIND_BRAKE), (DEMANDS.keys(), _BEHIND_LEVER)):
        behind |= {name: behind[name] | further for name in behind.keys() & names}
    for row, name in enumerate(sorted(behind)):
        equal = ",".join(f'SUMPRODUCT(--({cell}&""<>{cell}_saved&""))=0' for cell in sorted(behind[name]))
        sheet.write_formula(row, 0, f"=AND({equal})", None, True)
        book.name_cell(as_saved(name), sheet, row, 0)
    for column, name in enumerate(sorted(set().union(*behind.values())), 1):
        values = _saved(book, name)
        for row, value in enumerate(values):
            book.put(sheet, row, column, value, "label")
        book.name(f"{name}_saved", sheet, xl_range_abs(0, column, len(values) - 1, column))


def _saved(book: Book, name: str) -> list[Any]:
    """Values of an input: one, or one of each row for a phase, filled or spare."""
    export = book.export
    if name in ENTERED:
        return [entered(export, ENTERED[name])]
    if name in USED:
        loads: list[Any] = getattr(export.duty.phases, USED[name])[0, 0].tolist()
        return [*loads, *[0.0] * SPARE_PHASES]
    return [*(getattr(phase, name) for phase in export.application.duty_cycle.load_phases), *[None] * SPARE_PHASES]

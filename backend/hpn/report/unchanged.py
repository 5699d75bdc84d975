"""The hidden sheet that says whether the inputs behind motor torques are still those that were saved.

Along a motion with the motor's own inertia, and by an efficiency curve, no formula of the workbook gives these torques.
"""

from typing import Any

from xlsxwriter.utility import xl_range_abs

from hpn.report.inputs import value_of
from hpn.report.sheets import SPARE_PHASES, Book

UNCHANGED = "motor_inputs_as_saved"
"""Name of the cell that says it."""

_BLOCKS = ("torque_Nm", "speed_rpm", "duration_s", "peak_torque_Nm", "peak_speed_rpm", "rms_torque_Nm")
_CELLS = {"pause_s": "duty_cycle.pause_s", "eta": "requirements.efficiency"}
"""Inputs by their names in formulas: of each phase, and of any cycle."""


def write_unchanged(book: Book, sheet: Any) -> None:
    """Write the sheet: what was saved, in columns, and the cell that compares it with the inputs."""
    sheet.hide()
    phases = book.export.application.duty_cycle.load_phases
    equal = []
    for column, name in enumerate(_BLOCKS):
        for row, phase in enumerate(phases, 1):
            sheet.write(row, column, getattr(phase, name))
        book.name(f"{name}_saved", sheet, xl_range_abs(1, column, len(phases) + SPARE_PHASES, column))
        equal.append(f"SUMPRODUCT(--({name}<>{name}_saved))=0")
    for column, (name, value) in enumerate(_single(book).items(), len(_BLOCKS)):
        sheet.write(1, column, value)
        book.name_cell(f"{name}_saved", sheet, 1, column)
        equal.append(f"{name}={name}_saved")
    sheet.write_formula(0, 0, f"=AND({','.join(equal)})", None, True)
    book.name_cell(UNCHANGED, sheet, 0, 0)


def _single(book: Book) -> dict[str, Any]:
    export = book.export
    single = {name: value_of(export.equipped, path) for name, path in _CELLS.items()}
    if export.application.duty_cycle.motion is None:
        return single
    motor = value_of(export.equipped, "requirements.motor.inertia_kgm2")
    return single | {"J_m": motor, "J_L": export.selection.duty.load_inertia_kgm2}

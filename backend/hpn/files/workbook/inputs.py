"""The sheet of all inputs that are given: loads, requirements, motion, and below them the duty cycle."""

from collections.abc import Sequence

from hpn.account.inputs import LOADS, REQUIREMENTS, WORDS, value_of, written
from hpn.account.motion import MOTION_TITLE, MOVES, MOVES_TITLE, mechanism_of, moves_of
from hpn.account.motion import WORDS as MOTION_WORDS
from hpn.application.motion import Motion
from hpn.files.report.tables import columns, numbers
from hpn.files.workbook.sheet import Cell, Line, Sheet
from hpn.words.quantities import INPUTS
from hpn.words.titles import row_label
from hpn.words.units import suffix_of
from hpn.words.wording import N_

WIDTHS = (44, 14, 14, 14, 14, 14, 14, 14, 14)


def write_inputs(sheet: Sheet) -> None:
    """Write the sheet; phases stand last, so that any number has room."""
    for title, paths in ((N_("Loads"), LOADS), (N_("Requirements"), REQUIREMENTS)):
        sheet.lines(title, (_line(sheet, path) for path in paths))
    if (motion := sheet.export.application.duty_cycle.motion) is not None:
        _write_motion(sheet, motion)
    cycle = sheet.export.application.duty_cycle
    table: dict[str, tuple[str, Sequence[Cell]]] = {
        head: ("", labels) for head, labels in numbers(cycle, sheet.reader).items()
    }
    for name, column in columns(cycle.load_phases).items():
        table[sheet.head(INPUTS[f"phase.{name}"].symbol, name)] = suffix_of(name), column
    sheet.table(N_("Duty cycle"), table)
    sheet.page(WIDTHS)


def _line(sheet: Sheet, path: str) -> Line:
    value = value_of(sheet.export.equipped, path)
    if isinstance(value, dict):  # with the unit behind each number
        return Line(INPUTS[path], written(value, path, sheet.reader), "")
    return Line(INPUTS[path], _cell(value), suffix_of(path))


def _cell(value: float | str | bool | tuple[str | int, ...] | None) -> Cell:
    if isinstance(value, tuple):
        return ", ".join(map(str, value))
    return WORDS.get(str(value), str(value)) if isinstance(value, str | bool) else value


def _write_motion(sheet: Sheet, motion: Motion) -> None:
    """Write mechanism and moves as they were given."""
    lines = (
        Line(named, MOTION_WORDS[value] if isinstance(value, str) else value, "" if name == "type" else suffix_of(name))
        for name, named, value in mechanism_of(motion)
    )
    sheet.lines(MOTION_TITLE, lines)
    text = sheet.reader.text
    labels = [row_label(place, move.name) for place, move in enumerate(motion.moves)]
    table: dict[str, tuple[str, Sequence[Cell]]] = {text(N_("Move")): ("", labels)}
    for name, values in moves_of(motion).items():
        head = sheet.head(MOVES[name].symbol or text(MOVES[name].name), name)
        table[head] = suffix_of(name), [MOTION_WORDS[v] if isinstance(v, str) else v for v in values]
    sheet.table(MOVES_TITLE, table)

"""The phases of a long duty cycle as lines of one width, in as many columns as a page holds.

A table of 10,000 phases would take typst 700 MB, a cell of ten lines a quarter of it.
"""

from typing import Any

from hpn.account.motion import MOVES, moves_of, written
from hpn.files.export import Export
from hpn.files.report.tables import MOST_PHASES, columns, number_of, numbers
from hpn.words.quantities import INPUTS
from hpn.words.reader import Reader
from hpn.words.titles import row_label
from hpn.words.units import suffix_of
from hpn.words.wording import N_

GROUP = 10
"""Phases of a group, with a little space around."""

PAGE, GAP = 136, 6
"""Characters across a page, and between its columns."""


def listing(export: Export, reader: Reader) -> dict[str, Any] | None:
    """Each phase of a cycle that the first page only summarises; None where that page has them all."""
    cycle = export.application.duty_cycle
    phases, number = cycle.load_phases, number_of(cycle, reader)
    if len(phases) <= MOST_PHASES:
        return None
    table = [[head, *texts] for head, texts in numbers(cycle, reader).items()]
    for name, values in columns(phases).items():
        unit = suffix_of(name)
        head = f"{INPUTS[f'phase.{name}'].symbol} [{reader.unit(unit)}]"
        table.append([head, *("" if value is None else number(value, unit) for value in values)])
    return _laid_out(table)


def moves(export: Export, reader: Reader) -> dict[str, Any] | None:
    """Each move of a motion that the first page only counts; None where that page has them all."""
    motion = export.application.duty_cycle.motion
    if motion is None or len(motion.moves) <= MOST_PHASES:
        return None
    table = [[reader.text(N_("Move")), *(row_label(k, move.name) for k, move in enumerate(motion.moves))]]
    for name, values in moves_of(motion).items():
        unit = reader.unit(suffix_of(name))
        symbol = MOVES[name].symbol or reader.text(MOVES[name].name)
        table.append([f"{symbol} [{unit}]" if unit else symbol, *(written(value, name, reader) for value in values)])
    return _laid_out(table)


def _laid_out(table: list[list[str]]) -> dict[str, Any]:
    """Columns of texts as lines of one width, as many beside each other as a page holds."""
    widths = [max(map(len, column)) for column in table]
    head, *lines = (
        "  ".join(cell.rjust(w) for cell, w in zip(row, widths, strict=True)) for row in zip(*table, strict=True)
    )
    groups = ["\n".join(lines[start : start + GROUP]) for start in range(0, len(lines), GROUP)]
    return {"columns": max(1, (PAGE + GAP) // (len(head) + GAP)), "head": head, "groups": groups}

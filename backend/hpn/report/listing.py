"""The phases of a long duty cycle as lines of one width, in as many columns as a page holds.

A table of 10,000 phases would take typst 700 MB, a cell of ten lines a quarter of it.
"""

from typing import Any

from hpn.quantities import INPUTS
from hpn.reader import Reader
from hpn.report.export import Export
from hpn.report.tables import MOST_PHASES, columns
from hpn.units import suffix_of
from hpn.wording import N_

GROUP = 10
"""Phases of a group, with a little space around."""

PAGE, GAP = 136, 6
"""Characters across a page, and between its columns."""


def listing(export: Export, reader: Reader) -> dict[str, Any] | None:
    """Each phase of a cycle that the first page only summarises; None where that page has them all."""
    phases = export.application.duty_cycle.load_phases
    if len(phases) <= MOST_PHASES:
        return None
    table = [[reader.text(N_("Phase")), *(str(number) for number in range(1, len(phases) + 1))]]
    for name, values in columns(phases).items():
        unit = suffix_of(name) or ""
        head = f"{INPUTS[f'phase.{name}'].symbol} [{reader.unit(unit)}]"
        table.append([head, *("" if value is None else reader.exact(value, unit) for value in values)])
    widths = [max(map(len, column)) for column in table]
    head, *lines = (
        "  ".join(cell.rjust(w) for cell, w in zip(row, widths, strict=True)) for row in zip(*table, strict=True)
    )
    groups = ["\n".join(lines[start : start + GROUP]) for start in range(0, len(lines), GROUP)]
    return {"columns": max(1, (PAGE + GAP) // (len(head) + GAP)), "head": head, "groups": groups}

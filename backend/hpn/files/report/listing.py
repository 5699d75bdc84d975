"""Phases or moves of a long duty cycle as lines of equal width, in as many columns as fit on a page.

A table of 10,000 phases would take typst 700 MB, cells of ten lines each a quarter of that.
"""

from typing import Any

from hpn.account.lines import LineTable, QuantityColumn
from hpn.files.report.tables import MOST_PHASES
from hpn.words.reader import Reader

GROUP = 10
"""Phases of a group; groups stand apart by a small space."""

PAGE, GAP = 136, 6
"""Characters across a page, and characters between its columns."""


def listing(table: LineTable | None, reader: Reader) -> dict[str, Any] | None:
    """All phases or moves of a table that the first page only summarises; None where the first page lists them all."""
    if table is None or len(table) <= MOST_PHASES:
        return None
    labels = [[reader.text(head), *texts] for head, texts in table.labels.items()]
    return laid_out([*labels, *([_head(column, reader), *column.numbers(reader)] for column in table.columns)])


def _head(column: QuantityColumn, reader: Reader) -> str:
    line, unit = column.head, reader.unit(column.head.unit)
    symbol = line.named.symbol or line.label(reader)
    return f"{symbol} [{unit}]" if unit else symbol


def laid_out(table: list[list[str]]) -> dict[str, Any]:
    """Columns of texts as lines of equal width, in as many columns as fit on a page."""
    widths = [max(map(len, column)) for column in table]
    head, *lines = (
        "  ".join(cell.rjust(w) for cell, w in zip(row, widths, strict=True)) for row in zip(*table, strict=True)
    )
    groups = ["\n".join(lines[start : start + GROUP]) for start in range(0, len(lines), GROUP)]
    return {"columns": max(1, (PAGE + GAP) // (len(head) + GAP)), "head": head, "groups": groups}

"""Rows of a pasted table that are named like totals: which of them are told by their numbers to be totals."""

from collections.abc import Sequence
from math import isclose, nan

from hpn.tables.bodies import Body, Labelled
from hpn.tables.cells import DECIMALS, Decimal, Entry, entry, is_blank
from hpn.tables.columns import Column

MOST_TOTALS = 20
"""Rows named like totals that are compared with the others; of more none is taken for a total."""

THREE_DIGITS = 0.005
"""Relative error of a number rounded to three digits."""

Cells = Sequence[str]


def totals_of(body: Body, used: Sequence[Column], mark: Decimal) -> list[Labelled]:
    """Rows that are totals of the others in the columns that are used, their numbers read with a decimal mark."""
    named = {total.number for total in body.totals}
    phases = [row for number, row in zip(body.numbers, body.rows, strict=True) if number not in named]
    found = []
    for total in body.totals if phases and len(body.totals) <= MOST_TOTALS else ():
        others = [other.cells for other in body.totals if other is not total]
        if any(_sums_up(total, rows, used, mark) for rows in (phases, [*phases, *others])):
            found.append(total)
    return found


def _sums_up(total: Labelled, rows: Sequence[Cells], used: Sequence[Column], mark: Decimal) -> bool:
    """Whether all numbers of a row are the sums, the means, the largest or the smallest of other rows.

    Where its own numbers are none with this decimal mark the other counts: a formula without a format stands as 3.75
    below 0,25.
    """
    columns = []
    for column in used:
        cells = [row[column.place] for row in (total.cells, *rows) if not is_blank(row[column.place])]
        if cells and cells[0] is total.cells[column.place] and cells[0] != total.text:
            columns.append([_entry(cells[0], mark), *(entry(cell, mark) for cell in cells[1:])])
    read = [[float(cell.number) if cell else nan for cell in column] for column in columns]
    of_one_unit = all(len({cell and cell.unit for cell in column}) == 1 for column in columns)
    figures = (sum, _mean, max, min)
    return (
        len(rows) > 1
        and of_one_unit
        and any(
            all(isclose(first, figure(others or [nan]), rel_tol=THREE_DIGITS) for first, *others in read)
            for figure in figures
        )
    )


def _entry(cell: str, mark: Decimal) -> Entry | None:
    return next(filter(None, (entry(cell, each) for each in (mark, *DECIMALS))), None)


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)

"""Head of a table: rows that name the columns, rows of their units, and skipped rows above."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from hpn.tables.cells import is_blank, is_meant_as_number, spanned
from hpn.tables.factors import has_factors
from hpn.tables.headings import LONGEST_WRITTEN, QUANTITIES, UNIT, heading_of, is_qualifier, quantities_of
from hpn.tables.shafts import is_of_motor
from hpn.tables.sheets import MOST_HEAD_ROWS, Grid, RefusedError
from hpn.words.patterns import Pattern
from hpn.words.wording import N_, Sentence, first_of

REQUIRED = ("T", "n", "t")
"""Quantities without which there is no phase."""

HEAD_ROWS, HEAD_CELLS = MOST_HEAD_ROWS, 4000
"""Rows that are searched for the header, and their cells: fewer rows of a wide table."""

MOST_ABOVE = 3
"""Rows of names above the lowest: groups of columns, and groups of those."""

MOST_TURNED = 20
"""Rows, at most, of a table whose first column names the quantities."""

MOST_COLUMNS = 200
"""Columns, at most, of a table of phases or axes, after it was turned upright."""

MOST_NAMED = 5
"""Rows that a note names."""

MOST_SKIPPED = 3
"""Rows above the header that are quoted one by one."""

_MARKED = Pattern(r"#+\s*(?=[^\W\d_])(?!(?:N/A|NV|N/V|[A-ZÄÖÜ0/]+[!?])$)", LONGEST_WRITTEN)
"""The sign of a comment before a heading; the errors of spreadsheet programs begin with it as well."""


@dataclass(frozen=True, slots=True)
class Head:
    """Texts above each column, the first row below the header, the header's count of rows, and notes about skipped
    rows.
    """

    headings: tuple[tuple[str, ...], ...]
    end: int
    count: int
    notes: tuple[Sentence, ...]


SKIPPED = N_("Row {row} is skipped: {text}")


def skipped(number: int, text: str) -> Sentence:
    """Note for a row that is left out."""
    return Sentence(SKIPPED, {"row": number, "text": text[:60]})


def left_out(numbers: Sequence[int]) -> Sentence:
    """Note for rows that last 0 s."""
    return Sentence(N_("Rows that last 0 s are left out: {rows}."), {"rows": first_of(numbers, MOST_NAMED)})


def is_comment(row: Sequence[str]) -> bool:
    """True for a row that begins with the sign of a comment, and has fewer numbers than a phase."""
    return bool(_MARKED.match(row[0])) and numbers_in(row) < len(REQUIRED)


def uncommented(grid: Grid) -> Grid:
    """A table without the `#` that programs write before a header, also as a cell of its own between blanks.

    A `#` above a column of numbers stays: it is the heading of an index.
    """
    usual = Counter(reversed(grid.counts)).most_common(1)[0][0] if grid.counts else 0
    rows, counts = list(grid.rows), list(grid.counts)
    first = next((k for k, row in enumerate(rows[:HEAD_ROWS]) if numbers_in(row) >= len(REQUIRED)), HEAD_ROWS)
    for k, row in enumerate(rows[: first + 1]):
        if row[0] == "#" and grid.separator in ("blank", "blanks") and counts[k] == usual + 1:
            rows[k], counts[k] = (*row[1:], ""), usual
        elif mark := _MARKED.match(row[0]):
            rows[k] = (row[0][mark.end() :], *row[1:])
    width = grid.width
    while width > 1 and not any(row[width - 1] for row in rows):
        width -= 1
    return replace(grid, rows=tuple(row[:width] for row in rows), counts=tuple(counts))


def upright(grid: Grid) -> Grid:
    """The table with a row per phase: turned where its first column names the quantities."""
    if len(grid.rows) > MOST_TURNED:
        return grid
    across = max(_named_quantities(row) for row in grid.rows)
    turned = grid.transposed()
    down = max(
        _named_quantities(row, with_units=across < 2) for row in turned.rows[:MOST_TURNED]
    )  # a row below the names has units
    if down < 2:
        return grid
    if across >= 2:
        raise RefusedError(N_("quantities are named both in a row and in a column: paste one table at a time"))
    return turned


Names = Callable[[Sequence[str]], int]
"""Function that counts the figures which some cells name."""


def head_of(grid: Grid, *, named_in: Names | None = None) -> Head:
    """Head of an upright table; raises RefusedError for numbers above it.

    Where each row begins with a name, `named_in` counts the figures that a row of headings names, and one number beside
    the name is enough to end the head.
    """
    named_rows = named_in is not None
    top_rows = grid.rows[: max(1, min(HEAD_ROWS, HEAD_CELLS // grid.width))]
    named = [max(_named_quantities(row), named_in(row) if named_in else 0) for row in top_rows]
    if max(named) >= 2:
        bottom = named.index(max(named))
        end = bottom + 1
        while end < len(grid.rows) and (_continues(grid.rows[end]) or _qualifies(grid.rows[end], grid.rows[end - 1])):
            end += 1
        last = end - 1
    else:
        end = 0
        while end < len(grid.rows) and numbers_in(row := grid.rows[end]) < min(
            2, max(_filled_cells(row) - named_rows, named_rows)
        ):
            end += 1
        several = [k for k in range(end) if _filled_cells(grid.rows[k]) >= min(2, grid.width - 1)]
        if named_rows:  # a row whose only number is beside a name has other cells that can't be read
            several = [k for k in several if not numbers_in(grid.rows[k])]
        last = bottom = several[-1] if several else -1
        while last >= 0 and last + 1 < end and has_factors(grid.rows[last + 1]):
            last += 1
    top = bottom
    while top > max(0, bottom - MOST_ABOVE) and _heads(grid.rows[top - 1], grid.rows[top]):
        top -= 1
    places = range(max(top, 0), last + 1)
    notes = _notes(grid, [k for k in range(end) if k not in places])
    return Head(_headings([grid.rows[k] for k in places], grid.width), end, len(places), notes)


def _notes(grid: Grid, places: Sequence[int]) -> tuple[Sentence, ...]:
    for place in places:
        if numbers_in(grid.rows[place]) >= 3:
            raise RefusedError(N_("row {row} has numbers above the header"), row=grid.numbers[place])
    if len(places) > MOST_SKIPPED:
        template = N_("{count} rows above the header are skipped: {first} to {last}.")
        numbers = {"first": grid.numbers[places[0]], "last": grid.numbers[places[-1]]}
        return (Sentence(template, {"count": len(places), **numbers}),)
    return tuple(skipped(grid.numbers[place], " ".join(filter(None, grid.rows[place]))) for place in places)


def _named_quantities(row: Sequence[str], *, with_units: bool = True) -> int:
    """Number of quantities that a row names, by name or by unit."""
    headings = [heading_of(cell) for cell in row[:MOST_COLUMNS]]
    quantities = {heading.kind or heading.likely for heading in headings if heading.names_quantity}
    known = {QUANTITIES[each] for each in quantities}
    for heading in headings if with_units else ():
        measured = quantities_of(heading.unit) - known if heading.kind == UNIT else ()
        quantities |= {role for role in REQUIRED if QUANTITIES[role] in measured}
    return len(quantities)


def numbers_in(row: Sequence[str]) -> int:
    """Number of cells with a number or a stand-in for one."""
    return sum(is_meant_as_number(cell) for cell in row)


def _filled_cells(row: Sequence[str]) -> int:
    return sum(map(bool, row))


def _continues(row: Sequence[str]) -> bool:
    """True for a row of units, factors or further names below the quantities; a dash is none of these."""
    filled = [cell for cell in row if not is_blank(cell)]
    count = sum(heading_of(cell).kind in (*QUANTITIES, UNIT) for cell in filled)
    return bool(filled) and (count >= min(2, len(filled)) or has_factors(row))


def _qualifies(row: Sequence[str], above: Sequence[str]) -> bool:
    """True for a row that tells which figure of the quantities above it a column holds: `max` below `Torque`."""
    filled = [(k, cell) for k, cell in enumerate(row) if not is_blank(cell)]
    words = [k for k, cell in filled if is_qualifier(cell)]
    others = [cell for k, cell in filled if k not in words]
    over = [next((cell for cell in reversed(above[: k + 1]) if cell), "") for k in words]
    return any(heading_of(cell).kind in QUANTITIES for cell in over) and all(
        heading_of(cell).kind in (*QUANTITIES, UNIT) for cell in others
    )


def _heads(row: Sequence[str], below: Sequence[str]) -> bool:
    """True for a row of names or factors above a header row, but not for a title or a pair such as `Project;Axis 7`."""
    if has_factors(row):
        return True
    filled = [(k, cell) for k, cell in enumerate(row) if not is_blank(cell)]
    if any(is_meant_as_number(cell) or cell[0].isdigit() or cell[-1] == ":" for _, cell in filled):
        return False
    if len(filled) < 2:
        return any(_is_group(k, cell, below) for k, cell in filled)
    if all(is_of_motor(cell) and ":" not in cell for _, cell in filled):
        return True
    if all(heading_of(cell).kind == UNIT for cell in below):
        return True
    reaches_down = any(heading_of(cell).names_quantity and is_blank(below[k]) for k, cell in filled)
    pair = filled[-1][0] <= 1 and not reaches_down
    return not pair or all(heading_of(cell).kind in (*QUANTITIES, UNIT) for _, cell in filled)


def _is_group(place: int, cell: str, below: Sequence[str]) -> bool:
    """True for the only name in its row if it is a heading of columns rather than a title.

    That is a name of the motor, or a name over some of the columns: merged, or behind the first with two below it.
    """
    named = [k for k, under in enumerate(below) if not is_blank(under)]
    over = [k for k in named if place <= k < place + spanned(cell)]
    if len(over) > 1:
        return len(over) < len(named)
    if is_of_motor(cell):
        return ":" not in cell
    return bool(named) and place > named[0] and {place, place + 1}.issubset(named)


def _headings(head: Sequence[Sequence[str]], width: int) -> tuple[tuple[str, ...], ...]:
    """Texts above each column, from the top; a name over several columns is above each of them.

    A spreadsheet writes such a name only into the first of its columns. A time belongs to no shaft: it ends the name's
    reach.
    """
    headings = [list[str]() for _ in range(width)]
    for row, below in zip(head, [*head[1:], ()], strict=False):
        over, has_names, end = "", False, 0
        for k, cell in enumerate(row):
            under = below[k] if below and not is_blank(below[k]) and heading_of(below[k]).kind != UNIT else ""
            if not is_blank(cell):
                over, has_names, end = cell, bool(under), k + spanned(cell)
            elif k == end or not under or heading_of(under).kind == "t":
                over = ""
            if text := cell or (over if has_names or is_qualifier(under) else ""):
                headings[k].append(text)
    return tuple(map(tuple, headings))

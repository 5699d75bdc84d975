"""Head of a table: which of its rows name the columns, which say their units, and what stands above and is skipped."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

from hpn.tables.cells import is_blank, is_meant_as_number, spanned
from hpn.tables.headings import LONGEST_WRITTEN, QUANTITIES, UNIT, heading_of, is_qualifier, quantities_of
from hpn.tables.shafts import is_of_motor
from hpn.tables.sheets import MOST_HEAD_ROWS, Grid, RefusedError
from hpn.words.patterns import Pattern
from hpn.words.wording import N_, Sentence

REQUIRED = ("T", "n", "t")
"""Quantities without which there is no phase."""

HEAD_ROWS, HEAD_CELLS = MOST_HEAD_ROWS, 4000
"""Rows among which the header is looked for, and their cells: of a wide table fewer rows."""

MOST_ABOVE = 3
"""Rows of names above the lowest: groups of columns, and groups of those."""

MOST_TURNED = 20
"""Rows of a table whose quantities stand down its side."""

MOST_COLUMNS = 200
"""Columns that a table of phases or axes may have, once it has a row for each phase."""

MOST_NAMED = 5
"""Rows that a note names."""

MOST_SKIPPED = 3
"""Rows above the header that are quoted one by one."""

_MARKED = Pattern(r"#+\s*(?=[^\W\d_])(?!(?:N/A|NV|N/V|[A-ZÄÖÜ0/]+[!?])$)", LONGEST_WRITTEN)
"""The sign of a comment before a heading; the errors of spreadsheet programs begin with it as well."""


@dataclass(frozen=True, slots=True)
class Head:
    """Texts above each column, the first row below the header, how many rows that has, and notes about skipped rows."""

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
    listed = ", ".join([*map(str, numbers[:MOST_NAMED]), *(["…"] if len(numbers) > MOST_NAMED else [])])
    return Sentence(N_("Rows that last 0 s are left out: {rows}."), {"rows": listed})


def is_comment(row: Sequence[str]) -> bool:
    """True for a row that begins with the sign of a comment, and has too few numbers for a phase."""
    return bool(_MARKED.match(row[0])) and numbers_in(row) < len(REQUIRED)


def uncommented(grid: Grid) -> Grid:
    """A table without the `#` that programs write before a header, in a cell of its own where blanks part the columns.

    A `#` above a column of numbers stays: it is the heading of their index.
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
    across = max(_named(row) for row in grid.rows)
    turned = grid.transposed()
    down = max(
        _named(row, with_units=across < 2) for row in turned.rows[:MOST_TURNED]
    )  # a row below the names has units
    if down < 2:
        return grid
    if across >= 2:
        raise RefusedError(N_("quantities are named both in a row and in a column: paste one table at a time"))
    return turned


def head_of(grid: Grid, *, named_rows: bool = False) -> Head:
    """Head of an upright table; raises RefusedError where numbers stand above it.

    Where each row begins with a name, one number beside it makes a row below the head.
    """
    named = [_named(row) for row in grid.rows[: max(1, min(HEAD_ROWS, HEAD_CELLS // grid.width))]]
    if max(named) >= 2:
        bottom = named.index(max(named))
        end = bottom + 1
        while end < len(grid.rows) and (_continues(grid.rows[end]) or _qualifies(grid.rows[end], grid.rows[end - 1])):
            end += 1
        last = end - 1
    else:
        end = 0
        while end < len(grid.rows) and numbers_in(row := grid.rows[end]) < min(
            2, max(_filled(row) - named_rows, named_rows)
        ):
            end += 1
        several = [k for k in range(end) if _filled(grid.rows[k]) >= min(2, grid.width - 1)]
        last = bottom = several[-1] if several else -1
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


def _named(row: Sequence[str], *, with_units: bool = True) -> int:
    """Number of quantities that a row names, by name or by unit."""
    quantities = set()
    for cell in row[:MOST_COLUMNS]:
        heading = heading_of(cell)
        if heading.names_quantity:
            quantities.add(heading.kind or heading.meant)
        elif heading.kind == UNIT and with_units:
            measured = quantities_of(heading.unit)
            quantities |= {role for role in REQUIRED if QUANTITIES[role] in measured}
    return len(quantities)


def numbers_in(row: Sequence[str]) -> int:
    """Number of cells that are numbers, or stand where numbers do."""
    return sum(is_meant_as_number(cell) for cell in row)


def _filled(row: Sequence[str]) -> int:
    return sum(map(bool, row))


def _continues(row: Sequence[str]) -> bool:
    """True for units or further names below those of the quantities; a dash is neither."""
    filled = [cell for cell in row if not is_blank(cell)]
    said = sum(heading_of(cell).kind in (*QUANTITIES, UNIT) for cell in filled)
    return bool(filled) and said >= min(2, len(filled))


def _qualifies(row: Sequence[str], above: Sequence[str]) -> bool:
    """True for a row that says which figure of the quantities above a column holds: `max` below `Torque`."""
    filled = [(k, cell) for k, cell in enumerate(row) if not is_blank(cell)]
    words = [k for k, cell in filled if is_qualifier(cell)]
    others = [cell for k, cell in filled if k not in words]
    over = [next((cell for cell in reversed(above[: k + 1]) if cell), "") for k in words]
    return any(heading_of(cell).kind in QUANTITIES for cell in over) and all(
        heading_of(cell).kind in (*QUANTITIES, UNIT) for cell in others
    )


def _heads(row: Sequence[str], below: Sequence[str]) -> bool:
    """True for a row of names above a row of the header, which are no title and no pair such as `Project;Axis 7`."""
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
    """True for the only name in its row where it belongs to columns, and is no title.

    Such is a name of the motor, and one over some of the columns: merged, or behind the first with two below it.
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

    A spreadsheet writes such a name into the first of its columns alone. A time is one of no shaft: it ends the name's
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

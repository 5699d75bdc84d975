"""From a file or a text to a reading, as plain data: the only way in for tables of phases, axes and motors.

The contents of cells are examined only here: a service calls this in a process with limited memory and time, and shows
the result.
"""

import hashlib
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from hpn.tables.axes import read_axes
from hpn.tables.columns import ANY, NO_CHOICES, Choices
from hpn.tables.cycles import read_grids
from hpn.tables.files import TableBounds, contents_of
from hpn.tables.motors import read_motors
from hpn.tables.outcomes import with_outcomes
from hpn.tables.sheets import Grid
from hpn.tables.table import Table
from hpn.words.wording import Sentence


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """A file or a text as the program understands it, with its open questions.

    `of` is the mark of its content, to which answers belong. Without a `table` the user is asked for one of its
    `sheets`; or `suffix` names the format of a table that is taken unread, or `text` is an object of JSON.
    """

    of: str = ""
    text: str = ""
    sheets: tuple[str, ...] = ()
    sheet: str = ""
    table: Table | None = None
    suffix: str = ""
    is_application: bool = False


def reading_of(
    content: bytes | str, bounds: TableBounds, choices: Choices = NO_CHOICES, assumed: Collection[str] = ()
) -> Reading:
    """Reading of a file or a text with the answers to its questions; raises nothing but MemoryError.

    A column without a unit is in one of the `assumed` units.
    """
    contents = contents_of(content, bounds)
    if contents.problem:
        return Reading(text=contents.text, table=Table(problem=contents.problem))
    if contents.suffix or contents.is_application:
        return Reading(text=contents.text, suffix=contents.suffix, is_application=contents.is_application)
    whole = contents.text or content
    of = hashlib.sha256(whole.encode(errors="replace") if isinstance(whole, str) else whole).hexdigest()[:16]
    if choices.of not in (of, ANY):
        choices = NO_CHOICES
    sheets = tuple(contents.sheets)
    first = sheets[0] if len(sheets) == 1 or bounds.inputs.has_axes else ""
    sheet = choices.sheet if choices.sheet in sheets else first
    table = _table(contents.sheets[sheet], bounds, choices, assumed) if sheet in sheets else None
    return Reading(of=of, text=contents.text, sheets=sheets, sheet=sheet, table=table)


def _table(sheets: Sequence[Grid] | Sentence, bounds: TableBounds, choices: Choices, assumed: Collection[str]) -> Table:
    """The table of a sheet; for axes or motors the separator that gives most known columns."""
    if isinstance(sheets, Sentence):
        return Table(problem=sheets)
    if bounds.inputs.has_axes:
        read = read_motors if bounds.inputs.has_motors else read_axes
        tables = [read(grid, bounds.inputs, choices, assumed) for grid in sheets]
        return max(tables, key=lambda table: sum(bool(column.role) for column in table.columns))
    return with_outcomes(read_grids(sheets, choices, assumed), sheets, choices, assumed)

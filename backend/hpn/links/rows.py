"""Columns and rows of the tables of a form: phases, moves, bodies; the buttons that edit them; phases as one text."""

import re
from collections.abc import Collection, Iterable, Mapping, Sequence

from hpn.tables.inputs import NAME, PHASE_ROLES
from hpn.words.fields import MAXIMUM_PHASES

LOADS = ("FRi", "FAi")
OPTIONAL: Mapping[str, tuple[str, ...]] = {
    "names": (NAME.role,),
    "loads": LOADS,
    "varying": ("Tpk", "npk", "Trms", "Tlo"),
    "ramps": ("mta", "mtd"),
    "unequal": ("md2",),
    "jerk": ("mjk",),
}
"""Columns of phases and moves that appear where they are used, by the button that shows them."""

SHARED = ("names", "loads")
"""Groups that phases and moves have by the same names."""

EVEN = "ma"
"""Acceleration of both ramps, or of the first beside a deceleration; beside ramps by time it has a column only
if used."""

OF_ANY_ROW = (NAME.role, *LOADS)

_TIMED = ("ms", "mt", "mn", EVEN)
_RAMPS = (*OPTIONAL["ramps"], *OPTIONAL["unequal"])
_EVERY_MOVE = ("mx", *OF_ANY_ROW)
MOVE_COLUMNS: Mapping[str, tuple[str, ...]] = {
    "trapezoidal": (*_TIMED, *_RAMPS, *_EVERY_MOVE),
    "triangular": (*_TIMED, *_EVERY_MOVE),
    "s_curve": (*_TIMED, *_RAMPS, "mj", *OPTIONAL["jerk"], *_EVERY_MOVE),
    "modified_sine": ("ms", "mt", *_EVERY_MOVE),
    "dwell": ("mt", *_EVERY_MOVE),
}
"""Columns of a move, by its profile."""

_EVERY_BODY = ("qm", "qe", "qn")
BODY_COLUMNS: Mapping[str, tuple[str, ...]] = {
    "disc": (*_EVERY_BODY, "qr", "qd", "qh"),
    "ring": (*_EVERY_BODY, "qr", "qd", "qi", "qh"),
    "bar": (*_EVERY_BODY, "qr", "qd", "ql"),
    "block": (*_EVERY_BODY, "qr", "ql", "qw", "qh"),
    "point_mass": _EVERY_BODY,
}
"""Columns of a body, by its shape."""

TOLERANCE = "tol"
"""Field for a tolerance of an input of the form, repeated."""

TEXT = "phases"
"""Field of the form with the phases as text, a phase on each line, where they are too many for a table."""

ROWS_IN_TABLE = 100
"""Most rows of a table; a longer duty cycle is edited as text, since a field for each figure would weigh megabytes."""

WIDTHS = {"names": 10, "varying": 9, "loads": 5}
"""Cells of a line of that text, by the groups that the phases have."""


def groups_of(used: Collection[str]) -> set[str]:
    """Groups of optional columns with a used one."""
    return {group for group, names in OPTIONAL.items() if any(name in used for name in names)}


def shown_columns(names: Iterable[str], groups: Collection[str]) -> list[str]:
    """Columns of phases or moves; optional ones only from the given groups."""
    hidden = {name for group, columns in OPTIONAL.items() if group not in groups for name in columns}
    if "ramps" in groups and "unequal" not in groups and EVEN not in groups:
        hidden.add(EVEN)
    return [name for name in names if name not in hidden]


def used_columns(names: Iterable[str], used: Collection[str]) -> list[str]:
    """Columns of phases or moves; optional ones only from groups with a used column."""
    return shown_columns(names, groups_of(used))


class FormTable:
    """Rows of cells by column, and the buttons that edit them."""

    def __init__(self, names: Iterable[str], most: int) -> None:
        self.names = list(names)
        self.most = most
        self.counts: dict[str, int] = {}
        self.rows: list[dict[str, str]] = []

    def add(self, name: str, text: str) -> None:
        """Put a cell below the last one of its column; rows after the first one above `most` are left out."""
        k = self.counts.get(name, 0)
        self.counts[name] = k + 1
        if k == len(self.rows) and k <= self.most:
            self._append()
        if k < len(self.rows):
            self.rows[k][name] = text

    def show(self, names: Sequence[str]) -> None:
        """Show only these columns, and at least one blank row."""
        hidden = set(self.names).difference(names)
        added = [name for name in names if name not in self.names]
        self.names = list(names)
        for row in self.rows:
            for name in hidden:
                del row[name]
            row.update({name: "" for name in added if name not in row})
        if not self.rows:
            self._append()

    def widen(self, name: str) -> None:
        """Add a blank column."""
        if name not in self.names:
            self.names.append(name)
            self.counts[name] = max(self.counts.values(), default=0)
            for row in self.rows:
                row.setdefault(name, "")

    def press(self, do: str, k: int) -> str | None:
        """Edit the rows as one button does; returns the id of the element to focus, or None where nothing changes."""
        if do == "add":
            self._append()
            return self._first_of(len(self.rows) - 1)
        if not 0 <= k < len(self.rows):
            return None
        if do == "remove":
            del self.rows[k]
            if not self.rows:
                self._append()
            return self._first_of(min(k, len(self.rows) - 1))
        if do in ("up", "down"):
            to = min(max(k + (1 if do == "down" else -1), 0), len(self.rows) - 1)
            self.rows.insert(to, self.rows.pop(k))
            return self._first_of(to)
        return None

    def _append(self) -> None:
        self.rows.append(dict.fromkeys(self.names, ""))

    def _first_of(self, k: int) -> str:
        """Id of the first cell of a row."""
        return f"{self.names[0]}-{k}"


def filled(row: Mapping[str, str]) -> dict[str, str]:
    """Texts of a row that are not blank, by their names."""
    return {name: text for name, text in row.items() if text.strip()}


def cells_of(text: str) -> list[tuple[str, str]]:
    """Names and cells of phases in a text: T, n, t, and the used ones of the others; a missing cell of a line is blank.

    Tabs, semicolons or blanks separate the cells of a line; the tenth cell is the name, with all that follows.
    """
    lines = text.rstrip().splitlines()[: MAXIMUM_PHASES + 1]
    rows = [re.split(r" *[;\t] *| +", line.strip(" "), maxsplit=len(PHASE_ROLES)) for line in lines]
    columns = {
        name: [row[k] if k < len(row) else "" for row in rows] for k, name in enumerate((*PHASE_ROLES, NAME.role))
    }
    names = used_columns(columns, {name for name, texts in columns.items() if any(texts)})
    return [(name, columns[name][k].strip()) for k in range(len(rows)) for name in names]

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
    "ramps": ("mta", "mtd", "md2"),
    "jerk": ("mjk",),
}
"""Columns of phases and moves that appear where they are used, by the button that shows them."""

SHARED = ("names", "loads")
"""Those that phases and moves have by the same names."""

OF_ANY_ROW = (NAME.role, *LOADS)

_TIMED = ("ms", "mt", "mn", "ma")
_EVERY_MOVE = ("mx", *OF_ANY_ROW)
MOVE_COLUMNS: Mapping[str, tuple[str, ...]] = {
    "trapezoidal": (*_TIMED, *OPTIONAL["ramps"], *_EVERY_MOVE),
    "triangular": (*_TIMED, *_EVERY_MOVE),
    "s_curve": (*_TIMED, *OPTIONAL["ramps"], "mj", *OPTIONAL["jerk"], *_EVERY_MOVE),
    "modified_sine": ("ms", "mt", *_EVERY_MOVE),
    "dwell": ("mt", *_EVERY_MOVE),
}
"""Columns that a move of a profile has."""

_EVERY_BODY = ("qm", "qe", "qn")
BODY_COLUMNS: Mapping[str, tuple[str, ...]] = {
    "disc": (*_EVERY_BODY, "qr", "qd", "qh"),
    "ring": (*_EVERY_BODY, "qr", "qd", "qi", "qh"),
    "bar": (*_EVERY_BODY, "qr", "qd", "ql"),
    "block": (*_EVERY_BODY, "qr", "ql", "qw", "qh"),
    "point_mass": _EVERY_BODY,
}
"""Columns that a body of a shape has."""

TEXT = "phases"
"""Field of the form that holds the phases as text, a phase on each line, where they are too many for a table."""

WIDTHS = {"names": 10, "varying": 9, "loads": 5}
"""Cells of a line of that text by what the phases have."""


def groups_of(used: Collection[str]) -> set[str]:
    """Groups of optional columns of which one is used."""
    return {group for group, names in OPTIONAL.items() if any(name in used for name in names)}


def shown_columns(names: Iterable[str], groups: Collection[str]) -> list[str]:
    """Columns of phases or moves, of the optional ones those of some groups alone."""
    hidden = {name for group, columns in OPTIONAL.items() if group not in groups for name in columns}
    return [name for name in names if name not in hidden]


def used_columns(names: Iterable[str], used: Collection[str]) -> list[str]:
    """Columns of phases or moves, of the optional ones the groups of which one is used."""
    return shown_columns(names, groups_of(used))


class Rows:
    """Rows of a table, each with the place at which it stood before the buttons that edit it.

    The first of the columns takes the focus where a row is new.
    """

    def __init__(self, columns: Mapping[str, list[str]], names: Sequence[str], most: int) -> None:
        self.names = list(names)
        length = max((len(texts) for name, texts in columns.items() if name in self.names), default=0)
        self.placed: list[tuple[int | None, dict[str, str]]] = [
            (k, {name: texts[k] if k < len(texts := columns.get(name, [])) else "" for name in self.names})
            for k in range(min(length, most + 1))
        ]

    @property
    def texts(self) -> list[dict[str, str]]:
        """The rows, at least a blank one."""
        return [row for _, row in self.placed] or [dict.fromkeys(self.names, "")]

    @property
    def origins(self) -> tuple[int | None, ...]:
        """Place at which each row stood."""
        return tuple(origin for origin, _ in self.placed) or (None,)

    def show(self, names: Sequence[str]) -> None:
        """Have these columns alone."""
        self.names = list(names)
        self.placed = [(origin, {name: row.get(name, "") for name in self.names}) for origin, row in self.placed]

    def press(self, do: str, k: int) -> str | None:
        """Edit the rows as one button does; the element to go on from, if it does anything."""
        first = self.names[0]
        if do == "add":
            self.placed.append((None, dict.fromkeys(self.names, "")))
            return f"{first}-{len(self.placed) - 1}"
        if not 0 <= k < len(self.placed):
            return None
        if do == "remove":
            del self.placed[k]
            return f"{first}-{min(k, max(len(self.placed) - 1, 0))}"
        if do in ("up", "down"):
            to = min(max(k + (1 if do == "down" else -1), 0), len(self.placed) - 1)
            self.placed.insert(to, self.placed.pop(k))
            return f"{first}-{to}"
        return None


def filled(row: Mapping[str, str]) -> dict[str, str]:
    """Texts of a row that are not blank, by their names."""
    return {name: text for name, text in row.items() if text.strip()}


def expanded(pairs: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
    """Pairs of a form with repeated T, n, t, and the others where used, in place of the text of the phases."""
    plain = [pair for pair in pairs if pair[0] != TEXT]
    for name, text in pairs:
        if name == TEXT:
            lines = text.rstrip().splitlines()[: MAXIMUM_PHASES + 1]
            plain += _phase_pairs([_cells(line) for line in lines])
    return plain


def _cells(line: str) -> list[str]:
    """Cells of a line, separated by tabs, semicolons or blanks; a tenth is the name, with all that follows."""
    return re.split(r" *[;\t] *| +", line.strip(" "), maxsplit=len(PHASE_ROLES))


def _phase_pairs(rows: Sequence[Sequence[str]]) -> list[tuple[str, str]]:
    """Pairs of rows in the order T, n, t, FRi, FAi, Tpk, npk, Trms, Tlo, pn; what a short row lacks is blank."""
    columns = {
        name: [row[k] if k < len(row) else "" for row in rows] for k, name in enumerate((*PHASE_ROLES, NAME.role))
    }
    names = used_columns(columns, {name for name, texts in columns.items() if any(texts)})
    return [(name, columns[name][k].strip()) for k in range(len(rows)) for name in names]

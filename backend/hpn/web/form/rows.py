"""Rows of the tables of a form: phases, moves, bodies; the buttons that edit them, and phases as one text."""

import re
from collections.abc import Mapping, Sequence

from hpn.web.form.symbols import OPTIONAL, PHASE_SYMBOLS, shown_columns
from hpn.words.fields import MAXIMUM_PHASES

TEXT = "phases"
"""Field of the form that holds the phases as text, a phase on each line, where they are too many for a table."""

WIDTHS = {"names": 9, "varying": 8, "loads": 5}
"""Cells of a line of that text by what the phases have."""


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


def expanded(pairs: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
    """Pairs of a form with repeated T, n, t, and the others where used, in place of the text of the phases."""
    plain = [pair for pair in pairs if pair[0] != TEXT]
    for name, text in pairs:
        if name == TEXT:
            lines = text.rstrip().splitlines()[: MAXIMUM_PHASES + 1]
            plain += _phase_pairs([_cells(line) for line in lines])
    return plain


def _cells(line: str) -> list[str]:
    """Cells of a line, separated by tabs, semicolons or blanks; a ninth is the name, with all that follows."""
    return re.split(r" *[;\t] *| +", line.strip(" "), maxsplit=len(PHASE_SYMBOLS) - 1)


def _phase_pairs(rows: Sequence[Sequence[str]]) -> list[tuple[str, str]]:
    """Pairs of rows in the order T, n, t, FRi, FAi, Tpk, npk, Trms, pn; what a short row lacks is blank."""
    columns = {symbol.name: [row[k] if k < len(row) else "" for row in rows] for k, symbol in enumerate(PHASE_SYMBOLS)}
    used = {group for group, names in OPTIONAL.items() if any(any(columns.get(name, ())) for name in names)}
    names = shown_columns(columns, used)
    return [(name, columns[name][k].strip()) for k in range(len(rows)) for name in names]

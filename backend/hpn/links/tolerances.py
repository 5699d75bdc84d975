"""Tolerances in links: `tol`, repeated; each is a symbol, with a row where it has one, and the deviation.

`T:10p` is 10 percent of every torque, `T.2:10p` of the torque in the second row, `J:0.05` an amount in the input's own
unit, `Jm:0p/15p` the deviations below and above the value.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple

from hpn.application import Application
from hpn.application.tolerances import Deviation, Tolerance
from hpn.links.row_symbols import MOVE_BY_LEAF, PHASE_BY_LEAF, PHASE_BY_NAME, move_symbols
from hpn.links.symbol import MOTION_PATH
from hpn.links.symbols import BY_NAME, BY_PATH
from hpn.tables.numbers import read_value
from hpn.words.wording import N_, Sentence

LONGEST = 200
WRITTEN = re.compile(r"([A-Za-z0-9]+)(?:\.([1-9][0-9]{0,4}))?:([^/:]+)(?:/([^/:]+))?")
COLUMNS = (*PHASE_BY_LEAF, *MOVE_BY_LEAF)
ORDER = {name: place for place, name in enumerate((*PHASE_BY_NAME, *BY_NAME))}
MOVES = ".".join((*MOTION_PATH[1:], "moves"))

NO_TOLERANCE = N_("must be a symbol and its tolerance, such as T:10p, T.2:0.5 or Jm:0p/15p")
UNKNOWN = N_("{symbol} is not the symbol of an input that takes a tolerance here")
TWICE = N_("{symbol} has a tolerance twice")


class Side(NamedTuple):
    """Deviation of an input to one side: a number as a text, in percent or in the input's unit."""

    number: str
    is_percent: bool


class Sides(str):
    """Tolerance in the form of a link, with its one part, or those below and above the value."""

    parts: tuple[Side, ...]

    def __new__(cls, parts: Iterable[Side]) -> "Sides":
        """Tolerance of these parts; as a text it equals the tolerance in a link."""
        own = tuple(parts)
        text = super().__new__(cls, "/".join(f"{side.number}{'p' if side.is_percent else ''}" for side in own))
        text.parts = own
        return text


def sides_of(text: str) -> Sides:
    """Parts of a tolerance in a link."""
    if isinstance(text, Sides):
        return text
    parts = [part.strip() for part in text[:LONGEST].split("/")] if text.strip() else []
    return Sides(Side(part.removesuffix("p"), is_percent=part.endswith("p")) for part in parts)


def read(symbol: str, row: int | None, sides: Sides, mechanism: str | None) -> tuple[str, dict[str, Any]] | Sentence:
    """Path of a tolerance and its value, or the sentence on its fault; `mechanism` is that of a motion, else None."""
    path = path_of(symbol, row, mechanism)
    if path is None:
        return Sentence(UNKNOWN, {"symbol": symbol if row is None else f"{symbol}.{row + 1}"})
    deviations = [_deviation(side) for side in sides.parts]
    if wrong := [side for side in deviations if isinstance(side, Sentence)]:
        return wrong[0]
    values = [side for side in deviations if not isinstance(side, Sentence)]
    if not 0 < len(values) <= 2:
        return Sentence(NO_TOLERANCE)
    return path, values[0] if len(values) == 1 else dict(zip(("minus", "plus"), values, strict=True))


def read_text(text: str, mechanism: str | None) -> tuple[str, dict[str, Any]] | Sentence:
    """Path and value of a tolerance in a text such as `T.2:10p`, or the sentence on its fault."""
    match = WRITTEN.fullmatch(text.strip()) if len(text) <= LONGEST else None
    if match is None:
        return Sentence(NO_TOLERANCE)
    return read(match[1], int(match[2]) - 1 if match[2] else None, sides_of(text.strip().partition(":")[2]), mechanism)


def _deviation(side: Side) -> dict[str, float] | Sentence:
    value = read_value(side.number, "number")
    if isinstance(value, Sentence):
        return value
    return {"percent" if side.is_percent else "absolute": float(value)}


def path_of(symbol: str, row: int | None, mechanism: str | None) -> str | None:
    """Path of an input by its symbol and row, counted from 0; None for an unknown one."""
    if row is None:
        if symbol in PHASE_BY_NAME:
            return PHASE_BY_NAME[symbol].path[0]
        return ".".join(BY_NAME[symbol].path).removeprefix("duty_cycle.") if symbol in BY_NAME else None
    if mechanism is None:
        return f"phases.{row}.{PHASE_BY_NAME[symbol].path[0]}" if symbol in PHASE_BY_NAME else None
    fields = {each.name: each.path[-1] for each in move_symbols(mechanism)}
    return f"{MOVES}.{row}.{fields[symbol]}" if symbol in fields else None


def written(application: Application) -> Iterator[str]:
    """Tolerances of an application as in a link, in the order of symbols; those of single rows last, row by row."""
    for path, tolerance in sorted((application.tolerances or {}).items(), key=lambda each: _order(each[0])):
        yield text_of(path, tolerance)


def _order(path: str) -> tuple[int, int]:
    """Row of a path, -1 without one, and its place among the symbols."""
    *_, row, field = ("", *path.split("."))
    if row.isdigit():
        return int(row), COLUMNS.index(field) if field in COLUMNS else 0
    return -1, ORDER.get(symbol_of(path), 0)


def text_of(path: str, tolerance: Tolerance) -> str:
    """Tolerance of the input of a path in the form of a link; KeyError for an unknown path."""
    return f"{symbol_of(path)}:{_written(tolerance)}"


def symbol_of(path: str) -> str:
    """Symbol of the input of a path, with its row, counted from 1, where it has one."""
    *table, field = path.split(".")
    if table and table[-1].isdigit():
        by_leaf: Mapping[str, Any] = PHASE_BY_LEAF if table[0] == "phases" else MOVE_BY_LEAF
        return f"{by_leaf[field].name}.{int(table[-1]) + 1}"
    if not table and field in PHASE_BY_LEAF:
        return str(PHASE_BY_LEAF[field].name)
    place = (*table, field)
    return BY_PATH[("duty_cycle", *place) if path == "pause_s" or table[:1] == ["motion"] else place].name


def _written(tolerance: Tolerance) -> str:
    if tolerance.minus is not None and tolerance.plus is not None:
        return f"{_side(tolerance.minus)}/{_side(tolerance.plus)}"
    return _side(tolerance)


def _side(side: Deviation | Tolerance) -> str:
    return f"{_number(side.percent)}p" if side.percent is not None else _number(side.absolute or 0.0)


def _number(value: float) -> str:
    text = repr(value).removesuffix(".0")
    return text.replace("e+", "e").replace("e-0", "e-") if "e" in text else text

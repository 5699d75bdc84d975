"""Tolerances in links: `tol`, repeated, each a symbol with a row of its own where it has one, and how far it may lie.

`T:10p` is 10 percent of every torque, `T.2:10p` of that in the second row, `J:0.05` an amount in the input's own unit,
`Jm:0p/15p` what lies below and above the value.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from hpn.application import Application
from hpn.application.tolerances import MOST_TOLERANCES, Deviation, Tolerance
from hpn.links.symbols import BY_NAME, BY_PATH, MOTION_PATH, MOVE_BY_LEAF, PHASE_BY_LEAF, PHASE_BY_NAME, move_symbols
from hpn.tables.numbers import read_value
from hpn.words.wording import N_, Sentence

LONGEST = 200
WRITTEN = re.compile(r"([A-Za-z0-9]+)(?:\.([1-9][0-9]{0,4}))?:([^/:]+)(?:/([^/:]+))?")
MOVES = ".".join((*MOTION_PATH[1:], "moves"))

NO_TOLERANCE = N_("must be a symbol and its tolerance, such as T:10p, T.2:0.5 or Jm:0p/15p")
UNKNOWN = N_("{symbol} is not the symbol of an input that takes a tolerance here")
TWICE = N_("{symbol} has a tolerance twice")


def read(texts: Sequence[str], mechanism: str | None) -> tuple[dict[str, Any], list[Sentence]]:
    """Tolerances of a link by the paths of their inputs, and what is wrong with it; `mechanism` is that of a motion."""
    found: dict[str, Any] = {}
    faults: list[Sentence] = []
    for text in texts[: MOST_TOLERANCES + 1]:
        match = WRITTEN.fullmatch(text.strip()) if len(text) <= LONGEST else None
        if match is None:
            faults.append(Sentence(NO_TOLERANCE))
            continue
        symbol = match[1] if match[2] is None else f"{match[1]}.{match[2]}"
        path = _path_of(match[1], None if match[2] is None else int(match[2]) - 1, mechanism)
        if path is None or path in found:
            faults.append(Sentence(TWICE if path else UNKNOWN, {"symbol": symbol}))
            continue
        sides = [_deviation(side) for side in match.groups()[2:] if side is not None]
        wrong = [side for side in sides if isinstance(side, Sentence)]
        faults += wrong
        found[path] = sides[0] if len(sides) == 1 else dict(zip(("minus", "plus"), sides, strict=True))
    return found, faults


def _deviation(text: str) -> dict[str, float] | Sentence:
    text = text.strip()
    value = read_value(text.removesuffix("p"), "number")
    if isinstance(value, Sentence):
        return value
    return {"percent" if text.endswith("p") else "absolute": float(value)}


def _path_of(symbol: str, row: int | None, mechanism: str | None) -> str | None:
    """Path of an input by its symbol and row; None for one that there is none of."""
    if row is None:
        if symbol in PHASE_BY_NAME:
            return PHASE_BY_NAME[symbol].path[0]
        return _path(BY_NAME[symbol].path) if symbol in BY_NAME else None
    if mechanism is None:
        return f"phases.{row}.{PHASE_BY_NAME[symbol].path[0]}" if symbol in PHASE_BY_NAME else None
    fields = {each.name: each.path[-1] for each in move_symbols(mechanism)}
    return f"{MOVES}.{row}.{fields[symbol]}" if symbol in fields else None


def _path(place: Sequence[str]) -> str:
    return ".".join(place[1:] if place[0] == "duty_cycle" else place)


def written(application: Application) -> Iterator[str]:
    """Tolerances of an application as a link has them, in the order in which they were given."""
    for path, tolerance in (application.tolerances or {}).items():
        yield text_of(path, tolerance)


def text_of(path: str, tolerance: Tolerance) -> str:
    """Tolerance of the input that a path names as a link has it; KeyError for a path that is none."""
    return f"{symbol_of(path)}:{_written(tolerance)}"


def symbol_of(path: str) -> str:
    """Symbol of the input that a path names, with its row where it names one."""
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

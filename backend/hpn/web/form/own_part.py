"""Pairs of a link for an axis's own part of its application; an own value is written even if it equals the default."""

import json
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any
from urllib.parse import quote

from pydantic import ValidationError

from hpn.application.tolerances import Tolerance
from hpn.links.row_symbols import PHASE_SYMBOLS, move_symbols
from hpn.links.rows import TOLERANCE
from hpn.links.symbol import MOTION_PATH, Symbol
from hpn.links.symbols import BY_SIZE, CURVES, MECHANISM_SYMBOLS, SYMBOLS
from hpn.links.tolerances import text_of
from hpn.links.writer import point_text, shortened
from hpn.tables.by_size import BySize, Part
from hpn.web.form.query import CYCLE_NAMES, Pairs
from hpn.words.designations import OTHERS

Json = Mapping[str, Any]


def pairs_of_own(own: Json) -> list[tuple[str, str]]:
    """Pairs of an own part, malformed or not; a part without a cycle gets the pairs of a blank phase."""
    single = (pair for symbol in SYMBOLS for pair in _of_symbol(symbol, own))
    return [*_cycle(own), *single, *_tolerances(own.get("tolerances"))]


def written(pairs: Pairs) -> str:
    """Query of pairs in the form of canonical links."""
    return "&".join(f"{quote(name)}={quote(text, safe='/:')}" for name, text in pairs)


def _cycle(own: Json) -> Iterator[tuple[str, str]]:
    motion = _at(own, MOTION_PATH)
    if isinstance(motion, Mapping):
        for symbol in MECHANISM_SYMBOLS:
            yield from _of_symbol(symbol, own)
        kind = _at(motion, ("mechanism", "type"))
        yield from _rows(motion.get("moves"), move_symbols(kind if isinstance(kind, str) else ""))
        return
    phases = list(_rows(_at(own, ("duty_cycle", "phases")), PHASE_SYMBOLS))
    yield from phases or [(name, "") for name in ("T", "n", "t")]


def _rows(rows: Any, symbols: Sequence[Symbol]) -> Iterator[tuple[str, str]]:
    """Pairs of a table's rows, each with every column that is used in any row, and always the first three columns."""
    table = [row for row in rows if isinstance(row, Mapping)] if isinstance(rows, list) else []
    used = [s for k, s in enumerate(symbols) if k < 3 or any(row.get(s.path[-1]) is not None for row in table)]
    for row in table:
        for symbol in used:
            value = row.get(symbol.path[-1])
            yield symbol.name, "" if value is None else _text(value)


def _of_symbol(symbol: Symbol, own: Json) -> Iterator[tuple[str, str]]:
    value = _at(own, symbol.path)
    if value is None or (isinstance(value, Mapping) and not value):
        return
    if symbol.name in BY_SIZE and isinstance(value, Mapping):
        for size, number in value.items():
            yield symbol.name, _text(number) if size == OTHERS else BySize([Part(str(size), _text(number))])
    elif symbol.name in CURVES and isinstance(value, list) and all(isinstance(point, Mapping) for point in value):
        yield from ((symbol.name, point_text(point)) for point in value)
    elif symbol.many and isinstance(value, list):
        yield from ((symbol.name, _text(item)) for item in value)
    else:
        yield symbol.name, _text(value)


def _tolerances(tolerances: Any) -> Iterator[tuple[str, str]]:
    for path, value in tolerances.items() if isinstance(tolerances, Mapping) else ():
        try:
            yield TOLERANCE, text_of(path, Tolerance.model_validate(value))
        except (KeyError, ValidationError):
            yield TOLERANCE, _text({path: value})


def _at(value: Any, path: Iterable[str]) -> Any:
    for name in path:
        value = value.get(name) if isinstance(value, Mapping) else None
    return value


def _text(value: Any) -> str:
    """Text of a value in a link; a value that no link can express becomes its JSON."""
    if isinstance(value, str):
        return value
    if isinstance(value, float):
        return shortened(repr(value))
    return str(int(value)) if isinstance(value, int) else json.dumps(value)


def carried_over(now: Pairs, then: Pairs, own: Pairs, inherited: Collection[str]) -> list[tuple[str, str]]:
    """Own pairs of an axis whose whole application is to be replaced; `wo` names common values that no longer apply.

    `now` and `then` are the pairs of the canonical links of both applications, `own` the axis's present own pairs,
    `inherited` the names of common values. An own value that both links leave out, as it is a default, stays.
    """
    before, after, mine = grouped(now), grouped(then), grouped(own)
    rows = [pair for pair in then if pair[0] in CYCLE_NAMES]
    names = [name for name in dict.fromkeys((*mine, *after)) if name not in CYCLE_NAMES]
    pairs = [*rows, *(("wo", text) for text in mine.get("wo", ()))]
    for name in names:
        if name == "wo" or (name in inherited and name not in mine and before.get(name) == after.get(name)):
            continue
        texts = mine.get(name, ()) if before.get(name) == after.get(name) else after.get(name, ())
        pairs += [(name, text) for text in texts]
    left_out = [name for name in before if name in inherited and name not in after and name not in CYCLE_NAMES]
    return pairs + [("wo", name) for name in left_out if name not in mine.get("wo", ())]


def grouped(pairs: Pairs) -> dict[str, list[str]]:
    """Texts of pairs by their names."""
    texts: dict[str, list[str]] = {}
    for name, text in pairs:
        texts.setdefault(name, []).append(text)
    return texts

"""An axis's own part of its application as pairs of a link, in which an own value stands also where it is a default."""

import json
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any
from urllib.parse import quote

from pydantic import ValidationError

from hpn.application.tolerances import Tolerance
from hpn.links.row_symbols import PHASE_SYMBOLS, move_symbols
from hpn.links.rows import TOLERANCE
from hpn.links.symbol import MOTION_PATH, Symbol
from hpn.links.symbols import BY_SIZE, MECHANISM_SYMBOLS, SYMBOLS
from hpn.links.tolerances import text_of
from hpn.links.writer import shortened
from hpn.tables.by_size import BySize, Part
from hpn.web.form.given import CYCLE_NAMES, Pairs
from hpn.words.designations import OTHERS

Json = Mapping[str, Any]


def pairs_of_own(own: Json) -> list[tuple[str, str]]:
    """Pairs of an own part, whatever a caller has sent in it; of one without a cycle those of a blank phase."""
    single = (pair for symbol in SYMBOLS for pair in _of_symbol(symbol, own))
    return [*_cycle(own), *single, *_tolerances(own.get("tolerances"))]


def written(pairs: Pairs) -> str:
    """Query of pairs, as canonical links write it."""
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
    """Rows of a table, each with every figure that one of them has, and the first three in any case."""
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
    """A value as a link writes it; what no link can say is its JSON."""
    if isinstance(value, str):
        return value
    if isinstance(value, float):
        return shortened(repr(value))
    return str(int(value)) if isinstance(value, int) else json.dumps(value)


def carried_over(now: Pairs, then: Pairs, own: Pairs, inherited: Collection[str]) -> list[tuple[str, str]]:
    """Own pairs of an axis whose whole application is to be another one, `wo` for values that no longer hold.

    `now` and `then` are the pairs of the canonical links of both applications, `own` those that are the axis's own
    now, `inherited` the names of common values. An own value that both links leave out, as it is a default, stays.
    """
    before, after, mine = _grouped(now), _grouped(then), _grouped(own)
    rows = [pair for pair in then if pair[0] in CYCLE_NAMES]
    names = [name for name in dict.fromkeys((*mine, *after)) if name not in CYCLE_NAMES]
    pairs = [*rows, *(("wo", text) for text in mine.get("wo", ()))]
    for name in names:
        if name == "wo" or (name in inherited and name not in mine and before.get(name) == after.get(name)):
            continue
        texts = mine.get(name, ()) if before.get(name) == after.get(name) else after.get(name, ())
        pairs += [(name, text) for text in texts]
    gone = [name for name in before if name in inherited and name not in after and name not in CYCLE_NAMES]
    return pairs + [("wo", name) for name in gone if name not in mine.get("wo", ())]


def _grouped(pairs: Pairs) -> dict[str, list[str]]:
    texts: dict[str, list[str]] = {}
    for name, text in pairs:
        texts.setdefault(name, []).append(text)
    return texts

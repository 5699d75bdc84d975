"""Links and the form: from the symbols of a query to the application model.

The form, the address bar and every link that somebody writes by hand go through `parse`; `link_writer.to_link` is the
way back. Names are the handbook's symbols, values are in the units of the API.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from msgspec.structs import replace as with_values
from pydantic import ValidationError

from hpn.application import Application
from hpn.physics.motion.mechanisms import TYPES
from hpn.tables import numbers
from hpn.tables.by_size import BySize, Part, by_size
from hpn.tables.inputs import NAME
from hpn.tables.numbers import read_value
from hpn.web.form.form import Form
from hpn.web.form.given import REQUIRED, FieldProblem, Given
from hpn.web.form.helpers import BodyTable, body_table, with_figures
from hpn.web.form.labels import LABELS
from hpn.web.form.offers import with_offers
from hpn.web.form.refusals import refusal_of
from hpn.web.form.rows import TEXT, expanded, filled
from hpn.web.form.symbols import (
    BY_NAME,
    BY_PATH,
    BY_SIZE,
    MOTION_PATH,
    MOVE_BY_LEAF,
    PHASE_BY_LEAF,
    PHASE_BY_NAME,
    Symbol,
    move_symbols,
    units_of,
)
from hpn.web.form.ways import CYCLE_NAMES, Pairs, switched, taken_over
from hpn.words.designations import OTHERS
from hpn.words.reader import Reader
from hpn.words.terms import FOR_OTHERS
from hpn.words.titles import LONGEST_NAME, faults_of
from hpn.words.wording import N_, Sentence, Typed

_UNSEEN = re.compile("[\u00ad\u200b-\u200d\u2060\ufeff]")
"""Characters without width, which come with links copied from documents that break their lines with them."""

_OF_TWO_PHASES = re.compile(r"([1-9][0-9]{1,4}),([1-9][0-9]{1,4})")
"""Two values as likely as a number with decimals: `40,32`, which `9,3` is not."""

_SEVERAL = re.compile(r"(?![0-9]+,0+$)[0-9]{1,5}([\s,;/]+[0-9]{1,5}){1,10}")
"""Several whole numbers in one text; `5,0` is one."""

_VALUES = re.compile(r"(?![0-9]{1,2}(?:,[0-9]{3})+$)[+-]?[0-9]{1,6}(?:[,;] ?[+-]?[0-9]{1,6}){2,10}")
"""Several whole numbers in the field of one phase: `250,500,250`, but `1,234,567` is rather one."""

_RATIO = re.compile(r"([0-9]{1,4}) ?: ?1")

# Inputs beside which an error of a whole part of the model is shown.
_PARTS = {
    ("duty_cycle",): "T",
    ("duty_cycle", "phases"): "T",
    MOTION_PATH: "mech",
    (*MOTION_PATH, "mechanism"): "mech",
    ("output_load",): "FR",
    ("output_load", "drive"): "dt",
    ("emergency_stop",): "Tk",
    ("emergency_stop", "brake"): "TB",
}

_TABLES = (
    (("duty_cycle", "phases"), PHASE_BY_LEAF, "T"),
    ((*MOTION_PATH, "moves"), MOVE_BY_LEAF, "mv"),
)
"""Tables of the model, their inputs by field, and the input beside which any other error of a row is shown."""


def parse(pairs: Pairs) -> Form:
    """Form of a query, with everything that the query says and a message for each wrong field."""
    typed = next((text for name, text in pairs if name == TEXT), None)
    before = expanded(pairs)
    pairs, written = in_wire_units(taken := with_offers(before))
    typed = typed if taken == before else None
    pairs = with_figures(switched(_own(pairs)))
    form = replace(_parsed(pairs, written), typed=None if typed is None else typed.replace("\r\n", "\n"))
    if ("do", "take") in pairs and form.has_motion and form.application is not None:
        return _parsed(taken_over(pairs, form.application), written)
    return form


def _own(pairs: Pairs) -> Pairs:
    """Pairs before another way is chosen: of the worked example its phases alone, since nobody has given the rest."""
    buttons = [(name, text) for name, text in pairs if name == "do" and text.startswith("way:")]
    before = [pair for pair in pairs if pair[0] != "do"]
    if buttons and _parsed(before, None).application == Application.worked_example():
        return [*((name, text) for name, text in pairs if name in LABELS or name in CYCLE_NAMES), *buttons]
    return pairs


def _parsed(pairs: Pairs, written: str | None) -> Form:
    """Form of pairs in the wire's units."""
    given = Given()
    for name, text in pairs:
        given.add(name, match[1] if name == "i" and (match := _RATIO.fullmatch(text.strip())) else text)
    phases, moved, bodies, focus = given.tables()
    rows, moves = phases.texts, moved.texts if given.has_motion else []
    problems = [*given.problems(), *_list_problems(given)]
    application = None
    if not _untouched(given, rows, moves):
        document, found = _document(rows, moves, given)
        problems += found
        application, refused = _validated(document, moves or rows, problems)
        problems += refused
    decimal = Reader.of_marker(written or "").decimal
    return Form(
        rows=tuple(rows),
        origins=(moved if given.has_motion else phases).origins,
        texts=given.scalars,
        lists={name: tuple(texts) for name, texts in given.lists.items()},
        moves=tuple(moves),
        has_motion=given.has_motion,
        bodies=body_table(bodies.texts) if given.has_motion else BodyTable(),
        asides=tuple(given.asides),
        shown=frozenset(given.shown),
        gear=given.page.get("gear", "").strip(),
        pins=given.pinned(),
        focus=focus,
        problems=tuple(replace(problem, message=problem.message.marked(decimal)) for problem in problems),
        application=None if problems else application,
        written=written,
        labels={name: given.labels.get(name, [""])[0] for name in LABELS},
    )


def visible(text: str) -> str:
    """A part of a link without characters that have no width."""
    return _UNSEEN.sub("", text)


def in_wire_units(pairs: Pairs) -> tuple[Pairs, str | None]:
    """Pairs of a form as a link has them, and the marker of what they were written in: see `numbers`."""
    # In the texts of people such characters join emoji and letters.
    seen = [(visible(name), text if name in (*LABELS, NAME.role) else visible(text)) for name, text in pairs]
    units = units_of(dict(seen).get("mech", "").strip())
    pieces = [(name, by_size(text).parts if name in BY_SIZE else (Part("", text),)) for name, text in seen]
    wire, marker = numbers.to_wire([(name, part.number) for name, parts in pieces for part in parts], units)
    texts = iter(wire)
    found: list[tuple[str, str]] = []
    for name, parts in pieces:
        if name in BY_SIZE:
            found.append((name, BySize(Part(part.size, next(texts)[1]) for part in parts)))
        elif name not in (numbers.WRITTEN, numbers.WAS):
            found.append(next(texts))
    return found, marker


def _list_problems(given: Given) -> Iterable[FieldProblem]:
    for name, texts in given.lists.items():
        for k, text in enumerate(texts):
            if BY_NAME[name].kind != "text" and isinstance(message := read_value(text, "whole"), Sentence):
                if _SEVERAL.fullmatch(text.strip()):
                    example = "&".join(f"{name}={value}" for value in re.findall("[0-9]+", text)[:3])
                    message = Sentence(N_("give one value per field: {example}"), {"example": example})
                yield FieldProblem(name, k, message)


def _untouched(given: Given, rows: list[dict[str, str]], moves: list[dict[str, str]]) -> bool:
    """The form was sent with its duty table still blank, but for the profile that a move begins with."""
    begun = {"mv"} if "mt" in given.columns else set()
    if any(map(filled, rows)) or any(filled(move).keys() - begun for move in moves):
        return False
    if given.has_motion:
        return "mv" in given.columns and given.scalars.get("mech", "").strip() in TYPES
    return all(name in given.columns for name in REQUIRED)


def _document(
    rows: Sequence[Mapping[str, str]], moves: Sequence[Mapping[str, str]], given: Given
) -> tuple[dict[str, Any], list[FieldProblem]]:
    """Nested input of the application model; what can't be read is left out and reported."""
    problems: list[FieldProblem] = []
    cycle: dict[str, Any] = {}
    if given.has_motion:
        symbols = {symbol.name: symbol for symbol in move_symbols(given.scalars.get("mech", "").strip())}
        cycle["motion"] = {"mechanism": {}, "moves": _table(moves, symbols, problems)}
    else:
        cycle["phases"] = _table(rows, PHASE_BY_NAME, problems)
        if len(cycle["phases"]) == 1:
            problems = [_with_two_phases(problem, given.columns[problem.name]) for problem in problems]
    document: dict[str, Any] = {"duty_cycle": cycle}
    for name, text in given.scalars.items():
        symbol = BY_NAME[name]
        if name in BY_SIZE:
            document.setdefault(symbol.path[0], {})[symbol.path[1]] = _numbers_by_size(name, by_size(text), problems)
            continue
        _put(document, symbol.path, symbol, text, FieldProblem(name, None, Sentence("")), problems)
    for name, texts in given.lists.items():
        values = [value for text in texts if not isinstance(value := read_value(text, BY_NAME[name].kind), Sentence)]
        document.setdefault(BY_NAME[name].path[0], {})[BY_NAME[name].path[1]] = values or None
    return document, problems


def _numbers_by_size(name: str, text: BySize, problems: list[FieldProblem]) -> dict[str, float] | float | None:
    """Numbers by size as the application has them, or the one number for all; what can't be read is reported."""
    found: dict[str, float] = {}
    for part in text.parts:
        value = read_value(part.number, "number")
        if isinstance(value, Sentence):
            problems.append(FieldProblem(name, None, _on_size(part.place, value) if part.size else value))
        elif part.place in found and part.size:
            template = N_("{size} is given twice: give each size once")
            problems.append(FieldProblem(name, None, Sentence(template, {"size": _size(part.place)})))
        else:
            found[part.place] = float(value)
    return found[OTHERS] if found.keys() == {OTHERS} else found


def _on_size(size: str, said: Sentence) -> Sentence:
    """Sentence on the number of one size, which is part of a text: a form offers no number in place of that."""
    parts = {
        name: with_values(value, whole=False) if isinstance(value, Typed) else value
        for name, value in said.values.items()
    }
    return Sentence("{size}: {said}", {"size": _size(size), "said": with_values(said, values=parts)})


def _size(size: str) -> Sentence:
    return Sentence("{text}", {"text": FOR_OTHERS if size == OTHERS else size[:20]}, ("text",))


def _with_two_phases(problem: FieldProblem, texts: Sequence[str]) -> FieldProblem:
    """Fault of a number in the only phase, with advice where it may be two numbers."""
    several = next((text for text in texts if _VALUES.fullmatch(text.strip())), "")
    if several:
        example = "&".join(f"{problem.name}={value}" for value in re.findall("[+-]?[0-9]+", several)[:3])
        return replace(problem, message=Sentence(N_("give one value per field: {example}"), {"example": example}))
    match = next(filter(None, (_OF_TWO_PHASES.fullmatch(text.strip()) for text in texts)), None)
    if match is None:
        return problem
    values = {"advice": problem.message, "first": match[1], "second": match[2]}
    template = N_("{advice}; if {first} and {second} are meant, give two phases")
    return replace(problem, message=Sentence(template, values))


def _table(
    rows: Sequence[Mapping[str, str]], symbols: Mapping[str, Symbol], problems: list[FieldProblem]
) -> list[dict[str, Any]]:
    """Phases or moves, without blank rows."""
    table: list[dict[str, Any]] = []
    for k, row in enumerate(rows):
        if filled(row):
            entry: dict[str, Any] = {}
            table.append(entry)
            for name, text in row.items():
                _put(entry, symbols[name].path[-1:], symbols[name], text, FieldProblem(name, k, Sentence("")), problems)
    return table


def _put(
    document: dict[str, Any],
    path: tuple[str, ...],
    symbol: Symbol,
    text: str,
    place: FieldProblem,
    problems: list[FieldProblem],
) -> None:
    if not text.strip():
        return
    value = read_value(text, symbol.kind, mostly_whole=symbol.unit == "h")
    faults = [value] if isinstance(value, Sentence) else []
    if symbol.name == NAME.role:
        faults = list(faults_of(text, LONGEST_NAME))
    if faults:
        problems += (FieldProblem(place.name, place.index, fault) for fault in faults)
        return
    for step in path[:-1]:
        document = document.setdefault(step, {})
    document[path[-1]] = value


def _validated(
    document: dict[str, Any], rows: Sequence[Mapping[str, str]], known: Sequence[FieldProblem]
) -> tuple[Application | None, list[FieldProblem]]:
    kept = [k for k, row in enumerate(rows) if filled(row)] or [0]
    places = {(problem.name, problem.index) for problem in known}
    try:
        return Application.model_validate(document), []
    except ValidationError as refusal:
        errors = refusal.errors(include_url=False, include_input=False)
    problems = []
    for error in errors:
        name, index = place_of(error["loc"], kept)
        if error["type"] == "no_motion":
            name = "n"
        # Unreadable values are left out of the model, which then misses them, or the part that they belong to.
        consequence = known and error["type"] in ("no_motion", "no_load")
        refused_phases = error["type"] == "too_short" and any(map(filled, rows))
        if (name, index) not in places and not consequence and not refused_phases:
            problems.append(FieldProblem(name, index, _refused(name, error)))
    return None, problems


def _refused(name: str, error: Any) -> Sentence:
    """Text for an error of the model, which says the size of a number by size."""
    *path, size = error["loc"]
    if name in BY_SIZE and tuple(path) == BY_NAME[name].path:
        return _on_size(str(size), refusal_of({**error, "loc": path}))
    return refusal_of(error)


def place_of(location: Sequence[int | str], rows: Sequence[int] = ()) -> tuple[str, int | None]:
    """Query name and index of a location in the application model; `rows` are the rows that became phases."""
    path = tuple(step for step in location if isinstance(step, str))
    index = next((step for step in location if isinstance(step, int)), None)
    for table, by_leaf, first in _TABLES:
        if path[: len(table)] == table:
            symbol, k = by_leaf.get("".join(path[len(table) :][:1])), index or 0
            return symbol.name if symbol else first, rows[k] if k < len(rows) else k
    if path in BY_PATH:
        return BY_PATH[path].name, index
    if path[:-1] in BY_PATH and BY_PATH[path[:-1]].name in BY_SIZE:
        return BY_PATH[path[:-1]].name, None
    return _PARTS.get(path, ".".join(path)), None

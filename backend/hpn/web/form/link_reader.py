"""Reading of links and the form: from the symbols of a query to the application model.

The form, the address bar and links written by hand all go through `parse`; `links.writer.to_link` is the inverse.
Names are the handbook's symbols, values are in the units of the API.
"""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from msgspec.structs import replace as with_values
from pydantic import ValidationError

from hpn.application import Application, CurvePoint
from hpn.links import tolerances
from hpn.links.labels import LABELS
from hpn.links.row_symbols import MOVE_BY_LEAF, PHASE_BY_LEAF, PHASE_BY_NAME, move_symbols
from hpn.links.rows import TOLERANCE, filled
from hpn.links.symbol import MOTION_PATH, Symbol
from hpn.links.symbols import BY_NAME, BY_PATH, BY_SIZE, CURVES, MERGED
from hpn.physics.motion.mechanisms import TYPES
from hpn.tables.by_size import BySize, by_size
from hpn.tables.curve_text import CurveText, curve_text
from hpn.tables.inputs import NAME
from hpn.tables.numbers import read_value
from hpn.web.form.beside import with_beside
from hpn.web.form.buttons import play
from hpn.web.form.form import Form
from hpn.web.form.helpers import BodyTable, body_table
from hpn.web.form.query import CONDITION, REQUIRED, FieldProblem, Pairs, SortedQuery
from hpn.web.form.refusals import refusal_of
from hpn.web.form.tolerance_fields import COLUMN, OF_COLUMN, OF_ROW, ROW, fields
from hpn.words.designations import OTHERS
from hpn.words.terms import FOR_OTHERS
from hpn.words.titles import LONGEST_NAME, faults_of
from hpn.words.wording import N_, Sentence, Typed, Value

_OF_TWO_PHASES = re.compile(r"([1-9][0-9]{1,4}),([1-9][0-9]{1,4})")
"""Text that is as likely two values as a number with decimals: `40,32`, but not `9,3`."""

_SEVERAL = re.compile(r"(?![0-9]+,0+$)[0-9]{1,5}([\s,;/]+[0-9]{1,5}){1,10}")
"""Several whole numbers in one text; `5,0` is a single number."""

_VALUES = re.compile(r"(?![0-9]{1,2}(?:,[0-9]{3})+$)[+-]?[0-9]{1,6}(?:[,;] ?[+-]?[0-9]{1,6}){2,10}")
"""Several whole numbers in the field of one phase: `250,500,250`; `1,234,567` is more likely one number."""

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

NAMES = (NAME.role, BY_PATH["requirements", "motor", "name"].name)
"""Inputs whose text is a name."""

_TABLES = (
    (("duty_cycle", "phases"), PHASE_BY_LEAF, "T"),
    ((*MOTION_PATH, "moves"), MOVE_BY_LEAF, "mv"),
)
"""Tables of the model, their inputs by field, and the input beside which other errors of a row are shown."""


Completes = Callable[[dict[str, Any]], dict[str, Any]]
"""Function that completes the part of an application that a query gives; both are JSON."""


def parse(pairs: Pairs, whole: Completes = dict) -> Form:
    """Form of a query, with its whole content and a message for each wrong field."""
    query = SortedQuery(with_beside(pairs))
    focus = play(query, lambda sorted_pairs: _application_of(sorted_pairs, whole)[0])
    application, problems = _application_of(query, whole)
    decimal = query.notation.reader.decimal
    return Form(
        rows=tuple(query.phases.rows),
        texts=query.scalars,
        lists={name: tuple(texts) for name, texts in query.lists.items()},
        moves=tuple(query.moves.rows) if query.has_motion else (),
        has_motion=query.has_motion,
        bodies=body_table(query.bodies.rows) if query.has_motion else BodyTable(),
        tolerances=tuple(query.tolerances),
        asides=tuple(query.asides),
        groups=frozenset(query.groups),
        has_tolerances=query.has_tolerances,
        is_exact=query.is_exact,
        gear=query.page.get("gear", "").strip(),
        pins=query.pinned(),
        focus=focus,
        problems=tuple(replace(problem, message=problem.message.marked(decimal)) for problem in problems),
        application=application,
        written=query.notation.marker,
        typed=query.typed,
        condition={name: query.page[name] for name in CONDITION if query.page.get(name, "").strip()},
        labels={name: query.labels.get(name, [""])[0] for name in LABELS},
    )


def _application_of(query: SortedQuery, whole: Completes) -> tuple[Application | None, list[FieldProblem]]:
    """Application of a query, or a message for each wrong field; neither if the form is still blank."""
    problems = [*query.problems(), *_list_problems(query)]
    document, unread = _document(query)
    places: dict[str, FieldProblem] = {}
    unread += _tolerances(query, document, places)
    document = whole(document)
    if _untouched(query):
        return None, problems
    problems += unread
    application, refused = _validated(document, query.duty.rows, problems, places)
    problems += refused
    return None if problems else application, problems


def _list_problems(query: SortedQuery) -> Iterable[FieldProblem]:
    for name, texts in query.lists.items():
        for k, text in enumerate(texts):
            if BY_NAME[name].kind != "text" and isinstance(message := read_value(text, "whole"), Sentence):
                if _SEVERAL.fullmatch(text.strip()):
                    example = "&".join(f"{name}={value}" for value in re.findall("[0-9]+", text)[:3])
                    message = Sentence(N_("give one value per field: {example}"), {"example": example})
                yield FieldProblem(name, k, message)


def _untouched(query: SortedQuery) -> bool:
    """True for a form whose duty table is still blank, except for the profile that a new move has."""
    columns = query.duty.counts
    begun = {"mv"} if "mt" in columns else set()
    if any(map(filled, query.phases.rows)):
        return False
    if not query.has_motion:
        return all(name in columns for name in REQUIRED)
    begins = "mv" in columns and query.scalars.get("mech", "").strip() in TYPES
    return begins and not any(filled(move).keys() - begun for move in query.moves.rows)


def _document(query: SortedQuery) -> tuple[dict[str, Any], list[FieldProblem]]:
    """Nested input of the application model, and a problem for each text that can't be read and is left out."""
    problems: list[FieldProblem] = []
    cycle: dict[str, Any] = {}
    if query.has_motion:
        symbols = {symbol.name: symbol for symbol in move_symbols(query.scalars.get("mech", "").strip())}
        cycle["motion"] = {"mechanism": {}, "moves": _table(query.moves.rows, symbols, problems)}
    else:
        cycle["phases"] = _table(query.phases.rows, PHASE_BY_NAME, problems)
        if len(cycle["phases"]) == 1:
            columns = {name: [row[name] for row in query.phases.rows] for name in query.phases.names}
            problems = [_with_two_phases(problem, columns[problem.name]) for problem in problems]
    document: dict[str, Any] = {"duty_cycle": cycle}
    for name, text in query.scalars.items():
        if name in OF_COLUMN:
            continue
        symbol = BY_NAME[name]
        if name in BY_SIZE:
            document.setdefault(symbol.path[0], {})[symbol.path[1]] = _numbers_by_size(name, by_size(text), problems)
            continue
        if name in CURVES:
            motor = document.setdefault(symbol.path[0], {}).setdefault(symbol.path[1], {})
            motor[symbol.path[2]] = _points(name, curve_text(text), problems)
            continue
        _put(document, symbol.path, symbol, text, FieldProblem(name, None, Sentence("")), problems)
    for name, texts in query.lists.items():
        values = [value for text in texts if not isinstance(value := read_value(text, BY_NAME[name].kind), Sentence)]
        document.setdefault(BY_NAME[name].path[0], {})[BY_NAME[name].path[1]] = values or None
    return document, problems


def _tolerances(query: SortedQuery, document: dict[str, Any], places: dict[str, FieldProblem]) -> list[FieldProblem]:
    """Put tolerances into a document, and their fields by path into `places`; return the problems of wrong ones."""
    if query.is_exact:
        return []
    mechanism = query.scalars.get("mech", "").strip() if query.has_motion else None
    faults = [
        (FieldProblem(one.name, one.index, Sentence("")), tolerances.read(one.symbol, one.row, one.sides, mechanism))
        for one in fields(query.duty, query.scalars)
    ]
    faults += [
        (FieldProblem(TOLERANCE, k, Sentence("")), tolerances.read_text(text, mechanism))
        for k, text in enumerate(query.tolerances)
    ]
    problems, values = [], {}
    for place, fault in faults:
        if isinstance(fault, Sentence):
            problems.append(replace(place, message=fault))
        elif fault[0] in values:
            symbol = tolerances.symbol_of(fault[0])
            problems.append(replace(place, message=Sentence(tolerances.TWICE, {"symbol": symbol})))
        else:
            values[fault[0]], places[fault[0]] = fault[1], place
    if values:
        document["tolerances"] = values
    return problems


def _numbers_by_size(name: str, text: BySize, problems: list[FieldProblem]) -> dict[str, float] | float | None:
    """Numbers by size for the application, or one number for all sizes; unreadable ones are added to `problems`."""
    numbers: dict[str, float] = {}
    for part in text.parts:
        value = read_value(part.number, "number")
        if isinstance(value, Sentence):
            whole = len(text.parts) == 1 and not part.size
            problems.append(
                FieldProblem(name, None, value if whole else _on_part(ON_SIZE, {"size": _size(part.place)}, value))
            )
        elif part.place in numbers and part.size:
            template = N_("{size} is given twice: give each size once")
            problems.append(FieldProblem(name, None, Sentence(template, {"size": _size(part.place)})))
        else:
            numbers[part.place] = float(value)
    return numbers[OTHERS] if numbers.keys() == {OTHERS} else numbers


def _points(name: str, text: CurveText, problems: list[FieldProblem]) -> list[dict[str, float]]:
    """Points of a curve for the application; unreadable ones are added to `problems`."""
    points: list[dict[str, float]] = []
    for place, texts in enumerate(text.points, 1):
        if len(texts) != len(CurvePoint.model_fields):
            torque = Typed("2.4", whole=False)
            reason = Sentence(N_("give speed, continuous and peak torque, as 3000 : {torque} : 7"), {"torque": torque})
            problems.append(FieldProblem(name, None, _on_part(ON_POINT, {"number": str(place)}, reason)))
            continue
        values = [read_value(number, "number") for number in texts]
        wrong = [value for value in values if isinstance(value, Sentence)]
        problems += (FieldProblem(name, None, _on_part(ON_POINT, {"number": str(place)}, value)) for value in wrong)
        numbers = (float(value) for value in values if not isinstance(value, Sentence))
        points.append(dict(zip(CurvePoint.model_fields, numbers, strict=bool(not wrong))))
    return points


ON_SIZE, ON_POINT = "{size}: {reason}", N_("point {number}: {reason}")


def _on_part(template: str, part: Mapping[str, Value], sentence: Sentence) -> Sentence:
    """Sentence on a part of a text, a size or a point of a curve; the form can't offer a number for such a part."""
    parts = {
        name: with_values(value, whole=False) if isinstance(value, Typed) else value
        for name, value in sentence.values.items()
    }
    return Sentence(template, {**part, "reason": with_values(sentence, values=parts)})


def _size(size: str) -> Sentence:
    return Sentence("{text}", {"text": FOR_OTHERS if size == OTHERS else size[:20]}, ("text",))


def _with_two_phases(problem: FieldProblem, texts: Sequence[str]) -> FieldProblem:
    """Fault of a number in the only phase, with advice if the text may be several numbers."""
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
                place = FieldProblem(name, k, Sentence(""))
                if name not in OF_ROW:
                    _put(entry, symbols[name].path[-1:], symbols[name], text, place, problems)
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
    if symbol.name in NAMES:
        faults = list(faults_of(text, LONGEST_NAME))
    if faults:
        problems += (FieldProblem(place.name, place.index, fault) for fault in faults)
        return
    for step in path[:-1]:
        document = document.setdefault(step, {})
    document[path[-1]] = value


def _validated(
    document: dict[str, Any],
    rows: Sequence[Mapping[str, str]],
    known: Sequence[FieldProblem],
    of_tolerances: Mapping[str, FieldProblem],
) -> tuple[Application | None, list[FieldProblem]]:
    numbers = [k for k, row in enumerate(rows) if filled(row)] or [0]
    places = {(problem.name, problem.index) for problem in known}
    try:
        return Application.model_validate(document), []
    except ValidationError as refusal:
        errors = refusal.errors(include_url=False, include_input=False)
    problems = []
    for error in errors:
        name, index = place_of(error["loc"], numbers)
        if error["loc"][:1] == ("tolerances",) and (own := of_tolerances.get(str(error["loc"][1:2][0]))):
            name, index = own.name, own.index
        if error["type"] == "no_motion":
            name = "n"
        error, name = _of_missing_cell(error, name)
        # Unreadable values are left out of the model, which then reports them, or their part, as missing.
        consequence = known and error["type"] in ("no_motion", "no_load")
        refused_phases = error["type"] == "too_short" and name not in CURVES and any(map(filled, rows))
        if (name, index) not in places and not consequence and not refused_phases:
            problems.append(FieldProblem(name, index, _refusal(name, error)))
    return None, problems


def _of_missing_cell(error: Any, name: str) -> tuple[Any, str]:
    """Error and input; the error of a move that lacks a figure is placed at the cell of that figure."""
    if error["type"] == "move_needs":
        return {**error, "type": "missing"}, MOVE_BY_LEAF[error["ctx"]["field"]].name
    if error["type"] in ("move_takes_two", "move_takes_one") and "time_s" not in error["ctx"]["given"]:
        return error, "mt"
    return error, name


def _refusal(name: str, error: Any) -> Sentence:
    """Text for an error of the model; names the size of a number by size, and the symbol of a tolerance."""
    *path, size = error["loc"]
    if name in BY_SIZE and tuple(path) == BY_NAME[name].path:
        return _on_part(ON_SIZE, {"size": _size(str(size))}, refusal_of({**error, "loc": path}))
    if name in CURVES and any(isinstance(step, int) for step in error["loc"]):
        number = next(step for step in error["loc"] if isinstance(step, int)) + 1
        return _on_part(ON_POINT, {"number": str(number)}, refusal_of(error))
    if name == TOLERANCE and len(error["loc"]) > 1:  # one of several tolerances in a field
        symbol = tolerances.symbol_of(str(error["loc"][1]))
        return Sentence("{symbol}: {advice}", {"symbol": symbol, "advice": refusal_of(error)})
    return refusal_of(error)


def place_of(location: Sequence[int | str], rows: Sequence[int] = ()) -> tuple[str, int | None]:
    """Query name and index of a location in the application model; `rows` are the rows that became phases or moves."""
    path = tuple(step for step in location if isinstance(step, str))
    index = next((step for step in location if isinstance(step, int)), None)
    for table, by_leaf, first in _TABLES:
        if path[: len(table)] == table:
            symbol, k = by_leaf.get("".join(path[len(table) :][:1])), index or 0
            return symbol.name if symbol else first, rows[k] if k < len(rows) else k
    if path[:1] == ("tolerances",) and len(path) > 1:
        return _field_of(path[1], rows)
    if path in BY_PATH:
        return BY_PATH[path].name, None if BY_PATH[path].name in CURVES else index
    if path[:-1] in BY_PATH and BY_PATH[path[:-1]].name in MERGED:
        return BY_PATH[path[:-1]].name, None
    return _PARTS.get(path, ".".join(path)), None


def _field_of(path: str, rows: Sequence[int]) -> tuple[str, int | None]:
    """Name and index of a tolerance's field."""
    try:
        symbol, _, row = tolerances.symbol_of(path).partition(".")
    except KeyError:
        return TOLERANCE, None
    if not row:
        return f"{COLUMN}{symbol}", None
    k = int(row) - 1
    return f"{ROW}{symbol}", rows[k] if k < len(rows) else k

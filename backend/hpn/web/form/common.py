"""Common values of a machine, as a form shows and sends them."""

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from hpn.application.tolerances import Tolerance
from hpn.documents.common import COMMON, TOLERANCE, Common, is_common
from hpn.links import tolerances
from hpn.links.row_symbols import PHASE_BY_NAME
from hpn.links.symbol import Symbol
from hpn.links.symbols import BY_PATH, BY_SIZE
from hpn.links.tolerances import path_of, sides_of, symbol_of, text_of
from hpn.tables.numbers import WAS, WRITTEN, read_value
from hpn.web.form.form import Form, for_reader
from hpn.web.form.query import FieldProblem, SortedQuery
from hpn.web.form.refusals import refusal_of
from hpn.web.form.tolerance_fields import COLUMN, INPUT_OF, OF_COLUMN, OFFERED
from hpn.words.reader import Reader
from hpn.words.wording import Sentence

Json = dict[str, Any]
Values = Mapping[str, Any]
"""Values by their paths."""

FIRST = ("u", "Lh", "Lb", "Lbb", "fw", "rank", "size", "i")
"""Fields that nearly every machine has."""

BY_SYMBOL: Mapping[str, tuple[str, Symbol]] = {
    symbol.name: (path, symbol)
    for path in COMMON
    if (symbol := BY_PATH.get(tuple(path.split(".")))) is not None and symbol.name not in BY_SIZE
}
"""Fields of the form: path and symbol by name."""

OF_TOLERANCE: Mapping[str, str] = {
    field: f"{TOLERANCE}{path}"
    for field, name in OF_COLUMN.items()
    if (name in PHASE_BY_NAME or name in OFFERED)
    and (path := path_of(name, None, None)) is not None
    and is_common(f"{TOLERANCE}{path}")
}
"""Fields of the form for tolerances, and their paths; tolerances of a single phase or move can't be common."""

FIRST_TOLERANCES = tuple(f"{COLUMN}{name}" for name in ("T", "n", "t", "FR", "FA", "Tk", "tp", "JL"))
"""Fields that nearly every machine with tolerances has."""

PATHS: Mapping[str, str] = {name: path for name, (path, _) in BY_SYMBOL.items()} | dict(OF_TOLERANCE)
"""Paths of all fields by their names."""


def form_of(values: Values, reader: Reader, *, has_tolerances: bool = False) -> Form:
    """Form that shows values; with fields for tolerances if `has_tolerances`."""
    texts = {name: _text(values[path]) for name, (path, s) in BY_SYMBOL.items() if not s.many and path in values}
    texts |= tolerance_texts(values) if has_tolerances else {}
    lists = {
        name: tuple(map(_text, values[path])) for name, (path, s) in BY_SYMBOL.items() if s.many and path in values
    }
    return for_reader(Form(rows=(), texts=texts, lists=lists, has_tolerances=has_tolerances), reader)


def tolerance_texts(values: Values) -> dict[str, str]:
    """Tolerances as links write them, by the names of their fields."""
    return {
        field: sides_of(text_of(path.removeprefix(TOLERANCE), Tolerance.model_validate(values[path])).partition(":")[2])
        for field, path in OF_TOLERANCE.items()
        if path in values
    }


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return str(int(value))
    return repr(value).removesuffix(".0") if isinstance(value, int | float) else str(value)


def read(pairs: Sequence[tuple[str, str]], names: Sequence[str], reader: Reader) -> tuple[Form, Values]:
    """Form as sent, with its problems, and its values by path; a blank field has no value."""
    entries = SortedQuery([pair for pair in pairs if pair[0] in (*names, WRITTEN, WAS)])
    values = dict[str, Any]()
    problems: list[FieldProblem] = []
    several = [(name, text) for name, texts in entries.lists.items() for text in texts]
    for name, text in (*entries.scalars.items(), *several):
        if name in OF_TOLERANCE:
            tolerance = tolerances.read(INPUT_OF[name], None, sides_of(text), None)
            if isinstance(tolerance, Sentence):
                problems.append(FieldProblem(name, None, tolerance))
            else:
                values[OF_TOLERANCE[name]] = tolerance[1]
            continue
        path, symbol = BY_SYMBOL[name]
        value = read_value(text, symbol.kind, mostly_whole=symbol.unit == "h")
        if isinstance(value, Sentence):
            problems.append(FieldProblem(name, None, value))
        elif symbol.many:
            values.setdefault(path, []).append(value)
        else:
            values[path] = value
    problems += _problems_of(values)
    decimal = entries.notation.reader.decimal
    marked = tuple(FieldProblem(each.name, None, each.message.marked(decimal)) for each in problems)
    lists = {name: tuple(texts) for name, texts in entries.lists.items()}
    form = Form(
        rows=(),
        texts=entries.scalars,
        lists=lists,
        problems=marked,
        written=entries.notation.marker,
        has_tolerances=any(name in OF_TOLERANCE for name in names),
    )
    return for_reader(form, reader), values


def _problems_of(values: Values) -> list[FieldProblem]:
    """Problems of the values that the models refuse."""
    try:
        Common.model_validate(nested(values))
    except ValidationError as error:
        problems = []
        for each in error.errors(include_url=False, include_input=False):
            path = tuple(str(step) for step in each["loc"] if isinstance(step, str))
            if f"{path[0]}." == TOLERANCE and len(path) > 1:
                name = f"{COLUMN}{symbol_of(path[1])}"
            else:
                symbol = BY_PATH.get(path) or BY_PATH.get(path[:2])
                name = symbol.name if symbol else FIRST[0]
            problems.append(FieldProblem(name, None, refusal_of(each)))
        return problems
    return []


def nested(values: Values) -> Json:
    """Values as JSON of common values, or as a merge patch of them."""
    document: Json = {}
    for path, value in values.items():
        part, _, name = path.partition(".")
        (document.setdefault(part, {}) if name else document)[name or part] = value
    return document


def changes(before: Values, after: Values) -> dict[str, Any]:
    """Changed values by path, None for a removed one; a choice left at its default does not count as changed."""
    values: dict[str, Any] = {}
    defaults = {path: next(iter(symbol.choices), None) for path, symbol in BY_SYMBOL.values()}
    for path in PATHS.values():
        is_default = path not in after and before.get(path) == defaults.get(path)
        if before.get(path) != after.get(path) and not is_default:
            values[path] = after.get(path)
    return values

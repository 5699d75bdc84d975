"""Values of a machine that may be common, as a form shows and sends them."""

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from hpn.documents.common import COMMON, Common
from hpn.links.symbol import Symbol
from hpn.links.symbols import BY_PATH, BY_SIZE
from hpn.tables.numbers import WAS, WRITTEN, read_value
from hpn.web.form.form import Form, for_reader
from hpn.web.form.given import FieldProblem, SortedQuery
from hpn.web.form.refusals import refusal_of
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


def form_of(values: Values, reader: Reader) -> Form:
    """Form with some values."""
    texts = {name: _text(values[path]) for name, (path, s) in BY_SYMBOL.items() if not s.many and path in values}
    lists = {
        name: tuple(map(_text, values[path])) for name, (path, s) in BY_SYMBOL.items() if s.many and path in values
    }
    return for_reader(Form(rows=(), texts=texts, lists=lists), reader)


def _text(value: Any) -> str:
    return repr(value).removesuffix(".0") if isinstance(value, int | float) else str(value)


def read(pairs: Sequence[tuple[str, str]], names: Sequence[str], reader: Reader) -> tuple[Form, Values]:
    """Form as it was sent, with its problems, and the values in it by path; a blank field is none."""
    entries = SortedQuery([pair for pair in pairs if pair[0] in (*names, WRITTEN, WAS)])
    values = dict[str, Any]()
    problems: list[FieldProblem] = []
    several = [(name, text) for name, texts in entries.lists.items() for text in texts]
    for name, text in (*entries.scalars.items(), *several):
        path, symbol = BY_SYMBOL[name]
        value = read_value(text, symbol.kind, mostly_whole=symbol.unit == "h")
        if isinstance(value, Sentence):
            problems.append(FieldProblem(name, None, value))
        elif symbol.many:
            values.setdefault(path, []).append(value)
        else:
            values[path] = value
    problems += _refused(values)
    decimal = entries.notation.reader.decimal
    marked = tuple(FieldProblem(each.name, None, each.message.marked(decimal)) for each in problems)
    lists = {name: tuple(texts) for name, texts in entries.lists.items()}
    form = Form(rows=(), texts=entries.scalars, lists=lists, problems=marked, written=entries.notation.marker)
    return for_reader(form, reader), values


def _refused(values: Values) -> list[FieldProblem]:
    """Problems of values that the models refuse."""
    try:
        Common.model_validate(nested(values))
    except ValidationError as error:
        problems = []
        for each in error.errors(include_url=False, include_input=False):
            path = tuple(str(step) for step in each["loc"] if isinstance(step, str))
            symbol = BY_PATH.get(path) or BY_PATH.get(path[:2])
            problems.append(FieldProblem(symbol.name if symbol else FIRST[0], None, refusal_of(each)))
        return problems
    return []


def nested(values: Values) -> Json:
    """Values as JSON of common values, or as a merge patch of them."""
    document: Json = {}
    for path, value in values.items():
        part, _, name = path.partition(".")
        (document.setdefault(part, {}) if name else document)[name or part] = value
    return document


def changed(before: Values, after: Values) -> dict[str, Any]:
    """Values that differ, by path, None for one that is taken away; a choice that is left at its default is none."""
    values: dict[str, Any] = {}
    for path, symbol in BY_SYMBOL.values():
        is_default = path not in after and before.get(path) == next(iter(symbol.choices), None)
        if before.get(path) != after.get(path) and not is_default:
            values[path] = after.get(path)
    return values

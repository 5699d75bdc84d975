"""Buttons with the two numbers that an ambiguous text may mean, and the messages that offer them."""

import re
from collections.abc import Sequence
from dataclasses import replace

from msgspec.structs import replace as with_values

from hpn.tables.numbers import ONE_READING
from hpn.web.form.query import FieldProblem, SortedQuery
from hpn.words.reader import Reader
from hpn.words.wording import N_, Sentence, Typed

LIMITS = frozenset(("nm", "Tm", "Tmn", "nmr", "Jr", "bl", "m", "L", "pe", "pem", "u", "eta", "xc"))
"""Inputs whose smaller value is the stricter requirement: limits of motor, user or drawing."""

_OFFER = re.compile(r"(?:f-(?P<name>\w+)|(?P<column>\w+)-(?P<row>[0-9]{1,5})):(?P<text>.{1,60})")
"""Value of a button: the element for the number, and the number, as in `f-Lb:20000`."""


def take(query: SortedQuery, offer: str) -> None:
    """Replace a text by the number of a button."""
    if match := _OFFER.fullmatch(offer):
        name, row = match["name"] or match["column"], int(match["row"] or 0)
        text = query.in_wire_units(name, match["text"])
        table = query.table_of(name)
        if table and name in table.counts and name in table.names and row < len(table.rows):
            table.rows[row][name] = text
            query.typed = None
        elif name in query.single:
            query.put(name, text)
        elif name in query.lists:
            query.lists[name][0] = text


def beside_fields(problems: Sequence[FieldProblem], written: str | None, reader: Reader) -> tuple[FieldProblem, ...]:
    """Problems with messages for a reader's fields; `written` is the marker of the form that they came with.

    Of the two numbers that a text may mean, the safe one comes first: the keyboard reaches its button first.

    Links have a decimal point and the fields of a German form a comma: the message on a link shows both.
    """
    ordered = [replace(problem, message=_safe_first(problem.message, problem.name in LIMITS)) for problem in problems]
    if written is not None or reader.decimal == ".":
        return tuple(ordered)
    return tuple(replace(problem, message=_of_link(problem.message, reader.decimal)) for problem in ordered)


def _safe_first(message: Sentence, is_limit: bool) -> Sentence:
    """Message with its numbers in order of choice: for a limit the smaller first, else the larger."""
    typed = {name: value for name, value in message.values.items() if isinstance(value, Typed)}
    numbers = sorted(typed.values(), key=lambda one: abs(float(one.number.replace(",", "."))), reverse=not is_limit)
    parts = {
        name: _safe_first(value, is_limit) for name, value in message.values.items() if isinstance(value, Sentence)
    }
    return with_values(message, values={**message.values, **parts, **dict(zip(typed, numbers, strict=True))})


def _of_link(message: Sentence, decimal: str) -> Sentence:
    number = message.values.get("number")
    if message.template == ONE_READING and isinstance(number, Typed) and "." in number.number:
        template = N_("in a link write {plain}, in this field {typed}")
        message = Sentence(template, {"plain": str(number), "typed": number})
    return message.marked(decimal)

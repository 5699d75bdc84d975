"""Numbers that a form offers in place of a text that may be two: their buttons, and how messages on them read."""

import re
from collections.abc import Sequence
from dataclasses import replace

from msgspec.structs import replace as with_values

from hpn.tables.numbers import ONE_READING
from hpn.web.form.given import FieldProblem, SortedQuery
from hpn.words.reader import Reader
from hpn.words.wording import N_, Sentence, Typed

LIMITS = frozenset(("nm", "Tm", "Tmn", "nmr", "Jr", "bl", "m", "L", "pe", "pem", "u", "eta", "xc"))
"""Inputs that less of is asked more by: what motor, user or drawing allow."""

_TAKEN = re.compile(r"(?:f-(?P<name>\w+)|(?P<column>\w+)-(?P<row>[0-9]{1,5})):(?P<text>.{1,60})")
"""Value of a button: the element that takes the number, and the number, as in `f-Lb:20000`."""


def take(query: SortedQuery, offer: str) -> None:
    """Put the number of a button in place of a text that is given."""
    if taken := _TAKEN.fullmatch(offer):
        name, row = taken["name"] or taken["column"], int(taken["row"] or 0)
        text = query.in_wire_units(name, taken["text"])
        table = query.table_of(name)
        if table and name in table.counts and name in table.names and row < len(table.rows):
            table.rows[row][name] = text
            query.typed = None
        elif name in query.single:
            query.put(name, text)
        elif name in query.lists:
            query.lists[name][0] = text


def beside_fields(problems: Sequence[FieldProblem], written: str | None, reader: Reader) -> tuple[FieldProblem, ...]:
    """Problems as their messages read beside fields of a reader; `written` is the marker of the form they came with.

    Of two numbers that a text may be the one on the safe side is first: its button is the next by keyboard.

    A link takes a point where the fields of a German form take a comma: the message on a link shows both.
    """
    ordered = [replace(problem, message=_safe_first(problem.message, problem.name in LIMITS)) for problem in problems]
    if written is not None or reader.decimal == ".":
        return tuple(ordered)
    return tuple(replace(problem, message=_of_link(problem.message, reader.decimal)) for problem in ordered)


def _safe_first(message: Sentence, is_limit: bool) -> Sentence:
    """Message with the numbers to choose from in their order: of a limit the smaller first, else the larger."""
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

"""Numbers that a form offers in place of a text that may be two: their buttons, and how messages on them read."""

import re
from collections.abc import Sequence
from dataclasses import replace

from hpn.tables.numbers import ONE_READING
from hpn.web.form.given import FieldProblem
from hpn.web.form.ways import Pairs
from hpn.words.reader import Reader
from hpn.words.wording import N_, Sentence, Typed

_TAKEN = re.compile(r"take:(?:f-(?P<name>\w+)|(?P<column>\w+)-(?P<row>[0-9]{1,5})):(?P<text>.{1,60})")
"""Value of a button: the element that takes the number, and the number, as in `take:f-Lb:20000`."""


def with_offers(pairs: Pairs) -> Pairs:
    """Pairs after the buttons that take an offered number; the buttons stay, as they say where to go on."""
    for taken in filter(None, [_TAKEN.fullmatch(text) for name, text in pairs if name == "do"]):
        wanted, row = taken["name"] or taken["column"], int(taken["row"] or 0)
        places = [k for k, (name, _) in enumerate(pairs) if name == wanted]
        for k in places[row : row + 1]:
            pairs = [*pairs[:k], (wanted, taken["text"]), *pairs[k + 1 :]]
    return pairs


def beside_fields(problems: Sequence[FieldProblem], written: str | None, reader: Reader) -> tuple[FieldProblem, ...]:
    """Problems as their messages read beside fields of a reader; `written` is the marker of the form they came with.

    A link takes a point where the fields of a German form take a comma: the message on a link shows both.
    """
    if written is not None or reader.decimal == ".":
        return tuple(problems)
    return tuple(replace(problem, message=_of_link(problem.message, reader.decimal)) for problem in problems)


def _of_link(message: Sentence, decimal: str) -> Sentence:
    number = message.values.get("number")
    if message.template == ONE_READING and isinstance(number, Typed) and "." in number.number:
        template = N_("in a link write {plain}, in this field {typed}")
        message = Sentence(template, {"plain": str(number), "typed": number})
    return message.marked(decimal)

"""Condition of a gear's envelope, typed on the page of the gear: speed, life and load coefficient.

The permitted load of the shaft depends on no other input, neither on torque nor on load.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from hpn.engine.envelopes import EnvelopeQuery
from hpn.tables import numbers
from hpn.web.form.linked import WRITTEN_AT
from hpn.web.form.query import CONDITION
from hpn.web.form.refusals import refusal_of
from hpn.words.quantities import DUTY, INPUTS
from hpn.words.reader import Reader
from hpn.words.units import suffix_of
from hpn.words.wording import Named, Sentence

_NAMED: Mapping[str, Named] = {
    "speed_rpm": DUTY["average_output_speed_rpm"],
    "life_h": INPUTS["output_load.life_h"],
    "load_coefficient": INPUTS["output_load.load_coefficient"],
}
FIELDS = dict(zip(CONDITION, _NAMED, strict=True))
"""Names in the address -> fields of the condition."""

_UNITS = {name: suffix_of(field) for name, field in FIELDS.items()}


@dataclass(frozen=True, slots=True)
class ConditionField:
    """Input of the condition: its text, the default that counts while it is blank, and its problem."""

    name: str
    named: Named
    unit: str
    text: str
    default: float
    problem: Sentence | None


@dataclass(frozen=True, slots=True)
class Condition:
    """Condition as typed; `query` is the default if an input has a problem."""

    fields: tuple[ConditionField, ...]
    query: EnvelopeQuery
    written: str

    @property
    def tail(self) -> str:
        """Typed condition as the end of an address, in the units of links."""
        typed = [field.name for field in self.fields if field.text.strip() and not field.problem]
        return "".join(f"&{name}={getattr(self.query, FIELDS[name]):.12g}" for name in typed)


def condition_of(pairs: Sequence[tuple[str, str]], reader: Reader, default: EnvelopeQuery) -> Condition:
    """Condition in the query of an address; blank inputs take the default's values."""
    texts = dict(pairs)
    notation = numbers.Notation({numbers.WRITTEN: texts.get(WRITTEN_AT, "")})
    entries = [(name, notation.entry(texts.get(name, ""), _UNITS[name])) for name in FIELDS]
    cells = numbers.to_fields([(text, _UNITS[name]) for name, text in entries], reader, notation.marker)
    values = {name: numbers.read_value(text, "number") for name, text in entries if text.strip()}
    problems = {name: value for name, value in values.items() if isinstance(value, Sentence)}
    query = None if problems else _query({FIELDS[name]: value for name, value in values.items()}, default, problems)
    fields = tuple(
        ConditionField(
            name,
            _NAMED[FIELDS[name]],
            _UNITS[name],
            text,
            getattr(default, FIELDS[name]),
            problems[name].marked(notation.reader.decimal) if name in problems else None,
        )
        for (name, _), text in zip(entries, cells.texts, strict=True)
    )
    return Condition(fields, query or default, reader.marker)


def _query(values: Mapping[str, Any], default: EnvelopeQuery, problems: dict[str, Sentence]) -> EnvelopeQuery | None:
    """Default query with some values replaced; None if the model refuses one, with its problem added to `problems`."""
    names = {field: name for name, field in FIELDS.items()}
    try:
        return EnvelopeQuery.model_validate({**default.model_dump(), **values})
    except ValidationError as refused:
        for error in refused.errors(include_url=False, include_input=False):
            problems[names[str(error["loc"][0])]] = refusal_of(error)
        return None

"""Condition of a gear's envelope as a reader types it on the page of the gear: speed, life and load coefficient.

Nothing else is asked: what the shaft may carry needs no torque and no load.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from hpn.engine.envelopes import EnvelopeQuery
from hpn.tables import numbers
from hpn.web.form.given import CONDITION
from hpn.web.form.linked import WRITTEN_AT
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
    """One input of the condition: what stands in it, what counts while it is blank, and what is wrong with it."""

    name: str
    named: Named
    unit: str
    text: str
    default: float
    problem: Sentence | None


@dataclass(frozen=True, slots=True)
class Condition:
    """Condition that was typed; `query` is the default where something is wrong."""

    fields: tuple[ConditionField, ...]
    query: EnvelopeQuery
    written: str

    @property
    def tail(self) -> str:
        """The typed condition as the end of an address, in the units of links."""
        typed = [field.name for field in self.fields if field.text.strip() and not field.problem]
        return "".join(f"&{name}={getattr(self.query, FIELDS[name]):.12g}" for name in typed)


def condition_of(pairs: Sequence[tuple[str, str]], reader: Reader, default: EnvelopeQuery) -> Condition:
    """Condition in the query of an address; what is blank is as in the default."""
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
    """Query with some values in place of the default's; None where one is refused, which is added to the problems."""
    names = {field: name for name, field in FIELDS.items()}
    try:
        return EnvelopeQuery.model_validate({**default.model_dump(), **values})
    except ValidationError as refused:
        for error in refused.errors(include_url=False, include_input=False):
            problems[names[str(error["loc"][0])]] = refusal_of(error)
        return None

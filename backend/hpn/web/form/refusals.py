"""Texts for errors of the application model, beside the fields of a form and in answers to links."""

import re
from collections.abc import Mapping
from typing import Any

from hpn.application.tolerances import WITH_VALUES
from hpn.links.row_symbols import BODY_BY_LEAF, STROKE_SYMBOLS, TURN_SYMBOLS
from hpn.links.symbol import Symbol
from hpn.links.symbols import BY_NAME, MECHANISM_SYMBOLS
from hpn.physics.motion.refusals import REFUSALS
from hpn.words.fields import LEAST
from hpn.words.terms import PROFILES
from hpn.words.units import suffix_of
from hpn.words.wording import N_, Quantity, Sentence, Value, listed

MISSING = N_("is missing")
"""Text for a required input that is blank."""

_BOUNDS = {
    "greater_than": (N_("must be above {bound}"), "gt"),
    "greater_than_equal": (N_("must be at least {bound}"), "ge"),
    "less_than": (N_("must be below {bound}"), "lt"),
    "less_than_equal": (N_("must be at most {bound}"), "le"),
}

_WITH_INPUT = {
    "error_radius": (N_("needs “{input}” as well"), "pr"),
    "inertia_of_motor": (N_("needs “{input}” as well"), "Jm"),
    "inertia_of_load": (N_("needs a motion, or “{input}”"), "JL"),
    "opposing_below_load": (N_("must be at least “{input}”, which is part of it"), "TL"),
    "curve_stall": (N_("must not be above “{input}”"), "Tst"),
}
"""Texts that name another input as its field does, where the model's have its path; by type of error."""

_OF_BODY: Mapping[str, Symbol] = BODY_BY_LEAF
_OF_MOTION: Mapping[str, Symbol] = {s.path[-1]: s for s in (*MECHANISM_SYMBOLS, *TURN_SYMBOLS, *STROKE_SYMBOLS)}
_NAMES_FIELDS = ("field", "fields", "given")


def refusal_of(error: Any) -> Sentence:
    """Text for one error of a model."""
    context = error.get("ctx", {})
    if error["type"] in _BOUNDS:
        template, key = _BOUNDS[error["type"]]
        return Sentence(template, {"bound": Quantity(context[key], suffix_of(str(error["loc"][-1])), 12)})
    if error["type"] in REFUSALS:
        symbols = _OF_BODY if error["type"].startswith("body_") else _OF_MOTION
        values = {name: _value_of(name, value, symbols) for name, value in context.items()}
        return Sentence(REFUSALS[error["type"]], values)
    if error["type"] in WITH_VALUES:
        return Sentence(WITH_VALUES[error["type"]], {name: str(value) for name, value in context.items()})
    if error["type"] in _WITH_INPUT:
        template, name = _WITH_INPUT[error["type"]]
        return Sentence(template, {"input": BY_NAME[name].named.name}, ("input",))
    if error["type"] == "vanishing":
        return Sentence(_BOUNDS["greater_than_equal"][0], {"bound": Quantity(LEAST, "", 12)})
    if error["type"] == "extra_forbidden":
        return Sentence(N_("does not belong to this mechanism: leave it out"))
    if error["type"] == "no_load":
        return Sentence(N_("give a radial or an axial load, here or in a phase"))
    if error["type"] == "too_short" and context["min_length"] > 1:
        return Sentence(N_("must have at least {bound} values"), {"bound": str(context["min_length"])})
    if error["type"] in ("missing", "too_short"):
        return Sentence(MISSING)
    if error["type"] == "too_long":
        return Sentence(N_("must have at most {bound} values"), {"bound": str(context["max_length"])})
    if error["type"] == "literal_error":
        choices = ", ".join(re.findall("'([^']*)'", context["expected"]))  # pydantic's "or" is English
        return Sentence(N_("must be one of {expected}"), {"expected": choices})
    return Sentence("{text}", {"text": error["msg"]}, ("text",))


def _value_of(name: str, value: Quantity | str, symbols: Mapping[str, Symbol]) -> Value:
    """Value in a refusal's text; fields and profiles by their names."""
    if isinstance(value, Quantity):
        return value
    if name == "profile":
        return Sentence("{text}", {"text": PROFILES.get(value, value)}, ("text",))
    return listed([_field(field, symbols) for field in value.split(", ")]) if name in _NAMES_FIELDS else value


def _field(name: str, symbols: Mapping[str, Symbol]) -> Sentence:
    if name not in symbols:
        return Sentence("{text}", {"text": name}, ("text",))
    return Sentence("{text}", {"text": symbols[name].named.name}, ("text",))

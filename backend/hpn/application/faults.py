"""Faults of an input: their places, texts that name the remedy, and codes for programs."""

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from hpn.application.tolerances import WITH_VALUES
from hpn.physics.motion.refusals import REFUSALS
from hpn.words.fields import UNKNOWN
from hpn.words.likeness import likeness
from hpn.words.wording import N_, Sentence, Value

Location = tuple[str | int, ...]

LISTED_ERRORS = 5000
"""Errors, at most, that are listed; if there are more, only their number is given."""

REQUIRED = N_("is required")
SHOULD = re.compile("(?:Input|Tuple|String) should")
NOT_AVAILABLE = "not_available"
"""Code of an input without an answer in the catalogue."""

PHASE_INPUT, MOVE_INPUT = N_("{input} of phase {number}"), N_("{input} of move {number}")
"""Inputs of a phase or a move, in a sentence."""

OF_PHASE, OF_ROW = N_("phase {number}: {reason}"), N_("row {number}: {reason}")
_PLACED = {OF_PHASE: PHASE_INPUT, OF_ROW: N_("{input} in row {number}")}
"""Texts with the place of an input, and its name with this place."""

_PREDICATE = re.compile("(?:is|must|may|has|needs|gives|does|selects|takes|includes|replaces|acts|leaves) ")
"""Begin of an English text that is a sentence behind the name of its input."""

NOT_A_NUMBER, NOT_AN_INTEGER = N_("must be a number, such as 9.3"), N_("must be a whole number, such as 5")
A_TIME = N_("must be a date or time, such as 2026-11-27 or 2026-11-27T08:00:00Z")
NOT_JSON_NUMBER, NOT_JSON_INTEGER = N_("must be a JSON number, such as 9.3"), N_("must be a JSON integer, such as 5")


class InputError(ValueError):
    """Well-formed input that can't be answered; `problems` are (location, detail) pairs, in English."""

    def __init__(self, *sentences: tuple[Location, Sentence]) -> None:
        self.sentences = sentences
        self.problems = tuple((location, sentence.text) for location, sentence in sentences)
        super().__init__("; ".join(detail for _, detail in self.problems))

    def below(self, name: str) -> "InputError":
        """The error for an application that is a field of another object."""
        return InputError(*(((name, *location), sentence) for location, sentence in self.sentences))


class Fault(NamedTuple):
    """A fault at a location; `code` is pydantic's type of error, or of our own."""

    location: Location
    text: str
    code: str = "invalid"


def faults_of(error: ValidationError | InputError) -> list[Fault]:
    """Faults found by the models or the selection."""
    return [Fault(location, sentence.text, code) for location, sentence, code in sentences_of(error)]


def fault_sentence(name: Sentence, text: Sentence) -> Sentence:
    """Sentence on a fault with the name of its input: `Speed of phase 2 is required`."""
    inner = text.values.get("reason")
    if text.template in _PLACED and isinstance(inner, Sentence):
        return fault_sentence(Sentence(_PLACED[text.template], {"input": name, "number": text.values["number"]}), inner)
    template = N_("{input} {text}") if _PREDICATE.match(text.text) else N_("{input}: {text}")
    return Sentence(template, {"input": name, "text": text})


def lines_of(error: ValidationError | InputError) -> list[str]:
    """Lines with the place and the text of each fault."""
    return [f"{pointer(location) or '/'}: {text}" for location, text, _ in faults_of(error)]


def sentences_of(error: ValidationError | InputError) -> list[tuple[Location, Sentence, str]]:
    """Location, sentence and code of each fault."""
    if isinstance(error, InputError):
        return [(location, sentence, NOT_AVAILABLE) for location, sentence in error.sentences]
    if error.error_count() > LISTED_ERRORS:
        return [((), Sentence(N_("has {count} errors"), {"count": error.error_count()}), "invalid")]
    return _sentences(error.errors(include_url=False, include_input=False))


def unreadable(error: ValidationError) -> str | None:
    """Reason why an input is not JSON, such as "is empty"; None for any other error."""
    (first, *_) = error.errors(include_url=False, include_context=False)
    if first["type"] != "json_invalid":
        return None
    content = first["input"]
    if not content.strip():
        return "is empty"
    try:
        content if isinstance(content, str) else content.decode()
    except UnicodeDecodeError:  # as a file of Windows PowerShell, which writes UTF-16
        return "is not text in UTF-8"
    return first["msg"].replace("Invalid JSON", "is not JSON")


def pointer(location: Location) -> str:
    """JSON pointer (RFC 6901) of a location."""
    return "".join("/" + str(part).replace("~", "~0").replace("/", "~1") for part in location)


def plain_faults(entries: Sequence[ErrorDetails]) -> list[Fault]:
    """Faults for pydantic's entries."""
    return [Fault(location, sentence.text, code) for location, sentence, code in _sentences(entries)]


def _sentences(entries: Sequence[ErrorDetails]) -> list[tuple[Location, Sentence, str]]:
    # Pydantic also reports a list with wrong items as too short; the errors of the items are clearer.
    items = {entry["loc"][:end] for entry in entries for end in range(len(entry["loc"]))}
    singles = [entry for entry in entries if entry["type"] != "too_short" or entry["loc"] not in items]
    sentences = [sentence_of(entry) for entry in singles[:MOST_TOLD]]
    sentences += [_plain_sentence(entry) for entry in singles[MOST_TOLD:]]
    return [(entry["loc"], sentence, entry["type"]) for entry, sentence in zip(singles, sentences, strict=True)]


MOST_TOLD = 100
"""Errors, at most, whose sentences suggest a field for a misspelt one, which takes time."""

BOUNDS = {
    "greater_than_equal": N_("must be greater than or equal to {bound}"),
    "greater_than": N_("must be greater than {bound}"),
    "less_than_equal": N_("must be less than or equal to {bound}"),
    "less_than": N_("must be less than {bound}"),
    "string_too_short": N_("must have at least 1 character"),
    "string_too_long": N_("must have at most {most} characters"),
    "too_long": N_("must have at most {most} items, not {found}"),
    "literal_error": N_("must be '{expected}'"),
}
"""Sentences with values, by pydantic's types of errors."""

OWN: Mapping[str, str] = {**REFUSALS, **WITH_VALUES}
"""Sentences with values, by our own types of errors."""


def sentence_of(entry: ErrorDetails) -> Sentence:
    """Pydantic's message in words that name the remedy; for a misspelt field the likely one."""
    if entry["type"] == UNKNOWN:
        return unknown_field(str(entry["loc"][-1]), entry.get("ctx", {}).get("fields", ()))
    return _plain_sentence(entry)


def _plain_sentence(entry: ErrorDetails) -> Sentence:
    context, text = entry.get("ctx", {}), _plain_message(entry)
    if template := OWN.get(entry["type"]):
        return Sentence(template, context)
    values: dict[str, Value] = {
        "bound": text.rpartition(" ")[2],
        "most": str(context.get("max_length")),
        "found": str(context.get("actual_length")),
        "expected": str(context.get("expected"))[1:-1],
    }
    if template := BOUNDS.get(entry["type"]):
        sentence = Sentence(template, {name: value for name, value in values.items() if f"{{{name}}}" in template})
        if sentence.text == text:  # pydantic has a singular, and sometimes more details
            return sentence
    return Sentence("{text}", {"text": text}, ("text",))


def unknown_field(name: str, fields: Iterable[str]) -> Sentence:
    """Sentence on a name that is not a field of an object, with the most similar field, if any."""
    near = likeness(name, fields)
    if near is None:
        return Sentence(NO_FIELD)
    return Sentence(N_("is not a field of this object; it looks like {near}"), {"near": near})


NO_FIELD = N_("is not a field of this object")


def _plain_message(entry: ErrorDetails) -> str:
    kind, message = entry["type"], entry["msg"]
    return {
        UNKNOWN: NO_FIELD,
        "missing": REQUIRED,
        "float_parsing": NOT_A_NUMBER,
        "finite_number": N_("must be a finite number"),
        "float_type": NOT_JSON_NUMBER,
        "int_type": NOT_JSON_INTEGER,
        "int_parsing": NOT_AN_INTEGER,
        "string_type": N_("must be text"),
        "bool_parsing": N_("must be true or false"),
        "bool_type": N_("must be true or false"),
        "datetime_parsing": A_TIME,
        "datetime_from_date_parsing": A_TIME,
        "tuple_type": N_("must be a list"),
        "model_type": N_("must be an object"),
        "dict_type": N_("must be an object"),
    }.get(kind) or SHOULD.sub("must", message.removeprefix("Value error, ")).replace(" after validation,", ",")

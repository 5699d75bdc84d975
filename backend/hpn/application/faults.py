"""Faults of an input: where, in words that say what would be right, and a code for programs."""

import re
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from hpn.words.fields import UNKNOWN
from hpn.words.likeness import likeness
from hpn.words.wording import N_, Sentence, Value

Location = tuple[str | int, ...]

LISTED_ERRORS = 5000
"""Most errors that are listed; of more the number alone is given."""

REQUIRED = N_("is required")
SHOULD = re.compile("(?:Input|Tuple|String) should")
NOT_AVAILABLE = "not_available"
"""Code of an input that the catalogue has no answer to."""

NOT_A_NUMBER = N_("must be a number, such as 9.3")


class InputError(ValueError):
    """Input that is well formed but can't be answered; `problems` are (location, detail) pairs, in English."""

    def __init__(self, *sentences: tuple[Location, Sentence]) -> None:
        self.sentences = sentences
        self.problems = tuple((location, sentence.text) for location, sentence in sentences)
        super().__init__("; ".join(detail for _, detail in self.problems))

    def below(self, name: str) -> "InputError":
        """The same of an application that is a field of something else."""
        return InputError(*(((name, *location), sentence) for location, sentence in self.sentences))


class Fault(NamedTuple):
    """A fault at a location; `code` is pydantic's type of error, or of our own."""

    location: Location
    text: str
    code: str = "invalid"


def faults_of(error: ValidationError | InputError) -> list[Fault]:
    """Faults that the models or the selection have found."""
    return [Fault(location, sentence.text, code) for location, sentence, code in sentences_of(error)]


def sentences_of(error: ValidationError | InputError) -> list[tuple[Location, Sentence, str]]:
    """The same with their sentences: location, sentence and code of each."""
    if isinstance(error, InputError):
        return [(location, sentence, NOT_AVAILABLE) for location, sentence in error.sentences]
    if error.error_count() > LISTED_ERRORS:
        return [((), Sentence(N_("has {count} errors"), {"count": error.error_count()}), "invalid")]
    return _sentences(error.errors(include_url=False, include_input=False))


def unreadable(error: ValidationError) -> str | None:
    """Text on an input that is no JSON; None for any other."""
    (first, *_) = error.errors(include_url=False, include_context=False, include_input=False)
    return first["msg"] if first["type"] == "json_invalid" else None


def pointer(location: Location) -> str:
    """JSON pointer (RFC 6901) of a location."""
    return "".join("/" + str(part).replace("~", "~0").replace("/", "~1") for part in location)


def plain_faults(entries: Sequence[ErrorDetails]) -> list[Fault]:
    """Faults for pydantic's entries."""
    return [Fault(location, sentence.text, code) for location, sentence, code in _sentences(entries)]


def _sentences(entries: Sequence[ErrorDetails]) -> list[tuple[Location, Sentence, str]]:
    # A list whose items are wrong is also reported as too short; the items say it better.
    items = {entry["loc"][:end] for entry in entries for end in range(len(entry["loc"]))}
    singles = [entry for entry in entries if entry["type"] != "too_short" or entry["loc"] not in items]
    sentences = [sentence_of(entry) for entry in singles[:MOST_TOLD]]
    sentences += [_plain_sentence(entry) for entry in singles[MOST_TOLD:]]
    return [(entry["loc"], sentence, entry["type"]) for entry, sentence in zip(singles, sentences, strict=True)]


MOST_TOLD = 100
"""Errors whose sentence names the field that a misspelt one looks like, which takes a while to find."""

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


def sentence_of(entry: ErrorDetails) -> Sentence:
    """Pydantic's message in words that say what would be right; of a misspelt field what it looks like."""
    if entry["type"] == UNKNOWN:
        return unknown_field(str(entry["loc"][-1]), entry.get("ctx", {}).get("fields", ()))
    return _plain_sentence(entry)


def _plain_sentence(entry: ErrorDetails) -> Sentence:
    context, text = entry.get("ctx", {}), _plain_message(entry)
    values: dict[str, Value] = {
        "bound": text.rpartition(" ")[2],
        "most": str(context.get("max_length")),
        "found": str(context.get("actual_length")),
        "expected": str(context.get("expected"))[1:-1],
    }
    if template := BOUNDS.get(entry["type"]):
        sentence = Sentence(template, {name: value for name, value in values.items() if f"{{{name}}}" in template})
        if sentence.text == text:  # pydantic has a singular, and says more where it knows more
            return sentence
    return Sentence("{text}", {"text": text}, ("text",))


def unknown_field(name: str, fields: Iterable[str]) -> Sentence:
    """Sentence on a name that is none of the fields of an object, with the one that it looks like."""
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
        "float_type": N_("must be a JSON number, such as 9.3"),
        "int_type": N_("must be a JSON integer, such as 5"),
        "int_parsing": N_("must be a whole number, such as 5"),
        "string_type": N_("must be text"),
        "bool_parsing": N_("must be true or false"),
        "tuple_type": N_("must be a list"),
        "model_type": N_("must be an object"),
    }.get(kind) or SHOULD.sub("must", message.removeprefix("Value error, ")).replace(" after validation,", ",")

"""Faults of an input: where, in words that say what would be right, and a code for programs."""

import re
from collections.abc import Iterable
from typing import NamedTuple

from pydantic import ValidationError

from hpn.words.wording import N_, Sentence

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
    if isinstance(error, InputError):
        return [Fault(location, text, NOT_AVAILABLE) for location, text in error.problems]
    if error.error_count() > LISTED_ERRORS:
        return [Fault((), f"has {error.error_count()} errors")]
    found = error.errors(include_url=False, include_context=False, include_input=False)
    return plain_faults((entry["loc"], entry["type"], entry["msg"]) for entry in found)


def unreadable(error: ValidationError) -> str | None:
    """Text on an input that is no JSON; None for any other."""
    (first, *_) = error.errors(include_url=False, include_context=False, include_input=False)
    return first["msg"] if first["type"] == "json_invalid" else None


def pointer(location: Location) -> str:
    """JSON pointer (RFC 6901) of a location."""
    return "".join("/" + str(part).replace("~", "~0").replace("/", "~1") for part in location)


def plain_faults(found: Iterable[tuple[Location, str, str]]) -> list[Fault]:
    """Faults for pydantic's (location, type, message) entries."""
    # A list whose items are wrong is also reported as too short; the items say it better.
    entries = list(found)
    items = {tuple(location[:end]) for location, _, _ in entries for end in range(len(location))}
    return [
        Fault(location, plain_message(kind, message), kind)
        for location, kind, message in entries
        if kind != "too_short" or tuple(location) not in items
    ]


def plain_message(kind: str, message: str) -> str:
    """Pydantic's message in words that say what would be right."""
    return {
        "extra_forbidden": N_("is not a field of this object"),
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

"""Rules for texts that name something: titles, references, names of phases and moves."""

import re
import unicodedata
from collections.abc import Iterator
from typing import Annotated

from pydantic import AfterValidator, Field, StringConstraints
from pydantic_core import PydanticCustomError

from hpn.words.wording import N_, Sentence

LONGEST_TITLE, LONGEST_NAME, LONGEST_NOTE = 200, 40, 2000
"""Characters of a title, of the name of a phase or a move, and of a note."""

CONTROLS = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ufffe\uffff]")
"""Control characters, line separators, marks that change the direction of text, and noncharacters."""

NO_CONTROLS = N_("must not contain control characters or line breaks")

HIDDEN = re.compile("[\u200b\u2060\ufeff\U000e0000-\U000e007f]")
"""Invisible characters that no word needs: they make two titles look alike. Joiners (U+200C, U+200D) are spelling."""

MOST_MARKS = 4
"""Combining marks, at most, in a row on one letter in any script."""

SCHEMA_CONTROLS = "\\u0000-\\u001f\\u007f-\\u009f\\u2028-\\u202e\\u2066-\\u2069\\ufffe\\uffff"
"""`CONTROLS` between the brackets of a pattern in JSON Schema."""


def faults_of(text: str, longest: int = LONGEST_TITLE) -> Iterator[Sentence]:
    """Yield faults of a text as a title of at most `longest` characters."""
    if CONTROLS.search(text):
        yield Sentence(NO_CONTROLS)
    if len(text.strip()) > longest:
        yield Sentence(N_("must have at most {most} characters"), {"most": str(longest)})
    else:  # composing a long text can take long
        yield from _hidden_in(text.strip())


def _hidden_in(text: str) -> Iterator[Sentence]:
    """Yield faults that make a text look like another."""
    if match := HIDDEN.search(text):
        yield Sentence(N_("must not contain the invisible character {character}"), {"character": _named(match[0])})
    count = 0
    for character in unicodedata.normalize("NFC", text):
        count = count + 1 if unicodedata.category(character).startswith("M") else 0
        if count > MOST_MARKS:
            values = {"most": str(MOST_MARKS), "character": _named(character)}
            yield Sentence(N_("must have at most {most} combining marks in a row; {character} is one more"), values)
            return


def _named(character: str) -> str:
    """Code and name of a character that is not visible by itself: U+200B ZERO WIDTH SPACE."""
    return f"U+{ord(character):04X} {unicodedata.name(character, '')}".rstrip()


def _valid(text: str) -> str | None:
    for fault in faults_of(text):
        raise PydanticCustomError("label", "{text}", {"text": fault.text})
    return text or None


_VISIBLE = Field(json_schema_extra={"pattern": f"^[^{SCHEMA_CONTROLS}\\u200b\\u2060\\ufeff]*$"})

Title = Annotated[
    str,
    StringConstraints(strip_whitespace=True, max_length=LONGEST_TITLE),
    AfterValidator(_valid),
    _VISIBLE,
]
"""One line of text that names something, without invisible characters. An empty one becomes None."""

Name = Annotated[
    str,
    StringConstraints(strip_whitespace=True, max_length=LONGEST_NAME),
    AfterValidator(_valid),
    _VISIBLE,
]
"""A title short enough for a table's cell."""


def _without_controls(text: str) -> str | None:
    for fault in faults_of(text.replace("\r\n", "\n").replace("\n", " ").replace("\t", " "), LONGEST_NOTE):
        raise PydanticCustomError("note", "{text}", {"text": fault.text})
    return text or None


Note = Annotated[
    str,
    StringConstraints(strip_whitespace=True, max_length=LONGEST_NOTE),
    AfterValidator(_without_controls),
]
"""Some lines of text. An empty one becomes None."""


def is_title(text: str, longest: int = LONGEST_TITLE) -> bool:
    """True for a text without a fault."""
    return next(faults_of(text, longest), None) is None


def row_label(place: int, name: str | None) -> str:
    """Label of a row in a table of phases or moves: its number and its name, if any, `3 lift`."""
    return f"{place + 1} {name}" if name else str(place + 1)


def numbered(place: int, name: str | None) -> str:
    """Number of a phase or a move for a sentence, with its name, if any: `3 (lift)`."""
    return f"{place + 1} ({name})" if name else str(place + 1)

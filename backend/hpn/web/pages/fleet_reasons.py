"""Reasons of rejected axes, which the answers of a fleet have in English, as sentences for a reader.

Fixed texts are translated as they are; of those with values the template is found again.
"""

import re
from collections.abc import Sequence

from hpn.engine.allowed import LOOKS_LIKE, NOT_THERE, NOT_TOGETHER
from hpn.words.wording import N_, Sentence

TEMPLATES = (
    N_("row {number}: {reason}"),
    N_("phase {number}: {reason}"),
    N_("item {number}: {reason}"),
    N_("size {size}: {reason}"),
    N_("the row has {found} cells where the header has {expected}, in {row}"),
    N_("the line is not a JSON object: {error}, in {found}"),
    N_("must be an integer, as the first valid axis is, not {found}"),
    N_("must be text, as the first valid axis is, not {found}"),
    N_("has {found} phases where torque_Nm has {count}"),
    N_("must have at most {most} items, not {found}"),
    N_("must have at least 1 character"),
    N_("must have at most {most} characters"),
    N_("must be greater than or equal to {bound}"),
    N_("must be greater than {bound}"),
    N_("must be less than or equal to {bound}"),
    N_("must be less than {bound}"),
    N_("must be a number, such as 9.3, not {found}"),
    N_("must be text, not {found}"),
    N_("must be '{expected}'"),
    LOOKS_LIKE,
    NOT_THERE,
    NOT_TOGETHER,
)
"""Reasons with values, the narrower before the wider."""

_OF_PHASE = re.compile(r"(^|; )([a-z][A-Za-z0-9_.]*): phase ([0-9]+): ")
_FAULTS = re.compile(r"; (?=[a-z][A-Za-z0-9_.]*: )")


def _pattern(template: str) -> re.Pattern[str]:
    text = re.escape(template).replace(r"\{number\}", "(?P<number>[0-9]+)")
    return re.compile(re.sub(r"\\\{(\w+)\\\}", r"(?P<\1>.+)", text), re.DOTALL)


PATTERNS = {template: _pattern(template) for template in TEMPLATES}


def reasons_of(error: str) -> list[tuple[str, Sentence]]:
    """Column and reason of each fault of an axis, from the text of all that the answers have."""
    parts = (fault.partition(": ") for fault in _FAULTS.split(error))
    return [(column, _sentence(reason)) for column, _, reason in parts]


def by_rows(error: str, numbers: Sequence[int]) -> str:
    """The text of all faults of an axis with the rows of its table in place of its phases."""

    def by_row(found: re.Match[str]) -> str:
        place = int(found[3]) - 1
        return f"{found[1]}{found[2]}: row {numbers[place]}: " if place < len(numbers) else found[0]

    return _OF_PHASE.sub(by_row, error)


def _sentence(reason: str) -> Sentence:
    for template, pattern in PATTERNS.items():
        if found := pattern.fullmatch(reason):
            texts = found.groupdict()
            return Sentence(
                template, {name: _sentence(text) if name == "reason" else text for name, text in texts.items()}
            )
    return Sentence("{text}", {"text": reason}, ("text",))

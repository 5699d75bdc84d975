"""Number formats of workbooks: the texts that a format shows around a number, which give its unit."""

import operator
from dataclasses import dataclass
from functools import lru_cache
from re import DOTALL

from hpn.words.patterns import Pattern

LONGEST_FORMAT = 255
"""Characters, the limit of spreadsheet programs."""

_TOKEN = Pattern(
    r'"(?P<quoted>[^"]*)"|\\(?P<escaped>.)'
    r"|\[\$(?P<marked>[^\[\]]*?)(?:-(?:[0-9A-Fa-f]{2,8}|[a-z]{2}-[A-Z]{2}|x-\w+))?\]|\[(?P<condition>[^\[\]]*)\]"
    r"|(?P<gap>[_*].|\s)|(?P<number>General|[0#?.,]+|E[+-]0+)|(?P<end>;)|(?P<other>.)",
    LONGEST_FORMAT,
    DOTALL,
)
_CONDITION = Pattern(r"(<=|>=|<>|<|>|=)(-?[0-9.]+)", LONGEST_FORMAT)
_HOLDS = {
    **{"<": operator.lt, "<=": operator.le, "=": operator.eq},
    **{">": operator.gt, ">=": operator.ge, "<>": operator.ne},
}
_UNSHOWN = "+-()@%"
"""Unquoted signs that are no unit: signs of numbers, brackets of negative numbers, text, and the percent sign."""


@dataclass(slots=True)
class Section:
    """A section of a number format: its texts before and behind the number, its condition, its digits, and percent or
    not.
    """

    before: str = ""
    behind: str = ""
    condition: str = ""
    number: str = ""
    percent: bool = False

    @property
    def unit(self) -> str:
        """All text beside the number except its sign."""
        before, behind = self.before.strip(), self.behind.strip()
        if before.startswith("(") and behind.endswith(")"):
            before, behind = before[1:], behind[:-1]
        return " ".join(f"{before.lstrip('+-')} {behind}".split())

    @property
    def thousands(self) -> int:
        """Power of a thousand by which the shown number is divided."""
        whole = self.number.rstrip(",")
        return len(self.number) - len(whole) if whole else 0

    def holds(self, value: float) -> bool:
        """True where its condition is met, or there is none."""
        condition = _CONDITION.fullmatch(self.condition)
        return condition is None or bool(_HOLDS[condition[1]](value, float(condition[2])))


def section_of(number_format: str, value: float) -> Section | None:
    """Section that shows a number; None if unknown, or if some sections show thousands and their units don't say so.

    A zero may be shown as a dash.
    """
    if len(number_format) > LONGEST_FORMAT:
        return None
    sections = _sections(number_format)[:3]
    numbers = [section for section in sections if section.number]
    if len({section.thousands for section in numbers}) > len({section.unit for section in numbers}):
        return None
    if not any(section.condition for section in sections):
        candidates = [sections[0]] if value >= 0 or len(sections) == 1 else [sections[1]]
    elif all(section.condition for section in sections[:-1]):
        candidates = [section for section in sections if section.holds(value)]
    else:
        candidates = []
    if not value:
        candidates = [section for section in candidates if section.number] or numbers
    return candidates[0] if candidates else None


@lru_cache(maxsize=1000)
def _sections(number_format: str) -> list[Section]:
    sections = [Section()]
    for token in _TOKEN.finditer(number_format):
        section = sections[-1]
        if token["end"]:
            sections.append(Section())
        elif token["number"]:
            section.number += token["number"]
            section.behind += " " if section.behind else ""
        elif token["condition"] is not None:
            section.condition = token["condition"] if _CONDITION.fullmatch(token["condition"]) else section.condition
        else:
            section.percent |= token["other"] == "%"
            literal = token["quoted"] or token["escaped"] or token["marked"] or token["other"] or ""
            text = " " if token["gap"] else "" if literal == token["other"] and literal in _UNSHOWN else literal
            section.before, section.behind = (
                (section.before, section.behind + text) if section.number else (section.before + text, section.behind)
            )
    return sections

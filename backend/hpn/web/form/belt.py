"""The belt of the form, from whose strands a radial load is worked out; it belongs to the page, a link has the load."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from pydantic import ValidationError

from hpn.physics.strands import Strands
from hpn.tables.numbers import read_value
from hpn.web.form.given import FieldProblem
from hpn.web.form.refusals import refusal_of
from hpn.web.form.symbols import BELT_BY_LEAF, BELT_BY_NAME
from hpn.web.form.ways import Pairs
from hpn.words.wording import Sentence

DIGITS = 6
"""Digits of the load that is handed over."""


@dataclass(frozen=True)
class BeltInput:
    """Figures of a belt as given, what is wrong with them, and the radial load in N; None where there is none."""

    texts: Mapping[str, str] = field(default_factory=dict)
    problems: tuple[FieldProblem, ...] = ()
    radial_N: float | None = None

    @property
    def given(self) -> bool:
        """True where anything is filled in."""
        return any(text.strip() for text in self.texts.values())

    def messages(self, name: str) -> list[Sentence]:
        """Error messages of one input."""
        return [problem.message for problem in self.problems if problem.name == name]


def belt_of(texts: Mapping[str, str]) -> BeltInput:
    """Belt of texts by name; blank ones count as absent."""
    filled = {name: text for name, text in texts.items() if text.strip()}
    values = {name: read_value(text, "number") for name, text in filled.items()}
    problems = [FieldProblem(name, None, value) for name, value in values.items() if isinstance(value, Sentence)]
    if not filled or problems:
        return BeltInput(texts, tuple(problems))
    try:
        strands = Strands.model_validate({BELT_BY_NAME[name].path[-1]: value for name, value in values.items()})
    except ValidationError as refused:
        errors = refused.errors(include_url=False, include_input=False)
        found = [FieldProblem(BELT_BY_LEAF[str(error["loc"][0])].name, None, refusal_of(error)) for error in errors]
        return BeltInput(texts, tuple(found))
    return BeltInput(texts, (), strands.radial_N)


def with_belt(pairs: Pairs) -> Pairs:
    """Pairs after the button that takes the belt's load as the radial load of the cycle."""
    if ("do", "belt") not in pairs:
        return pairs
    found = belt_of({name: text for name, text in pairs if name in BELT_BY_NAME}).radial_N
    if found is None:
        return pairs
    return [*((name, text) for name, text in pairs if name != "FR"), ("FR", f"{found:.{DIGITS}g}")]

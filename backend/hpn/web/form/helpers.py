"""Helpers of the form: the moment of inertia of bodies and the radial load of a belt, from what somebody knows of them.

They belong to the page alone: a link has the figures that come out.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from hpn.physics.motion.bodies import Body, BodySum, sum_of
from hpn.physics.strands import Strands
from hpn.tables.numbers import read_value
from hpn.web.form.given import FieldProblem
from hpn.web.form.refusals import refusal_of
from hpn.web.form.rows import filled
from hpn.web.form.symbols import BELT_BY_NAME, BODY_BY_NAME, Symbol
from hpn.web.form.ways import Pairs, way_of
from hpn.words.wording import Sentence

DIGITS = 6
"""Digits of the figures that are handed over."""

M = TypeVar("M", bound=BaseModel)


@dataclass(frozen=True)
class BodyTable:
    """Rows of bodies as given, what is wrong with them, and what they come to; None where that is nothing."""

    rows: tuple[Mapping[str, str], ...] = ()
    problems: tuple[FieldProblem, ...] = ()
    sum: BodySum | None = None

    @property
    def given(self) -> bool:
        """True where anything is filled in."""
        return any(map(filled, self.rows))


@dataclass(frozen=True)
class BeltInput:
    """Figures of a belt as given, what is wrong with them, and the radial load in N; None where there is none."""

    texts: Mapping[str, str] = field(default_factory=dict)
    problems: tuple[FieldProblem, ...] = ()
    radial_N: float | None = None

    @property
    def given(self) -> bool:
        """True where anything is filled in."""
        return bool(filled(self.texts))

    def messages(self, name: str) -> list[Sentence]:
        """Error messages of one input."""
        return [problem.message for problem in self.problems if problem.name == name]


def body_table(rows: Sequence[Mapping[str, str]]) -> BodyTable:
    """Bodies of rows; blank ones count as absent."""
    problems: list[FieldProblem] = []
    bodies = [_model(Body, row, BODY_BY_NAME, k, problems) for k, row in enumerate(rows) if filled(row)]
    whole = [body for body in bodies if body is not None]
    return BodyTable(tuple(rows), tuple(problems), sum_of(whole) if whole and not problems else None)


def belt_of(texts: Mapping[str, str]) -> BeltInput:
    """Belt of texts by name; blank ones count as absent."""
    problems: list[FieldProblem] = []
    strands = _model(Strands, texts, BELT_BY_NAME, None, problems) if filled(texts) else None
    return BeltInput(texts, tuple(problems), strands.radial_N if strands else None)


def _model(
    model: type[M],
    texts: Mapping[str, str],
    symbols: Mapping[str, Symbol],
    index: int | None,
    problems: list[FieldProblem],
) -> M | None:
    """Model of texts by name; None where one can't be read or is refused, which is added to the problems."""
    values = {name: read_value(text, symbols[name].kind) for name, text in filled(texts).items()}
    unread = [FieldProblem(name, index, value) for name, value in values.items() if isinstance(value, Sentence)]
    if unread:
        problems += unread
        return None
    try:
        return model.model_validate({symbols[name].path[-1]: value for name, value in values.items()})
    except ValidationError as refused:
        names = {symbol.path[-1]: name for name, symbol in symbols.items()}
        errors = refused.errors(include_url=False, include_input=False)
        problems += [FieldProblem(names[str(error["loc"][0])], index, refusal_of(error)) for error in errors]
        return None


def with_figures(pairs: Pairs) -> Pairs:
    """Pairs after the buttons that take what the helpers come to: an inertia, its gravity too, or a radial load."""
    asked = {text for name, text in pairs if name == "do"}
    figures: dict[str, float | None] = {}
    if asked & {"inertia", "gravity"} and (found := _bodies_in(pairs).sum):
        figures["J"] = found.inertia_kgm2
        if "gravity" in asked and way_of(pairs) == "rotary" and found.gravity_radius_mm is not None:
            figures |= {"mg": found.gravity_mass_kg, "rg": found.gravity_radius_mm}
    if "belt" in asked:
        radial_N = belt_of({name: text for name, text in pairs if name in BELT_BY_NAME}).radial_N
        figures |= {} if radial_N is None else {"FR": radial_N}
    kept = [(name, text) for name, text in pairs if name not in figures]
    return [*kept, *((name, f"{value:.{DIGITS}g}") for name, value in figures.items())]


def _bodies_in(pairs: Pairs) -> BodyTable:
    columns = {name: [text for other, text in pairs if other == name] for name in BODY_BY_NAME}
    return body_table([dict(zip(columns, texts, strict=True)) for texts in zip(*columns.values(), strict=False)])

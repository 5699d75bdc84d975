"""Bodies of the form, from whose dimensions the moment of inertia of a mechanism is worked out.

They belong to the page alone: a link has the inertia that comes out.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from hpn.physics.motion.bodies import Body, BodySum, sum_of
from hpn.tables.numbers import read_value
from hpn.web.form.given import FieldProblem
from hpn.web.form.refusals import refusal_of
from hpn.web.form.symbols import BODY_BY_LEAF, BODY_BY_NAME
from hpn.web.form.ways import Pairs, way_of
from hpn.words.wording import Sentence

DIGITS = 6
"""Digits of the figures that the bodies hand over."""


@dataclass(frozen=True)
class BodyTable:
    """Rows of bodies as given, what is wrong with them, and what they come to; None where that is nothing."""

    rows: tuple[Mapping[str, str], ...] = ()
    problems: tuple[FieldProblem, ...] = ()
    sum: BodySum | None = None

    @property
    def given(self) -> bool:
        """True where anything is filled in."""
        return any(text.strip() for row in self.rows for text in row.values())


def body_table(rows: Sequence[Mapping[str, str]]) -> BodyTable:
    """Bodies of rows; blank ones count as absent."""
    problems: list[FieldProblem] = []
    bodies = [_body(row, k, problems) for k, row in enumerate(rows) if any(text.strip() for text in row.values())]
    whole = [body for body in bodies if body is not None]
    return BodyTable(tuple(rows), tuple(problems), sum_of(whole) if whole and not problems else None)


def _body(row: Mapping[str, str], k: int, problems: list[FieldProblem]) -> Body | None:
    document: dict[str, Any] = {}
    before = len(problems)
    for name, text in row.items():
        symbol = BODY_BY_NAME[name]
        if text.strip():
            value = read_value(text, symbol.kind)
            if isinstance(value, Sentence):
                problems.append(FieldProblem(name, k, value))
            document[symbol.path[-1]] = value
    if len(problems) > before:
        return None
    try:
        return Body.model_validate(document)
    except ValidationError as refused:
        errors = refused.errors(include_url=False, include_input=False)
        problems += [FieldProblem(BODY_BY_LEAF[str(error["loc"][0])].name, k, refusal_of(error)) for error in errors]
        return None


def with_inertia(pairs: Pairs) -> Pairs:
    """Pairs after the buttons that take the sum of the bodies: its inertia, and where asked for its gravity."""
    asked = [text for name, text in pairs if name == "do" and text in ("inertia", "gravity")]
    if not asked:
        return pairs
    columns = {name: [text for other, text in pairs if other == name] for name in BODY_BY_NAME}
    rows = [dict(zip(columns, texts, strict=True)) for texts in zip(*columns.values(), strict=False)]
    found = body_table(rows).sum
    if found is None:
        return pairs
    figures: dict[str, float | None] = {"J": found.inertia_kgm2}
    if "gravity" in asked and way_of(pairs) == "rotary" and found.gravity_radius_mm is not None:
        figures |= {"mg": found.gravity_mass_kg, "rg": found.gravity_radius_mm}
    kept = [(name, text) for name, text in pairs if name not in figures]
    return [*kept, *((name, f"{value:.{DIGITS}g}") for name, value in figures.items())]

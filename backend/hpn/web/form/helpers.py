"""Helper of the form: moment of inertia of bodies from their masses and dimensions.

It exists only on the page: a link contains the resulting figures.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from hpn.links.row_symbols import BODY_BY_NAME
from hpn.links.rows import filled
from hpn.links.symbol import Symbol
from hpn.physics.motion.bodies import Body, BodySum, sum_of
from hpn.tables.numbers import read_value
from hpn.web.form.query import FieldProblem, SortedQuery
from hpn.web.form.refusals import refusal_of
from hpn.words.wording import Sentence

DIGITS = 6
"""Significant digits of the figures that the form takes over."""

M = TypeVar("M", bound=BaseModel)


@dataclass(frozen=True)
class BodyTable:
    """Rows of bodies as given, their problems, and their sum; None if there are no bodies or a row has a problem."""

    rows: tuple[Mapping[str, str], ...] = ()
    problems: tuple[FieldProblem, ...] = ()
    sum: BodySum | None = None

    @property
    def is_filled(self) -> bool:
        """True if a row is filled in."""
        return any(map(filled, self.rows))


def body_table(rows: Sequence[Mapping[str, str]]) -> BodyTable:
    """Table of the bodies in rows; blank rows count as absent."""
    problems: list[FieldProblem] = []
    bodies = [_model(Body, row, BODY_BY_NAME, k, problems) for k, row in enumerate(rows) if filled(row)]
    whole = [body for body in bodies if body is not None]
    return BodyTable(tuple(rows), tuple(problems), sum_of(whole) if whole and not problems else None)


def _model(
    model: type[M],
    texts: Mapping[str, str],
    symbols: Mapping[str, Symbol],
    index: int | None,
    problems: list[FieldProblem],
) -> M | None:
    """Model of texts by name; None if a text can't be read or is refused, and its problem is added to `problems`."""
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


def hand_over(query: SortedQuery, *, gravity: bool) -> None:
    """Put the bodies' sum into the mechanism's inertia, with `gravity` also into the gravity inputs of a rotary one."""
    total = body_table(query.bodies.rows).sum
    if total is None:
        return
    figures = {"J": total.inertia_kgm2}
    if gravity and query.scalars.get("mech", "").strip() == "rotary" and total.gravity_radius_mm is not None:
        figures |= {"mg": total.gravity_mass_kg, "rg": total.gravity_radius_mm}
    for name, value in figures.items():
        query.put(name, f"{value:.{DIGITS}g}")

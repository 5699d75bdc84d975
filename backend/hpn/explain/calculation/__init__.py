"""The calculation of one gear as the handbook's equations, each with its numbers, its limit and the limit's source.

Shows only results of the selection: a test compares every formula with the candidate's figure.
"""

import math
from collections.abc import Callable, Iterable, Iterator

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.allowed import with_listed_motor
from hpn.engine.candidates import Candidate
from hpn.engine.selection import DutyFigures
from hpn.explain.calculation.formula import Formula, Subtraction, Term, inside, value_of
from hpn.explain.calculation.handbook import HANDBOOK
from hpn.explain.calculation.motor import MOTOR
from hpn.explain.calculation.output_bearing import bearing_steps
from hpn.explain.calculation.sheet import CalculationSheet, Comparison, EquationLine, LackingFigureError, Step
from hpn.explain.calculation.stiffness import frequency_steps, position_steps
from hpn.explain.calculation.stop import stop_steps
from hpn.words.wording import N_, Sentence

__all__ = ["Comparison", "EquationLine", "Step", "calculation_of"]

STEPS: tuple[Callable[[CalculationSheet], Iterable[Step]], ...] = (
    *(stop_steps, *HANDBOOK, *MOTOR),
    *(bearing_steps, frequency_steps, position_steps),
)
"""Steps in the order of the handbook, then motor, output bearing and stiffness."""

OTHERWISE = N_("The version that saved this calculated it otherwise: its result stands, without an equation.")

AGREEMENT = 1e-9
"""Relative difference of a formula and its figure that counts as rounding."""


def calculation_of(
    candidate: Candidate, duty: DutyFigures, gear: Gear, application: Application, catalogue: Catalogue
) -> tuple[Step, ...]:
    """Every equation that applies to a gear, in the order of STEPS.

    `candidate` and `duty` are the answer for the gear under the application, of this moment or saved. Steps that need
    an unpublished figure, or one that the answer lacks, are left out; a step whose equations don't give the figures of
    the answer keeps only its comparisons.
    """
    sheet = CalculationSheet(candidate, duty, gear, with_listed_motor(application, catalogue), catalogue)
    return tuple(step if _holds(step) else _as_saved(step) for make in STEPS for step in _steps_until_gap(make(sheet)))


def _steps_until_gap(steps: Iterable[Step]) -> Iterator[Step]:
    """Steps up to the first one that needs a figure missing in the answer."""
    try:
        yield from steps
    except LackingFigureError:
        return


def _holds(step: Step) -> bool:
    """True if a step's equations give its figures."""
    try:
        return all(
            math.isclose(figure, computed, rel_tol=AGREEMENT, abs_tol=_room(formula))
            for figure, computed, formula in (
                *((line.result.value, line.by_hand({}), line.formula) for line in step.lines),
                *((one.value, value_of(one.tested), one.tested) for one in step.comparisons),
            )
        )
    except (ArithmeticError, TypeError):  # a power of a negative number is complex
        return False


def _room(formula: Formula) -> float:
    """Rounding error of a formula that subtracts large numbers."""
    differences = (one for one in inside(formula) if isinstance(one, Subtraction))
    return AGREEMENT * math.fsum(abs(value_of(one.left)) + abs(value_of(one.right)) for one in differences)


def _as_saved(step: Step) -> Step:
    """A step without the equations of this version; a comparison stays if it compares a single figure."""
    compared = tuple(one for one in step.comparisons if isinstance(one.tested, Term))
    return Step(step.code, step.title, step.equation, (), compared, (Sentence(OTHERWISE),))

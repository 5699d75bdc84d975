"""Worst cases of one gear's checks over the tolerances, each as an application that can be opened."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from hpn.application import Application
from hpn.application.tolerances import Interval, Place
from hpn.engine.allowed import with_listed_motor
from hpn.engine.alone import Alone
from hpn.engine.candidates import Candidate, candidates_of
from hpn.engine.duty import Duty
from hpn.engine.evaluation import evaluate


@dataclass(frozen=True)
class Corner:
    """The worst case of a check, the gear in it, and the inputs above and below their values, by magnitude.

    Inputs that don't influence the check stay at their values.
    """

    application: Application
    candidate: Candidate
    high: tuple[Interval, ...]
    low: tuple[Interval, ...]


def corners_of(alone: Alone, codes: Sequence[str]) -> dict[str, Corner]:
    """Worst cases of some checks of a gear, by their codes."""
    worst, _ = alone.whole
    places = {check.code: place for place, check in enumerate(alone.base.checks) if check.code in codes}
    corners = {code: worst.at.item(place, 0) for code, place in places.items()}
    cases = {at: box.application_at(point) for at in set(corners.values()) for box, point in [worst.points[at]]}
    equipped = [with_listed_motor(case, alone.catalogue) for case in cases.values()]
    evaluation = evaluate(Duty.of(equipped), alone.base.gears, alone.catalogue)
    judged = {at: next(candidates_of(evaluation, index)) for index, at in enumerate(cases)}
    return {code: Corner(cases[at], judged[at], *_sides(alone.intervals, cases[at])) for code, at in corners.items()}


def _sides(intervals: Sequence[Interval], case: Application) -> tuple[tuple[Interval, ...], tuple[Interval, ...]]:
    """Inputs above and below their values in a case."""
    at = {one.place: _value_at(case, one.place) for one in intervals}
    high = tuple(one for one in intervals if abs(at[one.place]) > abs(one.value))
    return high, tuple(one for one in intervals if abs(at[one.place]) < abs(one.value))


def _value_at(application: Application, place: Place) -> float:
    part: Any = application.duty_cycle if place[0] in ("phases", "motion") else application
    for step in place:
        part = part[step] if isinstance(step, int) else getattr(part, step)
    return float(part)

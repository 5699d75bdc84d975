"""Cases in which the checks of one gear are worst over the tolerances, each as an application that can be opened."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from hpn.application import Application
from hpn.application.tolerances import Interval, Place
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.allowed import with_listed_motor
from hpn.engine.candidates import Candidate, candidates_of
from hpn.engine.duty import Duty
from hpn.engine.evaluation import evaluate
from hpn.engine.members import SAMPLES, members_of
from hpn.engine.tolerance import worst_cases


@dataclass(frozen=True)
class Corner:
    """The case in which a check is worst, the gear in it, and the inputs above and below their values, by magnitude.

    What does not move the check stays at its value.
    """

    application: Application
    candidate: Candidate
    high: tuple[Interval, ...]
    low: tuple[Interval, ...]


def corners_of(application: Application, gear: Gear, catalogue: Catalogue, codes: Sequence[str]) -> dict[str, Corner]:
    """Worst cases of some checks of a gear, by their codes."""
    gears = catalogue.listed([gear])
    nominal = evaluate(Duty.of([with_listed_motor(application, catalogue)]), gears, catalogue)
    (worst,) = worst_cases([members_of(application, catalogue)], nominal.checks, gears, catalogue, SAMPLES)
    places = {check.code: place for place, check in enumerate(nominal.checks) if check.code in codes}
    cases = {}
    for code, place in places.items():
        box, point = worst.points[worst.at.item(place, 0)]
        cases[code] = box.application_at(point)
    judged = [_judged(case, gear, catalogue) for case in cases.values()]
    return {
        code: Corner(case, candidate, *_sides(application.intervals, case))
        for (code, case), candidate in zip(cases.items(), judged, strict=True)
    }


def _judged(case: Application, gear: Gear, catalogue: Catalogue) -> Candidate:
    evaluation = evaluate(Duty.of([with_listed_motor(case, catalogue)]), catalogue.listed([gear]), catalogue)
    return next(candidates_of(evaluation, 0))


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

"""One gear by itself over the tolerances of an application, evaluated once for a page, a file and a reply."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from hpn.application import Application
from hpn.application.tolerances import Interval
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.allowed import with_listed_motor
from hpn.engine.duty import Duty
from hpn.engine.evaluation import SUITABLE, Evaluation, evaluate, judged_by
from hpn.engine.members import SAMPLES, Members, members_of
from hpn.engine.tolerance import WorstCases, worst_bound, worst_cases
from hpn.physics.equations import FloatArray


@dataclass(frozen=True, eq=False)
class Alone:
    """A gear by itself under an application with tolerances; `base` is its evaluation as given."""

    application: Application
    base: Evaluation

    @classmethod
    def of(cls, application: Application, gear: Gear, catalogue: Catalogue) -> "Alone":
        """A gear of a catalogue."""
        duty = Duty.of([with_listed_motor(application, catalogue)])
        return cls(application, evaluate(duty, catalogue.listed([gear]), catalogue))

    @property
    def catalogue(self) -> Catalogue:
        """Catalogue of the evaluation."""
        return self.base.catalogue

    @cached_property
    def intervals(self) -> tuple[Interval, ...]:
        """Inputs with a tolerance."""
        return self.application.intervals

    @cached_property
    def members(self) -> Members:
        """Boxes of the application."""
        return members_of(self.application, self.catalogue)

    @cached_property
    def whole(self) -> tuple[WorstCases, Evaluation]:
        """Worst case over all tolerances, and its evaluation."""
        (cases,), judged = self._worst([self.members], SAMPLES)
        return cases, judged

    @property
    def holds(self) -> bool:
        """True where it passes over all tolerances."""
        return bool(self.whole[1].verdict.item(0, 0) == SUITABLE)

    def worst(self, intervals: Sequence[Interval], samples: int) -> Evaluation:
        """Evaluation of the worst case over other intervals."""
        return self._worst([members_of(self.application, self.catalogue, intervals)], samples)[1]

    def without(self, paths: Sequence[str]) -> FloatArray:
        """Worst utilisations with the inputs of each path exact in turn and the others at the same points, shape
        (paths,).
        """
        rest = [[one for one in self.intervals if one.path != path] for path in paths]
        members = [members_of(self.application, self.catalogue, some, self.members) for some in rest]
        worst: FloatArray = self._worst(members, SAMPLES)[1].utilisation[:, 0]
        return worst

    def _worst(self, members: Sequence[Members], samples: int) -> tuple[list[WorstCases], Evaluation]:
        """Worst cases, and their evaluation with one row for each of `members`."""
        cases = worst_cases(members, self.base.checks, self.base.gears, self.catalogue, samples)
        used = np.stack([one.used for one in cases], axis=1)
        mask = np.repeat(self.base.applies, len(cases), axis=1)
        bound = np.repeat(worst_bound(self.base), len(cases), axis=1)
        return cases, judged_by(replace(self.base, applies=mask), used, bound)

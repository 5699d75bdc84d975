"""The calculation of one gear as the handbook's equations, each with its numbers, its limit and where that is from.

Only shows what the selection has worked out: a test holds every formula against the figure of the candidate.
"""

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.allowed import with_listed_motor
from hpn.engine.candidates import Candidate
from hpn.explain.calculation.handbook import handbook_steps
from hpn.explain.calculation.motor import motor_steps
from hpn.explain.calculation.output_bearing import bearing_steps
from hpn.explain.calculation.sheet import Comparison, Line, Sheet, Step
from hpn.explain.calculation.stiffness import stiffness_steps, stop_steps

__all__ = ["Comparison", "Line", "Step", "calculation_of"]


def calculation_of(
    candidate: Candidate, gear: Gear, application: Application, catalogue: Catalogue
) -> tuple[Step, ...]:
    """Every equation that applies to a gear, in the order of the handbook, then motor, output bearing and stiffness.

    `candidate` is the result for the gear under the application. Equations that need an unpublished figure are left
    out.
    """
    sheet = Sheet(candidate, gear, with_listed_motor(application, catalogue), catalogue)
    handbook, motor = (*stop_steps(sheet), *handbook_steps(sheet)), motor_steps(sheet)
    return (*handbook, *motor, *bearing_steps(sheet), *stiffness_steps(sheet))

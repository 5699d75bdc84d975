"""The calculation of one gear as the handbook's equations, each with its numbers, its limit and where that is from.

Only shows what the reply has worked out: a test holds every formula against the figure of the reply.
"""

from collections.abc import Mapping
from typing import Any

from hpn.calculation.handbook import handbook_steps
from hpn.calculation.motor import motor_steps
from hpn.calculation.output_bearing import bearing_steps
from hpn.calculation.sheet import Comparison, Line, Sheet, Step
from hpn.catalogue import Catalogue
from hpn.duty import Duty
from hpn.gear import Gear

__all__ = ["Comparison", "Line", "Step", "calculation_of"]


def calculation_of(candidate: Mapping[str, Any], gear: Gear, duty: Duty, catalogue: Catalogue) -> tuple[Step, ...]:
    """Every equation that applies to a gear, in the order of the handbook, then the motor and the output bearing.

    `candidate` is the gear's entry in the reply to the first application of `duty`. What a figure that is not
    published keeps from being worked out is left out.
    """
    sheet = Sheet(candidate, gear, duty, catalogue)
    return (*handbook_steps(sheet), *motor_steps(sheet), *bearing_steps(sheet))

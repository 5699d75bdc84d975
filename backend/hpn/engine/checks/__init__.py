"""Every check, in one table; a module for each thing that can be at its limit.

The functions of an entry take a `Case`, in which what belongs to an application has shape (N, 1) and what belongs to a
gear (G,); NaN is not published or not asked for, infinity without a limit.
"""

from hpn.engine.check import Check
from hpn.engine.checks.gear import GEAR
from hpn.engine.checks.motor import MOTOR
from hpn.engine.checks.output_bearing import OUTPUT_BEARING
from hpn.engine.checks.properties import PROPERTIES

CHECKS: tuple[Check, ...] = (*GEAR, *OUTPUT_BEARING, *MOTOR, *PROPERTIES)
"""In the order of the contract; a tie for governing goes to the first."""

BY_CODE = {check.code: check for check in CHECKS}


def allowed(code: str | None, utilisation: float) -> float:
    """Largest utilisation with which the check of a code passes; 1 where there is none to name."""
    return 1.0 if code is None else BY_CODE[code].allowed(utilisation)

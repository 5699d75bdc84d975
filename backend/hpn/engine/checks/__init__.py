"""Every check, in one table; a module for each thing that can be at its limit.

The functions of an entry take a `Case`, in which what belongs to an application has shape (N, 1) and what belongs to a
gear (G,); NaN is not published or not asked for, infinity without a limit.
"""

from hpn.engine.check import Check
from hpn.engine.checks.gear import GEAR
from hpn.engine.checks.motor import INERTIA_RATIO, MOTOR
from hpn.engine.checks.output_bearing import OUTPUT_BEARING
from hpn.engine.checks.properties import PROPERTIES

CHECKS: tuple[Check, ...] = (*GEAR, *OUTPUT_BEARING, *MOTOR, *PROPERTIES, INERTIA_RATIO)
"""In the order of the contract; a tie for governing goes to the first."""

BY_CODE = {check.code: check for check in CHECKS}


def name_of(code: str) -> str:
    """Name of a check as it stands inside a sentence; the code of one of another version."""
    return BY_CODE[code].name if code in BY_CODE else code


def allowed(code: str | None, utilisation: float) -> float:
    """Largest utilisation with which the check of a code passes; 1 where there is none to name.

    A check of another version, which this one does not know, counts as a load check.
    """
    if code is None:
        return 1.0
    return BY_CODE[code].allowed(utilisation) if code in BY_CODE else utilisation

"""Every check, in one table; a module for each component with limits.

The functions of an entry take a `Case`. Its figures of an application have shape (N, 1), and those of a gear (G,). NaN
means not published or not asked for, infinity means without a limit.
"""

from hpn.engine.check import Check
from hpn.engine.checks.gear import GEAR
from hpn.engine.checks.motor import INERTIA_RATIO, MOTOR
from hpn.engine.checks.output_bearing import OUTPUT_BEARING
from hpn.engine.checks.properties import PROPERTIES

CHECKS: tuple[Check, ...] = (*GEAR, *OUTPUT_BEARING, *MOTOR, *PROPERTIES, INERTIA_RATIO)
"""Checks in the order of the contract; of checks with equal utilisation the first one governs."""

BY_CODE = {check.code: check for check in CHECKS}


def name_of(code: str) -> str:
    """Name of a check for the middle of a sentence; for a check of another version its code."""
    return BY_CODE[code].name if code in BY_CODE else code


def allowed(code: str | None, utilisation: float) -> float:
    """Largest utilisation at which the check of a code passes; 1 without a code.

    A check of another version, unknown to this one, counts as a load check.
    """
    if code is None:
        return 1.0
    return BY_CODE[code].allowed(utilisation) if code in BY_CODE else utilisation

"""Designations of gears and sizes in the handbook's spelling, from all its printed spellings."""

import re
from typing import Any

_DESIGNATION = re.compile(
    r"(?:HPN[-\s]*)?(\d{1,3})A?[-\s]+(?:i\s?=?\s?)?0*(\d{1,3})(?:\s?:\s?1)?(?:-.*)?", re.IGNORECASE
)
_SIZE = re.compile(r"(?:HPN-?)?(\d{1,3})A?", re.IGNORECASE)


def canonical_size(text: Any) -> Any:
    """Size in the handbook's spelling: `14`, `14a` and `HPN-14A` are `14A`; any other value is returned unchanged."""
    match = _SIZE.fullmatch(text.strip()) if isinstance(text, str) else None
    return f"{int(match[1])}A" if match else text


OTHERS = "others"
"""Name beside sizes for all sizes without their own figure."""


def canonical_place(name: Any) -> Any:
    """Size in the handbook's spelling, or `others` in any case and with blanks around it; any other value is
    unchanged.
    """
    is_others = isinstance(name, str) and name.strip().casefold() == OTHERS
    return OTHERS if is_others else canonical_size(name)


def canonical_designation(text: str) -> str | None:
    """Designation `HPN-20A-5` from any printed or commonly typed spelling, or None.

    The handbook writes `HPN-11A-4-J6-BH-AF1` (ordering code, 3.2), `HPN-20-5` (equation 18.2) and `HPN-11A-04`
    (illustration 19.1) for gears of one kind. `20a 5`, `20A 5:1` and `HPN 20A i=5` are just as clear.
    """
    match = _DESIGNATION.fullmatch(text.strip())
    return f"HPN-{int(match[1])}A-{int(match[2])}" if match else None

"""Times as clocks and ISO 8601 write them: `0:00:30` and `PT30S` last so long, `2026-03-01T08:00:30` is a moment."""

import re
from collections.abc import Sequence
from datetime import UTC, datetime
from fractions import Fraction
from functools import lru_cache

LONGEST = 40

_CLOCK = re.compile(r"([0-9]{1,4}):([0-5][0-9]):([0-5][0-9])(?:[.,]([0-9]{1,9}))?")
_MINUTES = re.compile(r"()([0-9]{1,3}):([0-5][0-9])[.,]([0-9]{1,9})")
"""Minutes, seconds and a fraction: nobody writes one of minutes."""

_ISO = re.compile(r"PT(?=[0-9])(?:([0-9]{1,6})H)?(?:([0-9]{1,6})M)?(?:([0-9]{1,6})(?:[.,]([0-9]{1,9}))?S)?")
_MOMENT = re.compile(
    r"([0-9]{4}-[0-9]{2}-[0-9]{2})[T ]([0-9]{2}:[0-9]{2}(?::[0-9]{2})?)(?:[.,]([0-9]{1,9}))?"
    r"\s?(Z|[+-][0-9]{2}:?[0-9]{2})?"
)
FORMAT = re.compile(r"\[?[hH]{1,2}\]?:[mM]{2}:[sS]{2}(?:[.,](?:[0fsS]{1,6}|ms|xxx))?")
"""How a heading says that its times are written as on a clock."""

PARTED = re.compile(r"[0-5]?[0-9]:[0-5][0-9]")
"""A time of two parts, hours and minutes or minutes and seconds."""


@lru_cache(maxsize=5000)
def seconds_of(cell: str) -> str | None:
    """Seconds of a time on a clock or of a duration, in plain notation; None for anything else."""
    if len(cell) > LONGEST:
        return None
    match = _CLOCK.fullmatch(cell) or _MINUTES.fullmatch(cell) or _ISO.fullmatch(cell)
    if match is None:
        return None
    hours, minutes, seconds = (int(part or 0) for part in match.groups()[:3])
    return _written(3600 * hours + 60 * minutes + seconds, match[4])


def _written(whole: int, fraction: str | None) -> str:
    return f"{whole}.{fraction}" if fraction and fraction.strip("0") else str(whole)


@lru_cache(maxsize=5000)
def moment_of(cell: str) -> Fraction | None:
    """Seconds from the year 1970 to a date with a time of day, all digits of its fraction counted; None for no such."""
    match = _MOMENT.fullmatch(cell) if len(cell) <= LONGEST else None
    if match is None or (match[3] and match[2].count(":") < 2):
        return None
    try:
        moment = datetime.fromisoformat(f"{match[1]}T{match[2]}{match[4] or 'Z'}").astimezone(UTC)
    except (ValueError, OverflowError):
        return None
    return Fraction(int(moment.timestamp())) + Fraction(f"0.{match[3] or 0}")


def seconds_between(moments: Sequence[Fraction | None], moment: Fraction) -> str:
    """Seconds from the first of some moments to one, in plain notation."""
    first = next(each for each in moments if each is not None)
    nanoseconds = round((moment - first) * 10**9)
    sign, (whole, rest) = "-" if nanoseconds < 0 else "", divmod(abs(nanoseconds), 10**9)
    return sign + _written(whole, f"{rest:09d}".rstrip("0"))

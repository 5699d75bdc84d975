"""Times of a table: do they go on, where do they fall, what may that be, and how long does each phase last."""

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from itertools import pairwise

from hpn.tables.cells import written
from hpn.words.wording import N_

DAY = Fraction(86_400)

FEW = 3
"""Steps that rise for each one that falls, from which on times may be points in time."""

MOST_PERIODS = 3
_REACH = 10
"""How many times the longest other step the one at which a counter begins anew may be."""

MIDNIGHT, SORTED, FIRST, ERROR = "midnight", "sorted", "first", "error"
"""Answers to what a time that goes back is; any other is the period of a counter in seconds."""

OF_FALLS: Mapping[str, str] = {
    MIDNIGHT: N_("past midnight: the times go on the next day"),
    SORTED: N_("rows out of order: sort them by time"),
    FIRST: N_("another run: read the rows above it alone"),
    ERROR: N_("an error: reject these axes"),
}
OF_COUNTER = N_("a counter that begins anew at")

_OWN_PERIODS = (60, 3600, *(2**bits for bits in (8, 15, 16, 24, 31, 32)), *(10**digits for digits in range(2, 13)))
_CLOCKED_PERIODS = tuple(2**bits * Fraction(1, per) for bits in (16, 31, 32) for per in (1000, 10**6))
"""Where counters begin anew: in the unit of a column, and in seconds those of milliseconds and of microseconds."""


def falls_of(times: Sequence[Fraction]) -> list[int]:
    """Places of times that are before the one above."""
    return [k for k, (before, after) in enumerate(pairwise(times), start=1) if after < before]


def go_on(times: Sequence[Fraction], *, on_clock: bool) -> bool:
    """True where times rise, but for a few that fall: they may be points in time.

    Of times on a clock, and of those that begin with 0, as many may fall as rise: no phase takes 0 s. Past midnight a
    clock rises.
    """
    falls = falls_of(times)
    past = [k for k in falls if on_clock and passes_midnight(times, k)]
    up, down = sum(after > before for before, after in pairwise(times)) + len(past), len(falls) - len(past)
    return up >= max(1, FEW * down) or (up >= max(1, down) and (on_clock or times[0] == 0))


def falls_now_and_then(times: Sequence[Fraction]) -> bool:
    """True where times fall, but no more of them than rise; past midnight one may that is alone."""
    falls = falls_of(times)
    past = sum(passes_midnight(times, k) for k in falls)
    return 0 < len(falls) <= past + sum(after > before for before, after in pairwise(times))


def passes_midnight(times: Sequence[Fraction], place: int) -> bool:
    """True where a time of a day may be one of the next day, less than half a day later."""
    return all(0 <= time < DAY for time in times) and times[place - 1] - times[place] > DAY / 2


def laps_of(series: Iterable[Sequence[Fraction]], unit_s: Fraction) -> list[Fraction]:
    """Seconds that a clock or counter may have lost at each fall, a day first."""
    series = [times for times in series if falls_of(times)]
    longest = max((b - a for times in series for a, b in pairwise(times)), default=Fraction(0))
    falls = [(times[k - 1], times[k]) for times in series for k in falls_of(times)]
    highest = max(max(times) for times in series)
    periods = sorted({*(period * unit_s for period in _OWN_PERIODS), *_CLOCKED_PERIODS} - {DAY})
    fitting = [
        period
        for period in periods
        if period > highest and all(0 < after + period - before <= _REACH * longest for before, after in falls)
    ]
    by_day = all(passes_midnight(times, k) for times in series for k in falls_of(times))
    return [*([DAY] if by_day else []), *fitting[:MOST_PERIODS]]


def unrolled(times: Sequence[Fraction], lap: Fraction) -> list[Fraction]:
    """Times that go on where they fell by a lap of a clock or counter."""
    laps = [Fraction(0)]
    for before, after in pairwise(times):
        laps.append(laps[-1] + (lap if after < before else 0))
    return [time + passed for time, passed in zip(times, laps, strict=True)]


def durations_of(moments: Sequence[Fraction], times: str) -> list[Fraction]:
    """Seconds between points in time. Of starts the last one ends the cycle; the first phase of ends starts at 0."""
    return [end - start for start, end in pairwise(moments if times == "starts" else [Fraction(0), *moments])]


def in_plain(value: Fraction) -> str:
    """A number in plain notation; one beyond every float stays one that is too large."""
    try:
        return written(float(value))
    except OverflowError:
        return "1e999" if value > 0 else "-1e999"

"""Times of a table: do they rise, where do they fall, why may they fall, and how long does each phase last."""

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from itertools import pairwise

from hpn.tables.cells import written
from hpn.words.wording import N_

DAY = Fraction(86_400)

FEW = 3
"""Rising steps per falling step from which on times may be points in time."""

MOST_PERIODS = 3
_REACH = 10
"""Longest step at which a counter may begin anew, in multiples of the longest other step."""

MIDNIGHT, SORTED, FIRST, ERROR = "midnight", "sorted", "first", "error"
"""Answers to the question about a time that runs backwards; any other answer is the counter's period in seconds."""

OF_FALLS: Mapping[str, str] = {
    MIDNIGHT: N_("past midnight: the times go on the next day"),
    SORTED: N_("rows out of order: sort them by time"),
    FIRST: N_("another run: read the rows above it alone"),
    ERROR: N_("an error: reject these axes"),
}
OF_COUNTER = N_("a counter that begins anew at")

_OWN_PERIODS = (60, 3600, *(2**bits for bits in (8, 15, 16, 24, 31, 32)), *(10**digits for digits in range(2, 13)))
_CLOCKED_PERIODS = tuple(2**bits * Fraction(1, per) for bits in (16, 31, 32) for per in (1000, 10**6))
"""Periods after which counters begin anew: in the unit of the column; and those of counters in ms and µs, in seconds.
"""


def falls_of(times: Sequence[Fraction]) -> list[int]:
    """Places of times earlier than the time above."""
    return [k for k, (before, after) in enumerate(pairwise(times), start=1) if after < before]


def go_on(times: Sequence[Fraction], *, on_clock: bool) -> bool:
    """True where times rise, apart from a few falls: they may be points in time.

    As many may fall as rise on a clock, or where the first time is 0, since no phase takes 0 s. A step past midnight
    counts as a rise on a clock.
    """
    falls = falls_of(times)
    past = [k for k in falls if on_clock and passes_midnight(times, k)]
    up, down = sum(after > before for before, after in pairwise(times)) + len(past), len(falls) - len(past)
    return up >= max(1, FEW * down) or (up >= max(1, down) and (on_clock or times[0] == 0))


def falls_now_and_then(times: Sequence[Fraction]) -> bool:
    """True where times fall, but no more often than they rise; a step past midnight counts for both, so that it may be
    alone.
    """
    falls = falls_of(times)
    past = sum(passes_midnight(times, k) for k in falls)
    return 0 < len(falls) <= past + sum(after > before for before, after in pairwise(times))


def passes_midnight(times: Sequence[Fraction], place: int) -> bool:
    """True where a time of day may belong to the next day, less than half a day later."""
    return all(0 <= time < DAY for time in times) and times[place - 1] - times[place] > DAY / 2


def laps_of(series: Iterable[Sequence[Fraction]], unit_s: Fraction) -> list[Fraction]:
    """Seconds that a clock or counter may have lost at each fall, a day first; at most MOST_PERIODS periods of
    counters.
    """
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
    """Times that keep rising: a lap of the clock or counter is added at each fall."""
    laps = [Fraction(0)]
    for before, after in pairwise(times):
        laps.append(laps[-1] + (lap if after < before else 0))
    return [time + passed for time, passed in zip(times, laps, strict=True)]


def durations_of(moments: Sequence[Fraction], times: str) -> list[Fraction]:
    """Seconds between points in time. The last of the starts ends the cycle; the first phase of ends starts at 0."""
    return [end - start for start, end in pairwise(moments if times == "starts" else [Fraction(0), *moments])]


def in_plain(value: Fraction) -> str:
    """A number in plain notation; `1e999` or `-1e999`, which reads as too large, where no float can hold it."""
    try:
        return written(float(value))
    except OverflowError:
        return "1e999" if value > 0 else "-1e999"

"""Rate limits per key or address, counted in the memory of one process."""

import ipaddress
import math
import time
from collections.abc import Mapping
from typing import NamedTuple

import limits

SWEEP_SECONDS = 30


class Counters:
    """Counts in windows of time, in a dictionary for one event loop.

    The storage of the library `limits` would start a thread for nearly every request.
    """

    def __init__(self) -> None:
        self._counts: dict[tuple[str, str], tuple[int, float]] = {}
        self._sweep = 0.0

    def __len__(self) -> int:
        """Number of stored counts."""
        return len(self._counts)

    def hit(self, key: tuple[str, str], window_s: float, now: float) -> tuple[int, float]:
        """Count this hit; return the count and end of the key's window. A new window begins when the last has ended."""
        if now > self._sweep:
            self._counts = {name: entry for name, entry in self._counts.items() if entry[1] > now}
            self._sweep = now + SWEEP_SECONDS
        count, end = self._counts.get(key, (0, 0.0))
        if end <= now:
            count, end = 0, now + window_s
        self._counts[key] = count + 1, end
        return count + 1, end


class Admission(NamedTuple):
    """Decision on a request: whether it may pass, headers with the rest of the limit, seconds to wait, the rate."""

    granted: bool
    headers: Mapping[str, str]
    wait_seconds: int
    rate: limits.RateLimitItem


class Limiter:
    """Limits each subject (key or address) to a number of requests of a kind in each window of time."""

    def __init__(self, rates: dict[str, str]) -> None:
        self._rates = {name: limits.parse(rate) for name, rate in rates.items() if rate != "off"}
        self._counters = Counters()

    def admit(self, name: str, subject: str) -> Admission | None:
        """Count a request and decide on it; None where there is no limit."""
        rate = self._rates.get(name)
        if rate is None:
            return None
        now, window_s = time.monotonic(), rate.get_expiry()
        count, end = self._counters.hit((name, subject), window_s, now)
        wait = max(math.ceil(end - now), 1)
        headers = {
            "RateLimit-Policy": f'"{name}";q={rate.amount};w={window_s}',
            "RateLimit": f'"{name}";r={max(rate.amount - count, 0)};t={wait}',
        }
        return Admission(count <= rate.amount, headers, wait, rate)


def subject_of(address: str) -> str:
    """Caller of an address: the address itself, for IPv6 its /64 network, as one customer has that many addresses."""
    try:
        parsed = ipaddress.ip_address(address)
    except ValueError:
        return address
    if isinstance(parsed, ipaddress.IPv4Address):
        return address
    if parsed.ipv4_mapped:
        return str(parsed.ipv4_mapped)
    return str(ipaddress.ip_network((parsed, 64), strict=False))

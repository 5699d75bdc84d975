"""Rate limits per key or address, counted in the memory of one process."""

import ipaddress
import math
import time
from dataclasses import dataclass
from functools import lru_cache

import limits
from limits.storage import Storage

SWEEP_SECONDS = 30


class Counters(Storage):
    """Counters in a dictionary of one event loop. The library's own memory starts a thread for nearly every request."""

    STORAGE_SCHEME = None

    def __init__(self) -> None:
        super().__init__()
        self._counts: dict[str, tuple[int, float]] = {}
        self._sweep = 0.0

    @property
    def base_exceptions(self) -> type[Exception]:
        """What can go wrong here: nothing of its own."""
        return ValueError

    def incr(self, key: str, expiry: float, amount: int = 1) -> int:
        """Count; a new window begins where the last one has ended."""
        now = time.time()
        if now > self._sweep:
            self._counts = {name: entry for name, entry in self._counts.items() if entry[1] > now}
            self._sweep = now + SWEEP_SECONDS
        count, end = self._counts.get(key, (0, 0.0))
        if end <= now:
            count, end = 0, now + expiry
        self._counts[key] = count + amount, end
        return count + amount

    def get(self, key: str) -> int:
        """Count of the window that is running."""
        count, end = self._counts.get(key, (0, 0.0))
        return count if end > time.time() else 0

    def get_expiry(self, key: str) -> float:
        """End of the window."""
        return self._counts.get(key, (0, time.time()))[1]

    def check(self) -> bool:
        """It is always there."""
        return True

    def reset(self) -> int:
        """Forget all."""
        count = len(self._counts)
        self._counts.clear()
        return count

    def clear(self, key: str) -> None:
        """Forget one."""
        self._counts.pop(key, None)


@dataclass(frozen=True, slots=True)
class Admission:
    """Whether a request may pass, and the response headers that say how many more may."""

    granted: bool
    headers: tuple[tuple[bytes, bytes], ...]
    wait_seconds: int
    rate: limits.RateLimitItem


class Limiter:
    """Holds each subject, a key or an address, to the rate of its kind of request: so many in each window of time."""

    def __init__(self, rates: dict[str, str]) -> None:
        self._rates = {name: limits.parse(rate) for name, rate in rates.items() if rate != "off"}
        self._policies = {
            name: f'"{name}";q={item.amount};w={item.get_expiry()}'.encode() for name, item in self._rates.items()
        }
        self._counters = Counters()

    def admit(self, name: str, subject: str) -> Admission | None:
        """Count a request; None where there is no limit."""
        item = self._rates.get(name)
        if item is None:
            return None
        key = _key(item, name, subject)
        count = self._counters.incr(key, item.get_expiry())
        wait = max(math.ceil(self._counters.get_expiry(key) - time.time()), 1)
        state = b'"%b";r=%d;t=%d' % (name.encode(), max(item.amount - count, 0), wait)
        headers = ((b"ratelimit-policy", self._policies[name]), (b"ratelimit", state))
        return Admission(count <= item.amount, headers, wait, item)


@lru_cache(maxsize=4096)
def _key(item: limits.RateLimitItem, name: str, subject: str) -> str:
    return item.key_for(name, subject)


@lru_cache(maxsize=4096)
def subject_of(address: str) -> str:
    """Who an address stands for: itself, or its /64 network with IPv6, where one customer has that many addresses."""
    try:
        parsed = ipaddress.ip_address(address)
    except ValueError:
        return address
    if isinstance(parsed, ipaddress.IPv4Address):
        return address
    if parsed.ipv4_mapped:
        return str(parsed.ipv4_mapped)
    return str(ipaddress.ip_network((parsed, 64), strict=False))

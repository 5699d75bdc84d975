"""Limit of the bytes that requests of a process keep on disk until they are worked on."""

from collections.abc import Iterator
from contextlib import contextmanager

from hpn.web.door.problems import Problem

RETRY_SECONDS = 30


class Disk:
    """Bytes that all requests of one process together may set aside; at `app.state.disk`."""

    def __init__(self, total: int) -> None:
        self.total = total
        self.in_use = 0

    @contextmanager
    def share(self) -> Iterator["SpoolShare"]:
        """Yield the share of one request, given back at its end."""
        share = SpoolShare(self)
        try:
            yield share
        finally:
            share.give_back()


class SpoolShare:
    """Bytes that one request has set aside."""

    def __init__(self, disk: Disk) -> None:
        self._disk = disk
        self.in_use = 0

    def take(self, count: int) -> None:
        """Set more aside; Problem 413 for more than the total, 503 while other requests hold too much of it."""
        if self.in_use + count > self._disk.total:
            raise Problem(413, f"more than {self._disk.total} bytes can’t be set aside; send less at once")
        if self._disk.in_use + count > self._disk.total:
            text = f"other requests have set {self._disk.in_use} of {self._disk.total} bytes aside; try again later"
            raise Problem.later(text, RETRY_SECONDS)
        self.in_use += count
        self._disk.in_use += count

    def give_back(self) -> None:
        """Give all bytes back."""
        self._disk.in_use -= self.in_use
        self.in_use = 0

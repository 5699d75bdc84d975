"""The heap of the C library, of which little is kept that is free."""

import ctypes
from contextlib import suppress

TRIM_THRESHOLD, ARENA_MAX = -1, -8
"""Parameters of `mallopt`, as <malloc.h> numbers them."""

KEPT_BYTES = 128 * 1024


def give_back() -> None:
    """Have glibc give back to the system what is free beyond `KEPT_BYTES`, from one heap for all threads.

    By itself it begins like that, but lets the bound grow to 64 MB, and gives threads heaps of their own. Other C
    libraries have no `mallopt`, and keep their ways.
    """
    with suppress(AttributeError):
        mallopt = ctypes.CDLL(None).mallopt
        mallopt(TRIM_THRESHOLD, KEPT_BYTES)
        mallopt(ARENA_MAX, 1)

"""Huge pages for what lives as long as the process."""

import ctypes
import mmap
import re
import sys
from pathlib import Path

HUGE_PAGE = 2 * 1024 * 1024
COLLAPSE = 25
"""MADV_COLLAPSE of Linux, which `mmap` does not name yet."""

FILLED = 0.75
"""Share of an area that has to be in memory: stacks of threads, which hardly are, stay as they are."""

AREA = re.compile(r"^(\w+)-(\w+) rw-p \w+ 00:00 0 .*\n(?:(?!Rss)\w+:.*\n)*Rss: +(\d+) kB$", re.MULTILINE)


def into_huge_pages() -> None:
    """Have Linux put the heap into huge pages, as many systems leave it to a program to ask for.

    A reply touches some hundred places all over the heap, and for each the processor has to look up where its page is:
    on a virtual machine that is a tenth of a reply to every gear. An advice: where there are no huge pages to be had,
    everything stays as it is.
    """
    if sys.platform != "linux":
        return
    try:
        areas = AREA.findall(Path("/proc/self/smaps").read_text(errors="replace"))
    except OSError:
        return
    advise = ctypes.CDLL(None).madvise
    advise.argtypes = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int)
    for first, behind, resident_kB in areas:
        size = int(behind, 16) - int(first, 16)
        start, end = -(-int(first, 16) // HUGE_PAGE) * HUGE_PAGE, int(behind, 16) // HUGE_PAGE * HUGE_PAGE
        if start < end and int(resident_kB) * 1024 >= FILLED * size:
            advise(start, end - start, mmap.MADV_HUGEPAGE)
            advise(start, end - start, COLLAPSE)

"""Which duty cycles are evaluated together: every cycle of a chunk is padded to its longest."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike, NDArray

CHUNK_CYCLES = 1024
CHUNK_PHASES = 100_000
"""Cycles and phases of a chunk: its arrays stay in the processor's cache."""

LIKE = 2
"""How many times longer than the shortest cycle of a chunk the longest may be."""

SHORT_CYCLE = 16
"""Phases up to which a cycle counts as long as this."""


def chunks_of(counts: ArrayLike) -> Iterator[NDArray[np.intp]]:
    """Places of cycles with so many phases each, in chunks of like length."""
    lengths = np.asarray(counts, dtype=np.intp)
    order = np.argsort(lengths, kind="stable")
    ascending = lengths[order]
    start = 0
    while start < len(order):
        like = np.searchsorted(ascending, LIKE * max(ascending[start], SHORT_CYCLE), side="right")
        end = min(int(like), start + CHUNK_CYCLES)
        while (end - start) * ascending[end - 1] > CHUNK_PHASES and end > start + 1:
            end = start + max(int(CHUNK_PHASES // ascending[end - 1]), 1)
        yield order[start:end]
        start = end

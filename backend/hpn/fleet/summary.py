"""Counts over the answers of a fleet: gears, governing checks, utilisation by tenths, and axes without a gear."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

BINS = 10
"""Number of intervals of utilisation."""

Counts = tuple[tuple[str, int], ...]
"""Names with their numbers of axes, the largest number first."""


@dataclass(frozen=True)
class AxisCounts:
    """Counts over all axes. `checks` are the governing checks of selected gears; `utilisation` counts these in
    tenths."""

    axes: int
    rejected: int
    unsuitable: int
    gears: Counts
    checks: Counts
    utilisation: tuple[int, ...]

    @property
    def selected(self) -> int:
        """Number of axes with a gear."""
        return self.axes - self.rejected - self.unsuitable


def summary_of(answers: Iterable[pa.RecordBatch]) -> AxisCounts:
    """Count the axes of answers, batch by batch."""
    axes, rejected, unsuitable = 0, 0, 0
    gears, checks = Counter[str](), Counter[str]()
    bins = np.zeros(BINS, np.int64)
    for batch in answers:
        axes += batch.num_rows
        rejected += batch["suitable"].null_count
        unsuitable += pc.sum(pc.equal(batch["suitable"], 0)).as_py() or 0
        gears.update(_counts(batch["selected"]))
        checks.update(_counts(batch["governing_check"]))
        bins += _in_bins(batch["utilisation"])
    return AxisCounts(axes, rejected, unsuitable, _ordered(gears), _ordered(checks), tuple(bins.tolist()))


def _counts(names: pa.Array) -> dict[str, int]:
    return {entry["values"]: entry["counts"] for entry in pc.value_counts(names.drop_null()).to_pylist()}


def _in_bins(utilisation: pa.Array) -> NDArray[np.int64]:
    """Counts by tenths, each with its upper end; values that rounding puts above 1 count in the last."""
    used = utilisation.drop_null().to_numpy(zero_copy_only=False)
    return np.bincount(np.searchsorted(np.arange(1, BINS) / BINS, used), minlength=BINS)


def _ordered(counts: Counter[str]) -> Counts:
    return tuple(sorted(counts.items(), key=lambda entry: (-entry[1], entry[0])))

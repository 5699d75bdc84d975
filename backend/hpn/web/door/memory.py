"""Memory that the workers may take, against what the container has."""

from collections.abc import Iterable
from pathlib import Path

WORKER_BYTES = 768 << 20
LIMITS = (Path("/sys/fs/cgroup/memory.max"), Path("/sys/fs/cgroup/memory/memory.limit_in_bytes"))
"""Files with the limit of this container: of the second version of control groups, and of the first."""


def shortage(workers: int, beside_bytes: int, limits: Iterable[Path] = LIMITS) -> str | None:
    """Sentence for workers, each with so much beside it, that may take more than there is; None where it is enough."""
    needed, given = workers * (WORKER_BYTES + beside_bytes), _limit(limits)
    if given is None or needed <= given:
        return None
    return (
        f"HPN_WORKERS is {workers}, which with fleets may take {needed / 1e9:.1f} GB, and this container has "
        f"{given / 1e9:.1f} GB: give it more (WEB_MEMORY under compose), or fewer workers"
    )


def _limit(limits: Iterable[Path]) -> int | None:
    """Smallest limit in bytes, None where there is none."""
    texts = [file.read_text().strip() for file in limits if file.is_file()]
    return min((int(text) for text in texts if text.isdigit()), default=None)

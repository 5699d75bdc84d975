"""Many applications at once: the batch behind a PLM system's ten thousand axes."""

from collections import defaultdict
from collections.abc import Iterable, Sequence

from hpn.application import Application, InputError
from hpn.catalogue import Catalogue, GearList
from hpn.duty import Duty
from hpn.evaluation import evaluate
from hpn.selection import Judged, gears_for

CHUNK_CYCLES = 256
CHUNK_PHASES = 100_000
LIKE = 2
"""How many times longer than the shortest cycle of a chunk the longest may be."""

SHORT_CYCLE = 16
"""Phases up to which a cycle counts as long as this."""


def judge_batch(applications: Sequence[Application], catalogue: Catalogue) -> list[Judged | InputError]:
    """Each application on its gears, or the reason why it has none, in their order.

    Applications with the same candidates are evaluated together, in chunks that stay inside the processor's cache.
    """
    results: list[Judged | InputError | None] = [None] * len(applications)
    groups: dict[GearList, list[int]] = defaultdict(list)
    for index, application in enumerate(applications):
        try:
            groups[gears_for(application, catalogue)].append(index)
        except InputError as error:
            results[index] = error
    for gears, indices in groups.items():
        for chunk in _chunks(indices, applications):
            evaluation = evaluate(Duty.of([applications[index] for index in chunk]), gears, catalogue)
            for place, index in enumerate(chunk):
                results[index] = Judged(applications[index], evaluation, place)
    return [result for result in results if result is not None]


def _chunks(indices: list[int], applications: Sequence[Application]) -> Iterable[list[int]]:
    """Indices in chunks of cycles of like length, since every cycle of a chunk is padded to its longest."""

    def phases(index: int) -> int:
        return len(applications[index].duty_cycle.phases)

    chunk: list[int] = []
    for index in sorted(indices, key=phases):
        full = len(chunk) >= CHUNK_CYCLES or (len(chunk) + 1) * phases(index) > CHUNK_PHASES
        if chunk and (full or phases(index) > LIKE * max(phases(chunk[0]), SHORT_CYCLE)):
            yield chunk
            chunk = []
        chunk.append(index)
    if chunk:
        yield chunk

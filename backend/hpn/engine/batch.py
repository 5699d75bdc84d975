"""Many applications at once, as from a PLM system, evaluated in chunks of duty cycles of similar length."""

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hpn.application import Application, InputError
from hpn.catalogue import Catalogue, GearList
from hpn.engine.allowed import gears_for, with_listed_motor
from hpn.engine.duty import Duty
from hpn.engine.evaluation import evaluate
from hpn.engine.selection import Judgement, judge
from hpn.engine.tolerance import with_worst

Answer = TypeVar("Answer")

CHUNK_CYCLES = 1024
CHUNK_PHASES = 100_000
"""Cycles and phases of a chunk, small enough that its arrays stay in the processor's cache."""

LIKE = 2
"""Largest ratio of a chunk's longest cycle to its shortest; every cycle is padded to the longest."""

SHORT_CYCLE = 16
"""Phases below which a cycle counts as this long."""


def chunks_of(counts: ArrayLike) -> Iterator[NDArray[np.intp]]:
    """Places of cycles in chunks of similar length, from their numbers of phases."""
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


def judge_batch(
    applications: Sequence[Application], catalogue: Catalogue, answer: Callable[[Judgement], Answer]
) -> list[Answer | InputError]:
    """Answers to applications, or the errors that they raise, in the order of the applications.

    Applications with the same candidates are evaluated together, in chunks that stay inside the processor's cache.
    `answer` extracts the result from an evaluation, which is dropped afterwards: only one is kept at a time.
    """
    results: list[Answer | InputError | None] = [None] * len(applications)
    equipped = list(applications)
    groups: dict[GearList, list[int]] = defaultdict(list)
    for index, application in enumerate(applications):
        try:
            equipped[index] = with_listed_motor(application, catalogue)
            groups[gears_for(application, catalogue)].append(index)
        except InputError as error:
            results[index] = error
    for gears, indices in groups.items():
        for chunk in chunks_of([len(applications[index].duty_cycle.load_phases) for index in indices]):
            members = [indices[place] for place in chunk.tolist()]
            evaluation = evaluate(Duty.of([equipped[index] for index in members]), gears, catalogue)
            try:
                evaluation = with_worst([applications[index] for index in members], evaluation)
            except InputError:  # one of them has an invalid corner: each alone
                for index in members:
                    results[index] = _alone(applications[index], catalogue, answer)
                continue
            for place, index in enumerate(members):
                results[index] = answer(Judgement(applications[index], evaluation, place))
    return [result for result in results if result is not None]


def _alone(
    application: Application, catalogue: Catalogue, answer: Callable[[Judgement], Answer]
) -> Answer | InputError:
    try:
        return answer(judge(application, catalogue))
    except InputError as error:
        return error

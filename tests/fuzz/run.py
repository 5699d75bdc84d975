"""Sends the inputs of a door one after the other, and counts answers, times and findings."""

import asyncio
import os
import signal
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from itertools import repeat
from multiprocessing import get_context
from pathlib import Path
from random import Random
from typing import NoReturn

from tests.fuzz.doors import DOORS, World
from tests.fuzz.mutation import mutated

MOST_SECONDS = 1.0
"""Processor time that an input may take: unlike a clock it does not count what else the machine does."""

HANGING_SECONDS = 60
PART = 10_000
"""Inputs between two reports of a process."""


@dataclass
class Outcome:
    """Outcome of some inputs of a door; `findings` names each failing input by its seed."""

    inputs: int = 0
    seconds: float = 0.0
    slowest: tuple[float, int] = (0.0, 0)
    answers: Counter[str] = field(default_factory=Counter)
    findings: list[str] = field(default_factory=list)

    def add(self, other: "Outcome") -> None:
        """Count what another part came to."""
        self.inputs += other.inputs
        self.seconds += other.seconds
        self.slowest = max(self.slowest, other.slowest)
        self.answers += other.answers
        self.findings += other.findings

    def __str__(self) -> str:
        answers = ", ".join(f"{answer}: {count}" for answer, count in sorted(self.answers.items()))
        longest, seed = self.slowest
        mean = self.seconds / max(self.inputs, 1) * 1000
        return (
            f"{self.inputs} inputs ({answers}), {mean:.2f} ms each, longest {longest:.3f} s (seed {seed}), "
            f"{len(self.findings)} findings"
        )


def input_of(door: str, seed: int) -> tuple[Random, bytes]:
    """The input of a seed, and the source of chance with which it is sent."""
    random = Random(f"{door} {seed}")
    return random, mutated(random, DOORS[door].corpus, DOORS[door].words)


def attack(doors: Iterable[str], seeds: range) -> dict[str, Outcome]:
    """Send the inputs of some seeds through doors of one service."""
    with tempfile.TemporaryDirectory(dir=_memory()) as folder, warnings.catch_warnings():
        warnings.simplefilter("error")
        return asyncio.run(_attack(doors, seeds, Path(folder)))


async def _attack(doors: Iterable[str], seeds: range, folder: Path) -> dict[str, Outcome]:
    async with World.opened(folder) as world:
        try:
            return {door: await _attack_door(world, door, seeds) for door in doors}
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0)


async def _attack_door(world: World, door: str, seeds: range) -> Outcome:
    outcome = Outcome()
    for place, valid in enumerate(DOORS[door].corpus):  # what a process prepares once is no input's time
        await DOORS[door].send(world, Random(place), valid)
    for seed in seeds:
        signal.signal(signal.SIGPROF, partial(_hanging, door, seed))
        signal.setitimer(signal.ITIMER_PROF, HANGING_SECONDS)
        answer, seconds = await _timed(world, door, seed)
        outcome.inputs += 1
        outcome.seconds += seconds
        if seconds > MOST_SECONDS:  # beside busy neighbours even processor time is a matter of luck
            seconds = min(seconds, *[(await _timed(world, door, seed))[1] for _ in range(3)])
        outcome.slowest = max(outcome.slowest, (seconds, seed))
        if "\n" in answer or seconds > MOST_SECONDS:
            outcome.findings.append(f"{door} seed {seed}, {seconds:.2f} s: {answer}")
        else:
            outcome.answers[answer] += 1
    return outcome


async def _timed(world: World, door: str, seed: int) -> tuple[str, float]:
    """Answer to an input, or the traceback of what went wrong, and the processor time it took."""
    random, content = input_of(door, seed)
    start = time.process_time()
    try:
        answer = await DOORS[door].send(world, random, content)
    except Exception:
        answer = traceback.format_exc(limit=-3)
    return answer, time.process_time() - start


def _hanging(door: str, seed: int, *_: object) -> NoReturn:
    raise SystemExit(f"{door} seed {seed}: still at work after {HANGING_SECONDS} s of processor time")


def _memory() -> str | None:
    """A folder in memory where there is one: it is the service that is tried here, not the disk."""
    return "/dev/shm" if os.access("/dev/shm", os.W_OK) else None


def attack_in_parts(door: str, first: int, count: int, processes: int = 2) -> Outcome:
    """The same on several cores, each process giving way to whatever else runs."""
    parts = [range(start, min(start + PART, first + count)) for start in range(first, first + count, PART)]
    outcome = Outcome()
    with ProcessPoolExecutor(processes, get_context("spawn"), initializer=os.nice, initargs=(19,)) as pool:
        for part in pool.map(attack, repeat([door]), parts):
            outcome.add(part[door])
    return outcome

"""Trials in their order: each says in its name what must hold, and in its answer what it found."""

import re
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

from tests.containers.stack import Stack

RECOVERY_S = 25
"""Two checks of health, and some."""

Body = Callable[[Stack], str | None]


@dataclass
class Trials:
    """Trials of a kind, and their results."""

    bodies: dict[str, Body] = field(default_factory=dict)
    failed: list[str] = field(default_factory=list)
    passed: list[str] = field(default_factory=list)

    def __call__(self, name: str) -> Callable[[Body], Body]:
        """Add a function under a name."""

        def add(body: Body) -> Body:
            self.bodies[name] = body
            return body

        return add

    def run(self, stack: Stack, kind: str, wanted: str) -> None:
        """Try those of a module whose names a pattern finds, each from a healthy stack."""
        for name, body in self.bodies.items():
            if body.__module__ == kind and re.search(wanted, name):
                self.try_one(name, partial(_from_healthy, stack, body))

    def try_one(self, name: str, body: Callable[[], str | None]) -> bool:
        """Try one, and print a line; True if it holds."""
        start = time.monotonic()
        more: list[str] = []
        try:
            message, holds = body() or "", True
        except Exception as error:  # whatever goes wrong is this trial's failure, and the next one is tried
            (message, *more), holds = f"{type(error).__name__}: {error}".splitlines(), False
            more += [f"at {frame.filename}:{frame.lineno}" for frame in traceback.extract_tb(error.__traceback__)[-2:]]
        (self.passed if holds else self.failed).append(name)
        print(
            f"{'ok' if holds else 'FAILED':<6} {time.monotonic() - start:6.1f} s  {name}{message and ': '}{message}",
            flush=True,
        )
        print("".join(f"         {line[:300]}\n" for line in more[-15:]), end="", flush=True)
        return holds


def _from_healthy(stack: Stack, body: Body) -> str | None:
    try:
        stack.up()
    except RuntimeError:  # `up --wait` ends at once where the trial before has left a container unhealthy
        time.sleep(RECOVERY_S)
        stack.up()
    return body(stack)


trial = Trials()

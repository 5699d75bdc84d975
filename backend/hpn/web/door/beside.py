"""A process for work in which no thread can be stopped: kept from call to call, and killed where nobody waits any more.

It imports what its calls name and nothing else of the web, so that it starts soon.
"""

import os
import pickle
import re
import resource
import signal
import subprocess
import sys
import threading
import time
import traceback
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any, NamedTuple, TypeVar, cast

T = TypeVar("T")

NICENESS = 10
EXHAUSTED = 75
"""Exit code of a process whose work has met the bound of its memory."""

PARENT_SECONDS = 0.5
"""Time after which a process looks whether the one that started it is still there."""

KEPT_SHARE = 0.4
"""Share of its bound up to which a process is kept for the next call: of more, much would lie idle in it."""

PLAIN_MEMORY = {"ARROW_DEFAULT_MEMORY_POOL": "system", "OPENBLAS_NUM_THREADS": "1", "MALLOC_ARENA_MAX": "1"}
"""Environment of a bounded process: no library sets memory aside that the work then lacks."""


class Bounds(NamedTuple):
    """Most memory of a process, code and libraries included, and most time of one call on the clock."""

    memory_bytes: int
    seconds: float


class EndedError(Exception):
    """The process has ended before its work was done, or could not be started; the text says how.

    `is_excess` tells that the work took more than it may.
    """

    def __init__(self, text: str, *, is_excess: bool = False) -> None:
        super().__init__(text)
        self.is_excess = is_excess


class ProcessBeside:
    """At most one such process, for one caller at a time; with bounds, the system ends it where its work meets one."""

    def __init__(self, bounds: Bounds | None = None) -> None:
        self._bounds = bounds
        self._calling = threading.Lock()  # whoever has it may use the pipes
        self._lock = threading.Lock()  # whoever has it may start and end the process
        self._process: subprocess.Popen[bytes] | None = None
        self.is_taken = False

    @contextmanager
    def taken(self) -> Iterator[None]:
        """Have others of a pool look for another one."""
        self.is_taken = True
        try:
            yield
        finally:
            self.is_taken = False

    def call(self, work: Callable[[], T], given_up: threading.Event) -> T:
        """Result of work; EndedError, or RuntimeError with the traceback of what goes wrong there."""
        call = pickle.dumps(work)
        with self._calling:
            with self._lock:
                if given_up.is_set():
                    raise EndedError("given up")
                process = self._running()
            try:
                cast(Any, process.stdin).write(call)
                cast(Any, process.stdin).flush()
                done, result, has_grown = pickle.load(cast(Any, process.stdout))
            except (OSError, EOFError, pickle.UnpicklingError):
                self._reap(process)
                raise self._ended(process.returncode) from None
            if has_grown:
                self.end()
                self._reap(process)
        if not done:
            raise RuntimeError(result)
        return cast(T, result)

    def _ended(self, code: int) -> EndedError:
        """Killed is a process by this one, or by the system where the machine's memory runs out: no fault of the work.

        Whatever else ends a bounded one is its work: libraries abort, or worse, where they get no memory.
        """
        return EndedError(f"exit code {code}", is_excess=self._bounds is not None and code != -signal.SIGKILL)

    def end(self) -> None:
        """Kill the process; whoever calls at the moment gets an EndedError."""
        with self._lock:
            if self._process is not None:
                self._process.kill()

    def close(self) -> None:
        """Kill the process and wait until it has gone; whoever calls at the moment gets an EndedError first."""
        self.end()
        with self._calling:
            if self._process is not None:
                self._reap(self._process)

    def _reap(self, process: "subprocess.Popen[bytes]") -> None:
        """End a process that may be on its way out: how it ends by itself is told by its code."""
        with self._lock:
            with suppress(subprocess.TimeoutExpired):
                process.wait(0.1)
            process.kill()
            process.communicate()  # closes its pipes

    def _running(self) -> "subprocess.Popen[bytes]":
        if self._process is not None:
            if self._process.poll() is None:
                return self._process
            self._process.communicate()
        environment = {name: value for name, value in os.environ.items() if not name.upper().startswith("HPN_")}
        try:
            self._process = subprocess.Popen(
                [sys.executable, "-m", __name__, *map(str, self._bounds or ())],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env=environment | PLAIN_MEMORY if self._bounds else environment,
                start_new_session=True,  # Ctrl+C is for the service, which finishes what runs
            )
        except OSError as error:
            raise EndedError(f"it can’t be started: {error}") from None
        weakref.finalize(self, _forsaken, self._process)
        return self._process


def _forsaken(process: "subprocess.Popen[bytes]") -> None:
    """End a process whose owner is gone without having closed it."""
    process.kill()
    process.communicate()


def main(bounds: Bounds | None) -> None:
    """Answer calls until there are no more; what they print goes where errors go."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)  # of supervisors that send it to all: the service ends this one last
    with suppress(OSError):  # where memory runs out, the system ends this one before the service
        Path("/proc/self/oom_score_adj").write_text("1000", encoding="utf-8")
    if bounds:
        _restrain(bounds)
    threading.Thread(target=_end_with_parent, args=(os.getppid(),), daemon=True).start()
    calls, answers = os.fdopen(0, "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    while calls.peek(1):
        signal.setitimer(signal.ITIMER_REAL, bounds.seconds if bounds else 0)  # nothing here holds up the signal
        answer = _answer(calls, is_bounded=bounds is not None)
        pickle.dump((*answer, bounds is not None and _peak_bytes() > KEPT_SHARE * bounds.memory_bytes), answers)
        answers.flush()
        signal.setitimer(signal.ITIMER_REAL, 0)


def _end_with_parent(parent: int) -> None:
    """End this process when the one that started it is gone, which work in hand would not notice."""
    while os.getppid() == parent:
        time.sleep(PARENT_SECONDS)
    os._exit(1)


def _answer(calls: IO[bytes], *, is_bounded: bool) -> tuple[bool, Any]:
    """Result of the next call, or the traceback of what goes wrong."""
    try:
        return True, pickle.load(calls)()
    except BaseException as error:
        if is_bounded and isinstance(error, MemoryError):
            os._exit(EXHAUSTED)
        return False, traceback.format_exc()


def _peak_bytes() -> int:
    """Most memory that this process has had, 0 where the system doesn't say it."""
    status = Path("/proc/self/status")
    found = re.search(r"VmHWM:\s+(\d+) kB", status.read_text(encoding="ascii")) if status.exists() else None
    return int(found[1]) * 1024 if found else 0


def _restrain(bounds: Bounds) -> None:
    """Take no more memory than is allowed, and stand back behind the service."""
    os.nice(NICENESS)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    hard = resource.getrlimit(resource.RLIMIT_DATA)[1]
    most = bounds.memory_bytes if hard < 0 else min(bounds.memory_bytes, hard)
    resource.setrlimit(resource.RLIMIT_DATA, (most, hard))


if __name__ == "__main__":
    main(Bounds(int(sys.argv[1]), float(sys.argv[2])) if sys.argv[1:] else None)

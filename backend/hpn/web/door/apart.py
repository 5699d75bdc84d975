"""A process for work in which no thread can be stopped: kept from call to call, and killed where nobody waits any more.

It imports what its calls name and nothing else of the web, so that it starts soon.
"""

import os
import pickle
import signal
import subprocess
import sys
import threading
import traceback
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar, cast

from hpn.web.door import heap

T = TypeVar("T")


class EndedError(Exception):
    """The process has ended before its work was done, or could not be started; the text says how."""


class Apart:
    """At most one such process, for one caller at a time."""

    def __init__(self) -> None:
        self._calling = threading.Lock()  # whoever has it may use the pipes
        self._lock = threading.Lock()  # whoever has it may start and end the process
        self._process: subprocess.Popen[bytes] | None = None

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
                done, result = pickle.load(cast(Any, process.stdout))
            except (OSError, EOFError, pickle.UnpicklingError):
                self._reap(process)
                raise EndedError(f"exit code {process.returncode}") from None
        if not done:
            raise RuntimeError(result)
        return cast(T, result)

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
        with self._lock:
            process.kill()
            process.communicate()  # closes its pipes

    def _running(self) -> "subprocess.Popen[bytes]":
        if self._process is not None:
            if self._process.poll() is None:
                return self._process
            self._process.communicate()
        try:
            self._process = subprocess.Popen(
                [sys.executable, "-m", __name__],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env={name: value for name, value in os.environ.items() if not name.upper().startswith("HPN_")},
                start_new_session=True,  # Ctrl+C is for the service, which finishes what runs
            )
        except OSError as error:
            raise EndedError(f"it can’t be started: {error}") from None
        return self._process


def main() -> None:
    """Answer calls until there are no more; what they print goes where errors go."""
    heap.give_back()
    signal.signal(signal.SIGTERM, signal.SIG_IGN)  # of supervisors that send it to all: the service ends this one last
    with suppress(OSError):  # where memory runs out, the system ends this one before the service
        Path("/proc/self/oom_score_adj").write_text("1000", encoding="utf-8")
    calls, answers = os.fdopen(0, "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    while calls.peek(1):
        try:
            answer = True, pickle.load(calls)()
        except BaseException:
            answer = False, traceback.format_exc()
        pickle.dump(answer, answers)
        answers.flush()


if __name__ == "__main__":
    main()

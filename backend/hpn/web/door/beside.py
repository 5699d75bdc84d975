"""Process for work that a thread could not be stopped in: kept from call to call, killed when its caller has left.

The process imports only the modules that its calls name, so it starts fast. Its answers are plain data, decoded as the
called function's return type: even if a hostile file takes over the process, the service runs no code of it.
"""

import os
import pickle
import re
import resource
import signal
import struct
import subprocess
import sys
import threading
import time
import traceback
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import IO, Any, NamedTuple, TypeVar, cast, get_type_hints

import msgspec

T = TypeVar("T")

NICENESS = 10
EXHAUSTED = 75
"""Exit code of a process whose work reached its memory bound."""

PARENT_SECONDS = 0.5
"""Interval at which a process checks that its parent still runs."""

KEPT_SHARE = 0.4
"""Share of the memory bound above which a process is not kept for the next call: too much memory would lie idle."""

PLAIN_MEMORY = {"ARROW_DEFAULT_MEMORY_POOL": "system", "OPENBLAS_NUM_THREADS": "1", "MALLOC_ARENA_MAX": "1"}
"""Environment of a bounded process: keeps libraries from reserving memory that the work then lacks."""


_LENGTH = struct.Struct("<Q")
"""Length of an answer in bytes, sent before it."""


class Bounds(NamedTuple):
    """Maximum memory of a process, code and libraries included, and maximum wall-clock time of one call."""

    memory_bytes: int
    seconds: float


class EndedError(Exception):
    """The process ended before its work was done, or could not be started; the text gives the cause.

    `is_excess`: the work exceeded its bounds. `is_killed`: the process was killed, and not by the service; the system
    does so when the machine is out of memory.
    """

    def __init__(self, text: str, *, is_excess: bool = False, is_killed: bool = False) -> None:
        super().__init__(text)
        self.is_excess, self.is_killed = is_excess, is_killed


class CallResult(msgspec.Struct, array_like=True):
    """End of a call: its result or the traceback of its error; `has_grown` advises the caller to end the process."""

    is_done: bool
    has_grown: bool
    result: msgspec.Raw

    @classmethod
    def from_pipe(cls, pipe: IO[bytes]) -> "CallResult":
        """Next result from a pipe; EOFError at its end, ValueError for bytes that are not a result."""
        head = pipe.read(_LENGTH.size)
        if len(head) < _LENGTH.size:
            raise EOFError
        content = pipe.read(*_LENGTH.unpack(head))
        return msgspec.msgpack.decode(content, type=cls)

    def send(self, pipe: IO[bytes]) -> None:
        """Write the result to a pipe."""
        content = msgspec.msgpack.encode(self)
        pipe.write(_LENGTH.pack(len(content)) + content)
        pipe.flush()


class ProcessBeside:
    """At most one process, for one caller at a time; with bounds, the system ends the process at a bound."""

    def __init__(self, bounds: Bounds | None = None) -> None:
        self._bounds = bounds
        self._calling = threading.Lock()  # held to use the pipes
        self._lock = threading.Lock()  # held to start or end the process
        self._process: subprocess.Popen[bytes] | None = None
        self._is_ended = False
        self.is_taken = False

    @contextmanager
    def at_work(self) -> Iterator[None]:
        """Mark the process as taken, so that other callers of the pool choose another."""
        self.is_taken = True
        try:
            yield
        finally:
            self.is_taken = False

    def call(self, work: Callable[[], T], given_up: threading.Event) -> T:
        """Result of work; RuntimeError with the traceback of an error in the process, EndedError if it ends."""
        call, kind = pickle.dumps(work), _result_type(work)
        with self._calling:
            with self._lock:
                if given_up.is_set():
                    raise EndedError("given up")
                process = self._running()
            try:
                cast(Any, process.stdin).write(call)
                cast(Any, process.stdin).flush()
                answer = CallResult.from_pipe(cast(Any, process.stdout))
                result = msgspec.msgpack.decode(answer.result, type=kind if answer.is_done else str)
            except (OSError, EOFError, ValueError):
                self._reap(process)
                raise self._ended(process.returncode) from None
            if answer.has_grown:
                self.end()
                self._reap(process)
        if not answer.is_done:
            raise RuntimeError(result)
        return cast(T, result)

    def _ended(self, code: int) -> EndedError:
        """Error for a process that has ended. A bounded process that was not killed has ended by its work: libraries
        abort, or worse, when they get no memory.
        """
        is_killed = code == -signal.SIGKILL
        is_excess = self._bounds is not None and not is_killed
        return EndedError(f"exit code {code}", is_excess=is_excess, is_killed=is_killed and not self._is_ended)

    def end(self) -> None:
        """Kill the process; a caller under way gets an EndedError."""
        with self._lock:
            if self._process is not None:
                self._is_ended = True
                self._process.kill()

    def close(self) -> None:
        """Kill the process and wait until it has ended; a caller under way gets an EndedError first."""
        self.end()
        with self._calling:
            if self._process is not None:
                self._reap(self._process)

    def _reap(self, process: "subprocess.Popen[bytes]") -> None:
        """End a process that may be ending by itself: wait briefly first, so that its own exit code is kept."""
        with self._lock:
            try:
                process.wait(0.1)
            except subprocess.TimeoutExpired:
                self._is_ended = True
                process.kill()
            process.communicate()  # closes its pipes

    def _running(self) -> "subprocess.Popen[bytes]":
        if self._process is not None:
            if self._process.poll() is None:
                return self._process
            self._process.communicate()
        self._is_ended = False
        environment = {name: value for name, value in os.environ.items() if not name.upper().startswith("HPN_")}
        quiet = ("-W", "ignore") if self._bounds else ()
        try:
            self._process = subprocess.Popen(
                [sys.executable, *quiet, "-m", __name__, *map(str, self._bounds or ())],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL if self._bounds else None,  # libraries quote from a stranger's file
                env=environment | PLAIN_MEMORY if self._bounds else environment,
                start_new_session=True,  # Ctrl+C is for the service, which finishes running requests
            )
        except OSError as error:
            raise EndedError(f"it can’t be started: {error}") from None
        weakref.finalize(self, _forsaken, self._process)
        return self._process


def _result_type(work: Callable[[], Any]) -> Any:
    """Annotated return type of a function; any plain data where it has no annotation."""
    return get_type_hints(work.func if isinstance(work, partial) else work).get("return", Any)


def _forsaken(process: "subprocess.Popen[bytes]") -> None:
    """End a process whose owner was deleted without closing it."""
    process.kill()
    process.communicate()


def main(bounds: Bounds | None) -> None:
    """Answer calls until their pipe ends; output that they print goes to standard error."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)  # supervisors may signal all processes: this one ends last
    with suppress(OSError):  # when memory runs out, the system kills this one before the service
        Path("/proc/self/oom_score_adj").write_text("1000", encoding="utf-8")
    if bounds:
        _restrain(bounds)
    threading.Thread(target=_end_with_parent, args=(os.getppid(),), daemon=True).start()
    calls, answers = os.fdopen(0, "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    while calls.peek(1):
        signal.setitimer(signal.ITIMER_REAL, bounds.seconds if bounds else 0)  # nothing here holds up the signal
        is_done, result = _answer_call(calls, is_bounded=bounds is not None)
        has_grown = bounds is not None and _peak_bytes() > KEPT_SHARE * bounds.memory_bytes
        CallResult(is_done, has_grown, result).send(answers)
        signal.setitimer(signal.ITIMER_REAL, 0)


def _end_with_parent(parent: int) -> None:
    """End this process when its parent is gone; work under way would not notice."""
    while os.getppid() == parent:
        time.sleep(PARENT_SECONDS)
    os._exit(1)


def _answer_call(calls: IO[bytes], *, is_bounded: bool) -> tuple[bool, msgspec.Raw]:
    """True and the next call's result, or False and the traceback of its error."""
    try:
        result = pickle.load(calls)()
        return True, msgspec.Raw(msgspec.msgpack.encode(result, enc_hook=_plain))
    except BaseException as error:
        if is_bounded and isinstance(error, MemoryError):
            os._exit(EXHAUSTED)
        return False, msgspec.Raw(msgspec.msgpack.encode(traceback.format_exc()))


def _plain(value: object) -> str:
    """Plain text of a subclass of str; TypeError for any other type."""
    if isinstance(value, str):
        return str(value)
    raise TypeError(f"no plain data: {type(value)}")


def _peak_bytes() -> int:
    """Peak memory of this process, 0 where the system doesn't report it."""
    status = Path("/proc/self/status")
    match = re.search(r"VmHWM:\s+(\d+) kB", status.read_text(encoding="ascii")) if status.exists() else None
    return int(match[1]) * 1024 if match else 0


def _restrain(bounds: Bounds) -> None:
    """Limit this process's memory, and give the service priority over it."""
    os.nice(NICENESS)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    hard = resource.getrlimit(resource.RLIMIT_DATA)[1]
    most = bounds.memory_bytes if hard < 0 else min(bounds.memory_bytes, hard)
    resource.setrlimit(resource.RLIMIT_DATA, (most, hard))


if __name__ == "__main__":
    main(Bounds(int(sys.argv[1]), float(sys.argv[2])) if sys.argv[1:] else None)

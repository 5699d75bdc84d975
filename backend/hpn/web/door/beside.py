"""A process for work in which no thread can be stopped: kept from call to call, and killed where nobody waits any more.

It imports what its calls name and nothing else of the web, so that it starts soon. Its answers are plain data, decoded
as the type that the called function says: whatever a file makes of the process, nothing of it is run by the service.
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
"""Exit code of a process whose work has met the bound of its memory."""

PARENT_SECONDS = 0.5
"""Time after which a process looks whether the one that started it is still there."""

KEPT_SHARE = 0.4
"""Share of its bound up to which a process is kept for the next call: of more, much would lie idle in it."""

PLAIN_MEMORY = {"ARROW_DEFAULT_MEMORY_POOL": "system", "OPENBLAS_NUM_THREADS": "1", "MALLOC_ARENA_MAX": "1"}
"""Environment of a bounded process: no library sets memory aside that the work then lacks."""


_LENGTH = struct.Struct("<Q")
"""Bytes of an answer, before it."""


class Bounds(NamedTuple):
    """Most memory of a process, code and libraries included, and most time of one call on the clock."""

    memory_bytes: int
    seconds: float


class EndedError(Exception):
    """The process has ended before its work was done, or could not be started; the text says how.

    `is_excess` tells that the work took more than it may, `is_killed` that something else than the service killed it:
    the system, where the machine has no more memory.
    """

    def __init__(self, text: str, *, is_excess: bool = False, is_killed: bool = False) -> None:
        super().__init__(text)
        self.is_excess, self.is_killed = is_excess, is_killed


class CallResult(msgspec.Struct, array_like=True):
    """End of a call: its result, or the traceback of what went wrong; `has_grown` advises to end the process."""

    is_done: bool
    has_grown: bool
    result: msgspec.Raw

    @classmethod
    def received(cls, pipe: IO[bytes]) -> "CallResult":
        """The next one; EOFError, or ValueError for what is none."""
        head = pipe.read(_LENGTH.size)
        if len(head) < _LENGTH.size:
            raise EOFError
        content = pipe.read(*_LENGTH.unpack(head))
        return msgspec.msgpack.decode(content, type=cls)

    def send(self, pipe: IO[bytes]) -> None:
        """Write it."""
        content = msgspec.msgpack.encode(self)
        pipe.write(_LENGTH.pack(len(content)) + content)
        pipe.flush()


class ProcessBeside:
    """At most one such process, for one caller at a time; with bounds, the system ends it where its work meets one."""

    def __init__(self, bounds: Bounds | None = None) -> None:
        self._bounds = bounds
        self._calling = threading.Lock()  # whoever has it may use the pipes
        self._lock = threading.Lock()  # whoever has it may start and end the process
        self._process: subprocess.Popen[bytes] | None = None
        self._is_ended = False
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
        call, kind = pickle.dumps(work), _result_type(work)
        with self._calling:
            with self._lock:
                if given_up.is_set():
                    raise EndedError("given up")
                process = self._running()
            try:
                cast(Any, process.stdin).write(call)
                cast(Any, process.stdin).flush()
                answer = CallResult.received(cast(Any, process.stdout))
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
        """Error for a process that has ended. Whatever ends a bounded one without killing it is its work: libraries
        abort, or worse, where they get no memory.
        """
        is_killed = code == -signal.SIGKILL
        is_excess = self._bounds is not None and not is_killed
        return EndedError(f"exit code {code}", is_excess=is_excess, is_killed=is_killed and not self._is_ended)

    def end(self) -> None:
        """Kill the process; whoever calls at the moment gets an EndedError."""
        with self._lock:
            if self._process is not None:
                self._is_ended = True
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
                stderr=subprocess.DEVNULL if self._bounds else None,  # libraries quote what a stranger's file says
                env=environment | PLAIN_MEMORY if self._bounds else environment,
                start_new_session=True,  # Ctrl+C is for the service, which finishes what runs
            )
        except OSError as error:
            raise EndedError(f"it can’t be started: {error}") from None
        weakref.finalize(self, _forsaken, self._process)
        return self._process


def _result_type(work: Callable[[], Any]) -> Any:
    """Type that a function says to return; any plain data where it says none."""
    return get_type_hints(work.func if isinstance(work, partial) else work).get("return", Any)


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
        is_done, result = _done(calls, is_bounded=bounds is not None)
        has_grown = bounds is not None and _peak_bytes() > KEPT_SHARE * bounds.memory_bytes
        CallResult(is_done, has_grown, result).send(answers)
        signal.setitimer(signal.ITIMER_REAL, 0)


def _end_with_parent(parent: int) -> None:
    """End this process when the one that started it is gone, which work in hand would not notice."""
    while os.getppid() == parent:
        time.sleep(PARENT_SECONDS)
    os._exit(1)


def _done(calls: IO[bytes], *, is_bounded: bool) -> tuple[bool, msgspec.Raw]:
    """Result of the next call, or the traceback of what goes wrong."""
    try:
        result = pickle.load(calls)()
        return True, msgspec.Raw(msgspec.msgpack.encode(result, enc_hook=_plain))
    except BaseException as error:
        if is_bounded and isinstance(error, MemoryError):
            os._exit(EXHAUSTED)
        return False, msgspec.Raw(msgspec.msgpack.encode(traceback.format_exc()))


def _plain(value: object) -> str:
    """A text of a kind of its own as a text."""
    if isinstance(value, str):
        return str(value)
    raise TypeError(f"no plain data: {type(value)}")


def _peak_bytes() -> int:
    """Most memory that this process has had, 0 where the system doesn't say it."""
    status = Path("/proc/self/status")
    match = re.search(r"VmHWM:\s+(\d+) kB", status.read_text(encoding="ascii")) if status.exists() else None
    return int(match[1]) * 1024 if match else 0


def _restrain(bounds: Bounds) -> None:
    """Take no more memory than is allowed, and stand back behind the service."""
    os.nice(NICENESS)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    hard = resource.getrlimit(resource.RLIMIT_DATA)[1]
    most = bounds.memory_bytes if hard < 0 else min(bounds.memory_bytes, hard)
    resource.setrlimit(resource.RLIMIT_DATA, (most, hard))


if __name__ == "__main__":
    main(Bounds(int(sys.argv[1]), float(sys.argv[2])) if sys.argv[1:] else None)

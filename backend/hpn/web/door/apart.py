"""What a process of its own runs: a call as bytes. Nothing of the web is imported by it, so that it starts soon."""

import pickle
import signal
import traceback
from contextlib import suppress
from pathlib import Path

from hpn.web.door import heap


def called(call: bytes) -> object:
    """Result of a pickled call; RuntimeError with the traceback of what goes wrong, which pickle leaves behind."""
    heap.give_back()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C reaches it, too, and the service finishes what runs
    with suppress(OSError):  # where memory runs out, the system ends this one before the service
        Path("/proc/self/oom_score_adj").write_text("1000")
    try:
        result: object = pickle.loads(call)()
    except Exception:
        raise RuntimeError(traceback.format_exc()) from None
    return result

"""Restarts and kills while people save: nothing that was acknowledged is lost, and it goes on by itself."""

import time
from collections.abc import Callable

from tests.containers.savers import saving_while
from tests.containers.stack import Stack
from tests.containers.trials import trial

KILL_ALL = "kill -9 -1"
"""Inside a container: all but its first process, which then ends, too."""

KILL_WORKER = """
import os, pathlib, signal
for entry in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
    if b"spawn_main" in entry.read_bytes():
        os.kill(int(entry.parent.name), signal.SIGKILL)
        break
else:
    raise SystemExit("there is no worker")
"""


def _kill(service: str) -> Callable[[Stack], object]:
    def kill(stack: Stack) -> None:
        started = stack.inspect(service)["State"]["StartedAt"]
        stack.inside(service, "sh", "-c", KILL_ALL)
        for _ in range(100):
            state = stack.inspect(service)["State"]
            if state["StartedAt"] != started and state["Running"]:
                return
            time.sleep(0.2)
        raise AssertionError(f"{service} did not come back: {state}")

    return kill


def _paused(stack: Stack) -> None:
    stack.compose("pause", "db")
    time.sleep(8)
    stack.compose("unpause", "db")


def _stopped(stack: Stack) -> None:
    stack.compose("stop", "db")
    time.sleep(3)
    stack.up()


def _all_stopped(stack: Stack) -> None:
    stack.compose("stop")
    stack.up()


WAYS: dict[str, Callable[[Stack], object]] = {
    "web is restarted": lambda stack: stack.compose("restart", "web"),
    "all of web is killed": _kill("web"),
    "a worker of web is killed": lambda stack: stack.python(KILL_WORKER),
    "db is restarted": lambda stack: stack.compose("restart", "db"),
    "all of db is killed": _kill("db"),
    "db stands still for 8 s": _paused,
    "db is stopped and started": _stopped,
    "the proxy is restarted": lambda stack: stack.compose("restart", "proxy"),
    "all of the proxy is killed": _kill("proxy"),
    "everything is stopped and started": _all_stopped,
    "everything is made anew": lambda stack: stack.compose("up", "--detach", "--wait", "--force-recreate"),
}


def _add(name: str, happens: Callable[[Stack], object]) -> None:
    trial(f"people save while {name}")(lambda stack: saving_while(stack, lambda: happens(stack)))


for name, happens in WAYS.items():
    _add(name, happens)

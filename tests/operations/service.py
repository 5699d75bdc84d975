"""The service as its users run it: `hpn serve` in processes of its own, on a free port of loopback."""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import orjson

START_SECONDS = 120
"""It takes 3 s alone; several of them start beside each other on two cores."""
HPN = Path(sys.executable).with_name("hpn")


@dataclass
class Service:
    """A running service."""

    process: "subprocess.Popen[bytes]"
    port: int
    log: Path
    client: httpx.Client = field(repr=False)

    @property
    def url(self) -> str:
        """Its address."""
        return f"http://127.0.0.1:{self.port}"

    def events(self) -> list[dict[str, Any]]:
        """Its log so far."""
        return [orjson.loads(line) for line in self.log.read_bytes().split(b"\n")[:-1]]

    def event(self, *, count: int = 1, **fields: str) -> dict[str, Any]:
        """The event with these fields, once it has been logged `count` times."""
        for _ in range(START_SECONDS * 10):
            found = [event for event in self.events() if fields.items() <= event.items()]
            if len(found) >= count:
                return found[-1]
            time.sleep(0.1)
        raise AssertionError(f"nothing of this in the log: {fields}")

    def terminate(self) -> None:
        """Ask it to end, and go on."""
        self.process.send_signal(signal.SIGTERM)


def children_of(process: int) -> list[int]:
    """Processes that any thread of a process has started and that are still there."""
    return [
        int(child) for task in Path(f"/proc/{process}/task").glob("*/children") for child in task.read_text().split()
    ]


def until(holds: Callable[[], Any]) -> Any:
    """Value of a condition as soon as it holds; AssertionError after a minute."""
    end = time.monotonic() + 60
    while not (found := holds()):
        assert time.monotonic() < end
        time.sleep(0.02)
    return found


def is_gone(pid: int) -> bool:
    """True for a process that has ended."""
    with suppress(ProcessLookupError):
        os.kill(pid, 0)
        return False
    return True


@contextmanager
def held_port() -> Iterator[int]:
    """A port that the system gives to nobody else until the block ends: a program that asks for it can listen there."""
    with socket.socket() as held:
        held.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # as servers do, and only then beside each other
        held.bind(("", 0))  # free on every address, for a service that listens on all of them
        yield held.getsockname()[1]


@contextmanager
def serving(
    folder: Path,
    environment: Mapping[str, str] | None = None,
    *arguments: str,
    program: Sequence[str] = (str(HPN), "serve"),
    cwd: Path | None = None,
) -> Iterator[Service]:
    """Run `hpn serve`, or another program in its place, with a new database in `folder` until the block ends."""
    log = folder / "service.log"
    database = f"sqlite:///{folder}/store.sqlite3"
    clean = {name: value for name, value in os.environ.items() if not name.startswith("HPN_")}
    with held_port() as port, httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=60, trust_env=False) as client:
        command = [*program, "--port", str(port), *arguments]
        with log.open("wb") as output:
            process = subprocess.Popen(
                command,
                cwd=cwd,
                stdout=output,
                stderr=output,
                env={**clean, "HPN_DATABASE_URL": database, **(environment or {})},
            )
        service = Service(process, port, log, client)
        try:
            await_start(service)
            yield service
        finally:
            process.terminate()
            process.wait(timeout=60)


def await_start(service: Service) -> None:
    """Wait until it answers."""
    for _ in range(START_SECONDS * 10):
        try:
            if service.client.get("/healthz").status_code == 200:
                return
        except httpx.TransportError:
            if service.process.poll() is not None:
                break
            time.sleep(0.1)
    raise RuntimeError(f"the service did not start:\n{service.log.read_text()}")

"""A real server in its own process, and what it costs."""

import http.client
import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass

SERVICE = "hpn.web.serve:served_app"
JSON = {"Content-Type": "application/json"}


@dataclass(frozen=True)
class Server:
    """A running server."""

    pid: int
    port: int

    def cpu_seconds(self) -> float:
        """Processor time that the server has used so far, user and system."""
        with open(f"/proc/{self.pid}/stat") as file:
            fields = file.read().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def connect(self) -> http.client.HTTPConnection:
        """A connection to it."""
        return http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)


@contextmanager
def serving(factory: str, environment: Mapping[str, str] | None = None) -> Iterator[Server]:
    """Serve an application factory as `hpn serve` serves its own, on a free port of loopback, until the block ends."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    process = subprocess.Popen(
        [sys.executable, "-m", "tests.benchmarks.serve", factory],
        env={**os.environ, "HPN_PORT": str(port), "HPN_LOG_LEVEL": "warning", **(environment or {})},
    )
    try:
        server = Server(process.pid, port)
        _await_start(server, process)
        yield server
    finally:
        process.terminate()
        process.wait(timeout=20)


def _await_start(server: Server, process: "subprocess.Popen[bytes]") -> None:
    for _ in range(1200):
        if process.poll() is not None:
            raise RuntimeError(f"the server ended with {process.returncode}")
        try:
            socket.create_connection(("127.0.0.1", server.port), 1).close()
            return
        except OSError:
            time.sleep(0.1)
    raise RuntimeError("the server did not start")

"""Variants measured side by side: checkouts, each served from its own environment, and the plain service."""

import http.client
import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parents[3]
JSON = {"Content-Type": "application/json"}
START_SECONDS = 120


@dataclass(frozen=True)
class Checkout:
    """Installed checkout; nothing of it is imported here."""

    name: str
    folder: Path

    @property
    def hpn(self) -> str:
        """Path of its command."""
        return str(self.folder / ".venv/bin/hpn")

    def commit(self) -> str:
        """Commit to measure, with a plus where files differ from it."""
        return self._git("rev-parse", "--short", "HEAD") + ("+" if self._git("status", "--porcelain") else "")

    def _git(self, *arguments: str) -> str:
        return subprocess.run(
            ["git", *arguments], cwd=self.folder, check=True, capture_output=True, text=True
        ).stdout.strip()


@dataclass(frozen=True)
class Server:
    """Running server."""

    pid: int
    port: int

    @property
    def address(self) -> str:
        """Address of the server."""
        return f"http://127.0.0.1:{self.port}"

    def cpu_seconds(self) -> float:
        """Processor time used so far, user and system, in seconds."""
        fields = Path(f"/proc/{self.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def resident_MB(self) -> float:
        """Present memory in MB."""
        return self._status("VmRSS")

    def peak_MB(self) -> float:
        """Peak memory in MB."""
        return self._status("VmHWM")

    def ask(self, path: str, content: bytes | None = None, method: str = "") -> bytes:
        """Answer on a connection of its own; raises RuntimeError for a status of 300 or above."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=120)
        connection.request(method or ("POST" if content else "GET"), path, content, JSON if content else {})
        response = connection.getresponse()
        answer = response.read()
        connection.close()
        if response.status >= 300:
            raise RuntimeError(f"{path} answered {response.status}: {answer[:300]!r}")
        return answer

    def _status(self, name: str) -> float:
        status = Path(f"/proc/{self.pid}/status").read_text()
        return int(status.partition(f"{name}:")[2].split()[0]) / 1024


def clean_environment(**variables: str) -> dict[str, str]:
    """Environment of this machine without settings of the product and variables of this make."""
    own = ("HPN_", "MAKE", "MFLAGS", "PYTHON", "VIRTUAL_ENV", "BESIDE", "PORT", "HOST")
    return {name: value for name, value in os.environ.items() if not name.startswith(own)} | variables


@contextmanager
def product(checkout: Checkout, folder: Path) -> Iterator[Server]:
    """Run `hpn serve` of a checkout with a database in `folder`, until the block ends; rates are off."""
    rates = {f"HPN_{group}_RATE": "off" for group in ("CALCULATOR", "BATCH", "WRITING")}
    environment = clean_environment(HPN_DATABASE_URL=f"sqlite:///{folder}/{checkout.name}.sqlite3", **rates)
    with _running([checkout.hpn, "serve", "--port", "{port}"], folder, environment) as server:
        yield server


@contextmanager
def plain_service(folder: Path) -> Iterator[Server]:
    """Run the plain FastAPI service; `folder` holds its input."""
    command = [sys.executable, "-m", "tools.benchmarks.plain", "{port}", str(folder)]
    with _running(command, HERE, clean_environment()) as server:
        yield server


@contextmanager
def _running(command: list[str], folder: Path, environment: Mapping[str, str]) -> Iterator[Server]:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    words = [word.format(port=port) for word in command]
    # Its log is written as usual, and not read here.
    process = subprocess.Popen(words, cwd=folder, env=environment, stdout=subprocess.DEVNULL)
    try:
        _await_start(port, process)
        yield Server(process.pid, port)
    finally:
        process.terminate()
        process.wait(timeout=60)


def _await_start(port: int, process: "subprocess.Popen[bytes]") -> None:
    """Wait until the root answers, even if with 404."""
    deadline = time.monotonic() + START_SECONDS
    while time.monotonic() < deadline and process.poll() is None:
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=START_SECONDS)
        try:
            connection.request("GET", "/")
            connection.getresponse().read()
            return
        except OSError:
            time.sleep(0.01)
        finally:
            connection.close()
    raise RuntimeError(f"the server did not start; it ended with {process.poll()}")

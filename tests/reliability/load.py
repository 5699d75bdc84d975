"""Load on nginx from a process of its own: `python -m tests.reliability.load PORT RATE SECONDS CERTIFICATE`.

Connections come from 32 addresses, since one may have eight requests at once. Requests begin at fixed moments,
whether earlier ones are answered or not; one that finds no free connection waits, and that counts as its latency. A
rate of 0 asks for as much as eight connections take in turns, which measures capacity.
"""

import asyncio
import json
import math
import ssl
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from itertools import count

from tests.build import worked_example
from tests.operations.proxy import Proxy

CONNECTIONS = 256
AT_ONCE = 8
"""Connections by which capacity is measured: fewer than make an overload."""

ADDRESSES = 32

BODY = json.dumps(worked_example()).encode()
"""Its answer is short, so that reading it costs the client less than the service."""

REQUEST = (
    b"POST /api/v1/select HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
    b"Content-Length: %d\r\n\r\n%s" % (len(BODY), BODY)
)


@dataclass
class Outcome:
    """Answers by status; latencies in seconds of those with status 200."""

    seconds: float = 0.0
    statuses: dict[int, int] = field(default_factory=dict)
    p50: float = math.nan
    p99: float = math.nan
    longest: float = math.nan

    @property
    def answered(self) -> int:
        """Requests answered with 200."""
        return self.statuses.get(200, 0)

    @property
    def refused(self) -> int:
        """Requests answered with 503."""
        return self.statuses.get(503, 0)

    @property
    def share_refused(self) -> float:
        """Part of all requests that was answered with 503."""
        return self.refused / max(sum(self.statuses.values()), 1)

    @property
    def others(self) -> int:
        """Requests with any other answer, or none, which counts as status 0."""
        return sum(self.statuses.values()) - self.answered - self.refused


def load(proxy: Proxy, rate: float, seconds: float) -> Outcome:
    """Outcome of load from a process of its own."""
    certificate = str(proxy.folder / "fullchain.pem")
    command = [sys.executable, "-m", "tests.reliability.load", str(proxy.https), str(rate), str(seconds), certificate]
    outcome = subprocess.run(command, check=True, capture_output=True, timeout=seconds + 120)
    result = json.loads(outcome.stdout)
    return Outcome(**result | {"statuses": {int(status): n for status, n in result["statuses"].items()}})


async def _ask(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> int:
    writer.write(REQUEST)
    head = await reader.readuntil(b"\r\n\r\n")
    length = int(head.lower().partition(b"content-length:")[2].split()[0])
    await reader.readexactly(length)
    return int(head.split(None, 2)[1])


Stream = tuple[asyncio.StreamReader, asyncio.StreamWriter]


class _Load:
    def __init__(self, port: int, rate: float, seconds: float, certificate: str) -> None:
        self._port, self._rate, self._seconds = port, rate, seconds
        self._trust = ssl.create_default_context(cafile=certificate)
        self._opened = count()
        self._numbers = count()
        self._latencies: list[float] = []
        self._statuses: dict[int, int] = {}

    async def run(self) -> Outcome:
        # Opened before: a server accepts few connections in a turn, and requests behind these are not yet its own.
        # Each asks every two seconds, before it is closed as idle.
        connections = min(CONNECTIONS, max(AT_ONCE, round(2 * self._rate)))
        streams = [await self._open() for _ in range(connections)]
        self._start = time.perf_counter() + 0.2
        await asyncio.gather(*map(self._connection, streams))
        latencies = sorted(self._latencies) or [math.nan]
        return Outcome(
            time.perf_counter() - self._start,
            self._statuses,
            latencies[len(latencies) // 2],
            latencies[int(len(latencies) * 0.99)],
            latencies[-1],
        )

    def _moments(self) -> Iterator[float]:
        """Moments at which this connection asks next, as long as the load lasts."""
        while True:
            moment = self._start + next(self._numbers) / self._rate if self._rate else time.perf_counter()
            if moment > self._start + self._seconds:
                return
            yield moment

    async def _open(self) -> Stream:
        source = f"127.0.0.{2 + next(self._opened) % ADDRESSES}"
        return await asyncio.open_connection(
            "127.0.0.1", self._port, ssl=self._trust, server_hostname="localhost", local_addr=(source, 0)
        )

    async def _connection(self, stream: Stream | None) -> None:
        for moment in self._moments():
            if (early := moment - time.perf_counter()) > 0:
                await asyncio.sleep(early)
                moment = time.perf_counter()  # a timer that is late is no delay of the service
            try:
                stream = stream or await self._open()
                status = await _ask(*stream)
            except (OSError, asyncio.IncompleteReadError):
                status, stream = 0, None
            self._statuses[status] = self._statuses.get(status, 0) + 1
            if status == 200:
                self._latencies.append(time.perf_counter() - moment)
        if stream is not None:
            stream[1].close()


if __name__ == "__main__":
    port, rate, seconds, certificate = sys.argv[1:]
    print(json.dumps(asdict(asyncio.run(_Load(int(port), float(rate), float(seconds), certificate).run()))))

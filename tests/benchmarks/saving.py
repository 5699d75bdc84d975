"""Saving a selection against calculating it alone, with 16 clients at once, on SQLite."""

import asyncio
import statistics
import tempfile
import time
from collections.abc import Iterator
from typing import Any

from tests.benchmarks.reply import body
from tests.benchmarks.server import SERVICE, Server, serving

CLIENTS = 16
REQUESTS = 320
ROUNDS = 25


def measure() -> dict[str, Any]:
    """Time and processor time per request, saving over calculating, for the worked example and for every gear."""
    with tempfile.TemporaryDirectory() as folder:
        environment = {"HPN_DATABASE_URL": f"sqlite:///{folder}/store.sqlite3", "HPN_WRITING_RATE": "off"}
        with serving(SERVICE, environment | {"HPN_CALCULATOR_RATE": "off"}) as server:
            return {
                "worked_example_5_gears": _compare(server, [5]),
                "every_gear_64": _compare(server, None),
            }


def _compare(server: Server, ratios: list[int] | None) -> dict[str, Any]:
    applications = [body(index, ratios) for index in range(REQUESTS)]
    selects = [_request("/api/v1/select", content) for content in applications]
    saves = [_request("/api/v1/selections", b'{"application":' + content + b"}") for content in applications]
    rounds = []
    for _ in range(ROUNDS):  # in short turns, so that both see the same noise
        rounds.append((_cost(server, selects), _cost(server, saves)))
    return {
        "clients": CLIENTS,
        "time_over_calculation": round(statistics.median(save[0] / select[0] for select, save in rounds), 2),
        # As a sum, since the system counts in hundredths of a second.
        "processor_time_over_calculation": round(
            sum(save[1] for _, save in rounds) / sum(select[1] for select, _ in rounds), 2
        ),
        "calculation_time_us": round(1e6 * min(select[0] for select, _ in rounds)),
        "saving_time_us": round(1e6 * min(save[0] for _, save in rounds)),
    }


def _request(path: str, content: bytes) -> bytes:
    head = (
        f"POST {path} HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\nContent-Length: {len(content)}\r\n\r\n"
    )
    return head.encode() + content


def _cost(server: Server, requests: list[bytes]) -> tuple[float, float]:
    """Seconds and processor seconds of the server per request, with all clients busy."""
    processor, start = server.cpu_seconds(), time.perf_counter()
    asyncio.run(_send_all(server.port, requests))
    elapsed, spent = time.perf_counter() - start, server.cpu_seconds() - processor
    return elapsed / len(requests), spent / len(requests)


async def _send_all(port: int, requests: list[bytes]) -> None:
    waiting = iter(requests)
    await asyncio.gather(*(_client(port, waiting) for _ in range(CLIENTS)))


async def _client(port: int, waiting: Iterator[bytes]) -> None:
    reader, writer = await asyncio.open_connection("127.0.0.1", port, limit=1 << 20)
    for request in waiting:
        writer.write(request)
        head = await reader.readuntil(b"\r\n\r\n")
        length = int(head.lower().partition(b"content-length:")[2].partition(b"\r\n")[0])
        content = await reader.readexactly(length)
        if head[9:10] != b"2":
            raise RuntimeError(f"answered {head[:40]!r} {content[:300]!r}")
    writer.close()
    await writer.wait_closed()

"""Replies over HTTP: time from request to last byte, with one connection and with sixteen at once."""

import asyncio
import json
import math
import statistics
import time
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import uvloop

from tools.benchmarks.applications import CASES, save_body, select_body
from tools.benchmarks.turns import in_turns, p95, ratios
from tools.benchmarks.variants import Server

CONNECTIONS = (1, 16)
REQUESTS = {"/api/v1/select": 160, "/api/v1/selections": 64}
"""Requests in a turn of each variant; fewer where each is written to a disk."""

TURNS = 9

Seconds = list[float]


def measure(servers: Mapping[str, Server], path: str) -> dict[str, Any]:
    """Milliseconds of `POST path` by number of gears and of connections, and ratios of the variants."""
    body = {"/api/v1/select": select_body, "/api/v1/selections": save_body}[path]
    found: dict[str, Any] = {}
    for case, restriction in CASES.items():
        bodies = [body(number, restriction) for number in range(REQUESTS[path])]
        requests = [_request(path, content) for content in bodies]
        found[case] = {f"connections_{count}": _compare(servers, requests, count) for count in CONNECTIONS}
    return found


def _compare(servers: Mapping[str, Server], requests: list[bytes], connections: int) -> dict[str, Any]:
    def turn_of(server: Server) -> Callable[[int], tuple[Seconds, float]]:
        return lambda turn: _turn(server, requests, connections)

    found = in_turns({name: turn_of(server) for name, server in servers.items()}, TURNS)
    latencies = {name: [latency for turn, _ in turns for latency in turn] for name, turns in found.items()}
    return {
        **{
            name: {
                "p50_ms": round(1e3 * statistics.median(latencies[name]), 3),
                "p95_ms": round(1e3 * p95(latencies[name]), 3),
                # As a sum, since the system counts in hundredths of a second.
                "processor_ms": round(1e3 * sum(spent for _, spent in turns) / len(latencies[name]), 3),
            }
            for name, turns in found.items()
        },
        "p50_ratios": ratios({name: [statistics.median(turn) for turn, _ in turns] for name, turns in found.items()}),
        "p95_ratios": ratios({name: [p95(turn) for turn, _ in turns] for name, turns in found.items()}),
    }


def _turn(server: Server, requests: list[bytes], connections: int) -> tuple[Seconds, float]:
    """Seconds of each reply, and the server's processor seconds for all of them."""
    processor = server.cpu_seconds()
    latencies = uvloop.run(_send_all(server.port, requests, connections))
    return latencies, server.cpu_seconds() - processor


async def _send_all(port: int, requests: list[bytes], connections: int) -> Seconds:
    waiting, latencies = iter(requests), Seconds()
    await asyncio.gather(*(_client(port, waiting, latencies) for _ in range(connections)))
    return latencies


async def _client(port: int, waiting: Iterator[bytes], latencies: Seconds) -> None:
    reader, writer = await asyncio.open_connection("127.0.0.1", port, limit=1 << 20)
    for request in waiting:
        start = time.perf_counter()
        writer.write(request)
        head = await reader.readuntil(b"\r\n\r\n")
        length = int(head.lower().partition(b"content-length:")[2].partition(b"\r\n")[0])
        content = await reader.readexactly(length)
        latencies.append(time.perf_counter() - start)
        if head[9:10] != b"2":
            raise RuntimeError(f"answered {head[:40]!r} {content[:300]!r}")
    writer.close()
    await writer.wait_closed()


def _request(path: str, content: bytes) -> bytes:
    head = f"POST {path} HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
    return f"{head}Content-Length: {len(content)}\r\n\r\n".encode() + content


def prove_equal(servers: Mapping[str, Server]) -> None:
    """Raise RuntimeError unless all servers return the same figures and order, without which their times say
    nothing."""
    for restriction in CASES.values():
        answers = {
            name: json.loads(server.ask("/api/v1/select", select_body(7, restriction)))
            for name, server in servers.items()
        }
        first = next(iter(answers.values()))
        for name, answer in answers.items():
            for part in ("duty", "selected", "candidates"):
                for place in differing(first[part], answer[part], part):
                    raise RuntimeError(f"{name} answers differently at {place}")


def differing(one: Any, other: Any, place: str) -> Iterator[str]:
    """Places where two replies differ: figures by more than 1e-12 of themselves; sentences may differ."""
    if isinstance(one, dict) and isinstance(other, dict):
        for name in (one.keys() & other.keys()) - {"reason"}:  # a version may have more fields than another
            yield from differing(one[name], other[name], f"{place}/{name}")
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        for index, (left, right) in enumerate(zip(one, other, strict=True)):
            yield from differing(left, right, f"{place}/{index}")
    elif isinstance(one, int | float) and isinstance(other, int | float):
        if not math.isclose(one, other, rel_tol=1e-12):
            yield place
    elif one != other:
        yield place

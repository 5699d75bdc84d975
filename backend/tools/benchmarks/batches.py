"""Batch of ten thousand axes with ten phases each, as one JSON document and as a stream of lines."""

import http.client
import json
import statistics
import time
from collections.abc import Callable, Mapping
from typing import Any

from tools.benchmarks.applications import axis
from tools.benchmarks.turns import in_turns, ratios
from tools.benchmarks.variants import Server

AXES = 10_000
PHASES = 10
TURNS = 5


def measure(servers: Mapping[str, Server]) -> dict[str, Any]:
    """Axes per second by form of the batch, and each server's peak memory until then."""
    axes = [axis(number, PHASES) for number in range(AXES)]
    bodies = {
        "json": ("application/json", json.dumps({"applications": axes}).encode()),
        "lines": ("application/x-ndjson", b"".join(json.dumps(entry).encode() + b"\n" for entry in axes)),
    }
    return {name: _compare(servers, *body) for name, body in bodies.items()}


def _compare(servers: Mapping[str, Server], media_type: str, body: bytes) -> dict[str, Any]:
    def turn_of(server: Server) -> Callable[[int], float]:
        return lambda turn: _rate(server, media_type, body)

    rates = in_turns({name: turn_of(server) for name, server in servers.items()}, TURNS)
    return {
        **{
            name: {"axes_per_s": round(statistics.median(rates[name])), "peak_MB": round(server.peak_MB())}
            for name, server in servers.items()
        },
        "rate_ratios": ratios(rates),
    }


def _rate(server: Server, media_type: str, body: bytes) -> float:
    start = time.perf_counter()
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=120)
    connection.request("POST", "/api/v1/select/batch", body, {"Content-Type": media_type})
    answer = connection.getresponse().read()
    seconds = time.perf_counter() - start
    connection.close()
    if (answered := answer.count(b'"status":"ok"')) != AXES:
        raise RuntimeError(f"{answered} of {AXES} axes are answered: {answer[:300]!r}")
    return AXES / seconds

"""Machine of ten thousand axes: its page shown, sorted and filtered, its axes listed, an axis opened and saved, and the
changes compared with the revision before."""

import json
import statistics
import time
from collections.abc import Callable, Mapping
from typing import Any

from tools.benchmarks.applications import axis
from tools.benchmarks.turns import in_turns, p95, ratios
from tools.benchmarks.variants import Server

AXES = 10_000
PHASES = 10
TURNS = 15
LISTED = "order,axes.number,axes.name,axes.quantity,axes.answer"

ACTIONS: Mapping[str, str] = {
    "show": "/machines/{id}",
    "sort": "/machines/{id}?sort=-utilisation",
    "filter": "/machines/{id}?show=changed",
    "list": f"/api/v1/machines/{{id}}?fields={LISTED}",
    "open": "/api/v1/machines/{id}/axes/{number}",
    "save": "/api/v1/machines/{id}/axes/{number}",
    "compare": "/api/v1/machines/{id}/differences?from=A&to=now",
}
"""Actions on a machine, and their addresses."""


def measure(servers: Mapping[str, Server]) -> dict[str, Any]:
    """Seconds of saving the machine, milliseconds of each action, and each server's peak memory until then."""
    body = _machine()
    saved = {name: _saved(server, body) for name, server in servers.items()}
    found: dict[str, Any] = {"create": {name: {"seconds": round(seconds, 2)} for name, (_, seconds) in saved.items()}}
    for action in ACTIONS:
        times = in_turns({name: _turn_of(server, action, saved[name][0]) for name, server in servers.items()}, TURNS)
        found[action] = {
            **{
                name: {
                    "p50_ms": round(1e3 * statistics.median(times[name]), 1),
                    "p95_ms": round(1e3 * p95(times[name]), 1),
                }
                for name in servers
            },
            "ratios": ratios(times),
        }
    return found | {"peak_MB": {name: round(server.peak_MB()) for name, server in servers.items()}}


def _machine() -> bytes:
    axes = []
    for number in range(AXES):
        application = axis(number, PHASES)
        axes.append({"name": application.pop("reference"), "quantity": 1 + number % 4, "application": application})
    return json.dumps({"title": "Bench", "common": {"requirements": {"utilisation": 0.9}}, "axes": axes}).encode()


def _saved(server: Server, body: bytes) -> tuple[str, float]:
    """Id of the machine, which has a revision, and seconds until the answer."""
    start = time.perf_counter()
    id: str = json.loads(server.ask("/api/v1/machines", body))["id"]
    seconds = time.perf_counter() - start
    server.ask(f"/api/v1/machines/{id}/revisions", b'{"label": "A"}')
    return id, seconds


def _turn_of(server: Server, action: str, id: str) -> Callable[[int], float]:
    def turn(number: int) -> float:
        path = ACTIONS[action].format(id=id, number=1 + 97 * number)
        # Another torque each time, so that the axis is answered anew.
        cycle = axis(number + AXES, PHASES)["duty_cycle"]
        content = json.dumps({"application": {"duty_cycle": cycle}}).encode() if action == "save" else None
        start = time.perf_counter()
        server.ask(path, content, "PATCH" if content else "GET")
        return time.perf_counter() - start

    return turn

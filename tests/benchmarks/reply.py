"""One reply for one cycle against its floor: a bare Starlette route with the same model in and a ready reply out."""

import json
import statistics
import time
from typing import Any

from tests.benchmarks.server import JSON, SERVICE, Server, serving

REQUESTS = 160
ROUNDS = 25


def body(index: int, ratios: list[int] | None) -> bytes:
    """The worked example with a torque of its own, so that nothing could be served from a cache."""
    cycle = {
        "phases": [
            {"torque_Nm": 40 + index * 1e-3, "speed_rpm": 250, "duration_s": 0.3},
            {"torque_Nm": 32, "speed_rpm": 500, "duration_s": 3.0},
            {"torque_Nm": 20, "speed_rpm": 250, "duration_s": 0.4},
        ],
        "pause_s": 4.0,
    }
    application: dict[str, Any] = {"duty_cycle": cycle, "emergency_stop": {"torque_Nm": 200}}
    if ratios:
        application["requirements"] = {"ratios": ratios}
    return json.dumps(application).encode()


def measure() -> dict[str, Any]:
    """Time and processor time per reply, service over floor, for the worked example and for every gear."""
    with (
        serving("tests.benchmarks.floor:create_floor") as five,
        serving("tests.benchmarks.floor:create_full_floor") as full,
        serving(SERVICE) as service,
    ):
        return {
            "worked_example_5_gears": _compare(five, service, [5]),
            "every_gear_64": _compare(full, service, None),
        }


def _compare(floor: Server, service: Server, ratios: list[int] | None) -> dict[str, Any]:
    bodies = [body(index, ratios) for index in range(REQUESTS)]
    rounds = []
    for _ in range(ROUNDS):  # in short turns, so that both see the same noise
        rounds.append((_cost(floor, bodies), _cost(service, bodies)))
    time_ratios = [ours[0] / theirs[0] for theirs, ours in rounds]
    # As a sum, since the system counts in hundredths of a second.
    processor_ratio = sum(ours[1] for _, ours in rounds) / sum(theirs[1] for theirs, _ in rounds)
    return {
        "reply_bytes": _size(service, bodies[0]),
        "time_over_floor": round(statistics.median(time_ratios), 2),
        "processor_time_over_floor": round(processor_ratio, 2),
        "floor_time_us": round(1e6 * min(theirs[0] for theirs, _ in rounds)),
        "service_time_us": round(1e6 * min(ours[0] for _, ours in rounds)),
    }


def _cost(server: Server, bodies: list[bytes]) -> tuple[float, float]:
    """Seconds and processor seconds of the server per reply, as a caller with one connection sees it."""
    connection = server.connect()
    processor, start = server.cpu_seconds(), time.perf_counter()
    for content in bodies:
        connection.request("POST", "/api/v1/select", content, JSON)
        response = connection.getresponse()
        if response.status != 200:
            raise RuntimeError(f"answered {response.status}: {response.read()[:300]!r}")
        response.read()
    elapsed, spent = time.perf_counter() - start, server.cpu_seconds() - processor
    connection.close()
    return elapsed / len(bodies), spent / len(bodies)


def _size(server: Server, content: bytes) -> int:
    connection = server.connect()
    connection.request("POST", "/api/v1/select", content, JSON)
    size = len(connection.getresponse().read())
    connection.close()
    return size

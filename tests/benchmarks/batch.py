"""Memory and speed of a streamed batch, on both sides, from a thousand axes to a hundred thousand.

The client sends everything before it reads anything, as most HTTP libraries do: for the service that is the hard case.
"""

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.benchmarks.server import SERVICE, Server, serving

COUNTS = (1_000, 10_000, 100_000)
LINES_AT_ONCE = 100


def body(count: int) -> Iterator[bytes]:
    """Lines of applications, each with a torque of its own."""
    for start in range(0, count, LINES_AT_ONCE):
        yield b"".join(line(number) for number in range(start, min(start + LINES_AT_ONCE, count)))


def line(number: int) -> bytes:
    """One application."""
    phases = [
        {"torque_Nm": 20 + number % 400 / 10, "speed_rpm": 250, "duration_s": 0.3},
        {"torque_Nm": 32, "speed_rpm": 500, "duration_s": 3.0},
        {"torque_Nm": 20, "speed_rpm": 250, "duration_s": 0.4},
    ]
    application = {"reference": f"axis-{number}", "duty_cycle": {"phases": phases, "pause_s": 4.0}}
    return json.dumps(application).encode() + b"\n"


def peak_MB(pid: int | str) -> float:
    """Largest resident memory of a process so far."""
    status = Path(f"/proc/{pid}/status").read_text()
    return int(status.partition("VmHWM:")[2].split()[0]) / 1024


def forget_peak(pid: int) -> None:
    """Measure the peak anew from here on."""
    Path(f"/proc/{pid}/clear_refs").write_text("5")


def stream(server: Server, count: int) -> dict[str, Any]:
    """What one batch costs, seen from a client in a process of its own."""
    forget_peak(server.pid)
    command = [sys.executable, "-m", "tests.benchmarks.batch", str(server.pid), str(server.port), str(count)]
    client: dict[str, Any] = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    if client["answered"] != count:
        raise RuntimeError(f"{client['answered']} of {count} lines are answered")
    return {
        "axes": count,
        "server_peak_MB": round(peak_MB(server.pid), 1),
        "client_peak_MB": round(client["peak_MB"], 1),
        "axes_per_s": round(count / client["seconds"]),
    }


def measure() -> dict[str, Any]:
    """Peak memory by number of axes, after a first batch that warms up what is loaded once."""
    with serving(SERVICE) as server:
        stream(server, COUNTS[0])
        rows = [stream(server, count) for count in COUNTS]
    return {
        "by_count": rows,
        "server_growth_MB": round(rows[-1]["server_peak_MB"] - rows[0]["server_peak_MB"], 1),
        "client_growth_MB": round(rows[-1]["client_peak_MB"] - rows[0]["client_peak_MB"], 1),
    }


def client(server: Server, count: int) -> dict[str, Any]:
    """Send, then read line by line."""
    start, answered = time.perf_counter(), 0
    connection = server.connect()
    connection.request("POST", "/api/v1/select/batch", body(count), {"Content-Type": "application/x-ndjson"})
    for answer in connection.getresponse():
        if json.loads(answer)["reference"] != f"axis-{answered}":
            raise RuntimeError(f"out of order: {answer!r}")
        answered += 1
    connection.close()
    return {"answered": answered, "seconds": time.perf_counter() - start, "peak_MB": peak_MB("self")}


if __name__ == "__main__":
    print(json.dumps(client(Server(int(sys.argv[1]), int(sys.argv[2])), int(sys.argv[3]))))

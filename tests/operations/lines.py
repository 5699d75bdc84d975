"""Memory of a batch of lines on both sides: `python -m tests.operations.lines PORT COUNT` is its client, which
comes through nginx where a file with its certificate is named as well.

The client sends everything before it reads anything, as most HTTP libraries do: for the service that is the hard case.
"""

import http.client
import json
import ssl
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

LINES_AT_ONCE = 100


def peaks_MB(server: int, port: int, count: int, certificate: Path | None = None) -> tuple[float, float]:
    """Most memory of the server's process and of a client in a process of its own, while a batch is answered."""
    Path(f"/proc/{server}/clear_refs").write_text("5")  # the peak counts anew from here
    command = [sys.executable, "-m", "tests.operations.lines", str(port), str(count)]
    command += [str(certificate)] if certificate else []
    client = float(subprocess.run(command, check=True, capture_output=True).stdout)
    return _peak_MB(server), client


def _peak_MB(process: int | str) -> float:
    status = Path(f"/proc/{process}/status").read_text()
    return int(status.partition("VmHWM:")[2].split()[0]) / 1024


def _body(count: int) -> Iterator[bytes]:
    for start in range(0, count, LINES_AT_ONCE):
        yield b"".join(_line(number) for number in range(start, min(start + LINES_AT_ONCE, count)))


def _line(number: int) -> bytes:
    phases = [
        {"torque_Nm": 20 + number % 400 / 10, "speed_rpm": 250, "duration_s": 0.3},
        {"torque_Nm": 32, "speed_rpm": 500, "duration_s": 3.0},
        {"torque_Nm": 20, "speed_rpm": 250, "duration_s": 0.4},
    ]
    application = {"reference": f"axis-{number}", "duty_cycle": {"phases": phases, "pause_s": 4.0}}
    return json.dumps(application).encode() + b"\n"


def _client(port: int, count: int, certificate: str | None = None) -> float:
    """Send, then read line by line; its own peak in the end."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=120)
    if certificate is not None:
        trust = ssl.create_default_context(cafile=certificate)
        connection = http.client.HTTPSConnection("localhost", port, timeout=120, context=trust)
    connection.request("POST", "/api/v1/select/batch", _body(count), {"Content-Type": "application/x-ndjson"})
    answered = 0
    for answer in connection.getresponse():
        if json.loads(answer)["reference"] != f"axis-{answered}":
            raise RuntimeError(f"out of order: {answer!r}")
        answered += 1
    connection.close()
    if answered != count:
        raise RuntimeError(f"{answered} of {count} lines are answered")
    return _peak_MB("self")


if __name__ == "__main__":
    print(_client(int(sys.argv[1]), int(sys.argv[2]), *sys.argv[3:]))

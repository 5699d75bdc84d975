"""Request bodies, each with a torque of its own, so that no cache could answer."""

import json
from typing import Any

FIVE: dict[str, Any] = {"requirements": {"ratios": [5]}}
EVERY: dict[str, Any] = {}
CASES = {"5_gears": FIVE, "64_gears": EVERY}
"""Restrictions of the list of candidates, by the name of the case."""


def select_body(number: int, restriction: dict[str, Any]) -> bytes:
    """Worked example with a torque of its own."""
    phases = [_phase(40 + number * 1e-3, 250, 0.3), _phase(32, 500, 3.0), _phase(20, 250, 0.4)]
    cycle = {"phases": phases, "pause_s": 4.0}
    return json.dumps({"duty_cycle": cycle, "emergency_stop": {"torque_Nm": 200}} | restriction).encode()


def save_body(number: int, restriction: dict[str, Any]) -> bytes:
    """Worked example as a request to save."""
    return b'{"application":' + select_body(number, restriction) + b"}"


def axis(number: int, phases: int) -> dict[str, Any]:
    """Axis of a batch."""
    cycle = [_phase(20 + (number + step) % 400 / 10, 100.0 + 20 * step, 0.3 + step / 10) for step in range(phases)]
    return {"reference": f"axis-{number}", "duty_cycle": {"phases": cycle, "pause_s": 4.0}}


def _phase(torque_Nm: float, speed_rpm: float, duration_s: float) -> dict[str, float]:
    return {"torque_Nm": torque_Nm, "speed_rpm": speed_rpm, "duration_s": duration_s}

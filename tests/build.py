"""Short ways to write an application and to read a reply in a test."""

from typing import Any

from hpn.application import Application
from hpn.catalogue import Catalogue
from tests.reference.handbook import WORKED_EXAMPLE
from tests.wire import select

Json = dict[str, Any]

TURNING: Json = {
    "mechanism": {
        "type": "rotary",
        "inertia_kgm2": 0.8,
        "gravity_mass_kg": 12.0,
        "gravity_radius_mm": 250.0,
        "friction_torque_Nm": 1.5,
        "efficiency": 0.9,
    },
    "start_deg": 0.0,
    "moves": [
        {"profile": "trapezoidal", "angle_deg": 90.0, "time_s": 0.8, "acceleration_deg_per_s2": 900.0, "name": "turn"},
        {"profile": "dwell", "time_s": 0.4, "external_torque_Nm": 30.0},
        {"profile": "s_curve", "angle_deg": -90.0, "time_s": 1.0, "speed_rpm": 25.0, "jerk_share": 0.5},
    ],
}
LIFTING: Json = {
    "mechanism": {
        "type": "ball_screw",
        "mass_kg": 80.0,
        "lead_mm": 10.0,
        "incline_deg": 30.0,
        "inertia_kgm2": 0.002,
        "friction_force_N": 24.5,
        "friction_torque_Nm": 0.8,
        "counterweight_kg": 30.0,
    },
    "moves": [
        {"profile": "modified_sine", "distance_mm": 500.0, "time_s": 1.2, "external_force_N": 200.0},
        {"profile": "triangular", "distance_mm": -500.0, "speed_mm_per_s": 800.0},
        {"profile": "s_curve", "distance_mm": 200.0, "time_s": 1.0, "jerk_mm_per_s3": 20000.0},
    ],
}
"""Motions of a rotary and of a linear mechanism."""


def phase(torque_Nm: float, speed_rpm: float, duration_s: float = 1.0, **loads: float) -> Json:
    """One phase as JSON."""
    return {"torque_Nm": torque_Nm, "speed_rpm": speed_rpm, "duration_s": duration_s, **loads}


def cycle(*phases: Json, pause_s: float = 0.0, **parts: Any) -> Json:
    """An application as JSON: phases, pause, and any other part by its name."""
    return {"duty_cycle": {"phases": list(phases), "pause_s": pause_s}, **parts}


def worked_example(**parts: Any) -> Json:
    """The worked example of chapter 4.1 as JSON, from the tests' own transcription, for all sizes and ratios."""
    phases = [phase(T, n, t) for T, n, t in WORKED_EXAMPLE["phases"]]
    stop = {"torque_Nm": WORKED_EXAMPLE["momentary_peak_torque_nm"]}
    return cycle(*phases, pause_s=WORKED_EXAMPLE["pause_s"]) | {"emergency_stop": stop} | parts


def answer(application: Json, catalogue: Catalogue) -> Json:
    """The reply of the selection as JSON."""
    return select(Application.model_validate(application), catalogue).reply("/")


def candidate(reply: Json, designation: str) -> Json:
    """One candidate of a reply."""
    return next(entry for entry in reply["candidates"] if entry["designation"] == designation)


def check(reply: Json, designation: str, code: str) -> Json:
    """One check of one candidate of a reply."""
    return next(entry for entry in candidate(reply, designation)["checks"] if entry["code"] == code)


def suitable(reply: Json) -> set[str]:
    """Designations of the suitable candidates of a reply."""
    return {entry["designation"] for entry in reply["candidates"] if entry["status"] == "suitable"}


def notices(reply: Json) -> dict[str, str]:
    """Texts of a reply's notices by code."""
    return {notice["code"]: notice["text"] for notice in reply["notices"]}

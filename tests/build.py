"""Short ways to write an application and to read a reply in a test."""

from typing import Any

from hpn.application import Application
from hpn.catalogue import Catalogue
from tests.reference.handbook import WORKED_EXAMPLE
from tests.wire import select

Json = dict[str, Any]


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

"""The upload of machines as its form uses it."""

import re
from typing import Any

from starlette.testclient import TestClient

GERMAN = """Maschine 7;;;;;
Achse;Nr.;Drehmoment [Nm];Drehzahl [1/min];Dauer [ms];Lebensdauer Getriebe [h]
Hub Ä;1;12,5;250;300;20000
;2;8;500;2000,5;
Band;1;9000;100;500;
Greifer;1;abc;100;500;
"""
HUB = {
    "duty_cycle": {
        "phases": [
            {"torque_Nm": 12.5, "speed_rpm": 250, "duration_s": 0.3},
            {"torque_Nm": 8, "speed_rpm": 500, "duration_s": 2.0005},
        ]
    },
    "requirements": {"life_h": 20000},
}
HEAVY = {"duty_cycle": {"phases": [{"torque_Nm": 9000, "speed_rpm": 100, "duration_s": 0.5}]}}


def post(client: TestClient, content: bytes = b"", fields: dict[str, str] | None = None) -> Any:
    """Answer to the form."""
    files = {"file": ("axes", content)} if content else {"file": ("", b"")}
    return client.post("/machines", data=fields or {}, files=files)


def fields_of(page: str) -> dict[str, str]:
    """Fields that a form would send as it stands: hidden fields, and choices that are made."""
    fields = dict(re.findall(r'<input type="hidden" name="(\w+)" value="([^"]*)"', page))
    for name, options in re.findall(r'<select name="(\w+)"[^>]*>(.*?)</select>', page, re.DOTALL):
        chosen = re.search(r'value="([^"]*)" selected', options)
        fields[name] = chosen[1] if chosen else ""
    return fields | dict(re.findall(r'<input type="radio"\s+name="(\w+)"\s+id="[^"]*"\s+value="([^"]*)" checked', page))

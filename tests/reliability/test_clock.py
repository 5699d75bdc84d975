"""A clock that jumps, forth and back: ids, list and cursors stay right, and no limit of time notices."""

import time
from pathlib import Path

from tests.build import worked_example
from tests.operations.service import Service, serving

CLOCK = """
import datetime, os, time

real, real_time = datetime.datetime, time.time

def offset():
    with open(os.environ["JUMPING_CLOCK"]) as file:
        return float(file.read())

class Kind(type(real)):
    def __instancecheck__(cls, value):
        return isinstance(value, real)

class Jumping(real, metaclass=Kind):
    @classmethod
    def now(cls, tz=None):
        return real.now(tz) + datetime.timedelta(seconds=offset())

time.time, datetime.datetime = lambda: real_time() + offset(), Jumping
"""
"""Moves a process's clock by what stands in a file; as a machine's clock, the monotonic one stays."""

DAY_S = 86_400
JUMPS = (3650 * DAY_S, -30 * DAY_S, 0, -10_000 * DAY_S, 3600)
PART = 3
"""Selections on a page of the list."""


def save(service: Service, number: int) -> str:
    """Id of a saved selection; a retry with the same key, after whatever jump, is the same."""
    body = {"application": worked_example(), "title": f"axis {number}"}
    headers = {"Idempotency-Key": f"key-{number}"}
    saved = service.client.post("/api/v1/selections", json=body, headers=headers)
    assert saved.status_code == 201, saved.text
    return str(saved.json()["id"])


def listed(service: Service) -> list[tuple[str, str]]:
    """Time and id of everything that the list shows, part by part."""
    lines, address = [], f"/api/v1/selections?limit={PART}"
    while True:
        part = service.client.get(address).raise_for_status()
        lines += [(line["created"], line["id"]) for line in part.json()["selections"]]
        if "next" not in part.links:
            return lines
        address = part.links["next"]["url"]


def test_a_clock_that_jumps_loses_nothing_and_moves_no_limit_of_time(tmp_path: Path, soak: bool) -> None:
    (tmp_path / "sitecustomize.py").write_text(CLOCK, encoding="utf-8")
    turn(tmp_path, 0)
    environment = {
        "PYTHONPATH": str(tmp_path),
        "JUMPING_CLOCK": str(tmp_path / "clock"),
        "HPN_WRITING_RATE": "2000/hour",
    }
    acknowledged: dict[int, str] = {}
    with serving(tmp_path, environment) as service:
        for jump in JUMPS * (40 if soak else 1):
            left = remaining(service)
            turn(tmp_path, jump)
            for _ in range(PART):
                number = len(acknowledged)
                acknowledged[number] = save(service, number)
                assert save(service, number) == acknowledged[number]
            start = time.monotonic()
            assert service.client.get("/readyz").status_code == 200
            assert service.client.post("/api/v1/select", json=worked_example()).status_code == 200
            assert time.monotonic() - start < 30
            assert left - 2 * PART - 1 == remaining(service), "the count of the rate goes on as if nothing had happened"
        lines = listed(service)

    ids = [id for _, id in lines]
    print(f"\nclock jumps: acknowledged {len(acknowledged)}, found {len(set(ids) & set(acknowledged.values()))}")
    assert sorted(ids) == sorted(acknowledged.values())
    assert lines == sorted(lines, reverse=True)
    assert len({created[:4] for created, _ in lines}) >= 3, "the clock did not jump"


def turn(folder: Path, seconds: int) -> None:
    """Have the clock go so much ahead, or behind."""
    (folder / "new").write_text(str(seconds), encoding="utf-8")
    (folder / "new").replace(folder / "clock")


def remaining(service: Service) -> int:
    """Savings left of the rate; deleting a selection that does not exist counts as one."""
    headers = service.client.delete(f"/api/v1/selections/{'a' * 22}").headers
    return int(headers["RateLimit"].partition("r=")[2].partition(";")[0])

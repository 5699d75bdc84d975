"""A clock that jumps, forth and back: ids, list and cursors stay right, and no limit of time notices."""

import time
from pathlib import Path

import pytest

from tests.build import worked_example
from tests.operations.service import Service, serving

LIBRARY = next(
    (path for folder in ("lib*", "lib/*") for path in Path("/usr").glob(f"{folder}/faketime/libfaketime.so.1")), None
)
JUMPS = ("+10y", "-30d", "+0", "-40y", "+1h")
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


@pytest.mark.skipif(LIBRARY is None, reason="needs libfaketime, which `make test` installs on Debian")
def test_a_clock_that_jumps_loses_nothing_and_moves_no_limit_of_time(tmp_path: Path, soak: bool) -> None:
    clock = tmp_path / "clock"
    clock.write_text("+0", encoding="utf-8")
    environment = {
        "LD_PRELOAD": str(LIBRARY),
        "FAKETIME_TIMESTAMP_FILE": str(clock),
        "FAKETIME_NO_CACHE": "1",
        "FAKETIME_DONT_FAKE_MONOTONIC": "1",
        "HPN_WRITING_RATE": "2000/hour",
        "HPN_DATABASE_SECONDS": "60",
    }
    acknowledged: dict[int, str] = {}
    with serving(tmp_path, environment) as service:
        for jump in JUMPS * (40 if soak else 1):
            left = remaining(service)
            clock.write_text(jump, encoding="utf-8")
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


def remaining(service: Service) -> int:
    """How many savings are left of the rate; deleting what is not there counts as one."""
    headers = service.client.delete(f"/api/v1/selections/{'a' * 22}").headers
    return int(headers["RateLimit"].partition("r=")[2].partition(";")[0])

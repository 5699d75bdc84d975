"""Load: below capacity nothing fails; beyond it what is answered comes soon, and afterwards all is as before.

Long forms in `make soak`; how long the one below capacity lasts is `HPN_TEST_ENDURANCE_MINUTES`, by default 30.
"""

import os
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.build import cycle, phase, worked_example
from tests.operations.service import Service, serving
from tests.reliability.load import Outcome, load

MINUTES = float(os.environ.get("HPN_TEST_ENDURANCE_MINUTES", "30"))
RATIO = 5
"""How many times the unloaded median the slowest of a hundred answers may take, on a machine of its own."""

NOISE = 20
"""What other tests on the same two cores may add, as a factor: the short form finds a queue without end."""

SPELLS, SPELL_SECONDS = 60, 2
"""How often capacity is measured, and for how long; the slowest counts: a shared machine keeps up no more than that."""


@pytest.fixture
def quiet(tmp_path: Path) -> Iterator[Service]:
    """A service without rates, which logs no requests."""
    with serving(tmp_path, {"HPN_LOG_LEVEL": "warning", "HPN_CALCULATOR_RATE": "off", "HPN_BATCH_RATE": "off"}) as one:
        yield one


def capacity(service: Service, seconds: float) -> float:
    """Small calculations in a second."""
    found = load(service.port, 0, seconds)
    assert found.others == 0
    return found.answered / found.seconds


def memory_MB(service: Service) -> float:
    """Memory of the service."""
    status = Path(f"/proc/{service.process.pid}/status").read_text()
    return int(status.partition("VmRSS:")[2].split()[0]) / 1024


def test_at_four_times_capacity_answers_come_soon_and_the_rest_is_refused(
    quiet: Service, soak: bool, record_property: Callable[[str, object], None]
) -> None:
    most = capacity(quiet, 5 if soak else 1)
    unloaded = load(quiet.port, most / 10, 5 if soak else 1)
    load(quiet.port, 4 * most, 4 if soak else 3)  # it takes two seconds to tell an overload from a crowd
    loaded = load(quiet.port, 4 * most, 60 if soak else 1)
    back = load(quiet.port, most / 2, 4)  # it takes a second to tell that there is time for all again
    half = load(quiet.port, most / 2, 5 if soak else 1)
    time.sleep(2)
    after = load(quiet.port, most / 10, 5 if soak else 1)
    for name, found in {"unloaded": unloaded, "loaded": loaded, "back": back, "half": half, "after": after}.items():
        record_property(name, repr(found))  # a worker of pytest sends plain values alone
        print(f"{name}: {found}")

    assert unloaded.refused == after.refused == 0
    assert half.refused == 0 or not soak  # beside other tests half of capacity may be more than the service gets
    assert unloaded.others == loaded.others == back.others == half.others == after.others == 0
    assert loaded.answered
    assert loaded.p99 < unloaded.p50 * RATIO * (1 if soak else NOISE)
    assert after.p50 < unloaded.p50 * 2 * (1 if soak else NOISE)


def test_exports_and_batches_leave_room_for_small_calculations(quiet: Service, soak: bool) -> None:
    """Two callers' worth of each keep the workers busy; what they are refused is a 503, and small ones are answered."""
    enough = threading.Event()
    statuses: list[int] = []
    batch = {"applications": [worked_example()] * 300}
    long = cycle(*[phase(40 + k % 7, 250) for k in range(1000)])

    def ask(path: str, body: Any) -> None:
        with httpx.Client(base_url=quiet.url, timeout=120, trust_env=False) as client:
            while not enough.is_set():
                statuses.append(client.post(path, json=body).status_code)

    kinds = [("/api/v1/report.pdf", long), ("/api/v1/report.xlsx", long), ("/api/v1/select/batch", batch)]
    threads = [threading.Thread(target=ask, args=kind) for kind in kinds * (8 if soak else 2)]
    for thread in threads:
        thread.start()
    small = load(quiet.port, 20, 60 if soak else 2)
    enough.set()
    for thread in threads:
        thread.join()
    print(small, {status: statuses.count(status) for status in set(statuses)})

    assert small.others == small.refused == 0
    assert set(statuses) <= {200, 503}
    assert 200 in statuses


@pytest.mark.soak
def test_half_an_hour_at_four_fifths_of_capacity_without_an_error_and_in_flat_memory(
    quiet: Service, record_property: Callable[[str, object], None]
) -> None:
    rate = 0.8 * min(capacity(quiet, SPELL_SECONDS) for _ in range(SPELLS))
    memory, outcomes = [], list[Outcome]()
    print(f"{rate:.0f} requests a second")
    for _ in range(max(round(MINUTES), 1)):
        outcomes.append(load(quiet.port, rate, min(60, 60 * MINUTES)))
        memory.append(memory_MB(quiet))
        print(f"{memory[-1]:.1f} MB, {outcomes[-1]}", flush=True)
    record_property("rate", rate)
    record_property("memory_MB", memory)

    assert sum(outcome.refused + outcome.others for outcome in outcomes) == 0
    assert sum(outcome.answered for outcome in outcomes) > 0.95 * rate * 60 * MINUTES
    settled = memory[len(memory) // 5 :]
    assert max(settled) - settled[0] < 10

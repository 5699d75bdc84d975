"""Load behind nginx: below capacity nothing fails; beyond it what is answered comes soon, and then all is as before.

Long forms in `make soak`; how long the one below capacity lasts is `HPN_TEST_ENDURANCE_MINUTES`, by default 30.
"""

import os
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.build import cycle, phase, worked_example
from tests.operations.proxy import Proxy, proxied
from tests.operations.service import Service, serving
from tests.reliability.load import Outcome, load

MINUTES = float(os.environ.get("HPN_TEST_ENDURANCE_MINUTES", "30"))
RATIO = 40
"""How many times the unloaded median the slowest of a hundred answers may take, on a machine of its own: as many as may
wait for each other make it, and not how many ask.
"""

NOISE = 20
"""Factor for other tests on the same two cores: the short form finds a queue without end."""

SPELLS, SPELL_SECONDS = 60, 2
"""How often capacity is measured, and for how long; the slowest counts: a shared machine keeps up no more than that."""


@dataclass(frozen=True)
class Front:
    """A service, and nginx before it."""

    service: Service
    proxy: Proxy


@pytest.fixture
def quiet(tmp_path: Path) -> Iterator[Front]:
    """A service that logs no requests, behind nginx."""
    settings = {"HPN_LOG_LEVEL": "warning", "HPN_TRUSTED_PROXIES": "*"}
    with serving(tmp_path, settings) as service, proxied(service.port) as proxy:
        yield Front(service, proxy)


def capacity(front: Front, seconds: float) -> float:
    """Small calculations in a second."""
    result = load(front.proxy, 0, seconds)
    assert result.others == 0
    return result.answered / result.seconds


def memory_MB(service: Service) -> float:
    """Memory of the service."""
    status = Path(f"/proc/{service.process.pid}/status").read_text()
    return int(status.partition("VmRSS:")[2].split()[0]) / 1024


def test_beyond_capacity_answers_come_soon_and_the_rest_is_refused_at_once(
    quiet: Front, soak: bool, record_property: Callable[[str, object], None]
) -> None:
    most = min(capacity(quiet, SPELL_SECONDS if soak else 1) for _ in range(10 if soak else 1))
    seconds = 60 if soak else 1
    shares = {"unloaded": 0.1, "once": 1, "twice": 2, "four times": 4, "half": 0.5}
    by_name = {name: load(quiet.proxy, share * most, seconds) for name, share in shares.items()}
    for name, outcome in by_name.items():
        record_property(name, repr(outcome))  # a worker of pytest sends plain values alone
        print(f"{name}: {outcome.share_refused:.1%} refused, {outcome}")

    assert by_name["unloaded"].refused == 0
    assert by_name["once"].refused == by_name["half"].refused == 0 or not soak  # beside others it is more
    assert sum(outcome.others for outcome in by_name.values()) == 0
    for outcome in by_name.values():
        assert outcome.answered
        assert outcome.p99 < by_name["unloaded"].p50 * RATIO * (1 if soak else NOISE)


def test_exports_and_batches_leave_room_for_small_calculations(quiet: Front, soak: bool) -> None:
    """Two callers' worth of each keep the workers busy; what they are refused is a 503, and small ones are answered."""
    enough = threading.Event()
    statuses: list[int] = []
    batch = {"applications": [worked_example()] * 300}
    long = cycle(*[phase(40 + k % 7, 250) for k in range(1000)])

    def ask(path: str, body: Any) -> None:
        with httpx.Client(base_url=quiet.service.url, timeout=120, trust_env=False) as client:
            while not enough.is_set():
                statuses.append(client.post(path, json=body).status_code)

    kinds = [("/api/v1/report.pdf", long), ("/api/v1/report.xlsx", long), ("/api/v1/select/batch", batch)]
    threads = [threading.Thread(target=ask, args=kind) for kind in kinds * (8 if soak else 2)]
    for thread in threads:
        thread.start()
    small = load(quiet.proxy, 20, 60 if soak else 2)
    enough.set()
    for thread in threads:
        thread.join()
    print(small, {status: statuses.count(status) for status in set(statuses)})

    assert small.others == small.refused == 0
    assert set(statuses) <= {200, 503}
    assert 200 in statuses


@pytest.mark.soak
def test_half_an_hour_at_four_fifths_of_capacity_without_an_error_and_in_flat_memory(
    quiet: Front, record_property: Callable[[str, object], None]
) -> None:
    rate = 0.8 * min(capacity(quiet, SPELL_SECONDS) for _ in range(SPELLS))
    memory, outcomes = [], list[Outcome]()
    print(f"{rate:.0f} requests a second")
    for _ in range(max(round(MINUTES), 1)):
        outcomes.append(load(quiet.proxy, rate, min(60, 60 * MINUTES)))
        memory.append(memory_MB(quiet.service))
        print(f"{memory[-1]:.1f} MB, {outcomes[-1]}", flush=True)
    record_property("rate", rate)
    record_property("memory_MB", memory)

    assert sum(outcome.refused + outcome.others for outcome in outcomes) == 0
    assert sum(outcome.answered for outcome in outcomes) > 0.95 * rate * 60 * MINUTES
    settled = memory[len(memory) // 5 :]
    assert max(settled) - settled[0] < 10

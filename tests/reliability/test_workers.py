"""Workers that are killed, stopped or stuck: the others go on, new ones come, and nothing acknowledged is lost."""

import asyncio
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import orjson
import pytest

from hpn.catalogue import load_catalogue
from tests.operations.service import Service, serving
from tests.reliability.test_kill import Clients, read_back

WORKERS = 3
WORKER_SECONDS = 4
"""A busy machine needs some of it to start a process that answers."""

STUCK = "import signal, time; signal.signal(signal.SIGUSR1, lambda *_: time.sleep(3600))"
"""Has the event loop stand still at a signal, while other threads go on."""

RATINGS = "size,ratio,repeated_peak_torque_Nm,rated_torque_Nm,momentary_peak_torque_Nm,source\n"


def processes(service: Service) -> list[int]:
    """Workers that live, in the order of their start."""
    names = [event["event"] for event in service.events() if event["event"].startswith("Started server process")]
    return [number for name in names if alive(number := int(name.partition("[")[2].rstrip("]")))]


def alive(process: int) -> bool:
    """True for a process that runs; one that only waits for its parent's wait() has ended."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def started(service: Service, count: int) -> None:
    """Wait until so many workers have started since the beginning."""
    service.event(event="Application startup complete.", count=count)


@pytest.fixture
def surroundings(tmp_path: Path) -> dict[str, str]:
    """Environment of a service with several workers that can be brought to a standstill, and a supplement."""
    (tmp_path / "sitecustomize.py").write_text(STUCK, encoding="utf-8")
    supplement = tmp_path / "supplement"
    supplement.mkdir()
    (supplement / "ratings.csv").write_text(RATINGS + "20A,5,,82,,mine\n", encoding="utf-8")
    return {
        "PYTHONPATH": str(tmp_path),
        "HPN_CATALOGUE_SUPPLEMENT": str(supplement),
        "HPN_WORKERS": str(WORKERS),
        "HPN_WORKER_SECONDS": str(WORKER_SECONDS),
    }


@contextmanager
def saving(clients: Clients) -> Iterator[None]:
    """Clients save meanwhile."""
    threads = [threading.Thread(target=clients.run, daemon=True) for _ in range(2)]
    for thread in threads:
        thread.start()
    try:
        yield
    finally:
        clients.enough.set()
        for thread in threads:
            thread.join()


def assert_answers(service: Service) -> None:
    """It answers on new connections, whichever worker gets them."""
    for _ in range(10):
        assert httpx.get(f"{service.url}/healthz", trust_env=False, timeout=60).status_code == 200


def test_workers_killed_stopped_and_stuck_are_replaced_while_the_others_answer(
    tmp_path: Path, surroundings: dict[str, str], soak: bool
) -> None:
    turns = 10 if soak else 1
    with serving(tmp_path, surroundings) as service:
        started(service, WORKERS)
        clients = Clients(service.port, pause_s=0.05 if soak else 0.2)  # new workers need the processor to start
        with saving(clients):
            for turn in range(turns):
                killed, stopped, stuck = processes(service)[:WORKERS]
                os.kill(killed, signal.SIGKILL)
                assert_answers(service)
                started(service, WORKERS + 3 * turn + 1)
                os.kill(stopped, signal.SIGSTOP)
                os.kill(stuck, signal.SIGUSR1)
                assert_answers(service)
                assert alive(stopped) and alive(stuck), "they were to hold still meanwhile"
                started(service, WORKERS + 3 * turn + 3)
                assert not any(map(alive, (killed, stopped, stuck)))
        assert service.client.get("/readyz").status_code == 200
        assert "time.sleep(3600)" in service.event(level="error")["event"]  # the stuck one says where it stood

    catalogue = load_catalogue(supplement=tmp_path / "supplement")
    fault = f"{3 * turns} workers killed, stopped or stuck"
    asyncio.run(read_back(f"sqlite:///{tmp_path}/store.sqlite3", clients, catalogue, fault))
    assert {text[:3] for text in clients.unexpected} <= {"503"}, clients.unexpected[:3]
    assert len(clients.acknowledged) > 10


def test_a_worker_that_cannot_start_is_a_line_of_the_log(surroundings: dict[str, str]) -> None:
    file = Path(surroundings["HPN_CATALOGUE_SUPPLEMENT"], "ratings.csv")
    file.rename(file.with_name("Ratings.csv"))
    command = [sys.executable, "-c", "from hpn.web.serve import worker_app; worker_app()"]
    outcome = subprocess.run(command, env=os.environ | surroundings, capture_output=True, timeout=120)

    assert (outcome.returncode, outcome.stderr) == (1, b"")
    (line,) = outcome.stdout.splitlines()
    assert "Ratings.csv: is not a table of the catalogue" in orjson.loads(line)["event"]


@pytest.mark.soak
def test_a_worker_that_cannot_start_again_is_a_line_of_the_log_and_the_others_go_on(
    tmp_path: Path, surroundings: dict[str, str]
) -> None:
    with serving(tmp_path, surroundings | {"HPN_WORKERS": "2"}) as service:
        started(service, 2)
        file = tmp_path / "supplement" / "ratings.csv"
        file.rename(tmp_path / "away.csv")
        file.symlink_to("none.csv")
        os.kill(processes(service)[0], signal.SIGKILL)

        refusal = service.event(level="error")
        assert refusal["event"].endswith(f"{file}: is a link that leads nowhere")
        assert service.client.get("/healthz").status_code == 200
        assert "Traceback" not in service.log.read_text()
        (tmp_path / "away.csv").replace(file)
        started(service, 3)

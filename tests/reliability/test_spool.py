"""The folder for files on their way: gone, full, with strange things in it, or in use when the service ends."""

import errno
import os
import shutil
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.settings import Settings
from hpn.web.spool import CODES, TRIAL_SECONDS
from tests.operations.service import children_of, is_gone, serving, until
from tests.reliability.faults import assert_unavailable, full, small_disk

HEAD, AXIS = b"axis,torque_Nm,speed_rpm,duration_s\n", '%d,"[40,20,30]","[100,200,300]","[1,2,3]"\n'
CSV = {"Content-Type": "text/csv"}


@pytest.fixture
def spool(tmp_path: Path) -> Path:
    """An empty folder."""
    folder = tmp_path / "spool"
    folder.mkdir()
    return folder


@pytest.fixture
def client(spool: Path, tmp_path: Path) -> Iterator[TestClient]:
    """A service that keeps its files there."""
    settings = Settings(database_url=f"sqlite:///{tmp_path}/store.sqlite3", spool_folder=spool)
    with TestClient(create_app(settings), follow_redirects=False) as client:
        yield client


def table_of(axes: int) -> bytes:
    """A table of axes."""
    return HEAD + b"".join((AXIS % number).encode() for number in range(axes))


def answers_of(client: TestClient, axes: int = 1) -> tuple[Any, Any, Any]:
    """Answers of REST, the page and readiness."""
    return (
        client.post("/api/v1/fleet", content=table_of(axes), headers=CSV),
        client.post("/machines", files={"file": ("axes.csv", table_of(axes))}),
        client.get("/readyz"),
    )


def assert_refused_for_want_of(answers: tuple[Any, Any, Any], said: str) -> None:
    rest, page, ready = answers
    for answer in (rest, ready):
        assert_unavailable(answer)
        assert said in answer.json()["detail"] and "HPN_SPOOL_FOLDER" in answer.json()["detail"]
    assert page.status_code == 303  # what a page is given stands in no file


def test_a_folder_that_is_gone_is_said_and_used_again_once_it_is_back(client: TestClient, spool: Path) -> None:
    assert client.get("/readyz").json()["spool"] == "ok"
    shutil.rmtree(spool)
    time.sleep(TRIAL_SECONDS)

    assert_refused_for_want_of(answers_of(client), "is missing or not writable")

    spool.mkdir()
    time.sleep(TRIAL_SECONDS)
    assert [answer.status_code for answer in answers_of(client)] == [200, 303, 200]
    assert list(spool.iterdir()) == []


def test_a_full_disk_is_said_and_nothing_is_left_on_it(client: TestClient, spool: Path) -> None:
    with small_disk(spool):
        with full(spool):
            time.sleep(TRIAL_SECONDS)
            assert_refused_for_want_of(answers_of(client, 4000), "is full")
            assert [path.name for path in spool.iterdir()] == ["filler"]
        time.sleep(TRIAL_SECONDS)
        assert [answer.status_code for answer in answers_of(client)] == [200, 303, 200]


def test_a_disk_that_is_full_while_a_fleet_is_sized_is_said(client: TestClient, spool: Path) -> None:
    table = table_of(170_000)  # 8 of the 16 MB, as much again comes out
    with small_disk(spool):
        answer = client.post("/api/v1/fleet?give=candidates", content=table, headers=CSV)

        assert_unavailable(answer)
        assert "is full" in answer.json()["detail"]
        assert list(spool.iterdir()) == []


@pytest.mark.parametrize("make", [os.mkfifo, Path.touch, lambda path: path.symlink_to("/etc")])
def test_a_folder_that_is_not_ours_neither_holds_up_the_start_nor_is_touched(
    spool: Path, tmp_path: Path, make: Any
) -> None:
    make(spool / "hpn-fleet-x")
    (spool / "hpn-fleet-left").mkdir()
    (spool / "hpn-fleet-left" / "input.csv").touch()
    started = threading.Event()

    def start() -> None:
        settings = Settings(database_url=f"sqlite:///{tmp_path}/store.sqlite3", spool_folder=spool)
        with TestClient(create_app(settings)) as client:
            assert client.get("/healthz").status_code == 200
            started.set()

    threading.Thread(target=start, daemon=True).start()

    assert started.wait(30)
    assert [path.name for path in spool.iterdir()] == ["hpn-fleet-x"]


@pytest.mark.parametrize("workers", ["1", "2"])
def test_the_end_of_the_service_ends_fleets_and_removes_their_folders(
    spool: Path, tmp_path: Path, workers: str
) -> None:
    table = table_of(200_000)
    environment = {"HPN_SPOOL_FOLDER": str(spool), "HPN_SHUTDOWN_SECONDS": "1", "HPN_WORKERS": workers}
    answers: list[httpx.Response | httpx.HTTPError] = []
    with serving(tmp_path, environment) as service:

        def send() -> None:
            try:
                address = f"{service.url}/api/v1/fleet?give=candidates"
                answers.append(httpx.post(address, content=table, headers=CSV, timeout=120))
            except httpx.HTTPError as error:
                answers.append(error)

        sending = threading.Thread(target=send)
        sending.start()
        until(lambda: any(spool.rglob(".unfinished.*")))  # axes are sized
        every = _below(service.process.pid)
        service.terminate()
        service.process.wait(60)
        sending.join(60)

    assert list(spool.iterdir()) == []
    until(lambda: all(map(is_gone, every)))
    (answer,) = answers
    assert isinstance(answer, httpx.HTTPError) or answer.status_code == 503


def _below(process: int) -> list[int]:
    """Every process that it, or one of these, has started."""
    children = children_of(process)
    return [*children, *(further for child in children for further in _below(child))]


def test_codes_of_connections_are_none_of_the_disk() -> None:
    assert CODES.isdisjoint({errno.ECONNRESET, errno.EPIPE, errno.ETIMEDOUT, errno.EMFILE})

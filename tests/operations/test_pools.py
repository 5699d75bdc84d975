"""Pools of workers: bounded, and left by a client that leaves."""

import asyncio
import os
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack
from functools import partial
from inspect import iscoroutinefunction
from pathlib import Path
from typing import Any

import pytest
from fastapi.routing import iter_route_contexts
from starlette.requests import Request

from hpn.web.app import create_app
from hpn.web.door.beside import CallResult
from hpn.web.door.observation import CLIENT_CLOSED
from hpn.web.door.pools import Places, Pool, while_present
from hpn.web.door.problems import Problem
from hpn.web.settings import Settings
from tests.build import worked_example
from tests.operations.conftest import MakeClient
from tests.operations.service import children_of, is_gone
from tests.state import state_of


def test_all_places_are_taken_and_the_next_is_refused_until_one_is_given_back() -> None:
    pool = Pool(Places(1, 3))
    with ExitStack() as value_held:
        for _ in range(4):
            value_held.enter_context(pool.place())
        with pytest.raises(Problem) as refused, pool.place():
            pass

    assert refused.value.status_code == 503
    assert int((refused.value.headers or {})["Retry-After"]) > 0
    assert pool.in_use == 0


def request_of(*messages: str) -> Request:
    """A request whose body has been read, and of which this comes next."""
    coming = list(messages)

    async def receive() -> dict[str, Any]:
        if coming:
            return {"type": coming.pop(0)}
        await asyncio.Event().wait()
        raise AssertionError

    return Request({"type": "http"}, receive)


@pytest.mark.anyio
async def test_a_client_that_leaves_while_waiting_gives_up_the_place_and_nothing_is_computed() -> None:
    pool, busy = Pool(Places(1, 3)), threading.Event()
    outcome: list[int] = []
    first = asyncio.create_task(pool.run(busy.wait, 20))

    with pytest.raises(Problem) as left:
        await while_present(request_of("http.request", "http.disconnect"), pool.run(outcome.append, 1))
    await asyncio.sleep(0)  # the loop hears of it
    await asyncio.sleep(0)
    busy.set()
    await first
    await pool.run(outcome.append, 2)

    assert left.value.status_code == CLIENT_CLOSED
    assert outcome == [2]


@pytest.mark.anyio
async def test_work_in_slices_ends_when_its_client_leaves() -> None:
    pool = Pool(Places(1, 3))
    slices: list[int] = []

    async def work() -> None:
        for number in range(10_000):
            await pool.run(slices.append, number)
            await asyncio.sleep(0.001)

    with pytest.raises(Problem):
        await while_present(request_of("http.disconnect"), work())

    assert 0 < len(slices) < 10_000


@pytest.mark.anyio
async def test_a_client_that_stays_gets_the_result() -> None:
    assert await while_present(request_of(), Pool(Places(1, 0)).run(sum, [1, 2])) == 3


# --- Work in a process of its own -------------------------------------------------------------------------------------


@pytest.fixture
def pool() -> Iterator[Pool]:
    """A pool whose process ends with the test."""
    pool = Pool(Places(1, 3))
    yield pool
    pool.beside.close()


def beat(file: Path) -> None:
    """Tell the number of the process in a file that is there as a whole, and never end."""
    (new := file.with_suffix(".new")).write_text(str(os.getpid()))
    new.rename(file)
    while True:
        time.sleep(0.01)


def processes_beside() -> set[int]:
    """Processes beside this one that make or read files."""
    children = children_of(os.getpid())
    return {child for child in children if b"door.beside" in Path(f"/proc/{child}/cmdline").read_bytes()}


def fail_there() -> None:
    """Go wrong with what no answer can carry, and is no mere Exception, as typst's panics are."""
    raise BaseException(threading.Lock())


@pytest.mark.anyio
async def test_work_beside_is_killed_when_its_client_leaves_and_the_next_is_done(pool: Pool, tmp_path: Path) -> None:
    file, leaves = tmp_path / "beats", asyncio.Event()

    async def receive() -> dict[str, Any]:
        await leaves.wait()
        return {"type": "http.disconnect"}

    request = Request({"type": "http"}, receive)
    work = asyncio.create_task(while_present(request, pool.run_beside(partial(beat, file))))
    while not file.exists():
        await asyncio.sleep(0.01)
    leaves.set()
    with pytest.raises(Problem) as left:
        await work

    assert left.value.status_code == CLIENT_CLOSED
    assert await pool.run_beside(partial(sum, [1, 2])) == 3
    assert is_gone(int(file.read_text()))


@pytest.mark.anyio
@pytest.mark.parametrize("seconds", [0.0, 0.01, 0.05, 0.1, 0.2])
async def test_a_client_that_leaves_at_any_moment_of_the_start_leaves_no_process(pool: Pool, seconds: float) -> None:
    before = processes_beside()  # of services that other tests of this run have open
    for _ in range(3):
        work = asyncio.create_task(pool.run_beside(partial(time.sleep, 60)))
        await asyncio.sleep(seconds)
        work.cancel()
        with pytest.raises(asyncio.CancelledError):
            await work
    own = await pool.run_beside(os.getpid)

    assert processes_beside() - before == {own}


@pytest.mark.anyio
async def test_an_error_there_brings_its_traceback_and_an_early_end_is_a_503(
    pool: Pool, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = await pool.run_beside(os.getpid)

    with pytest.raises(RuntimeError, match="in fail_there"):
        await pool.run_beside(fail_there)
    assert await pool.run_beside(os.getpid) == first
    with pytest.raises(Problem) as ended:
        await pool.run_beside(partial(os._exit, 9))
    assert ended.value.status_code == 503
    assert int((ended.value.headers or {})["Retry-After"]) > 0
    assert caplog.messages[-1].endswith("exit code 9")  # and nothing of the work
    os.kill(second := await pool.run_beside(os.getpid), signal.SIGKILL)
    os.waitid(os.P_PID, second, os.WEXITED | os.WNOWAIT)  # its last thread has gone too, and the pool can see it
    assert await pool.run_beside(os.getpid) not in (first, second)

    pool.beside.close()
    monkeypatch.setattr(sys, "executable", "/nowhere/python")
    with pytest.raises(Problem) as unable:
        await pool.run_beside(os.getpid)
    assert unable.value.status_code == 503


@pytest.mark.anyio
async def test_a_service_that_ends_ends_work_beside_and_closes_nothing_that_is_read(
    pool: Pool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The answer is read late, so that a pipe closed at once would be found closed."""
    file, receive = tmp_path / "beats", CallResult.from_pipe

    def receive_late(pipe: Any) -> Any:
        while not file.exists():
            time.sleep(0.01)
        os.waitid(os.P_PID, int(file.read_text()), os.WEXITED | os.WNOWAIT)
        time.sleep(0.1)
        return receive(pipe)

    monkeypatch.setattr(CallResult, "from_pipe", receive_late)
    work = asyncio.create_task(pool.run_beside(partial(beat, file)))
    while not file.exists():
        await asyncio.sleep(0.01)
    pool.beside.close()

    with pytest.raises(Problem):
        await work
    assert is_gone(int(file.read_text()))


@pytest.mark.anyio
async def test_work_beside_knows_no_secrets_and_what_it_prints_is_no_answer(
    pool: Pool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HPN_DATABASE_PASSWORD", "secret")

    assert await pool.run_beside(partial(os.getenv, "HPN_DATABASE_PASSWORD")) is None
    await pool.run_beside(partial(print, "something"))
    assert await pool.run_beside(partial(os.system, "echo something")) == 0


# --- The pools of a service -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "path", "body"),
    [
        ("exports", "/api/v1/report.pdf", worked_example()),
        ("batches", "/api/v1/select/batch", {"applications": []}),
    ],
)
def test_a_full_pool_is_a_503_that_says_when_to_try_again(
    name: Any, path: str, body: Any, make_client: MakeClient
) -> None:
    client = make_client()
    pool: Pool = state_of(client).pools[name]
    with ExitStack() as stack:
        with pytest.raises(Problem):
            while True:
                stack.enter_context(pool.place())
        refused = client.post(path, json=body)
        small = client.post("/api/v1/select", json=worked_example())

    assert (refused.status_code, refused.headers["content-type"]) == (503, "application/problem+json")
    assert int(refused.headers["retry-after"]) > 0
    assert small.status_code == 200


def test_pages_beyond_what_nginx_lets_through_wait(make_client: MakeClient) -> None:
    client = make_client()
    pool: Pool = state_of(client).pools["pages"]
    with ExitStack() as stack:
        for _ in range(1000):
            stack.enter_context(pool.place())
        assert client.get("/").status_code == 200


def test_no_route_computes_in_the_frameworks_threads(tmp_path: Path) -> None:
    app = create_app(Settings(database_url=f"sqlite:///{tmp_path}/store.sqlite3"))

    plain = [route.path for route in iter_route_contexts(app.routes) if not iscoroutinefunction(route.endpoint)]

    assert plain == []

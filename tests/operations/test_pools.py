"""Pools of workers: bounded, half for one caller, and left by who leaves; and what a process holds at once."""

import asyncio
import json
import os
import pickle
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from inspect import iscoroutinefunction
from pathlib import Path
from typing import Any

import pytest
from fastapi.routing import iter_route_contexts
from starlette.requests import Request
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from hpn.web.app import create_app
from hpn.web.door import overload
from hpn.web.door.keys import new_key
from hpn.web.door.logs import make_logger
from hpn.web.door.metrics import Metrics
from hpn.web.door.observation import GONE
from hpn.web.door.overload import Budget
from hpn.web.door.pools import Places, Pool, while_present
from hpn.web.door.problems import Problem
from hpn.web.settings import Settings
from tests.build import worked_example
from tests.operations.conftest import MakeClient
from tests.operations.service import children_of, is_gone
from tests.state import state_of


@contextmanager
def holding(pool: Pool, *callers: str) -> Iterator[None]:
    """The pool with these places taken."""
    with ExitStack() as stack:
        for caller in callers:
            stack.enter_context(pool.place(caller))
        yield


def test_one_caller_takes_half_of_the_places_and_two_take_all() -> None:
    pool = Pool(Places(1, 3))
    with holding(pool, "one", "one"):
        with pytest.raises(Problem) as refused, pool.place("one"):
            pass
        with holding(pool, "two", "two"), pytest.raises(Problem), pool.place("three"):
            pass

    assert refused.value.status_code == 503
    assert int((refused.value.headers or {})["Retry-After"]) > 0
    assert pool.taken == 0


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
async def test_who_leaves_while_waiting_gives_up_the_place_and_nothing_is_computed() -> None:
    pool, busy = Pool(Places(1, 3)), threading.Event()
    done: list[int] = []
    first = asyncio.create_task(pool.run(busy.wait, 20))

    with pytest.raises(Problem) as left:
        await while_present(request_of("http.request", "http.disconnect"), pool.run(done.append, 1))
    await asyncio.sleep(0)  # the loop hears of it
    await asyncio.sleep(0)
    busy.set()
    await first
    await pool.run(done.append, 2)

    assert left.value.status_code == GONE
    assert done == [2]


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
async def test_who_stays_gets_the_result() -> None:
    assert await while_present(request_of(), Pool(Places(1, 0)).run(sum, [1, 2])) == 3


# --- Work in a process of its own -------------------------------------------------------------------------------------


@pytest.fixture
def pool() -> Iterator[Pool]:
    """A pool whose process ends with the test."""
    pool = Pool(Places(1, 3))
    yield pool
    pool.apart.close()


def beat(file: Path) -> None:
    """Tell the number of the process in a file that is there as a whole, and never end."""
    (new := file.with_suffix(".new")).write_text(str(os.getpid()))
    new.rename(file)
    while True:
        time.sleep(0.01)


def fail_there() -> None:
    """Go wrong with what no pickle can carry, and is no mere Exception, as typst's panics are."""
    raise BaseException(threading.Lock())


@pytest.mark.anyio
async def test_work_apart_is_killed_when_its_client_leaves_and_the_next_is_done(pool: Pool, tmp_path: Path) -> None:
    file, leaves = tmp_path / "beats", asyncio.Event()

    async def receive() -> dict[str, Any]:
        await leaves.wait()
        return {"type": "http.disconnect"}

    request = Request({"type": "http"}, receive)
    work = asyncio.create_task(while_present(request, pool.run_apart(partial(beat, file))))
    while not file.exists():
        await asyncio.sleep(0.01)
    leaves.set()
    with pytest.raises(Problem) as left:
        await work

    assert left.value.status_code == GONE
    assert await pool.run_apart(partial(sum, [1, 2])) == 3
    assert is_gone(int(file.read_text()))


@pytest.mark.anyio
@pytest.mark.parametrize("seconds", [0.0, 0.01, 0.05, 0.1, 0.2])
async def test_who_leaves_at_any_moment_of_the_start_leaves_no_process(pool: Pool, seconds: float) -> None:
    for _ in range(3):
        work = asyncio.create_task(pool.run_apart(partial(time.sleep, 60)))
        await asyncio.sleep(seconds)
        work.cancel()
        with pytest.raises(asyncio.CancelledError):
            await work
    own = await pool.run_apart(os.getpid)

    started = [child for child in children_of(os.getpid()) if b"apart" in Path(f"/proc/{child}/cmdline").read_bytes()]
    assert started == [own]


@pytest.mark.anyio
async def test_what_goes_wrong_apart_brings_its_traceback_and_what_ends_early_is_a_503(
    pool: Pool, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = await pool.run_apart(os.getpid)

    with pytest.raises(RuntimeError, match="in fail_there"):
        await pool.run_apart(fail_there)
    assert await pool.run_apart(os.getpid) == first
    with pytest.raises(Problem) as ended:
        await pool.run_apart(partial(os._exit, 9))
    assert ended.value.status_code == 503
    assert int((ended.value.headers or {})["Retry-After"]) > 0
    assert caplog.messages[-1].endswith("exit code 9")  # and nothing of the work
    os.kill(second := await pool.run_apart(os.getpid), signal.SIGKILL)
    while Path(f"/proc/{second}/stat").read_text().split()[2] != "Z":
        await asyncio.sleep(0.01)
    assert await pool.run_apart(os.getpid) not in (first, second)

    pool.apart.close()
    monkeypatch.setattr(sys, "executable", "/nowhere/python")
    with pytest.raises(Problem) as unable:
        await pool.run_apart(os.getpid)
    assert unable.value.status_code == 503


@pytest.mark.anyio
async def test_a_service_that_ends_ends_work_apart_and_closes_nothing_that_is_read(
    pool: Pool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The answer is read late, so that a pipe closed at once would be found closed."""
    file, load = tmp_path / "beats", pickle.load

    def load_late(pipe: Any) -> Any:
        while not file.exists():
            time.sleep(0.01)
        os.waitid(os.P_PID, int(file.read_text()), os.WEXITED | os.WNOWAIT)
        time.sleep(0.1)
        return load(pipe)

    monkeypatch.setattr(pickle, "load", load_late)
    work = asyncio.create_task(pool.run_apart(partial(beat, file)))
    while not file.exists():
        await asyncio.sleep(0.01)
    pool.apart.close()

    with pytest.raises(Problem):
        await work
    assert is_gone(int(file.read_text()))


@pytest.mark.anyio
async def test_work_apart_knows_no_secrets_and_what_it_prints_is_no_answer(
    pool: Pool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HPN_DATABASE_PASSWORD", "secret")

    assert await pool.run_apart(partial(os.getenv, "HPN_DATABASE_PASSWORD")) is None
    await pool.run_apart(partial(print, "something"))
    assert await pool.run_apart(partial(os.system, "echo something")) == 0


# --- The pools of a service -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "method", "path", "body"),
    [
        ("pages", "GET", "/", None),
        ("exports", "POST", "/api/v1/report.pdf", worked_example()),
        ("batches", "POST", "/api/v1/select/batch", {"applications": []}),
    ],
)
def test_a_full_pool_is_a_503_that_says_when_to_try_again(
    name: Any, method: str, path: str, body: Any, make_client: MakeClient
) -> None:
    (one, first), (two, second) = new_key("one"), new_key("two")
    client = make_client(api_keys=f"{first},{second}")
    pool: Pool = state_of(client).pools[name]
    with ExitStack() as stack:
        with pytest.raises(Problem):
            while True:
                stack.enter_context(pool.place("key one"))
        refused = client.request(method, path, json=body, headers={"X-API-Key": one})
        other = client.request(method, path, json=body, headers={"X-API-Key": two})
        small = client.post("/api/v1/select", json=worked_example(), headers={"X-API-Key": one})

    assert (refused.status_code, refused.headers["content-type"]) == (503, "application/problem+json")
    assert int(refused.headers["retry-after"]) > 0
    assert (other.status_code, small.status_code) == (200, 200)


def test_no_route_computes_in_the_frameworks_threads(tmp_path: Path) -> None:
    app = create_app(Settings(database_url=f"sqlite:///{tmp_path}/store.sqlite3"))

    plain = [route.path for route in iter_route_contexts(app.routes) if not iscoroutinefunction(route.endpoint)]

    assert plain == []


# --- Bytes in flight --------------------------------------------------------------------------------------------------


def test_beyond_the_bytes_in_flight_bodies_and_then_all_requests_are_refused(make_client: MakeClient) -> None:
    client = make_client(maximum_bytes_in_flight=1000)
    budget = state_of(client).budget

    large = client.post("/api/v1/select", content=b" " * 1001, headers={"Content-Type": "application/json"})
    assert (large.status_code, budget.held) == (503, 0)
    assert client.post("/api/v1/select", json=worked_example()).status_code == 200

    budget.held = 1000
    refused = client.get("/api/v1/catalogue")
    assert (refused.status_code, refused.headers["content-type"]) == (503, "application/problem+json")
    assert int(refused.headers["retry-after"]) > 0
    assert client.get("/healthz").status_code == 200


@pytest.mark.parametrize("path", ["/paste", "/fleets"])
def test_a_page_that_refuses_says_when_to_try_again_as_a_problem_does(path: str, make_client: MakeClient) -> None:
    client = make_client(maximum_bytes_in_flight=1000)

    page = client.post(path, files={"text": (None, "40 250 0.3\n" * 200)}, headers={"Accept": "text/html"})

    assert (page.status_code, page.headers["content-type"]) == (503, "text/html; charset=utf-8")
    assert int(page.headers["retry-after"]) > 0


def test_an_answer_counts_until_it_is_sent(make_client: MakeClient) -> None:
    client = make_client(maximum_bytes_in_flight=70_000)
    budget = state_of(client).budget

    with client.stream("GET", "/api/v1/catalogue", headers={"Accept-Encoding": "identity"}) as reply:
        assert len(reply.read()) > 70_000

    assert budget.held == 0


def test_a_batch_counts_with_what_it_makes(make_client: MakeClient) -> None:
    batch = {"applications": [worked_example()] * 10}
    size = len(json.dumps(batch, separators=(",", ":")).encode())

    assert make_client(maximum_bytes_in_flight=3 * size).post("/api/v1/select/batch", json=batch).status_code == 200
    assert make_client(maximum_bytes_in_flight=2 * size).post("/api/v1/select/batch", json=batch).status_code == 503


# --- Overload ---------------------------------------------------------------------------------------------------------


@pytest.mark.anyio
async def test_a_crowd_that_stays_is_an_overload_until_there_is_time_for_all(monkeypatch: pytest.MonkeyPatch) -> None:
    now = busy = 0.0
    monkeypatch.setattr(overload, "monotonic", lambda: now)

    async def answer(scope: Scope, receive: Receive, send: Send) -> None:
        nonlocal now, busy
        now, busy = now + busy, 0.0  # the first of a turn takes all of its time
        await _answer(scope, receive, send)

    app = overload.Overload(answer, Budget(1), Metrics(), make_logger("error"))

    async def window(*crowds: int, used: float) -> int:
        """Requests answered in a window of whose time the turns have used that share."""
        nonlocal now, busy
        answered = 0
        for count in crowds:
            busy = used * overload.WINDOW_SECONDS / len(crowds)
            now += overload.WINDOW_SECONDS / len(crowds) - busy
            answered += sum(await asyncio.gather(*(_asked(app) for _ in range(count))))
            await asyncio.sleep(0)
        return answered

    crowd, most = overload.CROWD, overload.QUEUE
    stall = (crowd + 1, *(1 for _ in range(crowd + 2)))

    assert [await window(crowd, used=1) for _ in range(5)] == [crowd] * 5, "a crowd is served"
    assert [await window(*stall, used=1) for _ in range(5)] == [sum(stall)] * 5, (
        "and what has come while all stood still"
    )
    assert [await window(n, used=1) for n in (3 * most, 1, 3 * most)] == [most, 1, most], "and much of a larger one"
    assert [await window(2 * crowd, used=1) for _ in range(5)] == [2 * crowd, 1, 1, 1, 1], "each turn answers the first"
    assert [await window(1, 3, used=0.5) for _ in range(5)] == [2] * 5, "idle, but for as many again it has no time"
    assert await window(1, 1, 1, 2, used=0.7) == 4, "in this window there was time for all"
    assert await window(most, used=1) == most, "so that it has ended"


async def _answer(scope: Scope, receive: Receive, send: Send) -> None:
    await Response().__call__(scope, receive, send)


async def _asked(app: ASGIApp) -> bool:
    """Whether a request is answered."""
    statuses = []

    async def send(message: Message) -> None:
        statuses.append(message.get("status"))

    async def receive() -> Message:
        return {"type": "http.request"}

    await asyncio.create_task(_call(app, receive, send))
    return statuses[0] == 200


async def _call(app: ASGIApp, receive: Receive, send: Send) -> None:
    await app({"type": "http", "method": "GET", "path": "/", "headers": []}, receive, send)

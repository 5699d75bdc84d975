"""One caller behind nginx takes no pool alone: whatever it asks at once, another is answered."""

import os
import signal
import socket
import subprocess
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import cache
from itertools import islice

import httpx
import orjson
import pytest

from tests.build import worked_example
from tests.fuzz.costly import made
from tests.operations.proxy import Proxy, proxied
from tests.operations.service import Service, serving, until

BATCH, FLEET, SMALL = "/api/v1/select/batch", "/api/v1/fleet", "/?T=40&n=250&t=1"
LINE = orjson.dumps({"reference": "axis", **worked_example(requirements={"ratios": [5]})}) + b"\n"
LINES, CSV = {"Content-Type": "application/x-ndjson"}, {"Content-Type": "text/csv"}
LONG = "/?" + "&".join(f"T={40 + k % 7}&n=250&t=0.3" for k in range(400))
ITEMS = orjson.dumps({"applications": [worked_example()] * 500})


def paste(client: httpx.Client, content: bytes, path: str = "/paste", name: str = "a.csv") -> httpx.Response:
    """Answer to a file that is sent from the page."""
    return client.post(path, files={"file": (name, content)}, headers={"Origin": str(client.base_url)})


def slow_lines(client: httpx.Client, enough: threading.Event) -> httpx.Response:
    """Answer to lines that come until it is enough."""

    def drip() -> Iterator[bytes]:
        while not enough.is_set():
            yield LINE
            time.sleep(0.2)

    return client.post(BATCH, content=drip(), headers=LINES)


@dataclass(frozen=True)
class Trial:
    """A pool: what the greedy caller asks again and again by each of its connections, and what another asks."""

    greedy: Callable[[httpx.Client, threading.Event], httpx.Response]
    other: Callable[[httpx.Client], httpx.Response]
    connections: int = 12


@cache
def fleet_of(axes: int) -> bytes:
    """A table of axes with one phase each."""
    rows = (b"a%d,40,250,1\n" % number for number in range(axes))
    return b"axis,torque_Nm,speed_rpm,duration_s\n" + b"".join(rows)


POOLS = {
    "pages": Trial(lambda client, _: client.get(LONG), lambda client: client.get(SMALL)),
    "batches": Trial(
        lambda client, _: client.post(BATCH, content=ITEMS, headers={"Content-Type": "application/json"}),
        lambda client: client.post(BATCH, json={"applications": [worked_example()]}),
    ),
    "lines": Trial(slow_lines, lambda client: client.post(BATCH, content=iter([LINE]), headers=LINES)),
    "files read": Trial(
        lambda client, _: paste(client, made("defined names"), name="a.xlsx"),
        lambda client: paste(client, b"T;n;t\n1;2;3\n"),
    ),
    "fleets": Trial(
        lambda client, _: client.post(FLEET, content=fleet_of(20_000), headers=CSV),
        lambda client: client.post(FLEET, content=fleet_of(1), headers=CSV),
    ),
    "files made": Trial(
        lambda client, _: client.get(f"/report.pdf{SMALL[1:]}"),
        lambda client: client.get("/report.xlsx?T=1&n=2&t=3"),
        connections=30,  # a score of them waits
    ),
    "metrics": Trial(lambda client, _: client.get("/metrics"), lambda client: client.get("/metrics")),
}
GREEDY, OTHER = "127.0.0.2", "127.0.0.3"


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """One process of the service, so that there is one pool of each kind."""
    settings = {"HPN_TRUSTED_PROXIES": "*", "HPN_LOG_LEVEL": "warning"}
    with serving(tmp_path_factory.mktemp("service"), settings) as running:
        yield running


@pytest.fixture(scope="module")
def proxy(service: Service) -> Iterator[Proxy]:
    """nginx before it, which believes one balancer."""
    with proxied(service.port, balancers="127.0.0.9", readers="127.0.0.0/8") as running:
        yield running


def caller(proxy: Proxy, address: str) -> httpx.Client:
    """A client from an address of loopback."""
    transport = httpx.HTTPTransport(verify=proxy.trust(), local_address=address)
    return httpx.Client(base_url=proxy.url, transport=transport, timeout=600)


@contextmanager
def greed(
    proxy: Proxy, trial: Trial, address: str, times: int = 1, enough: threading.Event | None = None
) -> Iterator[Counter[int]]:
    """Statuses of a caller that asks by all its connections, or times as many; entered once it is refused more.

    Greedy callers that share `enough` stop together.
    """
    enough, statuses = enough or threading.Event(), Counter[int]()

    def ask() -> None:
        with caller(proxy, address) as client:
            while not enough.is_set():
                try:
                    status = trial.greedy(client, enough).status_code
                except httpx.HTTPError:
                    status = 0
                statuses[status] += 1
                if status != 200:
                    enough.wait(0.2)  # as a program waits that tries again

    threads = [threading.Thread(target=ask) for _ in range(times * trial.connections)]
    for thread in threads:
        thread.start()
    try:
        until(lambda: statuses[429] >= 3)
        yield statuses
    finally:
        enough.set()
        for thread in threads:
            thread.join()


def answers(proxy: Proxy, trial: Trial, count: int) -> Counter[int]:
    """Statuses that another caller gets."""
    with caller(proxy, OTHER) as client:
        return Counter(trial.other(client).status_code for _ in range(count))


@pytest.mark.parametrize("name", POOLS)
def test_beside_a_caller_that_takes_all_it_may_another_is_answered(name: str, proxy: Proxy, soak: bool) -> None:
    count = 60 if soak else 3
    with greed(proxy, POOLS[name], GREEDY, 5 if soak else 1) as statuses:
        found = answers(proxy, POOLS[name], count)
    print(f"{name}: greedy {dict(statuses)}, other {dict(found)}")

    assert found == {200: count}
    assert set(statuses) <= {200, 422, 429}  # what is refused is its own share, and never the pool
    assert set(statuses) > {429}


def test_beside_greedy_callers_at_every_pool_another_is_answered_at_each(proxy: Proxy, soak: bool) -> None:
    count = 20 if soak else 1
    pools = POOLS if soak else {name: POOLS[name] for name in ("pages", "files read")}
    with ExitStack() as stack:
        enough = threading.Event()
        for number, trial in enumerate(pools.values()):
            stack.enter_context(greed(proxy, trial, f"127.0.1.{number + 1}", enough=enough))
        found = {name: answers(proxy, trial, count) for name, trial in pools.items()}
    print(found)

    assert found == {name: Counter({200: count}) for name in pools}


# --- Who one caller is ------------------------------------------------------------------------------------------------


@contextmanager
def paused(service: Service) -> Iterator[None]:
    """The service answers nobody meanwhile, so that what it is asked stays."""
    os.kill(service.process.pid, signal.SIGSTOP)
    try:
        yield
    finally:
        os.kill(service.process.pid, signal.SIGCONT)


def asked(proxy: Proxy, path: str, source: str, forwarded: str = "") -> socket.socket:
    """A connection that has asked for a page."""
    connection = proxy.connect(source=source)
    said = f"X-Forwarded-For: {forwarded}\r\n" if forwarded else ""
    connection.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\n{said}\r\n".encode())
    return connection


@pytest.mark.parametrize(
    ("number", "path", "most"),
    [(1, "/catalogue", 8), (2, "/machines/x", 2), (3, "/paste", 8), (4, "/metrics", 2), (5, "/static/none", 100)],
)
def test_one_address_has_so_many_at_once_and_another_its_own(
    number: int, path: str, most: int, proxy: Proxy, service: Service
) -> None:
    own = f"127.0.2.{number}"  # of which nothing that was asked before is left
    with ExitStack() as held:
        with paused(service):
            first = [held.enter_context(asked(proxy, path, own)) for _ in range(most)]
            until(lambda: refused(proxy, path, own))
            other = held.enter_context(asked(proxy, path, OTHER))
        statuses = {connection.recv(500)[9:12] for connection in [*first, other]}

    assert statuses <= {b"200", b"404"}


def refused(proxy: Proxy, path: str, source: str, forwarded: str = "") -> bool:
    """True where one more is refused at once."""
    with asked(proxy, path, source, forwarded) as connection:
        connection.settimeout(1)
        try:
            return connection.recv(500).startswith(b"HTTP/1.1 429 ")
        except TimeoutError:
            return False


@pytest.mark.parametrize(
    ("one", "same", "another"),
    [
        ("2001:db8:1:2::1", "2001:db8:1:2:ffff:a0a:a:d", "2001:db8:1:3::1"),
        ("2001:0:0:1:2:3:4:5", "2001:0:0:1::5", "2001:0:0:2:2:3:4:5"),  # whose shortest texts differ
        ("a0a:a0a:a0a:a0a::", "a0a:a0a:a0a:a0a:a0a:a0a:a0a:a0a", "a0a:a0a:a0a:a0b::"),  # bytes that are line ends
        ("::ffff:192.0.2.1", "192.0.2.1", "::ffff:192.0.2.2"),  # IPv4, as an IPv6 socket sees it
        ("192.0.2.10", "192.0.2.10", "192.0.2.11"),
    ],
)
def test_a_network_of_ipv6_is_one_caller(one: str, same: str, another: str, proxy: Proxy, service: Service) -> None:
    balancer = "127.0.0.9"
    with ExitStack() as held, paused(service):

        def is_full() -> bool:
            """True once both are refused; else some more requests of each are held."""
            if refused(proxy, "/catalogue", balancer, one) and refused(proxy, "/catalogue", balancer, same):
                return True
            for address in (one, same) * 3:
                held.enter_context(asked(proxy, "/catalogue", balancer, address))
            return False

        until(is_full)
        assert not refused(proxy, "/catalogue", balancer, another)


def test_streams_of_one_connection_count_each(proxy: Proxy, service: Service) -> None:
    command = f"curl --no-progress-meter --noproxy * --cacert {proxy.folder}/fullchain.pem --interface 127.0.0.8"
    written = ["--output", "/dev/null", "--write-out", "%{stderr}%{http_version} %{http_code}\n"]  # at once
    addresses = [word for number in range(12) for word in (*written, f"{proxy.url}/catalogue?{number}")]
    with subprocess.Popen([*command.split(), "--http2", "--parallel", *addresses], stderr=subprocess.PIPE) as curl:
        assert curl.stderr
        with paused(service):
            early = list(islice(curl.stderr, 4))
        late = list(curl.stderr)

    assert early == [b"2 429\n"] * 4
    assert late == [b"2 200\n"] * 8


def begun(proxy: Proxy, path: str, kind: str, length: int) -> socket.socket:
    """A connection whose request is counted and whose body is to come: nginx has asked for it."""
    head = f"POST {path} HTTP/1.1\r\nHost: localhost\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\n"
    connection = proxy.connect(source=GREEDY)
    connection.sendall(f"{head}Expect: 100-continue\r\n\r\n".encode())
    assert connection.recv(500).startswith(b"HTTP/1.1 100 ")
    return connection


@pytest.mark.parametrize(
    ("path", "kind", "most"),
    [
        ("/api/v1/select", "application/json", 8),
        (BATCH, "application/json", 3),
        (BATCH, "application/x-ndjson", 1),
        (FLEET, "text/csv", 2),
        ("/paste", "multipart/form-data; boundary=a", 2),
        ("/machines", "multipart/form-data; boundary=a", 2),
        ("/api/v1/report.pdf", "application/json", 4),
    ],
)
def test_bodies_that_are_still_to_come_count(path: str, kind: str, most: int, proxy: Proxy) -> None:
    until(lambda: not refused(proxy, "/machines/x", GREEDY))  # what tests before have left
    with ExitStack() as held:
        for _ in range(most):
            held.enter_context(begun(proxy, path, kind, 1_000_000))
        head = f"POST {path} HTTP/1.1\r\nHost: localhost\r\nContent-Type: {kind}\r\nContent-Length: 2\r\n\r\n{{}}"
        answers = []
        for source in (GREEDY, OTHER):
            connection = held.enter_context(proxy.connect(source=source))
            connection.sendall(head.encode())
            answers.append(int(connection.recv(500)[9:12]))
        assert not refused(proxy, "/healthz", GREEDY)

    assert answers[0] == 429
    assert answers[1] in (200, 403, 422)

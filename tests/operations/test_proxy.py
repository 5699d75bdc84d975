"""nginx as docker-compose.yml puts it in front: TLS, headers, sizes, and what it passes on."""

import os
import re
import signal
import subprocess
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from typing import Any

import httpx
import orjson
import pytest

from tests.build import worked_example
from tests.operations.proxy import Proxy, proxied
from tests.operations.service import Service, serving

BATCH, FLEET = "/api/v1/select/batch", "/api/v1/fleet"
LINES = {"Content-Type": "application/x-ndjson"}
LINE = orjson.dumps({"reference": "axis", **worked_example(requirements={"ratios": [5]})}) + b"\n"


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service with the settings of the compose file."""
    with serving(tmp_path_factory.mktemp("service"), {"HPN_TRUSTED_PROXIES": "*"}) as running:
        yield running


@pytest.fixture(scope="module")
def proxy(service: Service) -> Iterator[Proxy]:
    """nginx before it."""
    with proxied(service.port) as running:
        yield running


@pytest.fixture(scope="module")
def client(proxy: Proxy) -> Iterator[httpx.Client]:
    """A client that comes through nginx."""
    with httpx.Client(base_url=proxy.url, verify=proxy.trust(), timeout=60, trust_env=False) as client:
        yield client


def test_a_calculation_comes_through_and_says_that_it_wants_tls(client: httpx.Client) -> None:
    answer = client.post("/api/v1/select", json=worked_example(requirements={"ratios": [5]}))

    assert answer.json()["selected"] == "HPN-20A-5"
    assert answer.headers["Strict-Transport-Security"] == "max-age=31536000"
    assert answer.headers["X-Content-Type-Options"] == "nosniff"
    assert "nginx/" not in answer.headers["Server"]


def test_it_starts_without_a_warning_whichever_version_it_is(proxy: Proxy) -> None:
    log = (proxy.folder / "log").read_text()

    assert [line for line in log.splitlines() if not line.startswith("{")] == []


def test_a_fleet_of_some_megabytes_comes_through_and_one_that_is_too_large_does_not(
    client: httpx.Client, proxy: Proxy
) -> None:
    passed = client.post(FLEET, content=b"x" * 3_000_000, headers={"Content-Type": "text/csv"})
    with proxy.connect() as connection:
        connection.sendall(b"POST %s HTTP/1.1\r\nHost: localhost\r\nContent-Length: 200000001\r\n\r\n" % FLEET.encode())
        refused = connection.recv(65536)

    assert (passed.status_code, passed.json()["detail"]) == (422, "input: column axis is missing")
    assert b" 413 " in refused.partition(b"\r\n")[0]


def test_http_2_is_spoken(proxy: Proxy) -> None:
    assert curl(proxy, "/healthz", "--http2").startswith(b"HTTP/2 200")


def curl(proxy: Proxy, path: str, *options: str, body: bytes = b"") -> bytes:
    """Head and body of an answer."""
    command = ["curl", "--silent", "--include", "--noproxy", "*", "--cacert", f"{proxy.folder}/fullchain.pem"]
    return subprocess.run([*command, *options, f"{proxy.url}{path}"], input=body, capture_output=True).stdout


def test_the_service_learns_the_callers_address_host_and_id(proxy: Proxy, service: Service) -> None:
    head = b"GET /catalogue HTTP/1.1\r\nHost: localhost:%d\r\n"
    message = b"X-Forwarded-For: 192.0.2.7\r\nX-Request-ID: through-nginx\r\nConnection: close\r\n\r\n"
    with proxy.connect(source="127.0.0.2") as connection:
        connection.sendall(head % proxy.https + message)
        answer = b"".join(iter(lambda: connection.recv(65536), b""))

    assert b"x-request-id: through-nginx" in answer.lower()
    assert b'rel="canonical" href="https://localhost:%d/catalogue"' % proxy.https in answer.partition(b"\r\n\r\n")[2]
    assert service.event(request_id="through-nginx")["client"] == "127.0.0.2"


def test_a_request_without_an_id_gets_one_for_both_logs(client: httpx.Client, proxy: Proxy, service: Service) -> None:
    id = client.get("/api/v1/catalogue").headers["X-Request-ID"]

    service.event(request_id=id)
    client.get("/healthz")  # over the same connection: the line is written before it is read
    assert [line["status"] for line in logged(proxy, id)] == [200]


def logged(proxy: Proxy, id: str) -> list[dict[str, Any]]:
    """Lines of the log about a request."""
    lines = [orjson.loads(line) for line in (proxy.folder / "log").read_bytes().splitlines() if b"proxied" in line]
    return [line for line in lines if line["request_id"] == id]


@pytest.mark.parametrize(
    ("path", "size", "status"),
    [
        ("/api/v1/select", 2_000_000, 400),  # what the service says of a body of blanks
        ("/api/v1/select", 2_000_001, 413),
        (BATCH, 2_000_001, 400),
        (BATCH, 32_000_001, 413),
    ],
)
def test_bodies_are_as_large_as_the_settings_say(path: str, size: int, status: int, client: httpx.Client) -> None:
    answer = client.post(path, content=b" " * size, headers={"Content-Type": "application/json"})

    assert answer.status_code == answer.json()["status"] == status
    assert answer.headers["Content-Type"] == "application/problem+json"


@pytest.mark.parametrize("protocol", ["--http1.1", "--http2"])
@pytest.mark.parametrize("size", [2_000_001, 40_000_000])
def test_a_body_of_unknown_length_that_is_too_large_is_refused_as_a_problem(
    protocol: str, size: int, proxy: Proxy
) -> None:
    headers = ["--header", "Content-Type: application/json", "--header", "Expect:"]
    answer = curl(proxy, "/api/v1/select", protocol, "--request", "POST", *headers, "-T", "-", body=b" " * size)

    assert b" 413" in answer.splitlines()[0]
    assert b"content-type: application/problem+json" in answer.lower()


@pytest.mark.parametrize("path", ["/machines", "/fleets"])
def test_a_table_on_the_page_may_be_as_large_as_the_service_takes_it(path: str, client: httpx.Client) -> None:
    rows = b"axis;T;n;t\n" + b"x;40;250;1\n" * 250_000
    answers = [
        client.post(
            path,
            files={"file": ("axes.csv", content, "text/csv")},
            headers={"Origin": str(client.base_url)},
            follow_redirects=True,
        )
        for content in (rows, rows * 13)
    ]

    assert [answer.status_code for answer in answers] == [422, 413]
    assert "text/html" in answers[0].headers["Content-Type"]
    assert answers[1].headers["Content-Type"] == "application/problem+json"


@pytest.mark.parametrize(
    ("path", "status"),
    [("/?T=" + "1" * 59_000, 422), ("/?T=" + "1" * 61_000, 414)],
)
def test_the_longest_link_comes_through_and_the_service_refuses_a_longer_one(
    path: str, status: int, client: httpx.Client
) -> None:
    assert client.get(path).status_code == status


def test_a_head_that_is_too_large_is_refused_as_a_problem(client: httpx.Client) -> None:
    answer = client.get("/", headers={"X-Long": "a" * 70_000})

    assert answer.status_code == answer.json()["status"] == 431
    assert answer.json()["title"] == "The head of the request is too large"
    assert answer.json()["detail"] == "send fewer or shorter headers"
    assert "Retry-After" not in answer.headers


@pytest.mark.parametrize("length", ["known", "unknown"])
def test_lines_may_be_more_than_a_batch_of_json_has(length: str, client: httpx.Client) -> None:
    blank = b" " * 1_000_000 + b"\n"
    content = blank * 33 + LINE if length == "known" else iter([*[blank] * 33, LINE])
    answer = client.post(BATCH, content=content, headers={"Content-Type": "application/x-ndjson; charset=utf-8"})

    assert answer.json()["selected"] == "HPN-20A-5"


def test_a_batch_of_lines_too_many_is_told_so(client: httpx.Client, proxy: Proxy) -> None:
    with proxy.connect() as connection:
        head = f"POST {BATCH} HTTP/1.1\r\nHost: localhost\r\nContent-Type: {LINES['Content-Type']}\r\n"
        connection.sendall(f"{head}Content-Length: 30000000\r\nExpect: 100-continue\r\n\r\n".encode())
        assert connection.recv(500).startswith(b"HTTP/1.1 100 ")
        answer = client.post(BATCH, content=LINE, headers=LINES)

    assert answer.headers["Content-Type"] == "application/problem+json"
    assert answer.status_code == answer.json()["status"] == 429
    assert answer.json()["detail"] == "this address has too many requests at once; try again in 1 s"
    assert answer.headers["Retry-After"] == "1"


def test_ten_people_who_open_the_page_at_once_get_all_of_it(proxy: Proxy) -> None:
    def opened(number: int) -> Counter[int]:
        """Statuses of the page and of what it asks for, six at once as a browser does."""
        source = httpx.HTTPTransport(verify=proxy.trust(), local_address=f"127.0.0.{10 + number}")
        with httpx.Client(base_url=proxy.url, transport=source, timeout=60) as browser, ThreadPoolExecutor(6) as six:
            page = browser.get("/")
            parts = re.findall(r'(?:href|src)="(/static/[^"]+)"', page.text)
            assert len(parts) >= 3
            return Counter(answer.status_code for answer in [page, *six.map(browser.get, parts)])

    with ThreadPoolExecutor(10) as people:
        statuses = sum(people.map(opened, range(10)), Counter[int]())

    assert set(statuses) == {200}


def test_more_than_the_service_does_in_time_is_refused_at_once_and_what_a_page_needs_is_not(
    service: Service, proxy: Proxy, client: httpx.Client
) -> None:
    style = re.findall(r'href="(/static/[^"]+)"', client.get("/").text)[0]
    os.kill(service.process.pid, signal.SIGSTOP)
    try:
        with ExitStack() as value_held:
            for number in range(32):
                connection = value_held.enter_context(proxy.connect(source=f"127.0.0.{2 + number % 4}"))
                connection.sendall(asked_for("/catalogue"))
            refused, *others = (value_held.enter_context(proxy.connect(source="127.0.0.6")) for _ in range(3))
            refused.sendall(asked_for("/catalogue"))
            answer = refused.recv(5000)
            for connection, path in zip(others, (style, "/healthz"), strict=True):
                connection.sendall(asked_for(path))
            os.kill(service.process.pid, signal.SIGCONT)
            assert [connection.recv(500)[9:12] for connection in others] == [b"200", b"200"]
    finally:
        os.kill(service.process.pid, signal.SIGCONT)

    assert answer.startswith(b"HTTP/1.1 503")
    assert b"too much to do" in answer
    assert b"Retry-After: 5" in answer


def test_files_for_a_crowd_on_one_address_are_made_a_few_at_a_time_and_others_come_between(proxy: Proxy) -> None:
    question = asked_for("/report.pdf?T=40&n=250&t=1")
    with ThreadPoolExecutor(31) as crowd:
        values = [crowd.submit(status_from, proxy, "127.0.0.2", question) for _ in range(30)]
        time.sleep(0.5)
        before = sum(file.done() and file.result() == 200 for file in values)
        assert status_from(proxy, "127.0.0.3", question) == 200
        meanwhile = sum(file.done() and file.result() == 200 for file in values) - before
        results = Counter(file.result() for file in values)

    assert set(results) <= {200, 429}
    assert results[200] >= 4
    assert meanwhile <= 8  # four that were there before; without, all thirty


def asked_for(path: str) -> bytes:
    """A request for a page."""
    return b"GET %s HTTP/1.1\r\nHost: localhost\r\n\r\n" % path.encode()


def status_from(proxy: Proxy, address: str, request: bytes = asked_for("/healthz")) -> int:
    """Status that a caller from an address of loopback gets."""
    with proxy.connect(source=address) as connection:
        connection.settimeout(60)
        connection.sendall(request)
        return int(connection.recv(500)[9:12])


@pytest.mark.parametrize("path", ["/", "/api/v1/catalogue", BATCH, "/static/x.css", "/report.pdf?T=1"])
def test_a_name_that_is_not_the_services_is_a_421_that_names_it_and_the_setting(path: str, proxy: Proxy) -> None:
    answers = [
        httpx.get(f"{proxy.url}{path}", headers={"Host": host}, verify=proxy.trust(), trust_env=False)
        for host in ("evil.example:8443", '"><b>')
    ]

    assert answers[0].status_code == answers[0].json()["status"] == 421
    assert answers[1].status_code == answers[1].json()["status"] in (421, 400)  # nginx 1.30 finds it malformed
    assert [answer.headers["Content-Type"] for answer in answers] == ["application/problem+json"] * 2
    assert "evil.example" in answers[0].json()["detail"]
    assert "HPN_ALLOWED_HOSTS" in answers[0].json()["detail"]


@pytest.mark.parametrize("path", ["/healthz", "/readyz"])
def test_load_balancers_ask_for_health_by_any_name(path: str, client: httpx.Client) -> None:
    assert client.get(path, headers={"Host": "10.1.2.3"}).status_code == 200


def test_behind_a_load_balancer_callers_are_who_it_says_and_nobody_else_is_believed(service: Service) -> None:
    with proxied(service.port, balancers="127.0.0.2, 127.0.0.9") as proxy:
        for source, id in (("127.0.0.2", "by-balancer"), ("127.0.0.3", "by-stranger")):
            message = f"X-Forwarded-For: 192.0.2.7\r\nX-Request-ID: {id}\r\n\r\n".encode()
            assert status_from(proxy, source, b"GET /catalogue HTTP/1.1\r\nHost: localhost\r\n" + message) == 200

    assert service.event(request_id="by-balancer")["client"] == "192.0.2.7"
    assert service.event(request_id="by-stranger")["client"] == "127.0.0.3"


def test_metrics_are_nowhere_but_for_the_addresses_that_are_named(service: Service, client: httpx.Client) -> None:
    closed = client.get("/metrics")

    assert (closed.status_code, closed.headers["Content-Type"]) == (404, "application/problem+json")
    assert closed.json()["type"] == "/problems/not-found"
    assert client.get("/metrics", headers={"X-Forwarded-For": "127.0.0.3"}).status_code == 404
    with proxied(service.port, readers="127.0.0.3, 10.0.0.0/8", balancers="127.0.0.9") as proxy:
        question = asked_for("/metrics")
        assert status_from(proxy, "127.0.0.3", question) == 200
        assert status_from(proxy, "127.0.0.2", question) == 404
        behind = b"GET /metrics HTTP/1.1\r\nHost: localhost\r\nX-Forwarded-For: %s\r\n\r\n"
        assert status_from(proxy, "127.0.0.9", behind % b"10.1.2.3") == 200
        assert status_from(proxy, "127.0.0.9", behind % b"192.0.2.7") == 404


def test_no_line_of_the_log_holds_what_was_asked(client: httpx.Client, proxy: Proxy) -> None:
    client.get("/", params={"T": "987654"})

    assert "987654" not in (proxy.folder / "log").read_text()

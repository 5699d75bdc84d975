"""nginx without the service behind it: what it answers, and what its log holds."""

import socket
from collections.abc import Iterator
from contextlib import ExitStack

import httpx
import pytest

from hpn.web.door.observation import SECURITY_HEADERS
from tests.operations.proxy import Proxy, proxied
from tests.operations.test_proxy import BATCH, FLEET, LINE, LINES, curl, logged


@pytest.fixture(scope="module")
def alone() -> Iterator[Proxy]:
    """nginx before a service that is down."""
    with proxied(9) as running:  # nobody listens on the port to discard
        yield running


def test_without_the_service_the_answer_says_to_come_again(alone: Proxy) -> None:
    answer = httpx.get(f"{alone.url}/", verify=alone.trust(), trust_env=False)

    assert answer.status_code == answer.json()["status"] == 503
    assert answer.json()["detail"] == "the service has too much to do or does not answer; try again in 5 s"
    assert answer.headers["Retry-After"] == "5"
    assert answer.headers["Strict-Transport-Security"] == "max-age=31536000"


@pytest.mark.parametrize(
    ("status", "method", "path", "headers"),
    [
        (404, "GET", "/.problem", {}),
        (404, "POST", "/.lines", {}),
        (404, "POST", "/paste%0a", {}),
        (405, "TRACE", "/", {}),
        (413, "POST", "/", {"Content-Type": "application/json"}),
        (421, "GET", "/", {"Host": "evil.example"}),
        (431, "GET", "/", {"X-Long": "a" * 70_000}),
        (503, "GET", "/", {}),
    ],
)
def test_a_refusal_of_nginxs_own_is_a_problem_with_the_headers_of_every_answer(
    status: int, method: str, path: str, headers: dict[str, str], alone: Proxy
) -> None:
    with httpx.Client(verify=alone.trust(), trust_env=False) as client:
        body = b" " * 2_000_001 if status == 413 else b""
        answer = client.request(method, f"{alone.url}{path}", headers=headers, content=body)

    assert answer.status_code == answer.json()["status"] == status
    assert answer.headers["Content-Type"] == "application/problem+json"
    assert answer.headers["Content-Security-Policy"].startswith("default-src 'none'; ")  # a problem loads nothing
    same = SECURITY_HEADERS.keys() - {"Content-Security-Policy"}
    assert {name: answer.headers[name] for name in same} == {name: SECURITY_HEADERS[name] for name in same}
    assert ("Strict-Transport-Security" in answer.headers) is (status != 421)  # of another's name it says nothing
    assert ("Allow" in answer.headers) is (status == 405)


@pytest.mark.parametrize("method", ["TRACE", "CONNECT"])
@pytest.mark.parametrize("protocol", ["--http1.1", "--http2"])
def test_methods_that_nginx_knows_for_none_of_its_own_are_a_problem(method: str, protocol: str, alone: Proxy) -> None:
    answer = curl(alone, "/api/v1/select", protocol, "--request", method).lower()

    assert answer.split()[1] in ((b"405",) if method == "TRACE" else (b"400", b"405"))  # older versions read no CONNECT
    assert b"content-type: application/problem+json" in answer
    assert b"<html" not in answer


@pytest.mark.parametrize(
    ("names", "host", "leads"),
    [
        ("localhost,127.0.0.1", "127.0.0.1:80", "127.0.0.1"),
        ("localhost,127.0.0.1", "evil.example", "localhost"),
        ("localhost,127.0.0.1", None, "localhost"),
        ("*.plm.example plm.example", "a.PLM.example.", "a.plm.example"),
        ("*.plm.example", "evilplm.example", "plm.example"),
        (f"localhost,{'a' * 60}.{'b' * 60}.example,localhost", "b.example", "localhost"),
        ("[2001:db8::1]", "[2001:db8::1]:80", "[2001:db8::1]"),
        ("[2001:db8::1]", "[2001:db8::2]:80", "[2001:db8::1]"),
    ],
)
def test_plain_http_leads_on_with_method_and_body_to_a_name_of_the_service_and_to_no_other(
    names: str, host: str | None, leads: str
) -> None:
    line = b"" if host is None else f"Host: {host}\r\n".encode()
    version = b"1.0" if host is None else b"1.1"
    with proxied(9, names=names) as proxy, socket.create_connection(("127.0.0.1", proxy.http), 20) as connection:
        connection.sendall(b"POST /api/v1/select?a=b HTTP/%s\r\n%sConnection: close\r\n\r\n" % (version, line))
        answer = b"".join(iter(lambda: connection.recv(65536), b""))
        log = (proxy.folder / "log").read_text()

    assert answer.startswith(b"HTTP/1.1 308 ")
    assert f"\r\nLocation: https://{leads}/api/v1/select?a=b\r\n".encode() in answer
    assert "[" not in log.partition("{")[0]  # no warning


def test_what_plain_http_is_refused_is_a_problem_too(alone: Proxy) -> None:
    with socket.create_connection(("127.0.0.1", alone.http), 20) as connection:
        connection.sendall(b"TRACE / HTTP/1.1\r\nHost: evil.example\r\nConnection: close\r\n\r\n")
        answer = b"".join(iter(lambda: connection.recv(65536), b""))

    assert answer.startswith(b"HTTP/1.1 405 ")
    assert b"application/problem+json" in answer
    assert b"evil.example" not in answer and b"Strict-Transport-Security" not in answer


def test_the_log_has_the_method_of_what_is_refused(alone: Proxy) -> None:
    with httpx.Client(base_url=alone.url, verify=alone.trust(), trust_env=False) as client:
        client.put("/", headers={"X-Request-ID": "refused"})
        client.get("/")  # over the same connection: the line is written before it is read

    assert [line["method"] for line in logged(alone, "refused")] == ["PUT"]


@pytest.mark.parametrize("protocol", ["--http1.1", "--http2"])
@pytest.mark.parametrize("path", ["/api/v1/select", BATCH, FLEET])
def test_without_the_service_a_long_body_is_told_the_same(protocol: str, path: str, alone: Proxy) -> None:
    headers = ["--header", "Content-Type: application/json", "--header", "Expect:"]
    answer = curl(alone, path, protocol, *headers, "--data-binary", "@-", body=b" " * 1_900_000)

    assert b" 503" in answer.splitlines()[0]
    assert b"content-type: application/problem+json" in answer.lower()


@pytest.mark.parametrize("content", [LINE, [LINE]], ids=["of known length", "in chunks"])
def test_without_the_service_a_batch_of_lines_is_told_the_same(content: bytes | list[bytes], alone: Proxy) -> None:
    address = f"{alone.url}{BATCH}"
    answer = httpx.post(address, content=content, headers=LINES, verify=alone.trust(), trust_env=False)

    assert answer.status_code == answer.json()["status"] == 503
    assert answer.headers["Content-Type"] == "application/problem+json"


def test_a_batch_of_lines_that_the_service_does_not_take_in_time_is_told_the_same() -> None:
    with ExitStack() as stack:
        busy = stack.enter_context(socket.create_server(("127.0.0.1", 0), backlog=0))
        stack.enter_context(socket.create_connection(busy.getsockname()))  # all that it lets wait
        proxy = stack.enter_context(proxied(busy.getsockname()[1]))
        address = f"{proxy.url}{BATCH}"
        answer = httpx.post(address, content=LINE, headers=LINES, verify=proxy.trust(), timeout=30, trust_env=False)

    assert answer.status_code == answer.json()["status"] == 503

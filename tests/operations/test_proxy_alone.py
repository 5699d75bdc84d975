"""nginx without the service behind it: what it answers, and what its log holds."""

import socket
from collections.abc import Iterator
from contextlib import ExitStack

import httpx
import pytest

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

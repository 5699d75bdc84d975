"""Requests that offer another protocol, as Java’s HTTP client sends them: answered in HTTP/1.1, with their body.

And requests with addresses longer than the parser takes.
"""

import json
import re
import socket
from collections.abc import Sequence

import pytest

from hpn.application import WORKED_EXAMPLE
from tests.operations.service import Service

BODY = json.dumps(WORKED_EXAMPLE).encode()
OFFER = b"Connection: Upgrade, HTTP2-Settings\r\nUpgrade: h2c\r\nHTTP2-Settings: AAEAAEAAAAIAAAABAAMAAABk\r\n"
SELECT = b"POST /api/v1/select HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
SIZED = SELECT + OFFER + b"Content-Length: %d\r\n\r\n" % len(BODY)
CHUNKED = SELECT + OFFER + b"Transfer-Encoding: chunked\r\n\r\n"
CHUNKS = b"%x\r\n%b\r\n%x\r\n%b\r\n0\r\n\r\n" % (40, BODY[:40], len(BODY) - 40, BODY[40:])
READ = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n" + OFFER + b"\r\n"
LAST = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"


def answered(service: Service, parts: Sequence[bytes]) -> bytes:
    """Answers to bytes that are sent part by part, each once the service has had time to take the one before."""
    with socket.create_connection(("127.0.0.1", service.port), 60) as connection:
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        for part in parts:
            connection.sendall(part)
            service.client.get("/healthz").raise_for_status()
        return b"".join(iter(lambda: connection.recv(1 << 16), b""))


def statuses(answers: bytes) -> list[str]:
    return re.findall(r"HTTP/1\.1 (\d{3})", answers.decode(errors="replace"))


@pytest.mark.parametrize(
    "parts",
    [
        pytest.param([SIZED + BODY + LAST], id="at once"),
        pytest.param([SIZED, BODY, LAST], id="head before body"),
        pytest.param([SIZED[:90], SIZED[90:] + BODY[:50], BODY[50:] + LAST], id="in pieces"),
        pytest.param([CHUNKED, CHUNKS + LAST], id="in chunks"),
    ],
)
def test_a_body_behind_an_offer_is_read(service: Service, parts: Sequence[bytes]) -> None:
    answers = answered(service, parts)

    assert statuses(answers) == ["200", "200"]
    assert b'"selected":"HPN-20A-5"' in answers


def test_each_of_many_offers_is_left_alone(service: Service) -> None:
    answers = answered(service, [(READ + SIZED + BODY) * 3 + LAST])

    assert statuses(answers) == ["200"] * 7
    assert answers.count(b'"selected":"HPN-20A-5"') == 3


@pytest.mark.parametrize("method", [b"CONNECT", b"CONNECT h:1 HTTP/1.1\r\nHost: h\r\n" + OFFER + b"\r\nGET"])
def test_what_is_no_request_is_refused(service: Service, method: bytes) -> None:
    answers = answered(service, [method + b" \0 HTTP/1.1\r\n\r\n"])

    assert statuses(answers)[-1] == "400"
    assert service.client.get("/healthz").status_code == 200


@pytest.mark.parametrize("length", [60_001, 65_600, 2_000_000])
def test_an_address_of_any_length_gets_the_answer_on_long_addresses(service: Service, length: int) -> None:
    head = b"POST /api/v1/select?%b HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n" % (b"a" * length)

    answers = answered(service, [head + b"Content-Length: %d\r\n\r\n" % len(BODY) + BODY + LAST])

    assert statuses(answers) == ["414", "200"]
    assert b"/problems/address-too-long" in answers

"""The server gives up requests that do not come; nothing else is cut by that."""

import asyncio
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import suppress

import pytest
import uvicorn
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from hpn.web.door.protocol import HEAD_BYTES, HEADER_COUNT, BoundedProtocol

HEAD = b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 4\r\n\r\n"


class Hasty(BoundedProtocol):
    """Has no patience."""

    head_s = 3.0


async def echo(request: Request) -> Response:
    return Response(await request.body())


async def slow_echo(request: Request) -> Response:
    await asyncio.sleep(Hasty.head_s + 1)
    return await echo(request)


@pytest.fixture
def connection() -> Iterator[socket.socket]:
    """A connection to a server with the hasty protocol."""
    app = Starlette(routes=[Route("/", echo, methods=["POST"]), Route("/slow", slow_echo, methods=["POST"])])
    server = uvicorn.Server(uvicorn.Config(app, http=Hasty, log_level="warning", lifespan="off"))
    listener = socket.create_server(("127.0.0.1", 0))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
    thread.start()
    with socket.create_connection(listener.getsockname(), 20) as connection:
        yield connection
    server.should_exit = True
    thread.join(20)


@pytest.mark.parametrize("start", [b"", b"POST / HTT", HEAD[:-2]])
def test_a_connection_whose_head_does_not_come_is_closed(connection: socket.socket, start: bytes) -> None:
    connection.sendall(start)

    assert connection.recv(200) == b""


def everything(connection: socket.socket) -> bytes:
    """What the server sends until it closes."""
    return b"".join(iter(lambda: connection.recv(500), b""))


@pytest.mark.parametrize(
    ("sent", "status"),
    [
        (b"GET / HTTP/x\r\n\r\n", 400),
        (b"\x16\x03\x01\x02\x00\x01\x00", 400),  # how HTTPS begins
        (HEAD[:-2] + b"a: b\r\n" * HEADER_COUNT + b"\r\n", 400),
        (HEAD[:-2] + b"a: " + b"b" * 4 * HEAD_BYTES, 431),
    ],
)
def test_a_head_that_cannot_be_taken_is_refused_and_the_connection_closed(
    connection: socket.socket, sent: bytes, status: int
) -> None:
    with suppress(ConnectionError):  # a client that still sends may see the connection reset before it reads the answer
        connection.sendall(sent)
        assert everything(connection).startswith(b"HTTP/1.1 %d" % status)

    assert connection.recv(1) == b""


def test_what_follows_a_body_is_bounded_too(connection: socket.socket) -> None:
    """Trailers and extensions of chunks count as a head does: nothing else bounds them."""
    chunked = HEAD.replace(b"Content-Length: 4", b"Transfer-Encoding: chunked") + b"4\r\nabcd\r\n"
    with suppress(ConnectionError):
        connection.sendall(chunked + b"0\r\na: " + b"b" * 4 * HEAD_BYTES)
        assert everything(connection).startswith(b"HTTP/1.1 431")


def test_requests_in_time_are_answered_on_one_connection_whatever_the_breaks(connection: socket.socket) -> None:
    for _ in range(2):
        connection.sendall(HEAD)
        connection.sendall(b"ab")
        time.sleep(Hasty.head_s + 0.2)  # the rest of a body is for the application to wait for
        connection.sendall(b"cd")
        answer = b""
        while not answer.endswith(b"abcd"):
            answer += (part := connection.recv(500))
            assert part, answer
        time.sleep(Hasty.head_s + 0.2)


def test_a_later_request_has_as_long_as_the_first(connection: socket.socket) -> None:
    time.sleep(Hasty.head_s * 2 / 3)
    connection.sendall(HEAD[:-2])
    time.sleep(Hasty.head_s * 2 / 3)  # by now the connection is older than a request may be
    connection.sendall(b"\r\nabcd")

    assert connection.recv(500).startswith(b"HTTP/1.1 200")


def test_a_request_is_answered_although_the_head_behind_it_stalls(connection: socket.socket) -> None:
    connection.sendall(HEAD.replace(b"/", b"/slow", 1) + b"abcd" + b"POST / HTT")

    answers = everything(connection)
    assert answers.startswith(b"HTTP/1.1 200")
    assert answers.endswith(b"abcd")


@pytest.mark.parametrize("length", [70_000, 100_000, 200_000])
def test_an_address_that_no_parser_takes_is_a_414_with_words(connection: socket.socket, length: int) -> None:
    with suppress(OSError):  # it is closed before all has been sent
        connection.sendall(b"GET /?T=" + b"9" * length + b" HTTP/1.1\r\nHost: x\r\n\r\n")

    answer = connection.recv(2000)
    assert answer.startswith(b"HTTP/1.1 414 ")
    assert b"application/problem+json" in answer
    assert b"65535 bytes" in answer

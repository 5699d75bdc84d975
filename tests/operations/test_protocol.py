"""The server gives up requests that do not come and answers that nobody reads; nothing else is cut by that."""

import asyncio
import socket
import threading
import time
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from typing import Any

import pytest
import uvicorn
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import Response, StreamingResponse
from starlette.routing import Route

from hpn.web.door.protocol import HEAD_BYTES, HEADER_COUNT, SENDING_BYTES, WAITING_REQUESTS, BoundedProtocol

HEAD = b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 4\r\n\r\n"


HEAD_S = 2.0
STALLED_S = 1.0


async def echo(request: Request) -> Response:
    return Response(await request.body())


async def slow_echo(request: Request) -> Response:
    await asyncio.sleep(HEAD_S + 1)
    return await echo(request)


async def soon_echo(request: Request) -> Response:
    await asyncio.sleep(0.5)
    return await echo(request)


async def refuse(request: Request) -> Response:
    return Response(b"no", 404)


async def many(request: Request) -> Response:
    async def pieces() -> AsyncIterator[bytes]:
        sent[request.url.query] = 0
        try:
            while True:
                yield b"x" * PIECE
                await asyncio.sleep(0)  # what is sent to nobody does not wait
                sent[request.url.query] += PIECE
        finally:
            ended.add(request.url.query)

    return StreamingResponse(pieces())


PIECE = 64 * 1024
sent: dict[str, int] = {}
ended: set[str] = set()
ROUTES = [
    Route("/", echo, methods=["POST"]),
    Route("/slow", slow_echo, methods=["POST"]),
    Route("/soon", soon_echo, methods=["POST"]),
    Route("/refuse", refuse, methods=["GET", "POST"]),
    Route("/many", many),
]


@contextmanager
def server(**options: Any) -> Iterator[tuple[str, int]]:
    """Address of a server with the protocol and little patience."""
    hasty: Any = partial(BoundedProtocol, head_s=HEAD_S, stalled_s=STALLED_S)
    app = Starlette(routes=ROUTES)
    server = uvicorn.Server(uvicorn.Config(app, http=hasty, log_level="critical", lifespan="off", **options))
    listener = socket.create_server(("127.0.0.1", 0))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
    thread.start()
    try:
        yield listener.getsockname()
    finally:
        server.should_exit = server.force_exit = True
        thread.join(20)


@pytest.fixture(scope="module")
def address() -> Iterator[tuple[str, int]]:
    """Address of a server."""
    with server() as address:
        yield address


@pytest.fixture
def connection(address: tuple[str, int]) -> Iterator[socket.socket]:
    """A connection to it."""
    with socket.create_connection(address, 20) as connection:
        yield connection


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
        time.sleep(HEAD_S + 0.2)  # the rest of a body is for the application to wait for
        connection.sendall(b"cd")
        answer = b""
        while not answer.endswith(b"abcd"):
            answer += (part := connection.recv(500))
            assert part, answer
        time.sleep(HEAD_S + 0.2)


def test_a_later_request_has_as_long_as_the_first(connection: socket.socket) -> None:
    time.sleep(HEAD_S * 2 / 3)
    connection.sendall(HEAD[:-2])
    time.sleep(HEAD_S * 2 / 3)  # by now the connection is older than a request may be
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


# --- Answers before the whole request ---------------------------------------------------------------------------------

ANNOUNCED = b"POST /refuse HTTP/1.1\r\nHost: x\r\nContent-Length: %d\r\n\r\n"


def closed_after(connection: socket.socket) -> float:
    """Seconds until the server has ended the connection for good, while the client goes on sending little."""
    start = time.monotonic()
    with suppress(ConnectionError):
        while time.monotonic() < start + 15:
            connection.sendall(b"x")
            time.sleep(0.1)
    return time.monotonic() - start


def test_an_answer_before_its_request_has_arrived_is_delivered_and_is_the_last(connection: socket.socket) -> None:
    count = 20_000_000  # more than sockets hold: the client is still sending when the answer is ready
    connection.sendall(ANNOUNCED % count + bytes(count))

    answer = everything(connection)
    assert answer.startswith(b"HTTP/1.1 404")
    assert b"connection: close" in answer.lower()
    assert answer.endswith(b"no")


def test_a_body_that_drips_behind_an_early_answer_is_cut_off(connection: socket.socket) -> None:
    connection.sendall(ANNOUNCED % 1000)

    assert connection.recv(500).endswith(b"no")
    assert closed_after(connection) < 10


def test_what_follows_an_early_answer_is_discarded_up_to_a_bound(connection: socket.socket) -> None:
    connection.sendall(ANNOUNCED % 10**9)

    with pytest.raises(ConnectionError):
        for _ in range(200):
            connection.sendall(bytes(1_000_000))


def test_an_answer_before_a_small_body_that_is_there_keeps_the_connection(connection: socket.socket) -> None:
    for _ in range(2):
        connection.sendall(ANNOUNCED % 4 + b"abcd")
        assert b"connection: close" not in connection.recv(500).lower()


# --- Answers that nobody reads ----------------------------------------------------------------------------------------


def test_an_answer_that_nobody_reads_takes_little_and_is_broken_off(address: tuple[str, int]) -> None:
    with socket.socket() as connection:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        connection.settimeout(20)
        connection.connect(address)
        connection.sendall(b"GET /many?unread HTTP/1.1\r\nHost: x\r\n\r\n")

        await_that(lambda: "unread" in ended)

    # the system takes twice what it is told, and the transport a piece beyond its own bound of 64 kB
    assert sent["unread"] < 2 * SENDING_BYTES + 4 * PIECE


def test_an_answer_that_is_read_slowly_is_not_broken_off(address: tuple[str, int]) -> None:
    with socket.create_connection(address, 20) as connection:
        connection.sendall(b"GET /many?slow HTTP/1.1\r\nHost: x\r\n\r\n")
        for _ in range(20):
            assert connection.recv(300_000)
            time.sleep(STALLED_S / 10)
        assert "slow" not in ended

    await_that(lambda: "slow" in ended)


# --- More than one request --------------------------------------------------------------------------------------------


def test_few_requests_wait_on_one_connection_and_more_close_it(address: tuple[str, int]) -> None:
    slow, quick = HEAD.replace(b"/", b"/soon", 1) + b"abcd", HEAD + b"abcd"
    with socket.create_connection(address, 20) as few, socket.create_connection(address, 20) as more:
        few.sendall(slow + quick * WAITING_REQUESTS)
        more.sendall(slow + quick * (WAITING_REQUESTS + 1))

        assert b" 200 " not in everything(more)
        answers = b""
        while answers.count(b"HTTP/1.1 200") <= WAITING_REQUESTS:
            answers += (part := few.recv(5000))
            assert part, answers


def test_a_client_that_leaves_ends_its_work_although_another_request_waits(address: tuple[str, int]) -> None:
    with socket.create_connection(address, 20) as connection:
        connection.sendall(b"GET /many?left HTTP/1.1\r\nHost: x\r\n\r\n" + HEAD + b"abcd")
        assert connection.recv(10)

    await_that(lambda: "left" in ended)


def test_line_ends_between_requests_do_not_keep_a_connection(connection: socket.socket) -> None:
    connection.sendall(HEAD + b"abcd")
    assert connection.recv(500).endswith(b"abcd")
    connection.sendall(b"\r\n")  # uvicorn takes it for a request, and waits for the rest without end

    assert everything(connection) == b""


def test_idle_connections_make_room_for_others_and_busy_ones_do_not() -> None:
    with server(limit_concurrency=4) as address, ExitStack() as held:
        silent = [held.enter_context(socket.create_connection(address, 20)) for _ in range(20)]
        assert status_of(address) == b"200"
        assert [gone(connection) for connection in silent[:17]] == [True] * 17

        for _ in range(4):
            busy = held.enter_context(socket.create_connection(address, 20))
            busy.sendall(b"GET /many?busy HTTP/1.1\r\nHost: x\r\n\r\n")
            busy.recv(10)
        assert status_of(address) == b"503"


def gone(connection: socket.socket) -> bool:
    """Whether the server has ended a connection without a word."""
    try:
        return connection.recv(1) == b""
    except ConnectionError:
        return True


def status_of(address: tuple[str, int]) -> bytes:
    """Status of a small request on a connection of its own."""
    with socket.create_connection(address, 20) as connection:
        connection.sendall(HEAD + b"abcd")
        return connection.recv(500)[9:12]


def await_that(holds: Callable[[], bool]) -> None:
    """Wait until something holds."""
    for _ in range(200):
        if holds():
            return
        time.sleep(0.1)
    raise AssertionError("it does not come to hold")

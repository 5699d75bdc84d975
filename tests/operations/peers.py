"""Peers that are slow or greedy, as data, and a crowd that plays them on loopback."""

import selectors
import socket
import ssl
import struct
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

import orjson

from tests.build import worked_example

NDJSON, JSON = "application/x-ndjson", "application/json"
LINE = orjson.dumps({"reference": "axis", **worked_example()}) + b"\n"
LINES = LINE * 20_000
ITEMS = orjson.dumps({"applications": [{"reference": f"axis-{n}", **worked_example()} for n in range(2000)]})
LINK = b"/?T=40&n=250&t=0.3&T=32&n=500&t=3&tp=4&Tk=200"
RESET = struct.pack("ii", 1, 0)


def head(method: bytes, path: bytes, *lines: bytes) -> bytes:
    """Head of a request."""
    return b"\r\n".join([b"%b %b HTTP/1.1" % (method, path), b"Host: localhost", *lines, b"", b""])


def post(path: bytes, content_type: str, length: int | None) -> bytes:
    """Head of a POST; in chunks where it has no length."""
    framing = b"Transfer-Encoding: chunked" if length is None else b"Content-Length: %d" % length
    return head(b"POST", path, b"Content-Type: " + content_type.encode(), framing)


def chunk(piece: bytes) -> bytes:
    """A piece of a body in chunks."""
    return b"%x\r\n%b\r\n" % (len(piece), piece)


def frame(kind: int, flags: int, stream: int, payload: bytes) -> bytes:
    """A frame of HTTP/2 (RFC 9113, section 4.1)."""
    return struct.pack(">I", len(payload))[1:] + struct.pack(">BBI", kind, flags, stream) + payload


def resets(count: int) -> bytes:
    """Requests of HTTP/2 that are each taken back at once (CVE-2023-44487)."""
    question = b"\x82\x87\x84" + b"\x41\x09localhost"  # GET, https, / and the authority, as HPACK has them
    cancelled = struct.pack(">I", 8)
    streams = (frame(1, 5, k, question) + frame(3, 0, k, cancelled) for k in range(1, 2 * count, 2))
    return b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + frame(4, 0, 0, b"") + b"".join(streams)


@dataclass(frozen=True)
class Peer:
    """Behaviour of a peer: bytes sent at once and repeated, reading or not, and its end."""

    name: str
    sent: bytes = b""
    drip: bytes = b""
    reads: bool = True
    end: str = ""  # "half" closes its sending half, "reset" resets the connection
    many: int = 20
    crowd: int = 0  # how many there are behind nginx in the long form, where that is more
    tls: bool = True
    nginx_waits: bool = False  # nginx has no bound for the whole time of a body: gone once it stops, or after minutes
    protocol: str = ""  # h2, which nginx alone speaks
    alone: bool = False  # the service alone ends it too
    of_one: int = 8  # how many of them one address may have behind nginx


SELECT, BATCH, NOWHERE = b"/api/v1/select", b"/api/v1/select/batch", b"/nowhere"
SLOW = post(SELECT, JSON, 100_000)
PEERS = (
    Peer("head that drips", b"GET / HTTP/1.1\r\nHost: localhost\r\nX-Slow: ", b"a", crowd=1000),
    Peer(
        "body that drips, read by its handler",
        post(SELECT, JSON, 100_000),
        b" ",
        crowd=1000,
        nginx_waits=True,
        alone=True,
    ),
    Peer("body that drips, read by nobody", post(NOWHERE, JSON, 100_000), b" ", nginx_waits=True),
    Peer("lines that drip", post(BATCH, NDJSON, None), chunk(b" "), many=10, nginx_waits=True, alone=True, of_one=1),
    Peer("body announced and never sent", post(SELECT, JSON, 100_000), alone=True),
    Peer("early error, body still coming", post(NOWHERE, JSON, 10**9), bytes(65536)),
    Peer("body larger than allowed", post(SELECT, JSON, 10**8), bytes(65536)),
    Peer("chunked body without end", post(SELECT, JSON, None), chunk(bytes(65536))),
    Peer("answer nobody reads: page", head(b"GET", LINK) * 4, reads=False, crowd=1000),
    Peer("answer nobody reads: PDF", head(b"GET", b"/report.pdf" + LINK[1:]) * 2, reads=False, many=4, of_one=4),
    Peer("answer nobody reads: JSON of 2,000", post(BATCH, JSON, len(ITEMS)) + ITEMS, reads=False, many=4, of_one=3),
    Peer("answer nobody reads: lines", post(BATCH, NDJSON, len(LINES)) + LINES, reads=False, many=4, of_one=1),
    Peer("connections that say nothing", many=1000, tls=False),
    Peer("pipelined flood", head(b"GET", b"/healthz") * 2000, head(b"GET", b"/healthz") * 2000, reads=False),
    Peer("huge head", b"GET / HTTP/1.1\r\nHost: localhost\r\nX-Long: " + b"a" * 300_000),
    Peer("many headers", head(b"GET", b"/", *[b"X-%d: b" % n for n in range(20_000)])),
    Peer("half-closed", head(b"GET", LINK), end="half", tls=False, alone=True),
    Peer("keep-alive idle", head(b"GET", b"/healthz"), alone=True),
    Peer("HTTP/2 rapid reset", resets(20_000), protocol="h2"),
    Peer("reset in the middle", post(SELECT, JSON, 100_000) + b"{" * 1000, end="reset", alone=True),
)


class Crowd:
    """Many of one kind of peer, played by a thread until each has been cut off or `stop` ends it."""

    def __init__(self, peer: Peer, connect: Callable[[int], socket.socket], count: int) -> None:
        self._peer = peer
        self._selector = selectors.DefaultSelector()
        self._stopped = threading.Event()
        for number in range(count):
            self._add(connect(number))
        self._thread = threading.Thread(target=self._play)
        self._thread.start()

    @property
    def left(self) -> int:
        """Number of peers still connected."""
        return len(self._selector.get_map() or ())

    def stop(self) -> None:
        """Hang up."""
        self._stopped.set()
        self._thread.join()
        for key in list(self._selector.get_map().values()):
            self._drop(key.fileobj)
        self._selector.close()

    def _add(self, connection: socket.socket) -> None:
        connection.settimeout(2)
        with suppress(OSError):  # refused while it sends
            connection.sendall(self._peer.sent)
            if self._peer.end == "half":
                connection.shutdown(socket.SHUT_WR)
        if self._peer.end == "reset":
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, RESET)
            connection.close()
            return
        connection.setblocking(False)
        self._selector.register(connection, selectors.EVENT_READ)

    def _play(self) -> None:
        while not self._stopped.wait(0.1):
            for key in list(self._selector.get_map().values()):
                connection = key.fileobj
                assert isinstance(connection, socket.socket)
                if self._gone(connection):
                    self._drop(connection)

    def _gone(self, connection: socket.socket) -> bool:
        try:
            if self._peer.drip:
                connection.send(self._peer.drip)
        except (BlockingIOError, ssl.SSLWantWriteError, ssl.SSLWantReadError):
            pass
        except OSError:
            return True
        try:
            return self._peer.reads and connection.recv(1_000_000) == b""
        except (BlockingIOError, ssl.SSLWantReadError):
            return False
        except OSError:
            return True

    def _drop(self, connection: object) -> None:
        assert isinstance(connection, socket.socket)
        self._selector.unregister(connection)
        connection.close()


def until(holds: Callable[[], bool], seconds: float) -> float:
    """Seconds until something holds; AssertionError where it does not in time."""
    start = time.monotonic()
    while not holds():
        assert time.monotonic() < start + seconds, f"it does not hold after {seconds} s"
        time.sleep(0.1)
    return time.monotonic() - start

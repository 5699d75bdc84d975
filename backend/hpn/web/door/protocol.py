"""The server's HTTP protocol with bounds on how a request arrives, which uvicorn with httptools lacks."""

import asyncio
from typing import Any

from uvicorn.protocols.http.flow_control import service_unavailable
from uvicorn.protocols.http.httptools_impl import STATUS_LINE, HttpToolsProtocol

from hpn.web.door.problems import Problem

HEAD_BYTES = 128 * 1024
"""Enough for the longest link."""
HEADER_COUNT = 100
UNREADABLE = Problem(400, "this is not an HTTP/1.1 request")
LATE = Problem(408, "the body of the request did not come")
TOO_LARGE = Problem(431, f"the address and the headers are limited to {HEAD_BYTES} bytes and {HEADER_COUNT} headers")
BUSY = Problem(
    503,
    "the service has as many connections as it can take; try again in 1 s",
    headers={"Retry-After": "1", "Connection": "close"},
)


class HeadTooLargeError(Exception):
    """The parser is to stop."""


class BoundedProtocol(HttpToolsProtocol):
    """Answers 431 to a head that is too large, and gives up a request that does not come.

    What exceeds the most connections gets a problem that says when to come again, in place of uvicorn's plain text.
    Its head and the first of its body have `arrival_s` together; `bodies.py` limits the rest of a body.
    """

    arrival_s = 20.0
    _arrival: float | None = None
    _in_head = False
    _timer: asyncio.TimerHandle | None = None
    _refused = False
    _head_bytes = 0
    _unseen_bytes = 0

    def connection_made(self, transport: Any) -> None:
        """A client has connected."""
        super().connection_made(transport)
        self._expect()

    def connection_lost(self, exc: Exception | None) -> None:
        """The client has gone."""
        if self._timer is not None:
            self._timer.cancel()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Bytes have come; those that lead to nothing, such as an endless header, count."""
        self._unseen_bytes += len(data)
        super().data_received(data)
        if self._unseen_bytes > HEAD_BYTES + len(data) and not self.transport.is_closing():
            self._refused = True
            self.send_400_response("")

    def on_message_begin(self) -> None:
        """A request begins."""
        self._head_bytes, self._in_head = 0, True
        super().on_message_begin()
        self._expect()

    def on_url(self, url: bytes) -> None:
        """Part of the address."""
        self._count(len(url))
        super().on_url(url)

    def on_header(self, name: bytes, value: bytes) -> None:
        """A header, or a trailer after the body."""
        self._count(len(name) + len(value))
        if len(self.headers) >= HEADER_COUNT:
            self._refuse()
        super().on_header(name, value)

    def on_headers_complete(self) -> None:
        """The head is complete."""
        self._unseen_bytes, self._in_head = 0, False
        super().on_headers_complete()

    def on_body(self, body: bytes) -> None:
        """Part of the body."""
        self._unseen_bytes, self._arrival = 0, None
        super().on_body(body)

    def on_message_complete(self) -> None:
        """The whole request is there."""
        self._arrival = None
        super().on_message_complete()

    def send_400_response(self, msg: str) -> None:
        """Refuse what can't be parsed; 431 where that is because it is too large."""
        if not self.transport.is_closing():
            self._end(TOO_LARGE if self._refused else UNREADABLE)

    def _start_asgi_task(self, cycle: Any, app: Any) -> None:
        answering: Any = BUSY.response() if app is service_unavailable else app
        super()._start_asgi_task(cycle, answering)

    def _count(self, size: int) -> None:
        self._head_bytes += size
        if self._head_bytes > HEAD_BYTES:
            self._refuse()

    def _refuse(self) -> None:
        self._refused = True
        raise HeadTooLargeError

    def _expect(self) -> None:
        self._arrival = self.loop.time() + self.arrival_s
        if self._timer is None:
            self._timer = self.loop.call_later(self.arrival_s, self._look)

    def _look(self) -> None:
        """See whether the request is late. There is one timer for all requests of a connection."""
        self._timer = None
        if self._arrival is None:
            return
        left = self._arrival - self.loop.time()
        if left > 0:
            self._timer = self.loop.call_later(left, self._look)
            return
        answering = self.cycle is not None and not self.cycle.response_complete
        if answering and self._in_head:  # an earlier request, which is not to suffer
            self._timer = self.loop.call_later(self.arrival_s, self._look)
            return
        if answering and not self.cycle.response_started:
            self._end(LATE)
        self.transport.close()

    def _end(self, problem: Problem) -> None:
        response = problem.response()
        headers = (name + b": " + value + b"\r\n" for name, value in response.raw_headers)
        head = [STATUS_LINE[problem.status_code], *headers, b"connection: close\r\n\r\n"]
        self.transport.write(b"".join([*head, bytes(response.body)]))
        self.transport.close()

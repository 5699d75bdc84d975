"""A bound on the size and the time of a request's head, which uvicorn with httptools lacks."""

import asyncio
from typing import Any

from uvicorn.protocols.http.flow_control import service_unavailable
from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

from hpn.web.door.problems import MEDIA_TYPE, Problem

HEAD_BYTES = 128 * 1024
"""Enough for the longest link."""
HEADER_COUNT = 100
URL_BYTES = 0xFFFF
"""More can't be parsed; what is longer than a link may be is refused by its route."""
TOO_LARGE = b"HTTP/1.1 431 Request Header Fields Too Large\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"
TOO_LONG = Problem(414, f"an address may have {URL_BYTES} bytes at most; post what is longer")
BUSY = Problem(503, "all connections are taken; try again in 1 s", headers={"Retry-After": "1", "Connection": "close"})


class BoundedProtocol(HttpToolsProtocol):
    """Refuses a head that is too large, and closes a connection on which a head does not arrive in time."""

    head_s = 20.0
    _unread_bytes = 0  # since the last complete head or part of a body
    url = b""
    _timer: asyncio.TimerHandle | None = None

    def connection_made(self, transport: Any) -> None:
        super().connection_made(transport)
        self._expect_head()

    def connection_lost(self, exc: Exception | None) -> None:
        self._stop_timer()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        self._unread_bytes += len(data)
        super().data_received(data)
        if self._unread_bytes > HEAD_BYTES and not self.transport.is_closing():
            self.transport.write(TOO_LARGE)
            self.transport.close()

    def on_message_begin(self) -> None:
        super().on_message_begin()
        self._expect_head()

    def on_url(self, url: bytes) -> None:
        super().on_url(url)
        if len(self.url) > URL_BYTES:
            raise ValueError("too long")  # the parser stops, and `send_400_response` is called

    def send_400_response(self, msg: str) -> None:
        if len(self.url) <= URL_BYTES:
            super().send_400_response(msg)
            return
        body = TOO_LONG.response().body
        head = f"HTTP/1.1 414 URI Too Long\r\nContent-Type: {MEDIA_TYPE}\r\nContent-Length: {len(body)}\r\n"
        self.transport.write(head.encode() + b"Connection: close\r\n\r\n" + bytes(body))
        self.transport.close()

    def on_header(self, name: bytes, value: bytes) -> None:
        if len(self.headers) >= HEADER_COUNT:
            raise ValueError("too many headers")  # the parser stops, and uvicorn answers 400
        super().on_header(name, value)

    def on_headers_complete(self) -> None:
        self._stop_timer()
        self._unread_bytes = 0
        super().on_headers_complete()

    def on_body(self, body: bytes) -> None:
        self._unread_bytes = 0
        super().on_body(body)

    def _start_asgi_task(self, cycle: Any, app: Any) -> None:
        answering: Any = BUSY.response() if app is service_unavailable else app
        super()._start_asgi_task(cycle, answering)

    def _expect_head(self) -> None:
        self._stop_timer()
        self._timer = self.loop.call_later(self.head_s, self._late)

    def _stop_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()

    def _late(self) -> None:
        if self.cycle is not None and not self.cycle.response_complete:
            self._expect_head()  # the answer to an earlier request is still under way
        else:
            self.transport.close()

"""The server's HTTP protocol with bounds on a request's head, which uvicorn with httptools lacks."""

import asyncio
from typing import Any

from uvicorn.protocols.http.httptools_impl import STATUS_LINE, HttpToolsProtocol

HEAD_BYTES = 128 * 1024
"""Enough for the longest link."""
HEADER_COUNT = 100
HEAD_SECONDS = 20.0


class HeadTooLargeError(Exception):
    """The parser is to stop."""


class BoundedProtocol(HttpToolsProtocol):
    """Answers 431 to a head that is too large, and closes a connection whose head takes too long."""

    _head_timer: asyncio.TimerHandle | None = None
    _refused = False
    _head_bytes = 0
    _unseen_bytes = 0

    def connection_made(self, transport: Any) -> None:
        """A client has connected."""
        super().connection_made(transport)
        self._expect_head()

    def connection_lost(self, exc: Exception | None) -> None:
        """The client has gone."""
        self._forget_timer()
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
        self._head_bytes = 0
        super().on_message_begin()
        if self._head_timer is None:
            self._expect_head()

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
        self._forget_timer()
        self._unseen_bytes = 0
        super().on_headers_complete()

    def on_body(self, body: bytes) -> None:
        """Part of the body."""
        self._unseen_bytes = 0
        super().on_body(body)

    def send_400_response(self, msg: str) -> None:
        """Refuse what can't be parsed; 431 where that is because it is too large."""
        if self.transport.is_closing():
            return
        if not self._refused:
            super().send_400_response(msg)
            return
        head = [STATUS_LINE[431], b"content-length: 0\r\nconnection: close\r\n\r\n"]
        self.transport.write(b"".join(head))
        self.transport.close()

    def _count(self, size: int) -> None:
        self._head_bytes += size
        if self._head_bytes > HEAD_BYTES:
            self._refuse()

    def _refuse(self) -> None:
        self._refused = True
        raise HeadTooLargeError

    def _expect_head(self) -> None:
        self._head_timer = self.loop.call_later(HEAD_SECONDS, self.transport.close)

    def _forget_timer(self) -> None:
        if self._head_timer is not None:
            self._head_timer.cancel()
            self._head_timer = None

"""What one connection may take: bounds on a request's head, on what waits behind it, and on answers nobody reads.

uvicorn with httptools bounds none of these. Whoever reads a body bounds its size and its time (`bodies.py`).
"""

import asyncio
import socket
from typing import Any, cast

from starlette.types import Message, Receive, Scope, Send
from uvicorn.protocols.http.flow_control import service_unavailable
from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

from hpn.web.door.problems import MEDIA_TYPE, Problem

HEAD_BYTES = 128 * 1024
"""Enough for the longest link."""
HEADER_COUNT = 100
URL_BYTES = 0xFFFF
"""More can't be parsed; what is longer than a link may be is refused by its route."""
WAITING_REQUESTS = 4
"""Requests that may wait on one connection while another is answered."""
SENDING_BYTES = 128 * 1024
"""What the system buffers of an answer; left to itself it takes megabytes per connection."""
DISCARDED_BYTES = 64_000_000
"""What a closed connection still reads: a client that sends all before it reads would else miss why it was refused."""
LINGER_SECONDS = 5.0
TOO_LARGE = b"HTTP/1.1 431 Request Header Fields Too Large\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"
TOO_LONG = Problem(414, f"an address may have {URL_BYTES} bytes at most; post what is longer")
BUSY = Problem(503, "all connections are taken; try again in 1 s", headers={"Retry-After": "1", "Connection": "close"})


class Lingering:
    """A transport whose `close` delivers what was written although the client still sends, and ends in time.

    To close a socket that holds unread bytes resets the connection, and the client loses the answer. So only the
    sending half is closed, and what arrives is discarded until the client closes too, within bounds.
    """

    def __init__(self, transport: asyncio.Transport, loop: asyncio.AbstractEventLoop, seconds: float) -> None:
        self._transport = transport
        self._loop = loop
        self._seconds = seconds
        self._timer: asyncio.TimerHandle | None = None
        self._discarded = 0
        self.arriving = False  # whether a request has begun to arrive and not ended

    def __getattr__(self, name: str) -> Any:
        return getattr(self._transport, name)

    def is_closing(self) -> bool:
        """Whether nothing more is taken."""
        return self._timer is not None or self._transport.is_closing()

    def write(self, data: bytes) -> None:
        """Send, or drop what comes after the end."""
        if not self.is_closing():
            self._transport.write(data)

    def close(self) -> None:
        """End the connection once what was written is delivered, or its time is over."""
        if self.is_closing():
            return
        self._timer = self._loop.call_later(self._seconds, self._transport.abort)
        if self.arriving:
            self._transport.write_eof()
            self._transport.resume_reading()
        else:
            self._transport.close()

    def discard(self, count: int) -> None:
        """Note bytes that arrived after the end."""
        self._discarded += count
        if self._discarded > DISCARDED_BYTES:
            self._transport.abort()

    def lost(self) -> None:
        """Forget the connection."""
        if self._timer is not None:
            self._timer.cancel()


class BoundedProtocol(HttpToolsProtocol):
    """HTTP/1.1 for one connection, within bounds of size, number and time.

    `head_s` is the longest time for a head to arrive, `stalled_s` the longest time that a client may leave an answer
    unread.
    """

    _unread_bytes = 0  # since the last complete head or part of a body
    url = b""
    _head_timer: asyncio.TimerHandle | None = None
    _write_timer: asyncio.TimerHandle | None = None
    _answered: Any = None  # the request that is being answered: `cycle` is the last that has arrived
    idle_since = 0.0

    def __init__(self, *args: Any, head_s: float = 20.0, stalled_s: float = 30.0, **options: Any) -> None:
        super().__init__(*args, **options)
        self.head_s = head_s
        self.stalled_s = stalled_s

    # --- The connection -----------------------------------------------------------------------------------------------

    def connection_made(self, transport: Any) -> None:
        if (connection := transport.get_extra_info("socket")) is not None:
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SENDING_BYTES)
        self._line = Lingering(transport, self.loop, min(LINGER_SECONDS, self.stalled_s))
        super().connection_made(cast(asyncio.Transport, self._line))
        self._expect_head()
        if self.limit_concurrency is not None and len(self.connections) >= self.limit_concurrency:
            self._make_room()

    def connection_lost(self, exc: Exception | None) -> None:
        self._stop_head_timer()
        if self._write_timer is not None:
            self._write_timer.cancel()
        self._line.lost()
        if self._busy():  # uvicorn only tells the last request that has arrived
            self._answered.disconnected = True
            self._answered.message_event.set()
        super().connection_lost(exc)

    def eof_received(self) -> None:
        self._line.arriving = False
        self.transport.close()

    def _make_room(self) -> None:
        """End the connection that has been idle longest: one that says nothing must not keep others out."""
        others = cast(set[BoundedProtocol], self.connections - {self})
        if idle := [other for other in others if not other._busy()]:
            oldest = min(idle, key=lambda other: other.idle_since)
            self.connections.discard(oldest)
            oldest.transport.abort()

    def _busy(self) -> bool:
        return self._answered is not None and not self._answered.response_complete

    def _answering(self) -> bool:
        return self._busy() and self._answered.response_started

    # --- What arrives -------------------------------------------------------------------------------------------------

    def data_received(self, data: bytes) -> None:
        if self.transport.is_closing():
            self._line.discard(len(data))
            return
        self._unread_bytes += len(data)
        super().data_received(data)
        if self._head_timer is None and not self._busy():  # line ends between requests, which stopped uvicorn's timer
            self._expect_head()
        if self._unread_bytes > HEAD_BYTES and not self.transport.is_closing():
            if not self._answering():
                self.transport.write(TOO_LARGE)
            self.transport.close()

    def on_message_begin(self) -> None:
        super().on_message_begin()
        self._line.arriving = True
        self._expect_head()

    def on_url(self, url: bytes) -> None:
        super().on_url(url)
        if len(self.url) > URL_BYTES:
            raise ValueError("too long")  # the parser stops, and `send_400_response` is called

    def send_400_response(self, msg: str) -> None:
        if self._answering():  # it would stand in the middle of another answer
            self.transport.close()
        elif len(self.url) <= URL_BYTES:
            super().send_400_response(msg)
        else:
            body = TOO_LONG.response().body
            head = f"HTTP/1.1 414 URI Too Long\r\nContent-Type: {MEDIA_TYPE}\r\nContent-Length: {len(body)}\r\n"
            self.transport.write(head.encode() + b"Connection: close\r\n\r\n" + bytes(body))
            self.transport.close()

    def on_header(self, name: bytes, value: bytes) -> None:
        if len(self.headers) >= HEADER_COUNT:
            raise ValueError("too many headers")  # the parser stops, and uvicorn answers 400
        super().on_header(name, value)

    def on_headers_complete(self) -> None:
        self._stop_head_timer()
        self._unread_bytes = 0
        super().on_headers_complete()
        if len(self.pipeline) > WAITING_REQUESTS:
            raise ValueError("too many requests wait")

    def on_body(self, body: bytes) -> None:
        self._unread_bytes = 0
        super().on_body(body)

    def on_message_complete(self) -> None:
        self._line.arriving = False
        super().on_message_complete()

    # --- What is answered ---------------------------------------------------------------------------------------------

    def _start_asgi_task(self, cycle: Any, app: Any) -> None:
        self._answered = cycle
        answering: Any = BUSY.response() if app is service_unavailable else app

        async def run(scope: Scope, receive: Receive, send: Send) -> None:
            async def sending(message: Message) -> None:
                # A refusal before the whole request has arrived is the last answer, and says so. Nothing else does: a
                # client that streams both ways would take it for the end of what it may send.
                if message["type"] == "http.response.start" and message["status"] >= 400 and cycle.more_body:
                    cycle.keep_alive = False
                await send(message)

            await answering(scope, receive, sending)

        super()._start_asgi_task(cycle, cast(Any, run))

    def on_response_complete(self) -> None:
        if self._answered.more_body:
            self.transport.close()
        super().on_response_complete()
        self.idle_since = self.loop.time()

    def pause_writing(self) -> None:
        super().pause_writing()
        self._write_timer = self.loop.call_later(self.stalled_s, self.transport.abort)

    def resume_writing(self) -> None:
        if self._write_timer is not None:
            self._write_timer.cancel()
        super().resume_writing()

    # --- Time ---------------------------------------------------------------------------------------------------------

    def _expect_head(self) -> None:
        self._stop_head_timer()
        self.idle_since = self.loop.time()
        self._head_timer = self.loop.call_later(self.head_s, self._late)

    def _late(self) -> None:
        if self._busy():
            self._expect_head()  # the answer to an earlier request is still under way
        else:
            self.transport.close()

    def _stop_head_timer(self) -> None:
        if self._head_timer is not None:
            self._head_timer.cancel()
            self._head_timer = None

"""Newline-delimited JSON, streamed in and out at once, in memory that does not grow with the number of lines."""

import asyncio
import tempfile
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import orjson
from starlette.responses import Response
from starlette.types import Message, Receive, Scope, Send

from hpn.web import spool
from hpn.web.door.bodies import late
from hpn.web.door.disk import Disk, Share
from hpn.web.door.pools import Pool
from hpn.web.door.problems import Problem

MEDIA_TYPES = ("application/x-ndjson", "application/ndjson", "application/jsonl")
LINES_AT_ONCE = 256
MEMORY_BYTES = 512 * 1024
READ_BYTES = 128 * 1024

SHARES = 7
"""Streams that would fill the disk together: what one sends beyond its part waits until it reads its answers."""

PAUSE_S = 0.05
"""Time without anything arriving after which a client waits for its answers, rather than sends."""

PATIENCE_S, LITTLE_BYTES = 1.0, 500_000
"""Time after which what arrives without a pause is answered meanwhile, and what must not be there by then."""

BYTE_ORDER_MARK = b"\xef\xbb\xbf"


class Line(NamedTuple):
    """A line without its end, None for one that is too long, and its number in the body, which counts from 1."""

    number: int
    content: bytes | None


Evaluate = Callable[[Sequence[Line]], tuple[bytes, int]]
"""Answers to the first of some lines, each with its line end, and how many of them these answer: one at least."""


class LineSplitter:
    """Cuts chunks into lines. Blank ones are skipped, and of one that is too long nothing is kept."""

    def __init__(self, maximum_bytes: int) -> None:
        self._maximum = maximum_bytes
        self._part = bytearray()
        self._too_long = False
        self._number = 0

    def feed(self, chunk: bytes) -> list[Line]:
        """Lines that end in this chunk."""
        first, *others = chunk.split(b"\n")
        self._keep(first)
        lines = []
        for part in others:
            lines.append(self._take())
            self._keep(part)
        return [line for line in lines if line.content != b""]

    def rest(self) -> list[Line]:
        """The last line, where it has no end."""
        line = self._take()
        return [line] if line.content != b"" else []

    def _keep(self, part: bytes) -> None:
        if self._too_long or len(self._part) + len(part) > self._maximum:
            self._too_long = True
            self._part.clear()
        else:
            self._part += part

    def _take(self) -> Line:
        content = None if self._too_long else bytes(self._part).removeprefix(BYTE_ORDER_MARK).strip()
        self._too_long = False
        self._part.clear()
        self._number += 1
        return Line(self._number, content)


class Spool:
    """First in, first out; what exceeds a little memory waits in a temporary file."""

    def __init__(self, share: Share, most: int, folder: Path | None = None) -> None:
        self._share, self._most = share, most
        self._file = tempfile.SpooledTemporaryFile(MEMORY_BYTES, dir=str(folder) if folder else None)  # noqa: SIM115
        self._begin = self._end = 0

    def __len__(self) -> int:
        return self._end - self._begin

    def fits(self, piece: bytes) -> bool:
        """True where there is room for more: a file shrinks once all of it has been read."""
        return not self._end or (self._end + len(piece) <= self._most and self._share.fits(len(piece)))

    def write(self, piece: bytes) -> None:
        """Add at the end."""
        self._file.seek(self._end)
        self._end += self._file.write(piece)
        self._share.add(len(piece))

    def read(self) -> bytes:
        """Take from the front; nothing where nothing is left."""
        self._file.seek(self._begin)
        piece = self._file.read(min(READ_BYTES, len(self)))
        self._begin += len(piece)
        if self._begin == self._end:
            self._file.seek(0)
            self._file.truncate()
            self._share.give_back()
            self._begin = self._end = 0
        return piece

    def close(self) -> None:
        """Give the file back."""
        self._file.close()


class LineStream(Response):
    """Answers each line of the request's body with one line, while the body still arrives if its length is unknown.

    Arrived lines are read first, and answered once the client pauses, or sends so little that reading it takes no time:
    most clients send everything before they read, and nginx stops passing a body on where it has had to wait for a
    service whose answer has begun.

    A client that neither sends a line nor reads for `seconds` is told so in a last line, and the stream ends.
    """

    media_type = MEDIA_TYPES[0]

    def __init__(
        self,
        evaluate: Evaluate,
        *,
        pool: Pool,
        disk: Disk,
        maximum_line_bytes: int,
        spool_folder: Path | None = None,
        seconds: float,
    ) -> None:
        self.status_code = 200
        self.background = None
        self.init_headers({"X-Accel-Buffering": "no", "Cache-Control": "no-store"})
        self._evaluate, self._pool, self._disk = evaluate, pool, disk
        self._splitter = LineSplitter(maximum_line_bytes)
        self._folder, self._seconds = spool_folder, seconds
        self._changed, self._drained = asyncio.Event(), asyncio.Event()
        self._arrived = self._waiting_since = 0.0
        self._begun = self._whole = self._full = self._gone = self._sending = self._text = False

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Run both directions until every line is answered, or the client has gone; raises Problem 503 at once."""
        with self._pool.place(), self._disk.share() as share:
            self._spool = Spool(share, self._disk.total // SHARES, self._folder)
            try:
                await self._run(scope, receive, send)
            finally:
                self._spool.close()

    async def _run(self, scope: Scope, receive: Receive, send: Send) -> None:
        try:
            async with asyncio.timeout(self._seconds):
                first = await receive()  # before the head: only asking for the body answers `Expect: 100-continue`
        except TimeoutError:
            raise late(self._seconds) from None
        self._told = any(name == b"content-length" for name, _ in scope.get("headers", ()))
        reading: asyncio.Task[None] | None = None
        try:
            async with asyncio.timeout(self._seconds) as self._limit:
                reading = asyncio.create_task(self._read(first, receive))
                await self._answer(send)
                if reading.done():
                    reading.result()  # raises what went wrong; the answer then stays without its end
                await self._send(send, b"", more=False)
        except TimeoutError:
            if not self._begun:
                raise late(self._seconds) from None
            await self._give_up(send)
        finally:
            if reading is not None:
                reading.cancel()
                await asyncio.gather(reading, return_exceptions=True)

    # --- What arrives -------------------------------------------------------------------------------------------------

    async def _read(self, message: Message, receive: Receive) -> None:
        """Set aside what arrives until the body ends, then watch whether the client stays."""
        try:
            while message["type"] == "http.request" and not self._whole:
                await self._set_aside(message.get("body", b""))
                self._whole = not message.get("more_body", False)
                self._changed.set()
                message = await receive()
            while message["type"] == "http.request":
                message = await receive()
        finally:
            self._gone = True
            self._changed.set()

    async def _set_aside(self, piece: bytes) -> None:
        self._arrived = asyncio.get_running_loop().time()
        self._waiting_since = self._waiting_since if len(self._spool) else self._arrived
        self._text = self._text or bool(piece.strip())
        if self._text and b"\n" in piece:  # blank lines are no sign of life
            self._text = False
            self._progress()
        while not self._spool.fits(piece):
            self._full = True
            self._changed.set()
            self._drained.clear()
            await self._drained.wait()
        self._full = False
        with spool.usable():
            self._spool.write(piece)

    # --- What is answered ---------------------------------------------------------------------------------------------

    async def _answer(self, send: Send) -> None:
        """Answer what has been set aside, again and again, until all is answered or the client has gone."""
        while not self._gone:
            await self._pause()
            piece = self._spool.read()
            self._drained.set()
            ended = self._whole and not len(self._spool)
            lines = self._splitter.feed(piece) + (self._splitter.rest() if ended else [])
            while lines and not self._gone:
                answers, count = await self._pool.run(self._evaluate, lines[:LINES_AT_ONCE])
                lines = lines[count:]
                await self._send(send, answers)
            if ended:
                return

    async def _pause(self) -> None:
        """Return when there is something to answer, and a moment for it."""
        time = asyncio.get_running_loop().time
        while not (self._whole or self._full or self._gone):
            now, waits = time(), len(self._spool) and not self._told
            if waits and (now - self._arrived >= PAUSE_S or self._is_slow(now)):
                return
            self._changed.clear()
            with suppress(TimeoutError):
                async with asyncio.timeout(PAUSE_S if waits else None):
                    await self._changed.wait()
            await asyncio.sleep(0)  # where the loop was held, what has arrived meanwhile is read first

    def _is_slow(self, now: float) -> bool:
        """True for a client that sends without a pause, and so little that it can be answered meanwhile."""
        return now - self._waiting_since >= PATIENCE_S and len(self._spool) < LITTLE_BYTES

    async def _send(self, send: Send, piece: bytes, *, more: bool = True) -> None:
        if not self._begun:
            await send({"type": "http.response.start", "status": self.status_code, "headers": self.raw_headers})
            self._begun = True
        self._sending = True
        await send({"type": "http.response.body", "body": piece, "more_body": more})
        self._sending = False
        self._progress()

    def _progress(self) -> None:
        self._limit.reschedule(asyncio.get_running_loop().time() + self._seconds)

    async def _give_up(self, send: Send) -> None:
        if self._sending:  # the client does not read; the server cuts the connection
            return
        problem = Problem(408, f"no line arrived for {self._seconds:g} s; the lines above are answered")
        line = orjson.dumps({"reference": None, "status": "error", "problem": problem.body()}) + b"\n"
        await send({"type": "http.response.body", "body": line, "more_body": False})

"""Newline-delimited JSON, streamed in and out at once, in memory that does not grow with the number of lines."""

import asyncio
import tempfile
from collections import deque
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import IO, NamedTuple

import orjson
from starlette.responses import Response
from starlette.types import Message, Receive, Scope, Send

from hpn.web.door.bodies import late
from hpn.web.door.pools import Pool
from hpn.web.door.problems import Problem

MEDIA_TYPES = ("application/x-ndjson", "application/ndjson", "application/jsonl")
LINES_AT_ONCE = 256
MEMORY_BYTES = 512 * 1024
READ_BYTES = 128 * 1024
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
    """First in, first out; what exceeds a little memory waits in a temporary file.

    A client that sends everything before it reads anything, as most do, would otherwise block both sides for good.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self._folder = folder
        self._pieces: deque[bytes] = deque()
        self._in_memory = 0
        self._file: IO[bytes] | None = None
        self._begin = self._end = 0

    def __len__(self) -> int:
        return self._in_memory + self._end - self._begin

    def write(self, piece: bytes) -> None:
        """Add at the end."""
        if not piece:  # what is read as nothing ends the reading
            return
        if self._begin == self._end and self._in_memory + len(piece) <= MEMORY_BYTES:
            self._pieces.append(piece)
            self._in_memory += len(piece)
            return
        self._file = self._file or tempfile.TemporaryFile(buffering=0, dir=self._folder)  # noqa: SIM115
        self._file.seek(self._end)
        self._end += self._file.write(piece)

    def read(self) -> bytes:
        """Take from the front; nothing where nothing is left."""
        if self._pieces:
            piece = self._pieces.popleft()
            self._in_memory -= len(piece)
            return piece
        if self._file is None or self._begin == self._end:
            return b""
        self._file.seek(self._begin)
        piece = self._file.read(min(READ_BYTES, self._end - self._begin))
        self._begin += len(piece)
        if self._begin == self._end:
            self._file.truncate(0)
            self._begin = self._end = 0
        return piece

    def close(self) -> None:
        """Give the file back."""
        if self._file is not None:
            self._file.close()


class LineStream(Response):
    """Answers each line of the request's body with one line, while the body still arrives if its length is unknown.

    A client that neither sends a line nor reads for `seconds` is told so in a last line, and the stream ends.
    """

    media_type = MEDIA_TYPES[0]

    def __init__(
        self,
        evaluate: Evaluate,
        *,
        pool: Pool,
        subject: str,
        maximum_line_bytes: int,
        maximum_spool_bytes: int,
        spool_folder: Path | None = None,
        seconds: float,
    ) -> None:
        self.status_code = 200
        self.background = None
        self.init_headers({"X-Accel-Buffering": "no", "Cache-Control": "no-store"})
        self._evaluate, self._pool, self._subject = evaluate, pool, subject
        self._splitter = LineSplitter(maximum_line_bytes)
        self._maximum_spool = maximum_spool_bytes
        self._seconds = seconds
        self._spool = Spool(spool_folder)
        self._filled, self._drained, self._whole = asyncio.Event(), asyncio.Event(), asyncio.Event()
        self._begun = self._done = self._gone = self._sending = False

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Run both directions until every line is answered, or the client has gone; raises Problem 503 at once."""
        with self._pool.place(self._subject):
            await self._run(scope, receive, send)

    async def _run(self, scope: Scope, receive: Receive, send: Send) -> None:
        try:
            async with asyncio.timeout(self._seconds):
                first = await receive()  # before the head: only asking for the body answers `Expect: 100-continue`
        except TimeoutError:
            raise late(self._seconds) from None
        work = asyncio.create_task(self._work(first, receive))
        try:
            async with asyncio.timeout(self._seconds) as self._limit:
                if any(name == b"content-length" for name, _ in scope.get("headers", ())):
                    # nginx sends no more of a body once its answer has begun and the service has kept it waiting.
                    await self._whole.wait()
                await send({"type": "http.response.start", "status": self.status_code, "headers": self.raw_headers})
                self._begun = True
                await self._forward(send)
            if work.done():
                work.result()  # raises what went wrong; the answer then stays without its end
            await send({"type": "http.response.body", "body": b"", "more_body": False})
        except TimeoutError:
            work.cancel()
            if not self._begun:
                raise late(self._seconds) from None
            await self._give_up(send)
        finally:
            work.cancel()
            await asyncio.gather(work, return_exceptions=True)
            self._spool.close()

    async def _work(self, message: Message, receive: Receive) -> None:
        """Read and evaluate until the body ends, then watch whether the client stays."""
        try:
            while message["type"] == "http.request":
                await self._answer(self._splitter.feed(message.get("body", b"")))
                if not message.get("more_body", False):
                    await self._answer(self._splitter.rest())
                    break
                message = await receive()
        finally:
            self._done = True
            self._filled.set()
            self._whole.set()
        while message["type"] == "http.request":
            message = await receive()
        self._gone = True
        self._filled.set()

    async def _answer(self, lines: Sequence[Line]) -> None:
        done = 0
        while done < len(lines):
            answers, count = await self._pool.run(self._evaluate, lines[done : done + LINES_AT_ONCE])
            done += count
            self._progress()
            while len(self._spool) > self._maximum_spool:
                self._whole.set()
                self._drained.clear()
                await self._drained.wait()
            self._spool.write(answers)
            self._filled.set()

    async def _forward(self, send: Send) -> None:
        while not self._gone:
            piece = self._spool.read()
            if piece:
                self._sending = True
                await send({"type": "http.response.body", "body": piece, "more_body": True})
                self._sending = False
                self._progress()
                self._drained.set()
            elif self._done:
                return
            else:
                self._filled.clear()
                await self._filled.wait()

    def _progress(self) -> None:
        self._limit.reschedule(asyncio.get_running_loop().time() + self._seconds)

    async def _give_up(self, send: Send) -> None:
        if self._sending:  # the client does not read; the server cuts the connection
            return
        problem = Problem(408, f"no line arrived for {self._seconds:g} s; the lines above are answered")
        line = orjson.dumps({"reference": None, "status": "error", "problem": problem.body()}) + b"\n"
        await send({"type": "http.response.body", "body": line, "more_body": False})

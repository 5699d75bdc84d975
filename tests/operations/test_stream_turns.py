"""A stream of lines in both directions at once, by hand: whose turn it is, and how it ends."""

import asyncio
from collections.abc import Awaitable, Callable, Iterable
from functools import partial
from pathlib import Path
from typing import Any

import orjson
import pytest
from starlette.types import Message

from hpn.web.api.streaming import MEMORY_BYTES, SHARES, Line, LineStream
from hpn.web.door.disk import Disk
from hpn.web.door.pools import Places, Pool
from hpn.web.door.problems import Problem


def echo(lines: Iterable[Line]) -> bytes:
    """Answers every line with itself."""
    return b"".join((line.content or b"too long") + b"\n" for line in lines)


class Peer:
    """A client as the server's protocol shows it."""

    def __init__(self) -> None:
        self.incoming: asyncio.Queue[Message] = asyncio.Queue()
        self.reading = asyncio.Event()
        self.reading.set()
        self.outgoing: list[Message] = []
        self.asked = 0

    def send_body(self, body: bytes, *, more: bool = True) -> None:
        """Part of the body."""
        self.incoming.put_nowait({"type": "http.request", "body": body, "more_body": more})

    async def receive(self) -> Message:
        """For the application."""
        self.asked += 1
        return await self.incoming.get()

    async def send(self, message: Message) -> None:
        """For the application."""
        if message["type"] == "http.response.body":
            await self.reading.wait()
        self.outgoing.append(message)

    @property
    def received(self) -> bytes:
        """Body of the answer so far."""
        return b"".join(message.get("body", b"") for message in self.outgoing)

    @property
    def complete(self) -> bool:
        """True once the answer has its end."""
        return bool(self.outgoing) and self.outgoing[-1].get("more_body") is False


def whole(evaluate: Callable[[Any], bytes]) -> Callable[[Any], tuple[bytes, int]]:
    """An evaluator that answers every line that it gets."""
    return lambda lines: (evaluate(lines), len(lines))


def stream(evaluate: Callable[[Any], bytes] = echo, *, spool: int = 10_000_000, seconds: float = 20) -> LineStream:
    """A stream with small limits."""
    pool, disk = Pool(Places(1, 3)), Disk(SHARES * spool)
    return LineStream(whole(evaluate), pool=pool, disk=disk, maximum_line_bytes=100_000, seconds=seconds)


def ends_with(peer: Peer, end: bytes) -> bool:
    """True where this came last."""
    return peer.received.endswith(end)


async def until(condition: Callable[[], bool]) -> None:
    """Wait for something that others do."""
    async with asyncio.timeout(20):
        while not condition():
            await asyncio.sleep(0.005)


def running(response: LineStream, peer: Peer) -> "asyncio.Task[None]":
    """Run a stream."""
    call: Awaitable[None] = response({"type": "http"}, peer.receive, peer.send)
    return asyncio.ensure_future(call)


@pytest.mark.anyio
async def test_a_line_is_answered_before_the_next_one_is_sent() -> None:
    peer = Peer()
    task = running(stream(), peer)
    for number in range(5):
        peer.send_body(b"%d\n" % number)
        await until(partial(ends_with, peer, b"%d\n" % number))
    peer.send_body(b"last", more=False)
    await task

    assert peer.received == b"0\n1\n2\n3\n4\nlast\n"
    assert peer.complete


@pytest.mark.anyio
async def test_a_client_that_sends_everything_before_it_reads_gets_everything() -> None:
    peer, line = Peer(), b"x" * 50_000 + b"\n"
    peer.reading.clear()
    task = running(stream(), peer)
    for _ in range(100):
        peer.send_body(line)
    peer.send_body(b"", more=False)
    await until(lambda: peer.incoming.empty() and peer.asked > 101)
    peer.reading.set()
    await task

    assert peer.received == line * 100
    assert peer.complete


@pytest.mark.anyio
async def test_beyond_the_spool_nothing_more_is_read_until_the_client_reads() -> None:
    peer, line = Peer(), b"x" * 50_000 + b"\n"
    peer.reading.clear()
    task = running(stream(spool=200_000), peer)
    for _ in range(100):
        peer.send_body(line)
    await until(lambda: bool(peer.outgoing))  # the head; its answers find nobody who reads
    asked = peer.asked
    await asyncio.sleep(0.2)
    assert peer.asked == asked < 10

    peer.reading.set()
    peer.send_body(b"", more=False)
    await task
    assert peer.received == line * 100


@pytest.mark.anyio
async def test_lines_that_arrive_without_a_pause_are_set_aside_before_any_is_answered() -> None:
    """nginx passes no more of a body on where it has had to wait for a service whose answer has begun."""
    peer, line = Peer(), b"x" * 50_000 + b"\n"
    task = running(stream(), peer)
    for _ in range(60):
        peer.send_body(line)
        await asyncio.sleep(0.005)
    assert not peer.outgoing
    peer.send_body(b"", more=False)
    await task

    assert peer.received == line * 60


@pytest.mark.anyio
async def test_a_client_that_never_pauses_and_sends_little_is_answered_meanwhile() -> None:
    peer = Peer()
    task = running(stream(), peer)
    for number in range(300):
        peer.send_body(b"%d\n" % number)
        await asyncio.sleep(0.01)
    assert peer.received.count(b"\n") > 50
    peer.send_body(b"", more=False)
    await task

    assert peer.received == b"".join(b"%d\n" % number for number in range(300))


@pytest.mark.anyio
async def test_where_the_disk_is_full_a_stream_is_a_503(tmp_path: Path) -> None:
    peer = Peer()
    full = LineStream(
        whole(echo),
        pool=Pool(Places(1, 3)),
        disk=Disk(10**9),
        maximum_line_bytes=100_000,
        spool_folder=tmp_path / "gone",
        seconds=20,
    )
    peer.send_body(b"x" * 2 * MEMORY_BYTES, more=False)
    with pytest.raises(Problem) as refused:
        await running(full, peer)

    assert refused.value.status_code == 503


@pytest.mark.anyio
@pytest.mark.parametrize("sent", ["part", "everything"])
async def test_work_ends_when_the_client_leaves(sent: str) -> None:
    peer, answered = Peer(), 0

    def count(lines: Any) -> bytes:
        nonlocal answered
        answered += len(lines)
        return echo(lines)

    peer.reading.clear()
    task = running(stream(count), peer)
    peer.send_body(b"1\n", more=sent == "part")
    await until(lambda: answered == 1)
    peer.incoming.put_nowait({"type": "http.disconnect"})
    await until(lambda: peer.incoming.empty())
    peer.reading.set()  # as the server does: what is sent to nobody vanishes
    await asyncio.wait_for(task, 10)

    assert answered == 1


@pytest.mark.anyio
async def test_a_client_that_falls_silent_is_told_so() -> None:
    peer = Peer()
    peer.send_body(b"1\n")
    await running(stream(seconds=0.3), peer)

    first, last = peer.received.splitlines()
    assert first == b"1"
    assert orjson.loads(last)["problem"]["status"] == 408
    assert peer.complete


@pytest.mark.anyio
async def test_a_client_that_never_reads_is_cut_off() -> None:
    peer = Peer()
    peer.reading.clear()
    peer.send_body(b"1\n", more=False)
    await asyncio.wait_for(running(stream(seconds=0.3), peer), 10)

    assert not peer.complete


@pytest.mark.anyio
async def test_a_mistake_of_ours_is_raised_and_leaves_the_answer_without_its_end() -> None:
    def fail(lines: Any) -> bytes:
        raise RuntimeError("mistake")

    peer = Peer()
    peer.send_body(b"1\n", more=False)
    with pytest.raises(RuntimeError, match="mistake"):
        await running(stream(fail), peer)

    assert not peer.complete

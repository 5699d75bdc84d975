"""Batches as newline-delimited JSON: the same answers, line by line, while the body still arrives."""

import asyncio
import json
from collections.abc import Awaitable, Callable, Iterable
from functools import partial
from pathlib import Path
from typing import Any

import orjson
import pytest
from hypothesis import given
from hypothesis import strategies as st
from starlette.types import Message

from hpn.catalogue import Catalogue
from hpn.web.api import batch
from hpn.web.api.batch import batch_lines, line_evaluator
from hpn.web.api.replies import encode
from hpn.web.api.streaming import MEMORY_BYTES, SHARES, Line, LineSplitter, LineStream, Spool
from hpn.web.door.disk import Disk, Share
from hpn.web.door.metrics import Metrics
from hpn.web.door.pools import Places, Pool
from hpn.web.door.problems import Problem
from tests.build import worked_example
from tests.operations.conftest import MakeClient
from tests.operations.proxy import proxied
from tests.operations.service import Service
from tests.operations.streamed import peaks_MB

PATH = "/api/v1/select/batch"
NDJSON = {"Content-Type": "application/x-ndjson"}
ITEMS: list[Any] = [
    {"reference": "axis-1", **worked_example()},
    {"reference": "axis-2"},
    {"reference": "axis-3", **worked_example(requirements={"ratios": [6]})},
    {"reference": 4, **worked_example()},
    [1, 2],
    {"reference": "axis-ü", **worked_example(requirements={"ratios": [5]})},
]
LINES = [Line(number, orjson.dumps(item)) for number, item in enumerate(ITEMS, start=1)]


def lines_of(content: bytes) -> list[Any]:
    """Result lines."""
    assert content.endswith(b"\n") or not content
    return [json.loads(line) for line in content.splitlines()]


def named(results: list[Any]) -> list[Any]:
    """Results of the JSON form as the stream gives them: a problem without a reference names the line."""
    for number, result in enumerate(results, start=1):
        if "problem" in result and result["reference"] is None:
            result["problem"]["detail"] = f"line {number}: {result['problem']['detail']}"
    return results


def test_lines_are_answered_in_order_as_the_json_form_answers_them(make_client: MakeClient) -> None:
    client = make_client()
    body = "\n".join(json.dumps(item) for item in ITEMS)

    streamed = client.post(PATH, content=body.encode(), headers=NDJSON)
    whole = client.post(PATH, json={"applications": ITEMS})

    assert streamed.status_code == 200
    assert streamed.headers["Content-Type"] == "application/x-ndjson"
    assert "Content-Encoding" not in streamed.headers  # a packer would hold lines back
    assert lines_of(streamed.content) == named(whole.json()["results"])
    assert [line["status"] for line in lines_of(streamed.content)] == ["ok", "error", "error", "error", "error", "ok"]


@pytest.mark.parametrize("end", [b"", b"\n", b"\r\n", b"\n\n \n"])
@pytest.mark.parametrize("between", [b"\n", b"\r\n", b"\n\n\t\n"])
def test_line_ends_of_any_kind_and_blank_lines_make_no_difference(
    between: bytes, end: bytes, make_client: MakeClient
) -> None:
    one = orjson.dumps(ITEMS[-1])

    response = make_client().post(PATH, content=b"\xef\xbb\xbf" + one + between + one + end, headers=NDJSON)

    assert [line["selected"] for line in lines_of(response.content)] == ["HPN-20A-5"] * 2


def test_no_line_gives_no_line(make_client: MakeClient) -> None:
    assert make_client().post(PATH, content=b"\n", headers=NDJSON).content == b""


@pytest.mark.parametrize(
    ("line", "status"),
    [(b"{", 400), (b"\xff", 400), (b"NaN", 422), (b"null", 422), (b"[" * 5000, 400), (b'"' + b"a" * 3000 + b'"', 413)],
)
def test_a_bad_line_gets_its_problem_and_its_neighbours_their_answers(
    line: bytes, status: int, make_client: MakeClient
) -> None:
    good = orjson.dumps(ITEMS[0])
    client = make_client(maximum_body_bytes=2000 if status == 413 else 2_000_000)

    before, bad, after = lines_of(client.post(PATH, content=good + b"\n" + line + b"\n" + good, headers=NDJSON).content)

    assert bad["reference"] is None
    assert bad["problem"]["status"] == status
    assert before["status"] == after["status"] == "ok"


def test_a_problem_without_a_reference_names_its_line_and_blank_lines_count(make_client: MakeClient) -> None:
    lines = [
        orjson.dumps(ITEMS[0]),
        b"",
        b"not json",
        b"5",
        orjson.dumps({"reference": 5, **worked_example()}),
        orjson.dumps({"reference": "axis-2"}),
        b'"' + b"a" * 3000 + b'"',
    ]
    client = make_client(maximum_body_bytes=2000)

    results = lines_of(client.post(PATH, content=b"\r\n".join(lines), headers=NDJSON).content)

    assert [result["problem"]["detail"] for result in results[1:]] == [
        "line 3: is not JSON: expected ident at column 2",
        "line 4: must be an object",
        "line 5: /reference: must be text",
        "/duty_cycle: is required",
        "line 7: a line may have 2000 bytes at most",
    ]
    assert [result["reference"] for result in results] == ["axis-1", None, None, None, "axis-2", None]


def test_more_lines_than_the_json_form_takes(make_client: MakeClient) -> None:
    client = make_client(maximum_batch_count=3)

    assert len(lines_of(client.post(PATH, content=b"{}\n" * 1000, headers=NDJSON).content)) == 1000


def test_another_content_type_is_a_415(make_client: MakeClient) -> None:
    reply = make_client().post(PATH, content=b"{}", headers={"Content-Type": "text/csv"})

    assert reply.status_code == 415
    assert "as application/json or application/x-ndjson (" in reply.json()["detail"]


@given(st.lists(st.sampled_from([b"abc", b"", b" ", b"x" * 8, b"x" * 9, b"y" * 40, b"\r"])), st.integers(1, 20))
def test_cutting_does_not_depend_on_how_the_body_is_cut(parts: list[bytes], size: int) -> None:
    body = b"\n".join(parts)
    splitter = LineSplitter(8)

    lines: list[Line] = []
    for start in range(0, len(body), size):
        lines += splitter.feed(body[start : start + size])
    lines += splitter.rest()

    assert lines == [
        Line(number, None if len(part) > 8 else part.strip())
        for number, part in enumerate(parts, start=1)
        if len(part) > 8 or part.strip()
    ]


@given(st.lists(st.integers(0, MEMORY_BYTES) | st.just(-1), max_size=30))
def test_the_spool_gives_back_what_it_got_in_order(steps: list[int]) -> None:
    disk, expected, got = Disk(10**9), b"", b""
    share = Share(disk)
    spool = Spool(share, 10**9)
    for number, size in enumerate(steps):
        if size >= 0:
            piece = bytes([number]) * size
            spool.write(piece)
            expected += piece
        else:
            got += spool.read()
        assert len(spool) == len(expected) - len(got)
    while piece := spool.read():
        got += piece
    spool.close()

    assert got == expected
    assert disk.taken == 0


def test_twenty_times_the_lines_take_no_more_memory_on_either_side(service: Service) -> None:
    peaks_MB(service.process.pid, service.port, 1_000)
    few, many = (peaks_MB(service.process.pid, service.port, count) for count in (1_000, 20_000))

    # held in memory, the answers alone would be 5 MB, and as Python objects several times that
    assert many[0] - few[0] < 5
    assert many[1] - few[1] < 2


@pytest.mark.parametrize("front", ["alone", "nginx"])
def test_a_client_that_sends_all_before_it_reads_gets_all(front: str, service: Service, soak: bool) -> None:
    count = 300_000 if soak else 50_000  # of either, answers and lines are more than sockets hold
    with proxied(service.port) as proxy:
        where = (proxy.https, count, proxy.folder / "fullchain.pem") if front == "nginx" else (service.port, count)
        peaks = peaks_MB(service.process.pid, *where)
    print(f"{front}: {peaks[0]:.0f} MB of the service, {peaks[1]:.0f} MB of the client")

    assert peaks[0] < 400


# --- Both directions at once, by hand ---------------------------------------------------------------------------------


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


def test_the_evaluator_gives_the_lines_of_the_json_form(catalogue: Catalogue) -> None:
    answers, count = line_evaluator(catalogue, Metrics(), 100)(LINES)

    assert count == len(ITEMS)
    assert lines_of(answers) == named(json.loads(encode(batch_lines(ITEMS, catalogue))))


def test_a_slice_ends_when_its_time_is_up(catalogue: Catalogue, monkeypatch: pytest.MonkeyPatch) -> None:
    whole, _ = line_evaluator(catalogue, Metrics(), 100)(lines := LINES)
    monkeypatch.setattr(batch, "SLICE_SECONDS", 0)
    answers, counts = [], []
    while lines:
        answer, count = line_evaluator(catalogue, Metrics(), 100)(lines)
        answers.append(answer)
        counts.append(count)
        lines = lines[count:]

    assert b"".join(answers) == whole
    assert counts == [1] * len(ITEMS)

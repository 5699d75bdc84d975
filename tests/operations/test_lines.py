"""Batches as newline-delimited JSON: the same answers, line by line, once the body is in."""

import asyncio
import io
import json
from pathlib import Path
from typing import Any

import orjson
import pytest
from starlette.testclient import TestClient
from starlette.types import Message

from hpn.web.api import batch
from hpn.web.api.batch import MEMORY_BYTES, items_of_lines
from hpn.web.door.problems import Problem
from tests.build import worked_example
from tests.operations.conftest import MakeClient
from tests.operations.lines import peaks_MB
from tests.operations.proxy import proxied
from tests.operations.service import Service
from tests.state import state_of

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
BODY = b"".join(orjson.dumps(item) + b"\n" for item in ITEMS)


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
        "line 7: an application may have 2000 bytes at most",
    ]
    assert [result["reference"] for result in results] == ["axis-1", None, None, None, "axis-2", None]


def test_more_lines_than_the_json_form_takes(make_client: MakeClient) -> None:
    client = make_client(maximum_batch_count=3)

    assert len(lines_of(client.post(PATH, content=b"{}\n" * 1000, headers=NDJSON).content)) == 1000


def test_another_content_type_is_a_415(make_client: MakeClient) -> None:
    reply = make_client().post(PATH, content=b"{}", headers={"Content-Type": "text/csv"})

    assert reply.status_code == 415
    assert "as application/json or application/x-ndjson (" in reply.json()["detail"]


@pytest.mark.parametrize("size", [8, 9, 10, 11, 40])
def test_a_line_too_long_ends_at_its_own_end(size: int) -> None:
    body = b"\n".join([b"x" * size, b"5", b"", b"y" * size])
    items = list(items_of_lines(io.BytesIO(body), 8))

    assert [item and item.line for item in items] == [1, 2, None, 4]
    status = 400 if size == 8 else 413
    refused = [item.content for item in items if item]
    assert [isinstance(one, Problem) and one.status_code for one in refused] == [status, 422, status]


def test_twenty_times_the_lines_take_no_more_memory_on_either_side(service: Service) -> None:
    peaks_MB(service.process.pid, service.port, 1_000)
    few, many = (peaks_MB(service.process.pid, service.port, count) for count in (1_000, 20_000))

    # held in memory, the answers alone would be 5 MB, and as Python objects several times that
    assert many[0] - few[0] < 5
    assert many[1] - few[1] < 2


@pytest.mark.parametrize("front", [pytest.param("alone", marks=pytest.mark.soak), "nginx"])
def test_a_client_that_sends_all_before_it_reads_gets_all(front: str, service: Service, soak: bool) -> None:
    count = 300_000 if soak else 50_000  # of either, answers and lines are more than sockets hold
    with proxied(service.port) as proxy:
        where = (proxy.https, count, proxy.folder / "fullchain.pem") if front == "nginx" else (service.port, count)
        peaks = peaks_MB(service.process.pid, *where)
    print(f"{front}: {peaks[0]:.0f} MB of the service, {peaks[1]:.0f} MB of the client")

    assert peaks[0] < 400


def test_slices_that_end_early_answer_the_same(make_client: MakeClient, monkeypatch: pytest.MonkeyPatch) -> None:
    client, body = make_client(), b"\n\n" + BODY.replace(b"\n", b"\n\n")
    whole = client.post(PATH, content=body, headers=NDJSON).content
    monkeypatch.setattr(batch, "SLICE_SECONDS", 0)

    assert client.post(PATH, content=body, headers=NDJSON).content == whole
    assert len(lines_of(whole)) == len(ITEMS)


# --- Bounds -----------------------------------------------------------------------------------------------------------


def test_a_body_beyond_its_share_of_the_disk_is_refused_and_all_is_given_back(make_client: MakeClient) -> None:
    client = make_client(maximum_spool_bytes=7 * len(BODY))

    answers = [client.post(PATH, content=content, headers=NDJSON) for content in (BODY, BODY + b" ", BODY)]

    assert [answer.status_code for answer in answers] == [200, 413, 200]
    assert state_of(client).disk.in_use == 0


def test_where_the_disk_is_full_lines_are_a_503(make_client: MakeClient, tmp_path: Path) -> None:
    (folder := tmp_path / "spool").mkdir()
    client = make_client(spool_folder=folder)
    folder.rmdir()

    assert client.post(PATH, content=b" " * 2 * MEMORY_BYTES, headers=NDJSON).status_code == 503


class Peer:
    """A client as the server's protocol shows it, which has sent a body."""

    def __init__(self, body: bytes, *, reads: bool = True) -> None:
        self._incoming: asyncio.Queue[Message] = asyncio.Queue()
        self._incoming.put_nowait({"type": "http.request", "body": body, "more_body": False})
        self._reads, self.sent = reads, list[Message]()

    def leave(self) -> None:
        """Hang up."""
        self._incoming.put_nowait({"type": "http.disconnect"})

    async def send(self, message: Message) -> None:
        """For the application."""
        self.sent.append(message)
        while message.get("body") and not self._reads:
            await asyncio.sleep(60)

    async def ask(self, client: TestClient) -> None:
        """Have the application answer."""
        headers = [(b"content-type", b"application/x-ndjson"), (b"host", b"testserver")]
        scope = {"type": "http", "method": "POST", "path": PATH, "raw_path": PATH.encode(), "headers": headers}
        more = {"query_string": b"", "client": ("127.0.0.1", 5), "server": ("testserver", 80), "scheme": "http"}
        await client.app({**scope, **more, "http_version": "1.1"}, self._incoming.get, self.send)


@pytest.mark.anyio
async def test_a_client_that_never_reads_is_cut_off(make_client: MakeClient) -> None:
    client, peer = make_client(body_seconds=0.3), Peer(BODY, reads=False)
    await asyncio.wait_for(peer.ask(client), 20)

    assert peer.sent[-1]["more_body"]  # so that the server ends the connection
    assert state_of(client).disk.in_use == state_of(client).pools["batches"].in_use == 0


@pytest.mark.anyio
async def test_work_ends_when_the_client_leaves(make_client: MakeClient, monkeypatch: pytest.MonkeyPatch) -> None:
    client, peer = make_client(), Peer(b"{}\n" * 200_000)
    question = asyncio.ensure_future(peer.ask(client))
    while not peer.sent:
        await asyncio.sleep(0.01)
    peer.leave()
    await asyncio.wait_for(question, 20)

    assert peer.sent[-1]["more_body"]
    assert state_of(client).disk.in_use == state_of(client).pools["batches"].in_use == 0


@pytest.mark.anyio
async def test_a_mistake_of_ours_leaves_the_answer_without_its_end(
    make_client: MakeClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*arguments: Any) -> bytes:
        raise RuntimeError("mistake")

    client, peer = make_client(), Peer(BODY)
    monkeypatch.setattr(batch, "judge_batch", fail)
    await peer.ask(client)

    assert [message["type"] for message in peer.sent] == ["http.response.start"]
    assert state_of(client).disk.in_use == 0

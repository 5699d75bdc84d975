"""Batches as newline-delimited JSON: the same answers, line by line, while the body still arrives."""

import json
from typing import Any

import orjson
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hpn.catalogue import Catalogue
from hpn.web.api import batch
from hpn.web.api.batch import batch_lines, line_evaluator
from hpn.web.api.replies import encode
from hpn.web.api.streaming import MEMORY_BYTES, Line, LineSplitter, Spool
from hpn.web.door.disk import Disk, Share
from hpn.web.door.metrics import Metrics
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

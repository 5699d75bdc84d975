"""A file of some kilobytes ends nothing: whatever it stands for, others get their pages and selections meanwhile.

The files are those of `tests/fuzz/costly.py`. The service runs in a control group of 768 MB where one can be made.
"""

import threading
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.build import cycle, phase
from tests.fleet.test_api import TYPES
from tests.fuzz.costly import FILES, OBJECTS, TEXTS, WORKBOOKS, made, name_of
from tests.operations.service import Service, children_of, serving, until
from tests.operations.test_serving import ticks
from tests.reliability.test_memory import LIMIT_BYTES, limited, peak_MB

SETTINGS = {"HPN_LOG_LEVEL": "warning"}
REPORTED = (
    *("a cell in the last row of 20 sheets", "1,500,000 formats", "fonts", "rich texts", "shared strings"),
    *("empty rows", "empty cells", "merged cells"),
    *("Arrow of 20 columns and 10⁷ rows", "Parquet of 10⁸ rows", "Parquet with a long text"),
    *("14,000 rows, each with a key of its own", "Arrow with an axis of 3·10⁸ characters"),
)
"""Files that ended the service, or kept it from answering, in November 2026."""

OF_CELLS = (
    *("a workbook of brackets", "a workbook of a digit, blanks and a letter", "a heading of 95,000 brackets"),
    *("a ratio of blanks", "gzip of 131,000 brackets", "Parquet with ratios of blanks"),
)
"""Files whose cells did so once they were read."""

GZIP = "application/gzip"
MOST_ANSWER = 2_000_000
"""Bytes of any answer to such a file."""

LONGEST_WAIT_S = 5.0
"""Of the other caller: a request takes 10 ms, and other tests take their part of the machine."""


PAUSE_S = 0.2
"""Between its turns: whatever keeps it waiting for too long is met by one of them, and the machine is for the files."""


@contextmanager
def another_caller(service: Service) -> Iterator[list[float]]:
    """Somebody who asks for the page, a selection and a sign of life all the while, and how long each answer took."""
    waits: list[float] = []
    ended = threading.Event()

    def ask() -> None:
        with httpx.Client(base_url=service.url, timeout=120, trust_env=False) as client:
            while not ended.is_set():
                for method, path in (("GET", "/"), ("POST", "/api/v1/select"), ("GET", "/healthz")):
                    start = time.monotonic()
                    asked = cycle(phase(40, 250)) if method == "POST" else None
                    status = client.request(method, path, json=asked).status_code
                    waits.append(time.monotonic() - start if status == 200 else 1000.0 + status)
                time.sleep(PAUSE_S)

    thread = threading.Thread(target=ask)
    thread.start()
    try:
        yield waits
    finally:
        ended.set()
        thread.join()


def sent(name: str, content: bytes) -> Iterator[tuple[str, dict[str, Any]]]:
    """Path and arguments of each request that a file is sent with."""
    file = {"files": {"file": (name_of(name), content)}}
    yield "/paste", file
    yield "/machines", file
    if name not in WORKBOOKS:
        yield (
            "/api/v1/fleet",
            {"content": content, "headers": {"Content-Type": TYPES.get(Path(name_of(name)).suffix, GZIP)}},
        )


def test_no_file_keeps_another_caller_waiting_or_ends_the_service(
    tmp_path: Path, soak: bool, record_property: Any
) -> None:
    names = list(FILES) if soak else [*REPORTED, *OF_CELLS]
    answers: dict[str, str] = {}
    with limited(tmp_path) as (program, kind), serving(tmp_path, SETTINGS, program=program) as service:
        with another_caller(service) as waits:
            for name in names:
                content = made(name)
                for path, arguments in sent(name, content):
                    start = time.monotonic()
                    reply = service.client.post(path, timeout=400, **arguments)
                    answers[f"{name} at {path}"] = f"{reply.status_code} after {time.monotonic() - start:.1f} s"
                    assert reply.status_code in (200, 303, 413, 422), (name, path, reply.text[-500:])
                    assert len(reply.content) < MOST_ANSWER, (name, path)
        peak = peak_MB(service)
        assert service.process.poll() is None
        errors = [event for event in service.events() if event["level"] == "error"]
    slowest = sorted(answers.items(), key=lambda answer: float(answer[1].split()[2]))[-5:]
    record_property("peak_MB", peak)
    print(
        f"{peak:.0f} MB at most, {kind}; longest wait {max(waits):.2f} s of {len(waits)} requests; slowest: {slowest}"
    )

    assert max(waits) < LONGEST_WAIT_S
    assert peak * 2**20 < LIMIT_BYTES / 2
    assert errors == []


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service whose memory is not looked at."""
    with serving(tmp_path_factory.mktemp("service"), SETTINGS) as running:
        yield running


@pytest.mark.parametrize("path", ["/paste", "/machines"])
def test_callers_who_leave_leave_no_process_at_work(path: str, service: Service) -> None:
    content = made("elements in one another")  # ten seconds of work
    with another_caller(service) as waits:
        for _ in range(3):
            with pytest.raises(httpx.TimeoutException):
                service.client.post(path, files={"file": ("a.xlsx", content)}, timeout=1)
        until(lambda: not at_work(service))
        assert service.client.post(path, files={"file": ("a.csv", b"T;n;t\n1;2;3\n")}).status_code in (200, 422)
    assert max(waits) < LONGEST_WAIT_S


def at_work(service: Service) -> list[int]:
    """Processes beside the service that take processor time."""
    before = {child: ticks(child) for child in children_of(service.process.pid)}
    time.sleep(0.3)
    return [child for child in children_of(service.process.pid) if ticks(child) > before.get(child, 0) + 2]


def test_many_files_at_once_are_read_one_by_one_and_the_rest_is_asked_to_come_again(service: Service) -> None:
    content = made("twenty wide sheets")  # half a second of work
    statuses: Counter[int] = Counter()

    def send() -> None:
        with httpx.Client(base_url=service.url, timeout=300, trust_env=False) as client:
            reply = client.post("/paste", files={"file": ("a.xlsx", content)})
        statuses[reply.status_code] += 1
        assert reply.status_code != 503 or int(reply.headers["Retry-After"]) > 0

    with another_caller(service) as waits:
        threads = [threading.Thread(target=send) for _ in range(12)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert len(children_of(service.process.pid)) <= 1
    assert set(statuses) == {200, 503} and statuses[503] >= 4  # there are eight places
    assert max(waits) < LONGEST_WAIT_S


def test_texts_and_objects_of_the_largest_size_keep_nobody_waiting(tmp_path: Path, soak: bool) -> None:
    """Content that can't be packed costs its own size: 2 MB of it, as much as a page takes."""
    names = [*TEXTS, *OBJECTS] if soak else ["blanks", "rows of three readings", "phases without anything"]
    with serving(tmp_path, SETTINGS) as service, another_caller(service) as waits:
        for name in names:
            content = made(name)
            text = (content * (1_900_000 // len(content))).decode(errors="replace")
            for path in ("/paste", "/machines"):
                reply = service.client.post(path, data={"text": text}, timeout=400)
                assert reply.status_code in (200, 303, 413, 422), (name, path)
        assert peak_MB(service) * 2**20 < LIMIT_BYTES
    assert max(waits) < LONGEST_WAIT_S

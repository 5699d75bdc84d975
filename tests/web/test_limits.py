"""Limits of size and time have clear answers, and an internal error is a problem, too."""

import asyncio
from typing import Any

import orjson
import pytest
from fastapi import FastAPI
from starlette.testclient import TestClient
from starlette.types import Message, Scope

from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.build import cycle, phase

SMALL = orjson.dumps(cycle(phase(1, 1)))
JSON = {"content-type": "application/json"}
PATHS = ("/api/v1/select", "/api/v1/select/batch")


@pytest.fixture(scope="module")
def tight() -> FastAPI:
    """Service that accepts 1000 bytes within a twentieth of a second."""
    return create_app(Settings(maximum_body_bytes=1000, maximum_batch_body_bytes=1000, body_seconds=0.05))


@pytest.mark.parametrize("path", PATHS)
def test_a_body_that_is_too_long_is_a_413_that_names_the_limit(tight: FastAPI, path: str) -> None:
    client = TestClient(tight)

    by_length = client.post(path, content=b" " * 1001, headers=JSON)
    in_chunks = client.post(path, content=iter([b" " * 600, b" " * 600]), headers=JSON)

    for reply in (by_length, in_chunks):
        assert reply.status_code == 413
        assert reply.headers["content-type"] == "application/problem+json"
        assert "1000" in reply.json()["detail"]


def test_a_body_of_exactly_the_limit_is_read(tight: FastAPI) -> None:
    body = SMALL + b" " * (1000 - len(SMALL))

    assert TestClient(tight).post(PATHS[0], content=body, headers=JSON).status_code == 200


def call(app: FastAPI, path: str, messages: list[Message], headers: list[tuple[bytes, bytes]]) -> tuple[int, bytes]:
    """Status and body of a request, passed on as by a server; nothing arrives after the last message."""
    sent: list[Message] = []
    waiting = iter(messages)

    async def receive() -> Message:
        for message in waiting:
            return message
        await asyncio.sleep(30)
        raise AssertionError("the service waited for a body that never came")

    async def send(message: Message) -> None:
        sent.append(message)

    scope: Scope = {
        "type": "http",
        "http_version": "1.1",
        "method": "POST",
        "scheme": "http",
        "path": path,
        "raw_path": path.encode(),
        "query_string": b"",
        "root_path": "",
        "headers": headers,
        "client": ("127.0.0.1", 1),
        "server": ("127.0.0.1", 80),
        "state": {},
    }
    asyncio.run(app(scope, receive, send))
    return sent[0]["status"], b"".join(message.get("body", b"") for message in sent[1:])


PART: Message = {"type": "http.request", "body": b"{", "more_body": True}


@pytest.mark.parametrize("parts", [[], [PART]])
@pytest.mark.parametrize("path", PATHS)
def test_a_body_that_does_not_arrive_in_time_is_a_408(tight: FastAPI, path: str, parts: list[Message]) -> None:
    status, body = call(tight, path, parts, [(b"content-type", b"application/json")])

    assert status == 408
    assert "0.05 s" in orjson.loads(body)["detail"]


def test_a_stream_whose_first_line_does_not_arrive_in_time_is_a_408(tight: FastAPI) -> None:
    assert call(tight, PATHS[1], [], [(b"content-type", b"application/x-ndjson")])[0] == 408


def test_a_client_that_goes_away_ends_the_request_quietly(tight: FastAPI) -> None:
    status, _ = call(tight, PATHS[0], [PART, {"type": "http.disconnect"}], [(b"content-type", b"application/json")])

    assert status == 400


@pytest.mark.parametrize("length", ["-5", "many", "9" * 50, "\N{SUPERSCRIPT TWO}"])
def test_a_strange_content_length_never_breaks_the_service(tight: FastAPI, length: str) -> None:
    whole: Message = {"type": "http.request", "body": SMALL, "more_body": False}
    headers = [(b"content-type", b"application/json"), (b"content-length", length.encode("latin-1"))]

    status, _ = call(tight, PATHS[0], [whole], headers)

    assert status in (200, 413)


def test_a_mistake_of_the_service_is_a_problem_without_a_trace(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*arguments: Any) -> Any:
        raise RuntimeError("secret detail")

    monkeypatch.setattr("hpn.web.api.select.select", broken)
    client = TestClient(create_app(), raise_server_exceptions=False)

    reply = client.post(PATHS[0], content=SMALL, headers=JSON)

    assert reply.status_code == 500
    assert reply.headers["content-type"] == "application/problem+json"
    assert "secret" not in reply.text
    assert "Traceback" not in reply.text
    assert reply.headers["x-content-type-options"] == "nosniff"


def test_requests_at_once_get_their_own_answers(api: TestClient, soak: bool) -> None:
    """Hundreds of restrictions through eight threads; each has its own candidates."""
    from concurrent.futures import ThreadPoolExecutor

    ratios = [3, 4, 5, 7, 10, 15, 20, 25, 30, 35]
    wishes = [[r for k, r in enumerate(ratios) if mask >> k & 1] for mask in range(1, 1024 if soak else 150)]

    def ask(wish: list[int]) -> set[int]:
        item = cycle(phase(1, 1), requirements={"ratios": wish})
        reply = api.post("/api/v1/select", json=item)
        assert reply.status_code == 200
        return {candidate["ratio"] for candidate in reply.json()["candidates"]}

    with ThreadPoolExecutor(8) as threads:
        assert list(threads.map(ask, wishes)) == [set(wish) for wish in wishes]

"""A change that sizes many axes again: counted on the way, and given up without a trace where nobody waits for it."""

import asyncio
import json
import threading
from collections.abc import Iterator
from typing import Any
from urllib.parse import urlencode

import pytest
from fastapi import FastAPI
from starlette.testclient import TestClient

from hpn.catalogue import Catalogue
from hpn.documents.answers import AxisQuestion, answers
from hpn.documents.merge import resolve
from hpn.web import long_work
from hpn.web.long_work import EVENTS, GivenUpError, WorkProgress, answers_in_steps
from tests.fleet.test_common_tolerances import form
from tests.fleet.test_machine_changes import kept, past_of, send
from tests.fleet.test_machine_page import BELT, text_of

AXES = 25


@pytest.fixture(autouse=True)
def short_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps of four axes."""
    monkeypatch.setattr(long_work, "STEP", 4)


@pytest.fixture
def machine(client: TestClient) -> str:
    """Address of a machine of 25 axes."""
    axes = [{"name": f"A{k}", "application": BELT} for k in range(AXES)]
    return str(client.post("/api/v1/machines", json={"title": "Line", "axes": axes}).json()["url"])


def events(client: TestClient, machine: str, *pairs: tuple[str, str]) -> list[Any]:
    """Events of the answer to the form, in their order."""
    headers = {"Content-Type": "application/x-www-form-urlencoded", "Accept": f"{EVENTS}, text/html"}
    answer = client.post(f"{machine}/change", content=urlencode(pairs), headers=headers)
    assert answer.status_code == 200 and answer.headers["content-type"].startswith(EVENTS)
    return [json.loads(event.removeprefix("data: ")) for event in answer.text.split("\n\n")[:-1]]


def test_the_count_ends_with_the_page_that_a_plain_form_gets(client: TestClient, machine: str) -> None:
    fields = {**form(client, machine), "u": "0.5"}

    *counts, last = events(client, machine, *fields.items(), ("do", "apply"))

    assert all(0 <= each["done"] <= each["of"] <= AXES for each in counts)
    assert last["status"] == 200 and "Changed." in last["page"]
    assert kept(client, machine)["common"]["requirements"] == {"utilisation": 0.5}
    assert "Undone." in send(client, machine, ("do", "undo"), past=past_of(last["page"])).text
    (*_, wrong) = events(client, machine, *{**form(client, machine), "u": "x"}.items(), ("do", "apply"))
    assert wrong["status"] == 422 and "common" in kept(client, machine)
    (*_, past) = events(client, machine, ("do", "undo"), ("past", "%"))
    assert past["status"] == 422 and "past is not what this page has given" in text_of(past["page"])


def test_answers_in_steps_are_those_of_all_together(catalogue: Catalogue) -> None:
    """1e-12 is the rounding of sums whose order a batch may change."""
    axes = [
        {"duty_cycle": {"phases": [{"torque_Nm": 2.0 + k, "speed_rpm": 150, "duration_s": 0.3}]}} for k in range(11)
    ]
    questions = [AxisQuestion(resolve(axis, {})) for axis in axes]

    stepped, whole = answers_in_steps(iter(questions), len(questions), catalogue), answers(questions, catalogue)

    assert [each.designation for each in stepped] == [each.designation for each in whole]
    assert [each.utilisation for each in stepped] == pytest.approx([each.utilisation for each in whole], rel=1e-12)


def test_work_that_is_given_up_ends_at_its_next_step(catalogue: Catalogue, monkeypatch: pytest.MonkeyPatch) -> None:
    progress, case = WorkProgress(), list[int]()

    def questions() -> Iterator[AxisQuestion]:
        for k in range(100):
            case.append(k)
            if k == 5:
                progress.give_up()
            yield AxisQuestion(resolve(BELT, {}))

    token = long_work._PROGRESS.set(progress)
    try:
        with pytest.raises(GivenUpError):
            answers_in_steps(questions(), 100, catalogue)
    finally:
        long_work._PROGRESS.reset(token)

    assert len(case) < 20 and progress.done < progress.of == 100


@pytest.mark.parametrize("counted", [True, False])
def test_a_change_whose_client_leaves_changes_nothing(
    service: FastAPI, client: TestClient, machine: str, monkeypatch: pytest.MonkeyPatch, counted: bool
) -> None:
    """The client leaves while the axes are sized: the transaction is never begun, and the place is free again."""
    before = kept(client, machine)
    fields = {**form(client, machine), "u": "0.5", "do": "apply"}
    begun, go_on = threading.Event(), threading.Event()

    def slow(*arguments: Any) -> Any:
        begun.set()
        go_on.wait(20)
        return answers(*arguments)

    monkeypatch.setattr(long_work, "answers", slow)

    async def visit() -> None:
        sent = [{"type": "http.request", "body": urlencode(fields).encode(), "more_body": False}]

        async def receive() -> Any:
            if sent:
                return sent.pop(0)
            await asyncio.to_thread(begun.wait, 20)
            return {"type": "http.disconnect"}

        async def take(message: Any) -> None:
            """Takes nothing."""

        accept = EVENTS if counted else "text/html"
        headers = [
            (b"host", b"testserver"),
            (b"accept", accept.encode()),
            (b"content-type", b"application/x-www-form-urlencoded"),
        ]
        scope = {
            "type": "http",
            "asgi": {"version": "3.0", "spec_version": "2.3"},
            "http_version": "1.1",
            "method": "POST",
            "scheme": "http",
            "path": f"{machine}/change",
            "raw_path": f"{machine}/change".encode(),
            "query_string": b"",
            "root_path": "",
            "headers": headers,
            "client": ("127.0.0.1", 5),
            "server": ("testserver", 80),
        }
        await service(scope, receive, take)

    assert client.portal is not None
    client.portal.call(visit)
    go_on.set()
    monkeypatch.setattr(long_work, "answers", answers)

    assert kept(client, machine) == before
    again = send(client, machine, *fields.items())
    assert again.status_code == 200 and kept(client, machine)["common"]["requirements"] == {"utilisation": 0.5}

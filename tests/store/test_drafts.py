"""Records of saved applications: the very reply of `select` and the inputs as given, whoever saves beside."""

import random
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import pytest
from starlette.testclient import TestClient

from hpn.application import Application, InputError
from hpn.engine.selection import encode, select
from hpn.links.writer import to_link
from hpn.web.app import create_app
from hpn.web.archive import Labels, draft_of
from hpn.web.door.pools import SMALL_BYTES
from hpn.web.settings import Settings
from tests.build import Json, cycle, phase
from tests.conftest import Supplement
from tests.property.draw import at_random
from tests.store.test_catalogues import SUPPLEMENT

MODELS = ("linear", "iso281", "digitised")


@pytest.fixture
def client(ready_database: str) -> Iterator[TestClient]:
    """A client of a running service."""
    with TestClient(create_app(Settings(database_url=ready_database, database_seconds=60))) as client:
        yield client


def test_a_draft_has_the_reply_of_its_own_application(supplemented: Supplement) -> None:
    """With curves, efficiencies, cycles of 1 to 300 phases, and some that are refused."""
    catalogue = supplemented(**SUPPLEMENT)
    values = [at_random(random.Random(seed), MODELS) for seed in range(100)]
    values += [cycle(*[phase(10 + k, 100)] * 300) for k in range(3)]
    refused = 0
    for number, parts in enumerate(values):
        application = Application.model_validate(parts)
        try:
            reply = encode(select(application, catalogue, to_link))
        except InputError:
            with pytest.raises(InputError):
                draft_of(catalogue, application, Labels(), None)
            refused += 1
            continue
        draft = draft_of(catalogue, application, Labels(title=f"axis {number}"), "key")
        assert (draft.result, draft.title, draft.idempotency_key) == (reply, f"axis {number}", "key")
        assert Application.model_validate_json(draft.application) == application
    assert refused < 50


def test_savers_at_once_each_find_their_own(client: TestClient) -> None:
    """Short cycles and long ones, which are computed in another thread, some under one key and some refused."""

    def body(number: int) -> Json:
        phases = [phase(1 + number / 10, 100)] * (SMALL_BYTES // 40 if number % 8 == 0 else 1 + number % 5)
        wishes = {"ratios": [6 if number % 10 == 9 else 5]}
        return {"application": cycle(*phases, requirements=wishes), "title": f"axis {number % 40}"}

    def save(number: int) -> tuple[int, Json]:
        headers = {"Idempotency-Key": f"key-{number % 40}"}
        answer = client.post("/api/v1/selections", json=body(number % 40), headers=headers)
        return answer.status_code, answer.json()

    with ThreadPoolExecutor(8) as threads:
        answers = list(threads.map(save, range(80)))

    for number, (status, answer) in enumerate(answers[:40]):
        if number % 10 == 9:
            assert status == 422
            assert answer["errors"][0]["pointer"] == "/application/requirements/ratios/0"
            continue
        assert status == 201, answer
        assert answer["id"] == answers[number + 40][1]["id"]
        reply = client.get(f"/api/v1/selections/{answer['id']}").json()
        expected = body(number)
        assert (reply["title"], reply["application"]) == (expected["title"], expected["application"])
        assert reply["result"] == client.post("/api/v1/select", json=expected["application"]).json()
        assert reply["today"]["difference_count"] == 0

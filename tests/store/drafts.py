"""Drafts to save in tests."""

from collections.abc import Callable
from typing import Any

from sqlalchemy import Connection
from starlette.testclient import TestClient

from hpn.store import Draft, Store
from hpn.store.engine import WRITES
from tests.build import worked_example


def draft(**parts: Any) -> Draft:
    """A draft with whatever is not given filled in."""
    fields = {
        "application": b'{"duty_cycle":{"phases":[]}}',
        "result": b'{"selected":"HPN-20A-5"}',
        "engine_version": "1.0.0",
        "catalogue_version": "0123456789abcdef",
        "selected": "HPN-20A-5",
    }
    return Draft(**(fields | parts))


async def change(store: Store, work: Callable[[Connection], object]) -> None:
    """Change a store's database behind its back, in one transaction."""
    async with store._engine.execution_options(**WRITES).begin() as connection:
        await connection.run_sync(work)


WEAKER = """\
size,ratio,repeated_peak_torque_Nm,rated_torque_Nm,momentary_peak_torque_Nm,source
20A,5,,30,,test
"""
"""Ratings with which HPN-20A-5 no longer suits the worked example."""


ADDRESS = "/api/v1/selections"


def save(client: TestClient, /, headers: dict[str, str] | None = None, **parts: Any) -> str:
    """Id of a new saved selection."""
    response = client.post(ADDRESS, json={"application": worked_example()} | parts, headers=headers)
    assert response.status_code == 201, response.text
    return str(response.json()["id"])

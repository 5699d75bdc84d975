"""An open store, on each kind of database."""

import multiprocessing
from collections.abc import AsyncIterator, Iterator
from multiprocessing.context import ForkServerContext
from pathlib import Path
from zlib import crc32

import pytest
from starlette.testclient import TestClient

from hpn.store import Store
from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.databases import (
    KINDS,
    PostgreSQL,
    database,
    kind,
    migrated_database,
    migrated_file,
    postgresql,
    ready_database,
)

__all__ = [
    "PostgreSQL",
    "database",
    "kind",
    "migrated_database",
    "migrated_file",
    "postgresql",
    "ready_database",
]

ON_BOTH = ("test_two_people.py", "test_savers.py")
"""Files over HTTP whose subject is what databases do differently."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Leave the other database of a test over HTTP to the long form; tests of the store itself have both each time."""
    for item in items:
        if item.path.parent == Path(__file__).parent and item.path.name not in ON_BOTH:
            names = getattr(item, "fixturenames", ())
            if {"client", "ready_database"} <= {*names} and "store" not in names:
                of = str(item.callspec.params["kind"])  # type: ignore[attr-defined]
                if of in KINDS and of != KINDS[crc32(item.nodeid.replace(of, "").encode()) % len(KINDS)]:
                    item.add_marker(pytest.mark.soak)


@pytest.fixture
def anyio_backend() -> str:
    """Event loop of the asynchronous tests."""
    return "asyncio"


@pytest.fixture
async def store(ready_database: str) -> AsyncIterator[Store]:
    """A store with nothing in it."""
    store = Store(ready_database)
    await store.open()
    yield store
    await store.close()


@pytest.fixture
def client(ready_database: str) -> Iterator[TestClient]:
    """A client of a running service."""
    with TestClient(create_app(Settings(database_url=ready_database))) as client:
        yield client


@pytest.fixture(scope="session")
def processes() -> ForkServerContext:
    """Makes processes that share nothing with this one, and need not import what they use."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["tests.store.test_catalogues", "tests.store.test_upgrade"])
    return context

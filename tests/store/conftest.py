"""An open store, on each kind of database."""

from collections.abc import AsyncIterator

import pytest

from hpn.store import Store
from tests.databases import PostgreSQL, database, postgresql

__all__ = ["PostgreSQL", "database", "postgresql"]


@pytest.fixture
def anyio_backend() -> str:
    """Event loop of the asynchronous tests."""
    return "asyncio"


@pytest.fixture
async def store(database: str) -> AsyncIterator[Store]:
    """A store on a new database."""
    store = Store(database)
    await store.open()
    yield store
    await store.close()

"""An application in this process, made with the settings that a test asks for, and a service in its own."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.databases import PostgreSQL
from tests.operations.service import Service, serving
from tests.operations.stack import Stack, stacked

MakeClient = Callable[..., TestClient]


@pytest.fixture
def anyio_backend() -> str:
    """Event loop of the asynchronous tests."""
    return "asyncio"


@pytest.fixture
def make_client(tmp_path: Path) -> Iterator[MakeClient]:
    """Client of an application with the given settings and a database of its own."""
    with ExitStack() as stack:

        def make(**settings: Any) -> TestClient:
            values = {"database_url": f"sqlite:///{tmp_path}/store.sqlite3", **settings}
            app = create_app(Settings(**values))
            return stack.enter_context(TestClient(app, raise_server_exceptions=False, client=("127.0.0.1", 50000)))

        yield make


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service with one process and the settings as shipped."""
    with serving(tmp_path_factory.mktemp("service")) as running:
        yield running


@pytest.fixture
def stack(postgresql: PostgreSQL, tmp_path: Path) -> Iterator[Stack]:
    """A stack with an empty database."""
    with stacked(postgresql, tmp_path) as stack:
        yield stack

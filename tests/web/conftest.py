"""Service for the tests of the REST interface, with its own database."""

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from fastapi import FastAPI
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.settings import Settings


@pytest.fixture(scope="session")
def service(tmp_path_factory: pytest.TempPathFactory) -> FastAPI:
    """Application as shipped, with its own database file."""
    file = tmp_path_factory.mktemp("service") / "selections.sqlite3"
    return create_app(Settings(database_url=f"sqlite:///{file}"))


@pytest.fixture(scope="session")
def api(service: FastAPI) -> Iterator[TestClient]:
    """Client that gets an internal error as an answer 500, as users would."""
    with TestClient(service, raise_server_exceptions=False) as client:
        yield client


@pytest.fixture(scope="module")
def client() -> Iterator[TestClient]:
    """Client that follows no redirect."""
    app = create_app()
    yield TestClient(app, follow_redirects=False)
    app.state.pools.close()  # files are read in a process


@pytest.fixture(scope="module")
def keeping(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """Client of a service with its own empty store."""
    file = tmp_path_factory.mktemp("pairs") / "store.sqlite3"
    app = create_app(Settings(database_url=f"sqlite:///{file}", log_level="error"))
    with TestClient(app) as result:
        yield result


@pytest.fixture(scope="session")
def document(service: FastAPI) -> dict[str, Any]:
    """OpenAPI document of the service."""
    return service.openapi()


PART = 16
"""`make test` tries 1 in PART of the fuzz's examples on each operation of the API; `make soak` tries all."""


@pytest.fixture(autouse=True)
def _part_of_the_fuzz(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    if request.path.name == "test_fuzz.py" and not request.config.getoption("--soak"):
        whole: Callable[[str], int] = request.module.examples
        monkeypatch.setattr(request.module, "examples", lambda label: max(10, whole(label) // PART))

"""One service for the tests of the REST interface, with a database of its own."""

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from fastapi import FastAPI
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.settings import Settings


@pytest.fixture(scope="session")
def service(tmp_path_factory: pytest.TempPathFactory) -> FastAPI:
    """The application as shipped, on a database file of its own."""
    file = tmp_path_factory.mktemp("service") / "selections.sqlite3"
    return create_app(Settings(database_url=f"sqlite:///{file}"))


@pytest.fixture(scope="session")
def api(service: FastAPI) -> Iterator[TestClient]:
    """A client that shows a mistake of the service as an answer 500, as its users would see it."""
    with TestClient(service, raise_server_exceptions=False) as client:
        yield client


@pytest.fixture(scope="module")
def client() -> Iterator[TestClient]:
    """A client that follows no redirect."""
    app = create_app()
    yield TestClient(app, follow_redirects=False)
    app.state.pools.close()  # files are read in a process


@pytest.fixture(scope="module")
def keeping(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A client of a service with a store of its own, which nothing else has written."""
    file = tmp_path_factory.mktemp("pairs") / "store.sqlite3"
    app = create_app(Settings(database_url=f"sqlite:///{file}", log_level="error"))
    with TestClient(app) as found:
        yield found


@pytest.fixture(scope="session")
def document(service: FastAPI) -> dict[str, Any]:
    """The OpenAPI document."""
    return service.openapi()


PART = 8
"""`make test` tries every operation of the API with one in so many of the fuzz's examples; `make soak` with all."""


@pytest.fixture(autouse=True)
def _part_of_the_fuzz(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    if request.path.name == "test_fuzz.py" and not request.config.getoption("--soak"):
        whole: Callable[[str], int] = request.module.examples
        monkeypatch.setattr(request.module, "examples", lambda label: max(10, whole(label) // PART))

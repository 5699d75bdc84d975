"""A fleet as the command sizes it, and the page of a machine."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from fastapi import FastAPI
from starlette.testclient import TestClient

from hpn.catalogue import Catalogue
from hpn.fleet.order import Order
from hpn.fleet.run import Use, size_fleet
from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.fleet.page import GERMAN, fields_of, post
from tests.fleet.tables import Row, read, write

Size = Callable[..., list[Row]]


@pytest.fixture
def size(catalogue: Catalogue, tmp_path: Path) -> Size:
    """Sizes rows: gives the answers. Files lie in the test's folder: `in`, `out`, `rejected.parquet`."""

    def run(
        rows: list[Row] | str | bytes,
        suffix: str = ".parquet",
        *,
        candidates: Path | None = None,
        use: Use = lambda answers: None,
    ) -> list[Row]:
        order = Order(tmp_path / f"in{suffix}", tmp_path / f"out{suffix}", rejected=tmp_path / "rejected.parquet")
        if isinstance(rows, str | bytes):
            order.axes.write_bytes(rows.encode() if isinstance(rows, str) else rows)
        else:
            write(order.axes, rows)
        size_fleet(replace(order, candidates=candidates), catalogue, use=use)
        return read(order.answers)

    return run


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> FastAPI:
    """A service with a store of its own."""
    return create_app(Settings(database_url=f"sqlite:///{tmp_path_factory.mktemp('fleets') / 'fleets.sqlite3'}"))


@pytest.fixture(scope="module")
def client(service: FastAPI) -> Iterator[TestClient]:
    """A browser that stays where a redirect leads from."""
    with TestClient(service, follow_redirects=False) as client:
        yield client


@pytest.fixture(scope="module")
def machine(client: TestClient) -> str:
    """Address of the machine of the German table."""
    read = post(client, GERMAN.encode("cp1252"))
    assert read.status_code == 200, read.text
    sized = post(client, fields={**fields_of(read.text), "size": "1"})
    assert sized.status_code == 303, sized.text
    return str(sized.headers["location"])

"""The plain service that replies are measured against does the work of the product, so that their times compare."""

from pathlib import Path
from typing import Any

import pytest
from httpx2 import Response
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.settings import Settings
from tools.benchmarks import plain
from tools.benchmarks.applications import CASES, EVERY, select_body
from tools.benchmarks.replies import differing
from tools.benchmarks.variants import JSON


@pytest.mark.parametrize("restriction", CASES.values(), ids=CASES)
def test_the_plain_service_comes_to_the_figures_and_order_of_the_product(
    restriction: dict[str, Any], tmp_path: Path
) -> None:
    with TestClient(create_app(Settings(database_url=f"sqlite:///{tmp_path}/store.sqlite3"))) as product:
        (tmp_path / "catalogue.json").write_bytes(product.get("/api/v1/catalogue").content)
        (tmp_path / "reply.json").write_bytes(_ask(product, select_body(0, EVERY)).content)
        theirs = _ask(product, select_body(7, restriction)).json()

    ours = _ask(TestClient(plain.create_app(tmp_path)), select_body(7, restriction)).json()

    assert theirs.keys() == ours.keys()
    for part in ("duty", "selected", "candidates"):
        assert list(differing(theirs[part], ours[part], part)) == []


def _ask(client: TestClient, body: bytes) -> Response:
    return client.post("/api/v1/select", content=body, headers=JSON)

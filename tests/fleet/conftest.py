"""A fleet that is sized as the command does it."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from hpn.catalogue import Catalogue
from hpn.fleet.run import Order, size_fleet
from tests.fleet.tables import Row, read, write

Size = Callable[..., list[Row]]


@pytest.fixture
def size(catalogue: Catalogue, tmp_path: Path) -> Size:
    """Sizes rows: gives the answers. Files lie in the test's folder: `in`, `beside`, `out`, `rejected.ndjson`."""

    def run(
        rows: list[Row] | str | bytes,
        suffix: str = ".ndjson",
        *,
        beside: list[Row] | None = None,
        candidates: Path | None = None,
    ) -> list[Row]:
        order = Order(tmp_path / f"in{suffix}", tmp_path / f"out{suffix}", rejected=tmp_path / "rejected.ndjson")
        if isinstance(rows, str | bytes):
            order.axes.write_bytes(rows.encode() if isinstance(rows, str) else rows)
        else:
            write(order.axes, rows)
        if beside is not None:
            order = replace(order, requirements=write(tmp_path / f"beside{suffix}", beside))
        size_fleet(replace(order, candidates=candidates), catalogue)
        return read(order.answers)

    return run

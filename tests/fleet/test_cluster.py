"""A Dask cluster gives the same bytes as this machine, also when it loses a worker midway."""

import os
import random
import signal
import subprocess
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from hpn.catalogue import Catalogue
from hpn.fleet import run
from hpn.fleet.cluster import dask
from hpn.fleet.order import FleetError, Order
from hpn.fleet.run import size_fleet
from hpn.fleet.tables import Progress
from tests.fleet.tables import row_of, write
from tests.property.draw import at_random

distributed: Any = import_module("distributed")  # it has no types


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    """A scheduler and two workers, as processes."""
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address="127.0.0.1:0"
    ) as cluster:
        yield cluster


def test_a_cluster_gives_the_same_bytes(
    cluster: Any, tmp_path: Path, catalogue: Catalogue, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run, "SLICE_AXES", 100)
    rows = [row_of(number, at_random(random.Random(number))) for number in range(3000)]
    path = write(tmp_path / "in.parquet", rows, unit_rows=100)
    killed: list[str] = []

    def kill_one(progress: Progress) -> None:
        if not killed:  # some axes are done, others not yet
            with distributed.Client(cluster.scheduler_address, set_as_default=False) as client:
                worker, _info = next(iter(client.scheduler_info(n_workers=-1)["workers"].items()))
                killed.append(worker)
                os.kill(next(w.pid for w in cluster.workers.values() if w.worker_address == worker), signal.SIGKILL)

    size_fleet(Order(path, tmp_path / "here.parquet"), catalogue)
    size_fleet(Order(path, tmp_path / "cluster.parquet"), catalogue, dask(cluster.scheduler_address, 2), kill_one)

    assert killed
    assert (tmp_path / "cluster.parquet").read_bytes() == (tmp_path / "here.parquet").read_bytes()


def test_the_command_starts_a_cluster_of_its_own(tmp_path: Path) -> None:
    path = write(tmp_path / "in.csv", [row_of("a", at_random(random.Random(1)))])
    command: list[Any] = [
        sys.executable,
        "-m",
        "hpn",
        "fleet",
        path,
        tmp_path / "out.csv",
        "--engine",
        "dask",
        "--workers",
        "1",
    ]
    assert subprocess.run(command, check=True, capture_output=True, text=True).stderr.splitlines() == []
    assert (tmp_path / "out.csv").read_text().startswith('"axis"')


@pytest.mark.parametrize("address", ["nothing://here", pytest.param("tcp://127.0.0.1:9", marks=pytest.mark.soak)])
def test_a_scheduler_that_is_not_there_is_said(address: str, tmp_path: Path, catalogue: Catalogue) -> None:
    path = write(tmp_path / "in.csv", [row_of("a", at_random(random.Random(1)))])
    with pytest.raises(FleetError, match=f"--scheduler {address}: "):
        size_fleet(Order(path, tmp_path / "out.csv"), catalogue, dask(address, 1))
    assert list(tmp_path.iterdir()) == [path]

"""Sizing a fleet on a Dask cluster: the same function over the same parts; the extra `cluster` brings what it needs."""

import logging
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from importlib import import_module
from typing import Any

from hpn.fleet.errors import FleetError
from hpn.fleet.grouping import Part
from hpn.fleet.job import Job, compute
from hpn.fleet.run import MEMORY, Engine, interrupts_held
from hpn.installed import require

CONNECT_SECONDS = 10


def dask(scheduler: str | None, workers: int) -> Engine:
    """Engine of the cluster at an address, or of one of processes of this machine, started for the run.

    Parts are independent: nothing is exchanged between workers, and what a lost worker had is given to another.
    """
    require("cluster")
    distributed: Any = import_module("distributed")  # it has no types

    def run(job: Job, parts: Mapping[int, Part]) -> Iterator[int]:
        with ExitStack() as stack:
            address = scheduler or stack.enter_context(_of_this_machine(distributed, workers))
            try:
                client = stack.enter_context(distributed.Client(address, timeout=CONNECT_SECONDS))
            except (OSError, ValueError) as error:
                raise FleetError(f"--scheduler {scheduler}: {error}") from None
            shared = client.scatter(job, broadcast=True)
            futures = {
                client.submit(compute, shared, number, part, pure=False): number for number, part in parts.items()
            }
            for future in distributed.as_completed(futures):
                future.result()
                yield futures[future]

    return run


def _of_this_machine(distributed: Any, workers: int) -> Any:
    """A cluster of processes that keep memory as those of the local engine do."""
    with import_module("dask").config.set({"distributed.nanny.pre-spawn-environ": MEMORY}), interrupts_held():
        return distributed.LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
            silence_logs=logging.ERROR,
        )

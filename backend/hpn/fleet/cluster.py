"""Fleets on a Dask cluster: the same function over the same axes. Needs the extra `cluster`."""

import logging
import signal
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from importlib import import_module
from multiprocessing.resource_tracker import ensure_running
from typing import Any

from hpn.fleet.order import FleetError
from hpn.fleet.run import MEMORY, Engine, Outcome, Size, in_order
from hpn.fleet.tables import RowBatch
from hpn.installed import require

CONNECT_SECONDS = 10


class _Workers:
    """Workers of a cluster; they receive the function once for all batches."""

    def __init__(self, client: Any, size: Size) -> None:
        self._client, self._size = client, client.scatter(size, broadcast=True)

    def submit(self, size: Size, batch: RowBatch) -> Any:
        """Future outcome of a batch; where a worker is lost, another takes over its batches."""
        return self._client.submit(_sized, self._size, batch, pure=False)


def _sized(size: Size, batch: RowBatch) -> Outcome:
    return size(batch)


def dask(scheduler: str | None, workers: int) -> Engine:
    """Engine of the cluster at an address, or of processes on this machine, started for the run."""
    require("cluster")
    distributed: Any = import_module("distributed")  # the package has no types

    def run(size: Size, batches: Iterator[RowBatch]) -> Iterator[Outcome]:
        with ExitStack() as stack:
            address = scheduler or stack.enter_context(_of_this_machine(distributed, workers))
            try:
                client = stack.enter_context(distributed.Client(address, timeout=CONNECT_SECONDS))
            except (OSError, ValueError) as error:
                raise FleetError(f"--scheduler {scheduler}: {error}") from None
            count = max(workers, len(client.scheduler_info(n_workers=-1)["workers"]))
            yield from in_order(_Workers(client, size), count, size, batches)

    return run


def _of_this_machine(distributed: Any, workers: int) -> Any:
    """Cluster of processes on this machine that keep memory as the command does."""
    environment = {name: str(value) for name, (_, value) in MEMORY.items()}
    with import_module("dask").config.set({"distributed.nanny.pre-spawn-environ": environment}), interrupts_held():
        return distributed.LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
            silence_logs=logging.CRITICAL,  # a last heartbeat may miss the scheduler; faults of tasks are raised
        )


@contextmanager
def interrupts_held() -> Iterator[None]:
    """Block interrupts in the block: a process started there has them blocked from its start, this one gets them
    afterwards.

    The mask is that of the main thread; an interrupt in another thread is noted and raised at the end.
    """
    ensure_running()  # multiprocessing's own first process unblocks interrupts at its start
    noted: list[int] = []
    handler = signal.signal(signal.SIGINT, lambda number, _: noted.append(number))
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        signal.signal(signal.SIGINT, handler)
        if noted:
            signal.raise_signal(signal.SIGINT)

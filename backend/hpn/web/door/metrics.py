"""Prometheus metrics: requests, selections by verdict, operations of the store, versions.

With several workers, each writes its counts to files in one folder, and the worker that is asked adds them all up: the
client library's multiprocess mode, for which `serve.py` sets PROMETHEUS_MULTIPROC_DIR before it starts the workers.
"""

import os
from collections import Counter as Counts
from collections.abc import Awaitable, Callable, Iterable
from types import MethodType
from typing import ParamSpec, TypeVar

from prometheus_client import CollectorRegistry, Counter, Histogram, ProcessCollector, generate_latest
from prometheus_client.metrics_core import InfoMetricFamily
from prometheus_client.multiprocess import MultiProcessCollector
from prometheus_client.registry import Collector

from hpn import ENGINE_VERSION
from hpn.store import KeyReusedError, KeySpentError, NoRoomError, ShareSpentError, Store

P = ParamSpec("P")
T = TypeVar("T")

CONTENT_TYPE = "text/plain; version=0.0.4; charset=utf-8"
FOLDER = "PROMETHEUS_MULTIPROC_DIR"
METHODS = frozenset({"GET", "HEAD", "POST", "DELETE", "OPTIONS", "PUT", "PATCH"})
BUCKETS = (0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 10, 30, 60)


class Build(Collector):
    """Versions of the process that is asked; they are not added up over workers."""

    def __init__(self, catalogue_version: str) -> None:
        self._versions = {"engine_version": ENGINE_VERSION, "catalogue_version": catalogue_version}

    def collect(self) -> Iterable[InfoMetricFamily]:
        """Yield the one metric `hpn_build_info`, always 1."""
        yield InfoMetricFamily("hpn_build", "Versions of engine and catalogue.", value=self._versions)


class Metrics:
    """Counts of one process, and its versions."""

    def __init__(self, catalogue_version: str = "") -> None:
        self._build = Build(catalogue_version)
        self._registry = registry = CollectorRegistry()
        registry.register(self._build)
        if FOLDER not in os.environ:
            ProcessCollector(registry=registry)
        self._requests = Counter(
            "hpn_http_requests", "Requests answered.", ("route", "method", "status"), registry=registry
        )
        self._seconds = Histogram(
            "hpn_http_request_duration_seconds",
            "Time from a request’s head to the end of its answer.",
            ("route", "method"),
            buckets=BUCKETS,
            registry=registry,
        )
        self._selections = Counter(
            "hpn_selections",
            "Applications evaluated: selected, none suitable, or refused.",
            ("verdict",),
            registry=registry,
        )
        self._store = Counter(
            "hpn_store_operations",
            "Operations of the store: ok or failed.",
            ("operation", "outcome"),
            registry=registry,
        )

    def request(self, route: str, method: str, status: int, seconds: float) -> None:
        """Count an answered request."""
        method = method if method in METHODS else "other"
        self._requests.labels(route, method, str(status)).inc()
        self._seconds.labels(route, method).observe(seconds)

    def selections(self, verdicts: Iterable[str]) -> None:
        """Count evaluated applications, each by its verdict: `selected`, `none` or `refused`."""
        for verdict, count in Counts(verdicts).items():
            self._selections.labels(verdict).inc(count)

    def store_operation(self, name: str, outcome: str) -> None:
        """Count an operation of the store."""
        self._store.labels(name, outcome).inc()

    def exposition(self) -> bytes:
        """Counts of all workers in Prometheus' text format."""
        registry = self._registry
        if FOLDER in os.environ:
            registry = CollectorRegistry()
            MultiProcessCollector(registry)  # type: ignore[no-untyped-call]
            registry.register(self._build)
        return generate_latest(registry)


CALLERS_MISTAKES = (KeyReusedError, KeySpentError, ShareSpentError, NoRoomError, ValueError)

NOT_COUNTED = frozenset({"open", "close", "require_complete"})
"""Functions of the store that don't serve a request."""


class CountedStore(Store):
    """Store whose operations are counted: every public function, future ones included, except those in NOT_COUNTED."""

    def __init__(self, metrics: Metrics, address: str, *, seconds: float, password: str | None) -> None:
        super().__init__(address, seconds=seconds, password=password)
        inherited = (each for kind in reversed(Store.__mro__[:-1]) for each in vars(kind).items())
        for name, function in inherited:
            if not name.startswith("_") and name not in NOT_COUNTED:
                setattr(self, name, _counted(metrics, name, MethodType(function, self)))


def _counted(metrics: Metrics, operation: str, function: Callable[P, Awaitable[T]]) -> Callable[P, Awaitable[T]]:
    async def counted(*args: P.args, **kwargs: P.kwargs) -> T:
        outcome = "failed"
        try:
            result = await function(*args, **kwargs)
            outcome = "ok"
        except CALLERS_MISTAKES:
            outcome = "refused"
            raise
        finally:
            metrics.store_operation(operation, outcome)
        return result

    return counted

"""Prometheus metrics: requests, selections by verdict, operations of the store.

With several workers each writes its counts to files in one folder, and whichever is asked adds all of them up: that is
the client library's multiprocess mode, for which `serve.py` sets PROMETHEUS_MULTIPROC_DIR before it starts them.
"""

import os
from collections import Counter as Counts
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager

from prometheus_client import CollectorRegistry, Counter, Histogram, ProcessCollector, generate_latest
from prometheus_client.multiprocess import MultiProcessCollector

from hpn.catalogue import Catalogue
from hpn.store import (
    Draft,
    FleetDraft,
    FleetSummary,
    KeyReusedError,
    KeySpentError,
    NoRoomError,
    Page,
    SavedFleet,
    SavedSelection,
    ShareSpentError,
    Store,
)

CONTENT_TYPE = "text/plain; version=0.0.4; charset=utf-8"
FOLDER = "PROMETHEUS_MULTIPROC_DIR"
METHODS = frozenset({"GET", "HEAD", "POST", "DELETE", "OPTIONS", "PUT", "PATCH"})
BUCKETS = (0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 10, 30, 60)


class Metrics:
    """Counts of one process."""

    def __init__(self) -> None:
        self._registry = registry = CollectorRegistry()
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
        """All counts in Prometheus' text format, those of the other workers included."""
        registry = self._registry
        if FOLDER in os.environ:
            registry = CollectorRegistry()
            MultiProcessCollector(registry)  # type: ignore[no-untyped-call]
        return generate_latest(registry)


CALLERS_MISTAKES = (KeyReusedError, KeySpentError, ShareSpentError, NoRoomError, ValueError)


class CountedStore(Store):
    """A store whose operations are counted."""

    def __init__(self, metrics: Metrics, address: str, *, seconds: float, password: str | None) -> None:
        super().__init__(address, seconds=seconds, password=password)
        self._metrics = metrics

    async def check(self, catalogue: Catalogue | None = None) -> None:
        """See Store."""
        with self._counted("check"):
            await super().check(catalogue)

    async def save(self, draft: Draft) -> str:
        """See Store."""
        with self._counted("save"):
            return await super().save(draft)

    async def find(self, id: str) -> SavedSelection | None:
        """See Store."""
        with self._counted("find"):
            return await super().find(id)

    async def catalogue(self, version: str) -> Catalogue | None:
        """See Store."""
        with self._counted("catalogue"):
            return await super().catalogue(version)

    async def page(
        self, *, reference: str | None = None, search: str | None = None, cursor: str | None = None, limit: int = 50
    ) -> Page:
        """See Store."""
        with self._counted("page"):
            return await super().page(reference=reference, search=search, cursor=cursor, limit=limit)

    async def rename(self, id: str, names: Mapping[str, str | None], version: int | None = None) -> bool:
        """See Store."""
        with self._counted("rename"):
            return await super().rename(id, names, version)

    async def delete(self, id: str, version: int | None = None) -> bool:
        """See Store."""
        with self._counted("delete"):
            return await super().delete(id, version)

    async def require_room(self, caller: str, most_bytes: int) -> None:
        """See Store."""
        with self._counted("require_room"):
            await super().require_room(caller, most_bytes)

    async def keep_fleet(self, draft: FleetDraft, most_bytes: int) -> str:
        """See Store."""
        with self._counted("keep_fleet"):
            return await super().keep_fleet(draft, most_bytes)

    async def save_fleet(self, id: str, names: Mapping[str, str | None], owner: str | None) -> bool:
        """See Store."""
        with self._counted("save_fleet"):
            return await super().save_fleet(id, names, owner)

    async def rename_fleet(self, id: str, names: Mapping[str, str | None], version: int | None = None) -> bool:
        """See Store."""
        with self._counted("rename_fleet"):
            return await super().rename_fleet(id, names, version)

    async def find_fleet(self, id: str) -> SavedFleet | None:
        """See Store."""
        with self._counted("find_fleet"):
            return await super().find_fleet(id)

    async def fleets(self, cursor: str | None = None, limit: int = 50) -> tuple[list[FleetSummary], str | None]:
        """See Store."""
        with self._counted("fleets"):
            return await super().fleets(cursor, limit)

    async def delete_fleet(self, id: str, version: int | None = None) -> bool:
        """See Store."""
        with self._counted("delete_fleet"):
            return await super().delete_fleet(id, version)

    @contextmanager
    def _counted(self, operation: str) -> Iterator[None]:
        try:
            yield
        except CALLERS_MISTAKES:
            self._metrics.store_operation(operation, "refused")
            raise
        except BaseException:
            self._metrics.store_operation(operation, "failed")
            raise
        self._metrics.store_operation(operation, "ok")

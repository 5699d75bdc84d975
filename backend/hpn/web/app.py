"""Service: a factory that assembles settings, catalogue, store, routes and limits."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from typing import Any

from fastapi import APIRouter, FastAPI
from starlette.middleware.cors import CORSMiddleware
from starlette.middleware.gzip import DEFAULT_EXCLUDED_CONTENT_TYPES

from hpn import ENGINE_VERSION
from hpn.application import Application, Pairing
from hpn.documents.axis import Axis
from hpn.documents.document import Document
from hpn.documents.revision import RevisionBlock
from hpn.store import Store, StoreUnavailableError
from hpn.web import archive, fleets, spool, todays
from hpn.web.api import (
    agents,
    axes,
    batch,
    catalogue,
    files,
    fleet,
    health,
    machine_files,
    machines,
    motor_lists,
    motors,
    openapi,
    pairs,
    revisions,
    schemas,
    select,
    selection_revisions,
    selections,
    sizings,
)
from hpn.web.door import problems, readers
from hpn.web.door.access import Gate
from hpn.web.door.bodies import NDJSON
from hpn.web.door.codings import Packing
from hpn.web.door.disk import Disk
from hpn.web.door.heads import Heads
from hpn.web.door.hosts import Hosts, Proxies
from hpn.web.door.logs import make_logger
from hpn.web.door.metrics import CountedStore, Metrics
from hpn.web.door.observation import Observation
from hpn.web.door.pools import Pools
from hpn.web.door.readers import Readers
from hpn.web.motor_lists import MotorList
from hpn.web.pages import (
    assets,
    compared,
    explanations,
    machine,
    machine_changes,
    machine_kinds,
    machine_list,
    machine_since,
    machine_upload,
    paste,
    saved_list,
    saving,
    transfer,
)
from hpn.web.pages import axis as axis_pages
from hpn.web.pages import calculator as pages
from hpn.web.pages import catalogue as catalogue_pages
from hpn.web.pages import motor_lists as motor_list_pages
from hpn.web.pages import pairs as pair_pages
from hpn.web.pages import revisions as revision_pages
from hpn.web.pages import saved as selection_pages
from hpn.web.settings import Settings

CORS: dict[str, Any] = {
    "allow_methods": ["GET", "POST", "PATCH", "DELETE"],
    "allow_headers": [
        "Authorization",
        "Content-Type",
        "Idempotency-Key",
        "If-Match",
        "If-None-Match",
        "Prefer",
        "X-API-Key",
        "X-Request-ID",
    ],
    "expose_headers": [
        "Accept-Encoding",
        "Content-Disposition",
        "ETag",
        "HPN-Ignored-Columns",
        "Idempotency-Replayed",
        "Link",
        "Location",
        "Preference-Applied",
        "RateLimit",
        "RateLimit-Policy",
        "Retry-After",
        "X-Request-ID",
    ],
    "max_age": 3600,
}
"""Methods and headers that scripts of permitted origins may send, and headers that they may read."""


UNPACKED = (
    *DEFAULT_EXCLUDED_CONTENT_TYPES,
    *(file.media_type for file in files.FILES),
    *NDJSON,
    *fleet.MEDIA_TYPES.values(),
)
"""Content types that are sent uncompressed: they are compressed already, or consist of lines that must not wait."""

ROUTERS: tuple[APIRouter, ...] = (
    health.router,
    health.metrics_router,
    openapi.router,
    select.router,
    sizings.router,
    batch.router,
    fleet.router,
    catalogue.router,
    motors.router,
    pairs.router,
    motor_lists.router,
    agents.router,
    selections.router,
    selection_revisions.router,
    machines.router,
    axes.router,
    revisions.router,
    machine_files.router,
    files.saved_files,
    files.posted_files,
    files.linked_files,
    pages.router,
    axis_pages.router,
    assets.router,
    assets.docs_router,
    readers.router,
    catalogue_pages.router,
    explanations.router,
    paste.router,
    machine_upload.router,
    machine_changes.router,
    machine_kinds.router,
    machine_since.router,
    machine_list.router,
    motor_list_pages.router,
    pair_pages.router,
    machine.router,
    transfer.router,
    compared.router,
    saved_list.router,
    saving.router,
    selection_pages.router,
    revision_pages.router,
)


BODIES = (
    Application,
    Pairing,
    MotorList,
    schemas.Batch,
    archive.SaveRequest,
    archive.Names,
    Document,
    machines.MachinePatch,
    axes.SentAxes,
    Axis,
    axes.AxisPatch,
    axes.ManyAxes,
    RevisionBlock,
    selection_revisions.SelectionRevision,
)
"""Models of request bodies that routes read themselves."""


def create_app(settings: Settings | None = None) -> FastAPI:
    """Web application; raises CatalogueError for a faulty catalogue or supplement.

    At its start the application updates the database; it raises NewerDatabaseError if a newer version has changed it.
    A slow database, or one out of reach, does not prevent the start.
    """
    settings = settings or Settings()
    app = FastAPI(
        title="HPN Select",
        version=ENGINE_VERSION,
        summary="Selects the Harmonic Drive HPN planetary gear for an application and gives the reasons.",
        description="Independent of the manufacturer; check a selection with the manufacturer before ordering.",
        docs_url=None,
        redoc_url=None,
        openapi_url=None,
        responses=schemas.ANYWHERE,
        openapi_tags=openapi.TAGS,
        servers=openapi.SERVERS,
        license_info={"name": "Apache-2.0", "identifier": "Apache-2.0"},
        lifespan=_with_store,
    )
    app.state.settings = settings
    app.state.catalogue = settings.catalogue()
    app.state.spool = spool.Trial(settings)
    app.state.fleets_under_way = set()
    app.state.gate = Gate(settings)
    app.state.pools = Pools(settings.fleet_processes, fleets.bounds_of(settings))
    app.state.disk = Disk(settings.maximum_spool_bytes)
    app.state.metrics = Metrics(app.state.catalogue.version)
    app.state.store = CountedStore(app.state.metrics, **settings.database())
    app.state.todays = todays.Todays(app.state)
    problems.install(app, explanations.page_of)
    for router in ROUTERS:
        app.include_router(router, responses={} if router is health.router else schemas.GUARDED)
    openapi.install(app, *BODIES)
    _add_middleware(app, settings)
    return app


def _add_middleware(app: FastAPI, settings: Settings) -> None:
    """Add the middleware of all requests, from the inside out."""
    app.add_middleware(Readers)
    # A page that quotes its query contains no secret, so its length after compression reveals nothing.
    app.add_middleware(Packing, compresslevel=4, exclude_content_types=UNPACKED)
    app.add_middleware(Heads)
    if settings.cors_origins:
        app.add_middleware(CORSMiddleware, allow_origins=settings.cors_origins, **CORS)
    app.add_middleware(Hosts, allowed=settings.allowed_hosts)
    app.add_middleware(Observation, logger=make_logger(settings.log_level), metrics=app.state.metrics)
    if settings.trusted_proxies:
        app.add_middleware(Proxies, trusted_hosts=list(settings.trusted_proxies))


@asynccontextmanager
async def _with_store(app: FastAPI) -> AsyncIterator[None]:
    store: Store = app.state.store
    fleets.remove_leftovers(app.state.settings)
    with suppress(StoreUnavailableError, TimeoutError):  # the store logs it, and opens as soon as it can
        async with asyncio.timeout(app.state.settings.database_seconds):
            await store.open()
    asking = asyncio.create_task(app.state.todays.run())
    yield
    asking.cancel()
    await asyncio.wait({asking})
    await fleets.wait_for_end(app.state)
    app.state.pools.close()
    await store.close()

"""The service: one factory that puts settings, catalogue, store, routes and limits together."""

from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager, suppress
from functools import partial
from typing import Any

from fastapi import FastAPI
from starlette.middleware.cors import CORSMiddleware
from starlette.routing import Match, Route
from starlette.types import Scope
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

from hpn import ENGINE_VERSION
from hpn.application import Application
from hpn.catalogue import Catalogue, load_catalogue
from hpn.compiled import compile_equations
from hpn.selection import select
from hpn.store import Store, StoreUnavailableError
from hpn.web.api import embeds, health, schemas, selection_schemas, selections
from hpn.web.api import files as exports
from hpn.web.api import select as api
from hpn.web.door import problems
from hpn.web.door.access import Gate
from hpn.web.door.compression import PackedPages
from hpn.web.door.logs import make_logger
from hpn.web.door.metrics import CountedStore, Metrics
from hpn.web.door.observation import Observation
from hpn.web.door.readers import Readers
from hpn.web.door.service import Service
from hpn.web.pages import calculator as pages
from hpn.web.pages import catalogue as catalogue_pages
from hpn.web.pages import long_cycles, paste, transfer
from hpn.web.pages import saved as selection_pages
from hpn.web.settings import Settings

CORS: dict[str, Any] = {
    "allow_methods": ["GET", "POST", "DELETE"],
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
        "ETag",
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
"""What scripts of the permitted origins may send and read."""


def create_app(settings: Settings | None = None) -> Service:
    """The application; raises CatalogueError where the catalogue or its supplement is wrong.

    At its start it brings the database up to date, and raises NewerDatabaseError where a newer version has changed it.
    A database that is out of reach keeps nothing from starting.
    """
    settings = settings or Settings()
    metrics = Metrics()
    app = Service(
        title="HPN Select",
        version=ENGINE_VERSION,
        summary="Which Harmonic Drive HPN planetary gear fits an application, and why.",
        description="Independent of the maker; check a selection with the maker before ordering.",
        docs_url=None,
        redoc_url=None,
        license_info={"name": "Apache-2.0", "identifier": "Apache-2.0"},
        lifespan=_with_store,
    )
    app.state.settings = settings
    app.state.catalogue = load_catalogue(settings.catalogue_folder, settings.catalogue_supplement)
    _compile(app.state.catalogue)
    app.state.metrics = metrics
    app.state.store = CountedStore(
        settings.database_url.get_secret_value(),
        seconds=settings.database_seconds,
        make=partial(selections.drafts, app.state),
        metrics=metrics,
    )
    problems.install(app, catalogue_pages.nowhere)
    app.add_exception_handler(StoreUnavailableError, selections.unavailable)
    app.shortcuts = api.SHORTCUTS | selections.SHORTCUTS
    app.bodies = (Application, schemas.Batch, selection_schemas.SaveRequest)
    files = (exports.saved_files, exports.posted_files, exports.linked_files, embeds.router)
    routers = (health.router, api.router, selections.router, *files)
    for router in routers:
        app.include_router(router)
    for part in (pages, catalogue_pages, long_cycles, paste, transfer, selection_pages):
        app.router.routes.extend(part.routes)
    app.add_middleware(PackedPages)
    app.add_middleware(Readers)
    routes = [route for router in (app.router, *routers) for route in router.routes if isinstance(route, Route)]
    app.front = _front(app, settings, metrics, routes)
    return app


def _compile(catalogue: Catalogue) -> None:
    """Compile what requests run, or load what was compiled before, so that none of them has to wait for it."""
    compile_equations()
    selection = select(Application.worked_example(), catalogue)
    selection.json("/")
    selection.evaluation.bearing_loads()


def _front(app: Service, settings: Settings, metrics: Metrics, routes: Sequence[Route]) -> Any:
    """What every request passes, from the inside out."""
    front: Any = Gate(app.routed, settings, partial(_template_of, app, routes))
    if settings.cors_origins:
        front = CORSMiddleware(front, allow_origins=settings.cors_origins, **CORS)
    templates = {route.endpoint: route.path for route in app.routes if isinstance(route, Route)}
    templates |= {endpoint: path for (_, path), endpoint in app.shortcuts.items()}
    front = Observation(front, make_logger(settings.log_level), metrics, templates)
    if settings.trusted_proxies:
        front = ProxyHeadersMiddleware(front, trusted_hosts=list(settings.trusted_proxies))
    return front


def _template_of(app: Service, routes: Sequence[Route], scope: Scope) -> str:
    """Template of the route that answers a request, by the router's own match; the path where none does."""
    path: str = scope["path"]
    if (scope["method"], path) in app.shortcuts:
        return path
    return next((route.path for route in routes if route.matches(scope)[0] is Match.FULL), path)


@asynccontextmanager
async def _with_store(app: FastAPI) -> AsyncIterator[None]:
    store: Store = app.state.store
    with suppress(StoreUnavailableError):  # it is in the log, and the store opens as soon as it can
        await store.open()
    yield
    await store.close()

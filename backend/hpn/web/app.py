"""The service: one factory that puts settings, catalogue, store, routes and limits together."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress

from fastapi import FastAPI
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from hpn import ENGINE_VERSION
from hpn.application import Application
from hpn.catalogue import load_catalogue
from hpn.store import Store, StoreUnavailableError
from hpn.web import (
    api,
    embeds,
    exports,
    health,
    openapi,
    pages,
    problems,
    schemas,
    selection_pages,
    selection_schemas,
    selections,
)
from hpn.web.settings import Settings

SECURITY_HEADERS = [
    (
        b"content-security-policy",
        b"default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
        b"base-uri 'none'; form-action 'self'; frame-ancestors 'none'",
    ),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"same-origin"),
]


BODIES = (Application, schemas.Batch, selection_schemas.SaveRequest)


def create_app(settings: Settings | None = None) -> FastAPI:
    """The application; raises CatalogueError where the catalogue or its supplement is wrong.

    At its start it brings the database up to date, and raises NewerDatabaseError where a newer version has changed it.
    A database that is out of reach keeps nothing from starting.
    """
    settings = settings or Settings()
    app = FastAPI(
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
    app.state.store = Store(settings.database_url.get_secret_value(), seconds=settings.database_seconds)
    problems.install(app)
    app.add_exception_handler(StoreUnavailableError, selections.unavailable)
    app.router.routes[:0] = (*api.FAST_ROUTES, *selections.FAST_ROUTES)
    files = (exports.saved_files, exports.posted_files, exports.linked_files, embeds.router)
    for router in (health.router, api.router, selections.router, *files):
        app.include_router(router)
    app.router.routes.extend([*pages.routes, *selection_pages.routes])
    app.add_middleware(SecurityHeaders)
    document = app.openapi
    app.openapi = lambda: openapi.complete(document(), *BODIES)  # type: ignore[method-assign]
    return app


@asynccontextmanager
async def _with_store(app: FastAPI) -> AsyncIterator[None]:
    store: Store = app.state.store
    with suppress(StoreUnavailableError):  # it is in the log, and the store opens as soon as it can
        await store.open()
    yield
    await store.close()


class SecurityHeaders:
    """Headers that keep the page to its own host."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, and add the headers to the start of the response."""

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = [*message.get("headers", ()), *SECURITY_HEADERS]
            await send(message)

        await self.app(scope, receive, send_with_headers if scope["type"] == "http" else send)

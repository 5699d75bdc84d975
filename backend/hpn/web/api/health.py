"""Liveness and readiness of the service, for load balancers and orchestrators."""

from fastapi import APIRouter
from pydantic import BaseModel, Field
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response

from hpn import ENGINE_VERSION
from hpn.web.api.schemas import problems
from hpn.web.door.access import OPEN, admit
from hpn.web.door.metrics import CONTENT_TYPE
from hpn.web.door.pools import compute

router = APIRouter(tags=["Service"], dependencies=[OPEN])
metrics_router = APIRouter(tags=["Service"], dependencies=[admit("metrics")])


class Health(BaseModel):
    """State of the service."""

    status: str = Field(description="ok while the service answers.", examples=["ok"])


class Readiness(Health):
    """State of the service and of its dependencies."""

    engine_version: str = Field(description="Version of the running calculation.", examples=["1.1.0"])
    catalogue_version: str = Field(description="Hash of the loaded catalogue’s content.", examples=["53ef277c50b29b46"])
    gears: int = Field(description="Number of gears in the catalogue.", examples=[64])
    store: str = Field(description="ok while selections can be saved.", examples=["ok"])
    spool: str = Field(description="ok while files of fleets and batches of lines can be kept.", examples=["ok"])


@router.get("/healthz", operation_id="getHealth", summary="Liveness")
async def healthz() -> Health:
    """The process answers."""
    return Health(status="ok")


@router.get("/readyz", operation_id="getReadiness", summary="Readiness", responses=problems(503))
async def readyz(request: Request) -> Readiness:
    """The catalogue is loaded, and selections and files can be saved (tried at most once a second); else 503."""
    catalogue = request.app.state.catalogue
    await request.app.state.store.check(catalogue)
    await request.app.state.spool.check()
    return Readiness(
        status="ok",
        engine_version=ENGINE_VERSION,
        catalogue_version=catalogue.version,
        gears=len(catalogue.gears),
        store="ok",
        spool="ok",
    )


@metrics_router.get(
    "/metrics", operation_id="getMetrics", summary="Metrics for Prometheus", response_class=PlainTextResponse
)
async def metrics(request: Request) -> Response:
    """Counters for Prometheus: requests, selections by verdict, operations of the store; versions of engine and
    catalogue."""
    text = await compute(request, "metrics", request.app.state.metrics.exposition)
    return Response(text, media_type=CONTENT_TYPE)

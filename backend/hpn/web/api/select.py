"""`POST /api/v1/select`: a gear for one application."""

from typing import Annotated

from fastapi import APIRouter, Query
from starlette.datastructures import State
from starlette.requests import Request
from starlette.responses import Response

from hpn.application import Application
from hpn.engine.room import MOST_SAMPLES
from hpn.engine.selection import Selection, encode, select
from hpn.links.writer import to_link
from hpn.web.api import schemas
from hpn.web.api.replies import JSONBytes
from hpn.web.door.access import admit
from hpn.web.door.bodies import parsed, read_body
from hpn.web.door.pools import calculate

router = APIRouter(prefix="/api/v1", tags=["Selection"], dependencies=[admit("calculator")])

Samples = Annotated[
    int,
    Query(
        ge=0,
        le=MOST_SAMPLES,
        description="Points of the tolerances that are sampled for the share of those that fail; fewer of a motion "
        "and of a long cycle.",
    ),
]


@router.post(
    "/select",
    operation_id="select",
    summary="Select a gear for one application",
    openapi_extra=schemas.request_body(Application),
    response_model=Selection,
    responses=schemas.answers(400, 408, 413, 415, 422),
)
async def select_one(request: Request, samples: Samples = 0) -> Response:
    """Evaluates every size and ratio, ranks the candidates, and gives the reason for each status."""
    state: State = request.app.state
    body = await read_body(request)
    selected, reply = await calculate(request, body, _reply, body, state, samples)
    state.metrics.selections(["none" if selected is None else "selected"])
    return JSONBytes(reply)


def _reply(body: bytes, state: State, samples: int) -> tuple[str | None, bytes]:
    application = parsed(Application, body)
    selection = select(application, state.catalogue, to_link, samples)
    return selection.selected, encode(selection)

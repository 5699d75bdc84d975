"""`POST /api/v1/sizing`: the application in another tool's Sizing of Power Drive Trains (IDTA 02021)."""

from functools import partial
from typing import Any

import msgspec
from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import Response

from hpn.files.aas.opened import sizing_in
from hpn.web.api import schemas
from hpn.web.api.replies import JSONBytes, SizingReply, encode
from hpn.web.door.access import admit
from hpn.web.door.bodies import JSON, read_body
from hpn.web.door.pools import compute_beside
from hpn.web.door.problems import Problem

router = APIRouter(prefix="/api/v1", tags=["Selection"], dependencies=[admit("calculator")])

PACKAGE = "application/asset-administration-shell-package"
BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            PACKAGE: {"schema": {"type": "string", "format": "binary", "description": "An AASX package."}},
            JSON: {"schema": {"type": "object", "description": "An environment, or the submodel alone, as JSON."}},
        },
    }
}


@router.post(
    "/sizing",
    operation_id="readSizing",
    summary="Read the application from a sizing by IDTA 02021",
    openapi_extra=BODY,
    response_model=SizingReply,
    responses=schemas.answers(400, 408, 413, 415, 422, 503),
)
async def read_sizing(request: Request) -> Response:
    """Returns the application for `POST /api/v1/select` or `/selections`, and the elements that were not used.

    Elements are found by their semantic ids. A package made by this service returns its original application.
    """
    body = await read_body(request, PACKAGE, JSON)
    sizing = await compute_beside(request, "files", partial(sizing_in, body))
    if sizing.problem:
        raise Problem(422, sizing.problem)
    note = sizing.note.text if sizing.note else None
    return JSONBytes(encode(SizingReply(msgspec.Raw(sizing.text.encode()), sizing.unused, note)))

"""`POST /api/v1/select`: a gear for one application."""

from typing import Annotated, Any

import msgspec
from fastapi import APIRouter, Query
from msgspec import structs
from starlette.datastructures import State
from starlette.requests import Request
from starlette.responses import Response

from hpn.application import Application
from hpn.engine.candidates import Candidate
from hpn.engine.room import MOST_SAMPLES
from hpn.engine.selection import Selection, encode, select
from hpn.links.writer import to_link
from hpn.web.api import schemas
from hpn.web.api.field_names import FieldNames, field_names
from hpn.web.api.replies import JSONBytes
from hpn.web.door.access import admit
from hpn.web.door.bodies import parsed, read_body
from hpn.web.door.pools import calculate

router = APIRouter(prefix="/api/v1", tags=["Selection"], dependencies=[admit("calculator")])

MOST_CANDIDATES = 1000
FIELDS = ("a selection", Selection.__struct_fields__, "candidates", Candidate.__struct_fields__)
"""Arguments of `field_names` for a reply and its candidates."""

Samples = Annotated[
    int,
    Query(
        ge=0,
        le=MOST_SAMPLES,
        description="Number of points sampled within the tolerances for the share that fails; fewer for a motion and "
        "for a long cycle.",
    ),
]


Top = Annotated[
    int | None,
    Query(ge=1, le=MOST_CANDIDATES, description="Number of candidates in the reply, the best first; all by default."),
]

Fields = Annotated[
    str | None,
    Query(
        description="Names of the fields to return, separated by commas; fields of a candidate as `candidates.name`. "
        "Without it, all."
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
async def select_one(request: Request, samples: Samples = 0, top: Top = None, fields: Fields = None) -> Response:
    """Evaluates every size and ratio, ranks the candidates, and gives the reason for each status."""
    state: State = request.app.state
    names = None if fields is None else field_names(fields, *FIELDS)
    body = await read_body(request)
    selected, reply = await calculate(request, body, _reply, body, state, samples, top, names)
    state.metrics.selections(["none" if selected is None else "selected"])
    return JSONBytes(reply)


def _reply(
    body: bytes, state: State, samples: int, top: int | None, names: FieldNames | None
) -> tuple[str | None, bytes]:
    application = parsed(Application, body)
    selection = select(application, state.catalogue, to_link, samples)
    answer = structs.replace(selection, candidates=selection.candidates[:top])
    return selection.selected, encode(answer) if names is None else _part(answer, names)


def _part(selection: Selection, names: FieldNames) -> bytes:
    """JSON of the selected fields of a selection and of its candidates."""
    whole: dict[str, Any] = msgspec.json.decode(encode(selection))
    part = {name: value for name, value in whole.items() if name in names.names}
    if names.of_each:
        listed = [{k: value for k, value in one.items() if k in names.of_each} for one in whole["candidates"]]
        part["candidates"] = listed
    return msgspec.json.encode(part)

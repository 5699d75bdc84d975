"""`POST /api/v1/pairs`: gears with motors for one application."""

from collections.abc import Callable, Sequence
from typing import Annotated

from fastapi import APIRouter, Query
from starlette.datastructures import State
from starlette.requests import Request
from starlette.responses import Response

from hpn.application import Application, InputError, MotorEntry, Pairing
from hpn.catalogue import Catalogue
from hpn.engine.pairs import Pairs, pairs_of
from hpn.links.writer import to_link
from hpn.web.api import schemas
from hpn.web.api.replies import JSONBytes, encode
from hpn.web.door.access import admit
from hpn.web.door.bodies import parsed, read_body
from hpn.web.door.pools import compute
from hpn.web.form.linked import LONGEST_LINK
from hpn.web.motor_lists import motors_of

router = APIRouter(prefix="/api/v1", tags=["Motors"], dependencies=[admit("calculator")])

Failing = Annotated[bool, Query(description="True: returns the unsuitable pairs instead, the nearest miss first.")]


@router.post(
    "/pairs",
    operation_id="pairMotors",
    summary="Pairs of gear and motor for one application",
    openapi_extra=schemas.request_body(Pairing),
    response_model=Pairs,
    responses=schemas.answers(400, 408, 413, 415, 422),
)
async def pairs(request: Request, failing: Failing = False) -> Response:
    """Ranks every allowed gear with every motor; each pair is judged as in `POST /api/v1/select`."""
    state: State = request.app.state
    body = await read_body(request)
    question = await compute(request, "pages", parsed, Pairing, body)
    motors = question.motors or await motors_of(request, question.list or "")
    return JSONBytes(await compute(request, "pages", _reply, question, motors, state.catalogue, failing))


def _reply(question: Pairing, motors: Sequence[MotorEntry], catalogue: Catalogue, failing: bool) -> bytes:
    try:
        return encode(pairs_of(question, motors, catalogue, _links(question.application), failing=failing))
    except InputError as error:
        raise error.below("application") from None


def _links(application: Application) -> Callable[[Application, str], str | None]:
    """Function that makes links of pairs; None for all if the application's own link is too long."""
    if len(to_link(application)) > LONGEST_LINK:
        return lambda equipped, gear: None
    return _link


def _link(application: Application, gear: str) -> str | None:
    link = f"{to_link(application)}&gear={gear}"
    return link if len(link) <= LONGEST_LINK else None

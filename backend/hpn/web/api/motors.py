"""The user's own motors over REST: all of them, and the utilisation of each on a gear."""

from fastapi import APIRouter
from starlette.datastructures import State
from starlette.requests import Request
from starlette.responses import Response

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.motors import motors_on
from hpn.web.api import schemas
from hpn.web.api.catalogue import gear_named
from hpn.web.api.replies import JSONBytes, MotorsOnGearReply, MotorsReply, MotorUseReply, encode
from hpn.web.door.access import admit
from hpn.web.door.bodies import parsed, read_body
from hpn.web.door.conditions import conditional
from hpn.web.door.pools import compute

router = APIRouter(prefix="/api/v1", tags=["Motors"], dependencies=[admit("calculator")])


@router.get(
    "/motors",
    operation_id="getMotors",
    summary="The user’s own motors",
    openapi_extra=schemas.IF_NONE_MATCH,
    response_model=MotorsReply,
    responses=schemas.tagged(422),
)
async def motors(request: Request) -> Response:
    """Motors in the supplement’s motors.csv; empty without that file. A blank figure is null."""
    book: Catalogue = request.app.state.catalogue
    return conditional(request, encode(MotorsReply(book.version, book.motors)))


@router.post(
    "/motors/{designation}",
    operation_id="fitMotors",
    summary="The user’s own motors on a gear",
    openapi_extra=schemas.request_body(Application),
    response_model=MotorsOnGearReply,
    responses=schemas.answers(400, 404, 408, 413, 415, 422),
)
async def motors_of_gear(request: Request, designation: schemas.Designation) -> Response:
    """Utilisation of each motor in motors.csv on a gear for an application, in place of the application’s own motor."""
    state: State = request.app.state
    gear = gear_named(designation, state.catalogue)
    body = await read_body(request)
    return JSONBytes(
        await compute(
            request, "pages", lambda: encode(motors_on_gear(parsed(Application, body), gear, state.catalogue))
        )
    )


def motors_on_gear(application: Application, gear: Gear, catalogue: Catalogue) -> MotorsOnGearReply:
    """Reply with the utilisation of each motor of the catalogue’s list on a gear, best first."""
    uses = motors_on(application, gear, catalogue)
    replies = [MotorUseReply(use.motor, use.fits, use.governing, use.used, use.inertia_ratio) for use in uses]
    return MotorsOnGearReply(catalogue.version, gear.designation, replies)

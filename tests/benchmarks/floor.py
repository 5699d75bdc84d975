"""The floor that the service is measured against: a bare Starlette route, the same model in, a ready-made reply out."""

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from hpn.application import Application
from hpn.catalogue import load_catalogue
from hpn.selection import select


def create_floor() -> Starlette:
    """Floor with the reply of the worked example: the five gears of ratio 5."""
    return _floor(Application.worked_example())


def create_full_floor() -> Starlette:
    """Floor with the reply of the worked example on every gear."""
    example = Application.worked_example().model_dump(include={"duty_cycle", "emergency_stop"})
    return _floor(Application.model_validate(example))


def _floor(application: Application) -> Starlette:
    ready = select(application, load_catalogue()).json("/")

    async def floor(request: Request) -> Response:
        Application.model_validate_json(await request.body())
        return Response(ready, media_type="application/json")

    return Starlette(routes=[Route("/api/v1/select", floor, methods=["POST"])])

"""Page of a kind of problem: `type` of a problem leads to its cause and remedy."""

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import HTMLResponse, Response

from hpn.web.door.access import admit
from hpn.web.door.kinds import KINDS, PATH
from hpn.web.door.pools import worked
from hpn.web.pages.catalogue import nowhere
from hpn.web.pages.templates import environment


def show_kind(request: Request) -> Response:
    """The page of a kind by its name."""
    kind = KINDS.get(request.path_params["name"])
    if kind is None:
        return nowhere(request)
    shown = environment(request.app.state).get_template("problem.html").render(kind=kind)
    return HTMLResponse(shown, headers={"Cache-Control": "no-cache"})


router = APIRouter(include_in_schema=False, dependencies=[admit("calculator")])
router.add_api_route(PATH + "{name}", worked(show_kind))

"""What a check tests and what to change where it fails: a page of its own, and the part of it that the script shows."""

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import HTMLResponse, Response

from hpn.engine.checks import BY_CODE
from hpn.web.door.access import admit
from hpn.web.door.pools import worked
from hpn.web.pages.catalogue import nowhere
from hpn.web.pages.templates import environment


def show_check(request: Request) -> Response:
    """The page of a check by its code."""
    check = BY_CODE.get(request.path_params["code"])
    if check is None:
        return nowhere(request)
    template = environment(request.app.state).get_template("check.html")
    shown = template.render(code=check.code, definition=check, catalogue=request.app.state.catalogue)
    return HTMLResponse(shown, headers={"Cache-Control": "no-cache"})


router = APIRouter(include_in_schema=False, dependencies=[admit("calculator")])
router.add_api_route("/checks/{code}", worked(show_check))

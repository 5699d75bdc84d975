"""Refusals that a reader sees as a page, where a program gets a problem."""

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response

from hpn.web.door.problems import Problem
from hpn.web.pages.calculator import too_long
from hpn.web.pages.catalogue import nowhere


def reads_pages(request: Request) -> bool:
    """Whether a browser asks, and not for what the API says."""
    return "text/html" in request.headers.get("accept", "") and not request.scope["path"].startswith("/api/")


def page_of(request: Request, error: HTTPException) -> Response | None:
    """Page of an address that is too long or leads nowhere; None where a problem says it."""
    if error.status_code == 414 and (reads_pages(request) or request.scope["path"] == "/"):
        return too_long(request)
    if error.status_code == 404 and reads_pages(request) and not isinstance(error, Problem):
        return nowhere(request)
    return None

"""Pages that explain: the test of a check, cause and remedy of a problem, addresses without a page."""

from fastapi import APIRouter
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response

from hpn.engine.checks import BY_CODE
from hpn.web.door.access import MAXIMUM_QUERY_BYTES, admit
from hpn.web.door.kinds import KINDS, PATH
from hpn.web.door.pools import worked
from hpn.web.door.problems import Problem
from hpn.web.door.visit import current
from hpn.web.pages.rendering import page


def show_check(request: Request) -> Response:
    """Page of a check by its code; the script shows a part of it."""
    check = BY_CODE.get(request.path_params["code"])
    return _nowhere(request) if check is None else page(request, "check.html", code=check.code, definition=check)


def show_kind(request: Request) -> Response:
    """Page of a kind of problem by its name, the address in the problem's `type`."""
    kind = KINDS.get(request.path_params["name"])
    return _nowhere(request) if kind is None else page(request, "problem.html", kind=kind)


async def show_oembed() -> Response:
    """Raise Problem 410: oEmbed has ended. The next version answers 404, as for any unknown address."""
    raise Problem(410, "oEmbed has ended: read the Open Graph tags og:title and og:description of the page itself")


def page_of(request: Request, error: HTTPException) -> Response | None:
    """Page for an address that is too long, leads nowhere or needs a key; None if the problem is the answer.

    A page's script shows the text of a problem, so it gets that in the reader's language.
    """
    if error.status_code == 414 and (reads_pages(request) or request.scope["path"] == "/"):
        return page(request, "too_long.html", 414, limit=MAXIMUM_QUERY_BYTES)
    if error.status_code == 404 and reads_pages(request) and not isinstance(error, Problem):
        return _nowhere(request)
    if error.status_code in (401, 403) and reads_pages(request) and isinstance(error, Problem):
        answer = page(request, "problem.html", error.status_code, kind=KINDS[error.kind])
        answer.headers.update(error.headers or {})
        return answer
    if "hx-request" in request.headers and isinstance(error, Problem) and error.sentences:
        reader = current()
        text = "; ".join(sentence.render(reader.text, reader.bound) for sentence in error.sentences)
        return Problem(error.status_code, text, error.errors, dict(error.headers or {}), error.kind).response()
    return None


def reads_pages(request: Request) -> bool:
    """True for a browser's request that is not for the API."""
    return "text/html" in request.headers.get("accept", "") and not request.scope["path"].startswith("/api/")


def _nowhere(request: Request) -> Response:
    return page(request, "nowhere.html", 404)


router = APIRouter(include_in_schema=False, dependencies=[admit("calculator")])
router.add_api_route("/checks/{code}", worked(show_check))
router.add_api_route(PATH + "{name}", worked(show_kind))
router.add_api_route("/oembed", show_oembed)

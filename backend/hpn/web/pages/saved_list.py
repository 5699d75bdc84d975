"""The table of saved selections: newest first, in parts, all or those of a reference."""

from dataclasses import dataclass
from typing import Any
from urllib.parse import urlencode

from fastapi import APIRouter
from pydantic import ValidationError
from starlette.requests import Request
from starlette.responses import HTMLResponse, Response

from hpn.selection import Candidate, decode
from hpn.store import Page, Store, StoreUnavailableError, Summary
from hpn.web.archive import Labels, url_of
from hpn.web.door.access import admit
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.pages.saved import refused
from hpn.web.pages.templates import environment
from hpn.wording import N_

ADDRESS = "/selections"
LINES_ON_PAGE = 25
NO_SUCH_PART = N_("This part of the list can’t be found; its address is not whole.")


@dataclass(frozen=True, slots=True)
class Line:
    """A saved selection, and the gear that its page shows first, as it was judged then."""

    saved: Summary
    address: str
    gear: Candidate


async def show_selections(request: Request) -> Response:
    """Saved selections, newest first. `/api/v1/selections` says the same as JSON, also to a browser."""
    query = request.query_params
    reference, cursor = query.get("reference", ""), query.get("cursor") or None
    shown: dict[str, Any] = {
        "reference": reference,
        "lines": [],
        "error": "",
        "problem": "",
        "older": "",
        "newest": _address(reference),
        "later": bool(cursor),
    }
    store: Store = request.app.state.store
    try:
        wanted = Labels.model_validate({"reference": reference}).reference
        page = await store.page(reference=wanted, cursor=cursor, limit=LINES_ON_PAGE)
        results = await store.results([saved.id for saved in page.selections])
    except ValidationError as error:
        return await _rendered(request, 422, shown | {"error": Problem.of(error).errors[0][1]})
    except ValueError:
        return await _rendered(request, 422, shown | {"problem": NO_SUCH_PART})
    except StoreUnavailableError as error:
        return refused(request, error)
    shown["older"] = page.next_cursor and _address(reference, cursor=page.next_cursor)
    shown["lines"] = await compute(request, "pages", _lines, page, results)
    return await _rendered(request, 200, shown)


def _lines(page: Page, results: dict[str, bytes]) -> list[Line]:
    return [
        Line(saved, url_of(saved.id), decode(results[saved.id]).foremost)
        for saved in page.selections
        if saved.id in results
    ]


def _address(reference: str, **more: str) -> str:
    query = urlencode(({"reference": reference} if reference else {}) | more)
    return f"{ADDRESS}?{query}" if query else ADDRESS


async def _rendered(request: Request, status: int, shown: dict[str, Any]) -> Response:
    template = environment(request.app.state).get_template("selections.html")
    content = await compute(request, "pages", template.render, shown)
    return HTMLResponse(content, status, {"Cache-Control": "no-cache"})


router = APIRouter(include_in_schema=False, dependencies=[admit("listing")])
router.add_api_route(ADDRESS, show_selections)

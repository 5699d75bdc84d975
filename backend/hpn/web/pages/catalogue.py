"""The catalogue to read: one page for all gears, one for each, and the way to a gear by any spelling of its name."""

from dataclasses import dataclass
from typing import Any
from urllib.parse import quote, urlencode

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import HTMLResponse, PlainTextResponse, RedirectResponse, Response

from hpn.catalogue import Catalogue
from hpn.drawings import gear_envelope
from hpn.gear import Gear, canonical_designation, canonical_size
from hpn.web.door.access import admit
from hpn.web.door.bodies import pairs_of
from hpn.web.door.pools import worked
from hpn.web.door.visit import current
from hpn.web.form.ordering import ordering_code
from hpn.web.pages.gear_figures import figures_of, neighbours, series_figures, supplements_for
from hpn.web.pages.templates import environment

OWN_NAMES = ("output", "motor", "gear", "find")
"""Parameters of these pages; every other one belongs to the selection that the reader came from."""

LONGEST_LINK = 4000
"""Longest selection that is handed from page to page."""


@dataclass(frozen=True, slots=True)
class Filter:
    """A link that shows only some gears, or again all of them."""

    text: str
    address: str
    active: bool


def show_catalogue(request: Request) -> Response:
    """All gears in one table, or those of some sizes or ratios; `find` leads to the gear that it names."""
    catalogue: Catalogue = request.app.state.catalogue
    if find := request.query_params.get("find", "").strip():
        return RedirectResponse(f"/catalogue/{_path(find)}?{_carried(request)}".rstrip("?"), 303)
    size, ratio = canonical_size(request.query_params.get("size", "")), request.query_params.get("i", "")
    gears = [gear for gear in catalogue.gears if size in ("", gear.size) and ratio in ("", str(gear.ratio))]
    return _render(
        request,
        "catalogue.html",
        200 if gears else 404,
        gears=gears,
        sizes=[_filter(name, size == name, size="" if size == name else name, i=ratio) for name in catalogue.sizes],
        ratios=[_filter(str(i), ratio == str(i), size=size, i="" if ratio == str(i) else i) for i in catalogue.ratios],
        filtered=bool(size or ratio),
        canonical=f"{str(request.base_url).rstrip('/')}/catalogue",
    )


def _filter(text: str, active: bool, **query: Any) -> Filter:
    given = urlencode({name: value for name, value in query.items() if value})
    return Filter(text, f"/catalogue?{given}" if given else "/catalogue", active)


def show_gear(request: Request) -> Response:
    """The page of a gear; another spelling of its designation leads to it."""
    catalogue: Catalogue = request.app.state.catalogue
    name = request.path_params["designation"]
    gear = catalogue.find(name)
    if gear is None:
        return _unknown(request, name)
    if name != gear.designation:
        return RedirectResponse(f"/catalogue/{gear.designation}?{request.url.query}".rstrip("?"), 308)
    query = request.query_params
    return _render(
        request,
        "gear.html",
        200,
        gear=gear,
        groups=figures_of(gear),
        missing=supplements_for(gear),
        series_figures=series_figures,
        envelope=gear_envelope(catalogue, gear, current()),
        neighbours=neighbours(catalogue, gear),
        order=ordering_code(catalogue, gear, query.get("output", ""), query.get("motor", "")),
        carried=_carried(request),
        use=_use(request, gear),
        canonical=f"{str(request.base_url).rstrip('/')}/catalogue/{gear.designation}",
    )


def _unknown(request: Request, name: str) -> Response:
    """404 that offers what there is: the gears of that size or ratio, else all sizes."""
    catalogue: Catalogue = request.app.state.catalogue
    designation = canonical_designation(name)
    size = catalogue.find_size(designation.split("-")[1] if designation else name)
    near = [gear for gear in catalogue.gears if size is not None and gear.size == size.size]
    return _render(request, "gear_unknown.html", 404, name=name[:60], near=near)


def find_gear(request: Request) -> Response:
    """From the field that takes a gear by any spelling to that gear in the selection, with everything else as it is."""
    query = request.query_params
    pairs = pairs_of(query.get("link", "").removeprefix("/").removeprefix("?"))
    gear = request.app.state.catalogue.find(query.get("gear", ""))
    if gear is None:
        return _unknown(request, query.get("gear", ""))
    rest = [(name, value) for name, value in pairs if name not in ("gear", "do")]
    return RedirectResponse(f"/?{urlencode([*rest, ('gear', gear.designation)])}", 303)


def _carried(request: Request) -> str:
    """Query of the selection that the reader came from, or nothing."""
    pairs = [(name, value) for name, value in request.query_params.multi_items() if name not in OWN_NAMES]
    known = any(name == "T" for name, _ in pairs)
    query = urlencode(pairs)
    return query if known and len(query) <= LONGEST_LINK else ""


def _use(request: Request, gear: Gear) -> str:
    """Selection with this gear in view: the reader's own, or a blank one for its size and ratio."""
    carried = _carried(request)
    if carried:
        return f"/?{carried}&gear={gear.designation}"
    return f"/?T=&n=&t=&i={gear.ratio}&size={gear.size}"


def _path(text: str) -> str:
    return quote(text[:60], safe="")


def nowhere(request: Request) -> Response:
    """404 for a reader who followed an address that leads nowhere."""
    return _render(request, "nowhere.html", 404)


def _render(request: Request, template: str, status: int, **context: Any) -> Response:
    catalogue: Catalogue = request.app.state.catalogue
    content = environment(request.app.state).get_template(template)
    shown = content.render(catalogue=catalogue, **context)
    return HTMLResponse(shown, status, {"Cache-Control": "no-cache"})


async def robots(request: Request) -> Response:
    """What search engines may read: the calculator and the catalogue, not saved selections or the API."""
    return PlainTextResponse("User-agent: *\nDisallow: /selections\nDisallow: /api/\nDisallow: /paste\n")


router = APIRouter(include_in_schema=False, dependencies=[admit("calculator")])
router.add_api_route("/robots.txt", robots)
router.add_api_route("/catalogue", worked(show_catalogue))
router.add_api_route("/catalogue/{designation}", worked(show_gear))
router.add_api_route("/find", worked(find_gear))

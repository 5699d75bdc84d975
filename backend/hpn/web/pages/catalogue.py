"""Pages of the catalogue: all gears, each gear, and the search of a gear by any spelling of its name."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from urllib.parse import quote, urlencode

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import PlainTextResponse, RedirectResponse, Response

from hpn.account.published import groups_of
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.catalogue.ordering import OrderingCode, ordering_code
from hpn.explain.drawings import gear_envelope, published_condition
from hpn.links.labels import query_of
from hpn.web.door.access import admit
from hpn.web.door.bodies import pairs_of
from hpn.web.door.pools import worked
from hpn.web.door.visit import absolute, current
from hpn.web.form.condition import condition_of
from hpn.web.form.linked import carried_pairs, onward, query_part
from hpn.web.pages.gear_figures import series_figures, supplements_for
from hpn.web.pages.rendering import page
from hpn.words.designations import canonical_designation, canonical_size

COLUMNS = (
    "rated_torque_Nm",
    "repeated_peak_torque_Nm",
    "momentary_peak_torque_Nm",
    "maximum_input_speed_rpm",
    "average_input_speed_rpm",
    "backlash_arcmin",
    "transmission_accuracy_arcmin",
    "torsional_stiffness_Nm_per_rad",
    "weight_kg",
    "length_max_mm",
    "dynamic_radial_load_N",
    "dynamic_axial_load_N",
)
"""Figures in the table of all gears."""

GEAR = "gear"
"""Column that sorts the table by default."""


@dataclass(frozen=True, slots=True)
class SortHead:
    """Head of a column: its figure, the address that sorts by it, and its present order, blank if unsorted."""

    field: str
    address: str
    order: str


@dataclass(frozen=True, slots=True)
class Filter:
    """Link that shows only some gears, or all of them again."""

    text: str
    address: str
    active: bool


def show_catalogue(request: Request) -> Response:
    """Page with all gears in a table, or those of a size or ratio; `find` redirects to the named gear."""
    catalogue: Catalogue = request.app.state.catalogue
    if find := request.query_params.get("find", "").strip():
        return RedirectResponse(onward(f"/catalogue/{quote(find[:60], safe='')}"), 303)
    # In a carried selection `size` and `i` are its requirements.
    names = ("only_size", "only_i") if carried_pairs() else ("size", "i")
    size, ratio = (request.query_params.get(name, "") for name in names)
    size = canonical_size(size)
    gears = [gear for gear in catalogue.gears if size in ("", gear.size) and ratio in ("", str(gear.ratio))]
    sort = request.query_params.get("sort", "")
    sort = sort if sort.removeprefix("-") in (GEAR, *COLUMNS) else ""
    query = {names[0]: size, names[1]: ratio, "sort": sort}
    return page(
        request,
        "catalogue.html",
        200 if gears else 404,
        groups=_groups(gears, sort),
        count=len(gears),
        heads=[_head(field, sort, query) for field in (GEAR, *COLUMNS)],
        sizes=[_filter(one, size == one, query, names[0]) for one in catalogue.sizes],
        ratios=[_filter(one, ratio == one, query, names[1]) for one in map(str, catalogue.ratios)],
        filtered=bool(size or ratio),
        canonical=absolute(request, "/catalogue"),
    )


def _groups(gears: Sequence[Gear], sort: str) -> list[list[Gear]]:
    """Gears grouped by size, or all in the order of a column; gears without the figure come last."""
    field, falls = sort.removeprefix("-"), sort.startswith("-")
    if field in COLUMNS:
        valued = [gear for gear in gears if getattr(gear, field) is not None]
        valued.sort(key=lambda gear: getattr(gear, field), reverse=falls)
        return [valued + [gear for gear in gears if getattr(gear, field) is None]] if gears else []
    by_size = [list(group) for _, group in groupby(gears, key=lambda gear: gear.size)]
    return [group[::-1] for group in reversed(by_size)] if falls else by_size


def _head(field: str, sort: str, query: Mapping[str, str]) -> SortHead:
    now = sort or GEAR
    order = {field: "ascending", f"-{field}": "descending"}.get(now, "")
    return SortHead(field, onward("/catalogue", **{**query, "sort": f"-{field}" if now == field else field}), order)


def _filter(text: str, active: bool, query: Mapping[str, str], name: str) -> Filter:
    return Filter(text, onward("/catalogue", **{**query, name: "" if active else text}), active)


def show_gear(request: Request) -> Response:
    """Page of a gear; another spelling of its designation redirects to it."""
    catalogue: Catalogue = request.app.state.catalogue
    name = request.path_params["designation"]
    gear = catalogue.find(name)
    if gear is None:
        return _unknown(request, name)
    if name != gear.designation:
        return RedirectResponse(f"/catalogue/{gear.designation}?{request.url.query}".rstrip("?"), 308)
    query = request.query_params
    output, motor = (query.get(name, query.get(f"order_{name}", "")) for name in ("output", "motor"))
    order = ordering_code(catalogue, gear, output, motor)
    reader, groups = current(), groups_of(gear)
    condition = condition_of(query.multi_items(), reader, published_condition(catalogue, gear))
    return page(
        request,
        "gear.html",
        200,
        gear=gear,
        groups=[(title, [line for line in lines if line.value is not None]) for title, lines in groups],
        missing=supplements_for(gear),
        series_figures=series_figures,
        lacking=[line for _, lines in groups for line in lines if line.value is None],
        condition=condition,
        envelope=gear_envelope(catalogue, gear, condition.query, reader),
        order=order,
        use=_use(gear, order),
        canonical=absolute(request, f"/catalogue/{gear.designation}"),
    )


def _unknown(request: Request, name: str) -> Response:
    """Page with status 404 that offers the gears of that size, else all sizes."""
    catalogue: Catalogue = request.app.state.catalogue
    designation = canonical_designation(name)
    size = catalogue.find_size(designation.split("-")[1] if designation else name)
    near = [gear for gear in catalogue.gears if size is not None and gear.size == size.size]
    return page(request, "gear_unknown.html", 404, name=name[:60], near=near)


def find_gear(request: Request) -> Response:
    """Redirect from the gear field, which takes any spelling, to the selection with this gear and its other inputs."""
    query = request.query_params
    pairs = pairs_of(query_part(query.get("link", "")))
    gear = request.app.state.catalogue.find(query.get("gear", ""))
    if gear is None:
        return _unknown(request, query.get("gear", ""))
    rest = [(name, value) for name, value in pairs if name not in ("gear", "do")]
    return RedirectResponse(f"/?{urlencode([*rest, ('gear', gear.designation)])}", 303)


def _use(gear: Gear, order: OrderingCode) -> str:
    """Address of a selection that shows this gear: the carried one, or a blank one for its size and ratio."""
    if carried_pairs():
        return onward("/", gear=gear.designation, **order.labels)
    return f"/?T=&n=&t=&i={gear.ratio}&size={gear.size}{query_of(order.labels)}"


async def robots(request: Request) -> Response:
    """Rules for search engines: they may read calculator and catalogue, but not saved selections or the API."""
    return PlainTextResponse("User-agent: *\nDisallow: /selections\nDisallow: /api/\nDisallow: /paste\n")


router = APIRouter(include_in_schema=False, dependencies=[admit("calculator")])
router.add_api_route("/robots.txt", robots)
router.add_api_route("/catalogue", worked(show_catalogue))
router.add_api_route("/catalogue/{designation}", worked(show_gear))
router.add_api_route("/find", worked(find_gear))

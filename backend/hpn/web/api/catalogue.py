"""Catalogue over REST: every gear, one gear, and the envelopes of a size's output bearing."""

import dataclasses
from typing import Annotated

from fastapi import APIRouter, Query
from starlette.requests import Request
from starlette.responses import Response

from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.envelopes import EnvelopeQuery, life_envelopes
from hpn.web.api import schemas
from hpn.web.api.replies import CatalogueReply, EnvelopeReply, OneGearReply, encode
from hpn.web.door.access import admit
from hpn.web.door.conditions import conditional
from hpn.web.door.problems import Problem
from hpn.words.source import supplied_source

router = APIRouter(prefix="/api/v1", tags=["Catalogue"], dependencies=[admit("calculator")])


@router.get(
    "/catalogue",
    operation_id="getCatalogue",
    summary="Every gear",
    openapi_extra=schemas.IF_NONE_MATCH,
    response_model=CatalogueReply,
    responses=schemas.tagged(422),
)
async def catalogue(request: Request) -> Response:
    """Every gear of the series with every published figure and its source; null where not published."""
    book: Catalogue = request.app.state.catalogue
    return conditional(request, encode(CatalogueReply(book.version, book.gears, book.series)))


@router.get(
    "/catalogue/{designation}",
    operation_id="getGear",
    summary="One gear",
    openapi_extra=schemas.IF_NONE_MATCH,
    response_model=OneGearReply,
    responses=schemas.tagged(404, 422),
)
async def gear(request: Request, designation: schemas.Designation) -> Response:
    """One gear by its designation, in any of the printed spellings: as a single object and in the form of the
    catalogue."""
    book: Catalogue = request.app.state.catalogue
    match = gear_named(designation, book)
    return conditional(request, encode(one_gear(match, book)))


@router.get(
    "/bearing-envelopes/{size}",
    operation_id="getBearingEnvelopes",
    summary="Life envelopes of a size’s output bearing",
    openapi_extra=schemas.IF_NONE_MATCH,
    response_model=EnvelopeReply,
    responses=schemas.tagged(404, 422),
)
async def bearing_envelopes(request: Request, size: schemas.Size, query: Annotated[EnvelopeQuery, Query()]) -> Response:
    """Permitted constant load at a speed and life: one curve per load coefficient, from axial to radial axis."""
    book: Catalogue = request.app.state.catalogue
    gear = book.find_size(size)
    if gear is None:
        raise Problem(404, f"the catalogue has no size {size[:60]!r}; there are {', '.join(book.sizes)}")
    curves = life_envelopes(book, gear, query)
    sources = (
        {"curve": supplied_source("points of bearing_envelopes.csv")}
        if query.model == "digitised"
        else {name: gear.sources[name] for name in ("dynamic_radial_load_N", "dynamic_axial_load_N")}
    )
    return conditional(request, encode(EnvelopeReply(gear.size, query.model, curves, sources)))


def one_gear(gear: Gear, catalogue: Catalogue) -> OneGearReply:
    """Reply with a gear by itself, and in the form of the list."""
    own = {field.name: getattr(gear, field.name) for field in dataclasses.fields(gear)}
    return OneGearReply(**own, catalogue_version=catalogue.version, gears=(gear,))


def gear_named(designation: str, catalogue: Catalogue) -> Gear:
    """Gear by its designation in any printed spelling; Problem 404 if the catalogue lacks it."""
    match = catalogue.find(designation)
    if match is None:
        raise Problem(404, f"the catalogue has no gear {designation[:60]!r}; a designation is written like HPN-20A-5")
    return match

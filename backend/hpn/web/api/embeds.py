"""What a pasted link unfolds into: gear and verdict, by Open Graph and oEmbed."""

from typing import Annotated
from urllib.parse import urlsplit

from fastapi import APIRouter, Query
from pydantic import BaseModel, Field
from starlette.requests import Request

from hpn.catalogue import Catalogue
from hpn.engine.selection import decode, select
from hpn.web.api import schemas
from hpn.web.api.files import absolute
from hpn.web.door.access import admit
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.form.link_writer import to_link
from hpn.web.form.linked import linked
from hpn.web.preview import Preview, preview_of

SAVED = "/selections/"
router = APIRouter(tags=["Service"], dependencies=[admit("reading")])
"""oEmbed tells of saved selections too, so it belongs to reading."""


class OEmbedReply(BaseModel):
    """oEmbed of type link."""

    type: str = Field(description="Always link.")
    version: str = Field(description="Version of oEmbed.")
    title: str = Field(description="Gear and verdict.")
    description: str = Field(description="The figures behind them.")
    provider_name: str = Field(description="This service.")
    provider_url: str = Field(description="Its address.")
    cache_age: int = Field(description="Seconds for which it may be kept.")


@router.get(
    "/oembed",
    operation_id="getOEmbed",
    summary="What a link to a selection unfolds into",
    response_model=OEmbedReply,
    responses=schemas.problems(404, 406, 422),
)
async def oembed(
    request: Request,
    url: Annotated[str, Query(description="Address of a selection of this service.")],
    format: Annotated[str, Query(max_length=20, description="json; there is no other.")] = "json",
    maxwidth: Annotated[int | None, Query(description="Of no effect: a link has no size.")] = None,
    maxheight: Annotated[int | None, Query(description="Of no effect: a link has no size.")] = None,
) -> OEmbedReply:
    """What a link to a selection unfolds into (oEmbed 1.0)."""
    if format != "json":
        raise Problem(406, "oEmbed is given as JSON only")
    found = await _preview_of(request, url)
    return OEmbedReply(
        type="link",
        version="1.0",
        title=found.title,
        description=found.description,
        provider_name="HPN Select",
        provider_url=absolute(request, "/"),
        cache_age=3600,
    )


async def _preview_of(request: Request, url: str) -> Preview:
    unknown = Problem(404, "this is no address of a selection of this service")
    try:
        address = urlsplit(url)
    except ValueError:
        raise unknown from None
    if address.netloc not in ("", request.base_url.netloc) or address.scheme not in ("", "http", "https"):
        raise unknown
    if address.path.startswith(SAVED):
        saved = await request.app.state.store.find(address.path.removeprefix(SAVED))
        if saved is None:
            raise unknown
        return await compute(request, "pages", lambda: preview_of(decode(saved.result), address.path, saved.title))
    if address.path not in ("", "/") or not address.query:
        raise unknown
    try:
        return await compute(request, "pages", _linked, address.query, request.app.state.catalogue)
    except Problem as problem:
        raise (unknown if problem.status_code == 422 else problem) from None


def _linked(query: str, catalogue: Catalogue) -> Preview:
    application = linked(query).application
    link = to_link(application)
    return preview_of(select(application, catalogue, link), link)

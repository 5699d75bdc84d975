"""What a pasted link unfolds into: gear and verdict, by Open Graph and oEmbed."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any
from urllib.parse import parse_qsl, urlencode, urlsplit

import orjson
from fastapi import APIRouter, Query
from pydantic import BaseModel, Field
from starlette.requests import Request

from hpn.candidates import foremost
from hpn.report.language import language
from hpn.selection import select
from hpn.web.api import schemas
from hpn.web.api.files import absolute, application_of
from hpn.web.door.access import admit
from hpn.web.door.problems import Problem
from hpn.web.form.read import MAXIMUM_QUERY_BYTES
from hpn.web.form.write import to_link

SAVED = "/selections/"
LONGEST_PATH = 2000
"""Length of a link from which a page doesn't carry it a second time."""

router = APIRouter(dependencies=[admit("reading")])
"""oEmbed tells of saved selections too, so it belongs to reading."""


@dataclass(frozen=True, slots=True)
class Preview:
    """Title and description of a result, and where its oEmbed stands; empty for a very long link."""

    title: str
    description: str
    oembed: str


class OEmbedReply(BaseModel):
    """oEmbed of type link."""

    type: str = Field(description="Always link.")
    version: str = Field(description="Version of oEmbed.")
    title: str = Field(description="Gear and verdict.")
    description: str = Field(description="The figures behind them.")
    provider_name: str = Field(description="This service.")
    provider_url: str = Field(description="Its address.")
    cache_age: int = Field(description="Seconds for which it may be kept.")


def preview(reply: Mapping[str, Any], path: str, title: str | None = None) -> Preview:
    """Gear and verdict of a reply that stands at a path of this service."""
    best, english = foremost(reply["candidates"]), language("en")
    selected = reply["selected"]
    verdict = f"{selected}, suitable" if selected else "no suitable gear"
    duty = reply["duty"]
    parts = [
        f"Average torque {english.figure(duty['average_torque_Nm'])} Nm",
        f"largest torque {english.figure(duty['maximum_torque_Nm'])} Nm",
        f"average speed {english.figure(duty['average_output_speed_rpm'])} rpm",
    ]
    parts.append(f"{best['designation']}: {best['reason'].removesuffix('.')}")
    address = "/oembed?" + urlencode({"url": path, "format": "json"}) if len(path) <= LONGEST_PATH else ""
    return Preview(f"{title}: {verdict}" if title else f"HPN Select: {verdict}", ", ".join(parts) + ".", address)


@router.get(
    "/oembed",
    summary="What a link to a selection unfolds into",
    response_model=OEmbedReply,
    responses=schemas.problems(404, 406, 422),
)
async def oembed(
    request: Request,
    url: Annotated[str, Query(max_length=MAXIMUM_QUERY_BYTES, description="Address of a selection of this service.")],
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
    if address.netloc not in ("", request.url.netloc) or address.scheme not in ("", "http", "https"):
        raise unknown
    if address.path.startswith(SAVED):
        saved = await request.app.state.store.find(address.path.removeprefix(SAVED))
        if saved is None:
            raise unknown
        return preview(orjson.loads(saved.result), address.path, saved.title)
    if address.path not in ("", "/") or not address.query:
        raise unknown
    try:
        application = application_of(parse_qsl(address.query, keep_blank_values=True))
    except Problem:
        raise unknown from None
    link = to_link(application)
    return preview(select(application, request.app.state.catalogue).reply(link), link)

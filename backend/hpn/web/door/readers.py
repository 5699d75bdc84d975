"""Reader of a page: language and units from cookies and browser, and the form that changes them.

Addresses contain nothing about the reader, so a shared link shows each reader their own language and units.
"""

from urllib.parse import quote

from babel import negotiate_locale
from fastapi import APIRouter
from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from hpn.web.door.access import admit
from hpn.web.door.bodies import FORM, pairs_of, read_body
from hpn.web.door.hosts import require_same_origin
from hpn.web.door.visit import VISIT, Visit, current
from hpn.words import units
from hpn.words.reader import LANGUAGES, Reader

LANGUAGE, UNITS = "hpn_language", "hpn_units"
"""Cookies; their values are neither secret nor personal."""

POSTED_TO_ITSELF = ("/machines", "/paste")
"""Pages with a form that is posted to the page's own address."""

YEAR_S = 365 * 24 * 3600
MAXIMUM_BYTES = 70_000
"""Maximum size of a form of settings, which carries the address that it leads back to."""


class Readers:
    """Sets the reader of each request, and tells caches that pages depend on it."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on with its reader and without cookies: nothing else needs them, and the framework's time
        for a quoted cookie grows with the square of its length.
        """
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        reader = reader_from(Headers(scope=scope))
        scope.setdefault("state", {})["reader"] = reader  # for files, which the API makes too
        scope["headers"] = [header for header in scope["headers"] if header[0] != b"cookie"]
        if scope["path"].startswith(("/api/", "/static/")):
            await self.app(scope, receive, send)
            return

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                if headers.get("content-type", "").startswith("text/html"):
                    headers.add_vary_header("Accept-Language, Cookie")
                    headers["Content-Language"] = current().language
            await send(message)

        token = VISIT.set(Visit(reader, _address(scope)))
        try:
            await self.app(scope, receive, send_with_headers)
        finally:
            VISIT.reset(token)


def reader_from(headers: Headers) -> Reader:
    """Reader by cookies; by default the browser's language, or English, and SI units."""
    cookies = _cookies(headers.get("cookie", ""))
    language = cookies.get(LANGUAGE, "")
    if language not in LANGUAGES:
        language = accepted_language(headers.get("accept-language", ""))
    return Reader(language, units.codes_of(cookies.get(UNITS, "")))


def accepted_language(header: str) -> str:
    """Best of LANGUAGES for an Accept-Language header; English if none fits."""
    weighted = []
    for place, part in enumerate(header[:500].split(",")):
        tag, _, parameter = part.partition(";")
        weight = parameter.replace(" ", "").removeprefix("q=") or "1"
        if weight.strip("0.") and weight.replace(".", "", 1).isdecimal():
            weighted.append((-float(weight), place, tag.strip().replace("-", "_")))
    tags = [tag for _, _, tag in sorted(weighted) if tag]
    return negotiate_locale(tags, LANGUAGES) or "en"


def _cookies(header: str) -> dict[str, str]:
    # No library: the time of Starlette's parser grows with the square of a quoted value, and our values need no quotes.
    pairs = (part.partition("=") for part in header[:8000].split(";"))
    return {name.strip(): value.strip() for name, _, value in pairs}


def _address(scope: Scope) -> str:
    if scope["method"] not in ("GET", "HEAD"):
        return scope["path"] if scope["path"] in POSTED_TO_ITSELF else "/"
    query: bytes = scope["query_string"]
    return quote(scope["path"]) + (f"?{query.decode('latin-1')}" if query else "")


async def change(request: Request) -> Response:
    """Keep a language, units or both in cookies, and redirect to the page that the reader came from."""
    require_same_origin(request)
    body = await read_body(request, FORM, maximum_bytes=MAXIMUM_BYTES)
    fields = dict(pairs_of(body))
    response = RedirectResponse(_own(fields.get("back", "")), 303, {"Cache-Control": "no-store"})
    if (language := fields.get("language", "")) in LANGUAGES:
        _keep(request, response, LANGUAGE, language)
    if fields.get("preset") in units.PRESETS:
        _keep(request, response, UNITS, ".".join(units.PRESETS[fields["preset"]]))
    elif any(name in fields for name in units.CHOICES):
        codes = units.codes_of(".".join(fields.get(name, "") for name in units.CHOICES))
        _keep(request, response, UNITS, ".".join(codes))
    return response


def _keep(request: Request, response: Response, name: str, value: str) -> None:
    secure = request.url.scheme == "https"
    response.set_cookie(name, value or "SI", max_age=YEAR_S, samesite="lax", httponly=True, secure=secure)


def _own(address: str) -> str:
    """Address if it is on this host, else the first page: a form must not lead to another site."""
    safe = address.isascii() and address.isprintable() and "\\" not in address
    return address if safe and address.startswith("/") and not address.startswith("//") else "/"


router = APIRouter(include_in_schema=False, dependencies=[admit("calculator")])
router.add_api_route("/reader", change, methods=["POST"])

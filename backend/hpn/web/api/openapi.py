"""OpenAPI document: FastAPI's own, completed with entries that it can't derive."""

from collections.abc import Mapping
from functools import cache
from typing import Any

from fastapi import APIRouter, FastAPI
from fastapi.routing import iter_route_contexts
from pydantic import BaseModel
from pydantic.json_schema import models_json_schema
from starlette.datastructures import State
from starlette.requests import Request
from starlette.responses import Response

from hpn.web.api import schemas
from hpn.web.api.replies import encode
from hpn.web.door.access import admit, group_of
from hpn.web.door.conditions import conditional
from hpn.web.door.pools import compute
from hpn.web.settings import RouteGroup, Settings
from hpn.words.units import suffix_of, symbol_of

TAGS = [
    {"name": "Selection", "description": "Gear selection for one application or for many."},
    {"name": "Catalogue", "description": "Published figures of the gears, each with its source."},
    {"name": "Motors", "description": "The user’s own motors, and the utilisation of each on a gear."},
    {"name": "Saved selections", "description": "Saved selections: save, list, read with differences, delete."},
    {
        "name": "Machines",
        "description": "Machines with their axes and revisions; a selection is a machine with one axis.",
    },
    {"name": "Files", "description": "Report, workbook and Asset Administration Shell of a selection."},
    {"name": "Service", "description": "State of the service."},
]

SERVERS = [{"url": "/", "description": "This service."}]

KEY_SCHEMES = {
    "bearer": {"type": "http", "scheme": "bearer", "description": "A key of the service, where it has keys."},
    "key": {"type": "apiKey", "in": "header", "name": "X-API-Key", "description": "The same key in a header."},
}


router = APIRouter(include_in_schema=False, dependencies=[admit("calculator")])


@router.get("/openapi.json")
async def document(request: Request) -> Response:
    """The OpenAPI document."""
    state: State = request.app.state
    if not hasattr(state, "openapi"):
        state.openapi = await compute(request, "pages", lambda: encode(request.app.openapi()))
    return conditional(request, state.openapi)


def install(app: FastAPI, *bodies: type[BaseModel]) -> None:
    """Make `app.openapi()` return the completed document, built at its first call.

    `bodies` are the models of request bodies that routes read themselves.
    """
    generate = app.openapi

    @cache
    def openapi() -> dict[str, Any]:
        document = generate()
        models: list[Any] = [(model, "validation") for model in bodies]
        _, definitions = models_json_schema(models, ref_template="#/components/schemas/{model}")
        components = document["components"]
        components |= {"securitySchemes": KEY_SCHEMES, "headers": schemas.HEADER_COMPONENTS}
        components["schemas"] |= definitions["$defs"]
        _complete(document, _groups(app), app.state.settings)
        _give_formats(document)
        return document

    app.openapi = openapi  # type: ignore[method-assign]


def _groups(app: FastAPI) -> dict[tuple[str, str], RouteGroup | None]:
    """Group of every route by method and path."""
    routes = iter_route_contexts(app.routes)
    return {(method, route.path or ""): group_of(route) for route in routes for method in route.methods or ()}


def _complete(
    document: dict[str, Any], groups: Mapping[tuple[str, str], RouteGroup | None], settings: Settings
) -> None:
    """Add keys, headers and schemas of parameters to every operation."""
    for path, operations in document["paths"].items():
        for method, operation in operations.items():
            _say_keys(operation, groups[method.upper(), path], settings)
            _say_headers(operation)
            for parameter in operation.get("parameters", ()):
                _describe(parameter)


FORMATS = {"number": "double", "integer": "int64"}
"""Format of a number by its type: without it, clients in some languages compute in 32 bits."""


def _give_formats(part: Any, name: str = "") -> None:
    """Add the format to each number's schema in a part of the document; examples and the like are no schemas."""
    if isinstance(part, list):
        for item in part:
            _give_formats(item)
    elif isinstance(part, dict) and name not in VALUES:
        kind = part.get("type")
        if isinstance(kind, str) and kind in FORMATS:
            part.setdefault("format", FORMATS[kind])
        for key, item in part.items():
            _give_formats(item, "" if name == "properties" else key)


VALUES = ("example", "examples", "default", "const", "enum")
"""Names whose content is a value, not a schema."""


def _say_keys(operation: dict[str, Any], group: RouteGroup | None, settings: Settings) -> None:
    """Add the keys that a route accepts, and the option of no key where none is needed."""
    if group is None:
        operation["security"] = []
        return
    needed = bool(settings.api_keys) and group in settings.guarded
    operation["security"] = [*({name: []} for name in KEY_SCHEMES), *([] if needed else [{}])]


def _say_headers(operation: dict[str, Any]) -> None:
    """Add the common headers to each response of an operation, and those of a rate unless the route is open."""
    always = schemas.headers("X-Request-ID", *(("RateLimit", "RateLimit-Policy") if operation["security"] else ()))
    for response in operation["responses"].values():
        response["headers"] = response.get("headers", {}) | always


def _describe(parameter: dict[str, Any]) -> None:
    if parameter["in"] == "query":
        _leave_out_null(parameter["schema"])
        if parameter["schema"].get("type") == "array":
            parameter |= {"style": "form", "explode": True}  # the name is repeated for each value
    if suffix_of(parameter["name"]):
        parameter["schema"]["x-unit"] = symbol_of(parameter["name"])


def _leave_out_null(schema: dict[str, Any]) -> None:
    """Remove null from the schema of an optional parameter: FastAPI adds it, but a query can't express it."""
    options = [option for option in schema.get("anyOf", ()) if option != {"type": "null"}]
    if len(options) == 1:
        del schema["anyOf"]
        schema |= options[0]

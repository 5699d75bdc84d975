"""`/mcp`: tools for agents over HTTP, with the keys, rates and limits of a selection; `/llms.txt` leads there."""

from collections.abc import Mapping
from contextlib import suppress
from pkgutil import resolve_name
from typing import Any

from fastapi import APIRouter
from pydantic_core import from_json
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response

from hpn.agents.tools import ToolReply, answer
from hpn.web.door.access import admit
from hpn.web.door.bodies import read_body, require_bounded, require_unique
from hpn.web.door.hosts import require_known_origin
from hpn.web.door.pools import calculate, compute
from hpn.web.door.problems import Problem, needs
from hpn.web.door.visit import absolute

router = APIRouter(include_in_schema=False, dependencies=[admit("calculator")])

EXCHANGE = "hpn.agents.over_http:exchange"
"""Name of the function that needs the extra."""

LLMS = """# HPN Select

> Selects a Harmonic Drive HPN planetary gear for a duty cycle, and shows each limit with its equation and page.

Independent of the manufacturer: check a selection with the manufacturer before ordering. Torque and speed are at the
gear’s output; the names of fields end in their units. Never make up an input: ask the user for it.

## For agents

- [MCP]({service}/mcp): the tools select, explain and catalogue (streamable HTTP; a key, if any, as a Bearer token)
- [POST /api/v1/select]({service}/openapi.json): the whole answer as JSON, described as OpenAPI
- [Schema of an application]({service}/api/v1/application.schema.json): every input with its bounds
- [Catalogue]({service}/api/v1/catalogue): every published figure with its table and page

## For people

- [Calculator]({service}/): a link carries the whole application
- [Gears]({service}/catalogue)
- [REST]({service}/docs)
"""


@router.post("/mcp", dependencies=[needs("mcp")])
async def speak(request: Request) -> Response:
    """Answers one message of the Model Context Protocol."""
    require_known_origin(request)
    body = await read_body(request)
    require_bounded(body)
    with suppress(ValueError):  # the protocol itself answers malformed JSON
        require_unique(body, from_json(body))
    exchange = await compute(request, "pages", resolve_name, EXCHANGE)  # takes a second, the first time
    mistakes: list[Exception] = []

    async def call(tool: str, arguments: Mapping[str, Any]) -> ToolReply:
        try:
            service, catalogue = absolute(request, ""), request.app.state.catalogue
            return await calculate(request, body, answer, tool, arguments, catalogue, service)
        except Problem as problem:  # too much is being computed
            return ToolReply(problem.detail, True)
        except Exception as error:
            mistakes.append(error)
            raise

    reply = await exchange(call, request.scope, body)
    if mistakes:
        raise mistakes[0]
    return Response(reply.content, reply.status, reply.headers)


@router.get("/llms.txt")
async def llms(request: Request) -> Response:
    """The service in brief for agents, with its addresses."""
    return PlainTextResponse(LLMS.format(service=absolute(request, "")))

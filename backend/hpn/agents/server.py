"""Tools as a server of the Model Context Protocol, by its official SDK, for any transport."""

from collections.abc import Awaitable, Callable, Mapping
from typing import Any

import mcp_types as types
from mcp.server.context import ServerRequestContext
from mcp.server.lowlevel import Server

from hpn import ENGINE_VERSION
from hpn.agents.schema import INSTRUCTIONS, TOOLS
from hpn.agents.tools import ToolReply

ONLY_READS = types.ToolAnnotations(
    read_only_hint=True, destructive_hint=False, idempotent_hint=True, open_world_hint=False
)

Call = Callable[[str, Mapping[str, Any]], Awaitable[ToolReply]]
"""Function that answers a tool by its name and arguments, in any process."""


def server_of(call: Call) -> Server[Any]:
    """Server whose tools a function answers."""

    async def listed(_: ServerRequestContext[Any], __: types.PaginatedRequestParams | None) -> types.ListToolsResult:
        tools = [
            types.Tool(name=name, description=description, input_schema=schema, annotations=ONLY_READS)
            for name, (description, schema) in TOOLS.items()
        ]
        return types.ListToolsResult(tools=tools)

    async def called(_: ServerRequestContext[Any], params: types.CallToolRequestParams) -> types.CallToolResult:
        answer = await call(params.name, params.arguments or {})
        return types.CallToolResult(content=[types.TextContent(text=answer.text)], is_error=answer.is_refusal)

    return Server(
        "hpn-select",
        version=ENGINE_VERSION,
        instructions=INSTRUCTIONS,
        on_list_tools=listed,
        on_call_tool=called,
    )

"""`hpn mcp`: the tools for agents over standard input and output."""

import argparse
from collections.abc import Mapping
from typing import Any

import anyio
from anyio.to_thread import run_sync
from mcp.server.stdio import stdio_server

from hpn.agents.server import server_of
from hpn.agents.tools import ToolReply, answer
from hpn.web.settings import Settings


def run(options: argparse.Namespace) -> int:
    """Answer until the input ends."""
    settings = Settings()
    catalogue = settings.catalogue()
    service = (options.service or f"http://{settings.host}:{settings.port}").rstrip("/")

    async def call(tool: str, arguments: Mapping[str, Any]) -> ToolReply:
        return await run_sync(answer, tool, arguments, catalogue, service)

    anyio.run(_serve, server_of(call))
    return 0


async def _serve(server: Any) -> None:
    async with stdio_server() as (messages, answers):
        await server.run(messages, answers, server.create_initialization_options())

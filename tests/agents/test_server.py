"""The server of the tools, spoken to by the official client: over standard input and output, and over HTTP."""

import json
import os
import subprocess
from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any, Literal

import httpx2
import mcp_types as types
import pytest
from mcp.client.client import Client
from mcp.client.stdio import StdioServerParameters
from mcp.client.streamable_http import streamable_http_client

from hpn.agents.schema import INSTRUCTIONS, TOOLS
from hpn.web.door.keys import new_key
from tests.build import Json, cycle, worked_example
from tests.operations.service import HPN, Service, serving

MODES: list[Literal["legacy", "auto"]] = ["legacy", "auto"]
"""With the handshake of the protocol's earlier versions, and as its newest has it."""
WAYS = [(way, mode) for way in ("stdio", "http") for mode in MODES]


@pytest.fixture
def anyio_backend() -> str:
    """Event loop of the asynchronous tests."""
    return "asyncio"


@pytest.fixture(scope="module")
def key() -> tuple[str, str]:
    """A key of the service and its pair for the settings."""
    return new_key("agent")


@pytest.fixture(scope="module")
def service(key: tuple[str, str], tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service whose calculator needs a key."""
    settings = {"HPN_API_KEYS": key[1], "HPN_GUARDED": "calculator"}
    with serving(tmp_path_factory.mktemp("agents"), settings) as running:
        yield running


@asynccontextmanager
async def over_http(service: Service, key: str, mode: Literal["legacy", "auto"]) -> AsyncIterator[Client]:
    """The official client at `/mcp`, with a key."""
    headers = {"Authorization": f"Bearer {key}"}
    async with (
        httpx2.AsyncClient(headers=headers, trust_env=False) as http,
        Client(streamable_http_client(f"{service.url}/mcp", http_client=http), mode=mode) as client,
    ):
        yield client


@asynccontextmanager
async def over_stdio(folder: Path, mode: Literal["legacy", "auto"]) -> AsyncIterator[Client]:
    """The official client at `hpn mcp`."""
    command = StdioServerParameters(command=str(HPN), args=["mcp", "--service", "https://plm.example/"], cwd=folder)
    async with Client(command, mode=mode) as client:
        yield client


@pytest.fixture(params=WAYS, ids=" ".join)
async def client(
    request: pytest.FixtureRequest, service: Service, key: tuple[str, str], tmp_path: Path, anyio_backend: str
) -> AsyncIterator[Client]:
    """The client, over each way and version of the protocol."""
    way, mode = request.param
    async with over_http(service, key[0], mode) if way == "http" else over_stdio(tmp_path, mode) as client:
        yield client


async def told(client: Client, tool: str, **arguments: Any) -> Json:
    """Answer of a tool, which is no refusal and fits."""
    result = await client.call_tool(tool, arguments)
    assert isinstance(result, types.CallToolResult)
    (content,) = result.content
    assert isinstance(content, types.TextContent)
    assert not result.is_error, content.text
    assert len(result.model_dump_json(by_alias=True).encode()) < 4000
    reply: Json = json.loads(content.text)
    return reply


@pytest.mark.anyio
async def test_an_agent_selects_the_worked_example_and_explains_a_rejected_gear(client: Client) -> None:
    listed = await client.list_tools()
    decision = await told(client, "select", application=worked_example(requirements={"ratios": [5]}))
    rejected = await told(client, "explain", application=worked_example(), designation="HPN-14A-5")
    figures = await told(client, "catalogue", designation="HPN-20A-5")
    refused = await client.call_tool("select", {"application": cycle({"torque_Nm": 40})})

    assert [tool.name for tool in listed.tools] == list(TOOLS)
    assert 2000 < len(listed.model_dump_json(by_alias=True, exclude_none=True)) < 3000
    assert client.instructions == INSTRUCTIONS
    assert (decision["selected"], decision["status"]) == ("HPN-20A-5", "suitable")
    torque = dict(zip(decision["limits"]["columns"], decision["limits"]["rows"][0], strict=True))
    assert torque["demand"] == pytest.approx(32.021, rel=1e-4)  # as chapter 4.1 prints it
    assert torque["source"] == "eq. 17.2 · table 12.1, p. 12"
    assert decision["link"].endswith("&tp=4&Tk=200&i=5")
    assert (rejected["gear"], rejected["status"]) == ("HPN-14A-5", "unsuitable")
    assert rejected["fits_if"].startswith("Fits if")
    assert figures["gear"] == "HPN-20A-5"
    assert isinstance(refused, types.CallToolResult)
    assert refused.is_error
    assert "/duty_cycle/phases/0/speed_rpm (Speed, rpm): is required" in refused.model_dump_json()


@pytest.mark.anyio
async def test_links_lead_to_the_service_that_was_asked_or_named(
    service: Service, key: tuple[str, str], tmp_path: Path
) -> None:
    async with over_http(service, key[0], "legacy") as client:
        assert (await told(client, "catalogue"))["link"] == f"{service.url}/catalogue"
    async with over_stdio(tmp_path, "legacy") as client:
        assert (await told(client, "catalogue"))["link"] == "https://plm.example/catalogue"


def test_input_that_ends_ends_the_command() -> None:
    clean = {name: value for name, value in os.environ.items() if not name.startswith("HPN_")}

    run = subprocess.run([HPN, "mcp"], input=b'{"no": "message"}\n[\n', capture_output=True, env=clean, timeout=60)

    assert (run.returncode, run.stderr) == (0, b"")


# --- HTTP without a client --------------------------------------------------------------------------------------------

ACCEPT = {"Accept": "application/json, text/event-stream"}


def post(service: Service, body: object, key: str = "", **headers: str) -> Any:
    """Answer to a body at `/mcp`."""
    content = body if isinstance(body, bytes) else json.dumps(body).encode()
    sent: Mapping[str, str] = {"Content-Type": "application/json", "X-API-Key": key, **ACCEPT, **headers}
    return service.client.post("/mcp", content=content, headers={name: text for name, text in sent.items() if text})


PING = {"jsonrpc": "2.0", "id": 1, "method": "ping"}


def test_it_stands_behind_the_keys_of_a_selection(service: Service, key: tuple[str, str]) -> None:
    assert [post(service, PING, sent).status_code for sent in ("", "wrong", key[0])] == [401, 401, 200]
    assert post(service, PING).headers["WWW-Authenticate"].startswith("Bearer")


def test_a_page_of_another_site_is_refused(service: Service, key: tuple[str, str]) -> None:
    own, other = f"http://127.0.0.1:{service.port}", "https://elsewhere.example"

    assert [post(service, PING, key[0], Origin=origin).status_code for origin in (own, other, "null")] == [
        200,
        403,
        403,
    ]


def test_it_has_the_bounds_of_a_selection(service: Service, key: tuple[str, str]) -> None:
    long = b'{"a": "' + b"x" * 2_000_000 + b'"}'
    nested = b"[" * 90_000

    assert post(service, long, key[0]).status_code == 413
    assert post(service, nested, key[0]).status_code == 422
    assert post(service, b'{"a": 1, "a": 2}', key[0]).status_code == 422
    assert post(service, PING, key[0], **{"Content-Type": "text/plain"}).status_code == 415
    assert service.client.get("/mcp", headers={"X-API-Key": key[0]}).status_code == 405


def call(arguments: object, name: object = "select") -> Json:
    """Message that calls a tool."""
    return {"jsonrpc": "2.0", "id": 1, "method": "tools/call", "params": {"name": name, "arguments": arguments}}


HOSTILE: list[object] = [
    *(b"", b"{", b"[]", b"null", b"1", b"9" * 10_000, b"\xff\xfe", b'{"a":' * 5000),
    *([PING], {**PING, "id": {}}, {**PING, "method": 1}, {**PING, "method": "subscriptions/listen"}),
    b'{"jsonrpc":"2.0","id":1e999,"method":"ping"}',
    *(call([]), call({}, 1), call({}, "\ud800"), call({"application": {"\ud800": 1}}), call({"application": [[]]})),
    call({"application": cycle({"torque_Nm": float("nan"), "speed_rpm": 1e308, "duration_s": 1e-308})}),
    call({"application": worked_example(), "designation": "\ud800"}, "explain"),
    {"jsonrpc": "2.0", "id": 1, "result": {}},
    {"jsonrpc": "2.0", "method": "notifications/cancelled", "params": {"requestId": 1}},
]
META = {
    "io.modelcontextprotocol/protocolVersion": "2026-07-28",
    "io.modelcontextprotocol/clientCapabilities": {},
    "io.modelcontextprotocol/clientInfo": {"name": "x", "version": "1"},
}


@pytest.mark.parametrize("version", ["", "2025-06-18", "2026-07-28", "none"])
@pytest.mark.parametrize("number", range(len(HOSTILE)))
def test_hostile_messages_are_refused(number: int, version: str, service: Service, key: tuple[str, str]) -> None:
    message = HOSTILE[number]
    if version == "2026-07-28" and isinstance(message, dict):
        message = {**message, "params": {**message.get("params", {}), "_meta": META}}

    answer = post(service, message, key[0], **{"MCP-Protocol-Version": version})

    assert answer.status_code < 500
    assert len(answer.content) < 4000
    assert "Traceback" not in answer.text


def test_what_was_asked_is_in_no_log(service: Service, key: tuple[str, str]) -> None:
    post(service, b'{"jsonrpc": "2.0", "secret_of_the_caller": ', key[0])
    post(service, call({"secret_of_the_caller": 1}, "secret_of_the_caller"), key[0])

    assert "secret_of_the_caller" not in service.log.read_text()
    assert not [event for event in service.events() if event.get("logger", "").startswith("mcp")]


def test_a_text_for_agents_leads_to_every_door(service: Service, key: tuple[str, str]) -> None:
    text = service.client.get("/llms.txt", headers={"X-API-Key": key[0]}).text

    assert text.startswith("# HPN Select\n")
    for path in ("/mcp", "/openapi.json", "/api/v1/application.schema.json", "/api/v1/catalogue", "/catalogue"):
        assert f"({service.url}{path})" in text
        if path != "/mcp":
            assert service.client.get(path, headers={"X-API-Key": key[0]}).status_code == 200

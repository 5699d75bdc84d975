"""The gate over the wire: no spelling of an address, method or header reaches a guarded route without a key."""

import itertools
import socket
from collections.abc import Iterable, Iterator
from contextlib import closing
from http.client import HTTPException, HTTPResponse
from typing import NamedTuple

import pytest
from fastapi.routing import iter_route_contexts

from hpn.web.app import create_app
from hpn.web.door.access import group_of
from hpn.web.door.keys import new_key
from hpn.web.settings import RouteGroup
from tests.operations.service import Service, serving

GROUPS = "calculator,batch,writing,listing,deleting,reading,metrics"
KEY, PAIR = new_key("plm")
ID = "A" * 22
VALUES = {"{id}": ID, "{designation}": "HPN-20A-5", "{size}": "20A"}


class Route(NamedTuple):
    """A method, an address that leads to its route, and the route's group."""

    method: str
    path: str
    group: RouteGroup | None


CONTEXTS = list(iter_route_contexts(create_app().routes))
GUARDED = {str(context.path) for context in CONTEXTS if group_of(context)}


def every_route() -> Iterator[Route]:
    """Routes that declare a group, each also by HEAD where it has GET."""
    for context in CONTEXTS:
        path = str(context.path)
        for name, value in VALUES.items():
            path = path.replace(name, value)
        for method in sorted(context.methods or ()):
            if (group := group_of(context)) is not None:
                yield from (Route(each, path, group) for each in (method, *(["HEAD"] if method == "GET" else [])))


ROUTES = list(every_route())
OF_EACH_GROUP = list({(route.method, route.group): route for route in ROUTES}.values())

SPELLINGS = (
    *(
        "{path}" + end
        for end in ("%0a", "%0A", "%0d", "%0d%0a", "%00", "%09", "%20", "%7f", "%1f", "%c2%85", "%e2%80%a8")
    ),
    *("{path}" + end for end in ("/", "//", "/.", "/..", "/%2e%2e/", ";", ";a=b", "%3b", "%2f", "%252f", "%5c", "\\")),
    *("{path}" + end for end in ("?", "?key=admin", "?_method=GET", "#x", "%23", "%3f", ".json", "~", "*", ",")),
    "/{path}",
    "/.{path}",
    "/x/..{path}",
    "/%2e{path}",
    "/healthz/..{path}",
    "/healthz/..%2f..{path}",
    "/static/..{path}",
    "/static/%2e%2e{path}",
    "http://a{path}",
    "https://evil.example{path}",
    "http://evil.example:99/{path}",
    "{upper}",
    "{encoded}",
    "{twice}",
    "{overlong}",
    "{wide}",
    "{doubled}",
    "{dotted}",
    "{path}{path}",
    " {path}",
    "{path} ",
    "{path}\x0b",
    "{path}\x01",
    "{path}\xa0",
    "{path}\x00",
)

OVERRIDES = (
    "X-HTTP-Method-Override: {method}",
    "X-HTTP-Method: {method}",
    "X-Method-Override: {method}",
    "X-Original-URL: {path}",
    "X-Rewrite-URL: {path}",
    "X-Original-URI: {path}",
    "X-Forwarded-Prefix: {path}",
    "X-Forwarded-Path: {path}",
    "X-Forwarded-For: 127.0.0.1\r\nX-Forwarded-Proto: https",
    "X-API-Key: ",
    "X-API-Key: plm",
    "Authorization: Basic cGxtOg==",
    "Authorization: Bearer " + PAIR.partition(":")[2],
)
"""Headers that some proxy or framework takes for another method or address, and keys that are none."""


def spelled(path: str, spelling: str) -> str:
    """An address in another spelling."""
    last = path.rpartition("/")[2]
    return spelling.format(
        path=path,
        upper=path.swapcase(),
        encoded="/" + "".join(f"%{ord(letter):02x}" if letter != "/" else "/" for letter in path[1:]),
        twice=path[:-1] + f"%25{ord(path[-1]):02x}",
        overlong=path[:-1] + "%c0%" + f"{0x80 | ord(path[-1]) & 0x3F:02x}",
        wide=path[:-1] + f"%ef%bd%{0x20 + ord(path[-1]) & 0x3F | 0x80:02x}",
        doubled=path.replace("/", "//"),
        dotted=path.removesuffix(last) + "./" + last,
    )


class Wire:
    """A connection that sends bytes as they are, and is opened anew where the service has closed it."""

    def __init__(self, port: int) -> None:
        self._port = port
        self._socket: socket.socket | None = None

    def ask(self, method: str, target: str, *headers: str) -> tuple[int, bytes]:
        """Status and body of an answer; 0 where the connection was closed without one."""
        lines = [f"{method} {target} HTTP/1.1", "Host: localhost", "Content-Length: 0", *headers]
        request = ("\r\n".join(lines) + "\r\n\r\n").encode("latin-1")
        for _ in range(2):  # the service may have closed the connection that the answer before came on
            self._socket = self._socket or socket.create_connection(("127.0.0.1", self._port), 30)
            try:
                self._socket.sendall(request)
                answer = HTTPResponse(self._socket, method=method)
                answer.begin()
                body = answer.read()
            except (OSError, HTTPException):
                self.close()
                continue
            if answer.will_close:
                self.close()
            return answer.status, body
        return 0, b""

    def close(self) -> None:
        """End the connection."""
        if self._socket is not None:
            self._socket.close()
        self._socket = None


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service on which everything that can be guarded is."""
    limits = {f"HPN_{name}_RATE": "off" for name in ("CALCULATOR", "BATCH", "WRITING")}
    settings = {"HPN_API_KEYS": PAIR, "HPN_GUARDED": GROUPS, **limits}
    with serving(tmp_path_factory.mktemp("gate"), settings) as running:
        yield running


def admitted(service: Service, attempts: Iterable[tuple[str, str, tuple[str, ...]]]) -> tuple[int, list[object]]:
    """Number of attempts, and those that got further than the gate, by answer or by the log."""
    allowed = {0, 307, 308, 400, 401, 404, 405, 414, 431}
    before, count = len(service.events()), 0
    result: list[object] = []
    with closing(Wire(service.port)) as wire:
        for method, target, headers in attempts:
            count += 1
            status, body = wire.ask(method, target, *headers)
            if status not in allowed or b"Traceback" in body:
                result.append((method, target, headers, status))
    for event in service.events()[before:]:
        if event.get("key"):  # a line of the requests before these, which had one
            continue
        if event.get("route") in GUARDED and event["status"] not in (401, 405):  # 405: of no route at all
            result.append(event)
    return count, result


def test_a_key_opens_what_is_closed_without_it(guarded: Service) -> None:
    with closing(Wire(guarded.port)) as wire:
        without = {route: wire.ask(route.method, route.path)[0] for route in ROUTES}
        with_key = {route: wire.ask(route.method, route.path, f"X-API-Key: {KEY}")[0] for route in ROUTES}

    assert len(ROUTES) > 50
    assert set(without.values()) == {401}
    assert {with_key.pop(route) for route in ROUTES if route.path == "/oembed"} == {410}
    assert {with_key.pop(route) for route in ROUTES if route.path.startswith(("/fleets", "/machines/saved"))} == {308}
    assert set(with_key.values()) <= {200, 201, 204, 303, 404, 415, 422}


def test_no_spelling_of_an_address_gets_past_the_gate(guarded: Service) -> None:
    attempts = ((route.method, spelled(route.path, text), ()) for route, text in itertools.product(ROUTES, SPELLINGS))

    count, result = admitted(guarded, attempts)

    assert len(SPELLINGS) >= 30
    assert count == len(ROUTES) * len(SPELLINGS)
    assert result == []


def test_no_header_gets_past_the_gate(guarded: Service) -> None:
    def attempts() -> Iterator[tuple[str, str, tuple[str, ...]]]:
        for route, header in itertools.product(OF_EACH_GROUP, OVERRIDES):
            yield route.method, route.path, (header.format(method="GET", path="/healthz"),)

    _, result = admitted(guarded, attempts())

    assert result == []


def test_no_header_turns_an_open_route_into_a_guarded_one(guarded: Service) -> None:
    with closing(Wire(guarded.port)) as wire:
        answers = {
            wire.ask("GET", "/healthz", header.format(method=route.method, path=route.path))
            for route, header in itertools.product(OF_EACH_GROUP, OVERRIDES)
        }

    assert answers == {(200, b'{"status":"ok"}')}


@pytest.mark.soak
def test_no_byte_anywhere_in_an_address_gets_past_the_gate(guarded: Service) -> None:
    """Every byte, plain and encoded once and twice, at every place; every method; spellings of spellings."""
    methods = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS", "TRACE", "get", "FOO", "PROPFIND", "QUERY")
    paths = sorted({route.path for route in ROUTES})
    encoded = [f"%{byte:02x}" for byte in range(256)]
    written = [*(chr(byte) for byte in range(1, 256)), *encoded, *(f"%25{byte:02X}" for byte in range(256))]

    def attempts() -> Iterator[tuple[str, str, tuple[str, ...]]]:
        for (method, path, _), text in itertools.product(OF_EACH_GROUP, written):
            if text not in "\r\n ":  # those end the address, and so the request line
                for place in (1, len(path) - 1, len(path)):
                    yield method, path[:place] + text + path[place:], ()
        for (method, path, _), text in itertools.product(ROUTES, encoded):
            yield method, path + text, ()
        for method, path, text in itertools.product(methods, paths, SPELLINGS):
            yield method, spelled(path, text), ()
        for (method, path, _), one, other in itertools.product(OF_EACH_GROUP, SPELLINGS, SPELLINGS):
            yield method, spelled(spelled(path, one), other), ()

    count, result = admitted(guarded, attempts())

    assert count > 80_000
    assert result == []

"""API keys: who may do what, and what a key looks like at rest."""

import base64
import hashlib
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import cache

import pytest
from fastapi import FastAPI
from fastapi.routing import APIRoute, RouteContext, iter_route_contexts
from pydantic import ValidationError
from starlette.responses import Response
from starlette.testclient import TestClient

from hpn.cli import main
from hpn.web.app import create_app
from hpn.web.door.access import group_of
from hpn.web.door.keys import holder, new_key
from hpn.web.settings import Settings
from tests.build import worked_example
from tests.operations.conftest import MakeClient

SAVE = {"application": worked_example()}
REQUESTS = {
    "calculator": ("POST", "/api/v1/select", worked_example()),
    "batch": ("POST", "/api/v1/select/batch", {"applications": []}),
    "writing": ("POST", "/api/v1/selections", SAVE),
    "listing": ("GET", "/api/v1/selections", None),
    "deleting": ("DELETE", "/api/v1/selections/AAAAAAAAAAAAAAAAAAAAAA", None),
    "reading": ("GET", "/api/v1/selections/AAAAAAAAAAAAAAAAAAAAAA", None),
    "metrics": ("GET", "/metrics", None),
}
"""One request of each group; 404 is an answer of the route, and so tells that the gate was open."""


Guarding = Callable[[str], tuple[TestClient, str]]


@pytest.fixture(scope="module")
def guarding(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Guarding]:
    """Client of a service that guards groups, and a key for it; one service for each choice of groups."""
    with ExitStack() as stack:

        @cache
        def serve(guarded: str) -> tuple[TestClient, str]:
            key, pair = new_key("plm")
            database = f"sqlite:///{tmp_path_factory.mktemp('guarding')}/store.sqlite3"
            app = create_app(Settings(database_url=database, api_keys=pair, guarded=guarded))
            return stack.enter_context(TestClient(app, raise_server_exceptions=False)), key

        yield serve


@pytest.mark.parametrize("group", REQUESTS)
@pytest.mark.parametrize("guarded", [*REQUESTS, "batch,writing,listing,deleting"])
def test_a_guarded_group_needs_a_key_and_any_other_does_not(group: str, guarded: str, guarding: Guarding) -> None:
    client, key = guarding(guarded)
    method, path, body = REQUESTS[group]

    without = client.request(method, path, json=body)
    wrong = client.request(method, path, json=body, headers={"X-API-Key": key[:-1]})
    right = client.request(method, path, json=body, headers={"X-API-Key": key})

    assert right.status_code in (200, 201, 404)
    expected = 401 if group in guarded.split(",") else right.status_code
    assert without.status_code == expected
    assert wrong.status_code == 401  # on an open route, too: whoever sends a key means it


MOTORS = [{"designation": "M-1", "rated_torque_Nm": 1.3, "rated_speed_rpm": 3000}]
CYCLE = "T=40&n=250&t=0.3"


def test_no_page_shows_saved_data_that_the_key_of_another_group_guards(guarding: Guarding) -> None:
    """Pages that calculate with a saved list, axis or selection need the key of `reading`, too."""
    client, key = guarding("reading")
    own = {"X-API-Key": key}
    machine = client.post("/api/v1/machines", json={"axes": [{"application": worked_example()}]}, headers=own).json()
    motors = client.post("/api/v1/motor-lists", json={"name": "Ours", "motors": MOTORS}, headers=own).json()
    selection = client.post("/api/v1/selections", json=SAVE, headers=own).json()
    pairs = {"application": worked_example(), "list": motors["id"]}
    marked = {"new": "selections", "id": selection["id"]}

    for headers, status in (({}, {401}), (own, {200, 303})):
        answers = [
            client.get(f"/pairs?{CYCLE}&list={motors['id']}", headers=headers),
            client.post("/api/v1/pairs", json=pairs, headers=headers),
            client.get(f"/machines/{machine['id']}/axes/1", headers=headers),
            client.post("/machines", data=marked, headers=headers, follow_redirects=False),
        ]
        assert {answer.status_code for answer in answers} <= status, [answer.text for answer in answers]


def test_the_page_of_pairs_names_no_list_of_motors_that_only_a_key_may_list(guarding: Guarding) -> None:
    client, key = guarding("listing")
    client.post("/api/v1/motor-lists", json={"name": "Prototype drive", "motors": MOTORS}).raise_for_status()

    assert "Prototype drive" not in client.get(f"/pairs?{CYCLE}").text
    assert "Prototype drive" in client.get(f"/pairs?{CYCLE}", headers={"X-API-Key": key}).text


SPELLINGS = (
    "{path}%0a",
    "{path}%0A",
    "{path}%0d",
    "{path}%00",
    "{path}/",
    "/{path}",
    "{path}%20",
    "{path};",
    "{path}%2f",
)


@pytest.mark.parametrize("group", REQUESTS)
@pytest.mark.parametrize("spelling", SPELLINGS)
def test_no_other_spelling_of_a_path_walks_past_the_key(group: str, spelling: str, guarding: Guarding) -> None:
    """The router takes `/api/v1/selections` with a line feed behind it for the same: what it matches decides."""
    client, _ = guarding(",".join(REQUESTS))
    method, path, body = REQUESTS[group]

    response = client.request(method, spelling.format(path=path), json=body, follow_redirects=False)

    assert response.status_code in (307, 401, 404, 405), response.text


def test_a_key_is_needed_by_default_for_writing_listing_deleting_and_batch() -> None:
    assert Settings().guarded == {"writing", "listing", "deleting", "batch"}


def test_without_keys_nothing_is_guarded(make_client: MakeClient) -> None:
    client = make_client()

    assert client.post("/api/v1/selections", json=SAVE).status_code == 201
    assert client.get("/api/v1/selections").status_code == 200


@pytest.mark.parametrize(
    "header",
    [
        lambda key: {"X-API-Key": key},
        lambda key: {"Authorization": f"Bearer {key}"},
        lambda key: {"Authorization": f"bearer  {key}"},
        lambda key: {"Authorization": "Basic " + base64.b64encode(f"me:{key}".encode()).decode()},
    ],
)
def test_a_key_is_sent_in_any_of_three_ways(header: object, make_client: MakeClient) -> None:
    assert callable(header)
    key, pair = new_key("plm")
    client = make_client(api_keys=f"other:{'0' * 64}, {pair}")

    assert client.get("/api/v1/selections", headers=header(key)).status_code == 200


@pytest.mark.parametrize("value", ["", "Bearer", "Bearer ", "Basic !!", "Basic bWU=", "Digest x", "Bearer \xff"])
def test_a_malformed_credential_is_a_401(value: str, make_client: MakeClient) -> None:
    client = make_client(api_keys=new_key("plm")[1])

    response = client.get("/api/v1/selections", headers={b"Authorization": value.encode("latin-1")})

    assert response.status_code == 401


def test_a_401_is_a_problem_that_says_how_to_authenticate(make_client: MakeClient) -> None:
    client = make_client(api_keys=new_key("plm")[1])

    api = client.get("/api/v1/selections")
    page = client.post("/selections", data={"link": "/?T=1"})

    assert api.headers["Content-Type"] == page.headers["Content-Type"] == "application/problem+json"
    assert api.json()["status"] == 401
    assert api.headers["WWW-Authenticate"] == 'Bearer realm="HPN Select"'
    assert page.headers["WWW-Authenticate"] == 'Basic realm="HPN Select"'


def test_a_wrong_key_and_no_key_read_differently(make_client: MakeClient) -> None:
    key, pair = new_key("plm")
    client = make_client(api_keys=pair)

    none = client.get("/api/v1/selections")
    wrong = client.get("/api/v1/selections", headers={"X-API-Key": key[:-1]})

    assert (none.status_code, wrong.status_code) == (401, 401)
    assert (none.json()["type"], wrong.json()["type"]) == ("/problems/api-key-needed", "/problems/api-key-unknown")
    assert "a key is needed" in none.json()["detail"]
    assert "is none of this service" in wrong.json()["detail"]
    assert key[:-1] not in wrong.text
    assert none.headers["WWW-Authenticate"] == wrong.headers["WWW-Authenticate"]


@pytest.mark.parametrize(
    ("language", "needed", "unknown"),
    [
        ("en", "An API key is needed", "The API key is unknown"),
        ("de", "Ein API-Schlüssel ist erforderlich", "Der API-Schlüssel ist unbekannt"),
    ],
)
def test_a_reader_gets_the_page_of_a_key_that_is_missing_or_unknown(
    make_client: MakeClient, language: str, needed: str, unknown: str
) -> None:
    client = make_client(api_keys=new_key("plm")[1])
    read = {"Accept": "text/html,*/*", "Cookie": f"hpn_language={language}"}

    none, wrong = (client.get("/selections", headers=read | more) for more in ({}, {"X-API-Key": "hpn_x"}))

    for answer, title in ((none, needed), (wrong, unknown)):
        assert answer.status_code == 401
        assert answer.headers["WWW-Authenticate"] == 'Basic realm="HPN Select"'
        assert f"<h2>{title}" in answer.text


def test_a_403_says_whether_a_key_was_sent(make_client: MakeClient) -> None:
    keys = {name: new_key(name) for name in ("plm", "erp")}
    client = make_client(api_keys=",".join(pair for _, pair in keys.values()), guarded="writing")
    own, other = ({"X-API-Key": keys[name][0]} for name in keys)
    place = client.post("/api/v1/selections", json=SAVE, headers=own).headers["Location"]

    none, wrong = client.delete(place), client.delete(place, headers=other)

    assert (none.status_code, wrong.status_code) == (403, 403)
    assert none.json()["detail"].startswith("no key was sent; only")
    assert wrong.json()["detail"].startswith("the key erp did not save it; only")


def test_a_key_never_appears_in_its_pair_nor_in_the_settings() -> None:
    key, pair = new_key("plm")
    name, digest = pair.split(":")

    assert name == "plm"
    assert digest == hashlib.sha256(key.encode()).hexdigest()
    assert key not in repr(Settings(api_keys=pair))


def test_every_key_is_compared_even_after_one_has_matched(monkeypatch: pytest.MonkeyPatch) -> None:
    key, pair = new_key("first")
    keys = Settings(api_keys=f"{pair} second:{'0' * 64} third:{'1' * 64}").api_keys
    compared = []

    def compare(one: bytes, other: bytes) -> bool:
        compared.append(one)
        return one == other

    monkeypatch.setattr("hpn.web.door.keys.hmac.compare_digest", compare)

    assert holder(key.encode(), keys) == "first"
    assert len(compared) == 3


@pytest.mark.parametrize("pairs", ["secret", "plm:secret", f"a b:{'0' * 64}", f":{'0' * 64}"])
def test_a_text_that_is_no_pair_stops_the_start_and_is_not_repeated(pairs: str) -> None:
    with pytest.raises(ValidationError, match="hpn key NAME") as refused:
        Settings(api_keys=pairs)

    assert "secret" not in refused.value.errors(include_input=False)[0]["msg"]


def test_the_command_prints_a_key_and_the_pair_that_admits_it(
    capsys: pytest.CaptureFixture[str], make_client: MakeClient
) -> None:
    assert main(["key", "plm"]) == 0
    _, key, _, pair = (line.strip() for line in capsys.readouterr().out.splitlines())

    assert make_client(api_keys=pair).get("/api/v1/selections", headers={"X-API-Key": key}).status_code == 200
    assert main(["key", "no spaces"]) == 2


LISTS = ("/selections", "/machines", "/machines/saved", "/motor-lists")


def test_every_route_belongs_to_the_group_that_its_method_and_address_suggest() -> None:
    open_to_all = {"/healthz", "/readyz", "/static/{name:path}"}
    routes = {(method, str(route.path)): group_of(route) for route in every_route() for method in route.methods or ()}
    assert len(routes) > 40
    for (method, path), group in sorted(routes.items()):
        if path in open_to_all:
            assert group is None, path
        elif path == "/metrics":
            assert group == "metrics"
        elif path.endswith(("/select/batch", "/fleet")) or (path, method) == ("/machines", "POST"):
            assert group == "batch"
        elif path.removeprefix("/api/v1") in LISTS and method == "GET":
            assert group == "listing"
        elif path == "/machines/{id}/axes/{number}":  # the workbench on an axis, which a form may be posted to
            assert group == "reading"
        elif "/selections" in path or "/machines" in path or "/motor-lists" in path:
            expected = {"GET": "reading", "POST": "writing"} | dict.fromkeys(("PUT", "PATCH", "DELETE"), "deleting")
            sent_to = ("/rename", "/delete", *(("/change", "/save", "/axes", "/revisions") if method == "POST" else ()))
            changes = path.endswith(sent_to)
            assert group == ("deleting" if changes else expected[method]), path
        else:
            assert group == "calculator", path


def test_a_route_that_declares_no_group_is_found() -> None:
    app = FastAPI(openapi_url=None)
    app.add_api_route("/forgotten", lambda: None)
    app.add_route("/of/starlette", lambda request: Response())

    for route in iter_route_contexts(app.routes):
        with pytest.raises(LookupError, match=f"{route.path} declares no group"):
            group_of(route)


def every_route() -> list[RouteContext]:
    """Every route, of the document and beside it; there is no other kind than FastAPI's own."""
    routes = list(iter_route_contexts(create_app().routes))
    assert {type(route.original_route) for route in routes} == {APIRoute}
    return routes

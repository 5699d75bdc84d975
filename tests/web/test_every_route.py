"""Promises of every route: HEAD like GET, a limit on the length of links, compressed JSON, headers of one host."""

import gzip
import re
from typing import Any

import pytest
from fastapi import FastAPI
from fastapi.routing import iter_route_contexts
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.door.access import MAXIMUM_QUERY_BYTES, group_of
from hpn.web.pages.assets import Assets
from tests.build import phase, worked_example
from tests.fleet.sized import machine_draft
from tests.fleet.tables import row_of
from tests.store.test_machines import MOST_BYTES

LINK = "T=40&n=250&t=0.3&T=32&n=500&t=3&tp=4&i=5"
QUERIES = {
    "/api/v1/machines/{id}/differences": "from=saved&to=now",
    "/api/v1/machines/{id}/differences.pdf": "from=saved&to=now",
    "/api/v1/machines/{id}/differences.xlsx": "from=saved&to=today",
    "/application.json": LINK,
    "/cycle.csv": LINK,
    "/report.pdf": LINK,
    "/report.xlsx": LINK,
    "/submodel.aasx": LINK,
    "/find": "gear=HPN-20A-5",
    "/selections/compare": "a={id}&b={id}",
}
"""Query of each route that needs one."""

ALL = list(iter_route_contexts(create_app().routes))
ROUTES = [route for route in ALL if "GET" in (route.methods or ())]
PATHS = {str(route.path): group_of(route) for route in ROUTES}
LIMITED = [path for path, group in PATHS.items() if group is not None]
ENDED = "/oembed"
"""A route that answers 410, for one version."""

OF_EACH_REQUEST = {"x-request-id", "ratelimit", "date"}


@pytest.fixture(scope="module")
def saved(api: TestClient) -> str:
    """Id of a saved selection."""
    return str(api.post("/api/v1/selections", json={"application": worked_example()}).json()["id"])


@pytest.fixture(scope="module")
def machine(api: TestClient, service: FastAPI) -> str:
    """Id of a machine that was sized."""
    draft = machine_draft([row_of("hub", worked_example())], service.state.catalogue)
    assert api.portal is not None
    id: str = api.portal.call(service.state.store.keep_machine, draft, MOST_BYTES)
    return id


@pytest.fixture
def address(saved: str, machine: str) -> "Address":
    """Function that makes an address from a route's path."""
    return Address(saved, machine)


class Address:
    """Valid addresses, one for each route."""

    def __init__(self, saved: str, machine: str) -> None:
        self.values = {
            "motor-lists/{id}": "motor-lists/server",
            "{id}": saved,
            "{machine}": machine,
            "{designation}": "HPN-20A-5",
            "{size}": "20A",
            "{code}": "average_torque",
            "{rest:path}": machine,
            "{name}": "not-found",
            "{number}": "1",
            "{label}": "saved",
            "{name:path}": Assets.load().url("page.css").removeprefix("/static/"),
        }

    def __call__(self, path: str) -> str:
        """Address of a path with its query."""
        place = "?".join(filter(None, (path, QUERIES.get(path))))
        for name, value in self.values.items():
            place = place.replace(name, value)
        assert "{" not in place
        return place


@pytest.fixture(scope="module")
def answers(api: TestClient, saved: str, machine: str) -> dict[str, Any]:
    """Answer of each route, by its path."""
    address = Address(saved, machine)
    return {path: api.get(address(path), headers=coding(path), follow_redirects=False) for path in PATHS}


def coding(path: str) -> dict[str, str]:
    """Header with the coding of a path: none for the calculator's page, as a random key varies its packed length."""
    return {"Accept-Encoding": "identity" if path in ("/", "/selections/{id}/copy") else "gzip"}


def headers_of(answer: Any) -> dict[str, str]:
    """Headers of an answer that are the same for every request."""
    return {name: value for name, value in answer.headers.items() if name not in OF_EACH_REQUEST}


def test_the_walk_meets_many_routes() -> None:
    assert len(PATHS) > 25
    assert set(QUERIES) <= set(PATHS)


@pytest.mark.parametrize("path", [path for path in PATHS if path != "/metrics"])  # its answer counts the previous one
def test_head_has_the_headers_of_get_and_no_body(
    api: TestClient, answers: dict[str, Any], address: "Address", path: str
) -> None:
    get, head = answers[path], api.head(address(path), headers=coding(path), follow_redirects=False)

    assert get.status_code == head.status_code, get.text
    assert get.status_code == 410 if path == ENDED else get.status_code < 400, get.text
    assert headers_of(head) == headers_of(get)
    assert head.content == b""
    assert get.content or get.status_code in (303, 308)


def test_json_of_some_size_is_compressed(answers: dict[str, Any]) -> None:
    large = {
        path: answer
        for path, answer in answers.items()
        if "json" in answer.headers.get("Content-Type", "") and len(answer.content) >= 500
    }

    assert len(large) >= 5
    assert {path for path, answer in large.items() if answer.headers.get("Content-Encoding") != "gzip"} == set()
    assert {path for path, answer in large.items() if "Accept-Encoding" not in answer.headers["Vary"]} == set()


@pytest.mark.parametrize(
    ("accepted", "coding"),
    [("gzip;q=0", None), ("GZIP; Q=0.000, br", None), ("*;q=0", None), ("gzip;q=0.001", "gzip"), ("br, gzip", "gzip")],
)
@pytest.mark.parametrize("path", ["/api/v1/catalogue", "/catalogue"])
def test_answers_are_compressed_only_for_whoever_accepts_it(
    api: TestClient, path: str, accepted: str, coding: str | None
) -> None:
    answer = api.get(path, headers={"Accept-Encoding": accepted})

    assert answer.headers.get("Content-Encoding") == coding
    assert "Accept-Encoding" in answer.headers["Vary"]


def test_posted_json_and_problems_are_compressed_and_lines_are_not(api: TestClient) -> None:
    wrong = {"duty_cycle": {"phases": [{**phase(1, 1), "a": 1, "b": 2, "c": 3, "d": 4, "e": 5, "f": 6}] * 5}}
    line = b'{"reference": "' + b"x" * 600 + b'"}\n'
    answers = [
        api.post("/api/v1/select", json=worked_example()),
        api.post("/api/v1/select/batch", json={"applications": [worked_example()] * 5}),
        api.post("/api/v1/select", json=wrong),
    ]
    lines = api.post("/api/v1/select/batch", content=line, headers={"Content-Type": "application/x-ndjson"})

    assert [len(answer.content) > 500 for answer in (*answers, lines)] == [True] * 4
    assert [answer.headers.get("Content-Encoding") for answer in (*answers, lines)] == ["gzip"] * 3 + [None]


WITHOUT_BODY = {"/machines/{machine}/delete", "/fleets", "/fleets/{rest:path}"}
"""Routes that answer before they read a body, or without one."""

FORMS = {str(route.path) for route in ALL if "POST" in (route.methods or ())} - WITHOUT_BODY
BODIES = [
    *(("POST", path, "application/x-www-form-urlencoded") for path in sorted(FORMS) if not path.startswith("/api/")),
    ("POST", "/api/v1/select", "application/json"),
    ("POST", "/api/v1/select/batch", "application/json"),
    ("POST", "/api/v1/select/batch", "application/x-ndjson"),
    ("POST", "/api/v1/fleet", "text/csv"),
    ("POST", "/paste", "multipart/form-data; boundary=b"),
    ("PATCH", "/api/v1/selections/{id}", "application/merge-patch+json"),
]


@pytest.mark.parametrize("coding", ["gzip", "Identity, br", "x" * 3000])
@pytest.mark.parametrize(("method", "path", "kind"), BODIES)
def test_a_compressed_body_is_a_415(
    api: TestClient, address: Address, method: str, path: str, kind: str, coding: str
) -> None:
    headers = {"Content-Type": kind, "Content-Encoding": coding}

    answer = api.request(method, address(path), content=gzip.compress(b"{}"), headers=headers, follow_redirects=False)

    assert answer.status_code == 415
    if path.startswith("/api/"):
        assert answer.headers["Accept-Encoding"] == "identity"
        assert coding.lower()[:40] in answer.json()["detail"]
        assert len(answer.json()["detail"]) < 150


def test_a_body_that_is_said_to_be_as_it_is_is_read(api: TestClient) -> None:
    for coding in ("identity", "Identity , identity", ""):
        answer = api.post("/api/v1/select", json=worked_example(), headers={"Content-Encoding": coding})
        assert answer.status_code == 200


@pytest.mark.parametrize("path", LIMITED)
def test_a_link_that_is_too_long_is_a_414_with_words(api: TestClient, address: Address, path: str) -> None:
    place = address(path)
    long = f"{place}{'&' if '?' in place else '?'}T={'9' * MAXIMUM_QUERY_BYTES}"

    program, reader = api.get(long), api.get(long, headers={"Accept": "text/html"})

    assert program.status_code == reader.status_code == 414
    if path == "/":
        assert "POST /api/v1/select" in program.text
    else:
        assert program.headers["Content-Type"] == "application/problem+json"
        assert f"{MAXIMUM_QUERY_BYTES} bytes" in program.json()["detail"]
    page = not path.startswith("/api/")
    assert reader.headers["Content-Type"].startswith("text/html" if page else "application/problem+json")


@pytest.mark.parametrize("path", PATHS)
def test_every_answer_keeps_to_this_host(api: TestClient, answers: dict[str, Any], path: str) -> None:
    for answer in (answers[path], api.put(path), api.get(f"{path}/nowhere")):
        policy = answer.headers["Content-Security-Policy"]
        assert "unsafe-inline" not in policy
        assert "unsafe-eval" not in policy
        assert answer.headers["Cross-Origin-Opener-Policy"] == "same-origin"
        assert answer.headers["Cross-Origin-Resource-Policy"] == "same-origin"
        assert "camera=()" in answer.headers["Permissions-Policy"]
        assert "clipboard-write" not in answer.headers["Permissions-Policy"]  # the page copies


@pytest.mark.parametrize("path", PATHS)
def test_answers_about_saved_selections_are_private_and_the_rest_are_not(answers: dict[str, Any], path: str) -> None:
    record = answers[path].headers.get("Cache-Control", "")

    assert (record == "private, no-cache") == (PATHS[path] in ("reading", "listing", "deleting"))
    assert ("private" in record) == (record == "private, no-cache")


def test_answers_about_a_deleted_or_missing_selection_are_private_too(api: TestClient, saved: str) -> None:
    place = f"/api/v1/selections/{saved}"
    tag = api.get(place).headers["ETag"]
    answers = [
        api.get(place, headers={"If-None-Match": tag}),
        api.get("/api/v1/selections/none"),
        api.get("/selections/none"),
        api.post(
            "/api/v1/selections", json={"application": worked_example()}, headers={"Prefer": "return=representation"}
        ),
        api.delete("/api/v1/selections/none"),
    ]

    assert [answer.status_code for answer in answers] == [304, 404, 404, 201, 404]
    assert {answer.headers["Cache-Control"] for answer in answers} == {"private, no-cache"}


@pytest.mark.parametrize("path", ["/api/v1/catalogue", "/api/v1/catalogue/HPN-20A-5", "/api/v1/bearing-envelopes/20A"])
def test_published_content_is_asked_for_once(api: TestClient, path: str) -> None:
    first = api.get(path)
    again = api.get(path, headers={"If-None-Match": first.headers["ETag"]})
    other = api.get(path, headers={"If-None-Match": '"another"'})

    assert (first.status_code, again.status_code, other.status_code) == (200, 304, 200)
    assert again.content == b""
    assert again.headers["ETag"] == first.headers["ETag"]


def test_no_page_has_a_style_or_a_script_of_its_own(api: TestClient, answers: dict[str, Any]) -> None:
    loaded = f"/?{LINK}&FR=500&FA=200&fw=1.2&Tk=200&pin=HPN-14A-5&gear=HPN-20A-5"
    others = [
        api.get(path, headers={"Accept": "text/html"}) for path in (loaded, "/?T=x", "/nowhere", "/selections/none")
    ]
    result = [*answers.values(), *others]
    pages = [answer.text for answer in result if answer.headers.get("Content-Type", "").startswith("text/html")]

    assert len(pages) > 8
    for page in pages:
        assert not re.search(r"\sstyle=|<style|<script>|\son[a-z]+=", page)


def test_a_file_of_the_page_is_there_before_any_page_was_asked_for() -> None:
    name = Assets.load().manifest["page.js"]

    assert TestClient(create_app()).get(f"/static/{name}").status_code == 200

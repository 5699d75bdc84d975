"""What holds for every route: HEAD like GET, links of a bounded length, compressed JSON, headers of one host."""

from collections.abc import Iterator
from typing import Any
from urllib.parse import quote

import pytest
from fastapi.routing import iter_route_contexts
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.door.access import MAXIMUM_QUERY_BYTES, group_of
from hpn.web.pages.assets import Assets
from tests.build import phase, worked_example

LINK = "T=40&n=250&t=0.3&T=32&n=500&t=3&tp=4&i=5"
QUERIES = {
    "/report.pdf": LINK,
    "/report.xlsx": LINK,
    "/submodel.aasx": LINK,
    "/oembed": f"url={quote(f'/?{LINK}')}",
    "/find": "gear=HPN-20A-5",
}
"""What routes need in their query, those that need any."""

ROUTES = [route for route in iter_route_contexts(create_app().routes) if "GET" in (route.methods or ())]
PATHS = {str(route.path): group_of(route) for route in ROUTES}
LIMITED = [path for path, group in PATHS.items() if group is not None]
OF_EACH_REQUEST = {"x-request-id", "ratelimit", "date"}


@pytest.fixture(scope="module")
def saved(api: TestClient) -> str:
    """Id of a saved selection."""
    return str(api.post("/api/v1/selections", json={"application": worked_example()}).json()["id"])


@pytest.fixture
def address(saved: str) -> "Address":
    """Makes an address of the path of a route."""
    return Address(saved)


class Address:
    """Addresses that lead somewhere, one for each route."""

    def __init__(self, saved: str) -> None:
        self.values = {
            "{id}": saved,
            "{designation}": "HPN-20A-5",
            "{size}": "20A",
            "{name:path}": Assets.load().url("app.css").removeprefix("/static/"),
        }

    def __call__(self, path: str) -> str:
        """Address of a path, with the query that it needs."""
        query = QUERIES.get(path, "")
        for name, value in self.values.items():
            path = path.replace(name, value)
        assert "{" not in path
        return f"{path}?{query}" if query else path


def headers_of(answer: Any) -> dict[str, str]:
    """Headers of an answer that are the same each time."""
    return {name: value for name, value in answer.headers.items() if name not in OF_EACH_REQUEST}


def test_the_walk_meets_many_routes() -> None:
    assert len(PATHS) > 25
    assert set(QUERIES) <= set(PATHS)


@pytest.mark.parametrize("path", [path for path in PATHS if path != "/metrics"])  # each answer tells of the one before
def test_head_has_the_headers_of_get_and_no_body(api: TestClient, address: Address, path: str) -> None:
    # A key that is another each time makes the calculator's page longer or shorter once it is compressed.
    headers = {"Accept-Encoding": "identity" if path == "/" else "gzip"}
    get, head = (
        api.request(method, address(path), headers=headers, follow_redirects=False) for method in ("GET", "HEAD")
    )

    assert get.status_code == head.status_code < 400, get.text
    assert headers_of(head) == headers_of(get)
    assert head.content == b""
    assert get.content or get.status_code in (303, 308)


@pytest.mark.parametrize("path", PATHS)
def test_json_of_some_size_is_compressed(api: TestClient, address: Address, path: str) -> None:
    answer = api.get(address(path), headers={"Accept-Encoding": "gzip"}, follow_redirects=False)

    if "json" in answer.headers.get("Content-Type", ""):
        assert len(answer.content) < 500 or answer.headers["Content-Encoding"] == "gzip"
        assert "Accept-Encoding" in answer.headers.get("Vary", "") or len(answer.content) < 500


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
def test_every_answer_keeps_to_this_host(api: TestClient, address: Address, path: str) -> None:
    for answer in (api.get(address(path), follow_redirects=False), api.get(f"{address(path)}&x=%ff"), api.put(path)):
        policy = answer.headers["Content-Security-Policy"]
        assert "unsafe-inline" not in policy
        assert "unsafe-eval" not in policy
        assert answer.headers["Cross-Origin-Opener-Policy"] == "same-origin"
        assert answer.headers["Cross-Origin-Resource-Policy"] == "same-origin"
        assert "camera=()" in answer.headers["Permissions-Policy"]
        assert "clipboard-write" not in answer.headers["Permissions-Policy"]  # the page copies


@pytest.mark.parametrize("path", PATHS)
def test_what_tells_of_saved_selections_is_private_and_the_rest_is_not(
    api: TestClient, address: Address, path: str
) -> None:
    answer = api.get(address(path), follow_redirects=False)
    again = api.get(address(path), headers={"If-None-Match": answer.headers.get("ETag", "*")}, follow_redirects=False)

    of_saved = PATHS[path] in ("reading", "listing")
    for reply in (answer, again):
        assert (reply.headers.get("Cache-Control") == "private, no-cache") == of_saved
        assert ("private" in reply.headers.get("Cache-Control", "")) == of_saved


@pytest.mark.parametrize("path", ["/api/v1/catalogue", "/api/v1/catalogue/HPN-20A-5", "/api/v1/bearing-envelopes/20A"])
def test_what_is_published_is_asked_for_once(api: TestClient, path: str) -> None:
    first = api.get(path)
    again = api.get(path, headers={"If-None-Match": first.headers["ETag"]})
    other = api.get(path, headers={"If-None-Match": '"another"'})

    assert (first.status_code, again.status_code, other.status_code) == (200, 304, 200)
    assert again.content == b""
    assert again.headers["ETag"] == first.headers["ETag"]


@pytest.fixture
def inline(api: TestClient, address: Address) -> Iterator[list[str]]:
    """Pages, to be searched."""
    long = "&".join(f"T={number}&n=100&t=1" for number in range(1, 6))
    paths = [address(path) for path in PATHS]
    loaded = f"/?{LINK}&FR=500&FA=200&fw=1.2&Tk=200&pin=HPN-14A-5&gear=HPN-20A-5"
    answers = [api.get(path) for path in (*paths, loaded, f"/?{long}", "/?T=x", "/nowhere", "/selections/none")]
    yield [answer.text for answer in answers if answer.headers.get("Content-Type", "").startswith("text/html")]


def test_no_page_has_a_style_or_a_script_of_its_own(inline: list[str]) -> None:
    assert len(inline) > 8
    for page in inline:
        assert " style=" not in page
        assert "<style" not in page
        assert "<script>" not in page
        assert " onclick=" not in page

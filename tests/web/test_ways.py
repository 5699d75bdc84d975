"""Every way through the site keeps the reader's selection."""

import html
from collections.abc import Iterator
from html.parser import HTMLParser
from typing import Any
from urllib.parse import parse_qsl, urlsplit

import pytest
from pydantic import SecretStr
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.build import worked_example

LINK = "T=41&n=250&t=0.3&i=5"
PAGES = (
    "/catalogue",
    "/catalogue?only_size=20A",
    "/catalogue?only_size=nothing",
    "/catalogue/HPN-20A-5",
    "/catalogue/HPN-20A-99",
    "/selections",
    "/selections?search=nothing",
    "/selections/compare",
    "/selections/compare?a=none&b=none",
    "/checks/average_torque",
    "/machines",
    "/paste",
    "/nowhere",
)


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """Client of a service with two saved selections."""
    file = tmp_path_factory.mktemp("ways") / "store.sqlite3"
    with TestClient(create_app(Settings(database_url=SecretStr(f"sqlite:///{file}")))) as client:
        for _ in range(2):
            client.post("/api/v1/selections", json={"application": worked_example()})
        yield client


class Ways(HTMLParser):
    """Links of a page, and its forms that get another page, each with the names that it sends."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[tuple[str, list[str]]] = []
        self._form: list[str] | None = None
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, Any]]) -> None:
        """Note a way, or a field of one."""
        inputs = dict(attributes)
        if tag == "a" and "href" in inputs:
            parts = urlsplit(inputs["href"])
            self.found.append((parts.path, [name for name, _ in parse_qsl(parts.query, True)]))
        if tag == "form":
            self._form = [] if inputs.get("method") == "get" else None
            if self._form is not None:
                self.found.append((inputs["action"], self._form))
        if tag == "input" and self._form is not None:
            self._form.append(inputs.get("name", ""))


@pytest.mark.parametrize("address", PAGES)
def test_every_way_keeps_the_selection(client: TestClient, address: str) -> None:
    answer = client.get(f"{address}{'&' if '?' in address else '?'}{LINK}", headers={"Accept": "text/html"})
    ways = Ways(answer.text).found

    led = [(path, names) for path, names in ways if path in ("/", "/selections", "/machines") or "/catalogue" in path]
    assert len(led) >= 4, answer.text
    assert [path for path, names in led if "T" not in names] == []


def test_marking_two_selections_keeps_the_one_that_is_worked_on(client: TestClient) -> None:
    answer = client.get(f"/selections/compare?id=one&id=two&{LINK}", follow_redirects=False)

    pairs = parse_qsl(urlsplit(answer.headers["location"]).query)
    assert sorted(pairs) == sorted([*parse_qsl(LINK), ("a", "one"), ("b", "two")])


def test_the_name_of_the_site_leads_back_to_the_form_and_on_the_form_nowhere(client: TestClient) -> None:
    elsewhere, form = client.get(f"/catalogue?{LINK}").text, client.get(f"/?{LINK}").text

    assert 'class="brand" href="/?T=41' in elsewhere
    assert 'class="brand" aria-current="page"' in form
    assert 'formaction="/checks/average_torque"' in form  # a button of the form, which sends the form's content


STILL = " come from the example:"
EXAMPLE = "T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200&i=5"


@pytest.mark.parametrize(
    ("query", "own"),
    [
        (EXAMPLE, None),
        ("", None),
        (EXAMPLE.replace("T=40", "T=45"), "T=45&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4"),
        ("T=7&n=90&t=2&tp=4&Tk=200&i=5&title=Axis", "T=7&n=90&t=2&title=Axis"),
        ("T=7&n=90&t=2&tp=4&Tk=200&i=5&gear=HPN-32A-5&pin=HPN-20A-5", "T=7&n=90&t=2&gear=HPN-32A-5&pin=HPN-20A-5"),
        ("T=7&n=90&t=2&tp=4&Tk=200&i=5&FR=10", None),
        ("T=7&n=90&t=2&tp=3&Tk=200&i=5", None),
        ("T=7&n=90&t=2", None),
    ],
)
def test_a_cycle_over_the_worked_example_can_start_without_the_rest_of_it(
    client: TestClient, query: str, own: str | None
) -> None:
    page = html.unescape(client.get(f"/?{query}").text)

    assert (STILL in page) is (own is not None)
    assert own is None or f'<a href="/?{own}">Remove</a>' in page

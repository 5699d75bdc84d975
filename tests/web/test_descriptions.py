"""Every page describes itself in one sentence, in its reader's language."""

import re
from collections.abc import Iterator
from html import unescape

import pytest
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.build import worked_example

PAGES = (
    "/",
    "/?T=&n=&t=",
    "/?T=9,3",
    "/?T=" + "1" * 61_000,
    "/paste",
    "/catalogue",
    "/catalogue/HPN-20A-5",
    "/catalogue/HPN-99A-5",
    "/selections",
    "/selections/nothing",
    "/nowhere",
    "SAVED",
)


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """Client of a service with one saved selection."""
    folder = tmp_path_factory.mktemp("descriptions")
    settings = Settings(database_url=f"sqlite:///{folder}/store.sqlite3")
    with TestClient(create_app(settings), headers={"Accept": "text/html"}) as client:
        client.post("/api/v1/selections", json={"application": worked_example()})
        yield client


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path[:30])
def test_a_page_has_one_description_in_each_language(client: TestClient, path: str) -> None:
    if path == "SAVED":
        path = client.get("/api/v1/selections").json()["selections"][0]["url"]
    message = []
    for language in ("en", "de"):
        page = client.get(path, headers={"Cookie": f"hpn_language={language}"}).text
        [description] = re.findall('<meta name="description" content="([^"]*)">', page)
        message.append(unescape(description))

    english, german = message
    assert english != german
    assert all(40 < len(text) < 200 for text in message)

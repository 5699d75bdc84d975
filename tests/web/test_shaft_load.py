"""Page of a pinion or pulley on the gear's shaft: inputs, the load that it names, the button that counts it."""

import html
from collections.abc import Iterator
from typing import Any

import pytest
from starlette.testclient import TestClient

from hpn.application import Application
from hpn.links.writer import to_link
from hpn.web.app import create_app
from tests.reference.test_shaft_load import MOVE, RACK, axis


@pytest.fixture(scope="module")
def client() -> Iterator[TestClient]:
    with TestClient(create_app()) as client:
        yield client


def link_of(**load: Any) -> str:
    application = axis(**load) if load else {"duty_cycle": {"motion": {"mechanism": RACK, "moves": [MOVE]}}}
    return to_link(Application.model_validate(application))


def page(client: TestClient, link: str, language: str = "en", section: str = "bearing") -> str:
    response = client.get(link, headers={"Cookie": f"hpn_language={language}"})
    assert response.status_code == 200
    part = client.get(link, headers={"Cookie": f"hpn_language={language}", "HX-Request": "true", "HX-Target": section})
    return html.unescape(response.text + part.text)


def test_the_page_tells_the_load_that_is_not_counted_and_counts_it_at_a_press(client: TestClient) -> None:
    plain = page(client, link_of())
    assert "not counted" in plain and 'value="from_motion"' in plain and 'name="fm"' in plain
    pressed = page(client, f"{link_of()}&do=from_motion")
    assert "fm=1" in pressed and "tangential force" in pressed and 'value="from_motion"' not in pressed
    assert "Umfangskraft" in page(client, link_of(from_motion=True), "de")


def test_only_what_the_cycle_leaves_open_can_be_typed(client: TestClient) -> None:
    rack = page(client, link_of())
    assert 'name="hx"' in rack and 'name="kb"' not in rack and 'name="dt"' not in rack
    typed = page(client, "/?T=40&n=250&t=0.3&dt=belt&dd=80&kb=1.5")
    assert 'name="dd"' in typed and 'name="kb"' in typed and 'name="fm"' not in typed
    refused = client.get(f"{link_of()}&dt=belt&dd=80")
    assert refused.status_code == 422 and "typed phases" in html.unescape(refused.text)

"""A machine under keys: read-only for everybody without its key, and what would fail is not offered."""

import pytest
from starlette.testclient import TestClient

from hpn.web.door.keys import new_key
from tests.operations.conftest import MakeClient

AXIS = {
    "name": "A",
    "application": {"duty_cycle": {"phases": [{"torque_Nm": 21, "speed_rpm": 150, "duration_s": 0.3}], "pause_s": 0.4}},
}
CHANGES = ('name="axis"', "edit=common", "/rename", "/delete", 'value="add"', 'id="save-revision"', 'name="past"')


@pytest.fixture
def keyed(make_client: MakeClient) -> tuple[TestClient, dict[str, str], str]:
    """Client of a service with two keys, those, and the address of a machine of the first."""
    pairs = {name: new_key(name) for name in ("plm", "other")}
    client = make_client(api_keys=" ".join(pair for _, pair in pairs.values()))
    keys = {name: key for name, (key, _) in pairs.items()}
    saved = client.post("/api/v1/machines", json={"axes": [AXIS]}, headers={"X-API-Key": keys["plm"]})
    return client, keys, str(saved.json()["url"])


def test_without_its_key_a_machine_opens_read_only_and_edit_asks_for_the_key(
    keyed: tuple[TestClient, dict[str, str], str],
) -> None:
    client, keys, place = keyed

    for headers in ({}, {"X-API-Key": keys["other"]}):
        page = client.get(place, headers=headers)
        assert page.status_code == 200 and "Only the key that saved this" in page.text
        assert f'href="{place}?edit=1"' in page.text
        assert not [each for each in CHANGES if each in page.text]
    response = client.get(f"{place}?edit=1")
    assert response.status_code == 401 and response.headers["www-authenticate"].startswith("Basic")
    assert client.get(f"{place}?edit=common").status_code == 401
    assert client.get(f"{place}?edit=1", headers={"X-API-Key": keys["other"]}).status_code == 403

    own = client.get(f"{place}?edit=1", headers={"X-API-Key": keys["plm"]}).text
    assert "Only the key that saved this" not in own
    assert not [each for each in CHANGES[:-1] if each not in own]


def test_without_its_key_an_axis_is_calculated_and_says_before_that_it_is_not_saved(
    keyed: tuple[TestClient, dict[str, str], str],
) -> None:
    client, keys, place = keyed

    page = client.get(f"{place}/axes/1").text
    assert "Only the key that saved this" in page and '/axes/1/save"\n' not in page
    assert 'id="save-axis"' not in page and 'name="once"' not in page and f'href="{place}/axes/1?edit=1"' in page
    assert client.get(f"{place}/axes/1?edit=1").status_code == 401
    assert client.get(f"{place}/axes/1?edit=1", headers={"X-API-Key": keys["other"]}).status_code == 403

    own = client.get(f"{place}/axes/1?edit=1", headers={"X-API-Key": keys["plm"]}).text
    assert 'id="save-axis"' in own and "Only the key that saved this" not in own


def test_a_change_without_the_key_is_refused_before_anything_is_sized(
    keyed: tuple[TestClient, dict[str, str], str],
) -> None:
    client, keys, place = keyed
    form = {"do": "add", "name": "B"}

    for accept in ("text/html", "text/event-stream"):
        headers = {"Accept": accept}
        assert client.post(f"{place}/change", data=form, headers=headers).status_code == 401
        theirs = client.post(f"{place}/change", data=form, headers={**headers, "X-API-Key": keys["other"]})
        assert theirs.status_code == 403
    assert client.get(f"/api/v1{place}").json()["axes"][0]["name"] == "A"
    assert len(client.get(f"/api/v1{place}").json()["axes"]) == 1

"""A list of motors under keys: read-only for everybody without its key, which its page asks for."""

from hpn.web.door.keys import new_key
from tests.operations.conftest import MakeClient

LIST = {"name": "Ours", "motors": [{"designation": "M1", "rated_torque_Nm": 1, "maximum_speed_rpm": 6000}]}


def test_without_its_key_a_list_opens_read_only_and_edit_asks_for_the_key(make_client: MakeClient) -> None:
    pairs = {name: new_key(name) for name in ("plm", "other")}
    client = make_client(api_keys=" ".join(pair for _, pair in pairs.values()))
    own, other = ({"X-API-Key": pairs[name][0]} for name in ("plm", "other"))
    place = "/motor-lists/" + client.post("/api/v1/motor-lists", json=LIST, headers=own).json()["id"]

    for headers in ({}, other):
        page = client.get(place, headers=headers)
        assert page.status_code == 200 and "M1" in page.text and f'href="{place}?edit=1"' in page.text
        assert f"{place}/save" not in page.text and f"{place}/delete" not in page.text
    response = client.get(f"{place}?edit=1")
    assert response.status_code == 401 and response.headers["www-authenticate"].startswith("Basic")
    assert client.get(f"{place}?edit=1", headers=other).status_code == 403

    page = client.get(f"{place}?edit=1", headers=own)
    assert f"{place}/save" in page.text and f"{place}/delete" in page.text and f'href="{place}?edit=1"' not in page.text

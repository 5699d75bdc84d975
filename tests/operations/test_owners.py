"""Rights to delete: keys own what they save, and the log says which selection it was."""

import orjson
import pytest
from starlette.testclient import TestClient

from hpn.web.door.keys import new_key
from tests.build import worked_example
from tests.operations.conftest import MakeClient
from tests.state import state_of

SAVE = {"application": worked_example()}
KEYS = {name: new_key(name) for name in ("plm", "erp", "admin")}
PAIRS = ",".join(pair for _, pair in KEYS.values())


def key(name: str) -> dict[str, str]:
    """Header of a key."""
    return {"X-API-Key": KEYS[name][0]} if name else {}


def saved(client: TestClient, name: str) -> str:
    """Address of a selection that a key has saved."""
    answer = client.post("/api/v1/selections", json=SAVE, headers=key(name))
    return str(answer.headers["Location"])


@pytest.mark.parametrize(
    ("owner", "caller", "status"),
    [
        ("plm", "plm", 204),
        ("plm", "erp", 403),
        ("plm", "admin", 204),
        ("plm", "", 403),
        ("", "", 403),
        ("", "plm", 403),
        ("", "admin", 204),
        ("admin", "plm", 403),
    ],
)
def test_a_key_deletes_its_own_and_admin_deletes_any(
    owner: str, caller: str, status: int, make_client: MakeClient
) -> None:
    client = make_client(api_keys=PAIRS, guarded="listing")
    place = saved(client, owner)

    answer = client.delete(place, headers=key(caller))

    assert answer.status_code == status
    assert client.get(place).status_code == (404 if status == 204 else 200)
    if status == 403:
        assert answer.json()["title"] == "Not allowed"
        assert "key that saved this selection, or the one named admin" in answer.json()["detail"]


def test_without_keys_everybody_deletes_what_anybody_has_saved(make_client: MakeClient) -> None:
    record = saved(make_client(api_keys=PAIRS), "plm")

    assert make_client().delete(record).status_code == 204


def test_a_form_that_a_browser_sends_with_a_key_is_that_keys_own(make_client: MakeClient) -> None:
    client = make_client(api_keys=PAIRS)
    answer = client.post("/selections", data={"link": "/?T=40&n=250&t=1"}, headers=key("erp"), follow_redirects=False)
    place = f"/api/v1{answer.headers['Location']}"

    assert client.delete(place, headers=key("plm")).status_code == 403
    assert client.delete(place, headers=key("erp")).status_code == 204


def test_a_caller_that_may_not_delete_learns_nothing_of_its_state(make_client: MakeClient) -> None:
    client = make_client(api_keys=PAIRS)
    place = saved(client, "plm")

    answer = client.delete(place, headers={**key("erp"), "If-Match": '"other"'})

    assert answer.status_code == 403


def test_the_log_says_who_saved_and_who_deleted_which_selection(
    make_client: MakeClient, capsys: pytest.CaptureFixture[str]
) -> None:
    client = make_client(api_keys=PAIRS)
    place = saved(client, "plm")
    client.delete(place, headers=key("erp"))
    client.delete(place, headers=key("admin"))

    lines = [orjson.loads(line) for line in capsys.readouterr().out.splitlines()]
    noted = [(line["key"], line["method"], line["status"], line.get("selection")) for line in lines if "route" in line]
    id = place.rpartition("/")[2]
    assert noted == [("plm", "POST", 201, id), ("erp", "DELETE", 403, None), ("admin", "DELETE", 204, id)]


# --- Idempotency keys -------------------------------------------------------------------------------------------------


def test_callers_without_a_key_are_told_apart_by_their_address(make_client: MakeClient) -> None:
    client = make_client(trusted_proxies="127.0.0.1")

    def save(address: str, torque: float) -> tuple[int, str]:
        body = {"application": worked_example(emergency_stop={"torque_Nm": torque})}
        headers = {"Idempotency-Key": "1", "X-Forwarded-For": address}
        answer = client.post("/api/v1/selections", json=body, headers=headers)
        return answer.status_code, answer.json().get("id")

    one, again, other = save("192.0.2.1", 200), save("192.0.2.1", 200), save("192.0.2.2", 150)

    assert (one[0], other[0]) == (201, 201)
    assert one == again != other
    assert save("192.0.2.1", 150)[0] == 422
    assert save("2001:db8::1", 120) == save("2001:db8::2", 120)  # one customer's network


def test_a_key_keeps_its_idempotency_keys_wherever_it_is_sent_from(make_client: MakeClient) -> None:
    client = make_client(api_keys=PAIRS, trusted_proxies="127.0.0.1")
    headers = {"Idempotency-Key": "1", **key("plm")}

    ids = {
        client.post("/api/v1/selections", json=SAVE, headers={**headers, "X-Forwarded-For": address}).json()["id"]
        for address in ("192.0.2.1", "192.0.2.2")
    }

    assert len(ids) == 1


def test_no_address_is_kept_in_clear(make_client: MakeClient, tmp_path_factory: pytest.TempPathFactory) -> None:
    client = make_client(trusted_proxies="127.0.0.1")
    headers = {"Idempotency-Key": "1", "X-Forwarded-For": "192.0.2.77"}

    place = client.post("/api/v1/selections", json=SAVE, headers=headers).headers["Location"]

    url = state_of(client).settings.database_url.get_secret_value()
    folder = tmp_path_factory.getbasetemp()  # the database lies below it
    files = [path for path in folder.rglob("store.sqlite3*") if str(path).startswith(url.removeprefix("sqlite:///"))]
    content = b"".join(path.read_bytes() for path in files)
    assert place.rpartition("/")[2].encode() in content
    assert b"192.0.2.77" not in content

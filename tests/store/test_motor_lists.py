"""Lists of motors: kept, listed, read, replaced and deleted over REST, and by whom; pairs with their motors."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from hpn.store import MOST_LISTS
from hpn.web.app import create_app
from hpn.web.door.keys import new_key
from hpn.web.settings import Settings
from tests.build import Json, worked_example

ADDRESS = "/api/v1/motor-lists"
M40 = {
    "designation": "M 40",
    "maximum_speed_rpm": 6000.0,
    "rated_speed_rpm": 3000.0,
    "rated_torque_Nm": 9.0,
    "stall_torque_Nm": 10.0,
    "peak_torque_Nm": 27.0,
    "inertia_kgm2": 0.0015,
    "weight_kg": 4.2,
}
M60 = {"designation": "M 60", "rated_torque_Nm": 12.0}
OURS: Json = {"name": "Ours", "motors": [M40, M60]}
KEYS = {name: new_key(name) for name in ("plm", "erp", "admin")}


def key(name: str) -> dict[str, str]:
    """Header of a key."""
    return {"X-API-Key": KEYS[name][0]}


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    """Settings of a service with a store and a motors.csv."""
    place = tmp_path / "supplement"
    place.mkdir()
    head = "designation,maximum_speed_rpm,rated_speed_rpm,rated_torque_Nm,peak_torque_Nm,inertia_kgm2,source\n"
    (place / "motors.csv").write_text(f"{head}S 1,6000,3000,9,27,0.001,sheet\n")
    database = f"sqlite:///{tmp_path}/store.sqlite3"
    return Settings(catalogue_supplement=place, database_url=database)


@pytest.fixture
def api(settings: Settings) -> Iterator[TestClient]:
    """Client of it."""
    with TestClient(create_app(settings)) as client:
        yield client


def test_a_list_is_kept_listed_read_replaced_and_deleted(api: TestClient) -> None:
    kept = api.post(ADDRESS, json=OURS)
    assert kept.status_code == 201, kept.text
    place, tag = kept.headers["Location"], kept.headers["ETag"]
    assert (kept.json()["name"], kept.json()["motors"]) == ("Ours", 2)

    lists = api.get(ADDRESS).json()["lists"]
    assert [(one["id"], one["name"], one["motors"]) for one in lists] == [
        ("server", "server", 1),
        (kept.json()["id"], "Ours", 2),
    ]
    read = api.get(place)
    assert read.headers["ETag"] == tag
    assert read.json()["motors"] == [M40 | {"curve": None}, dict.fromkeys([*M40, "curve"]) | M60]
    assert api.get(place, headers={"If-None-Match": tag}).status_code == 304

    replaced = api.put(place, json={"name": "Theirs", "motors": [M60]}, headers={"If-Match": tag})
    assert (replaced.status_code, replaced.json()["motors"]) == (200, 1)
    assert replaced.headers["ETag"] != tag
    assert api.put(place, json=OURS, headers={"If-Match": tag}).status_code == 412
    assert api.delete(place, headers={"If-Match": tag}).status_code == 412
    assert api.get(place).json()["name"] == "Theirs"

    assert api.delete(place, headers={"If-Match": replaced.headers["ETag"]}).status_code == 204
    assert [api.get(place).status_code, api.delete(place).status_code, api.put(place, json=OURS).status_code] == [
        404,
        404,
        404,
    ]


def test_a_name_is_there_once_in_any_case_and_may_change_its_own(api: TestClient) -> None:
    place = api.post(ADDRESS, json=OURS).headers["Location"]
    other = api.post(ADDRESS, json=OURS | {"name": "Other"}).headers["Location"]

    assert api.post(ADDRESS, json=OURS | {"name": " ours "}).status_code == 409
    assert api.put(other, json=OURS).status_code == 409
    assert api.put(place, json=OURS | {"name": "OURS"}).status_code == 200


def test_a_key_changes_its_own_lists_admin_any_and_names_are_of_each_owner(settings: Settings) -> None:
    pairs = ",".join(pair for _, pair in KEYS.values())
    with TestClient(create_app(Settings(**settings.model_dump() | {"api_keys": pairs}))) as api:
        place = api.post(ADDRESS, json=OURS, headers=key("plm")).headers["Location"]
        assert api.post(ADDRESS, json=OURS, headers=key("erp")).status_code == 201
        assert api.post(ADDRESS, json=OURS).status_code == 401
        assert api.get(place).status_code == 200
        assert api.put(place, json=OURS, headers=key("erp")).status_code == 403
        assert api.delete(place, headers=key("erp")).status_code == 403
        assert api.put(place, json=OURS, headers=key("plm")).status_code == 200
        assert api.delete(place, headers=key("admin")).status_code == 204


def test_an_owner_has_200_lists_at_most(api: TestClient) -> None:
    for number in range(MOST_LISTS):
        assert api.post(ADDRESS, json={"name": f"list {number}", "motors": [M60]}).status_code == 201
    one_more = api.post(ADDRESS, json=OURS)

    assert (one_more.status_code, "200" in one_more.json()["detail"]) == (409, True)


def test_the_list_of_the_server_is_read_only(api: TestClient) -> None:
    place = f"{ADDRESS}/server"

    assert [motor["designation"] for motor in api.get(place).json()["motors"]] == ["S 1"]
    assert api.put(place, json=OURS).status_code == 403
    assert api.delete(place).status_code == 403


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        ({"name": " "}, "/name"),
        ({"name": "x" * 500}, "/name"),
        ({"name": None}, "/name"),
        ({"motors": []}, "/motors"),
        ({"motors": None}, "/motors"),
        ({"motors": [M40, M60, M40]}, "/motors/2/designation"),
        ({"motors": [M40 | {"rated_speed_rpm": 6001}]}, "/motors/0/rated_speed_rpm"),
        ({"motors": [M40 | {"stall_torque_Nm": 28}]}, "/motors/0/stall_torque_Nm"),
        ({"motors": [M40 | {"inertia": 1}]}, "/motors/0/inertia"),
        ({"motors": [M40, {"designation": "M 9"}]}, "/motors/1"),
        ({"motors": [{"designation": "M 9", "peak_torque_Nm": None}]}, "/motors/0"),
        ({"motors": [{"designation": f"M {k}"} for k in range(5001)]}, "/motors"),
    ],
)
def test_what_is_wrong_with_a_list_is_said_at_its_place(api: TestClient, change: Json, pointer: str) -> None:
    reply = api.post(ADDRESS, json=OURS | change)

    assert reply.status_code == 422, reply.text
    assert pointer in [error["pointer"] for error in reply.json()["errors"]], reply.text


def test_pairs_go_by_a_kept_list_and_what_was_taken_stays_when_it_is_gone(api: TestClient) -> None:
    kept = api.post(ADDRESS, json=OURS)
    asked = {"application": worked_example(), "list": kept.json()["id"], "top": 1}
    [pair] = api.post("/api/v1/pairs", json=asked).raise_for_status().json()["pairs"]
    [by_server] = api.post("/api/v1/pairs", json=asked | {"list": "server"}).raise_for_status().json()["pairs"]

    assert (pair["motor"], by_server["motor"]) == ("M 40", "S 1")
    api.delete(kept.headers["Location"])
    assert api.get(pair["link"]).status_code == 200
    gone = api.post("/api/v1/pairs", json=asked)
    assert (gone.status_code, gone.json()["errors"][0]["pointer"]) == (422, "/list")


TABLE = "Motor;M_N [Nm];J [kg·cm²];I [A]\nA;1.5;0.4;3\nB;2.5;0.8;4\n".encode()


def test_a_table_is_kept_as_a_list_by_the_reader_of_tables(client: TestClient) -> None:
    headers = {"Content-Type": "text/csv"}

    asked = client.post(ADDRESS, params={"name": "Sheet"}, content=TABLE, headers=headers)
    unnamed = client.post(ADDRESS, params={"answer": "4:skip"}, content=TABLE, headers=headers)
    kept = client.post(ADDRESS, params={"name": "Sheet", "answer": "4:skip"}, content=TABLE, headers=headers)

    assert asked.status_code == 422 and asked.json()["errors"][0]["detail"] == "What is column “I [A]”?"
    assert unnamed.status_code == 422 and unnamed.json()["errors"][0]["pointer"] == "/name"
    assert kept.status_code == 201, kept.text
    motors = client.get(kept.headers["location"]).json()["motors"]
    assert [(motor["designation"], motor["rated_torque_Nm"], motor["inertia_kgm2"]) for motor in motors] == [
        ("A", 1.5, 4e-5),
        ("B", 2.5, 8e-5),
    ]


def test_no_motor_of_a_table_is_left_out_unsaid(client: TestClient) -> None:
    headers, params = {"Content-Type": "text/csv"}, {"name": "Left out", "answer": "zeros:skip"}

    wrong = client.post(ADDRESS, params=params, content=b"Motor;M_N [Nm]\nA;1.5\nB;x\n", headers=headers)
    asked = client.post(ADDRESS, params=params, content=b"Motor;M_N [Nm]\nA;1.5\nB;0\n", headers=headers)

    assert wrong.status_code == 422 and "no number above 0 are left out (1): row 3" in wrong.json()["detail"]
    assert asked.status_code == 201 and asked.json()["motors"] == 1

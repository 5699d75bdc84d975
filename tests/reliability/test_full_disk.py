"""A full disk of SQLite: every way that changes something says what to do, and deleting works once that is done."""

import os
import time
from pathlib import Path
from typing import Any

from starlette.testclient import TestClient

from tests.reliability.faults import SAVE, assert_unavailable, client_of, full, small_disk

ROOM_BYTES = 4 << 20
"""Room that somebody makes: some megabytes, as the sentence says. The disk has 16."""

TABLE = b'axis,torque_Nm,speed_rpm,duration_s\nHub,"[40,20,30]","[100,200,300]","[1,2,3]"\n'
SAID = "The disk of the database (HPN_DATABASE_URL) is full: make some megabytes of room on it"
GESAGT = "Der Datenträger der Datenbank (HPN_DATABASE_URL) ist voll"


def sized(client: TestClient) -> Any:
    """Answer of the page to a table of one axis, which it keeps."""
    return client.post("/machines", files={"file": ("axes.csv", TABLE)}, follow_redirects=False)


def deletions(client: TestClient, ids: list[str], machine: str) -> list[Any]:
    """Answers to deleting a selection over REST, another on the page, and a machine on its own."""
    rest, page = ids
    return [
        client.delete(f"/api/v1/selections/{rest}"),
        client.post(f"/selections/{page}/delete", data={"back": ""}, follow_redirects=False),
        client.post(f"{machine}/delete", follow_redirects=False),
    ]


def test_on_a_full_disk_every_change_says_what_to_do_and_deleting_works_once_it_is_done(tmp_path: Path) -> None:
    with small_disk(tmp_path), client_of(f"sqlite:///{tmp_path}/store.sqlite3") as client:
        ids = [client.post("/api/v1/selections", json=SAVE).json()["id"] for _ in range(2)]
        machine = sized(client).headers["location"]
        with full(tmp_path):
            while client.post("/api/v1/selections", json=SAVE).status_code == 201:
                pass  # a full disk still has room in files that are there
            time.sleep(1.1)  # after which readiness is tried anew
            rest, *pages = deletions(client, ids, machine)
            rename = client.patch(f"/api/v1/selections/{ids[0]}", json={"title": "x"})
            for answer in (rest, rename, client.post("/api/v1/selections", json=SAVE), client.get("/readyz")):
                assert_unavailable(answer)
                assert SAID in answer.json()["detail"]
            for page in (*pages, sized(client), client.post("/selections", data={"T": "40", "n": "250", "t": "1"})):
                assert page.status_code == 503 and int(page.headers["retry-after"]) > 0
                assert SAID in page.text
            in_german = client.post(
                f"/selections/{ids[1]}/delete", data={"back": ""}, headers={"Accept-Language": "de"}
            )
            assert GESAGT in in_german.text

            os.truncate(tmp_path / "filler", (tmp_path / "filler").stat().st_size - ROOM_BYTES)
            assert [answer.status_code for answer in deletions(client, ids, machine)] == [204, 303, 303]
            time.sleep(1.1)
            assert client.get("/readyz").status_code == 200
            assert [client.get(f"/api/v1/selections/{id}").status_code for id in ids] == [404, 404]
            assert client.get(machine).status_code == 404

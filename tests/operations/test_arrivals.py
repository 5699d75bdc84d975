"""Fleets that arrive: a place is taken by a body that is there, and the disk is bounded."""

import socket
from contextlib import ExitStack

import pytest

from hpn.web.door.disk import Disk
from hpn.web.door.problems import Problem
from tests.operations.conftest import MakeClient
from tests.operations.service import Service
from tests.state import state_of

PATH = "/api/v1/fleet"
CSV = {"Content-Type": "text/csv"}
AXES = b'axis,torque_Nm,speed_rpm,duration_s\n1,"[40]","[250]","[2]"\n'


def dripping(service: Service) -> socket.socket:
    """A connection that has sent the beginning of a fleet."""
    connection = socket.create_connection(("127.0.0.1", service.port), 20)
    head = f"POST {PATH} HTTP/1.1\r\nHost: localhost\r\nContent-Type: text/csv\r\nExpect: 100-continue\r\n"
    connection.sendall(f"{head}Content-Length: 100000\r\n\r\n".encode())
    assert connection.recv(100).startswith(b"HTTP/1.1 100")  # the service waits for the body
    connection.sendall(b"a")
    return connection


def test_callers_whose_bodies_drip_shut_fleets_for_nobody(service: Service) -> None:
    with ExitStack() as value_held:
        for _ in range(8):
            value_held.enter_context(dripping(service))
        answer = service.client.post(PATH, content=AXES, headers=CSV)

    assert (answer.status_code, answer.text.count("\n")) == (200, 2)


def test_arriving_bytes_are_bounded_for_all_together_and_given_back(make_client: MakeClient) -> None:
    client = make_client(maximum_spool_bytes=1_000_000)
    disk: Disk = state_of(client).disk
    with disk.share() as others:
        others.take(999_990)
        refused = client.post(PATH, content=AXES, headers=CSV)
    too_much = client.post(PATH, content=b"x" * 1_000_001, headers=CSV)

    assert (refused.status_code, refused.headers["Retry-After"]) == (503, "30")
    assert "999990 of 1000000 bytes" in refused.json()["detail"]
    assert (too_much.status_code, "1000000 bytes" in too_much.text) == (413, True)
    assert client.post(PATH, content=AXES, headers=CSV).status_code == 200
    assert disk.in_use == 0


def test_shares_of_the_disk_add_up() -> None:
    disk = Disk(100)
    with disk.share() as one, disk.share() as other:
        one.take(60)
        with pytest.raises(Problem) as refused:
            other.take(41)
        other.take(40)

    assert refused.value.status_code == 503
    assert disk.in_use == 0

"""`hpn serve` as its users run it: processes, limits of the server, and its end."""

import http.client
import json
import os
import signal
import socket
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, contextmanager
from pathlib import Path

import httpx
import orjson
import pytest

from hpn import ENGINE_VERSION
from tests.build import cycle, phase, worked_example
from tests.operations.service import Service, children_of, held_port, is_gone, serving, until

SELECT = "/api/v1/select"
REPORT = "/api/v1/report.pdf"
NDJSON = {"Content-Type": "application/x-ndjson"}
LINE = orjson.dumps({"reference": "axis", **worked_example(requirements={"ratios": [5]})}) + b"\n"
CHUNK = b"%x\r\n%b\r\n" % (len(LINE), LINE)
ENDED = (0, -signal.SIGTERM)
"""uvicorn ends its own process with the signal that it was sent, as shells expect."""


def test_the_longest_link_is_read_and_a_longer_one_is_a_414(service: Service) -> None:
    assert service.client.get("/?T=" + "1" * 59_000).status_code == 422
    assert service.client.get("/?T=" + "1" * 61_000).status_code == 414


def test_a_body_of_many_small_chunks_is_read(service: Service) -> None:
    response = service.client.post(
        f"{SELECT}/batch", content=(LINE[i : i + 1] for i in range(len(LINE))), headers=NDJSON
    )

    assert response.json()["status"] == "ok"


def test_the_server_does_not_trust_a_forwarded_address(service: Service) -> None:
    service.client.get("/api/v1/catalogue", headers={"X-Forwarded-For": "192.0.2.1", "X-Request-ID": "forwarded"})

    assert service.event(request_id="forwarded")["client"] == "127.0.0.1"


def test_a_client_that_sends_all_before_it_reads_gets_all(service: Service) -> None:
    # the answers, some 20 MB, exceed what sockets of both sides hold, so a server without a spool would stand still
    count = 60_000
    with closing(http.client.HTTPConnection("127.0.0.1", service.port, timeout=120)) as connection:
        connection.request("POST", f"{SELECT}/batch", (b'{"reference":"%d"}\n' % n for n in range(count)), NDJSON)
        with connection.getresponse() as response:
            references = [orjson.loads(line)["reference"] for line in response]

    assert references == [str(number) for number in range(count)]


@contextmanager
def batch_under_way(service: Service) -> Iterator[http.client.HTTPConnection]:
    """A batch of lines whose body the service waits for."""
    connection = http.client.HTTPConnection("127.0.0.1", service.port, timeout=60)
    connection.putrequest("POST", f"{SELECT}/batch")
    connection.putheader("Content-Type", "application/x-ndjson")
    connection.putheader("Transfer-Encoding", "chunked")
    connection.putheader("Expect", "100-continue")
    connection.endheaders()
    with closing(connection):
        assert connection.sock.recv(100).startswith(b"HTTP/1.1 100")
        connection.send(CHUNK)
        yield connection


@pytest.mark.parametrize("workers", ["1", "2"])
def test_running_requests_finish_before_the_end_and_nothing_more_is_taken(tmp_path: Path, workers: str) -> None:
    with serving(tmp_path, {"HPN_WORKERS": workers}) as service, batch_under_way(service) as connection:
        service.terminate()
        wait_until_closed(service)
        for _ in range(20):
            connection.send(CHUNK)
            time.sleep(0.05)
        connection.send(b"0\r\n\r\n")

        with connection.getresponse() as response:
            assert [json.loads(line)["selected"] for line in response] == ["HPN-20A-5"] * 21
        assert service.process.wait(timeout=30) in ENDED


@pytest.mark.parametrize(
    ("host", "proxies", "has_message"),
    [("0.0.0.0", "", True), ("127.0.0.1", "", False), ("0.0.0.0", "10.0.0.1", False)],
)
def test_a_service_that_others_reach_says_that_a_proxy_belongs_before_it(
    host: str, proxies: str, has_message: bool, tmp_path: Path
) -> None:
    with serving(tmp_path, {"HPN_HOST": host, "HPN_TRUSTED_PROXIES": proxies}) as service:
        lines = [event["event"] for event in service.events() if "HPN_TRUSTED_PROXIES" in event["event"]]

    assert len(lines) == has_message
    assert not has_message or "0.0.0.0" in lines[0]


def test_a_setting_that_went_is_named_with_what_replaces_it_and_the_service_starts(tmp_path: Path) -> None:
    gone = {"HPN_MAXIMUM_BYTES_IN_FLIGHT": "1", "HPN_HEAD_SECONDS": "20", "hpn_maximum_connections": "3"}
    with serving(tmp_path, gone) as service:
        lines = [event["event"] for event in service.events() if "no setting any more" in event["event"]]

    assert [line.split()[0] for line in lines] == sorted(gone)
    assert "client_header_timeout" in lines[0]


def wait_until_closed(service: Service) -> None:
    """Wait until it takes no new connection."""
    for _ in range(200):
        try:
            httpx.get(f"{service.url}/healthz", trust_env=False)
        except httpx.ConnectError:
            return
        except (httpx.ReadError, httpx.RemoteProtocolError):  # taken, and then not
            pass
        time.sleep(0.05)
    raise AssertionError("it still takes connections")


def test_the_end_does_not_wait_for_ever(tmp_path: Path) -> None:
    with serving(tmp_path, {"HPN_SHUTDOWN_SECONDS": "1"}) as service, batch_under_way(service):
        service.terminate()

        assert service.process.wait(timeout=20) in ENDED


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_report_under_way_is_finished_when_all_processes_are_told_to_end(
    tmp_path: Path, number: signal.Signals
) -> None:
    long = cycle(*[phase(20 + k % 7, 500 + k % 11) for k in range(10_000)])
    with serving(tmp_path) as service, ThreadPoolExecutor() as pool:
        service.client.post(REPORT, json=worked_example()).raise_for_status()
        (beside,), group = children_of(service.process.pid), os.getpgid(service.process.pid)
        report = pool.submit(httpx.post, service.url + REPORT, json=long, timeout=60, trust_env=False)
        idle = ticks(beside)
        until(lambda: ticks(beside) >= idle + 10)
        processes = (service.process.pid, *children_of(service.process.pid))
        if number == signal.SIGINT:  # of a terminal, which knows a group; a supervisor finds them all
            processes = tuple(process for process in processes if os.getpgid(process) == group)
        for process in processes:
            os.kill(process, number)

        assert report.result().content.startswith(b"%PDF")
        assert service.process.wait(timeout=30) in (*ENDED, -number)
        until(lambda: is_gone(beside))
        assert not [event for event in service.events() if event["level"] == "error"]


def test_a_report_whose_reader_leaves_is_given_up(service: Service) -> None:
    long = cycle(*[phase(20 + k % 7, 500 + k % 11) for k in range(10_000)])
    service.client.post(REPORT, json=worked_example()).raise_for_status()
    (beside,) = children_of(service.process.pid)
    idle = ticks(beside)
    with socket.create_connection(("127.0.0.1", service.port), 20) as connection:
        body = orjson.dumps(long)
        head = f"POST {REPORT} HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
        connection.sendall(f"{head}Content-Length: {len(body)}\r\n\r\n".encode() + body)
        until(lambda: ticks(beside) >= idle + 10)
    until(lambda: is_gone(beside))

    service.client.post(REPORT, json=worked_example()).raise_for_status()
    assert beside not in children_of(service.process.pid)


def ticks(process: int) -> int:
    """Processor time that a process has taken, in hundredths of a second."""
    return sum(map(int, Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[11:13]))


def test_several_workers_serve_count_together_and_end(tmp_path: Path) -> None:
    with serving(tmp_path, {"HPN_WORKERS": "2"}) as service:
        service.event(event="Application startup complete.", count=2)
        for _ in range(40):  # each on a connection of its own, so that both workers get some
            httpx.post(service.url + SELECT, json=worked_example(), trust_env=False).raise_for_status()
        saved = service.client.post("/api/v1/selections", json={"application": worked_example()})
        counted = service.client.get("/metrics").text

        assert saved.status_code == 201
        assert f'hpn_http_requests_total{{method="POST",route="{SELECT}",status="200"}} 40.0' in counted
        assert 'hpn_selections_total{verdict="selected"} 41.0' in counted
        assert 'hpn_store_operations_total{operation="save",outcome="ok"} 1.0' in counted
        assert counted.count("\nhpn_build_info{") == 1  # of the worker that was asked

        service.terminate()
        assert service.process.wait(timeout=30) == 0
        assert sum(event["event"].startswith("Finished server process") for event in service.events()) == 2


def test_the_log_says_at_the_start_which_versions_run(service: Service) -> None:
    ready, start = service.client.get("/readyz").json(), service.event(event="start")

    assert start["engine_version"] == ENGINE_VERSION
    assert start["catalogue_version"] == ready["catalogue_version"]


def test_everything_that_is_logged_is_json(service: Service) -> None:
    service.client.get("/api/v1/catalogue", headers={"X-Request-ID": "last"})
    service.event(request_id="last")

    assert {"event", "level", "timestamp"} <= set.intersection(*(set(event) for event in service.events()))


def test_the_port_of_a_service_under_test_is_given_to_nobody_else_before_it_listens() -> None:
    with held_port() as port, socket.socket() as other, socket.socket() as server:
        with pytest.raises(OSError):
            other.bind(("127.0.0.1", port))
        server.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        server.bind(("127.0.0.1", port))
        server.listen()
        socket.create_connection(("127.0.0.1", port), 20).close()

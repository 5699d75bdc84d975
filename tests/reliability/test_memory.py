"""Memory behind nginx is bounded, whatever is asked at once: a worker in 768 MB is never killed for it."""

import json
import os
import socket
import threading
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import httpx

from tests.build import cycle, phase
from tests.operations.proxy import Proxy, proxied
from tests.operations.service import HPN, Service, serving

LIMIT_BYTES = 768_000_000
GROUPS = Path("/sys/fs/cgroup")
JSON = {"Content-Type": "application/json"}
LONG = cycle(*[phase(40 + k % 7 / 3, 250 + k % 11 / 3, 1 / 3) for k in range(10_000)])
ITEM = json.dumps(cycle(*[phase(40 + k % 7 / 3, 250, 0.3) for k in range(40)]))


@contextmanager
def limited(folder: Path) -> Iterator[tuple[tuple[str, ...], str]]:
    """A program that serves in a control group with the limit, where one can be made; and what kind that is."""
    second = (GROUPS / "cgroup.controllers").exists()
    group = (GROUPS if second else GROUPS / "memory") / f"hpn-{os.getpid()}"
    plain = (str(HPN), "serve")
    try:
        group.mkdir()
        (group / ("memory.max" if second else "memory.limit_in_bytes")).write_text(str(LIMIT_BYTES))
    except OSError:
        with suppress(OSError):
            group.rmdir()
        yield plain, "no control group; the peak alone is looked at"
        return
    yield (
        ("/bin/sh", "-c", f'echo $$ > {group}/cgroup.procs && exec {HPN} serve "$@"', "serve"),
        f"control group of version {2 if second else 1}",
    )
    with suppress(OSError):  # a process that was killed is still on its way out
        group.rmdir()


def peak_MB(service: Service) -> float:
    """Most memory that the worker has had; a process of the same group that makes files would be killed before it."""
    status = Path(f"/proc/{service.process.pid}/status").read_text()
    return int(status.partition("VmHWM:")[2].split()[0]) / 1024


def unread(proxy: Proxy, path: str, count: int) -> list[socket.socket]:
    """Clients that ask and don't read."""
    clients = list[socket.socket]()
    for number in range(count):
        client = proxy.connect(source=f"127.0.{1 + number // 8}.1", receiving=4096)
        client.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
        clients.append(client)
    return clients


def half_sent(proxy: Proxy, size: int, count: int) -> list[socket.socket]:
    """Clients that send all but the last byte of a body."""
    head = "POST /api/v1/select HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
    clients = list[socket.socket]()
    for number in range(count):
        client = proxy.connect(source=f"127.0.{1 + number // 8}.2")
        with suppress(OSError):
            client.sendall(f"{head}Content-Length: {size}\r\n\r\n".encode() + b" " * (size - 1))
        clients.append(client)
    return clients


def test_a_worker_in_768_MB_outlives_everything_at_once(tmp_path: Path, soak: bool, record_property: Any) -> None:
    batch = ('{"applications": [' + ",".join([ITEM] * (9_900 if soak else 1_000)) + "]}").encode()
    nested = b'{"applications": [' + b"[]," * 9_000_000 + b"1]}"
    long = json.dumps(LONG).encode()
    statuses: list[int] = []

    def ask(proxy: Proxy, method: str, path: str, body: bytes, turns: int) -> None:
        with httpx.Client(base_url=proxy.url, verify=proxy.trust(), timeout=300, trust_env=False) as client:
            for _ in range(turns):
                statuses.append(client.request(method, path, content=body, headers=JSON).status_code)
                time.sleep(0.1)

    with (
        limited(tmp_path) as (program, kind),
        serving(tmp_path, {"HPN_LOG_LEVEL": "warning", "HPN_TRUSTED_PROXIES": "*"}, program=program) as service,
        proxied(service.port) as proxy,
    ):
        saved = service.client.post("/api/v1/selections", content=b'{"application": %s}' % long, headers=JSON).json()
        question = [
            ("POST", "/api/v1/select/batch", batch),
            ("POST", "/api/v1/select/batch", nested),
            ("POST", "/api/v1/select", long),
            ("POST", "/api/v1/report.pdf", long),
            ("GET", saved["url"], b""),
            ("GET", f"/api/v1{saved['url']}", b""),
            ("GET", f"{saved['url']}/copy", b""),
        ]
        if soak:
            question.append(("POST", "/api/v1/report.xlsx", long))
        for silent, slow in ((200, 100), (10, 10)) if soak else ((20, 20),):
            peers = unread(proxy, f"/api/v1{saved['url']}", silent)
            peers += half_sent(proxy, 1_900_000, slow)
            threads = [
                threading.Thread(target=ask, args=(proxy, *one, 10 if soak else 1), daemon=True)
                for one in question * (6 if soak else 1)
            ]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            for peer in peers:
                peer.close()
        peak = peak_MB(service)
        killed = [event for event in service.events() if "ended before" in event["event"]]
        alive = service.process.poll() is None
        small = service.client.post("/api/v1/select", json=cycle(phase(40, 250))).status_code
    record_property("peak_MB", peak)
    print(f"{peak:.0f} MB at most, {kind}, {len(killed)} killed beside it; {dict(Counter(statuses))}")

    assert alive
    assert small == 200
    assert set(statuses) <= {200, 413, 422, 429, 503}
    assert 200 in statuses
    assert soak or not killed
    assert peak * 2**20 < LIMIT_BYTES

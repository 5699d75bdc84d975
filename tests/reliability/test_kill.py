"""An acknowledged save survives `kill -9` of the server at any moment."""

import asyncio
import http.client
import itertools
import json
import os
import random
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TypeVar

import orjson
from starlette.testclient import TestClient

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.selection import encode, select
from hpn.links.writer import to_link
from hpn.store import Store
from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.build import Json, cycle, phase

KILLS, SOAK_KILLS = 40, 400
"""On SQLite, which lives in the process that is killed; on PostgreSQL, which does not, a quarter of them."""

CLIENTS = 4


@contextmanager
def killed_server(database: str, kills: int) -> Iterator[tuple[int, "subprocess.Popen[str]"]]:
    """Port of a service whose workers are killed at random moments, and the process that does it."""
    with socket.create_server(("127.0.0.1", 0), backlog=128) as listener:
        command = [sys.executable, "-m", "tests.reliability.killer", str(listener.fileno()), str(kills), "17"]
        process = subprocess.Popen(
            command,
            env={**os.environ, "HPN_DATABASE_URL": database, "HPN_LOG_LEVEL": "error"},
            pass_fds=[listener.fileno()],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        try:
            yield listener.getsockname()[1], process
        finally:
            process.communicate(timeout=120)


@dataclass
class Clients:
    """Clients that save, with a pause or without, and repeat with the same key what was not acknowledged."""

    port: int
    acknowledged: dict[str, Json] = field(default_factory=dict)
    broken: int = 0
    unexpected: list[str] = field(default_factory=list)
    enough: threading.Event = field(default_factory=threading.Event)
    numbers: "itertools.count[int]" = field(default_factory=itertools.count)
    pause_s: float = 0.0

    def run(self) -> None:
        """One client."""
        while not self.enough.is_set():
            number = next(self.numbers)
            wanted = application(number)
            body = {"application": wanted, "title": f"axis {number}", "reference": f"r{number % 10}"}
            id = None
            while id is None and not self.enough.is_set():
                id = self.save(body, f"key-{number}")
            if id is not None:
                self.acknowledged[id] = body
            self.enough.wait(self.pause_s)

    def save(self, body: Json, key: str) -> str | None:
        """Id if the service says that it is saved."""
        saved = self.send("POST", "/api/v1/selections", body, 201, {"Idempotency-Key": key})
        return None if saved is None else str(saved["id"])

    def send(self, method: str, path: str, body: Json, status: int, headers: dict[str, str]) -> Json | None:
        """Answer, if one comes with the status."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        try:
            connection.request(method, path, json.dumps(body), {"Content-Type": "application/json", **headers})
            response = connection.getresponse()
            content = response.read()
        except (OSError, http.client.HTTPException):
            self.broken += 1
            return None
        finally:
            connection.close()
        if response.status != status:
            self.unexpected.append(f"{response.status} {content[:200]!r}")
            return None
        answer: Json = json.loads(content)
        return answer


@dataclass
class Editors(Clients):
    """Clients each of whom changes an axis of its own, again and again."""

    place: str = ""
    tried: dict[int, int] = field(default_factory=dict)
    done: dict[int, int] = field(default_factory=dict)

    def run(self) -> None:
        """One client."""
        axis = next(self.numbers) + 1
        for quantity in itertools.count(1):
            if self.enough.is_set():
                return
            self.tried[axis] = quantity
            if self.send("PATCH", f"{self.place}/axes/{axis}", {"quantity": quantity}, 200, {}) is not None:
                self.done[axis] = quantity


def application(number: int) -> Json:
    """An application that no other number has."""
    chance = random.Random(number)
    return cycle(phase(chance.uniform(1, 60), 200.0 + number, 1.5), phase(-5.0, 100.0, 2.0), pause_s=1.0)


async def read_back(database: str, clients: Clients, catalogue: Catalogue, fault: str) -> None:
    """Every acknowledged selection is there, once and whole; says how many those are."""
    store = Store(database)
    await store.open()
    for id, body in clients.acknowledged.items():
        found = await store.find(id)
        assert found is not None, f"{body['title']} was acknowledged and is lost"
        assert (found.title, found.reference) == (body["title"], body["reference"])
        assert orjson.loads(found.application) == body["application"]
        wanted = Application.model_validate(body["application"])
        assert found.result == encode(select(wanted, catalogue, to_link))
    titles, cursor = [], None
    while True:
        page = await store.page(cursor=cursor, limit=200)
        titles += [summary.title for summary in page.selections]
        cursor = page.next_cursor
        if cursor is None:
            break
    await store.close()
    assert len(titles) == len(set(titles)), "a repeated request was saved twice"
    wanted_titles = {body["title"] for body in clients.acknowledged.values()}
    print(f"\n{fault}: acknowledged {len(clients.acknowledged)}, found {len(wanted_titles & set(titles))}")
    assert wanted_titles <= set(titles)


def test_every_acknowledged_selection_survives_a_kill_at_any_moment(
    database: str, catalogue: Catalogue, soak: bool
) -> None:
    kills = (SOAK_KILLS if soak else KILLS) // (1 if database.startswith("sqlite") else 4)
    clients = killed_beside(database, kills, Clients)
    assert len(clients.acknowledged) >= kills
    asyncio.run(read_back(database, clients, catalogue, f"{kills} kills, {database.partition(':')[0]}"))


C = TypeVar("C", bound=Clients)


def killed_beside(database: str, kills: int, make: Callable[[int], C]) -> C:
    """Clients of a port after a service has been killed beside them so often."""
    with killed_server(database, kills) as (port, process):
        clients = make(port)
        threads = [threading.Thread(target=clients.run) for _ in range(CLIENTS)]
        for thread in threads:
            thread.start()
        assert process.stdout is not None
        finished = process.stdout.readline()
        clients.enough.set()
        for thread in threads:
            thread.join()

    assert finished == "done\n", "the killing broke off"
    assert clients.unexpected == []
    assert clients.broken >= kills / 4, "too few kills met a request"
    return clients


def test_every_acknowledged_change_of_an_axis_survives_a_kill_beside_other_axes(database: str, soak: bool) -> None:
    kills = (SOAK_KILLS if soak else KILLS) // (2 if database.startswith("sqlite") else 4)
    axes = [{"application": application(number)} for number in range(CLIENTS)]
    with TestClient(create_app(Settings(database_url=database, log_level="error"))) as client:
        place = client.post("/api/v1/machines", json={"axes": axes}).headers["location"]

    editors = killed_beside(database, kills, lambda port: Editors(port, place=place))

    async def quantities() -> dict[int, int]:
        store = Store(database)
        machine = await store.find_machine(place.rpartition("/")[2])
        await store.close()
        assert machine is not None
        return {axis.number: axis.quantity for axis in machine.items}

    found = asyncio.run(quantities())
    assert all(editors.done[axis] <= found[axis] <= editors.tried[axis] for axis in range(1, CLIENTS + 1))
    assert sum(editors.done.values()) >= kills

"""People who save while something happens: what they were told is saved has to be there afterwards."""

import http.client
import json
import secrets
import ssl
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field

from tests.build import Json
from tests.containers.stack import Stack
from tests.reliability.test_kill import Clients

COUNT = 3
BACK_S = 120.0
"""Longest time until saving works again."""


@dataclass
class Savers(Clients):
    """Clients through the proxy: an answer that tells to come again is no loss."""

    context: ssl.SSLContext = field(default_factory=ssl.create_default_context)
    mark: str = field(default_factory=lambda: secrets.token_hex(4))
    saved_at: list[float] = field(default_factory=list)

    def save(self, body: Json, key: str) -> str | None:
        """Id if the service says that it is saved."""
        connection = http.client.HTTPSConnection("localhost", self.port, timeout=60, context=self.context)
        try:
            headers = {"Content-Type": "application/json", "Idempotency-Key": f"{self.mark}-{key}"}
            connection.request("POST", "/api/v1/selections", json.dumps(body), headers)
            response = connection.getresponse()
            content = response.read()
        except (OSError, http.client.HTTPException):
            self.broken += 1
            time.sleep(0.1)
            return None
        finally:
            connection.close()
        if response.status == 201:
            self.saved_at.append(time.monotonic())
            return str(json.loads(content)["id"])
        if response.status != 503 or "retry-after" not in response.headers:
            self.unexpected.append(f"{response.status} {content[:200]!r}")
        self.broken += 1
        time.sleep(0.1)
        return None


def saving_while(stack: Stack, happens: Callable[[], object]) -> str:
    """Save while something happens and until saving works again; says how much, and how long nobody could save."""
    savers = Savers(stack.https, pause_s=0.02, context=stack.trust())
    threads = [threading.Thread(target=savers.run) for _ in range(COUNT)]
    for thread in threads:
        thread.start()
    try:
        _await_saved(savers, since=0.0)
        time.sleep(1)
        happens()
        _await_saved(savers, since=time.monotonic())
        time.sleep(1)
    finally:
        savers.enough.set()
        for thread in threads:
            thread.join()
    assert not savers.unexpected, savers.unexpected[:3]
    with stack.client() as client:
        for id, body in savers.acknowledged.items():
            response = client.get(f"/api/v1/selections/{id}")
            assert response.status_code == 200, f"{body['title']} was acknowledged and answers {response.status_code}"
            assert response.json()["title"] == body["title"]
        titles = _titles(stack)
    doubled = sorted(title for title in titles if titles.count(title) > 1 and title.startswith("axis "))
    assert not doubled, f"saved twice: {doubled[:5]}"
    for id in savers.acknowledged:
        _delete(stack, id)
    gaps = zip(savers.saved_at, savers.saved_at[1:], strict=False)
    away = max(after - before for before, after in gaps)
    return f"{len(savers.acknowledged)} saved, none lost; {savers.broken} to come again, {away:.1f} s without one"


def _await_saved(savers: Savers, since: float) -> None:
    end = time.monotonic() + BACK_S
    while not any(at > since for at in savers.saved_at[-COUNT:]):
        assert time.monotonic() < end, f"nobody could save for {BACK_S:.0f} s: {savers.unexpected[:2]}"
        time.sleep(0.05)


def _titles(stack: Stack) -> list[str]:
    titles: list[str] = []
    query: dict[str, str] = {"limit": "200"}
    with stack.client() as client:
        while True:
            page = client.get("/api/v1/selections", params=query).json()
            titles += [each["title"] for each in page["selections"]]
            if page["next_cursor"] is None:
                return titles
            query["cursor"] = page["next_cursor"]


def _delete(stack: Stack, id: str) -> None:
    with stack.client() as client:
        client.delete(f"/api/v1/selections/{id}")
